//! Screen-space normalised diffusion, as engines ship it: Golubev 2018, "Efficient Screen-Space Subsurface Scattering Using Burley's
//! Normalized Diffusion in Real-Time"; Golubev 2019, "Sampling Burley's Normalized Diffusion Profiles".
//!
//! reads  the mesh, lights, camera                    writes  a depth map per light, irradiance as the eye sees it, the picture
//! WGSL   `shaders/screen_space.wgsl`

use crate::geometry::Geometry;
use crate::gpu::{self, Pass};
use crate::scene::{Frame, MAX_LIGHTS, SceneLayout, focal};
use crate::{Error, Target, check};
use bytemuck::{Pod, Zeroable};
use translume::wgpu::{self, TextureFormat, TextureViewDimension as Dimension};
use translume::{BurleyFit, Medium};

/// Quality of screen-space diffusion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScreenSpace {
    /// Samples of a pixel's disc, 1..=1024.
    pub samples: u32,
    /// Whether light passes through the body, by its thickness as each light sees it.
    pub transmission: bool,
    /// Whether the disc is turned by another angle at every pixel: noise in place of bands, for engines that blur it over frames.
    pub rotate: bool,
    /// Width of a light's depth map, texels, from 16 to 8192.
    pub map: u32,
}

impl Default for ScreenSpace {
    fn default() -> Self {
        Self { samples: 55, transmission: true, rotate: false, map: 1024 }
    }
}

impl ScreenSpace {
    const MAX_SAMPLES: u32 = 1024;

    fn validate(&self) -> Result<(), Error> {
        check("samples", self.samples, 1, Self::MAX_SAMPLES)?;
        check("map", self.map, 16, 8192)
    }
}

/// As WGSL reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct ProfileLayout {
    pub albedo: [f32; 3],
    pub sample_count: u32,
    pub shape: [f32; 3],
    pub padding0: u32,
    pub focal: [f32; 2],
    pub padding: [u32; 2],
}

/// Irradiance with depth, and the share of what leaves that goes to the eye.
const PIXEL: [TextureFormat; 2] = [TextureFormat::Rgba32Float, TextureFormat::R32Float];

pub(crate) struct Screen {
    settings: ScreenSpace,
    medium: Option<Medium>,
    profile: ProfileLayout,
    lights: u32,
    scene: wgpu::Buffer,
    constants: wgpu::Buffer,
    samples: wgpu::Buffer,
    /// Of the picture's size.
    pub pixels: [wgpu::Texture; 2],
    pixel_views: [wgpu::TextureView; 2],
    map_layers: Vec<wgpu::TextureView>,
    map_group: wgpu::BindGroup,
    light_group: wgpu::BindGroup,
    blur_group: wgpu::BindGroup,
    map: wgpu::RenderPipeline,
    light_up: wgpu::RenderPipeline,
    blur: wgpu::RenderPipeline,
}

impl Screen {
    pub fn new(device: &wgpu::Device, settings: ScreenSpace, size: [u32; 2]) -> Result<Self, Error> {
        settings.validate()?;
        let source = crate::SCREEN_SPACE.join("\n");
        let module = &device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("screen-space diffusion"),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let maps = gpu::texture(wgpu::TextureSampleType::Depth, Dimension::D2Array);
        let pixel = gpu::texture(gpu::float(false), Dimension::D2);
        let map_layout = gpu::layout(device, "depth map", &[(0, gpu::UNIFORM)]);
        let bindings = [(0, gpu::UNIFORM), (1, gpu::UNIFORM), (2, maps)];
        let light_layout = gpu::layout(device, "irradiance", &bindings);
        let bindings = [(1, gpu::UNIFORM), (3, pixel), (4, pixel), (5, gpu::READ)];
        let blur_layout = gpu::layout(device, "diffusion", &bindings);

        let buffer = |label, size, usage| gpu::buffer(device, label, size, usage);
        let scene = buffer("rival scene", size_of::<SceneLayout>() as u64, wgpu::BufferUsages::UNIFORM);
        let constants =
            buffer("rival profile", size_of::<ProfileLayout>() as u64, wgpu::BufferUsages::UNIFORM);
        let samples = buffer("rival samples", 16 * u64::from(settings.samples), wgpu::BufferUsages::STORAGE);
        let [width, height] = size;
        let pixels = PIXEL.map(|format| gpu::target(device, "irradiance", format, [width, height, 1], 1));
        let pixel_views = pixels.each_ref().map(|texture| gpu::view(texture, Dimension::D2));
        let square = [settings.map, settings.map, MAX_LIGHTS as u32];
        let maps = gpu::target(device, "depth maps", gpu::DEPTH, square, 1);
        let all_maps = gpu::view(&maps, Dimension::D2Array);
        let texture = wgpu::BindingResource::TextureView;
        let light_resources =
            [(0, scene.as_entire_binding()), (1, constants.as_entire_binding()), (2, texture(&all_maps))];
        let blur_resources = [
            (1, constants.as_entire_binding()),
            (3, texture(&pixel_views[0])),
            (4, texture(&pixel_views[1])),
            (5, samples.as_entire_binding()),
        ];
        let constants_of_shader = [
            ("TRANSMISSION", f64::from(u8::from(settings.transmission))),
            ("ROTATE", f64::from(u8::from(settings.rotate))),
        ];
        let map = Pass {
            label: "depth map",
            module,
            layout: &map_layout,
            vertex: "from_light",
            mesh: true,
            fragment: None,
            targets: &[],
            writes: wgpu::ColorWrites::ALL,
            depth: Some(wgpu::CompareFunction::Less),
            constants: &constants_of_shader,
        };
        Ok(Self {
            map: map.pipeline(device),
            light_up: Pass {
                label: "irradiance",
                layout: &light_layout,
                vertex: "from_eye",
                fragment: Some("light_up"),
                targets: &PIXEL,
                ..map
            }
            .pipeline(device),
            blur: Pass {
                label: "diffusion",
                layout: &blur_layout,
                vertex: "whole",
                mesh: false,
                fragment: Some("blur"),
                targets: &[gpu::PICTURE],
                depth: None,
                ..map
            }
            .pipeline(device),
            map_layers: (0..MAX_LIGHTS as u32)
                .map(|layer| gpu::level(&maps, Dimension::D2, layer, 0))
                .collect(),
            map_group: gpu::bind(device, "depth map", &map_layout, &light_resources[..1]),
            light_group: gpu::bind(device, "irradiance", &light_layout, &light_resources),
            blur_group: gpu::bind(device, "diffusion", &blur_layout, &blur_resources),
            settings,
            medium: None,
            profile: ProfileLayout::zeroed(),
            lights: 0,
            scene,
            constants,
            samples,
            pixels,
            pixel_views,
        })
    }

