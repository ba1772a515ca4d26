//! `translume inspect`: what models hold and how they unwrap.

use crate::cli::Inspect;
use crate::error::Error;
use crate::model::{self, Model};
use crate::progress;
use serde_json::{Value, json};
use translume_mesh::{AtlasReport, RepairReport};

pub fn run(arguments: &Inspect) -> Result<(), Error> {
    let mut found = Vec::new();
    if arguments.table {
        progress::print(TABLE_HEAD);
    }
    for name in &arguments.models {
        let inspected = Inspected::new(name, arguments)?;
        if arguments.json {
            found.push(inspected.as_json()?);
        } else if arguments.table {
            progress::print(&inspected.as_row());
        } else {
            inspected.tell()?;
        }
    }
    match found.as_slice() {
        [] => {}
        [one] => progress::print(&format!("{one:#}")),
        several => progress::print(&format!("{:#}", Value::from(several))),
    }
    Ok(())
}

/// A model, and its layout before and after charts are evened out.
struct Inspected {
    model: Model,
    size: u32,
    flattened: AtlasReport,
    even: AtlasReport,
}

impl Inspected {
    fn new(name: &str, arguments: &Inspect) -> Result<Self, Error> {
        let model = model::open(name)?;
        let build = |equiareal| {
            let options = arguments.layout.quality(equiareal).atlas(1.0)?;
            Ok::<_, Error>(model::unwrap(&model.mesh, &options)?.report)
        };
        let (flattened, even) = (build(false)?, build(true)?);
        Ok(Self { model, size: arguments.layout.quality(true).atlas, flattened, even })
    }

    fn animations(&self) -> Vec<&str> {
        self.model.rig.animations.iter().map(|animation| animation.name.as_str()).collect()
    }

    /// The figures of the evened layout lie beside those of the model; those of the one before under `as_flattened`.
    fn as_json(&self) -> Result<Value, Error> {
        let mesh = &self.model.mesh;
        let (low, high) = self.model.bounds()?;
        let targets: Vec<_> = mesh.targets.iter().map(|target| target.name.as_str()).collect();
        let mut value = json!({
            "name": mesh.name,
            "vertices": mesh.positions.len(),
            "triangles": mesh.triangles.len(),
            "morph_targets": targets,
            "joints": self.model.rig.joints.len(),
            "animations": self.animations(),
            "bounds": { "min": low, "max": high },
            "diagonal": self.model.diagonal()?,
            "repairs": repairs(&self.model.repairs),
            "atlas": self.size,
            "as_flattened": layout(&self.flattened),
        });
        if let (Value::Object(all), Value::Object(even)) = (&mut value, layout(&self.even)) {
            all.extend(even);
        }
        Ok(value)
    }

    fn tell(&self) -> Result<(), Error> {
        let (mesh, flattened, even) = (&self.model.mesh, &self.flattened, &self.even);
        let (low, high) = self.model.bounds()?;
        let diagonal = self.model.diagonal()?;
        let lines = [
            ("model", mesh.name.clone()),
            ("vertices", mesh.positions.len().to_string()),
            ("triangles", mesh.triangles.len().to_string()),
            ("morph targets", mesh.targets.len().to_string()),
            ("joints", self.model.rig.joints.len().to_string()),
            ("animations", self.model.animations()),
            ("bounds", format!("{low:?} to {high:?}, diagonal {diagonal:.4}")),
            ("repairs", self.model.repairs.to_string()),
            (
                "atlas",
                format!(
                    "{0} × {0}, {1} charts, {2} texels",
                    self.size, flattened.charts, flattened.covered_texels
                ),
            ),
            ("utilisation", format!("{:.1} %", 100.0 * flattened.utilisation)),
            (
                "area distortion",
                format!(
                    "cv {:.4}, 99th percentile of the ratio {:.3}; evened out {:.4}, {:.3}",
                    flattened.area_cv, flattened.area_ratio_p99, even.area_cv, even.area_ratio_p99
                ),
            ),
            (
                "angle distortion",
                format!("{:.4}; evened out {:.4}", flattened.angle_distortion, even.angle_distortion),
            ),
            ("seams", format!("{:.1} diagonals", flattened.seam_length / f64::from(diagonal))),
            (
                "faults",
                format!(
                    "{} flipped triangles, {} overlapping texels",
                    flattened.flipped.max(even.flipped),
                    flattened.overlapping_texels.max(even.overlapping_texels)
                ),
            ),
            ("seconds", format!("{:.2}; evened out {:.2}", flattened.seconds, even.seconds)),
        ];
        for (name, value) in lines {
            progress::print(&format!("{name:>16}  {value}"));
        }
        Ok(())
    }

    fn as_row(&self) -> String {
        let pair = |figure: &dyn Fn(&AtlasReport) -> String| {
            format!("{} → {}", figure(&self.flattened), figure(&self.even))
        };
        let diagonal = f64::from(self.model.mesh.diagonal());
        let cells = [
            self.model.mesh.name.clone(),
            self.model.mesh.triangles.len().to_string(),
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
        format!("| {} |", cells.join(" | "))
    }
}

/// The columns of [`Inspected::as_row`]: flattened → evened out.
const TABLE_HEAD: &str = "\
| model | triangles | charts | seconds | utilisation % | area cv | ratio p99 | angle | seams, diagonals | flipped | overlaps |
| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |";

fn repairs(repairs: &RepairReport) -> Value {
    json!({
        "turned_edges": repairs.turned_edges,
        "dropped_degenerate": repairs.dropped_degenerate,
        "dropped_duplicate": repairs.dropped_duplicate,
        "dropped_vertices": repairs.dropped_vertices,
        "welded_vertices": repairs.welded_vertices,
        "flipped_triangles": repairs.flipped_triangles,
        "turned_normals": repairs.turned_normals,
        "filled_holes": repairs.filled_holes,
        "boundary_edges": repairs.boundary_edges,
        "non_manifold_edges": repairs.non_manifold_edges,
        "inconsistent_edges": repairs.inconsistent_edges,
        "unorientable_pieces": repairs.unorientable_pieces,
    })
}

fn layout(report: &AtlasReport) -> Value {
    json!({
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
