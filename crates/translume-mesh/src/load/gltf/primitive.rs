//! Primitives: what there is to read, and reading it into one mesh.

use std::collections::BTreeMap;

use glam::{DMat3, DMat4, DVec3};
use gltf::mesh::{Mode, Primitive, Semantic};

use super::budget::{Budget, cost};
use super::morph::Morphs;
use super::scene::Scene;
use super::skin::{SET, sets};
use super::{Fault, finite};
use crate::load::accessor;
use crate::load::buffers::Buffer;
use crate::mesh::{Influence, Mesh, MorphTarget, Skin};

/// A primitive of triangles on a node.
pub(super) struct Part<'a> {
    pub(super) primitive: Primitive<'a>,
    /// Where its node is in the scene.
    pub(super) place: usize,
    mesh: usize,
    pub(super) vertices: usize,
}

impl<'a> Part<'a> {
    /// Every part of a scene, with all that they will unfold to taken from the budget.
    pub(super) fn of_scene(
        scene: &Scene<'a>,
        buffers: &[Buffer],
        budget: &mut Budget,
    ) -> Result<Vec<Self>, Fault> {
        let mut parts = Vec::new();
        for (place, placed) in scene.nodes.iter().enumerate() {
            let Some(mesh) = placed.node.mesh() else { continue };
            for primitive in mesh.primitives() {
                let mut part = Self { primitive, place, mesh: mesh.index(), vertices: 0 };
                budget.take(part.members(), cost::MEMBER).map_err(|reason| part.fault(reason))?;
                if part.is_surface() {
                    part.count(buffers, budget).map_err(|reason| part.fault(reason))?;
                    parts.push(part);
                }
            }
        }
        Ok(parts)
    }

    pub(super) fn fault(&self, reason: String) -> Fault {
        Fault::at(format!("meshes[{}].primitives[{}]", self.mesh, self.primitive.index()), reason)
    }

    /// Number of its morph targets.
    pub(super) fn targets(&self) -> usize {
        self.primitive.morph_targets().len()
    }

    /// What its JSON holds: itself, targets and attributes.
    fn members(&self) -> usize {
        1 + self.targets() + self.primitive.attributes().len()
    }

    pub(super) fn has_uvs(&self) -> bool {
        self.primitive.get(&Semantic::TexCoords(0)).is_some()
    }

    fn is_surface(&self) -> bool {
        !matches!(self.primitive.mode(), Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip)
    }

    fn count(&mut self, buffers: &[Buffer], budget: &mut Budget) -> Result<(), String> {
        let positions = self.primitive.get(&Semantic::Positions).ok_or("it has no positions")?;
        let at = in_accessor(positions.index());
        self.vertices = accessor::count(&positions, buffers, "positions").map_err(at)?;
        let indices = match self.primitive.indices() {
            Some(a) => accessor::count(&a, buffers, "indices").map_err(in_accessor(a.index()))?,
            None => self.vertices,
        };
        // A strip or fan has a triangle, three corners, for each index.
        let corners = match self.primitive.mode() {
            Mode::TriangleStrip | Mode::TriangleFan => indices.saturating_mul(3),
            _ => indices,
        };
        budget.take(self.vertices, cost::VERTEX)?;
        budget.take(corners, cost::INDEX)
    }
}

/// Prefixes what is wrong with an accessor by its number.
pub(super) fn in_accessor(index: usize) -> impl Fn(String) -> String {
    move |reason| format!("accessors[{index}]: {reason}")
}

/// Everything read so far.
pub(super) struct Merged {
    pub(super) mesh: Mesh,
    /// Area of the parts of each material, square model units.
    pub(super) areas: BTreeMap<usize, f64>,
    /// Influences of each vertex; 0 where nothing moves the mesh.
    stride: usize,
    influences: Vec<Influence>,
    has_uvs: bool,
}

/// What holds a part: where it is put to rest, and which joints its vertices follow.
pub(super) struct Hold {
    pub(super) placement: DMat4,
    pub(super) influences: Vec<Influence>,
}

