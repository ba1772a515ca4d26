//! Procedural warps: a mesh twists, bends and swells without an artist's help.
//!
//! Source: Barr 1984, "Global and Local Deformations of Solid Primitives", Computer Graphics 18(3), for twist and bend.

use glam::{DVec3, Vec3};

use crate::mesh::Mesh;
use crate::normals::smooth_normals;
use crate::rig::{self, Pose, PoseError};

/// Inflation, twist and bend. The default does nothing.
///
/// The order is inflate, morph, skin, twist, bend, model matrix. Inflation comes first because it follows the normals of the rest pose,
/// and whatever moves the skin has to move what the skin was inflated to. Twist and bend come last because they act on the space around
/// the posed mesh: a walking figure bends as a whole. Twist goes before bend because a bent axis is no line to twist around.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Warp {
    /// By how much the top of the axis turns against its foot: radians, anticlockwise seen from above.
    pub twist: f32,
    /// The arc of a circle that the axis becomes: radians. The foot stays where it is and upright; positive leans towards +x. What is
    /// further from the axis than the circle's radius, height / |bend|, turns inside out.
    pub bend: f32,
    /// How far the surface moves along its smooth normal at rest, which all vertices at one position share, so that hard edges stay
    /// closed: model units, negative inwards. Folds narrower than this distance wrinkle.
    pub inflate: f32,
    /// What is twisted and bent; `None` for [`Axis::of`] the mesh.
    pub axis: Option<Axis>,
}

/// An upright line, parallel to y. What is beyond its ends moves on with them, rigidly.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Axis {
    /// The lower end, model units.
    pub foot: [f32; 3],
    /// From the lower end to the upper, model units, ≥ 0; with 0 nothing twists or bends.
    pub height: f32,
}

impl Warp {
    /// The largest |angle| of twist or bend: f32 still tells apart what is 6·10⁻⁵ radians apart.
    pub const MAX_ANGLE: f32 = 1000.0;

    /// Whether it moves nothing.
    #[must_use]
    pub fn is_identity(&self) -> bool {
        self.twist == 0.0 && self.bend == 0.0 && self.inflate == 0.0
    }

    /// Where a pose and this warp put every vertex, model units, on the CPU: for a camera that has to see them all, or for export.
    ///
    /// # Errors
    /// As [`rig::posed`].
    pub fn posed(&self, mesh: &Mesh, pose: &Pose) -> Result<Vec<[f32; 3]>, PoseError> {
        let axis = self.axis.unwrap_or_else(|| Axis::of(mesh));
        let posed =
            if self.inflate == 0.0 { rig::posed(mesh, pose) } else { rig::posed(&self.inflated(mesh), pose) };
        Ok(posed?.into_iter().map(|p| axis.bend(self.bend, axis.twist(self.twist, p))).collect())
    }

    fn inflated(&self, mesh: &Mesh) -> Mesh {
        let mut mesh = mesh.clone();
        let directions = smooth_normals(&mesh.positions, &mesh.triangles);
        for (position, direction) in mesh.positions.iter_mut().zip(directions) {
            *position = (Vec3::from(*position) + self.inflate * Vec3::from(direction)).to_array();
        }
        mesh
    }
}

impl Axis {
    /// Through the middle of the bounding box of the mesh at rest, as high as the box.
    #[must_use]
    pub fn of(mesh: &Mesh) -> Self {
        mesh.bounds().map_or(Self::default(), |(low, high)| Self::within(low, high))
    }

    /// Through the middle of a box, as high as the box.
    #[must_use]
    pub fn within(low: [f32; 3], high: [f32; 3]) -> Self {
        let middle = |k: usize| 0.5 * low[k] + 0.5 * high[k];
        Self { foot: [middle(0), low[1], middle(2)], height: high[1] - low[1] }
    }

    /// Where a point goes when the axis twists by `angle`, as [`Warp::twist`].
    #[must_use]
    pub fn twist(&self, angle: f32, point: [f32; 3]) -> [f32; 3] {
        let (from_foot, on_axis) = self.split(point);
        let (sine, versine) = sine_and_versine(self.angle_at(angle, on_axis));
        let [x, z] = [from_foot.x, from_foot.z];
        moved(point, DVec3::new(z * sine - x * versine, 0.0, -x * sine - z * versine))
    }

