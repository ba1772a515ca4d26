use translume_mesh::repair::{RepairError, RepairOptions, RepairReport, repair, repair_with};
use translume_mesh::{Mesh, MorphTarget};

use crate::fixtures::{cube, sphere, tetrahedron};

fn counts(mesh: Mesh) -> RepairReport {
    repair(mesh).unwrap().1
}

#[test]
fn closed_meshes_come_through() {
    for mesh in [cube(), tetrahedron(), sphere(3)] {
        let (repaired, report) = repair(mesh.clone()).unwrap();
        assert!(report.is_pristine() && report.computed_normals, "{report}");
        assert_eq!((repaired.positions, repaired.triangles), (mesh.positions, mesh.triangles));
        assert_eq!(report.to_string(), "closed, nothing to repair, normals computed");
    }
}

#[test]
fn repairing_twice_changes_nothing() {
    let (once, _) = repair(sphere(2)).unwrap();
    let (twice, report) = repair(once.clone()).unwrap();
    assert!(!report.computed_normals);
    // Unit normals are normalised again: one rounding.
    for (a, b) in once.normals.as_flattened().iter().zip(twice.normals.as_flattened()) {
        assert!((a - b).abs() < 2e-7);
    }
}

#[test]
fn what_cannot_carry_light_is_dropped_and_counted() {
    let mut mesh = cube();
    mesh.positions.extend([[0.0, 0.0, 1.0], [f32::NAN; 3], [1.0, 1.0, 1.0 + 1e-6]]);
    // A repeated vertex, a line, a sliver, a repeated triangle, the same from the other side.
    let [a, b, c] = mesh.triangles[0];
    mesh.triangles.splice(0..0, [[0, 0, 1], [4, 7, 8], [3, 7, 10], [b, c, a], [c, b, a]]);
    mesh.targets
        .push(MorphTarget { name: "t".into(), position_deltas: (0..11).map(|k| [k as f32; 3]).collect() });
    let (mesh, report) = repair(mesh).unwrap();
    assert_eq!((report.dropped_degenerate, report.dropped_duplicate, report.dropped_vertices), (3, 1, 3));
    assert_eq!((report.non_manifold_edges, report.boundary_edges, report.inconsistent_edges), (3, 0, 0));
    assert_eq!((mesh.positions.len(), mesh.triangles.len(), mesh.normals.len()), (8, 13, 8));
    assert_eq!(mesh.targets[0].position_deltas[7], [7.0; 3]);
}

#[test]
fn a_corner_on_an_edge_leaves_no_slit() {
    // The middle of an edge of a cube, in a triangle between the edge and one of its two neighbours.
    let mut mesh = cube();
    let [a, b, c] = mesh.triangles[0];
    let middle = |k: usize| 0.5 * (mesh.positions[a as usize][k] + mesh.positions[b as usize][k]);
    mesh.positions.push([0, 1, 2].map(middle));
    mesh.triangles.splice(0..1, [[a, 8, c], [8, b, c], [8, a, b]]);
    let repaired = |mesh: &Mesh| repair(mesh.clone()).unwrap();
    let (mended, report) = repaired(&mesh);
    assert_eq!(
        (report.turned_edges, report.dropped_degenerate, report.boundary_edges),
        (1, 0, 0),
        "{report}"
    );
    assert_eq!((mended.triangles.len(), mended.positions.len()), (14, 9));
    // With the edge in a seam of the texture nobody knows the neighbour's coordinates in the middle.
    mesh.uvs = vec![[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]; 14];
    let (_, report) = repaired(&mesh);
    assert_eq!(
        (report.turned_edges, report.dropped_degenerate, report.boundary_edges),
        (0, 1, 3),
        "{report}"
    );
    // Without a seam they are those of the flat triangle.
    let at = |mesh: &Mesh, t: usize| mesh.triangles[t].map(|v| [0, 1].map(|k| mesh.positions[v as usize][k]));
    mesh.uvs = (0..14).map(|t| at(&mesh, t)).collect();
    let (mended, report) = repaired(&mesh);
    assert_eq!((report.turned_edges, report.boundary_edges), (1, 0), "{report}");
    assert_eq!(mended.uvs, (0..14).map(|t| at(&mended, t)).collect::<Vec<_>>());
}

#[test]
fn vertices_keep_their_data_when_others_go() {
    let mut mesh = tetrahedron();
    mesh.positions.insert(1, [f32::INFINITY; 3]);
    mesh.triangles.iter_mut().flatten().filter(|v| **v > 0).for_each(|v| *v += 1);
    mesh.targets.push(MorphTarget {
        name: String::new(),
        position_deltas: vec![[0.0; 3], [f32::NAN; 3], [1.0; 3], [2.0; 3], [3.0; 3]],
    });
    let (mesh, report) = repair(mesh).unwrap();
    assert_eq!((report.dropped_vertices, report.origins), (1, vec![0, 2, 3, 4]));
    assert_eq!((mesh.positions, mesh.triangles), (tetrahedron().positions, tetrahedron().triangles));
    assert_eq!(mesh.targets[0].position_deltas, [[0.0; 3], [1.0; 3], [2.0; 3], [3.0; 3]]);
}