impl Merged {
    /// Room for all parts.
    pub(super) fn new(
        parts: &[Part<'_>],
        morphs: &Morphs,
        stride: usize,
        budget: &mut Budget,
    ) -> Result<Self, Fault> {
        let vertices = parts.iter().map(|part| part.vertices).sum();
        let scene = |reason| Fault::at("scene", reason);
        budget.take(morphs.names.len().saturating_mul(vertices), cost::DELTA).map_err(scene)?;
        budget.take(stride.saturating_mul(vertices), cost::INFLUENCE).map_err(scene)?;
        let targets = morphs
            .names
            .iter()
            .map(|name| MorphTarget { name: name.clone(), position_deltas: vec![[0.0; 3]; vertices] });
        let mesh = Mesh {
            positions: Vec::with_capacity(vertices),
            normals: Vec::with_capacity(vertices),
            targets: targets.collect(),
            ..Mesh::default()
        };
        let has_uvs = parts.iter().any(Part::has_uvs);
        let influences = Vec::with_capacity(vertices.saturating_mul(stride));
        Ok(Self { mesh, areas: BTreeMap::new(), stride, influences, has_uvs })
    }

    /// Reads a part. Its first morph target becomes target `first`.
    pub(super) fn append(
        &mut self,
        part: &Part<'_>,
        hold: &Hold,
        first: usize,
        buffers: &[Buffer],
    ) -> Result<(), String> {
        let (primitive, count) = (&part.primitive, part.vertices);
        let positions =
            vectors(primitive, &Semantic::Positions, buffers, count)?.ok_or("it has no positions")?;
        let normals = vectors(primitive, &Semantic::Normals, buffers, count)?;
        let indices = match primitive.indices() {
            Some(a) => accessor::indices(&a, buffers).map_err(in_accessor(a.index()))?,
            None => (0..count as u32).collect(),
        };
        if let Some((place, index)) = indices.iter().enumerate().find(|(_, index)| **index as usize >= count)
        {
            return Err(format!("index {place} uses vertex {index}, but there are {count}"));
        }
        let triangles = triangles(&indices, primitive.mode(), hold.placement.determinant() < 0.0);
        self.append_uvs(part, &triangles, buffers)?;
        self.append_deltas(part, hold.placement, first, buffers)?;
        self.append_vertices(&positions, normals, hold);
        let base = (self.mesh.positions.len() - count) as u32;
        let begin = self.mesh.triangles.len();
        self.mesh.triangles.extend(triangles.into_iter().map(|triangle| triangle.map(|v| base + v)));
        if let Some(material) = primitive.material().index() {
            *self.areas.entry(material).or_default() += self.area(begin);
        }
        Ok(())
    }

    fn append_vertices(&mut self, positions: &[[f32; 3]], normals: Option<Vec<[f32; 3]>>, hold: &Hold) {
        let place = |p: &[f32; 3]| {
            hold.placement.transform_point3(DVec3::from(p.map(f64::from))).as_vec3().to_array()
        };
        self.mesh.positions.extend(positions.iter().map(place));
        let turn = normal_matrix(hold.placement);
        let turned =
            |n: [f32; 3]| (turn * DVec3::from(n.map(f64::from))).normalize_or_zero().as_vec3().to_array();
        match normals {
            Some(normals) => self.mesh.normals.extend(normals.into_iter().map(turned)),
            None => self.mesh.normals.resize(self.mesh.positions.len(), [0.0; 3]),
        }
        self.influences.extend_from_slice(&hold.influences);
    }

    /// Parts without texture coordinates have zeros where others have some.
    fn append_uvs(
        &mut self,
        part: &Part<'_>,
        triangles: &[[u32; 3]],
        buffers: &[Buffer],
    ) -> Result<(), String> {
        let Some(a) = part.primitive.get(&Semantic::TexCoords(0)) else {
            let without = if self.has_uvs { triangles.len() } else { 0 };
            self.mesh.uvs.resize(self.mesh.uvs.len() + without, [[0.0; 2]; 3]);
            return Ok(());
        };
        let at = in_accessor(a.index());
        let uvs: Vec<[f32; 2]> = accessor::numbers(&a, buffers, (part.vertices, "vertices")).map_err(&at)?;
        finite(uvs.as_flattened()).map_err(at)?;
        self.mesh.uvs.extend(triangles.iter().map(|triangle| triangle.map(|v| uvs[v as usize])));
        Ok(())
    }

    fn append_deltas(
        &mut self,
        part: &Part<'_>,
        placement: DMat4,
        first: usize,
        buffers: &[Buffer],
    ) -> Result<(), String> {
        let base = self.mesh.positions.len();
        let turn =
            |d: [f32; 3]| placement.transform_vector3(DVec3::from(d.map(f64::from))).as_vec3().to_array();
        let targets = part.primitive.morph_targets().zip(self.mesh.targets.iter_mut().skip(first));
        for (k, (target, merged)) in targets.enumerate() {
            let Some(a) = target.positions() else { continue };
            let deltas = accessor::numbers(&a, buffers, (part.vertices, "vertices"))
                .map_err(|reason| format!("targets[{k}]: accessors[{}]: {reason}", a.index()))?;
            for (merged, delta) in merged.position_deltas.iter_mut().skip(base).zip(deltas) {
                *merged = turn(delta);
            }
        }
        Ok(())
    }

    /// Area of the triangles from one on; numbers that are none count nothing.
    fn area(&self, begin: usize) -> f64 {
        let area = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|v| DVec3::from(self.mesh.positions[v as usize].map(f64::from)));
            0.5 * (b - a).cross(c - a).length()
        };
        self.mesh.triangles[begin..].iter().map(area).filter(|area| area.is_finite()).sum()
    }

    /// The mesh, with no more influences for each vertex than some vertex needs.
    pub(super) fn finish(mut self, joints: usize) -> Mesh {
        if self.stride == 0 {
            return self.mesh;
        }
        let used = |all: &[Influence]| all.iter().filter(|influence| influence.weight > 0.0).count();
        let per_vertex = self.influences.chunks_exact(self.stride).map(used).max().unwrap_or(1).max(1);
        let influences = if per_vertex < self.stride {
            self.influences.chunks_exact(self.stride).flat_map(|all| &all[..per_vertex]).copied().collect()
        } else {
            self.influences
        };
        self.mesh.skin = Some(Skin { joints, per_vertex, influences });
        self.mesh
    }
}

