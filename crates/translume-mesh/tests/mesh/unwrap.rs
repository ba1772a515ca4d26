use std::sync::atomic::{AtomicUsize, Ordering};

use translume_mesh::{Atlas, AtlasError, AtlasOptions, Mesh, Progress};

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
    Atlas::build(&mesh, &AtlasOptions { size: 64, ..Default::default() }, listen).unwrap();
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
        let error = Atlas::build(&mesh, &AtlasOptions { size: 64, ..Default::default() }, stop).unwrap_err();
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
