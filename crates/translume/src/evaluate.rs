//! Where radiant exitance is evaluated, and for which pictures.

use crate::{Camera, Error};
use glam::{Mat4, Vec3};
use std::collections::HashMap;
use translume_mesh::{Atlas, Mesh};

/// Where the last step of the scatter runs: the sum over near sources, which is more than half of its cost. What groups of receivers
/// share is the same for all.
///
/// A texel stands in the sum as a disc. From the middle of a texel the discs around it close without gaps; from elsewhere they do only where
/// light wanders further than a texel is wide. Points therefore need a mean free path of a texel or more: below that single texels show.
///
/// ```no_run
/// # fn example(device: &translume::wgpu::Device, queue: &translume::wgpu::Queue, body: &mut translume::Body) -> Result<(), translume::Error> {
/// use translume::Evaluate;
///
/// // The library draws this body, so it may choose.
/// body.set_evaluate(Evaluate::Auto)?;
/// # Ok(()) }
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Evaluate {
    /// At every texel, for any number of views and for hosts that sample the texture ("TTF").
    #[default]
    PerTexel,
    /// At every vertex, interpolated over triangles ("VTF", Gong et al. 2008): cheap where vertices are few, and right only where they
    /// are closer together than light wanders. [`Composite`](crate::Composite) draws it, and hosts find it in
    /// [`Outputs::vertex_exitance`](crate::Outputs::vertex_exitance); the texture is not written.
    PerVertex,
    /// At every fragment that [`Composite`](crate::Composite) draws, behind a depth pass where the target has depth ("FTF", Gong et al.
    /// 2008). The texture is not written.
    PerFragment,
    /// For bodies that [`Composite`](crate::Composite) draws: whichever of these has the fewest receivers and loses nothing. Points only where
    /// the profile is smooth over a texel (the shortest mean free path is longer; never for those without bound at r = 0); vertices only
    /// where edges are on average shorter than a texel or than half that path; fragments only with a
    /// [`Frame::view`](crate::Frame::view). [`Body::evaluated`](crate::Body::evaluated) says which.
    Auto,
}

impl Evaluate {
    /// Every place with its name.
    pub const NAMES: &[(&'static str, Self)] = &[
        ("texel", Self::PerTexel),
        ("vertex", Self::PerVertex),
        ("fragment", Self::PerFragment),
        ("auto", Self::Auto),
    ];
}

/// The only picture of a body in a frame.
///
/// ```
/// # fn example(camera: translume::Camera, body: &translume::Body) {
/// use translume::{Frame, View};
///
/// let view = View { camera, pixels: [1920, 1080] };
/// if body.covered(&view) > 0.0 {
///     let frame = Frame { view: Some(view), ..Default::default() };
/// }
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// From where it is taken.
    pub camera: Camera,
    /// Its width and height, pixels.
    pub pixels: [u32; 2],
}

impl View {
    /// Checks the camera.
    pub(crate) fn validate(&self) -> Result<(), Error> {
        let finite = Mat4::from_cols_array_2d(&self.camera.view_projection).is_finite()
            && Vec3::from(self.camera.eye).is_finite();
        if finite {
            return Ok(());
        }
        Err(Error::Frame {
            problem: "the view's camera is not finite".to_owned(),
            remedy: "give a finite matrix and eye, or no view",
        })
    }

    /// Pixels of the picture that the box with these corners covers, at most. World units.
    pub(crate) fn covered(&self, corners: impl Iterator<Item = Vec3>) -> f32 {
        let matrix = Mat4::from_cols_array_2d(&self.camera.view_projection);
        let mut low = glam::Vec2::splat(f32::INFINITY);
        let (mut high, mut reaches_behind) = (-low, false);
        for corner in corners {
            let clip = matrix * corner.extend(1.0);
            if clip.w <= 0.0 {
                reaches_behind = true;
                continue;
            }
            let at = clip.truncate().truncate() / clip.w;
            (low, high) = (low.min(at), high.max(at));
        }
        if low.x > high.x {
            // All of it is behind the eye.
            return 0.0;
        }
        if reaches_behind {
            (low, high) = (glam::Vec2::NEG_ONE, glam::Vec2::ONE);
        }
        let bounds = (glam::Vec2::NEG_ONE, glam::Vec2::ONE);
        let size = high.clamp(bounds.0, bounds.1) - low.clamp(bounds.0, bounds.1);
        0.25 * size.x * size.y * self.pixels[0] as f32 * self.pixels[1] as f32
    }
}

/// What of a body's shape decides where exitance is evaluated. Lengths in units of the mesh, at rest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    /// Mean length of an edge.
    pub edge: f32,
    /// Side of a typical texel.
    pub texel: f32,
    /// Whether its inside can be seen from nowhere.
    pub closed: bool,
}

impl Shape {
    pub fn new(mesh: &Mesh, atlas: &Atlas) -> Self {
        let area: f32 = atlas.texels.iter().map(|texel| texel.area).sum();
        let lengths = mesh.triangles.iter().enumerate().map(|(triangle, _)| {
            let [a, b, c] = mesh.corners(triangle).map(Vec3::from);
            a.distance(b) + b.distance(c) + c.distance(a)
        });
        Self {
            edge: lengths.sum::<f32>() / (3 * mesh.triangles.len().max(1)) as f32,
            texel: (area / atlas.texels.len().max(1) as f32).sqrt(),
            closed: is_closed(mesh),
        }
    }
}

