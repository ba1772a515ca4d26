//! glTF 2.0 and GLB: the static geometry and morph targets of the default scene.
//!
//! Source: Khronos, glTF 2.0 specification.

use std::path::Path;

use glam::{Mat3, Mat4, Vec3};
use gltf::json::Root;
use gltf::mesh::{Mode, Primitive, Semantic};

use super::{LoadError, accessor, buffers};
use crate::mesh::{Mesh, MorphTarget};

/// Most vectors (positions and deltas) that a file may unfold to by using the same data again: 805 MB.
const MAX_VECTORS: usize = 1 << 26;

/// Reads a document; the bytes decide between JSON and binary.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Mesh, LoadError> {
    let file = path.display().to_string();
    let (document, blob) =
        parse(bytes).map_err(|reason| LoadError::NotAMesh { file: file.clone(), reason })?;
    let buffers = buffers::load(path, &document, blob)?;
    let mut merged = Merged { buffers, mesh: Mesh::default() };
    for (node, transform) in
        placed_nodes(&document).map_err(|(element, reason)| error(&file, element, reason))?
    {
        let Some(mesh) = node.mesh() else { continue };
        // A skin places its mesh by itself (specification, section 3.7.3.3).
        let transform = if node.skin().is_some() { Mat4::IDENTITY } else { transform };
        for primitive in mesh.primitives() {
            let element = format!("meshes[{}].primitives[{}]", mesh.index(), primitive.index());
            merged.append(&primitive, transform).map_err(|reason| error(&file, element, reason))?;
        }
    }
    if merged.mesh.triangles.is_empty() {
        return Err(LoadError::NotAMesh { file, reason: "its scene holds no triangle".into() });
    }
    Ok(merged.finish())
}

fn error(file: &str, element: String, reason: String) -> LoadError {
    LoadError::Gltf { file: file.into(), element, reason }
}

/// Parses and validates. The `gltf` crate panics on two malformed inputs, which are caught here first.
fn parse(bytes: &[u8]) -> Result<(gltf::Document, Option<Vec<u8>>), String> {
    if bytes.starts_with(b"glTF") {
        let stated = bytes.get(8..12).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
        if stated.is_none_or(|stated| (stated as usize) < 12 || stated as usize > bytes.len()) {
            return Err(format!("it is a truncated GLB: {} bytes of {}", bytes.len(), stated.unwrap_or(12)));
        }
    }
    let gltf = gltf::Gltf::from_slice_without_validation(bytes).map_err(|e| e.to_string())?;
    let mut root = gltf.document.into_json();
    check_positions(&root)?;
    // Quantised vertices are read; the crate's own list of extensions does not know them.
    root.extensions_required.retain(|name| name != "KHR_mesh_quantization");
    let document = gltf::Document::from_json(root).map_err(|e| match e {
        // One is enough to act on, and a malicious file may have millions.
        gltf::Error::Validation(errors) => {
            errors.first().map_or_else(String::new, |(path, error)| format!("{path}: {error}"))
        }
        other => other.to_string(),
    })?;
    Ok((document, gltf.blob))
}

fn check_positions(root: &Root) -> Result<(), String> {
    use gltf::json::validation::Checked;
    for (m, mesh) in root.meshes.iter().enumerate() {
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let position = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
            if let Some(index) = position.filter(|index| index.value() >= root.accessors.len()) {
                return Err(format!(
                    "meshes[{m}].primitives[{p}] uses accessor {}, but there are {}",
                    index.value(),
                    root.accessors.len()
                ));
            }
        }
    }
    Ok(())
}

/// The nodes of the default scene, each with its transform to the world, parents first.
fn placed_nodes(document: &gltf::Document) -> Result<Vec<(gltf::Node<'_>, Mat4)>, (String, String)> {
    let mut pending: Vec<_> = roots(document).into_iter().map(|node| (node, Mat4::IDENTITY)).collect();
    pending.reverse();
    let mut visited = vec![false; document.nodes().len()];
    let mut placed = Vec::new();
    while let Some((node, parent)) = pending.pop() {
        let element = || format!("nodes[{}]", node.index());
        if std::mem::replace(&mut visited[node.index()], true) {
            return Err((element(), "it has two parents or is its own ancestor".into()));
        }
        let transform = parent * Mat4::from_cols_array_2d(&node.transform().matrix());
        if !transform.is_finite() {
            return Err((element(), "its transform is not finite".into()));
        }
        let first_child = pending.len();
        pending.extend(node.children().map(|child| (child, transform)));
        pending[first_child..].reverse();
        placed.push((node, transform));
    }
    Ok(placed)
}

