use proptest::prelude::*;
use translume_mesh::{Atlas, AtlasError, AtlasReport, AtlasVertex, Mesh};

use crate::fixtures::{area, clean, cube, grid_atlas, grid_layout, sphere, tetrahedron};

/// Relative: single areas are stored in f32, 6e-8 each; the demanded closure is 1e-5.
const CLOSURE: f64 = 1e-5;

pub fn area_error(atlas: &Atlas, mesh: &Mesh) -> f64 {
    let sum: f64 = atlas.texels.iter().map(|t| f64::from(t.area)).sum();
    (sum / area(mesh) - 1.0).abs()
}

fn meshes() -> Vec<Mesh> {
    vec![clean(cube()), clean(tetrahedron()), clean(sphere(2))]
}

#[test]
fn texel_areas_add_up_to_the_surface() {
    assert!((area(&cube()) - 24.0).abs() < 1e-12, "six sides of 2 by 2");
    for mesh in meshes() {
        let error = area_error(&grid_atlas(&mesh, 200), &mesh);
        assert!(error < CLOSURE, "{}: {error:e}", mesh.name);
    }
}

#[test]
fn area_closure_notices_a_missing_texel() {
    let mesh = clean(sphere(2));
    let mut atlas = grid_atlas(&mesh, 200);
    let smallest_visible = (CLOSURE * area(&mesh)) as f32;
    let lost = atlas.texels.iter().position(|t| t.area > smallest_visible).unwrap();
    atlas.texels.remove(lost);
    assert!(area_error(&atlas, &mesh) > CLOSURE);
}

/// Whether bilinear filtering inside charts reads only texels that stand for their own pixel.
fn covered_texels_have_a_ring(atlas: &Atlas) -> bool {
    let size = atlas.size as i64;
    atlas.texels.iter().filter(|t| t.area > 0.0).all(|texel| {
        let [x, y] = texel.pixel.map(i64::from);
        (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x + dx, y + dy))).all(|(x, y)| {
            if !(0..size).contains(&x) || !(0..size).contains(&y) {
                return true;
            }
            let index = atlas.pixels[(y * size + x) as usize];
            atlas.texels.get(index as usize).is_some_and(|t| t.pixel.map(i64::from) == [x, y])
        })
    })
}

#[test]
fn every_covered_texel_has_a_ring_of_texels() {
    for mesh in meshes() {
        assert!(covered_texels_have_a_ring(&grid_atlas(&mesh, 160)), "{}", mesh.name);
    }
}

#[test]
fn the_ring_test_notices_a_missing_rim() {
    let mut atlas = grid_atlas(&clean(cube()), 160);
    let rim = atlas.texels.iter().position(|t| t.area == 0.0).unwrap();
    let [x, y] = atlas.texels[rim].pixel.map(usize::from);
    atlas.pixels[y * 160 + x] = (rim as u32 + 1) % atlas.texels.len() as u32;
    assert!(!covered_texels_have_a_ring(&atlas));
}

/// Largest distance between a texel's centre and the UV its weights lead to, in texels.
fn centre_error(atlas: &Atlas) -> f32 {
    let size = atlas.size as f32;
    let errors = atlas.texels.iter().map(|texel| {
        let uv = atlas.triangles[texel.triangle as usize].map(|v| atlas.vertices[v as usize].uv);
        let found = texel.interpolate(uv);
        let centre = texel.pixel.map(|k| (f32::from(k) + 0.5) / size);
        (found[0] - centre[0]).abs().max((found[1] - centre[1]).abs()) * size
    });
    errors.fold(0.0, f32::max)
}

#[test]
fn weights_lead_back_to_the_centre() {
    // 200 texels · 2⁻²⁴ for UVs near 1, times weights up to 1 + 2·4: 1e-4.
    for mesh in meshes() {
        let error = centre_error(&grid_atlas(&mesh, 200));
        assert!(error < 1e-4, "{}: {error:e}", mesh.name);
    }
}

#[test]
fn the_centre_test_notices_a_shift_by_a_hundredth_of_a_texel() {
    let mut atlas = grid_atlas(&clean(cube()), 200);
    atlas.vertices.iter_mut().for_each(|v| v.uv[0] += 0.01 / 200.0);
    assert!(centre_error(&atlas) > 1e-3);
}

