//! What must hold for any mesh, on random ones.

use proptest::prelude::*;
use translume_mesh::Mesh;
use translume_mesh::repair::{RepairOptions, fill_holes, repair_with};

use crate::fixtures::{Topology, clean, sphere, volume};

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(cases) }
}

/// Triangles among a few points of a small grid: full of repetitions, flat triangles, crowded edges and one-sided pieces.
fn soup() -> impl Strategy<Value = Mesh> {
    let point = prop::array::uniform3(0_u8..3).prop_map(|p| p.map(f32::from));
    let points = prop::collection::vec(point, 4..20);
    points.prop_flat_map(|positions| {
        let corner = 0..positions.len() as u32;
        prop::collection::vec(prop::array::uniform3(corner), 1..60).prop_map(move |triangles| Mesh {
            name: "soup".into(),
            positions: positions.clone(),
            triangles,
            ..Mesh::default()
        })
    })
}

fn options() -> impl Strategy<Value = RepairOptions> {
    let distance = prop_oneof![Just(None), Just(Some(0.0)), (1e-7_f32..1e-2).prop_map(Some)];
    let holes = prop_oneof![Just(None), Just(Some(4)), Just(Some(usize::MAX))];
    (distance, any::<bool>(), holes).prop_map(|(weld_distance, orient, fill_holes)| RepairOptions {
        weld_distance,
        orient,
        fill_holes,
    })
}

/// Which of the triangles of [`sphere`] something happens to.
fn some_of(triangles: usize) -> impl Strategy<Value = Vec<bool>> {
    prop::collection::vec(any::<bool>(), triangles)
}

proptest! {
    #![proptest_config(config(256))]

    #[test]
    fn a_repaired_mesh_needs_no_repair(mesh in soup(), options in options()) {
        let Ok((once, first)) = repair_with(mesh, &options) else { return Ok(()) };
        let (twice, second) = repair_with(once.clone(), &options).unwrap();
        prop_assert_eq!(&twice.positions, &once.positions);
        prop_assert_eq!(&twice.triangles, &once.triangles);
        // Unit normals are normalised again: one rounding.
        for (a, b) in once.normals.as_flattened().iter().zip(twice.normals.as_flattened()) {
            prop_assert!((a - b).abs() < 2e-7);
        }
        let changes = [
            second.turned_edges,
            second.dropped_degenerate,
            second.dropped_duplicate,
            second.dropped_vertices,
            second.welded_vertices,
            second.flipped_triangles,
            second.turned_normals,
            second.filled_holes,
        ];
        prop_assert_eq!(changes, [0; 8], "{}; then {}", first, second);
        let edges = |r: &translume_mesh::RepairReport| (r.boundary_edges, r.non_manifold_edges, r.inconsistent_edges);
        prop_assert_eq!(edges(&first), edges(&second));
    }

    #[test]
    fn triangles_turned_over_at_random_are_turned_back(turned in some_of(128)) {
        let whole = sphere(2);
        let mut mesh = whole.clone();
        (0..128).filter(|&t| turned[t]).for_each(|t| mesh.triangles[t].swap(0, 1));
        let mended = clean(mesh);
        prop_assert_eq!(Topology::of(&mended).bad_edges, 0);
        prop_assert!((volume(&mended) - volume(&whole)).abs() < 1e-5, "f32 positions, other corners first");
    }

    #[test]
    fn holes_of_any_shape_are_closed(gone in some_of(512), rare in any::<bool>()) {
        let mut mesh = sphere(3);
        let gone = |t: usize| gone[t] && (!rare || t.is_multiple_of(5));
        mesh.triangles = (0..512).filter(|&t| !gone(t)).map(|t| mesh.triangles[t]).collect();
        prop_assume!(!mesh.triangles.is_empty());
        let mut mesh = clean(mesh);
        let open = mesh.triangles.clone();
        fill_holes(&mut mesh, usize::MAX);
        prop_assert_eq!(Topology::of(&mesh).bad_edges, 0);
        prop_assert_eq!(&mesh.triangles[..open.len()], open.as_slice());
        prop_assert_eq!(fill_holes(&mut mesh, usize::MAX), 0);
    }
}

#[cfg(feature = "load")]
proptest! {
    #![proptest_config(config(64))]

    #[test]
    fn obj_returns_what_was_written(mesh in soup(), relative in any::<bool>(), scale in 1e-3_f32..1e3) {
        let mut mesh = mesh;
        mesh.positions.as_flattened_mut().iter_mut().for_each(|x| *x *= scale);
        mesh.name = "soup.obj".into();
        // `{}` writes the shortest number that reads back as the same.
        let mut text: String = mesh.positions.iter().map(|p| format!("v {} {} {}\n", p[0], p[1], p[2])).collect();
        let base = if relative { -(mesh.positions.len() as i64) } else { 1 };
        for triangle in &mesh.triangles {
            let corners = triangle.map(|v| (i64::from(v) + base).to_string());
            text += &format!("f {}\n", corners.join(" "));
        }
        let read = crate::fixtures::Folder::new().load("soup.obj", text);
        match repair_with(mesh, &RepairOptions::default()) {
            Ok((expected, _)) => prop_assert_eq!(read.unwrap().mesh, expected),
            Err(expected) => prop_assert_eq!(read.unwrap_err().to_string(), expected.to_string()),
        }
    }
}

/// The checks above notice a triangle too few, one turned over, and one that another run would drop.
#[test]
fn the_properties_can_fail() {
    let mut mesh = clean(sphere(2));
    mesh.triangles[7].swap(0, 1);
    assert!(Topology::of(&mesh).bad_edges > 0);
    mesh.triangles.remove(7);
    assert!(Topology::of(&mesh).bad_edges > 0);
    mesh.triangles.push(mesh.triangles[0]);
    assert_eq!(repair_with(mesh, &RepairOptions::default()).unwrap().1.dropped_duplicate, 1);
}
