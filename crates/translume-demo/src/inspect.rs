//! `translume inspect`: what a model holds and how it unwraps.

use crate::cli::Inspect;
use crate::error::Error;
use crate::{model, progress};
use serde_json::json;

pub fn run(arguments: &Inspect) -> Result<(), Error> {
    let model = model::open(&arguments.model)?;
    let atlas = model::unwrap(&model.mesh, arguments.atlas)?;
    let (mesh, report, repairs) = (&model.mesh, &atlas.report, &model.repairs);
    let (low, high) = model.bounds()?;
    let diagonal = model.diagonal()?;
    let animations: Vec<_> = model.rig.animations.iter().map(|animation| animation.name.as_str()).collect();
    if arguments.json {
        let targets: Vec<_> = mesh.targets.iter().map(|target| target.name.as_str()).collect();
        let value = json!({
            "name": mesh.name,
            "vertices": mesh.positions.len(),
            "triangles": mesh.triangles.len(),
            "morph_targets": targets,
            "joints": model.rig.joints.len(),
            "animations": animations,
            "bounds": { "min": low, "max": high },
            "diagonal": diagonal,
            "repairs": {
                "dropped_degenerate": repairs.dropped_degenerate,
                "dropped_duplicate": repairs.dropped_duplicate,
                "dropped_vertices": repairs.dropped_vertices,
                "boundary_edges": repairs.boundary_edges,
                "non_manifold_edges": repairs.non_manifold_edges,
                "inconsistent_edges": repairs.inconsistent_edges,
            },
            "atlas": atlas.size,
            "charts": report.charts,
            "texels": report.covered_texels,
            "utilisation": report.utilisation,
            "area_cv": report.area_cv,
            "area_ratio_p99": report.area_ratio_p99,
            "flipped": report.flipped,
            "overlapping_texels": report.overlapping_texels,
            "seconds": report.seconds,
        });
        progress::print(&format!("{value:#}"));
        return Ok(());
    }
    let lines = [
        ("model", mesh.name.clone()),
        ("vertices", mesh.positions.len().to_string()),
        ("triangles", mesh.triangles.len().to_string()),
        ("morph targets", mesh.targets.len().to_string()),
        ("joints", model.rig.joints.len().to_string()),
        ("animations", model.animations()),
        ("bounds", format!("{low:?} to {high:?}, diagonal {diagonal:.4}")),
        ("repairs", repairs.to_string()),
        (
            "atlas",
            format!("{0} × {0}, {1} charts, {2} texels", atlas.size, report.charts, report.covered_texels),
        ),
        ("utilisation", format!("{:.1} %", 100.0 * report.utilisation)),
        (
            "area distortion",
            format!("cv {:.4}, 99th percentile of the ratio {:.3}", report.area_cv, report.area_ratio_p99),
        ),
        (
            "faults",
            format!("{} flipped triangles, {} overlapping texels", report.flipped, report.overlapping_texels),
        ),
        ("seconds", format!("{:.2}", report.seconds)),
    ];
    for (name, value) in lines {
        progress::print(&format!("{name:>16}  {value}"));
    }
    Ok(())
}
