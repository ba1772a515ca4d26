use std::path::{Path, PathBuf};

use translume_mesh::load::{EXTENSIONS, load};
use translume_mesh::{Atlas, AtlasOptions};

use crate::atlas::area_error;

fn models() -> Option<PathBuf> {
    std::env::var_os("TRANSLUME_MODELS").map(PathBuf::from)
}

/// Every model of a folder, in order.
fn files(folder: &Path) -> Vec<PathBuf> {
    let known = |path: &PathBuf| {
        let extension = path.extension().and_then(|e| e.to_str());
        extension.is_some_and(|e| EXTENSIONS.contains(&e))
    };
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).filter(known).collect();
    files.sort();
    files
}

#[test]
fn real_models_load_and_unwrap() {
    let Some(folder) = models() else { return };
    for name in files(&folder) {
        let loaded = load(&name).unwrap();
        let name = loaded.mesh.name.as_str();
        // Half of them with charts evened out.
        let options =
            AtlasOptions { size: 256, equiareal: name.len().is_multiple_of(2), ..Default::default() };
        let atlas = Atlas::build(&loaded.mesh, &options, |_| true).unwrap();
        let error = area_error(&atlas, &loaded.mesh);
        println!("{name}: {}; {:?}", loaded.repairs, atlas.report);
        // Single areas are stored in f32, 6e-8 each.
        assert!(error < 1e-5, "{name}: {error:e}");
        assert!(atlas.report.covered_texels > 256 * 256 / 4);
        assert_eq!((atlas.report.flipped, atlas.report.overlapping_texels), (0, 0), "{name}");
    }
}

/// Figures for every model: `cargo test --release -p translume-mesh -- --ignored --nocapture every_model`.
#[test]
#[ignore = "takes seconds per model; for reading, in release"]
fn every_model_in_figures() {
    let Some(folder) = models() else { return };
    for file in files(&folder) {
        let start = std::time::Instant::now();
        let loaded = load(&file).unwrap();
        let seconds = start.elapsed().as_secs_f64();
        let mesh = &loaded.mesh;
        println!(
            "{}: {} triangles, {} vertices, {} targets, loaded in {seconds:.3} s; {}",
            mesh.name,
            mesh.triangles.len(),
            mesh.positions.len(),
            mesh.targets.len(),
            loaded.repairs
        );
        for (size, equiareal) in [(128, true), (256, true), (512, true), (512, false)] {
            let options = AtlasOptions { size, equiareal, ..Default::default() };
            match Atlas::build(mesh, &options, |_| true) {
                Ok(atlas) => {
                    let start = std::time::Instant::now();
                    let again =
                        Atlas::from_uvs(mesh, size, atlas.vertices.clone(), atlas.triangles.clone()).unwrap();
                    println!(
                        "  {size}²: {} texels, raster and order {:.3} s, area error {:.1e}, {:?}",
                        again.texels.len(),
                        start.elapsed().as_secs_f64(),
                        area_error(&atlas, mesh),
                        atlas.report
                    );
                }
                Err(error) => println!("  {size}²: {error}"),
            }
        }
    }
}