/// The roots of the default scene; of everything where the file has no scene.
fn roots(document: &gltf::Document) -> Vec<gltf::Node<'_>> {
    if let Some(scene) = document.default_scene().or_else(|| document.scenes().next()) {
        return scene.nodes().collect();
    }
    let mut roots: Vec<_> = document.nodes().map(Some).collect();
    for child in document.nodes().flat_map(|node| node.children().collect::<Vec<_>>()) {
        roots[child.index()] = None;
    }
    roots.into_iter().flatten().collect()
}

/// Everything read so far.
struct Merged {
    buffers: Vec<Vec<u8>>,
    mesh: Mesh,
}

impl Merged {
    fn append(&mut self, primitive: &Primitive<'_>, transform: Mat4) -> Result<(), String> {
        if matches!(primitive.mode(), Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
            return Ok(());
        }
        let in_accessor = |index: usize| move |reason: String| format!("accessors[{index}]: {reason}");
        let positions = primitive.get(&Semantic::Positions).ok_or("it has no positions")?;
        let at = in_accessor(positions.index());
        let count = accessor::position_count(&positions).map_err(at)?;
        let vectors = (self.mesh.positions.len().saturating_add(count))
            .saturating_mul(1 + self.mesh.targets.len().max(primitive.morph_targets().len()));
        if vectors > MAX_VECTORS {
            return Err(format!("the scene unfolds to more than {MAX_VECTORS} positions and deltas"));
        }
        let positions = accessor::vectors(&positions, &self.buffers, count).map_err(at)?;
        let normals = match primitive.get(&Semantic::Normals) {
            Some(a) => accessor::vectors(&a, &self.buffers, count).map_err(in_accessor(a.index()))?,
            None => vec![[0.0; 3]; count],
        };
        let indices = match primitive.indices() {
            Some(a) => accessor::indices(&a, &self.buffers).map_err(in_accessor(a.index()))?,
            None => (0..count as u32).collect(),
        };
        self.append_triangles(&indices, primitive.mode(), count, transform)?;
        self.append_targets(primitive, count, transform)?;
        let place = |p: [f32; 3]| transform.transform_point3(p.into()).to_array();
        self.mesh.positions.extend(positions.into_iter().map(place));
        let turn = normal_matrix(transform);
        self.mesh.normals.extend(normals.into_iter().map(|n| (turn * Vec3::from(n)).to_array()));
        Ok(())
    }

    fn append_triangles(
        &mut self,
        indices: &[u32],
        mode: Mode,
        count: usize,
        transform: Mat4,
    ) -> Result<(), String> {
        if let Some((place, index)) = indices.iter().enumerate().find(|(_, index)| **index as usize >= count)
        {
            return Err(format!("index {place} uses vertex {index}, but there are {count}"));
        }
        let base = self.mesh.positions.len() as u32;
        let mirrored = transform.determinant() < 0.0;
        self.mesh.triangles.extend(triangles(indices, mode).into_iter().map(|triangle| {
            let [a, b, c] = triangle.map(|v| base + v);
            if mirrored { [a, c, b] } else { [a, b, c] }
        }));
        Ok(())
    }

    /// Targets merge by their number; a primitive that lacks one does not move with it.
    fn append_targets(
        &mut self,
        primitive: &Primitive<'_>,
        count: usize,
        transform: Mat4,
    ) -> Result<(), String> {
        let base = self.mesh.positions.len();
        for (k, target) in primitive.morph_targets().enumerate() {
            let Some(a) = target.positions() else { continue };
            let deltas = accessor::vectors(&a, &self.buffers, count)
                .map_err(|reason| format!("targets[{k}]: accessors[{}]: {reason}", a.index()))?;
            if self.mesh.targets.len() <= k {
                self.mesh.targets.resize(k + 1, MorphTarget::default());
            }
            let merged = &mut self.mesh.targets[k].position_deltas;
            merged.resize(base, [0.0; 3]);
            merged.extend(deltas.into_iter().map(|d| transform.transform_vector3(d.into()).to_array()));
        }
        Ok(())
    }

    fn finish(mut self) -> Mesh {
        let count = self.mesh.positions.len();
        self.mesh.targets.iter_mut().for_each(|target| target.position_deltas.resize(count, [0.0; 3]));
        self.mesh
    }
}

/// The inverse transpose, up to scale; zero for a transform that flattens, whose normals are then computed.
fn normal_matrix(transform: Mat4) -> Mat3 {
    let linear = Mat3::from_mat4(transform);
    let inverse_transpose = linear.inverse().transpose();
    if inverse_transpose.is_finite() { inverse_transpose } else { Mat3::ZERO }
}

/// Triangles in the winding of the specification, section 3.7.2.1.
fn triangles(indices: &[u32], mode: Mode) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => (0..indices.len().saturating_sub(2))
            .map(|i| [indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]])
            .collect(),
        Mode::TriangleFan => indices.windows(2).skip(1).map(|pair| [pair[0], pair[1], indices[0]]).collect(),
        _ => indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
    }
}
