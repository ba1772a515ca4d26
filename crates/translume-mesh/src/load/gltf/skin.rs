//! Joints: those of skins, and one for each node that holds a part without a skin.

use std::collections::BTreeMap;

use glam::{DMat3, DMat4, DVec3};
use gltf::mesh::{Primitive, Semantic};

use super::budget::{Budget, cost};
use super::primitive::in_accessor;
use super::scene::Scene;
use super::{Fault, finite};
use crate::load::accessor;
use crate::load::buffers::Buffer;
use crate::mesh::Influence;
use crate::rig::{Joint, affine};

/// Influences in one pair of `JOINTS_n` and `WEIGHTS_n`.
pub(super) const SET: usize = 4;

/// Share of the size of a matrix below which its smallest stretch counts as none. The square of it is well above what
/// double precision leaves of a stretch that should be none.
const FLAT: f64 = 1e-5;

/// Error below which a transform and its stored inverse cancel: a hundred thousandth of what is transformed.
const UNDONE: f64 = 1e-5;

/// The joints of the merged mesh, added as its parts need them.
#[derive(Default)]
pub(super) struct Joints {
    pub(super) joints: Vec<Joint>,
    skins: BTreeMap<usize, Bound>,
    rigid: BTreeMap<usize, u32>,
}

/// A skin among the joints.
#[derive(Clone, Copy)]
pub(super) struct Bound {
    /// Its first joint.
    first: u32,
    /// How many it has.
    count: usize,
    /// From where its meshes were bound to where they rest.
    pub(super) placement: DMat4,
}

impl Joints {
    /// The joint that holds what is rigidly fixed to a node.
    ///
    /// A node that is flat at rest (a scale of 0) flattens the rest positions, and nothing can unfold them again: its
    /// joint is bound by the pseudo-inverse of its transform, which keeps the rest positions where they are and lets the
    /// node turn and shift them.
    pub(super) fn of_node(&mut self, scene: &Scene<'_>, place: usize) -> u32 {
        *self.rigid.entry(place).or_insert_with(|| {
            let global = scene.nodes[place].global;
            let inverse_bind = inverse(global).unwrap_or_else(|| pseudo_inverse(global));
            let inverse_bind = inverse_bind.as_mat4().to_cols_array_2d();
            self.joints.push(Joint { node: place as u32, inverse_bind });
            (self.joints.len() - 1) as u32
        })
    }

    /// The joints of a skin. Its meshes rest in the shape they were bound in, where the first joint's inverse bind matrix
    /// and default transform put them: in the units and at the place of the scene, whatever the mesh was modelled in.
    pub(super) fn of_skin(
        &mut self,
        skin: &gltf::Skin<'_>,
        scene: &Scene<'_>,
        buffers: &[Buffer],
        budget: &mut Budget,
    ) -> Result<Bound, Fault> {
        if let Some(&bound) = self.skins.get(&skin.index()) {
            return Ok(bound);
        }
        let fault = |reason| Fault::at(format!("skins[{}]", skin.index()), reason);
        let places = places(skin, scene)?;
        budget.take(places.len(), cost::JOINT).map_err(fault)?;
        let binds = inverse_binds(skin, buffers, places.len()).map_err(fault)?;
        let global = |k: usize| scene.nodes[places[k]].global;
        let placed = Some(global(0) * binds[0]).filter(|m| m.as_mat4().is_finite());
        let (placement, back) = placed
            .and_then(|placement| Some((placement, inverse(placement)?)))
            .filter(|(_, back)| binds.iter().all(|&bind| (bind * *back).as_mat4().is_finite()))
            .unwrap_or((DMat4::IDENTITY, DMat4::IDENTITY));
        let bound = Bound { first: self.joints.len() as u32, count: places.len(), placement };
        self.joints.extend(places.iter().zip(&binds).map(|(&place, &bind)| Joint {
            node: place as u32,
            inverse_bind: (bind * back).as_mat4().to_cols_array_2d(),
        }));
        self.skins.insert(skin.index(), bound);
        Ok(bound)
    }
}

impl Bound {
    /// Influences of every vertex of a primitive, `stride` for each, the used ones first. A vertex without any weight
    /// follows the first joint that it names.
    pub(super) fn influences(
        &self,
        primitive: &Primitive<'_>,
        buffers: &[Buffer],
        vertices: usize,
        stride: usize,
    ) -> Result<Vec<Influence>, String> {
        let mut influences = vec![Influence::default(); vertices.saturating_mul(stride)];
        let mut used = vec![0; vertices];
        let mut first = Vec::new();
        for set in 0..sets(primitive)? {
            let (joints, weights) = read_set(primitive, set, buffers, vertices)?;
            for (v, (joints, weights)) in joints.iter().zip(&weights).enumerate() {
                for (&joint, &weight) in joints.iter().zip(weights).filter(|(_, weight)| **weight > 0.0) {
                    let joint = self.joint(joint, v)?;
                    influences[v * stride + used[v]] = Influence { joint, weight };
                    used[v] += 1;
                }
            }
            if set == 0 {
                first = joints;
            }
        }
        for (v, influences) in influences.chunks_exact_mut(stride).enumerate() {
            let sum: f64 = influences.iter().map(|influence| f64::from(influence.weight)).sum();
            if sum > 0.0 {
                influences.iter_mut().for_each(|i| i.weight = (f64::from(i.weight) / sum) as f32);
            } else {
                influences[0] = Influence { joint: self.joint(first[v][0], v)?, weight: 1.0 };
            }
        }
        Ok(influences)
    }