    pub fn prepare(&mut self, queue: &wgpu::Queue, frame: &Frame<'_>) -> Result<(), Error> {
        let scene = SceneLayout::new(frame, self.settings.map)?;
        if self.medium != Some(frame.medium) {
            self.set_medium(queue, &frame.medium);
        }
        self.profile.focal = focal(frame, [self.pixels[0].width(), self.pixels[0].height()]);
        self.lights = scene.light_count;
        queue.write_buffer(&self.constants, 0, bytemuck::bytes_of(&self.profile));
        queue.write_buffer(&self.scene, 0, bytemuck::bytes_of(&scene));
        Ok(())
    }

    fn set_medium(&mut self, queue: &wgpu::Queue, medium: &Medium) {
        let shape = BurleyFit::Diffuse.shape(medium);
        self.profile = ProfileLayout {
            albedo: shape.albedo,
            sample_count: self.settings.samples,
            shape: shape.length.map(|d| 1.0 / d),
            ..ProfileLayout::zeroed()
        };
        let widest = shape.length.into_iter().fold(0.0, f32::max);
        let samples = disc(self.settings.samples, widest.into());
        queue.write_buffer(&self.samples, 0, bytemuck::cast_slice(&samples));
        self.medium = Some(*medium);
    }

    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder, geometry: &Geometry, target: &Target) {
        for (index, layer) in (0..self.lights).zip(&self.map_layers) {
            let mut pass = gpu::begin(encoder, "depth map", [], Some(layer));
            pass.set_pipeline(&self.map);
            pass.set_bind_group(0, &self.map_group, &[]);
            geometry.draw(&mut pass, index);
        }
        {
            let pixels = self.pixel_views.each_ref();
            let mut pass = gpu::begin(encoder, "irradiance", pixels, Some(&target.depth_view));
            pass.set_pipeline(&self.light_up);
            pass.set_bind_group(0, &self.light_group, &[]);
            geometry.draw(&mut pass, 0);
        }
        let mut pass = gpu::begin(encoder, "diffusion", [&target.picture_view], None);
        pass.set_pipeline(&self.blur);
        pass.set_bind_group(0, &self.blur_group, &[]);
        pass.draw(0..3, 0..1);
    }
}

/// Samples of a Fibonacci spiral that hold the same energy each of a profile of this length, mm: offset, its length, and 1 over the density
/// of radius and angle.
pub(crate) fn disc(count: u32, length: f64) -> Vec<[f32; 4]> {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let sample = |k: u32| {
        let radius = length * quantile((f64::from(k) + 0.5) / f64::from(count));
        let (sine, cosine) = (golden * f64::from(k)).sin_cos();
        let density = ((-radius / length).exp() + (-radius / (3.0 * length)).exp()) / length;
        [radius * cosine, radius * sine, radius, 1.0 / density].map(|x| x as f32)
    };
    (0..count).map(sample).collect()
}

/// Radius, in lengths d, inside which this share of the energy lies: the root of 1 − (e^(−r) + 3e^(−r/3))/4 = share, by bisection.
fn quantile(share: f64) -> f64 {
    let (mut low, mut high) = (0.0_f64, 200.0_f64);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let enclosed = 1.0 - 0.25 * ((-middle).exp() + 3.0 * (-middle / 3.0).exp());
        if enclosed < share { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_hold_the_same_energy_each() {
        let samples = disc(200, 2.0);
        // Σ R·r/(density·N) is the energy: 1 for the profile itself, by definition of the density.
        let energy = |length: f64| {
            let each = samples.iter().map(|s| {
                let r = f64::from(s[2]);
                ((-r / length).exp() + (-r / (3.0 * length)).exp()) / length * f64::from(s[3])
            });
            each.sum::<f64>() / 200.0
        };
        assert!((energy(2.0) - 1.0).abs() < 1e-6);
        // A narrower one comes out by importance sampling: the midpoint rule of 200 points.
        assert!((energy(1.0) - 1.0).abs() < 5e-3, "{}", energy(1.0));
        let median = f64::from(samples[100][2]);
        let enclosed = |r: f64| 1.0 - 0.25 * ((-r / 2.0).exp() + 3.0 * (-r / 6.0).exp());
        // Half of the energy lies inside of the 100.5th of 200.
        assert!((enclosed(median) - 0.5025).abs() < 1e-6, "{median}");
        assert!((enclosed(1.01 * median) - 0.5025).abs() > 1e-3, "1 % must be noticed");
    }
}
