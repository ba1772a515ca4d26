use translume_mesh::repair::{fill_holes, repair};
use translume_mesh::{Influence, Mesh, MorphTarget, Skin};

use crate::fixtures::{Random, Topology, clean, cube, sphere, volume};

fn without(mut mesh: Mesh, gone: impl Fn(usize) -> bool) -> Mesh {
    let kept = (0..mesh.triangles.len()).filter(|&t| !gone(t)).map(|t| mesh.triangles[t]).collect();
    mesh.triangles = kept;
    clean(mesh)
}

/// The sphere without what lies above `height`.
fn bowl(height: f32) -> Mesh {
    let sphere = sphere(3);
    let middle = |t: usize| sphere.corners(t).iter().map(|p| p[1]).sum::<f32>() / 3.0;
    without(sphere.clone(), |t| middle(t) > height)
}

fn is_closed(mesh: &Mesh) -> bool {
    Topology::of(mesh).bad_edges == 0
}

#[test]
fn a_cube_gets_its_side_back() {
    let mut mesh = without(cube(), |t| t < 2);
    assert!(!is_closed(&mesh), "the check notices a hole");
    assert_eq!(fill_holes(&mut mesh, 3), 0, "the hole has four edges");
    assert_eq!(fill_holes(&mut mesh, 4), 1);
    assert!(is_closed(&mesh));
    assert_eq!((Topology::of(&mesh).euler, mesh.triangles.len(), volume(&mesh)), (2, 12, 8.0));
}

#[test]
fn a_bowl_gets_a_flat_lid_around_one_new_vertex() {
    let open = bowl(0.5);
    let mut mesh = open.clone();
    assert_eq!(fill_holes(&mut mesh, usize::MAX), 1);
    assert!(is_closed(&mesh));
    assert_eq!(Topology::of(&mesh).euler, 2);
    assert_eq!(mesh.triangles[..open.triangles.len()], open.triangles, "what was there keeps its number");
    let (_, report) = repair(mesh.clone()).unwrap();
    assert!(report.is_pristine(), "{report}");
    // Every new triangle faces up, as the lid does.
    for t in open.triangles.len()..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(t);
        let up = (b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2]);
        assert!(up > 0.0, "triangle {t}");
    }
    assert_eq!(fill_holes(&mut mesh, usize::MAX), 0);
}

#[test]
fn new_vertices_carry_what_the_rim_carries() {
    let mut mesh = bowl(0.5);
    let count = mesh.positions.len();
    mesh.targets = vec![MorphTarget { name: "lift".into(), position_deltas: vec![[0.0, 2.0, 0.0]; count] }];
    let influences =
        (0..count).map(|v| Influence { joint: u32::from(mesh.positions[v][0] > 0.0), weight: 1.0 });
    mesh.skin = Some(Skin { joints: 2, per_vertex: 1, influences: influences.collect() });
    mesh.uvs = vec![[[0.25, 0.75]; 3]; mesh.triangles.len()];
    // Normals that point up at the rim, so that the lid continues a smooth surface.
    mesh.normals = vec![[0.0, 1.0, 0.0]; count];
    assert_eq!(fill_holes(&mut mesh, usize::MAX), 1);
    assert_eq!(mesh.positions.len(), count + 1);
    let near = |a: &[f32], b: &[f32]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
    assert!(near(&mesh.normals[count], &[0.0, 1.0, 0.0]));
    assert!(near(&mesh.targets[0].position_deltas[count], &[0.0, 2.0, 0.0]));
    assert_eq!((mesh.uvs.len(), mesh.skin.unwrap().influences.len()), (mesh.triangles.len(), count + 1));
    assert!(mesh.uvs.iter().flatten().all(|uv| near(uv, &[0.25, 0.75])));
}

#[test]
fn a_rim_with_normals_of_its_own_stays_a_hard_edge() {
    let mut mesh = bowl(0.0);
    assert_eq!(fill_holes(&mut mesh, usize::MAX), 1);
    // Normals at the equator point sideways; the lid is flat.
    let lid: Vec<_> = mesh.triangles.iter().rev().take(32).flatten().collect();
    assert!(lid.iter().all(|&&v| mesh.normals[v as usize][1] > 0.999));
    assert!(is_closed(&mesh));
}

#[test]
fn holes_that_touch_are_closed_each() {
    // So many of 512 are gone that holes touch, and islands remain.
    let mut random = Random(3);
    for _ in 0..20 {
        let gone: Vec<usize> = (0..200).map(|_| random.below(512)).collect();
        let mut mesh = without(sphere(3), |t| gone.contains(&t));
        assert!(fill_holes(&mut mesh, usize::MAX) > 1);
        assert!(is_closed(&mesh));
    }
}

/// A square of four triangles around its middle; filled, its border gets a second side whose edges must be new ones.
#[test]
fn a_sheet_gets_a_second_side() {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.1], [0.0, 1.0, 0.0]];
    let mut mesh = clean(Mesh {
        name: "sheet".into(),
        positions: corners.to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    });
    assert_eq!(fill_holes(&mut mesh, usize::MAX), 1);
    assert!(is_closed(&mesh));
}

/// A vertex in the middle of a neighbour's edge: only a triangle without area would close that.
#[test]
fn a_crack_without_area_stays_open() {
    let mut mesh = clean(cube());
    mesh.positions.push([0.0, -1.0, -1.0]);
    mesh.normals.push([0.0, 0.0, -1.0]);
    let t = mesh.triangles.iter().position(|t| t.contains(&0) && t.contains(&1)).unwrap();
    let corner =
        (0..3).find(|&k| [[0, 1], [1, 0]].contains(&[mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]]));
    let k = corner.unwrap();
    let [a, b, c] = [0, 1, 2].map(|step| mesh.triangles[t][(k + step) % 3]);
    mesh.triangles[t] = [a, 8, c];
    mesh.triangles.push([8, b, c]);
    let before = mesh.clone();
    assert_eq!(fill_holes(&mut mesh, usize::MAX), 0);
    assert_eq!(mesh, before);
}

#[test]
#[cfg(feature = "load")]
fn the_scanned_bunny_closes() {
    let Some(folder) = std::env::var_os("TRANSLUME_MODELS") else { return };
    let file = std::path::Path::new(&folder).join("stanford-bunny.obj");
    let mut mesh = translume_mesh::load::load(&file).unwrap().mesh;
    assert_eq!(fill_holes(&mut mesh, usize::MAX), 5);
    assert!(is_closed(&mesh));
    assert_eq!(Topology::of(&mesh).euler, 2);
}