    /// Where a point goes when the axis bends by `angle`, as [`Warp::bend`].
    #[must_use]
    pub fn bend(&self, angle: f32, point: [f32; 3]) -> [f32; 3] {
        let (from_foot, on_axis) = self.split(point);
        let angle = self.angle_at(angle, on_axis);
        let (sine, versine) = sine_and_versine(angle);
        // The arc up to this height ends `on_axis` · (versine, sine) / angle from the foot.
        let (aside, up) = if angle == 0.0 { (0.0, 0.0) } else { (versine / angle, sine / angle - 1.0) };
        let (x, beyond) = (from_foot.x, from_foot.y - on_axis);
        let shift_x = on_axis * aside + beyond * sine - x * versine;
        let shift_y = on_axis * up - beyond * versine - x * sine;
        moved(point, DVec3::new(shift_x, shift_y, 0.0))
    }

    /// From the foot to a point, and the height of that point held to the axis.
    fn split(&self, point: [f32; 3]) -> (DVec3, f64) {
        let from_foot = DVec3::from(point.map(f64::from)) - DVec3::from(self.foot.map(f64::from));
        (from_foot, from_foot.y.max(0.0).min(self.height.into()))
    }

    fn angle_at(&self, angle: f32, on_axis: f64) -> f64 {
        if self.height > 0.0 { f64::from(angle) * on_axis / f64::from(self.height) } else { 0.0 }
    }
}

/// sin and 1 − cos, both to full precision near 0.
fn sine_and_versine(angle: f64) -> (f64, f64) {
    (angle.sin(), 2.0 * (0.5 * angle).sin().powi(2))
}

