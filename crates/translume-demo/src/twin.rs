//! What paths run through.

use crate::scene::Shape;
use translume::Medium;
use translume_reference::Surface;
use translume_reference::path::{Ball, Block, Closed, PathError, Shape as Body, Volume};

/// A body: exact where the scene says how, else the surface.
pub fn shape<'a>(
    exact: Option<&Shape>,
    surface: &'a Surface,
    mm_per_unit: f64,
) -> Result<Box<dyn Body + 'a>, PathError> {
    let mm = |p: [f32; 3]| p.map(|x| f64::from(x) * mm_per_unit);
    Ok(match exact {
        Some(Shape::Sphere { center, radius }) => {
            Box::new(Ball { center: mm(*center), radius: f64::from(*radius) * mm_per_unit })
        }
        Some(Shape::Box { min, max }) => Box::new(Block { low: mm(*min), high: mm(*max) }),
        _ => Box::new(Closed::new(surface)?),
    })
}

/// A medium without the reduction that diffusion makes.
pub fn volume(medium: &Medium, g: f32) -> Volume {
    Volume::new(&translume_twin::medium(medium), g.into())
}
