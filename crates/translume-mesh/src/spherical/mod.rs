//! Any closed surface without handles, laid around a sphere or an egg: the same triangles, none turned over.
//!
//! ```
//! # #[cfg(feature = "builtin")] {
//! use translume_mesh::{builtin, spherical};
//!
//! let mesh = builtin::cuboid([0.0; 3], [20.0, 10.0, 10.0], [8, 4, 4]);
//! let laid = spherical::to_egg(&mesh, &spherical::EggOptions::default(), |_| true)?;
//! assert_eq!(laid.mesh.targets[0].name, "egg");
//! assert_eq!(laid.report.flipped, 0);
//! # }
//! # Ok::<_, translume_mesh::spherical::SphericalError>(())
//! ```
//!
//! Areas stay as even as the shape allows, which matters for light and keeps thin parts (ears) from shrinking to nothing:
//! a conformal map would shrink them exponentially, and f32 could not tell their triangles apart.
//!
//! | module | what it does |
//! | --- | --- |
//! | `surface` | from a mesh to one closed surface, or the reason why not |
//! | `coarsen` | fewer triangles, and back |
//! | `cover` | around the egg, coarse to fine |
//! | `distortion` | what is made small on the way |
//! | `turn` | which way the egg faces |
//! | `ovoid` | the egg itself |
//! | `laid` | the map in f32, without a triangle turned over |
//! | `figures` | how well it went |
//!
//! Source: Praun and Hoppe 2003, "Spherical parametrization and remeshing".

pub(crate) mod coarsen;
pub(crate) mod cover;
mod distortion;
mod error;
mod figures;
mod laid;
pub(crate) mod ovoid;
mod surface;
mod turn;

pub use error::SphericalError;
pub use figures::SphericalReport;

use crate::mesh::{Mesh, MorphTarget};
use crate::progress::{Progress, Stopwatch};
use crate::repair::check::check;
use crate::repair::fill_holes;
use cover::Cover;
use laid::settle;
use ovoid::Ovoid;
use surface::Surface;

/// What egg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EggOptions {
    /// Radius at half the height, model units, finite and above 0; `None` for a size half way (by geometric mean) between
    /// the egg of the same area as the mesh and that of the same volume.
    pub radius: Option<f32>,
    /// Height over the width at half the height, 0.25..=4.
    pub slenderness: f32,
    /// How much slimmer the upper half is, −0.5..=0.5: the radius carries e^(−taper·y), y from −1 at the bottom to 1 at the
    /// top. The egg is convex within this range.
    pub taper: f32,
}

impl EggOptions {
    /// A ball.
    pub const SPHERE: Self = Self { radius: None, slenderness: 1.0, taper: 0.0 };
}

impl Default for EggOptions {
    /// A hen's egg, blunt end down: that of the built-in creature.
    fn default() -> Self {
        Self { radius: None, slenderness: 41.0 / 31.0, taper: 0.2 }
    }
}

/// An upright egg: (r / (radius · e^(−taper · y)))² + y² = 1 with r the distance from its axis and y the height above its
/// centre over half its height. A ball where `taper` is 0 and `height` twice `radius`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Egg {
    /// The middle of its axis, model units.
    pub center: [f32; 3],
    /// Radius at half the height, model units.
    pub radius: f32,
    /// Height, model units.
    pub height: f32,
    /// How much slimmer the upper half is.
    pub taper: f32,
}

/// A mesh that can become an egg.
#[derive(Clone, Debug, PartialEq)]
pub struct Spherical {
    /// The mesh, its holes filled, with one more morph target, "sphere" or "egg", that lays it around the egg at weight 1.
    pub mesh: Mesh,
    /// Where that target lays it.
    pub egg: Egg,
    /// Figures of merit.
    pub report: SphericalReport,
}

/// Lays a clean mesh around a ball: [`to_egg`] with [`EggOptions::SPHERE`] and a target "sphere".
///
/// # Errors
/// As [`to_egg`].
pub fn to_sphere(mesh: &Mesh, progress: impl FnMut(Progress) -> bool) -> Result<Spherical, SphericalError> {
    lay(mesh, "sphere", &EggOptions::SPHERE, progress)
}

