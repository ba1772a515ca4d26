//! Five hundred meshes that nobody made by hand: what comes out must be fit for light all the same.

use translume_mesh::{Atlas, AtlasOptions, AtlasReport, Mesh};

use crate::atlas::area_error;
use crate::fixtures::{Random, clean, sphere, tetrahedron};

/// A sheet of quads over a grid, joined at its ends where asked.
fn sheet(columns: u32, rows: u32, closed: [bool; 2], place: impl Fn(f32, f32) -> [f32; 3]) -> Mesh {
    let [across, down] = [columns + u32::from(!closed[0]), rows + u32::from(!closed[1])];
    let positions = (0..down * across)
        .map(|k| place((k % across) as f32 / columns as f32, (k / across) as f32 / rows as f32))
        .collect();
    let vertex = |x: u32, y: u32| (y % down) * across + x % across;
    let quads = (0..columns * rows).map(|k| (k % columns, k / columns));
    let triangles = quads
        .flat_map(|(x, y)| {
            let [a, b, c, d] = [vertex(x, y), vertex(x + 1, y), vertex(x + 1, y + 1), vertex(x, y + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    Mesh { name: "sheet".into(), positions, triangles, ..Mesh::default() }
}

fn random_mesh(seed: u64) -> Mesh {
    use std::f32::consts::TAU;
    let mut dice = Random(seed);
    let [a, b, c] = dice.point(1.0);
    let mut mesh = match seed % 10 {
        // Smooth and lumpy.
        0 | 1 => {
            let mut mesh = sphere(2 + dice.below(2));
            for p in &mut mesh.positions {
                let lump = 1.0 + 0.4 * ((5.0 * a + 3.0) * p[0]).sin() + 0.3 * (7.0 * b * p[1] * p[2]).cos();
                *p = p.map(|x| x * lump);
            }
            mesh
        }
        // Crumpled: every vertex shaken.
        2 => {
            let mut mesh = sphere(2 + dice.below(2));
            let shake = 0.02 + 0.2 * a.abs();
            for p in &mut mesh.positions {
                let by = dice.point(shake);
                *p = std::array::from_fn(|k| p[k] + by[k]);
            }
            mesh
        }
        // Spikes.
        3 => {
            let mut mesh = sphere(3);
            for p in &mut mesh.positions {
                let reach = if dice.below(9) == 0 { 1.0 + 3.0 * b.abs() } else { 1.0 };
                *p = p.map(|x| x * reach);
            }
            mesh
        }
        // A torus, squashed.
        4 => sheet(24, 12, [true, true], |u, v| {
            let (u, v) = (TAU * u, -TAU * v);
            let r = 2.0 + (0.7 + 0.2 * a) * v.cos();
            [r * u.cos(), (0.5 + 0.4 * b) * v.sin(), r * u.sin()]
        }),
        // Hills.
        5 => sheet(20, 20, [false, false], |u, v| [u, 0.3 * (9.0 * a * u).sin() * (8.0 * b * v).cos(), v]),
        // A Möbius strip: the last row meets the first turned over, left open by a hair.
        6 => sheet(4, 40, [false, false], |u, v| {
            let (angle, wide) = (TAU * 0.999 * v, u - 0.5);
            let r = 2.0 + wide * (angle / 2.0).cos();
            [r * angle.cos(), wide * (angle / 2.0).sin(), r * angle.sin()]
        }),
        // Loose triangles.
        7 => Mesh {
            name: "soup".into(),
            positions: (0..3 * 60).map(|_| dice.point(1.0)).collect(),
            triangles: (0..60).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
            ..Mesh::default()
        },
        // Triangles over shared vertices: non-manifold edges everywhere.
        8 => Mesh {
            name: "tangle".into(),
            positions: (0..20).map(|_| dice.point(1.0)).collect(),
            triangles: (0..50).map(|_| std::array::from_fn(|_| dice.below(20) as u32)).collect(),
            ..Mesh::default()
        },
        // Pieces of very different sizes.
        _ => {
            let mut mesh = Mesh { name: "crowd".into(), ..Mesh::default() };
            for k in 0..12 {
                let (one, base) = (tetrahedron(), mesh.positions.len() as u32);
                let size = 10.0_f32.powf(-2.0 * dice.signed().abs());
                let by = dice.point(5.0);
                mesh.positions.extend(one.positions.iter().map(|p| -> [f32; 3] {
                    std::array::from_fn(|i| {
                        by[i] + size * p[i] * if i == k % 3 { 1.0 + 5.0 * c.abs() } else { 1.0 }
                    })
                }));
                mesh.triangles.extend(one.triangles.iter().map(|t| t.map(|v| v + base)));
            }
            mesh
        }
    };
    mesh.name = format!("random {seed}");
    clean(mesh)
}

fn is_fit(report: &AtlasReport) -> bool {
    (report.flipped, report.overlapping_texels) == (0, 0)
}

#[test]
fn random_meshes_become_atlases_fit_for_light() {
    use rayon::prelude::*;
    let unfit: Vec<String> = (0..500_u64)
        .into_par_iter()
        .filter_map(|seed| {
            let mesh = random_mesh(seed);
            // Every kind of mesh with charts evened out and not.
            let options =
                AtlasOptions { size: 128, equiareal: (seed / 10).is_multiple_of(2), ..Default::default() };
            let atlas = Atlas::build(&mesh, &options, |_| true);
            let complaint = match atlas {
                // Single areas are stored in f32, 6e-8 each.
                Ok(atlas) if is_fit(&atlas.report) && area_error(&atlas, &mesh) < 1e-5 => return None,
                Ok(atlas) => format!("{:?}", atlas.report),
                Err(error) => error.to_string(),
            };
            Some(format!("{}, {} triangles: {complaint}", mesh.name, mesh.triangles.len()))
        })
        .collect();
    assert!(unfit.is_empty(), "{} of 500:\n{}", unfit.len(), unfit.join("\n"));
}

/// The same question must be answered with no where charts are put on one another or folded.
#[test]
fn bad_layouts_are_noticed() {
    let mesh = random_mesh(0);
    let atlas = Atlas::build(&mesh, &AtlasOptions { size: 128, ..Default::default() }, |_| true).unwrap();
    let again = |change: &dyn Fn([f32; 2]) -> [f32; 2]| {
        let mut vertices = atlas.vertices.clone();
        vertices.iter_mut().for_each(|v| v.uv = change(v.uv));
        is_fit(&Atlas::from_uvs(&mesh, 128, vertices, atlas.triangles.clone()).unwrap().report)
    };
    assert!(again(&|uv| uv));
    assert!(!again(&|[u, v]| [0.5 - (u - 0.5).abs(), v]), "folded over the middle");
}
