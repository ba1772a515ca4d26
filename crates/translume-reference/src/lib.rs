//! CPU ground truth for translume, in double precision and without a GPU: the judge of every stage.
//!
//! | module | what it computes |
//! | --- | --- |
//! | [`medium`], [`fresnel`], [`boundary`], [`dipole`], [`profile`] | the optics: coefficients, exact Fresnel terms, what enters, diffuse reflectance profiles |
//! | [`half_space`] | Monte Carlo of a half-space or slab, which profiles approximate |
//! | [`surface`], [`lights`], [`environment`] | the scene: triangles with ray queries, and what illuminates them |
//! | [`deform`] | positions and normals of a morphed pose |
//! | [`gather`] | position, normal, live area and irradiance of every texel, shadows by ray casting |
//! | [`cluster`] | sums of texels up the tree |
//! | [`scatter`] | radiant exitance from all pairs of texels, with the profile averaged over each source |
//! | [`converged`] | radiant exitance from the triangles themselves: what `scatter` tends to with ever more texels |
//! | [`composite`] | the camera's picture |
//! | [`path`] | the picture without any diffusion model: paths through the body, with the standard error of every pixel |
//! | [`transport`] | radiance from diffusion with the body's own boundary, and what diffusion lacks |
//! | [`metrics`] | how far a picture is from another |
//!
//! The stages carry the names of the GPU stages they judge and share no code with them. Lengths are millimetres,
//! colours linear RGB, angles radians.

pub mod boundary;
pub mod cluster;
pub mod composite;
pub mod converged;
pub mod deform;
mod dice;
pub mod dipole;
pub mod environment;
pub mod fresnel;
pub mod gather;
pub mod half_space;
pub mod lights;
pub mod medium;
pub mod metrics;
pub mod path;
pub mod profile;
mod quadrature;
mod rgb;
pub mod scatter;
pub mod surface;
#[cfg(test)]
mod testing;
pub mod transport;

pub use boundary::Boundary;
pub use dipole::Dipole;
pub use environment::EnvironmentMap;
pub use lights::Light;
pub use medium::Medium;
pub use surface::{Hit, Surface};