#[test]
fn pixels_name_their_texel_and_gutters_the_nearest() {
    let atlas = grid_atlas(&clean(cube()), 160);
    let distance = |pixel: usize, index: usize| {
        let [x, y] = atlas.texels[index].pixel.map(i64::from);
        ((pixel % 160) as i64 - x).pow(2) + ((pixel / 160) as i64 - y).pow(2)
    };
    let mut gutter = 0;
    for (pixel, &index) in atlas.pixels.iter().enumerate() {
        let nearest = (0..atlas.texels.len()).map(|k| distance(pixel, k)).min().unwrap();
        if index == Atlas::EMPTY {
            assert!(nearest > 4 * 4, "pixel {pixel} is within reach and empty");
        } else {
            gutter += usize::from(nearest > 0);
            assert_eq!(distance(pixel, index as usize), nearest, "pixel {pixel}");
        }
    }
    assert!(gutter > 0);
}

#[test]
fn slivers_are_not_extrapolated_without_bound() {
    let mesh = Mesh {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    let mesh = clean(mesh);
    let uvs = [[0.2, 0.2], [0.8, 0.7], [0.5, 0.4502]];
    let vertices = (0..).zip(uvs).map(|(xref, uv)| AtlasVertex { xref, uv }).collect();
    let atlas = Atlas::from_uvs(&mesh, 64, vertices, vec![[0, 1, 2]]).unwrap();
    let beyond = |[second, third]: [f32; 2]| {
        [1.0 - second - third, second, third].iter().map(|w| (-w).max(0.0)).sum::<f32>()
    };
    let farthest = atlas.texels.iter().map(|t| beyond(t.barycentric)).fold(0.0, f32::max);
    // The bound is reached, and kept but for the rounding of weights of size 5.
    assert!((farthest - Atlas::MAX_EXTRAPOLATION).abs() < 1e-5, "{farthest}");
    assert!(area_error(&atlas, &mesh) < CLOSURE);
}

#[test]
fn a_triangle_without_uv_area_keeps_its_surface() {
    let mesh = clean(cube());
    let (mut vertices, triangles) = grid_layout(&mesh, 100, 3.0);
    let uv = vertices[3].uv;
    vertices[3..6].iter_mut().for_each(|v| v.uv = uv);
    let atlas = Atlas::from_uvs(&mesh, 100, vertices, triangles).unwrap();
    assert!(area_error(&atlas, &mesh) < CLOSURE);
    assert!(atlas.texels.iter().all(|t| t.barycentric.iter().all(|w| w.is_finite())));
}

#[test]
fn the_report_tells_flips_overlaps_and_charts() {
    let mesh = clean(cube());
    let good = grid_atlas(&mesh, 128).report;
    assert_eq!((good.charts, good.flipped, good.overlapping_texels), (12, 0, 0));
    // Twelve equal triangles in UV for twelve equal triangles in space; UVs are rounded to 2⁻²⁴.
    assert!(good.area_cv < 1e-5 && (good.area_ratio_p99 - 1.0).abs() < 1e-5, "{good:?}");

    let (mut vertices, triangles) = grid_layout(&mesh, 128, 2.0);
    for k in 0..3 {
        vertices[k].uv = vertices[k + 3].uv;
    }
    let bad = Atlas::from_uvs(&mesh, 128, vertices, triangles).unwrap().report;
    assert!(bad.overlapping_texels > 100 && bad.utilisation < good.utilisation, "{bad:?}");
}

/// A square of two triangles whose shared edge is cut or not, with the second triangle folded back or not.
fn square_report(second: [[f32; 2]; 3]) -> AtlasReport {
    let mesh = clean(Mesh {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    });
    let first = [[0.2, 0.2], [0.5, 0.2], [0.5, 0.5]];
    let corners =
        [(0, first[0]), (1, first[1]), (2, first[2]), (0, second[0]), (2, second[1]), (3, second[2])];
    let vertices = corners.map(|(xref, uv)| AtlasVertex { xref, uv }).to_vec();
    Atlas::from_uvs(&mesh, 64, vertices, vec![[0, 1, 2], [3, 4, 5]]).unwrap().report
}

#[test]
fn a_fold_is_a_flip_and_a_mirrored_chart_is_none() {
    let whole = square_report([[0.2, 0.2], [0.5, 0.5], [0.2, 0.5]]);
    assert_eq!((whole.charts, whole.flipped, whole.seam_length), (1, 0, 0.0));
    assert!((whole.angle_distortion - 1.0).abs() < 1e-6, "isometric up to rounding of UVs: {whole:?}");
    // The third corner on the same side as the first triangle's: smaller, so that the chart knows which way it faces.
    let folded = square_report([[0.2, 0.2], [0.5, 0.5], [0.45, 0.3]]);
    assert_eq!((folded.charts, folded.flipped), (1, 1));
    assert!(folded.angle_distortion > 1.1, "{folded:?}");
    let cut = square_report([[0.6, 0.2], [0.9, 0.5], [0.6, 0.5]]);
    assert_eq!((cut.charts, cut.flipped), (2, 0));
    assert!((cut.seam_length - 2.0_f64.sqrt()).abs() < 1e-12, "the diagonal, once: {cut:?}");
    let mirrored = square_report([[0.9, 0.2], [0.6, 0.5], [0.9, 0.5]]);
    assert_eq!((mirrored.charts, mirrored.flipped), (2, 0));
}

#[test]
fn unequal_texels_show_in_the_report() {
    let mesh = clean(cube());
    let (mut vertices, triangles) = grid_layout(&mesh, 128, 2.0);
    vertices[1].uv[0] -= 0.1;
    let report = Atlas::from_uvs(&mesh, 128, vertices, triangles).unwrap().report;
    assert!(report.area_cv > 0.1 && report.area_ratio_p99 > 1.5, "{report:?}");
}

#[test]
fn wrong_layouts_are_refused_by_name() {
    let mesh = clean(cube());
    let (vertices, triangles) = grid_layout(&mesh, 64, 2.0);
    type Change = fn(&mut Vec<AtlasVertex>, &mut Vec<[u32; 3]>);
    let refuse = |change: Change, what: &str| {
        let (mut vertices, mut triangles) = (vertices.clone(), triangles.clone());
        change(&mut vertices, &mut triangles);
        let error = Atlas::from_uvs(&mesh, 64, vertices, triangles).unwrap_err().to_string();
        assert!(error.starts_with("cube: ") && error.contains(what), "{error}");
    };
    refuse(|v, _| v[7].uv[1] = f32::NAN, "atlas vertex 7");
    refuse(|v, _| v[8].uv[0] = 1.5, "atlas vertex 8");
    refuse(|v, _| v[10].xref = 99, "triangle 3");
    refuse(|_, t| t[4][1] = 1000, "triangle 4");
    refuse(|_, t| t.truncate(11), "there are 11, but the mesh has 12");
}

#[test]
fn wrong_sizes_and_meshes_are_refused() {
    let mesh = clean(cube());
    let (vertices, triangles) = grid_layout(&mesh, 64, 2.0);
    let build = |mesh: &Mesh, size| Atlas::from_uvs(mesh, size, vertices.clone(), triangles.clone());
    for size in [0, 15, 8193] {
        assert_eq!(build(&mesh, size).unwrap_err(), AtlasError::Size { size });
    }
    assert!(matches!(build(&Mesh::default(), 64), Err(AtlasError::Empty { .. })));
    let mut broken = mesh.clone();
    broken.positions[3][1] = f32::INFINITY;
    assert!(build(&broken, 64).unwrap_err().to_string().contains("vertex 3"));
    let mut flat = mesh;
    flat.positions.iter_mut().for_each(|p| *p = [0.0; 3]);
    assert!(matches!(build(&flat, 64), Err(AtlasError::Empty { .. })));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any triangle anywhere in the texture, however thin, keeps its surface, and its texels stay finite.
    #[test]
    fn any_triangle_keeps_its_surface(uvs in prop::array::uniform3(prop::array::uniform2(0.0_f32..=1.0)), thin in 0.0_f32..1.0) {
        let mut uvs = uvs;
        let far = thin.powi(8);
        uvs[2] = std::array::from_fn(|k| uvs[0][k] + far * (uvs[2][k] - uvs[0][k]));
        let mesh = Mesh {
            positions: vec![[0.0; 3], [3.0, 0.0, 0.0], [0.0, 0.5, 0.0]],
            normals: vec![[0.0, 0.0, 1.0]; 3],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let vertices = (0..).zip(uvs).map(|(xref, uv)| AtlasVertex { xref, uv }).collect();
        let atlas = Atlas::from_uvs(&mesh, 40, vertices, vec![[0, 1, 2]]).unwrap();
        prop_assert!(area_error(&atlas, &mesh) < CLOSURE, "{}", area_error(&atlas, &mesh));
        prop_assert!(atlas.texels.iter().all(|t| t.barycentric.iter().all(|w| w.abs() <= 9.1)));
        prop_assert!(covered_texels_have_a_ring(&atlas));
    }
}
