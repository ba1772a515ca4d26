//! From a name on the command line to a clean mesh and its atlas.

use crate::cli::Layout;
use crate::error::Error;
use crate::progress;
use std::path::Path;
use translume_mesh::{Atlas, AtlasOptions, ChartSource, Mesh, RepairReport, builtin, load};

/// A mesh and what had to be done to it.
pub struct Model {
    pub mesh: Mesh,
    pub repairs: RepairReport,
}

/// A built-in model by its name, else a file.
pub fn open(name: &str) -> Result<Model, Error> {
    if !Path::new(name).exists()
        && let Some(mesh) = builtin::builtin(name)
    {
        return clean(mesh);
    }
    open_file(Path::new(name))
}

/// A mesh file.
pub fn open_file(path: &Path) -> Result<Model, Error> {
    let loaded = load::load(path)?;
    Ok(Model { mesh: loaded.mesh, repairs: loaded.repairs })
}

/// A mesh made here, through the same checks as one from a file.
pub fn clean(mesh: Mesh) -> Result<Model, Error> {
    let (mesh, repairs) = translume_mesh::repair::repair(mesh)?;
    Ok(Model { mesh, repairs })
}

/// What the command line says of the atlas.
pub fn atlas_options(layout: &Layout) -> Result<AtlasOptions, Error> {
    let charts = match layout.charts.as_str() {
        "unwrap" => ChartSource::Unwrap,
        "own" => ChartSource::Own,
        "auto" => ChartSource::OwnOrUnwrap,
        other => {
            let problem = format!("no source of charts is called \"{other}\"; known are unwrap, own, auto");
            return Err(Error::Option { option: "--charts", problem });
        }
    };
    Ok(AtlasOptions { size: layout.atlas, charts, equiareal: !layout.uneven, ..Default::default() })
}

/// Builds an atlas behind a progress bar.
pub fn unwrap(mesh: &Mesh, options: &AtlasOptions) -> Result<Atlas, Error> {
    let bar = progress::bar("unwrap");
    let atlas = Atlas::build(mesh, options, |step| progress::show(&bar, &step));
    bar.finish_and_clear();
    Ok(atlas?)
}

/// Turns a model whose z axis points up, as CAD programs and scanners write them.
pub fn turn_z_up(mesh: &mut Mesh) {
    let deltas = mesh.targets.iter_mut().flat_map(|target| &mut target.position_deltas);
    for vector in mesh.positions.iter_mut().chain(&mut mesh.normals).chain(deltas) {
        *vector = [vector[0], vector[2], -vector[1]];
    }
}
