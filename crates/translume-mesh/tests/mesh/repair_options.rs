use translume_mesh::repair::{RepairError, RepairOptions, RepairReport, repair, repair_with};
use translume_mesh::{Influence, Mesh, MorphTarget, Skin};

use crate::fixtures::{Random, Topology, clean, cube, sphere, tetrahedron, volume};

fn turn_over(mesh: &mut Mesh, triangles: impl IntoIterator<Item = usize>) {
    triangles.into_iter().for_each(|t| mesh.triangles[t].swap(1, 2));
}

/// Several meshes as one.
fn together(parts: &[Mesh]) -> Mesh {
    let mut whole = Mesh { name: "together".into(), ..Mesh::default() };
    for part in parts {
        let base = whole.positions.len() as u32;
        whole.positions.extend(&part.positions);
        whole.normals.extend(&part.normals);
        whole.triangles.extend(part.triangles.iter().map(|t| t.map(|v| base + v)));
    }
    whole
}

fn moved(mut mesh: Mesh, scale: f32, shift: f32) -> Mesh {
    mesh.positions.iter_mut().for_each(|p| *p = [p[0] * scale + shift, p[1] * scale, p[2] * scale]);
    mesh
}

fn inside_out(mut mesh: Mesh) -> Mesh {
    let all = 0..mesh.triangles.len();
    turn_over(&mut mesh, all);
    mesh
}

fn mended(mesh: Mesh) -> (Mesh, RepairReport) {
    repair(mesh).unwrap()
}

#[test]
fn triangles_turned_over_are_turned_back() {
    let whole = sphere(2);
    for count in [1, 40, 100, 128] {
        let mut mesh = whole.clone();
        let mut random = Random(count as u64);
        let mut turned: Vec<usize> = (0..count).map(|_| random.below(128)).collect();
        turned.sort_unstable();
        turned.dedup();
        turn_over(&mut mesh, turned.iter().copied());
        assert!(Topology::of(&mesh).bad_edges > 0 || turned.len() == 128, "the check notices");
        let (mesh, report) = mended(mesh);
        // Corners may come in another order.
        assert_eq!((Topology::of(&mesh).bad_edges, report.flipped_triangles), (0, turned.len()));
        assert!(volume(&mesh) > 3.5, "outwards");
    }
}

#[test]
fn a_closed_surface_faces_outwards() {
    let (mesh, report) = mended(inside_out(sphere(2)));
    assert_eq!(report.flipped_triangles, 128);
    assert_eq!(mesh.triangles, sphere(2).triangles);
    assert_eq!(report.to_string(), "128 triangles turned over, normals computed");
    let as_it_is = RepairOptions { orient: false, ..RepairOptions::default() };
    assert!(volume(&repair_with(inside_out(sphere(2)), &as_it_is).unwrap().0) < -3.5);
}

#[test]
fn a_cavity_stays_a_cavity() {
    let hollow = || together(&[sphere(2), moved(inside_out(sphere(1)), 0.5, 0.1)]);
    let (mesh, report) = mended(hollow());
    assert_eq!((report.flipped_triangles, mesh.triangles), (0, hollow().triangles));
    // Exported inside out: both turn.
    let (mesh, report) = mended(inside_out(hollow()));
    assert_eq!((report.flipped_triangles, mesh.triangles), (160, hollow().triangles));
    // Beside the sphere, though within its bounding box, it is no cavity.
    let corner = moved(inside_out(cube()), 0.05, 0.9);
    let shifted = Mesh {
        positions: corner.positions.iter().map(|p| [p[0], p[1] + 0.9, p[2] + 0.9]).collect(),
        ..corner
    };
    assert_eq!(mended(together(&[sphere(2), shifted])).1.flipped_triangles, 12);
    // In a shell in a shell in a shell everything follows the outermost.
    let nested = |k: usize| (0..k).map(|k| moved(sphere(1), 1.0 / (k + 1) as f32, 0.0)).collect::<Vec<_>>();
    assert_eq!(mended(together(&nested(4))).1.flipped_triangles, 0);
    assert_eq!(mended(inside_out(together(&nested(4)))).1.flipped_triangles, 4 * 32);
}

#[test]
fn pieces_are_turned_each_by_itself() {
    let (mesh, report) = mended(together(&[
        inside_out(cube()),
        moved(cube(), 1.0, 5.0),
        moved(inside_out(cube()), 2.0, 20.0),
    ]));
    assert_eq!((report.flipped_triangles, volume(&mesh)), (24, 8.0 + 8.0 + 64.0));
}

