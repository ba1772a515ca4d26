//! An engine's own forward renderer, with depth and four samples a pixel, draws a body with a material of its own that looks radiant exitance
//! up in Translume's texture.
//!
//! `cargo run --release -p translume-examples --example own_material` writes `out/own_material.png` and says how far the material's
//! radiance is from that of the library's own composite.

#![allow(clippy::print_stdout, reason = "a program talks to its terminal")]

use std::error::Error;
use translume::{
    BodyDescriptor, Config, DirectionalLight, Frame, Geometry, Gloss, Light, Lighting, Medium, PointLight,
    Translume, wgpu,
};
use translume_examples::{Host, Picture, camera, relative_rmse};
use translume_mesh::{Atlas, AtlasOptions, builtin};

/// As `Scene` in `own_material.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Scene {
    view_projection: [[f32; 4]; 4],
    eye: [f32; 3],
    eta: f32,
    to_sun: [f32; 3],
    exit_scale: f32,
    sun: [f32; 3],
    gloss: f32,
}

fn main() -> Result<(), Box<dyn Error>> {
    let host = Host::new()?;
    let picture = Picture::new(&host, [480, 400]);
    let camera = camera([150.0, 120.0, 240.0], [0.0, 48.0, 0.0], picture.aspect());

    // Once: the body. One unit of this engine is a millimetre.
    let translume = Translume::new(&host.device, &Config::default())?;
    let mesh = builtin::creature_with(20_000);
    let atlas = Atlas::build(&mesh, &AtlasOptions { size: 256, ..Default::default() }, |_| true)?;
    let descriptor =
        BodyDescriptor { medium: Medium::JADE, mm_per_unit: 1.0, ..BodyDescriptor::new(&mesh, &atlas) };
    let mut body = translume.create_body(&host.device, &descriptor)?;

    // Once: the engine's pipelines. The material binds the body's texture like any other; it stays the same for the body's life.
    let source = format!("{}\n{}", translume_shaders::MATERIAL, include_str!("own_material.wgsl"));
    let module = host.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("own material"),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let layout = layout(&host.device);
    let body_pipeline = pipeline(&host.device, &module, &layout, "body", &Geometry::LAYOUTS.map(Some));
    let floor_pipeline = pipeline(&host.device, &module, &layout, "floor", &[]);

    // Each frame: the engine's lights are Translume's lights.
    let sun =
        DirectionalLight { to_light: [0.5, 0.7, -0.5], irradiance: [2.5, 2.3, 2.0], ..Default::default() };
    let lamp =
        PointLight { position: [-50.0, 110.0, -80.0], intensity: [6e4, 5e4, 4e4], ..Default::default() };
    let lights = [Light::Directional(sun), Light::Point(lamp)];
    body.prepare(
        &host.device,
        &host.queue,
        &Frame { lighting: Lighting::Lights(&lights), ..Default::default() },
    )?;
    let scene = |gloss| Scene {
        view_projection: camera.view_projection,
        eye: camera.eye,
        eta: body.medium().ior,
        to_sun: unit(sun.to_light),
        exit_scale: body.profile().exit_scale(body.medium().ior),
        sun: sun.irradiance,
        gloss,
    };
    let group = |gloss| {
        let uniform = host.buffer(&[scene(gloss)], wgpu::BufferUsages::UNIFORM);
        host.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("own material"),
            layout: &layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::TextureView(body.exitance_view()),
                },
            ],
        })
    };
    let (glossy, matt) = (group(1.0), group(0.0));
    let mut encoder = host.encoder();
    body.encode(&mut encoder);
    {
        let mut pass = picture.pass(&mut encoder);
        pass.set_bind_group(0, &glossy, &[]);
        pass.set_pipeline(&floor_pipeline);
        pass.draw(0..4, 0..1);
        pass.set_pipeline(&body_pipeline);
        body.geometry().draw(&mut pass);
    }
    host.queue.submit([encoder.finish()]);
    println!("wrote {}", picture.save(&host, "own_material")?.display());

    // Not for engines: the same body alone, without a highlight, by this material and by the library's composite.
    let composite = translume.composite(&host.device, Picture::TARGET);
    let mut view = composite.view(&host.device, &body);
    view.prepare(&host.device, &host.queue, &body, &camera, Gloss::None);
    let draw = |draw: &dyn Fn(&mut wgpu::RenderPass<'_>)| {
        let mut encoder = host.encoder();
        draw(&mut picture.pass(&mut encoder));
        host.queue.submit([encoder.finish()]);
        picture.radiance(&host)
    };
    let own = draw(&|pass| {
        pass.set_bind_group(0, &matt, &[]);
        pass.set_pipeline(&body_pipeline);
        body.geometry().draw(pass);
    })?;
    let theirs = draw(&|pass| composite.draw(pass, &view))?;
    println!("relative RMSE against the composite: {:.4} %", 100.0 * relative_rmse(&own, &theirs));
    Ok(())
}

fn layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
        ty,
        count: None,
    };
    let uniform = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    // Not every device filters 32-bit floats; the look-up interpolates on its own.
    let exitance = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: false },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("own material"),
        entries: &[entry(0, uniform), entry(1, exitance)],
    })
}

fn pipeline(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    layout: &wgpu::BindGroupLayout,
    name: &str,
    buffers: &[Option<wgpu::VertexBufferLayout<'_>>],
) -> wgpu::RenderPipeline {
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(name),
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    });
    let topology = if buffers.is_empty() {
        wgpu::PrimitiveTopology::TriangleStrip
    } else {
        wgpu::PrimitiveTopology::TriangleList
    };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(name),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(&format!("{name}_vertex")),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers,
        },
        primitive: wgpu::PrimitiveState { topology, ..Default::default() },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: Picture::DEPTH,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Less),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState { count: Picture::SAMPLES, ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(&format!("{name}_fragment")),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(Picture::FORMAT.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn unit(v: [f32; 3]) -> [f32; 3] {
    let length = v.iter().map(|x| x * x).sum::<f32>().sqrt();
    v.map(|x| x / length)
}
