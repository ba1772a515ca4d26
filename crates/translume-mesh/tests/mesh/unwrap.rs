use std::sync::atomic::{AtomicUsize, Ordering};

use translume_mesh::builtin::cuboid;
use translume_mesh::{Atlas, AtlasError, AtlasOptions, ChartSource, Mesh, Progress, Texel};

use crate::atlas::area_error;
use crate::fixtures::{clean, cube, sphere, tetrahedron};

fn build(mesh: &Mesh, size: u32) -> Atlas {
    Atlas::build(mesh, &AtlasOptions { size, ..Default::default() }, |_| true).unwrap()
}

#[test]
fn unwrapped_meshes_keep_their_surface_and_use_the_texture() {
    for mesh in [clean(cube()), clean(tetrahedron()), clean(sphere(3))] {
        let atlas = build(&mesh, 96);
        // As for layouts by hand: f32 areas, 6e-8 each, against the demanded closure.
        assert!(area_error(&atlas, &mesh) < 1e-5, "{}", mesh.name);
        let report = &atlas.report;
        assert_eq!((report.flipped, report.overlapping_texels), (0, 0), "{}: {report:?}", mesh.name);
        assert!(report.charts >= 1 && report.seconds > 0.0);
        // Packing a few odd shapes with gutters wastes about half; a page whose height were not undone would be above 1
        // or stretch the charts.
        assert!((0.3..0.95).contains(&report.utilisation), "{}: {report:?}", mesh.name);
        assert!(report.area_ratio_p99 < 4.0, "the unwrapper's own bound: {report:?}");
        assert!(atlas.vertices.iter().all(|v| (v.xref as usize) < mesh.positions.len()));
    }
}