/// Two cubes that share an edge: it has four triangles, and each cube is closed nevertheless.
#[test]
fn a_shared_edge_leaves_both_sides_closed() {
    let mut second = inside_out(cube());
    second.positions.iter_mut().for_each(|p| *p = [p[0] + 2.0, p[1] + 2.0, p[2]]);
    let (mesh, report) = mended(together(&[cube(), second]));
    assert_eq!((report.flipped_triangles, report.non_manifold_edges, volume(&mesh)), (12, 1, 16.0));
}

#[test]
fn a_moebius_strip_is_left_alone_and_counted() {
    let mut mesh = Mesh { name: "strip".into(), ..Mesh::default() };
    const N: u32 = 16;
    for k in 0..N {
        let turn = k as f32 / N as f32 * std::f32::consts::TAU;
        for side in [-0.4, 0.4] {
            let radius = 2.0 + side * (turn / 2.0).cos();
            mesh.positions.push([radius * turn.cos(), radius * turn.sin(), side * (turn / 2.0).sin()]);
        }
        let [a, b] = [2 * k, 2 * k + 1];
        let [c, d] = if k + 1 < N { [a + 2, b + 2] } else { [1, 0] };
        mesh.triangles.extend([[a, c, b], [b, c, d]]);
    }
    let (strip, report) = mended(mesh.clone());
    assert_eq!((report.unorientable_pieces, report.flipped_triangles, report.inconsistent_edges), (1, 0, 1));
    assert_eq!(strip.triangles, mesh.triangles);
    assert!(report.to_string().contains("1 one-sided pieces"), "{report}");
    mesh.triangles.truncate(30);
    assert_eq!(mended(mesh).1.unorientable_pieces, 0, "cut open it has two sides");
}

#[test]
fn normals_and_texture_coordinates_follow_the_triangles() {
    let mut mesh = clean(sphere(2));
    mesh.uvs = (0..128).map(|t| [0, 1, 2].map(|k| [t as f32, k as f32])).collect();
    let right = mesh.clone();
    // Right normals on wrong triangles stay; wrong normals on wrong triangles turn.
    turn_over(&mut mesh, [5, 70]);
    mesh.uvs.iter_mut().for_each(|uv| uv.swap(1, 2));
    mesh.uvs.iter_mut().enumerate().filter(|(t, _)| ![5, 70].contains(t)).for_each(|(_, uv)| uv.swap(1, 2));
    let (mended_mesh, report) = mended(mesh);
    assert_eq!(report.flipped_triangles, 2);
    assert_eq!((mended_mesh.triangles, mended_mesh.uvs), (right.triangles.clone(), right.uvs.clone()));
    let outwards = |mesh: &Mesh| {
        mesh.normals.iter().zip(&mesh.positions).all(|(n, p)| (0..3).map(|k| n[k] * p[k]).sum::<f32>() > 0.9)
    };
    let mut wrong = inside_out(right);
    wrong.normals.as_flattened_mut().iter_mut().for_each(|x| *x = -*x);
    assert!(!outwards(&wrong), "the check notices");
    assert!(outwards(&mended(wrong).0));
}

/// The tetrahedron with corners of its own for every triangle.
fn split() -> Mesh {
    let whole = clean(tetrahedron());
    let corners = || whole.triangles.iter().flatten().map(|&v| v as usize);
    Mesh {
        name: "split".into(),
        positions: corners().map(|v| whole.positions[v]).collect(),
        normals: corners().map(|v| whole.normals[v]).collect(),
        triangles: (0..4).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        ..Mesh::default()
    }
}

fn welding(distance: f32) -> RepairOptions {
    RepairOptions { weld_distance: Some(distance), ..RepairOptions::default() }
}