/// Lays a clean mesh around an egg, as a morph target of the mesh itself. Deterministic.
///
/// Holes are filled first ([`fill_holes`]), which may add triangles and vertices after the others. Vertices at the same
/// position, copies made for normals or texture coordinates, move together. The egg stands on the lowest point of the mesh
/// at rest, in the middle of its bounding box in x and z, and is turned so that parts of the mesh stay on their side.
///
/// When `progress` returns `false` the work ends with [`SphericalError::Cancelled`]. Takes a second or two for 70,000
/// triangles.
///
/// # Errors
/// [`SphericalError`]: the mesh is not one closed and consistently oriented surface without handles, facing outwards; or
/// an option is out of range, or f32 too coarse for the triangles.
pub fn to_egg(
    mesh: &Mesh,
    options: &EggOptions,
    progress: impl FnMut(Progress) -> bool,
) -> Result<Spherical, SphericalError> {
    lay(mesh, "egg", options, progress)
}

fn lay(
    mesh: &Mesh,
    target: &str,
    options: &EggOptions,
    mut progress: impl FnMut(Progress) -> bool,
) -> Result<Spherical, SphericalError> {
    let start = Stopwatch::start();
    check_options(options)?;
    check(mesh)?;
    let mut mesh = mesh.clone();
    let holes_filled = fill_holes(&mut mesh, usize::MAX);
    let surface = Surface::new(&mesh)?;
    let egg = egg(&mesh, &surface, options);
    let name = mesh.name.clone();
    let mut report_progress = |stage, done, total| {
        let proceed = progress(Progress { stage, done, total });
        proceed.then_some(()).ok_or_else(|| SphericalError::Cancelled { mesh: name.clone() })
    };

    report_progress("coarsening", 0, None)?;
    let mut cover = cover(&mesh, &surface, &egg);
    while cover.refine() {
        report_progress("laying", cover.laid(), Some(surface.positions.len()))?;
    }
    report_progress("checking", 0, None)?;
    let laid = settle(&mesh, &surface, &egg, &mut cover)?;
    let measured = SphericalReport::measure(&mesh, &laid.positions);
    mesh.targets.push(MorphTarget { name: target.into(), position_deltas: laid.deltas });
    let leaning = laid.leaning;
    let report = SphericalReport { holes_filled, leaning, seconds: start.seconds(), ..measured };
    Ok(Spherical { mesh, egg, report })
}

fn check_options(options: &EggOptions) -> Result<(), SphericalError> {
    let EggOptions { radius, slenderness, taper } = *options;
    let (slendernesses, tapers) = (0.25..=4.0, -0.5..=0.5);
    let wrong = |option, value, range| Err(SphericalError::Option { option, value, range });
    match radius {
        Some(radius) if !(radius.is_finite() && radius > 0.0) => {
            wrong("radius", radius, "a finite number above 0")
        }
        _ if !slendernesses.contains(&slenderness) => wrong("slenderness", slenderness, "0.25..=4"),
        _ if !tapers.contains(&taper) => wrong("taper", taper, "-0.5..=0.5"),
        _ => Ok(()),
    }
}

fn egg(mesh: &Mesh, surface: &Surface, options: &EggOptions) -> Egg {
    let unit = Ovoid { radius: 1.0, half: options.slenderness.into(), taper: options.taper.into() };
    let fitting = || {
        let by_area = (surface.area / unit.area()).sqrt();
        let by_volume = (surface.volume / unit.volume()).cbrt();
        (by_area * by_volume).sqrt() as f32
    };
    let radius = options.radius.unwrap_or_else(fitting);
    let height = 2.0 * radius * options.slenderness;
    let (low, high) = mesh.bounds().unwrap_or_default();
    let center = [f32::midpoint(low[0], high[0]), low[1] + height / 2.0, f32::midpoint(low[2], high[2])];
    Egg { center, radius, height, taper: options.taper }
}

impl Egg {
    fn ovoid(&self) -> Ovoid {
        Ovoid { radius: self.radius.into(), half: f64::from(self.height) / 2.0, taper: self.taper.into() }
    }
}

/// The surface about its middle and about one unit across, so that squares of small and large lengths fit f32.
fn cover(mesh: &Mesh, surface: &Surface, egg: &Egg) -> Cover {
    let scale = f64::from(mesh.diagonal()).recip();
    let rest = surface.positions.iter().map(|&p| (p - surface.centroid) * scale).collect();
    Cover::new(egg.ovoid(), rest, &surface.triangles)
}