/// Influences that the parts of a rigged scene need for each vertex.
pub(super) fn stride(scene: &Scene<'_>, parts: &[Part<'_>]) -> Result<usize, Fault> {
    let mut stride = 1;
    for part in parts.iter().filter(|part| scene.nodes[part.place].node.skin().is_some()) {
        let sets = sets(&part.primitive).map_err(|reason| part.fault(reason))?;
        stride = stride.max(SET * sets);
    }
    Ok(stride)
}

fn vectors(
    primitive: &Primitive<'_>,
    semantic: &Semantic,
    buffers: &[Buffer],
    count: usize,
) -> Result<Option<Vec<[f32; 3]>>, String> {
    let Some(a) = primitive.get(semantic) else { return Ok(None) };
    accessor::numbers(&a, buffers, (count, "vertices")).map(Some).map_err(in_accessor(a.index()))
}

/// The inverse transpose, up to scale; zero for a transform that flattens, whose normals are then computed.
fn normal_matrix(transform: DMat4) -> DMat3 {
    let inverse_transpose = DMat3::from_mat4(transform).inverse().transpose();
    if inverse_transpose.is_finite() { inverse_transpose } else { DMat3::ZERO }
}

/// Triangles in the winding of the specification, section 3.7.2.1; the other way round where they are mirrored.
fn triangles(indices: &[u32], mode: Mode, mirrored: bool) -> Vec<[u32; 3]> {
    let mut triangles: Vec<[u32; 3]> = match mode {
        Mode::TriangleStrip => (0..indices.len().saturating_sub(2))
            .map(|i| [indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]])
            .collect(),
        Mode::TriangleFan => indices.windows(2).skip(1).map(|pair| [pair[0], pair[1], indices[0]]).collect(),
        _ => indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
    };
    if mirrored {
        triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }
    triangles
}