/// Whether every edge is crossed as often in one direction as in the other. Corners in the same place are one.
fn is_closed(mesh: &Mesh) -> bool {
    let mut balance = HashMap::new();
    for triangle in &mesh.triangles {
        let places = triangle.map(|vertex| mesh.positions[vertex as usize].map(|x| (x + 0.0).to_bits()));
        for k in 0..3 {
            let (from, to) = (places[k], places[(k + 1) % 3]);
            if from < to {
                *balance.entry((from, to)).or_insert(0_i32) += 1;
            } else if to < from {
                *balance.entry((to, from)).or_insert(0) -= 1;
            }
        }
    }
    balance.values().all(|count| *count == 0)
}

/// What `Auto` knows of a body in a frame. Lengths in mm.
pub(crate) struct Candidates<'a> {
    pub texels: u32,
    pub vertices: u32,
    /// Mean length of an edge.
    pub edge: f32,
    /// Side of a typical texel.
    pub texel: f32,
    /// Below which length light does not change.
    pub path: f32,
    /// Where the frame before evaluated.
    pub last: Evaluate,
    pub view: Option<&'a View>,
    /// Of the box around the body, world units.
    pub corners: [Vec3; 8],
}

impl Candidates<'_> {
    /// The place with the fewest receivers.
    pub fn choose(&self) -> Evaluate {
        // Another place needs other memory: it has to be a fifth cheaper.
        let stay = |place| if place == self.last { 0.8 } else { 1.0 };
        let mut best = (self.texels as f32 * stay(Evaluate::PerTexel), Evaluate::PerTexel);
        let mut consider = |receivers: f32, place| {
            let receivers = receivers * stay(place);
            if receivers < best.0 {
                best = (receivers, place);
            }
        };
        if self.path < self.texel {
            return Evaluate::PerTexel;
        }
        if self.edge < self.texel.max(0.5 * self.path) {
            consider(self.vertices as f32, Evaluate::PerVertex);
        }
        if let Some(view) = self.view {
            consider(view.covered(self.corners.into_iter()), Evaluate::PerFragment);
        }
        best.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LookAt;

    fn view(distance: f32) -> View {
        let camera = Camera::from(LookAt {
            eye: [0.0, 0.0, distance],
            target: [0.0; 3],
            up: [0.0, 1.0, 0.0],
            horizontal_fov: std::f32::consts::FRAC_PI_2,
            aspect: 2.0,
            near: 0.01,
            far: 1000.0,
        });
        View { camera, pixels: [200, 100] }
    }

    #[test]
    fn only_what_has_no_edge_is_closed() {
        // A tetrahedron whose faces share no vertex, as with normals of their own.
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.0, 0.0, 1.0]];
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let positions = faces.iter().flatten().map(|&corner: &usize| corners[corner]).collect();
        let triangles = (0..4).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect();
        let mut mesh = Mesh { positions, triangles, ..Mesh::default() };
        assert!(is_closed(&mesh));
        mesh.triangles.pop();
        assert!(!is_closed(&mesh));
    }

    fn cube() -> [Vec3; 8] {
        std::array::from_fn(|k| {
            Vec3::new((k & 1) as f32, (k >> 1 & 1) as f32, (k >> 2) as f32) - Vec3::splat(0.5)
        })
    }

    #[test]
    fn a_box_covers_its_share_of_the_picture() {
        // Its near face is 9.5 away: a twentieth of the 19 that the picture is wide there, and a ninth and a half of its height.
        let expected = 200.0 / 19.0 * 100.0 / 9.5;
        let covered = view(10.0).covered(cube().into_iter());
        assert!((covered / expected - 1.0).abs() < 1e-4, "{covered} against {expected}");
        assert!(
            (view(0.4).covered(cube().into_iter()) - 20_000.0).abs() < 1.0,
            "from inside it is everywhere"
        );
        let beside = cube().map(|corner| corner + Vec3::new(100.0, 0.0, 0.0));
        assert!(view(10.0).covered(beside.into_iter()) < 1.0, "out of the picture it is nowhere");
        assert_eq!(
            view(10.0).covered(cube().map(|corner| corner + Vec3::Z * 30.0).into_iter()),
            0.0,
            "behind the eye"
        );
    }

    #[test]
    fn auto_takes_the_fewest_that_lose_nothing() {
        let far = view(100.0);
        let body = |vertices, edge, path, view| {
            let corners = cube();
            let last = Evaluate::PerTexel;
            Candidates { texels: 40_000, vertices, edge, texel: 0.5, path, last, view, corners }.choose()
        };
        assert_eq!(body(20_000, 0.4, 0.6, None), Evaluate::PerVertex, "edges below a texel");
        assert_eq!(body(20_000, 0.4, 0.1, None), Evaluate::PerTexel, "texels would show");
        assert_eq!(body(20_000, 2.0, 0.6, None), Evaluate::PerTexel, "edges too long");
        assert_eq!(body(20_000, 2.0, 5.0, None), Evaluate::PerVertex, "but not for this light");
        assert_eq!(body(80_000, 0.4, 0.6, None), Evaluate::PerTexel, "more vertices than texels");
        assert_eq!(body(20_000, 0.4, 1.0, Some(&far)), Evaluate::PerFragment, "far away");
        assert_eq!(body(80_000, 0.4, 0.3, Some(&far)), Evaluate::PerTexel, "single texels would show");
    }
}
