use translume_mesh::Mesh;
use translume_mesh::normals::{NormalAdjacency, deformed_normals, smooth_normals};

use crate::fixtures::{clean, cube, sphere};

fn largest_difference(a: &[[f32; 3]], b: &[[f32; 3]]) -> f32 {
    assert_eq!(a.len(), b.len());
    a.as_flattened().iter().zip(b.as_flattened()).map(|(x, y)| (x - y).abs()).fold(0.0, f32::max)
}

/// The cube with four vertices a side and hard edges.
fn hard_cube() -> Mesh {
    let soft = cube();
    let mut mesh = Mesh { name: "hard cube".into(), ..Mesh::default() };
    for quad in soft.triangles.chunks_exact(2) {
        let base = mesh.positions.len() as u32;
        let corners = [quad[0][0], quad[0][1], quad[0][2], quad[1][2]].map(|v| soft.positions[v as usize]);
        let normal: [f32; 3] = std::array::from_fn(|k| corners.iter().map(|c| c[k]).sum::<f32>() / 4.0);
        mesh.positions.extend(corners);
        mesh.normals.extend([normal; 4]);
        mesh.triangles.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
    }
    clean(mesh)
}

/// The sphere with every triangle's vertices of its own, smooth normals.
fn split_sphere() -> Mesh {
    let sphere = clean(sphere(3));
    let corners = || sphere.triangles.iter().flatten().map(|&v| v as usize);
    Mesh {
        positions: corners().map(|v| sphere.positions[v]).collect(),
        normals: corners().map(|v| sphere.normals[v]).collect(),
        triangles: (0..sphere.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        ..Mesh::default()
    }
}

#[test]
fn normals_of_a_sphere_are_its_positions() {
    let sphere = sphere(4);
    let normals = smooth_normals(&sphere.positions, &sphere.triangles);
    // Facets of edge 0.1 lean to all sides by their circumradius, 0.06; in the sum that must cancel but for their
    // unequal areas, so to well under half.
    let error = largest_difference(&normals, &sphere.positions);
    assert!(error < 0.03, "{error}");
    let flipped: Vec<_> = sphere.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    assert!(largest_difference(&smooth_normals(&sphere.positions, &flipped), &sphere.positions) > 1.0);
}

#[test]
fn copies_of_a_vertex_share_one_normal() {
    let split = split_sphere();
    assert_eq!(split.normals, smooth_normals(&split.positions, &split.triangles));
}

#[test]
fn a_two_sided_sheet_keeps_its_sides() {
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let positions = [square, square].concat();
    let normals = smooth_normals(&positions, &[[0, 1, 2], [3, 5, 4]]);
    assert_eq!(normals[..3], [[0.0, 0.0, 1.0]; 3]);
    assert_eq!(normals[3..], [[0.0, 0.0, -1.0]; 3]);
    // On shared vertices the sides cancel and nothing is left to choose from.
    assert_eq!(smooth_normals(&square, &[[0, 1, 2], [0, 2, 1]]), [[0.0, 1.0, 0.0]; 3]);
}

#[test]
fn adjacency_reproduces_the_rest_normals() {
    for mesh in [clean(sphere(3)), split_sphere(), hard_cube(), clean(cube())] {
        let adjacency = NormalAdjacency::build(&mesh);
        let normals = deformed_normals(&adjacency, &mesh.positions, &mesh.triangles);
        // A dozen f32 sums of cross products: about 1e-6.
        let error = largest_difference(&normals, &mesh.normals);
        assert!(error < 2e-6, "{}: {error:e}", mesh.name);
        assert_eq!(adjacency.offsets.len(), mesh.positions.len() + 1);
        for v in 0..mesh.positions.len() {
            assert!(adjacency.row(v).windows(2).all(|pair| pair[0] < pair[1]), "row {v} ascends");
        }
    }
}

#[test]
fn hard_edges_stay_hard_and_copies_stay_together() {
    let hard = hard_cube();
    let adjacency = NormalAdjacency::build(&hard);
    assert!((0..24).all(|v| adjacency.row(v).iter().all(|&t| t / 2 == v as u32 / 4)), "one side each");

    let split = split_sphere();
    let adjacency = NormalAdjacency::build(&split);
    // Three edges of the octahedron end in each corner, so at least four triangles touch every position.
    assert!((0..split.positions.len()).all(|v| adjacency.row(v).len() >= 4));
    // Stretching must move all copies of a normal alike.
    let stretched: Vec<_> = split.positions.iter().map(|&[x, y, z]| [x, 3.0 * y, z]).collect();
    let normals = deformed_normals(&adjacency, &stretched, &split.triangles);
    let smooth = smooth_normals(&stretched, &split.triangles);
    assert!(largest_difference(&normals, &smooth) < 2e-6);
    assert!(largest_difference(&normals, &split.normals) > 0.1, "the stretch shows");
}

#[test]
fn crushed_poses_give_finite_normals() {
    let mesh = clean(sphere(2));
    let adjacency = NormalAdjacency::build(&mesh);
    for pose in [[0.0, 0.0, 0.0], [1e-38, 0.0, 0.0], [3e38, 3e38, 3e38]] {
        let crushed: Vec<_> =
            mesh.positions.iter().map(|p| std::array::from_fn(|k| p[k] * pose[k])).collect();
        let normals = deformed_normals(&adjacency, &crushed, &mesh.triangles);
        assert!(normals.as_flattened().iter().all(|x| x.is_finite()), "{pose:?}");
    }
}
