//! Other methods of real-time translucency, to be measured beside translume. Where a paper leaves a choice, or was not to be had, docs/method.md
//! says what was chosen.
//!
//! | rival | how light gets from where it enters to where it leaves |
//! | --- | --- |
//! | [`TranslucentShadowMap`] | every fragment sums the dipole over a picture of the body from the light, coarser further out |
//! | [`ScreenSpace`] | every pixel averages irradiance over a disc of the picture; what comes through goes by thickness |
//!
//! Both draw L = F_t(η, ω_o)·B/π/(1 − F_dr,ext), as `translume::Composite` does with all profiles but the paper's dipole. What each can and
//! cannot do: docs/method.md.
//!
//! ```no_run
//! # fn example(device: &translume::wgpu::Device, queue: &translume::wgpu::Queue, frame: &translume_rivals::Frame<'_>,
//! #     mesh: (&[[f32; 4]], &[[f32; 4]], &[[u32; 3]])) -> Result<(), translume_rivals::Error> {
//! use translume_rivals::{Geometry, Renderer, Rival, ScreenSpace};
//!
//! let (positions, normals, triangles) = mesh;
//! let geometry = Geometry::new(device, queue, positions.len(), triangles)?;
//! let mut renderer = Renderer::new(device, Rival::ScreenSpace(ScreenSpace::default()), [512, 512])?;
//!
//! // each frame
//! geometry.write(queue, positions, normals)?;
//! renderer.prepare(queue, frame)?;
//! let mut encoder = device.create_command_encoder(&Default::default());
//! renderer.encode(&mut encoder, &geometry);
//! queue.submit([encoder.finish()]);
//! let radiance = renderer.picture();
//! # let _ = radiance; Ok(()) }
//! ```

mod dipole;
mod error;
mod geometry;
mod gpu;
#[cfg(test)]
mod layout_tests;
mod scene;
mod screen_space;
mod translucent_shadow_map;

pub use error::Error;
pub use geometry::Geometry;
pub use scene::{Frame, MAX_LIGHTS};
pub use screen_space::ScreenSpace;
pub use translucent_shadow_map::TranslucentShadowMap;

use screen_space::Screen;
use translucent_shadow_map::Maps;
use translume::wgpu;

/// The WGSL of [`TranslucentShadowMap`], to be joined by newlines.
pub const TRANSLUCENT_SHADOW_MAP: [&str; 3] = [
    translume_shaders::MATERIAL,
    include_str!("../shaders/scene.wgsl"),
    include_str!("../shaders/translucent_shadow_map.wgsl"),
];
/// The WGSL of [`ScreenSpace`], to be joined by newlines.
pub const SCREEN_SPACE: [&str; 3] = [
    translume_shaders::MATERIAL,
    include_str!("../shaders/scene.wgsl"),
    include_str!("../shaders/screen_space.wgsl"),
];

/// Which method, and how well.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Rival {
    /// Dachsbacher, Stamminger 2003.
    TranslucentShadowMap(TranslucentShadowMap),
    /// Christensen, Burley 2015 in screen space, after Golubev 2018.
    ScreenSpace(ScreenSpace),
}

impl std::fmt::Display for Rival {
    /// As in tables.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::TranslucentShadowMap(settings) => {
                write!(f, "translucent shadow map, {} samples of {}²", settings.samples(), settings.map)?;
                f.write_str(if settings.displaced { ", displaced" } else { "" })
            }
            Self::ScreenSpace(settings) => {
                write!(f, "screen space, {} samples", settings.samples)?;
                f.write_str(if settings.transmission { "" } else { ", opaque" })
            }
        }
    }
}

/// A method, and pictures of one size.
pub struct Renderer {
    kind: Kind,
    target: Target,
}

enum Kind {
    Maps(Box<Maps>),
    Screen(Box<Screen>),
}

/// What is drawn into.
pub(crate) struct Target {
    picture: wgpu::Texture,
    picture_view: wgpu::TextureView,
    depth_view: wgpu::TextureView,
}

impl Renderer {
    /// Compiles the pipelines of a method and makes all its textures; later frames allocate nothing.
    ///
    /// # Errors
    /// [`Error::Setting`] names the number that cannot be.
    pub fn new(device: &wgpu::Device, rival: Rival, [width, height]: [u32; 2]) -> Result<Self, Error> {
        let limit = device.limits().max_texture_dimension_2d;
        check("width", width, 1, limit)?;
        check("height", height, 1, limit)?;
        let dimension = wgpu::TextureViewDimension::D2;
        let target = |format| gpu::target(device, "rival picture", format, [width, height, 1], 1);
        let picture = target(gpu::PICTURE);
        Ok(Self {
            kind: match rival {
                Rival::TranslucentShadowMap(settings) => Kind::Maps(Box::new(Maps::new(device, settings)?)),
                Rival::ScreenSpace(settings) => {
                    Kind::Screen(Box::new(Screen::new(device, settings, [width, height])?))
                }
            },
            target: Target {
                picture_view: gpu::view(&picture, dimension),
                depth_view: gpu::view(&target(gpu::DEPTH), dimension),
                picture,
            },
        })
    }

    /// Takes over and uploads the inputs of the next frame.
    ///
    /// # Errors
    /// [`Error`] names the light, the coefficient or what else cannot be. The last frame then stays.
    pub fn prepare(&mut self, queue: &wgpu::Queue, frame: &Frame<'_>) -> Result<(), Error> {
        match &mut self.kind {
            Kind::Maps(maps) => maps.prepare(queue, frame),
            Kind::Screen(screen) => screen.prepare(queue, frame),
        }
    }

    /// Records everything that a frame takes: maps, irradiance, picture.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder, geometry: &Geometry) {
        match &self.kind {
            Kind::Maps(maps) => maps.encode(encoder, geometry, &self.target),
            Kind::Screen(screen) => screen.encode(encoder, geometry, &self.target),
        }
    }

    /// Radiance of every pixel, `Rgba32Float`, linear RGB; alpha is 1 where the body is, else 0.
    #[must_use]
    pub fn picture(&self) -> &wgpu::Texture {
        &self.target.picture
    }

    /// What the picture was made of, for tools and tests, in `readback`'s sense. Of [`TranslucentShadowMap`]: what enters through a unit of
    /// map over what arrives, times normal and 1 (`Rgba16Float`), and times depth (`R16Float`), a layer per light. Of [`ScreenSpace`]:
    /// irradiance and depth in mm (`Rgba32Float`), and radiance over exitance (`R32Float`), per pixel.
    #[must_use]
    pub fn intermediates(&self) -> &[wgpu::Texture; 2] {
        match &self.kind {
            Kind::Maps(maps) => &maps.textures,
            Kind::Screen(screen) => &screen.pixels,
        }
    }
}

fn check(field: &'static str, value: u32, least: u32, most: u32) -> Result<(), Error> {
    if (least..=most).contains(&value) {
        return Ok(());
    }
    Err(Error::Setting { field, value: value.into(), range: format!("from {least} to {most}") })
}
