//! Hard cases of what comes in: mended and counted, or refused by name, and never a panic.

use super::demand::{Figure, excess, unsound};
use super::scene::{Scene, USUAL, sun};
use super::way::{Bodies, Glow, Way, ceiling};
use translume::{Body, BodyDescriptor, Error};
use translume_mesh::repair::{RepairError, RepairReport, repair};
use translume_mesh::{Atlas, AtlasError, AtlasOptions, ChartSource, Mesh, builtin};
use translume_tests::{Check, Model, gpu, holds, notices, sphere_with};

/// What becomes of a mesh.
enum Fate {
    /// Mended so that the report says this, and then as sound as any.
    Mended(fn(&RepairReport) -> bool),
    /// Refused by the repair.
    Unrepaired(fn(&RepairError) -> bool),
}

type Case = (&'static str, fn(&mut Mesh), Fate);

fn cases() -> Vec<Case> {
    use Fate::{Mended, Unrepaired};
    vec![
        ("nothing wrong", |_| (), Mended(RepairReport::is_pristine)),
        ("triangle of zero area", |m| m.triangles.push([0, 0, 1]), Mended(|r| r.dropped_degenerate == 1)),
        (
            "triangle along a line",
            |m| {
                let [a, b] = [m.positions[0], m.positions[1]];
                m.positions.push([0, 1, 2].map(|k| 0.5 * (a[k] + b[k])));
                m.triangles.push([0, 1, m.positions.len() as u32 - 1]);
            },
            Mended(|r| r.dropped_degenerate + r.turned_edges == 1),
        ),
        (
            "NaN vertex",
            |m| m.positions[7][1] = f32::NAN,
            Unrepaired(|e| matches!(e, RepairError::Vertex { vertex: 7, .. })),
        ),
        (
            "infinite vertex",
            |m| m.positions[9][2] = f32::NEG_INFINITY,
            Unrepaired(|e| matches!(e, RepairError::Vertex { vertex: 9, .. })),
        ),
        (
            "unreferenced vertices, one of them NaN",
            |m| m.positions.extend([[f32::NAN; 3], [1.0; 3]]),
            Mended(|r| r.dropped_vertices == 2),
        ),
        (
            "vertex that is not there",
            |m| m.triangles[3][1] = 1_000_000,
            Unrepaired(|e| matches!(e, RepairError::Index { triangle: 3, .. })),
        ),
        (
            "non-manifold edge: a fin on the sphere",
            |m| {
                let [a, b, _] = m.triangles[0];
                m.positions.push(m.positions[a as usize].map(|x| 1.3 * x));
                m.triangles.push([a, b, m.positions.len() as u32 - 1]);
            },
            Mended(|r| r.non_manifold_edges == 1),
        ),
        (
            "flipped normals",
            |m| m.normals.as_flattened_mut().iter_mut().for_each(|x| *x = -*x),
            Mended(|r| r.turned_normals > 0),
        ),
        (
            "a third of the triangles turned over",
            |m| m.triangles.iter_mut().step_by(3).for_each(|t| t.swap(0, 1)),
            Mended(|r| r.flipped_triangles > 0 && r.inconsistent_edges == 0),
        ),
        (
            "normals that are no direction",
            |m| m.normals.iter_mut().for_each(|n| *n = [f32::NAN; 3]),
            Mended(|r| r.computed_normals),
        ),
        (
            "open boundary: half a sphere",
            |m| m.triangles.truncate(m.triangles.len() / 2),
            Mended(|r| r.boundary_edges > 0),
        ),
        ("empty mesh", |m| *m = Mesh::default(), Unrepaired(|e| matches!(e, RepairError::NoArea { .. }))),
        (
            "all in one point",
            |m| m.positions.fill([1.0; 3]),
            Unrepaired(|e| matches!(e, RepairError::NoArea { .. } | RepairError::Scale { .. })),
        ),
        (
            "larger than arithmetic",
            |m| m.positions.as_flattened_mut().iter_mut().for_each(|x| *x *= 1e30),
            Unrepaired(|e| matches!(e, RepairError::Scale { .. })),
        ),
    ]
}

fn broken(change: fn(&mut Mesh)) -> Mesh {
    let mut mesh = builtin::sphere([0.0; 3], 50.0, 2);
    change(&mut mesh);
    // A new vertex has no normal: all are computed.
    if mesh.positions.len() != mesh.normals.len() {
        mesh.normals.clear();
    }
    mesh
}

/// Mends and lights a mesh; says what went otherwise than the case says.
fn fate((name, change, fate): &Case) -> Check {
    let fail = |what: String| Err(format!("{name}: {what}"));
    match (repair(broken(*change)), fate) {
        (Ok((mesh, report)), Fate::Mended(expected)) if expected(&report) => {
            eprintln!("| {name} | mended: {report} |");
            if report.boundary_edges == 0 {
                outward(&mesh)?;
            }
            sound(name, mesh)
        }
        (Err(error), Fate::Unrepaired(expected)) if expected(&error) => {
            eprintln!("| {name} | refused: {error} |");
            Ok(())
        }
        (Ok((_, report)), _) => fail(format!("accepted with {report}")),
        (Err(error), _) => fail(error.to_string()),
    }
}

/// Normals and triangles of a sphere around the origin face outwards.
fn outward(mesh: &Mesh) -> Check {
    let along = |p: [f32; 3], n: [f32; 3]| (0..3).map(|k| p[k] * n[k]).sum::<f32>() > 0.0;
    let inwards = mesh.positions.iter().zip(&mesh.normals).filter(|(p, n)| !along(**p, **n)).count();
    let turned = mesh.triangles.iter().filter(|t| {
        let [a, b, c] = t.map(|v| glam::Vec3::from(mesh.positions[v as usize]));
        (b - a).cross(c - a).dot(a) <= 0.0
    });
    let turned = turned.count();
    if inwards + turned == 0 {
        return Ok(());
    }
    Err(format!("{}: {inwards} normals and {turned} triangles face inwards", mesh.name))
}

/// Finite, not negative, bounded, by all pairs, dual and at vertices.
fn sound(name: &'static str, mesh: Mesh) -> Check {
    // A fin may light what it stands on, and a hole shows the other side.
    let scene = Scene { model: Model::new(mesh, 32), faces: 2.0, ..Scene::ball(USUAL).lit(&[sun()]) };
    for way in Way::all().iter().filter(|way| ["all pairs", "dual", "per vertex"].contains(&way.name())) {
        let glow = way.glow(&scene, &mut Bodies::default());
        bounded(name, way, &scene, &glow)?;
    }
    Ok(())
}

fn bounded(row: &'static str, way: &Way, scene: &Scene, glow: &Glow) -> Check {
    let figure = |demand, measured, bound| Figure {
        row,
        demand,
        way: way.name(),
        column: way.column(),
        measured,
        bound,
    };
    figure("values not finite or negative", unsound(glow), 0.0).check()?;
    let totals = ceiling(way, &scene.medium);
    figure("brightest, above the bound of energy", excess(glow, totals, scene.faces), 0.05).check()
}

#[test]
fn broken_meshes_are_mended_or_refused_by_name() {
    for case in cases() {
        holds(fate(&case));
    }
}

/// Each kind of fate notices the other.
#[test]
fn another_fate_is_noticed() {
    notices(fate(&("good mesh", |_| (), Fate::Unrepaired(|_| true))));
    notices(fate(&("NaN", |m| m.positions[7][1] = f32::NAN, Fate::Mended(|_| true))));
    notices(fate(&("hole", |m| m.triangles.truncate(9), Fate::Mended(RepairReport::is_pristine))));
    let whole = broken(|_| ());
    holds(outward(&whole));
    notices(outward(&broken(|m| m.triangles[5].swap(0, 1))));
    notices(outward(&broken(|m| m.normals[5] = m.normals[5].map(|x| -x))));
    let scene = Scene::ball(USUAL).lit(&[sun()]);
    let way = &Way::all()[0];
    let mut glow = way.glow(&scene, &mut Bodies::default());
    holds(bounded("ball", way, &scene, &glow));
    let good = glow.leaving[5];
    for bad in [f64::NAN, f64::INFINITY, -1e-9, 10.0] {
        glow.leaving[5][1] = bad;
        notices(bounded("ball", way, &scene, &glow));
    }
    glow.leaving[5] = good;
    holds(bounded("ball", way, &scene, &glow));
}

/// A square of two triangles with these texture coordinates.
fn mapped(uvs: [[f32; 2]; 4]) -> Mesh {
    let positions = vec![[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [10.0, 0.0, -10.0], [0.0, 0.0, -10.0]];
    let triangles = vec![[0, 1, 2], [0, 2, 3]];
    let uvs = triangles.iter().map(|t: &[u32; 3]| t.map(|v| uvs[v as usize])).collect();
    let mesh = Mesh { name: "square".into(), positions, triangles, uvs, ..Mesh::default() };
    repair(mesh).map(|(mesh, _)| mesh).expect("a square")
}

#[test]
fn texture_coordinates_unfit_for_light_are_refused_by_name() {
    let options = AtlasOptions { size: 16, charts: ChartSource::Own, ..AtlasOptions::default() };
    let layout = |uvs| Atlas::build(&mapped(uvs), &options, |_| true);
    let whole = [[0.2, 0.8], [0.8, 0.8], [0.8, 0.2], [0.2, 0.2]];
    assert!(layout(whole).is_ok());
    let folded = [[0.2, 0.8], [0.8, 0.8], [0.8, 0.2], [0.8, 0.8]];
    let beyond = whole.map(|[u, v]| [u + 0.5, v]);
    for (name, uvs) in [("folded over one another", folded), ("out of range", beyond)] {
        let error = layout(uvs).expect_err(name);
        eprintln!("| texture coordinates {name} | refused: {error} |");
        assert!(matches!(error, AtlasError::OwnUvs { .. }), "{name}: {error}");
    }
    let endless = whole.map(|[u, _]| [u, f32::NAN]);
    let mut mesh = mapped(whole);
    mesh.uvs = mesh.triangles.iter().map(|t| t.map(|v| endless[v as usize])).collect();
    assert!(matches!(repair(mesh), Err(RepairError::Uv { triangle: 0, .. })));
}

#[test]
fn what_was_not_mended_makes_no_body() {
    let model = sphere_with(16);
    let refused = |mesh: &Mesh, atlas: &Atlas| {
        let descriptor = BodyDescriptor::new(mesh, atlas);
        let body: Result<Body, Error> = gpu().translume.create_body(&gpu().device, &descriptor);
        body.err().expect("a body of broken input")
    };
    let with = |change: fn(&mut Mesh)| {
        let mut mesh = model.mesh.clone();
        change(&mut mesh);
        mesh
    };
    let meshes: [(&str, Mesh); 4] = [
        ("empty mesh", Mesh::default()),
        ("NaN vertex", with(|m| m.positions[3] = [f32::NAN; 3])),
        ("infinite normal", with(|m| m.normals[3] = [f32::INFINITY; 3])),
        ("vertex that is not there", with(|m| m.triangles[3][0] = u32::MAX)),
    ];
    for (name, mesh) in meshes {
        let error = refused(&mesh, &model.atlas);
        eprintln!("| {name}, not mended | refused: {error} |");
        assert!(matches!(error, Error::Body { .. }), "{name}: {error}");
        let options = AtlasOptions { size: 16, ..AtlasOptions::default() };
        let unwrapped = Atlas::build(&mesh, &options, |_| true);
        // An atlas needs no normals.
        assert!(unwrapped.is_err() || name == "infinite normal", "{name}: unwrapped");
    }
    let mut atlas = model.atlas.clone();
    atlas.texels.clear();
    assert!(matches!(refused(&model.mesh, &atlas), Error::Body { .. }));
    for size in [0, 15, 8193] {
        let options = AtlasOptions { size, ..AtlasOptions::default() };
        let error = Atlas::build(&model.mesh, &options, |_| true).expect_err("a size out of range");
        assert_eq!(error, AtlasError::Size { size });
    }
}
