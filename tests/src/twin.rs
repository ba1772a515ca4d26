//! The same scene for the CPU twins.

use crate::Fixture;
use glam::{DMat4, DVec3, Mat4};
use translume::{Deformation, Frame, Light, Lighting, Medium, Profile};
use translume_mesh::Warp;
use translume_reference::gather::{Gather, Source};
use translume_reference::profile::Numeric;
use translume_reference::{Surface, deform};

/// Where a body is and how it is bent.
#[derive(Clone, Debug)]
pub struct Pose {
    /// Model space to world space.
    pub model: Mat4,
    /// One weight per morph target.
    pub weights: Vec<f32>,
    /// One matrix per joint of the mesh's skin, or none for joints at rest.
    pub joints: Vec<[[f32; 4]; 4]>,
    /// Inflation, twist and bend.
    pub warp: Warp,
}

impl Pose {
    /// As loaded, for a mesh with this many morph targets.
    #[must_use]
    pub fn rest(targets: usize) -> Self {
        Self { model: Mat4::IDENTITY, weights: vec![0.0; targets], joints: Vec::new(), warp: Warp::default() }
    }

    /// The frame that shows this pose in this light.
    #[must_use]
    pub fn frame<'a>(&'a self, lights: &'a [Light]) -> Frame<'a> {
        let deformation = if self.joints.is_empty() {
            Deformation::Morph(&self.weights)
        } else {
            Deformation::Pose { weights: &self.weights, joints: &self.joints }
        };
        Frame {
            model: self.model.to_cols_array_2d(),
            deformation,
            warp: self.warp,
            lighting: Lighting::Lights(lights),
            casters: None,
            view: None,
        }
    }
}

impl Fixture {
    /// Vertex positions of a pose, mm.
    #[must_use]
    pub fn twin_positions(&self, pose: &Pose) -> Vec<[f64; 3]> {
        let weights: Vec<f64> = pose.weights.iter().copied().map(f64::from).collect();
        let joints: Vec<_> =
            pose.joints.iter().map(|joint| joint.map(|column| column.map(f64::from))).collect();
        let model = pose.model.as_dmat4();
        let deformed = deform::Pose { weights: &weights, joints: &joints, warp: pose.warp };
        deform::posed(&self.model.mesh, &deformed, 1.0)
            .into_iter()
            .map(|p| (model.transform_point3(p.into()) * self.mm_per_unit).to_array())
            .collect()
    }

    /// Vertex normals of a pose. A mesh that nothing deforms keeps its own.
    #[must_use]
    pub fn twin_normals(&self, pose: &Pose, positions: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let model = pose.model.as_dmat4();
        let mesh = &self.model.mesh;
        if mesh.targets.is_empty() && mesh.skin.is_none() && pose.warp.is_identity() {
            let normal = DMat4::transpose(&model.inverse());
            let turned = mesh.normals.iter().map(|n| normal.transform_vector3(DVec3::from(n.map(f64::from))));
            return turned.map(|n| n.normalize().to_array()).collect();
        }
        let winding = model.determinant().signum();
        deform::normals(mesh, positions).into_iter().map(|n| n.map(|x| x * winding)).collect()
    }

    /// The surface of a pose that does not mirror.
    #[must_use]
    pub fn twin_surface(&self, pose: &Pose) -> Surface {
        let positions = self.twin_positions(pose);
        let normals = self.twin_normals(pose, &positions);
        Surface::new(positions, normals, self.model.mesh.triangles.clone(), self.flat_normals)
    }

    /// What the twin gathers, averaged over `samples`² points of each texel.
    #[must_use]
    pub fn twin_sources(&self, pose: &Pose, lights: &[Light], samples: u32) -> Vec<Source> {
        let lights: Vec<_> = lights.iter().map(|each| light(each, self.mm_per_unit)).collect();
        self.twin_sources_lit(pose, &lights, [samples, 16])
    }

    /// The same in lights of the twin, which also knows maps of the environment, with `rays`² rays to each area light or sky.
    #[must_use]
    pub fn twin_sources_lit(
        &self,
        pose: &Pose,
        lights: &[translume_reference::Light],
        [samples, rays]: [u32; 2],
    ) -> Vec<Source> {
        let rest = deform::positions(&self.model.mesh, &[], self.mm_per_unit);
        let gather = Gather {
            atlas: &self.model.atlas,
            rest: &rest,
            mm_per_unit: self.mm_per_unit,
            surface: &self.twin_surface(pose),
            lights,
            boundary: translume_twin::boundary(self.body.profile(), self.body.medium()),
            samples,
            rays,
        };
        gather.run()
    }
}

/// A light in millimetres.
///
/// # Panics
/// For a kind of light the twins do not know.
#[must_use]
pub fn light(light: &Light, mm_per_unit: f64) -> translume_reference::Light {
    translume_twin::light(light, mm_per_unit).unwrap_or_else(|| panic!("the twins do not know {light:?}"))
}

/// Any profile of each channel, by the twin's own quadrature.
///
/// # Panics
/// For a kind of profile the twins do not know.
#[must_use]
pub fn profiles(profile: &Profile, medium: &Medium) -> [Numeric; 3] {
    translume_twin::profiles(profile, medium).unwrap_or_else(|| panic!("the twins do not know {profile:?}"))
}

/// Irradiance of sources.
#[must_use]
pub fn luminous(sources: &[Source]) -> Vec<[f64; 3]> {
    sources.iter().map(|source| source.irradiance).collect()
}

/// Σ value · area over the texels.
#[must_use]
pub fn sum(values: &[[f64; 3]], sources: &[Source]) -> [f64; 3] {
    let each = values.iter().zip(sources).map(|(value, source)| DVec3::from(*value) * source.area);
    each.sum::<DVec3>().to_array()
}