/// Flat charts are isometric, so u and v must have one scale even where the page was cropped.
#[test]
fn charts_are_not_stretched() {
    let mesh = Mesh {
        positions: vec![[0.0; 3], [8.0, 0.0, 0.0], [8.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let atlas = build(&clean(mesh), 128);
    let extent = |k: usize| {
        let along = atlas.vertices.iter().map(|v| v.uv[k]);
        along.clone().fold(0.0, f32::max) - along.fold(1.0, f32::min)
    };
    let ratio = extent(0).max(extent(1)) / extent(0).min(extent(1));
    assert!((ratio - 8.0).abs() < 1e-3, "{ratio}; UVs are rounded to 2⁻²⁴ of 1/8");
}

#[test]
fn the_number_of_threads_does_not_show() {
    let mesh = clean(sphere(3));
    let in_pool = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut atlas = pool.install(|| build(&mesh, 64));
        atlas.report.seconds = 0.0;
        atlas
    };
    assert_eq!(in_pool(1), in_pool(4));
    assert_ne!(in_pool(1), build(&clean(sphere(2)), 64));
}

#[test]
fn progress_is_told_and_can_cancel() {
    let mesh = clean(sphere(3));
    let stages = std::sync::Mutex::new(Vec::new());
    let listen = |p: Progress| {
        stages.lock().unwrap().push(p.stage);
        true
    };
    Atlas::build(&mesh, &AtlasOptions { size: 64, equiareal: true, ..Default::default() }, listen).unwrap();
    let mut stages = stages.into_inner().unwrap();
    stages.dedup();
    assert_eq!(
        stages,
        ["segmenting", "flattening", "evening out", "packing", "splitting", "rasterising", "ordering"]
    );
    for last in ["segmenting", "flattening", "evening out", "packing", "rasterising", "ordering"] {
        let after = AtomicUsize::new(0);
        let stop = |p: Progress| {
            after.fetch_add(usize::from(p.stage == last), Ordering::Relaxed);
            p.stage != last
        };
        let error =
            Atlas::build(&mesh, &AtlasOptions { size: 64, equiareal: true, ..Default::default() }, stop)
                .unwrap_err();
        assert_eq!(error, AtlasError::Cancelled { mesh: "sphere".into() });
        assert_eq!(after.into_inner(), 1, "nothing is reported after {last} was stopped");
    }
}

#[test]
fn what_cannot_be_unwrapped_is_told() {
    let refuse = |mesh: &Mesh, size, padding| {
        Atlas::build(mesh, &AtlasOptions { size, padding, ..Default::default() }, |_| true).unwrap_err()
    };
    let mesh = clean(cube());
    assert_eq!(refuse(&mesh, 8, 2), AtlasError::Size { size: 8 });
    assert_eq!(refuse(&mesh, 16, 8), AtlasError::Padding { padding: 8, size: 16 });
    assert!(matches!(refuse(&Mesh::default(), 64, 2), AtlasError::Empty { .. }));
    let mut broken = mesh.clone();
    broken.triangles[2][1] = 77;
    assert!(refuse(&broken, 64, 2).to_string().contains("triangle 2 uses vertex 77"));

    // A hundred loose tetrahedra have more charts than a 16² texture has room for gutters.
    let mut many = Mesh { name: "crowd".into(), ..Mesh::default() };
    for k in 0..100 {
        let base = many.positions.len() as u32;
        let one = tetrahedron();
        many.positions.extend(one.positions.iter().map(|p| [p[0] + 5.0 * k as f32, p[1], p[2]]));
        many.triangles.extend(one.triangles.iter().map(|t| t.map(|v| v + base)));
    }
    let error = refuse(&clean(many), 16, 2);
    assert!(matches!(error, AtlasError::DoesNotFit { size: 16, charts, .. } if charts >= 100), "{error}");
}

#[test]
fn evening_out_makes_texels_equal_and_costs_no_chart() {
    for mesh in [clean(sphere(3)), clean(tetrahedron())] {
        let options = AtlasOptions { size: 512, equiareal: true, ..Default::default() };
        let (flattened, even) = (build(&mesh, 512), Atlas::build(&mesh, &options, |_| true).unwrap());
        assert!(area_error(&even, &mesh) < 1e-5);
        let (before, after) = (&flattened.report, &even.report);
        assert!(after.area_cv < 0.01, "twice the relaxation's own goal: {after:?}");
        assert_eq!((after.charts, after.flipped, after.overlapping_texels), (before.charts, 0, 0));
        // Outlines move a little, so packing may too.
        assert!(after.utilisation > before.utilisation - 0.03, "{before:?} {after:?}");
    }
    assert!(build(&clean(sphere(3)), 128).report.area_cv > 0.01, "or there is nothing to show");
}

/// A block with a sheet beside it, and how many times finer texels of the sheet are.
fn finer_on_a_sheet(finer_below: Option<f32>, size: u32) -> f64 {
    let mut mesh = cuboid([0.0; 3], [40.0; 3], [8; 3]);
    let sheet = cuboid([60.0, 0.0, 0.0], [100.0, 2.0, 40.0], [20, 1, 20]);
    let (base, block) = (mesh.positions.len() as u32, mesh.triangles.len());
    mesh.positions.extend(sheet.positions);
    mesh.normals.extend(sheet.normals);
    mesh.triangles.extend(sheet.triangles.iter().map(|t| t.map(|v| v + base)));
    let mesh = clean(Mesh { positions: mesh.positions, triangles: mesh.triangles, ..Mesh::default() });
    let options = AtlasOptions { size, finer_below, ..Default::default() };
    let atlas = Atlas::build(&mesh, &options, |_| true).unwrap();
    assert!(area_error(&atlas, &mesh) < 1e-5);
    assert_eq!((atlas.report.flipped, atlas.report.overlapping_texels), (0, 0));
    let beside = |sheet: bool| move |t: &&Texel| (t.triangle as usize >= block) == sheet;
    let density = |sheet: bool, area: f64| atlas.texels.iter().filter(beside(sheet)).count() as f64 / area;
    density(true, 2.0 * 1600.0 + 4.0 * 80.0) / density(false, 6.0 * 1600.0)
}

/// A quarter of the thickness: four times as many texels, and a little less at the sheet's rim, which is not thin.
#[test]
fn texels_are_finer_where_it_is_thin() {
    let finer = finer_on_a_sheet(Some(8.0), 256);
    assert!((3.3..4.3).contains(&finer), "{finer}");
    let same = finer_on_a_sheet(None, 256);
    assert!((0.9..1.1).contains(&same), "{same}");
    let mesh = clean(cube());
    for below in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let options = AtlasOptions { finer_below: Some(below), ..Default::default() };
        let error = Atlas::build(&mesh, &options, |_| true).unwrap_err();
        assert!(matches!(error, AtlasError::FinerBelow { .. }), "{error}");
    }
}

/// A sphere with the texture coordinates of an unwrapping, as an artist might have stored them.
fn textured_sphere() -> Mesh {
    let mut mesh = clean(sphere(3));
    let atlas = build(&mesh, 128);
    mesh.uvs = atlas.triangles.iter().map(|t| t.map(|v| atlas.vertices[v as usize].uv)).collect();
    mesh
}

fn build_own(mesh: &Mesh, size: u32) -> Result<Atlas, AtlasError> {
    Atlas::build(mesh, &AtlasOptions { size, charts: ChartSource::Own, ..Default::default() }, |_| true)
}

#[test]
fn own_texture_coordinates_are_kept_where_they_are_fit() {
    let mesh = textured_sphere();
    let atlas = build_own(&mesh, 128).unwrap();
    let kept = atlas.triangles.iter().map(|t| t.map(|v| atlas.vertices[v as usize].uv));
    assert_eq!(kept.collect::<Vec<_>>(), mesh.uvs);
    assert!(area_error(&atlas, &mesh) < 1e-5);
    let fresh = build(&mesh, 128).report;
    assert_eq!((atlas.report.charts, atlas.report.flipped), (fresh.charts, 0));
    assert!((atlas.report.seam_length / fresh.seam_length - 1.0).abs() < 1e-9);
    // A texture read upside down mirrors every chart and folds none.
    let mut mirrored = mesh;
    mirrored.uvs.as_flattened_mut().iter_mut().for_each(|uv| uv[1] = 1.0 - uv[1]);
    assert_eq!(build_own(&mirrored, 128).unwrap().report.flipped, 0);
}

#[test]
fn own_texture_coordinates_that_are_unfit_are_refused_with_the_reason() {
    let refuse = |change: &dyn Fn(&mut Mesh), size, reason: &str| {
        let mut mesh = textured_sphere();
        change(&mut mesh);
        let error = build_own(&mesh, size).unwrap_err();
        assert!(matches!(error, AtlasError::OwnUvs { .. }) && error.to_string().contains(reason), "{error}");
        let options = AtlasOptions { size: 128, charts: ChartSource::OwnOrUnwrap, ..Default::default() };
        let unwrapped = Atlas::build(&mesh, &options, |_| true).unwrap().report;
        assert_eq!((unwrapped.flipped, unwrapped.overlapping_texels), (0, 0), "unwrapped instead");
    };
    refuse(&|mesh| mesh.uvs.clear(), 128, "it has none");
    refuse(&|mesh| mesh.uvs[7][2][0] = 1.5, 128, "triangle 7 leave [0, 1]");
    refuse(&|mesh| mesh.uvs[7][2][0] = f32::NAN, 128, "triangle 7 leave [0, 1]");
    refuse(
        &|mesh| mesh.uvs.iter_mut().for_each(|uvs| *uvs = [[0.1, 0.1], [0.9, 0.1], [0.1, 0.9]]),
        128,
        "lie on one another",
    );
    // One vertex of a triangle pulled across the edge opposite to it, with all who share it.
    let fold = |mesh: &mut Mesh| {
        let [a, b, c] = mesh.uvs[7];
        let beyond = std::array::from_fn(|k| b[k] + c[k] - 0.9 * a[k] - 0.1 * b[k]);
        mesh.uvs.as_flattened_mut().iter_mut().filter(|uv| **uv == a).for_each(|uv| *uv = beyond);
    };
    refuse(&fold, 128, "turned over within their chart");
}

#[test]
fn charts_without_gutters_are_refused_at_sizes_where_they_meet() {
    // Two quads of a strip, cut, with a gap of 1/32 between them: four texels at 128², one at 32².
    let mut mesh = clean(Mesh {
        positions: vec![
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [1.0, 1.0, 0.0],
            [2.0, 1.0, 0.0],
        ],
        triangles: vec![[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]],
        ..Mesh::default()
    });
    let quad = |u: f32| [[u, 0.25], [u + 0.25, 0.25], [u + 0.25, 0.5], [u, 0.5]];
    let [p, q] = [quad(0.125), quad(0.40625)];
    mesh.uvs = vec![[p[0], p[1], p[2]], [p[0], p[2], p[3]], [q[0], q[1], q[2]], [q[0], q[2], q[3]]];
    build_own(&mesh, 128).unwrap();
    let error = build_own(&mesh, 32).unwrap_err().to_string();
    assert!(error.contains("closer than two texels"), "{error}");
}
