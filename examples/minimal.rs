//! The least an engine does: a device, a mesh, a lamp behind it, and the exitance texture read back.
//!
//! `cargo run --release -p translume-examples --example minimal` writes `out/exitance.png`: the atlas with the light that leaves each
//! texel, brighter where the lamp shines through. A real host samples the texture in its material instead.

use std::error::Error;
use translume::{
    BodyDescriptor, Config, Frame, Light, Lighting, Medium, PointLight, Translume, readback, wgpu,
};
use translume_mesh::{Atlas, AtlasOptions, builtin};

fn main() -> Result<(), Box<dyn Error>> {
    // The host has these already.
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle().with_env());
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))?;
    let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default()))?;

    // Once: unwrap the mesh on the CPU, compile the pipelines, upload the body.
    let mesh = builtin::creature_with(5_000);
    let atlas = Atlas::build(&mesh, &AtlasOptions { size: 128, ..Default::default() }, |_| true)?;
    let translume = Translume::new(&device, &Config::default())?;
    let descriptor =
        BodyDescriptor { medium: Medium::JADE, mm_per_unit: 1.0, ..BodyDescriptor::new(&mesh, &atlas) };
    let mut body = translume.create_body(&device, &descriptor)?;

    // Each frame: say what the light and the pose are, record, submit.
    let lamp = Light::Point(PointLight {
        position: [-40.0, 120.0, -90.0],
        intensity: [2e4; 3],
        ..Default::default()
    });
    body.prepare(&device, &queue, &Frame { lighting: Lighting::Lights(&[lamp]), ..Default::default() })?;
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    body.encode(&mut encoder);
    queue.submit([encoder.finish()]);

    let exitance = readback::texture::<[f32; 4]>(&device, &queue, body.exitance_texture(), 0)?;
    let bytes: Vec<u8> = exitance
        .iter()
        .flat_map(|texel| [0, 1, 2].map(|k| (255.0 * texel[k].max(0.0).sqrt().min(1.0)) as u8))
        .collect();
    std::fs::create_dir_all("out")?;
    image::save_buffer("out/exitance.png", &bytes, atlas.size, atlas.size, image::ColorType::Rgb8)?;
    Ok(())
}
