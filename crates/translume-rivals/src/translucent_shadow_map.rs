//! Translucent shadow maps: Dachsbacher, Stamminger 2003, "Translucent Shadow Maps".
//!
//! reads  the mesh, lights, camera                    writes  a map per light with all its levels, the picture
//! WGSL   `shaders/translucent_shadow_map.wgsl`

use crate::dipole::MediumLayout;
use crate::geometry::Geometry;
use crate::gpu::{self, Pass};
use crate::scene::{Frame, MAX_LIGHTS, SceneLayout};
use crate::{Error, Target, check};
use translume::wgpu::{self, TextureFormat, TextureViewDimension as Dimension};
use translume::{Light, Medium};

/// Quality of translucent shadow maps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TranslucentShadowMap {
    /// Rings of samples around the middle one, 1..=64.
    pub rings: u32,
    /// Samples of each ring, 3..=64.
    pub spokes: u32,
    /// Width of a light's map, texels: a power of two from 16 to 4096.
    pub map: u32,
    /// Whether the dipole's sources stand along the normal of the point of entry, as in the paper; if not, the dipole is that of the distance
    /// between the points alone, as translume's.
    pub displaced: bool,
}

impl Default for TranslucentShadowMap {
    /// The paper's 21 samples.
    fn default() -> Self {
        Self { rings: 4, spokes: 5, map: 512, displaced: false }
    }
}

impl TranslucentShadowMap {
    /// Samples per light and fragment.
    #[must_use]
    pub fn samples(&self) -> u32 {
        1 + self.rings * self.spokes
    }

    fn validate(&self) -> Result<(), Error> {
        check("rings", self.rings, 1, 64)?;
        check("spokes", self.spokes, 3, 64)?;
        check("map", self.map, 16, 4096)?;
        if self.map.is_power_of_two() {
            return Ok(());
        }
        let range = "a power of two".to_owned();
        Err(Error::Setting { field: "map", value: self.map.into(), range })
    }
}

/// Of the map: what enters times (normal, 1), and times depth.
const MAP: [TextureFormat; 2] = [TextureFormat::Rgba16Float, TextureFormat::R16Float];

pub(crate) struct Maps {
    settings: TranslucentShadowMap,
    medium: Option<Medium>,
    lights: u32,
    scene: wgpu::Buffer,
    constants: wgpu::Buffer,
    /// What enters and depth, all levels of all lights.
    pub textures: [wgpu::Texture; 2],
    layers: Vec<Layer>,
    map_depth: wgpu::TextureView,
    map_group: wgpu::BindGroup,
    picture_group: wgpu::BindGroup,
    store: wgpu::RenderPipeline,
    halve: wgpu::RenderPipeline,
    depth_alone: wgpu::RenderPipeline,
    picture: wgpu::RenderPipeline,
}

/// The map of a light: each level as a target, and each but the last as what the next is made of.
struct Layer {
    targets: Vec<[wgpu::TextureView; 2]>,
    finer: Vec<wgpu::BindGroup>,
}