#[test]
fn edges_are_counted() {
    let mut open = cube();
    open.triangles.truncate(10);
    assert_eq!(counts(open).boundary_edges, 4);
    let mut flipped = cube();
    flipped.triangles[0].swap(1, 2);
    let as_it_is = RepairOptions { orient: false, ..RepairOptions::default() };
    assert_eq!(repair_with(flipped.clone(), &as_it_is).unwrap().1.inconsistent_edges, 3);
    let oriented = counts(flipped);
    assert_eq!((oriented.inconsistent_edges, oriented.flipped_triangles), (0, 1));
    let mut split = cube();
    split.positions.push(split.positions[0]);
    split.triangles[0][0] = 8;
    assert!(counts(split).is_pristine(), "copies of a vertex are one point");
}

#[test]
fn unusable_normals_are_computed_and_others_kept() {
    let mut mesh = tetrahedron();
    mesh.normals = vec![[2.0, 0.0, 0.0], [0.0; 3], [f32::NAN, 0.0, 0.0], [0.0, 0.0, 0.5]];
    let (mesh, report) = repair(mesh).unwrap();
    assert!(report.computed_normals);
    assert_eq!((mesh.normals[0], mesh.normals[3]), ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]));
    // By symmetry the normals of a tetrahedron point along its corners.
    for v in [1, 2] {
        for k in 0..3 {
            assert!((mesh.normals[v][k] - mesh.positions[v][k] / 3_f32.sqrt()).abs() < 1e-6);
        }
    }
}

#[test]
fn normals_of_the_other_side_are_turned_around() {
    let (whole, _) = repair(sphere(2)).unwrap();
    let turned = |share: usize| {
        let mut mesh = whole.clone();
        mesh.normals.iter_mut().skip(1).step_by(share).for_each(|n| *n = n.map(|x| -x));
        repair(mesh).unwrap()
    };
    let (mesh, report) = turned(1);
    // All but the first were turned, so the first is the one that is wrong now.
    assert_eq!(report.turned_normals, whole.normals.len());
    // Unit normals are normalised again: one rounding.
    for (a, b) in mesh.normals[1..].as_flattened().iter().zip(whole.normals[1..].as_flattened()) {
        assert!((a - b).abs() < 2e-7);
    }
    let (_, report) = turned(3);
    assert_eq!(report.turned_normals, 0, "a third may be what the artist meant");
    let as_it_is = RepairOptions { orient: false, ..RepairOptions::default() };
    let mut inwards = whole.clone();
    inwards.normals.as_flattened_mut().iter_mut().for_each(|x| *x = -*x);
    assert_eq!(repair_with(inwards, &as_it_is).unwrap().1.turned_normals, 0);
}

#[test]
fn errors_name_the_element() {
    let refused = |change: &dyn Fn(&mut Mesh)| {
        let mut mesh = cube();
        change(&mut mesh);
        let error = repair(mesh).unwrap_err();
        assert!(error.to_string().starts_with("cube: "), "{error}");
        error
    };
    let index = refused(&|m| m.triangles[5][2] = 8);
    assert_eq!(
        index.to_string(),
        "cube: triangle 5 (from 0) uses vertex 8, but there are 8; re-export the file or repair its indices"
    );
    assert!(matches!(refused(&|m| m.positions[6][0] = f32::NAN), RepairError::Vertex { vertex: 6, .. }));
    assert!(matches!(
        refused(&|m| m.targets = vec![MorphTarget::default()]),
        RepairError::TargetCount { target: 0, deltas: 0, count: 8, .. }
    ));
    let infinite = MorphTarget { name: String::new(), position_deltas: vec![[f32::INFINITY; 3]; 8] };
    assert!(matches!(
        refused(&|m| m.targets = vec![infinite.clone()]),
        RepairError::TargetDelta { target: 0, vertex: 0, .. }
    ));
    assert!(matches!(
        refused(&|m| m.normals = vec![[0.0; 3]]),
        RepairError::NormalCount { normals: 1, count: 8, .. }
    ));
    assert!(matches!(refused(&|m| m.triangles.clear()), RepairError::NoArea { triangles: 0, .. }));
    let flat = refused(&|m| m.positions.iter_mut().for_each(|p| *p = [p[0], p[0], p[0]]));
    assert!(matches!(flat, RepairError::NoArea { triangles: 12, .. }), "{flat}");
    for scale in [1e-30, 1e-8, 1e10, 3e38] {
        let error = refused(&|m| m.positions.as_flattened_mut().iter_mut().for_each(|x| *x *= scale));
        assert!(matches!(error, RepairError::Scale { .. } | RepairError::NoArea { .. }), "{error}");
    }
}

#[test]
fn size_alone_drops_nothing() {
    for scale in [1e-6, 1e-3, 1e3, 2e8] {
        let mut mesh = sphere(4);
        mesh.positions.as_flattened_mut().iter_mut().for_each(|x| *x *= scale);
        assert!(counts(mesh).is_pristine(), "scale {scale}");
    }
}
