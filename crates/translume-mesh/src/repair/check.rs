//! What no repair can mend.

use super::error::{DIAGONALS, RepairError};
use crate::mesh::{Influence, Mesh};

/// Errors where dropping would change what the artist meant.
pub(crate) fn check(mesh: &Mesh) -> Result<(), RepairError> {
    let name = || mesh.name.clone();
    let count = mesh.positions.len();
    let mut used = vec![false; count];
    for (triangle, corners) in mesh.triangles.iter().enumerate() {
        for &vertex in corners {
            *used.get_mut(vertex as usize).ok_or_else(|| RepairError::Index {
                mesh: name(),
                triangle,
                vertex,
                count,
            })? = true;
        }
    }
    let broken = |points: &[[f32; 3]]| {
        let mut used = used.iter().zip(points);
        used.position(|(&used, p)| used && !p.iter().all(|x| x.is_finite()))
    };
    if let Some(vertex) = broken(&mesh.positions) {
        return Err(RepairError::Vertex { mesh: name(), vertex, position: mesh.positions[vertex] });
    }
    for (target, deltas) in mesh.targets.iter().map(|t| &t.position_deltas).enumerate() {
        if deltas.len() != count {
            return Err(RepairError::TargetCount { mesh: name(), target, deltas: deltas.len(), count });
        }
        if let Some(vertex) = broken(deltas) {
            return Err(RepairError::TargetDelta { mesh: name(), target, vertex, delta: deltas[vertex] });
        }
    }
    if !mesh.normals.is_empty() && mesh.normals.len() != count {
        return Err(RepairError::NormalCount { mesh: name(), normals: mesh.normals.len(), count });
    }
    check_uvs(mesh)?;
    check_skin(mesh)?;
    // A mesh without extent has no area either, and that is the clearer message.
    let diagonal = mesh.diagonal();
    if diagonal != 0.0 && !DIAGONALS.contains(&diagonal) {
        return Err(RepairError::Scale { mesh: name(), diagonal });
    }
    Ok(())
}

fn check_uvs(mesh: &Mesh) -> Result<(), RepairError> {
    let (uvs, triangles) = (mesh.uvs.len(), mesh.triangles.len());
    if uvs != 0 && uvs != triangles {
        return Err(RepairError::UvCount { mesh: mesh.name.clone(), uvs, triangles });
    }
    for (triangle, corners) in mesh.uvs.iter().enumerate() {
        if let Some(&uv) = corners.iter().find(|uv| !uv.iter().all(|x| x.is_finite())) {
            return Err(RepairError::Uv { mesh: mesh.name.clone(), triangle, uv });
        }
    }
    Ok(())
}

fn check_skin(mesh: &Mesh) -> Result<(), RepairError> {
    let Some(skin) = &mesh.skin else { return Ok(()) };
    let (influences, count) = (skin.influences.len(), mesh.positions.len());
    if skin.per_vertex == 0 || count.checked_mul(skin.per_vertex) != Some(influences) {
        let per_vertex = skin.per_vertex;
        return Err(RepairError::InfluenceCount { mesh: mesh.name.clone(), influences, per_vertex, count });
    }
    let broken = |i: &Influence| i.joint as usize >= skin.joints || !i.weight.is_finite();
    match skin.influences.iter().position(broken) {
        Some(place) => Err(RepairError::Influence {
            mesh: mesh.name.clone(),
            vertex: place / skin.per_vertex,
            joint: skin.influences[place].joint,
            weight: skin.influences[place].weight,
            joints: skin.joints,
        }),
        None => Ok(()),
    }
}
