//! What is lit: bodies whose limits are known.

use glam::Mat4;
use std::f32::consts::PI;
use std::sync::{Arc, OnceLock};
use translume::{AmbientLight, DirectionalLight, Light, Medium};
use translume_mesh::{Atlas, AtlasVertex, Mesh};
use translume_tests::{Model, Pose, Shot, plane, sphere_with};

/// One frame of a body, whichever way it is computed.
#[derive(Clone)]
pub struct Scene {
    pub model: Arc<Model>,
    pub medium: Medium,
    pub mm_per_unit: f32,
    pub pose: Pose,
    pub lights: Vec<Light>,
    /// How often the surface covers a place: what every covering may send there adds up.
    pub faces: f64,
    /// For fragments.
    pub shot: Shot,
    /// Whether it is a ball of radius 50 units under the sky, which paths can be followed through.
    pub round: bool,
}

/// Light of radiance 1 from everywhere. Without shadows, E is the same all over a convex body.
pub fn sky() -> Light {
    Light::Ambient(AmbientLight { shadow: false, half_angle: PI, ..Default::default() })
}

/// From above, a little oblique; E differs from place to place.
pub fn sun() -> Light {
    Light::Directional(DirectionalLight { to_light: [0.3, 0.8, 0.5], ..Default::default() })
}

/// Three channels about a mean free path of 1 mm that absorb a thirtieth, a fifth and a third of it.
pub const USUAL: Medium =
    Medium { sigma_s_prime: [1.0, 0.9, 0.8], sigma_a: [0.03, 0.2, 0.4], ior: 1.3, g: 0.0 };

/// Texels across the atlas of the plane.
pub const CELLS: u32 = 32;

fn once(cell: &'static OnceLock<Arc<Model>>, make: impl FnOnce() -> Arc<Model>) -> Arc<Model> {
    Arc::clone(cell.get_or_init(make))
}

impl Scene {
    /// A sphere of radius 5 mm with texels of 0.7 mm under the sky. On a sphere ∫ R_d(chord) dA is the flat integral up to the diameter, so
    /// that no radial profile gives back more than its total.
    pub fn ball(medium: Medium) -> Self {
        static MODEL: OnceLock<Arc<Model>> = OnceLock::new();
        Self {
            model: once(&MODEL, || sphere_with(32)),
            medium,
            mm_per_unit: 0.1,
            pose: Pose::rest(0),
            lights: vec![sky()],
            faces: 1.0,
            shot: Shot { eye: [60.0, 80.0, 230.0], target: [0.0; 3], fov: 0.5, size: 24 },
            round: true,
        }
    }

    /// A square of texels of 1 mm, evenly lit.
    pub fn plane(medium: Medium) -> Self {
        static MODEL: OnceLock<Arc<Model>> = OnceLock::new();
        let side = CELLS as f32;
        Self {
            model: once(&MODEL, || plane(side, CELLS)),
            mm_per_unit: 1.0,
            // Over the middle, a twelfth of the side to each side.
            shot: Shot { eye: [0.0, 2.0 * side, 0.2 * side], target: [0.0; 3], fov: 0.08, size: 16 },
            round: false,
            ..Self::ball(medium)
        }
    }

    /// Two squares, one `gap` mm below the other, texels of 1 mm. The upper faces up; the lower faces down, or up as well.
    pub fn sheets(medium: Medium, gap: f32, lower_up: bool) -> Self {
        Self {
            model: Arc::new(two_squares(gap, lower_up, 64)),
            lights: vec![from_above()],
            faces: 2.0,
            ..Self::plane(medium)
        }
    }

    pub fn with(mut self, change: impl FnOnce(&mut Self)) -> Self {
        change(&mut self);
        self
    }

    pub fn moved(self, model: Mat4) -> Self {
        self.with(|scene| (scene.pose.model, scene.round) = (model, false))
    }

    pub fn lit(self, lights: &[Light]) -> Self {
        self.with(|scene| (scene.lights, scene.round) = (lights.to_vec(), lights.is_empty()))
    }
}

/// Straight down, so that what faces down stays dark.
pub fn from_above() -> Light {
    Light::Directional(DirectionalLight { to_light: [0.0, 1.0, 0.0], shadow: false, ..Default::default() })
}

/// Texels along a side of each of the two squares.
pub const SHEET: u32 = 30;

/// Sheets whose atlas has this size: texels of 1 mm at 64², a gap of four such texels between the charts.
pub fn two_squares(gap: f32, lower_up: bool, size: u32) -> Model {
    const CELLS: u32 = 6;
    const ATLAS: f32 = 64.0;
    let mut mesh = Mesh { name: "two sheets".to_owned(), ..Mesh::default() };
    let mut vertices = Vec::new();
    for (y, up, left) in [(0.0, true, 0.0), (-gap, lower_up, ATLAS - SHEET as f32)] {
        let first = vertices.len() as u32;
        for k in 0..(CELLS + 1).pow(2) {
            let cell = [k % (CELLS + 1), k / (CELLS + 1)].map(|k| k as f32 * SHEET as f32 / CELLS as f32);
            let uv = [(left + cell[0]) / ATLAS, cell[1] / ATLAS];
            vertices.push(AtlasVertex { xref: vertices.len() as u32, uv });
            let middle = 0.5 * SHEET as f32;
            mesh.positions.push([cell[0] - middle, y, middle - cell[1]]);
            mesh.normals.push([0.0, if up { 1.0 } else { -1.0 }, 0.0]);
        }
        for k in 0..CELLS * CELLS {
            let a = first + k / CELLS * (CELLS + 1) + k % CELLS;
            let [b, c, d] = [a + 1, a + CELLS + 2, a + CELLS + 1];
            let faces = [[a, b, c], [a, c, d]];
            mesh.triangles.extend(if up { faces } else { faces.map(|[a, b, c]| [a, c, b]) });
        }
    }
    let triangles = mesh.triangles.clone();
    let atlas = Atlas::from_uvs(&mesh, size, vertices, triangles).expect("the atlas of two squares");
    Model { mesh, atlas }
}
