//! Wavefront OBJ: the statements `v`, `vt`, `vn` and `f`; everything else carries no geometry.
//!
//! Source: "Appendix B1. Object Files (.obj)", Wavefront Advanced Visualizer manual, 1992.

mod statements;
mod vertices;

use std::mem::take;

use super::LoadError;
use super::listener::Listener;
use super::polygon::Cutter;
use crate::mesh::Mesh;
use statements::{Statements, place};
use vertices::Vertices;

/// Reads the text of an OBJ file. Vertices keep their numbers; copies for further normals follow after them.
pub(super) fn read(bytes: Vec<u8>, listener: &Listener<'_>) -> Result<Mesh, LoadError> {
    let not_a_mesh = |reason: &str| LoadError::NotAMesh { file: listener.file.into(), reason: reason.into() };
    if bytes.contains(&0) {
        return Err(not_a_mesh("it holds binary data"));
    }
    let statements = Statements::parse(&bytes, listener)?;
    drop(bytes);
    if statements.faces().next().is_none() {
        return Err(not_a_mesh("it holds no face"));
    }
    statements.check(listener.file)?;
    mesh(statements, listener.file)
}

fn mesh(mut statements: Statements, file: &str) -> Result<Mesh, LoadError> {
    let mut vertices = Vertices::new(take(&mut statements.positions), take(&mut statements.normals));
    let mut mesh = Mesh::default();
    let textured = statements.corners.iter().all(|corner| corner.uv.is_some());
    let mut cutter = Cutter::new();
    let mut triangles = Vec::new();
    for (face, corners) in (1..).zip(statements.faces()) {
        let points = corners.iter().map(|corner| vertices.positions[place(corner.vertex)]);
        triangles.clear();
        cutter.cut(points, &mut triangles).map_err(|_| LoadError::Polygon {
            file: file.into(),
            face,
            corners: corners.len(),
        })?;
        for triangle in &triangles {
            let corners = triangle.map(|k| corners[k as usize]);
            mesh.triangles.push(corners.map(|corner| vertices.index(corner)));
            if textured {
                mesh.uvs.push(corners.map(|c| c.uv.map_or([0.0; 2], |uv| statements.uvs[place(uv)])));
            }
        }
    }
    (mesh.positions, mesh.normals) = vertices.finish();
    Ok(mesh)
}