#[test]
fn copies_of_a_vertex_become_one_if_asked_and_only_if_they_carry_the_same() {
    assert_eq!(mended(split()).0.positions.len(), 12, "numbers stay by default");
    let weld = |mesh: Mesh| {
        let (mesh, report) = repair_with(mesh, &welding(0.0)).unwrap();
        assert_eq!(mesh.positions.len() + report.welded_vertices, 12);
        assert_eq!(Topology::of(&mesh).bad_edges, 0);
        mesh
    };
    let welded = weld(split());
    assert_eq!(
        (welded.positions.len(), welded.triangles),
        (4, vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    );
    let deltas = |special: usize| {
        let position_deltas = (0..12).map(|v| [f32::from(u8::from(v == special)), 0.0, 0.0]).collect();
        vec![MorphTarget { name: String::new(), position_deltas }]
    };
    let skin = |special: usize| {
        let influences = (0..12).map(|v| Influence { joint: u32::from(v == special), weight: 1.0 }).collect();
        Some(Skin { joints: 2, per_vertex: 1, influences })
    };
    let mut hard = split();
    hard.normals[7] = [0.0, 0.0, 1.0];
    for mesh in [hard, Mesh { targets: deltas(7), ..split() }, Mesh { skin: skin(7), ..split() }] {
        assert_eq!(weld(mesh).positions.len(), 5);
    }
}

#[test]
fn what_remains_tells_where_it_came_from() {
    // Welding drops two of every three copies, a hole of more than eight edges gets a vertex in its middle.
    let mut open = sphere(3);
    let high = |v: u32| open.positions[v as usize][1] > 0.5;
    let kept = open.triangles.iter().filter(|t| !t.iter().all(|&v| high(v))).copied().collect();
    open.triangles = kept;
    let filling = RepairOptions { fill_holes: Some(40), ..RepairOptions::default() };
    for (mesh, options, made) in [(split(), welding(0.0), 0), (open, filling, 1)] {
        let (repaired, report) = repair_with(mesh.clone(), &options).unwrap();
        assert_eq!(report.origins.len(), repaired.positions.len());
        assert!(repaired.positions.len() < mesh.positions.len());
        assert_eq!(report.origins.iter().filter(|origin| **origin == RepairReport::NEW).count(), made);
        for (position, origin) in repaired.positions.iter().zip(&report.origins) {
            let expected = mesh.positions.get(*origin as usize).unwrap_or(position);
            assert_eq!(position, expected);
        }
    }
}

#[test]
fn copies_that_differ_by_rounding_close_within_a_distance() {
    let mut mesh = split();
    let mut random = Random(1);
    mesh.positions.as_flattened_mut().iter_mut().for_each(|x| *x += random.below(100) as f32 * 1e-7);
    assert_eq!(mended(mesh.clone()).1.boundary_edges, 12);
    let (welded, report) = repair_with(mesh.clone(), &welding(1e-4)).unwrap();
    assert_eq!((report.boundary_edges, welded.positions.len()), (0, 4));
    assert_eq!(
        repair_with(mesh, &welding(1e-8)).unwrap().1.boundary_edges,
        12,
        "a smaller distance does not"
    );
}

#[test]
fn weld_distances_out_of_range_are_refused() {
    for share in [-1.0, 1e-9, 0.02, f32::NAN, f32::INFINITY] {
        let error = repair_with(cube(), &welding(share)).unwrap_err();
        assert!(matches!(error, RepairError::WeldDistance { .. }), "{error}");
        assert!(error.to_string().contains("within 1e-8..=1e-2 of the diagonal"), "{error}");
    }
}

#[test]
fn holes_are_closed_before_normals_are_computed() {
    let mut open = cube();
    open.triangles.truncate(10);
    let options = RepairOptions { fill_holes: Some(4), ..RepairOptions::default() };
    let (mesh, report) = repair_with(open, &options).unwrap();
    assert_eq!((report.filled_holes, report.boundary_edges, volume(&mesh)), (1, 0, 8.0));
    // Each corner belongs to three sides, by one or two triangles: (1, 2, 2)/3 at the least. An open rim knows but two.
    assert!(mesh.normals.iter().flatten().all(|x| x.abs() > 0.3));
    let (again, report) = repair_with(mesh.clone(), &options).unwrap();
    assert_eq!((again.triangles, report.filled_holes), (mesh.triangles, 0));
}

#[test]
fn broken_texture_coordinates_and_skins_name_the_element() {
    let refused = |change: &dyn Fn(&mut Mesh)| {
        let mut mesh = cube();
        mesh.uvs = vec![[[0.0; 2]; 3]; 12];
        let influences = vec![Influence { joint: 0, weight: 1.0 }; 8];
        mesh.skin = Some(Skin { joints: 1, per_vertex: 1, influences });
        repair(mesh.clone()).unwrap();
        change(&mut mesh);
        repair(mesh).unwrap_err()
    };
    let influence = |m: &mut Mesh, v: usize, influence| m.skin.as_mut().unwrap().influences[v] = influence;
    assert!(matches!(refused(&|m| m.uvs.truncate(3)), RepairError::UvCount { uvs: 3, triangles: 12, .. }));
    assert!(matches!(refused(&|m| m.uvs[7][1][0] = f32::NAN), RepairError::Uv { triangle: 7, .. }));
    assert!(matches!(
        refused(&|m| influence(m, 5, Influence { joint: 1, weight: 1.0 })),
        RepairError::Influence { vertex: 5, joint: 1, joints: 1, .. }
    ));
    assert!(matches!(
        refused(&|m| influence(m, 2, Influence { joint: 0, weight: f32::NAN })),
        RepairError::Influence { vertex: 2, .. }
    ));
    for per_vertex in [0, 2, usize::MAX] {
        let error = refused(&|m| m.skin.as_mut().unwrap().per_vertex = per_vertex);
        assert!(matches!(error, RepairError::InfluenceCount { influences: 8, count: 8, .. }), "{error}");
    }
}