    fn joint(&self, joint: u32, vertex: usize) -> Result<u32, String> {
        if joint as usize >= self.count {
            return Err(format!("vertex {vertex} follows joint {joint}, but its skin has {}", self.count));
        }
        Ok(self.first + joint)
    }
}

/// Pairs of `JOINTS_n` and `WEIGHTS_n` that a skinned primitive has.
pub(super) fn sets(primitive: &Primitive<'_>) -> Result<usize, String> {
    let has = |semantic| primitive.get(&semantic).is_some();
    let joints = (0_u32..).take_while(|&n| has(Semantic::Joints(n))).count();
    let weights = (0_u32..).take_while(|&n| has(Semantic::Weights(n))).count();
    if joints == 0 || joints != weights {
        let missing = if joints > weights { "WEIGHTS" } else { "JOINTS" };
        return Err(format!("its node has a skin, but it has no {missing}_{}", joints.min(weights)));
    }
    Ok(joints)
}

type ReadSet = (Vec<[u32; 4]>, Vec<[f32; 4]>);

fn read_set(
    primitive: &Primitive<'_>,
    set: usize,
    buffers: &[Buffer],
    vertices: usize,
) -> Result<ReadSet, String> {
    let get = |semantic: Semantic| {
        primitive.get(&semantic).ok_or_else(|| format!("it has no {}", semantic.to_string()))
    };
    let joints = get(Semantic::Joints(set as u32))?;
    let weights = get(Semantic::Weights(set as u32))?;
    let at = in_accessor(weights.index());
    let joints = accessor::joints(&joints, buffers, vertices).map_err(in_accessor(joints.index()))?;
    let weights: Vec<[f32; 4]> = accessor::numbers(&weights, buffers, (vertices, "vertices")).map_err(&at)?;
    let broken = weights.iter().position(|w| !w.iter().all(|w| (0.0..=f32::MAX).contains(w)));
    match broken {
        Some(v) => Err(at(format!("vertex {v} has the weights {:?}, which cannot be", weights[v]))),
        None => Ok((joints, weights)),
    }
}

/// Where in the scene a skin's joints are.
fn places(skin: &gltf::Skin<'_>, scene: &Scene<'_>) -> Result<Vec<usize>, Fault> {
    let element = format!("skins[{}]", skin.index());
    let places: Vec<usize> = skin
        .joints()
        .enumerate()
        .map(|(k, node)| {
            scene.place(node.index()).ok_or_else(|| {
                Fault::at(
                    format!("{element}.joints[{k}]"),
                    format!("nodes[{}] is not in the scene that the skin is used in", node.index()),
                )
            })
        })
        .collect::<Result<_, _>>()?;
    if places.is_empty() { Err(Fault::at(element, "it has no joints")) } else { Ok(places) }
}

fn inverse_binds(skin: &gltf::Skin<'_>, buffers: &[Buffer], joints: usize) -> Result<Vec<DMat4>, String> {
    let Some(accessor) = skin.inverse_bind_matrices() else { return Ok(vec![DMat4::IDENTITY; joints]) };
    let at = in_accessor(accessor.index());
    let matrices = accessor::inverse_binds(&accessor, buffers, joints).map_err(&at)?;
    finite(matrices.as_flattened()).map_err(at)?;
    let columns = |m: &[f32; 16]| std::array::from_fn(|c| std::array::from_fn(|r| m[4 * c + r]));
    Ok(matrices.iter().map(|m| affine(&columns(m))).collect())
}

/// The inverse, where it still undoes the transform once it is stored in `f32`.
fn inverse(transform: DMat4) -> Option<DMat4> {
    let inverse = transform.inverse();
    let stored = inverse.as_mat4();
    let undone = DMat3::from_mat4(transform * stored.as_dmat4());
    (stored.is_finite() && undone.abs_diff_eq(DMat3::IDENTITY, UNDONE)).then_some(inverse)
}

/// The Moore–Penrose inverse of a flat transform, up to 1e-10 of its size.
fn pseudo_inverse(transform: DMat4) -> DMat4 {
    let linear = DMat3::from_mat4(transform);
    let size = linear.to_cols_array().iter().fold(0.0, |size: f64, x| size.max(x.abs()));
    // Below, the stretch back would leave the range of f32.
    if size < 1e-30 {
        return DMat4::from_mat3(DMat3::ZERO);
    }
    let unit = linear * size.recip();
    let damping = DMat3::from_diagonal(DVec3::splat(FLAT * FLAT));
    let back = (unit.transpose() * unit + damping).inverse() * unit.transpose() * size.recip();
    DMat4::from_mat3_translation(back, -(back * transform.w_axis.truncate()))
}
