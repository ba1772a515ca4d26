//! Pictures by paths: light transport in a homogeneous medium without a diffusion model, and how sure each pixel is.
//!
//! A path starts at the eye, runs straight for exponentially distributed distances, scatters by Henyey and Greenstein's phase function and
//! ends where it leaves the body for good. Nothing is approximated; the estimate is wrong by its noise alone, whose standard error is kept
//! for each pixel and channel.
//!
//! * **Index-matched** (η = 1): every collision is connected to every light by a straight line, with the exact optical depth of all that is
//!   inside on the way. Lights of some extent are also met by paths that leave, and both count by the balance heuristic.
//! * **Smooth dielectric** (other η): paths are refracted and reflected by Fresnel's equations, and meet lights when they leave. A
//!   direction or a point can never be met, so such lights are refused.
//!
//! Light and background are never seen directly, and what was not scattered or is mirrored by the surface on the way from the eye is not part
//! of the picture: what is left is the subsurface component. Light is shadowed by the body whatever `shadow` says, refracted by faces
//! whatever normals they are shaded with, and lights stand outside the body.

mod connect;
mod emit;
mod estimate;
mod facet;
mod fan;
mod film;
mod grid;
mod guide;
pub(crate) mod lamp;
mod lists;
mod mesh;
mod photons;
mod shape;
mod trace;
mod volume;
mod walk;
pub(crate) mod way;

pub use estimate::Estimate;
pub use fan::{Fan, Vantage};
pub use mesh::Closed;
pub use shape::{Ball, Block, Crossing, Shape};
pub use trace::{Progress, Source, Trace};
pub use volume::Volume;

use crate::Light;
use crate::composite::Camera;
use emit::Bounds;
use lamp::Lamp;
use volume::Group;

/// Why no path is followed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PathError {
    /// The surface does not enclose a volume.
    #[error(
        "{edges} edges of the surface lack a triangle on one side; close the mesh, as paths must know inside from outside"
    )]
    Open {
        /// Edges without a counterpart.
        edges: usize,
    },
    /// A coefficient is not in its range.
    #[error("{what} is {value}, but must be {range}")]
    Volume {
        /// Which one.
        what: &'static str,
        /// What it is.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// No path can meet a light without extent through a boundary that refracts.
    #[error(
        "light {index} is a direction or a point, which no path can meet through a surface that refracts (index {ior:.3}); \
         give it an extent, as a sphere, a rectangle or a cone of the sky, or take an index of 1"
    )]
    Refracted {
        /// Number of the light, from 0.
        index: usize,
        /// The index of refraction.
        ior: f64,
    },
}

/// A lit body.
pub struct PathTracer<'a> {
    shape: &'a dyn Shape,
    volume: Volume,
    groups: Vec<Group>,
    lamps: Vec<Lamp>,
    /// Of lights that connections run towards through one point or along one direction.
    fans: Vec<Option<Fan>>,
    bounds: Bounds,
}

impl<'a> PathTracer<'a> {
    /// Lights a body.
    ///
    /// # Errors
    /// [`PathError::Volume`] for a coefficient out of range, [`PathError::Refracted`] for a directional, point or spot light where the index
    /// of refraction is not 1.
    pub fn new(shape: &'a dyn Shape, volume: Volume, lights: &[Light]) -> Result<Self, PathError> {
        check(&volume)?;
        let lamps: Vec<Option<Lamp>> = lights.iter().map(Lamp::new).collect();
        let is_point = |lamp: &Option<Lamp>| lamp.as_ref().is_some_and(Lamp::has_no_extent);
        match lamps.iter().position(is_point) {
            Some(index) if volume.ior != 1.0 => Err(PathError::Refracted { index, ior: volume.ior }),
            _ => {
                let lamps: Vec<Lamp> = lamps.into_iter().flatten().collect();
                let fan = |lamp: &Lamp| lamp.vantage().and_then(|vantage| shape.fan(vantage));
                let fans = lamps.iter().map(fan).collect();
                let [low, high] = shape.extent();
                let bounds = Bounds { center: 0.5 * (low + high), radius: 0.5 * low.distance(high) };
                Ok(Self { shape, volume, groups: volume.groups(), lamps, fans, bounds })
            }
        }
    }

    /// Starts a picture. The camera stands outside the body.
    #[must_use]
    pub fn trace(&'a self, camera: Camera, seed: u64) -> Trace<'a> {
        Trace::new(self, camera, seed)
    }

    fn is_matched(&self) -> bool {
        self.volume.ior == 1.0
    }
}

fn check(volume: &Volume) -> Result<(), PathError> {
    let fail = |what, value, range| Err(PathError::Volume { what, value, range });
    for (what, values) in [("sigma_s", volume.sigma_s), ("sigma_a", volume.sigma_a)] {
        if let Some(value) = values.into_iter().find(|value| !(0.0..f64::INFINITY).contains(value)) {
            return fail(what, value, "finite and not negative, in 1/mm");
        }
    }
    if !(volume.g > -1.0 && volume.g < 1.0) {
        return fail("g", volume.g, "between −1 and 1");
    }
    if !(volume.ior > 0.0 && volume.ior.is_finite()) {
        return fail("the index of refraction", volume.ior, "positive");
    }
    Ok(())
}
