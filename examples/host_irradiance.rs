//! An engine that lights things itself: Translume hands out the texels of this frame, the engine writes how much light enters each, and
//! Translume scatters that.
//!
//! `cargo run --release -p translume-examples --example host_irradiance` writes `out/host_irradiance.png`: a projector throws a flower
//! onto a ball of wax, and the wax blurs it.

#![allow(clippy::print_stdout, reason = "a program talks to its terminal")]

use std::error::Error;
use translume::{BodyDescriptor, Config, Frame, Gloss, Lighting, Medium, Stage, Translume, wgpu};
use translume_examples::{Compute, Host, Picture, camera};
use translume_mesh::{Atlas, AtlasOptions, builtin};

/// As in `host_irradiance.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Projector {
    matrix: [[f32; 4]; 4],
    position: [f32; 3],
    intensity: f32,
    eta: f32,
    texels: u32,
    padding: [u32; 2],
}

fn main() -> Result<(), Box<dyn Error>> {
    let host = Host::new()?;
    let picture = Picture::new(&host, [400, 400]);
    let mesh = builtin::sphere([0.0; 3], 25.0, 5);
    let atlas = Atlas::build(&mesh, &AtlasOptions { size: 256, ..Default::default() }, |_| true)?;
    let translume = Translume::new(&host.device, &Config::default())?;
    let descriptor =
        BodyDescriptor { medium: Medium::WAX, mm_per_unit: 1.0, ..BodyDescriptor::new(&mesh, &atlas) };
    let mut body = translume.create_body(&host.device, &descriptor)?;

    // Once: a buffer of four floats for each texel, which Translume copies from.
    let texels = body.texels();
    let irradiance = host.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("irradiance"),
        size: 16 * u64::from(texels),
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let eye = [40.0, 25.0, 80.0];
    let slide = camera(eye, [0.0; 3], 1.0);
    let projector = Projector {
        matrix: slide.view_projection,
        position: eye,
        intensity: 4e4,
        eta: body.medium().ior,
        texels,
        padding: [0; 2],
    };
    // Of Translume's material functions the engine's shader takes the Fresnel term.
    let source = format!("{}\n{}", translume_shaders::MATERIAL, include_str!("host_irradiance.wgsl"));
    let uniform = host.buffer(&[projector], wgpu::BufferUsages::UNIFORM);
    let outputs = body.outputs();
    let buffers = [&uniform, outputs.texel_positions, outputs.texel_normals, &irradiance];
    let lighting = Compute::new(&host, &source, "light", &buffers);

    // Each frame: Translume's first stages, the engine's light, and the rest of Translume's. One encoder takes all.
    let frame = Frame { lighting: Lighting::Irradiance(&irradiance), ..Default::default() };
    body.prepare(&host.device, &host.queue, &frame)?;
    let mut encoder = host.encoder();
    body.encode_through(&mut encoder, Stage::Gather);
    lighting.encode(&mut encoder, texels);
    body.encode(&mut encoder);

    let composite = translume.composite(&host.device, Picture::TARGET);
    let mut view = composite.view(&host.device, &body);
    let camera = camera([0.0, 15.0, 90.0], [0.0; 3], picture.aspect());
    view.prepare(&host.device, &host.queue, &body, &camera, Gloss::None);
    composite.draw(&mut picture.pass(&mut encoder), &view);
    host.queue.submit([encoder.finish()]);
    println!("wrote {}", picture.save(&host, "host_irradiance")?.display());
    Ok(())
}