/// Displacements, not positions: no angle is then exactly no movement.
fn moved(point: [f32; 3], by: DVec3) -> [f32; 3] {
    (DVec3::from(point.map(f64::from)) + by).as_vec3().to_array()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Influence, MorphTarget, Skin};
    use std::f32::consts::{FRAC_PI_2, PI};

    /// From (1, 2, 3) upwards by 4.
    const AXIS: Axis = Axis { foot: [1.0, 2.0, 3.0], height: 4.0 };

    fn apart(a: [f32; 3], b: [f32; 3]) -> f32 {
        (0..3).map(|k| (a[k] - b[k]).abs()).fold(0.0, f32::max)
    }

    #[test]
    fn no_angle_moves_nothing() {
        for point in [[0.1, 0.2, 0.3], [-7e3, 1e-9, 4.4], [1.0, 9.0, 3.0]] {
            assert_eq!(AXIS.twist(0.0, point), point);
            assert_eq!(AXIS.bend(0.0, point), point);
            let flat = Axis { height: 0.0, ..AXIS };
            assert_eq!((flat.twist(2.0, point), flat.bend(2.0, point)), (point, point));
        }
        assert_ne!(AXIS.bend(1e-3, [1.0, 6.0, 3.0]), [1.0, 6.0, 3.0]);
    }

    #[test]
    fn the_top_turns_by_the_whole_angle_and_the_foot_stays() {
        // Anticlockwise from above, a quarter turn takes z to x. f32 holds these numbers to 5e-7.
        assert!(apart(AXIS.twist(FRAC_PI_2, [1.0, 6.0, 5.0]), [3.0, 6.0, 3.0]) < 1e-6);
        assert!(apart(AXIS.twist(FRAC_PI_2, [1.0, 4.0, 5.0]), [2.414_213_5, 4.0, 4.414_213_5]) < 1e-6);
        assert_eq!(AXIS.twist(FRAC_PI_2, [1.0, 2.0, 5.0]), [1.0, 2.0, 5.0]);
        assert_eq!(AXIS.twist(FRAC_PI_2, [1.0, -2.0, 5.0]), [1.0, -2.0, 5.0], "below the foot nothing turns");
        assert!(
            apart(AXIS.twist(FRAC_PI_2, [1.0, 9.0, 5.0]), [3.0, 9.0, 3.0]) < 1e-6,
            "nor more above the top"
        );
    }

    #[test]
    fn a_bent_axis_is_an_arc_of_its_own_length() {
        // Half a circle of length 4 is 8/π wide and leads back to the height of the foot.
        let top = [1.0, 6.0, 3.0];
        assert!(apart(AXIS.bend(PI, top), [1.0 + 8.0 / PI, 2.0, 3.0]) < 1e-6);
        assert!(apart(AXIS.bend(-PI, top), [1.0 - 8.0 / PI, 2.0, 3.0]) < 1e-6);
        // What was beside the axis is as far from the circle, and what is beyond the top goes straight on.
        assert!(apart(AXIS.bend(PI, [1.5, 6.0, 3.0]), [0.5 + 8.0 / PI, 2.0, 3.0]) < 1e-6);
        assert!(apart(AXIS.bend(PI, [1.0, 7.0, 3.0]), [1.0 + 8.0 / PI, 1.0, 3.0]) < 1e-6);
        let points: Vec<_> =
            (0..=100_u8).map(|k| AXIS.bend(PI, [1.0, 2.0 + f32::from(k) * 0.04, 3.0])).collect();
        let chord = |pair: &[[f32; 3]]| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
        // A chord of 0.031 rad is 4.1e-5 shorter than its arc.
        assert!((points.windows(2).map(chord).sum::<f32>() - 4.0).abs() < 2e-4);
    }

    #[test]
    fn small_angles_lose_nothing() {
        for angle in [1e-30, 1e-7, 1e-4, 1e-3_f32] {
            let axis = Axis { foot: [0.0; 3], height: 4.0 };
            let ([x, y, _], [_, _, z]) =
                (axis.bend(angle, [0.0, 4.0, 0.0]), axis.twist(angle, [-1.0, 4.0, 0.0]));
            // The next term of the series is 1e-7 of the first.
            assert!((x / (2.0 * angle) - 1.0).abs() < 3e-7 && (z / angle - 1.0).abs() < 3e-7, "{x} {y} {z}");
            assert!((y - 4.0).abs() < 1e-6, "{y}");
        }
    }

    #[test]
    fn a_pose_is_inflated_then_morphed_then_skinned_then_warped() {
        let raised =
            |y| [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, y, 0.0, 1.0]];
        let mesh = Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            normals: vec![[0.0, 0.0, 1.0]; 3],
            triangles: vec![[0, 1, 2]],
            targets: vec![MorphTarget { name: String::new(), position_deltas: vec![[0.0, 0.0, 2.0]; 3] }],
            skin: Some(Skin {
                joints: 2,
                per_vertex: 2,
                influences: [[(0, 1.0), (0, 0.0)], [(1, 1.0), (0, 0.0)], [(0, 0.5), (1, 0.5)]]
                    .concat()
                    .into_iter()
                    .map(|(joint, weight)| Influence { joint, weight })
                    .collect(),
            }),
            ..Mesh::default()
        };
        let pose = Pose { weights: vec![0.5], joints: vec![raised(0.0), raised(1.0)] };
        let at_rest = Pose { weights: vec![0.0], joints: vec![raised(0.0); 2] };
        assert_eq!(Warp::default().posed(&mesh, &at_rest).unwrap(), mesh.positions);
        assert!(Warp::default().posed(&mesh, &Pose::default()).is_err());
        let posed = Warp { inflate: 0.25, ..Warp::default() }.posed(&mesh, &pose).unwrap();
        assert_eq!(posed, [[0.0, 0.0, 1.25], [1.0, 1.0, 1.25], [0.0, 1.5, 1.25]]);
        // The axis stands at (0.5, 0, 0): half a turn at its top takes x to 1 − x and z to −z.
        let turned = Warp { twist: PI, ..Warp::default() }.posed(&mesh, &pose).unwrap();
        assert!(
            apart(turned[1], [0.0, 1.0, -1.0]) < 1e-6 && apart(turned[0], [0.0, 0.0, 1.0]) < 1e-6,
            "{turned:?}"
        );
    }
}
