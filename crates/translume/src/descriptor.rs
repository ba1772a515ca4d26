//! What a body is made of.

use crate::{Error, Medium, Method, Profile};
use translume_mesh::{Atlas, Mesh};

/// What a body is made of and how it is computed.
#[derive(Clone, Copy, Debug)]
pub struct BodyDescriptor<'a> {
    /// The mesh, clean (see [`translume_mesh::repair`]).
    pub mesh: &'a Mesh,
    /// Its atlas.
    pub atlas: &'a Atlas,
    /// The medium.
    pub medium: Medium,
    /// The profile.
    pub profile: Profile,
    /// How the scatter sum is evaluated.
    pub method: Method,
    /// Millimetres per world unit: 1000 for an engine that counts in metres. Finite, > 0.
    pub mm_per_unit: f32,
    /// Whether each triangle keeps its own normal instead of the smooth vertex normals.
    pub flat_normals: bool,
    /// Width of a depth map in texels, from 16 to the device's `max_texture_dimension_2d`.
    pub shadow_resolution: u32,
}

impl<'a> BodyDescriptor<'a> {
    /// Defaults for everything but the shape: marble, normalised dipole, tree, metres, smooth normals, depth maps of 1024².
    #[must_use]
    pub fn new(mesh: &'a Mesh, atlas: &'a Atlas) -> Self {
        Self {
            mesh,
            atlas,
            medium: Medium::default(),
            profile: Profile::default(),
            method: Method::default(),
            mm_per_unit: 1000.0,
            flat_normals: false,
            shadow_resolution: 1024,
        }
    }

    /// Checks everything but the shape. `limit` is the widest texture of the device.
    pub(crate) fn validate(&self, limit: u32) -> Result<(), Error> {
        self.medium.validate()?;
        self.method.validate()?;
        let fail =
            |problem: String, remedy| Err(Error::Body { mesh: self.mesh.name.clone(), problem, remedy });
        if !(self.mm_per_unit > 0.0 && self.mm_per_unit.is_finite()) {
            let problem = format!("{} mm per unit", self.mm_per_unit);
            return fail(problem, "give a finite scale above 0");
        }
        if !(16..=limit).contains(&self.shadow_resolution) {
            let problem = format!("depth maps of {}²", self.shadow_resolution);
            return fail(problem, "give a resolution between 16 and the device's max_texture_dimension_2d");
        }
        Ok(())
    }
}
