//! `translume inspect`: what models hold and how they unwrap.

use crate::cli::Inspect;
use crate::error::Error;
use crate::model::{self, Model};
use crate::progress;
use serde_json::{Value, json};
use translume_mesh::{Atlas, AtlasOptions};

pub fn run(arguments: &Inspect) -> Result<(), Error> {
    let options = model::atlas_options(&arguments.layout)?;
    if arguments.table {
        return table(arguments, &options);
    }
    let mut found = Vec::new();
    for name in &arguments.models {
        let model = model::open(name)?;
        let atlas = model::unwrap(&model.mesh, &options)?;
        if arguments.json {
            found.push(as_json(&model, &atlas));
        } else {
            tell(&model, &atlas);
        }
    }
    match found.as_slice() {
        [] => {}
        [one] => progress::print(&format!("{one:#}")),
        several => progress::print(&format!("{:#}", Value::from(several))),
    }
    Ok(())
}

fn as_json(model: &Model, atlas: &Atlas) -> Value {
    let (mesh, report, repairs) = (&model.mesh, &atlas.report, &model.repairs);
    let (low, high) = mesh.bounds().unwrap_or_default();
    let targets: Vec<_> = mesh.targets.iter().map(|target| target.name.as_str()).collect();
    json!({
        "name": mesh.name,
        "vertices": mesh.positions.len(),
        "triangles": mesh.triangles.len(),
        "morph_targets": targets,
        "bounds": { "min": low, "max": high },
        "diagonal": mesh.diagonal(),
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
        "angle_distortion": report.angle_distortion,
        "seam_length": report.seam_length,
        "flipped": report.flipped,
        "overlapping_texels": report.overlapping_texels,
        "seconds": report.seconds,
    })
}

fn tell(model: &Model, atlas: &Atlas) {
    let (mesh, report) = (&model.mesh, &atlas.report);
    let (low, high) = mesh.bounds().unwrap_or_default();
    let diagonal = mesh.diagonal();
    let lines = [
        ("model", mesh.name.clone()),
        ("vertices", mesh.positions.len().to_string()),
        ("triangles", mesh.triangles.len().to_string()),
        ("morph targets", mesh.targets.len().to_string()),
        ("bounds", format!("{low:?} to {high:?}, diagonal {diagonal:.4}")),
        ("repairs", model.repairs.to_string()),
        (
            "atlas",
            format!("{0} × {0}, {1} charts, {2} texels", atlas.size, report.charts, report.covered_texels),
        ),
        ("utilisation", format!("{:.1} %", 100.0 * report.utilisation)),
        (
            "area distortion",
            format!("cv {:.4}, 99th percentile of the ratio {:.3}", report.area_cv, report.area_ratio_p99),
        ),
        ("angle distortion", format!("{:.4}", report.angle_distortion)),
        (
            "seams",
            format!("{:.4}, {:.1} diagonals", report.seam_length, report.seam_length / f64::from(diagonal)),
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
}

/// Each model with charts evened out, and beside it as the unwrapper left them.
fn table(arguments: &Inspect, options: &AtlasOptions) -> Result<(), Error> {
    let columns = [
        "model",
        "triangles",
        "charts",
        "seconds",
        "utilisation %",
        "area cv",
        "ratio p99",
        "angle",
        "seams, diagonals",
        "flipped",
        "overlaps",
    ];
    progress::print(&format!("| {} |", columns.join(" | ")));
    progress::print(&format!("|{}", " --- |".repeat(columns.len())));
    for name in &arguments.models {
        let mesh = model::open(name)?.mesh;
        let before = model::unwrap(&mesh, &AtlasOptions { equiareal: false, ..options.clone() })?.report;
        let after = model::unwrap(&mesh, &AtlasOptions { equiareal: true, ..options.clone() })?.report;
        let pair = |figure: &dyn Fn(&translume_mesh::AtlasReport) -> String| {
            format!("{} → {}", figure(&before), figure(&after))
        };
        let diagonal = f64::from(mesh.diagonal());
        let cells = [
            mesh.name.clone(),
            mesh.triangles.len().to_string(),
            pair(&|r| r.charts.to_string()),
            pair(&|r| format!("{:.2}", r.seconds)),
            pair(&|r| format!("{:.1}", 100.0 * r.utilisation)),
            pair(&|r| format!("{:.4}", r.area_cv)),
            pair(&|r| format!("{:.3}", r.area_ratio_p99)),
            pair(&|r| format!("{:.4}", r.angle_distortion)),
            pair(&|r| format!("{:.1}", r.seam_length / diagonal)),
            pair(&|r| r.flipped.to_string()),
            pair(&|r| r.overlapping_texels.to_string()),
        ];
        progress::print(&format!("| {} |", cells.join(" | ")));
    }
    Ok(())
}
