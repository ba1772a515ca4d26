//! From a time to a pose, and from a pose to positions.

use glam::{DMat4, DVec3, Mat4, Vec3};

use super::sample::unit;
use super::{Animation, Channel, Local, Pose, Rig, Target};
use crate::mesh::{Influence, Mesh};

impl Rig {
    /// The pose at a time of an animation, or without one the pose in which the file stands.
    ///
    /// Before the first key and after the last a channel keeps that key's value; to repeat an animation, pass the
    /// remainder by its [`duration`](Animation::duration). What no channel moves stands as in the file; where two
    /// channels move the same, the later one counts. Channels that name a node or weight that is not there, hold too few
    /// numbers, or would move a node that stands by a matrix have no effect, and a joint whose node is not there keeps the
    /// rest position; a parent that does not come before its child is as good as none. All matrices are finite unless the
    /// file's own numbers multiply beyond `f32`.
    ///
    /// The result is the only thing that is allocated for longer than the call; nothing depends on earlier calls.
    #[must_use]
    pub fn pose(&self, animation: Option<&Animation>, seconds: f32) -> Pose {
        let mut locals: Vec<Local> = self.nodes.iter().map(|node| node.local).collect();
        let mut weights = self.weights.clone();
        for channel in animation.into_iter().flat_map(|animation| &animation.channels) {
            // A channel without the numbers it should have has no effect, as documented.
            let _moved = channel.apply(seconds, &mut locals, &mut weights);
        }
        let globals = self.globals(&locals);
        let joints = self.joints.iter().map(|joint| {
            let inverse_bind = Mat4::from_cols_array_2d(&joint.inverse_bind).as_dmat4();
            let global = globals.get(joint.node as usize);
            global.map_or(Mat4::IDENTITY, |global| (*global * inverse_bind).as_mat4()).to_cols_array_2d()
        });
        Pose { weights, joints: joints.collect() }
    }

    /// The pose in which the file stands while nothing is animated.
    ///
    /// Not quite what [`Mesh::positions`](crate::Mesh::positions) shows: there a part with a skin has the shape it was bound
    /// in, and no morph target weighs anything.
    #[must_use]
    pub fn rest_pose(&self) -> Pose {
        self.pose(None, 0.0)
    }

    /// Transforms from each node to the model.
    fn globals(&self, locals: &[Local]) -> Vec<DMat4> {
        let mut globals: Vec<DMat4> = Vec::with_capacity(locals.len());
        for (node, local) in self.nodes.iter().zip(locals) {
            let parent = node.parent.and_then(|parent| globals.get(parent as usize));
            globals.push(parent.copied().unwrap_or(DMat4::IDENTITY) * local.matrix());
        }
        globals
    }
}

impl Local {
    /// To the parent, in double precision. Rotations are brought to unit length; a matrix's last row is 0, 0, 0, 1.
    pub(crate) fn matrix(&self) -> DMat4 {
        match self {
            Self::Trs { translation, rotation, scale } => DMat4::from_scale_rotation_translation(
                DVec3::from(scale.map(f64::from)),
                unit(rotation.map(f64::from)),
                DVec3::from(translation.map(f64::from)),
            ),
            Self::Matrix(columns) => affine(columns),
        }
    }
}

/// A matrix in double precision with 0, 0, 0, 1 for its last row, as the format demands it.
pub(crate) fn affine(columns: &[[f32; 4]; 4]) -> DMat4 {
    let column = |k: usize, w: f64| {
        let [x, y, z, _] = columns[k].map(f64::from);
        glam::DVec4::new(x, y, z, w)
    };
    DMat4::from_cols(column(0, 0.0), column(1, 0.0), column(2, 0.0), column(3, 1.0))
}

impl Channel {
    fn apply(&self, seconds: f32, locals: &mut [Local], weights: &mut [f32]) -> Option<()> {
        match self.target {
            Target::Translation(node) => *trs(locals, node)?.0 = self.vector(seconds)?,
            Target::Rotation(node) => *trs(locals, node)?.1 = self.rotation(seconds)?,
            Target::Scale(node) => *trs(locals, node)?.2 = self.vector(seconds)?,
            Target::Weights { first, count } => {
                let [first, count] = [first as usize, count as usize];
                let weights = weights.get_mut(first..first.checked_add(count)?)?;
                let at = self.moment(seconds)?;
                // The last one needs the most numbers: where it has them, so have all.
                let _last = self.component(at, count, count.checked_sub(1)?)?;
                for (k, weight) in weights.iter_mut().enumerate() {
                    *weight = self.component(at, count, k)? as f32;
                }
            }
        }
        Some(())
    }
}

type Trs<'a> = (&'a mut [f32; 3], &'a mut [f32; 4], &'a mut [f32; 3]);