impl Maps {
    pub fn new(device: &wgpu::Device, settings: TranslucentShadowMap) -> Result<Self, Error> {
        settings.validate()?;
        let source = crate::TRANSLUCENT_SHADOW_MAP.join("\n");
        let module = &device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("translucent shadow map"),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let map = |filterable| gpu::texture(gpu::float(filterable), Dimension::D2Array);
        let map_layout = gpu::layout(device, "translucent shadow map", &[(0, gpu::UNIFORM)]);
        let halve_layout = gpu::layout(device, "halve", &[(2, map(false)), (3, map(false))]);
        let bindings =
            [(0, gpu::UNIFORM), (1, gpu::UNIFORM), (2, map(true)), (3, map(true)), (4, gpu::SAMPLER)];
        let picture_layout = gpu::layout(device, "translucent picture", &bindings);

        let uniform =
            |label, size: usize| gpu::buffer(device, label, size as u64, wgpu::BufferUsages::UNIFORM);
        let scene = uniform("rival scene", size_of::<SceneLayout>());
        let constants = uniform("rival medium", size_of::<MediumLayout>());
        let width = settings.map;
        let levels = width.ilog2() + 1;
        let size = [width, width, MAX_LIGHTS as u32];
        let textures = MAP.map(|format| gpu::target(device, "translucent shadow map", format, size, levels));
        let depth = gpu::target(device, "depth of a map", gpu::DEPTH, [width, width, 1], 1);
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("translucent shadow map"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        });
        let all = textures.each_ref().map(|texture| gpu::view(texture, Dimension::D2Array));
        let picture_group = gpu::bind(
            device,
            "translucent picture",
            &picture_layout,
            &[
                (0, scene.as_entire_binding()),
                (1, constants.as_entire_binding()),
                (2, wgpu::BindingResource::TextureView(&all[0])),
                (3, wgpu::BindingResource::TextureView(&all[1])),
                (4, wgpu::BindingResource::Sampler(&sampler)),
            ],
        );
        let constants_of_shader = [
            ("RINGS", settings.rings.into()),
            ("SPOKES", settings.spokes.into()),
            ("DISPLACED", f64::from(u8::from(settings.displaced))),
        ];
        let mesh = Pass {
            label: "translucent shadow map",
            module,
            layout: &map_layout,
            vertex: "from_light",
            mesh: true,
            fragment: Some("store"),
            targets: &MAP,
            writes: wgpu::ColorWrites::ALL,
            depth: Some(wgpu::CompareFunction::Less),
            constants: &constants_of_shader,
        };
        let seen = Pass { layout: &picture_layout, vertex: "from_eye", targets: &[gpu::PICTURE], ..mesh };
        Ok(Self {
            store: mesh.pipeline(device),
            halve: Pass {
                label: "halve",
                layout: &halve_layout,
                vertex: "whole",
                mesh: false,
                fragment: Some("halve"),
                depth: None,
                ..mesh
            }
            .pipeline(device),
            depth_alone: Pass {
                label: "depth",
                fragment: Some("depth_alone"),
                writes: wgpu::ColorWrites::empty(),
                ..seen
            }
            .pipeline(device),
            picture: Pass {
                label: "translucent picture",
                fragment: Some("picture"),
                depth: Some(wgpu::CompareFunction::LessEqual),
                ..seen
            }
            .pipeline(device),
            layers: (0..MAX_LIGHTS as u32)
                .map(|layer| Layer::new(device, &halve_layout, &textures, layer))
                .collect(),
            map_group: gpu::bind(
                device,
                "translucent shadow map",
                &map_layout,
                &[(0, scene.as_entire_binding())],
            ),
            map_depth: gpu::view(&depth, Dimension::D2),
            settings,
            medium: None,
            lights: 0,
            scene,
            constants,
            textures,
            picture_group,
        })
    }

    pub fn prepare(&mut self, queue: &wgpu::Queue, frame: &Frame<'_>) -> Result<(), Error> {
        let scene = SceneLayout::new(frame, self.settings.map)?;
        let shadowless = |light: &Light| match light {
            Light::Directional(sun) => !sun.shadow,
            Light::Point(lamp) => !lamp.shadow,
            _ => false,
        };
        if let Some(index) = frame.lights.iter().position(shadowless) {
            let problem = "casts no shadow, but a map holds only what its light sees";
            return Err(Error::Light { index, problem, remedy: "let it cast one" });
        }
        if self.medium != Some(frame.medium) {
            queue.write_buffer(&self.constants, 0, bytemuck::bytes_of(&MediumLayout::new(&frame.medium)));
            self.medium = Some(frame.medium);
        }
        self.lights = scene.light_count;
        queue.write_buffer(&self.scene, 0, bytemuck::bytes_of(&scene));
        Ok(())
    }

    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder, geometry: &Geometry, target: &Target) {
        for (index, layer) in (0..self.lights).zip(&self.layers) {
            self.draw_map(encoder, geometry, index, layer);
        }
        let mut pass =
            gpu::begin(encoder, "translucent picture", [&target.picture_view], Some(&target.depth_view));
        pass.set_bind_group(0, &self.picture_group, &[]);
        // Sums are dear: only what is seen makes them.
        drop_in(&mut pass, &self.depth_alone, geometry);
        drop_in(&mut pass, &self.picture, geometry);
    }

    fn draw_map(&self, encoder: &mut wgpu::CommandEncoder, geometry: &Geometry, index: u32, layer: &Layer) {
        let [first, rest @ ..] = layer.targets.as_slice() else { return };
        {
            let mut pass =
                gpu::begin(encoder, "translucent shadow map", first.each_ref(), Some(&self.map_depth));
            pass.set_pipeline(&self.store);
            pass.set_bind_group(0, &self.map_group, &[]);
            geometry.draw(&mut pass, index);
        }
        for (target, finer) in rest.iter().zip(&layer.finer) {
            let mut pass = gpu::begin(encoder, "halve", target.each_ref(), None);
            pass.set_pipeline(&self.halve);
            pass.set_bind_group(0, finer, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}

fn drop_in(pass: &mut wgpu::RenderPass<'_>, pipeline: &wgpu::RenderPipeline, geometry: &Geometry) {
    pass.set_pipeline(pipeline);
    geometry.draw(pass, 0);
}

impl Layer {
    fn new(
        device: &wgpu::Device,
        halve: &wgpu::BindGroupLayout,
        textures: &[wgpu::Texture; 2],
        layer: u32,
    ) -> Self {
        let levels = textures[0].mip_level_count();
        let one = |level, dimension| {
            textures.each_ref().map(|texture| gpu::level(texture, dimension, layer, level))
        };
        let finer = (0..levels - 1).map(|level| {
            let [entering, depths] = one(level, Dimension::D2Array);
            let resources = [
                (2, wgpu::BindingResource::TextureView(&entering)),
                (3, wgpu::BindingResource::TextureView(&depths)),
            ];
            gpu::bind(device, "halve", halve, &resources)
        });
        Self { finer: finer.collect(), targets: (0..levels).map(|level| one(level, Dimension::D2)).collect() }
    }
}
