//! Vertices: unused ones, equal ones, nearly equal ones, and their normals.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use super::retain;
use crate::mesh::Mesh;
use crate::normals::smooth_normals;
use crate::weld::weld;

/// Moves every vertex to the first one within `distance`, model units, that has not moved itself.
pub(super) fn snap(positions: &mut [[f32; 3]], distance: f64) {
    // Vertices that stay are farther apart than the distance, so that a cell of that size holds at most a few.
    let mut cells: HashMap<[i64; 3], Vec<[f32; 3]>> = HashMap::new();
    for position in positions.iter_mut().filter(|p| p.iter().all(|x| x.is_finite())) {
        let point = DVec3::from(position.map(f64::from));
        let cell = (point / distance).floor().to_array().map(|x| x as i64);
        let near =
            |&&p: &&[f32; 3]| DVec3::from(p.map(f64::from)).distance_squared(point) <= distance * distance;
        let found = neighbourhood(cell).find_map(|cell| cells.get(&cell)?.iter().find(near));
        match found {
            Some(&other) => *position = other,
            None => cells.entry(cell).or_default().push(*position),
        }
    }
}

/// The cell and the 26 around it.
fn neighbourhood(cell: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    (0..27).map(move |k| {
        let step = [k % 3, k / 3 % 3, k / 9];
        std::array::from_fn(|axis| cell[axis].saturating_add(step[axis] - 1))
    })
}

/// Lets triangles use the first of several vertices that carry the same; returns how many are no longer used.
pub(super) fn join_equal(mesh: &mut Mesh) -> usize {
    let welded = weld(&mesh.positions);
    let mut kinds: HashMap<u32, Vec<u32>> = HashMap::new();
    let mut joined = 0;
    let representatives: Vec<u32> = (0_u32..)
        .zip(&welded)
        .map(|(v, &position)| {
            let others = kinds.entry(position).or_default();
            if let Some(&other) = others.iter().find(|&&other| carry_the_same(mesh, v, other)) {
                joined += 1;
                return other;
            }
            others.push(v);
            v
        })
        .collect();
    mesh.triangles.iter_mut().flatten().for_each(|v| *v = representatives[*v as usize]);
    joined
}

fn carry_the_same(mesh: &Mesh, a: u32, b: u32) -> bool {
    let (a, b) = (a as usize, b as usize);
    let influences = |v: usize| {
        mesh.skin.as_ref().and_then(|s| s.influences.get(v * s.per_vertex..(v + 1) * s.per_vertex))
    };
    mesh.normals.get(a) == mesh.normals.get(b)
        && mesh.targets.iter().all(|t| t.position_deltas[a] == t.position_deltas[b])
        && influences(a) == influences(b)
}

/// Drops vertices that no triangle uses, and their `origins`; returns how many.
pub(super) fn drop_unused(mesh: &mut Mesh, origins: &mut Vec<u32>) -> usize {
    let mut used = vec![false; mesh.positions.len()];
    mesh.triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
    let unused = used.iter().filter(|&&used| !used).count();
    if unused == 0 {
        return 0;
    }
    let before = used.iter().scan(0, |kept, &used| {
        let number = *kept;
        *kept += u32::from(used);
        Some(number)
    });
    let renumbered: Vec<u32> = before.collect();
    mesh.triangles.iter_mut().flatten().for_each(|v| *v = renumbered[*v as usize]);
    retain(origins, &used);
    retain(&mut mesh.positions, &used);
    retain(&mut mesh.normals, &used);
    mesh.targets.iter_mut().for_each(|target| retain(&mut target.position_deltas, &used));
    if let Some(skin) = &mut mesh.skin {
        let used: Vec<bool> =
            used.iter().flat_map(|&used| std::iter::repeat_n(used, skin.per_vertex)).collect();
        retain(&mut skin.influences, &used);
    }
    unused
}

/// Negates all normals where most of them point away from their triangles: the file means the other side. Returns how many that were.
pub(super) fn turn_normals(mesh: &mut Mesh) -> usize {
    let sides = smooth_normals(&mesh.positions, &mesh.triangles);
    let points_away =
        |(normal, side): (&[f32; 3], &[f32; 3])| Vec3::from(*normal).dot(Vec3::from(*side)) < 0.0;
    let away = mesh.normals.iter().zip(&sides).filter(|&pair| points_away(pair)).count();
    if 2 * away <= mesh.normals.len() {
        return 0;
    }
    mesh.normals.as_flattened_mut().iter_mut().for_each(|x| *x = -*x);
    mesh.normals.len()
}

/// Brings normals to unit length, and computes those that are missing, zero or not finite; returns whether there were such.
pub(super) fn complete_normals(mesh: &mut Mesh) -> bool {
    mesh.normals.resize(mesh.positions.len(), [0.0; 3]);
    let units: Vec<Option<Vec3>> = mesh.normals.iter().map(|&n| Vec3::from(n).try_normalize()).collect();
    let incomplete = units.contains(&None);
    let computed = if incomplete { smooth_normals(&mesh.positions, &mesh.triangles) } else { Vec::new() };
    for (v, unit) in units.into_iter().enumerate() {
        mesh.normals[v] = unit.map_or_else(|| computed[v], |n| n.to_array());
    }
    incomplete
}