fn trs(locals: &mut [Local], node: u32) -> Option<Trs<'_>> {
    match locals.get_mut(node as usize)? {
        Local::Trs { translation, rotation, scale } => Some((translation, rotation, scale)),
        Local::Matrix(_) => None,
    }
}

/// Why a pose does not fit a mesh.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PoseError {
    /// There is not one weight per morph target.
    #[error(
        "{mesh}: the pose has {weights} morph weights, but the mesh has {targets} targets; \
         take the pose from the rig that came with the mesh"
    )]
    Weights {
        /// The mesh's name.
        mesh: String,
        /// Number of weights in the pose.
        weights: usize,
        /// Number of morph targets.
        targets: usize,
    },
    /// There is not one matrix per joint.
    #[error(
        "{mesh}: the pose has {matrices} joint matrices, but the mesh has {joints} joints; \
         take the pose from the rig that came with the mesh"
    )]
    Joints {
        /// The mesh's name.
        mesh: String,
        /// Number of matrices in the pose.
        matrices: usize,
        /// Number of joints of the mesh's skin; 0 without a skin.
        joints: usize,
    },
    /// The mesh contradicts itself.
    #[error("{mesh}: {problem}; build deltas and influences for the vertices that it has")]
    Mesh {
        /// The mesh's name.
        mesh: String,
        /// What is wrong, naming the element.
        problem: String,
    },
}

/// Where a pose puts every vertex, model units: [`posed_into`] a new list.
///
/// # Errors
/// As [`posed_into`].
pub fn posed(mesh: &Mesh, pose: &Pose) -> Result<Vec<[f32; 3]>, PoseError> {
    let mut positions = Vec::new();
    posed_into(mesh, pose, &mut positions)?;
    Ok(positions)
}

/// Where a pose puts every vertex, model units: `Σ weight · joint matrix · (rest + Σ weight · delta)`, in `f32`.
///
/// `positions` is cleared first and keeps its memory, so that a list that is used again costs no allocation. On an error
/// it holds nothing of use.
///
/// # Errors
/// [`PoseError`], where pose and mesh do not belong together or the mesh contradicts itself.
pub fn posed_into(mesh: &Mesh, pose: &Pose, positions: &mut Vec<[f32; 3]>) -> Result<(), PoseError> {
    let name = || mesh.name.clone();
    let (weights, targets) = (pose.weights.len(), mesh.targets.len());
    if weights != targets {
        return Err(PoseError::Weights { mesh: name(), weights, targets });
    }
    let (matrices, joints) = (pose.joints.len(), mesh.skin.as_ref().map_or(0, |skin| skin.joints));
    if matrices != joints {
        return Err(PoseError::Joints { mesh: name(), matrices, joints });
    }
    let problem = |problem| PoseError::Mesh { mesh: name(), problem };
    positions.clear();
    positions.extend_from_slice(&mesh.positions);
    for (k, (target, &weight)) in mesh.targets.iter().zip(&pose.weights).enumerate() {
        let deltas = &target.position_deltas;
        if deltas.len() != positions.len() {
            return Err(problem(format!(
                "morph target {k} (from 0) has {} deltas for {} vertices",
                deltas.len(),
                positions.len()
            )));
        }
        if weight != 0.0 {
            morph(positions, deltas, weight);
        }
    }
    let Some(skin) = &mesh.skin else { return Ok(()) };
    if skin.per_vertex == 0 || skin.influences.len() != positions.len().saturating_mul(skin.per_vertex) {
        return Err(problem(format!(
            "its skin has {} influences, {} a vertex, for {} vertices",
            skin.influences.len(),
            skin.per_vertex,
            positions.len()
        )));
    }
    let matrices: Vec<Mat4> = pose.joints.iter().map(Mat4::from_cols_array_2d).collect();
    for (v, (position, influences)) in
        positions.iter_mut().zip(skin.influences.chunks_exact(skin.per_vertex)).enumerate()
    {
        *position = skinned(*position, influences, &matrices).ok_or_else(|| {
            problem(format!("vertex {v} (from 0) follows a joint that is not among its {joints}"))
        })?;
    }
    Ok(())
}

fn morph(positions: &mut [[f32; 3]], deltas: &[[f32; 3]], weight: f32) {
    for (position, delta) in positions.iter_mut().zip(deltas) {
        *position = (Vec3::from(*position) + weight * Vec3::from(*delta)).to_array();
    }
}

fn skinned(position: [f32; 3], influences: &[Influence], matrices: &[Mat4]) -> Option<[f32; 3]> {
    let mut sum = Vec3::ZERO;
    // Unused influences weigh nothing, even where their matrix is not finite.
    for influence in influences.iter().filter(|influence| influence.weight != 0.0) {
        sum += influence.weight * matrices.get(influence.joint as usize)?.transform_point3(position.into());
    }
    Some(sum.to_array())
}
