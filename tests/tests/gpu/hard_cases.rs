//! Hard cases: whatever comes in, what goes out is finite, not negative, and within what the row allows.

use glam::{Mat4, Vec3};
use std::sync::Arc;
use translume::{DirectionalLight, Light, Medium, PointLight};
use translume_tests::{
    Check, Fixture, Model, Pose, at_most, creature, gpu, holds, luminous, notices, sphere_with, sum,
};

/// What must hold of Σ B·A beside being finite and not negative.
#[derive(Clone, Copy)]
enum Energy {
    /// Not more than Σ E·A and this share of it; the comment of a row says where the share comes from.
    AtMost(f64),
    /// Nothing, which the kernel table writes as e^−80 = 2e-35 per mm² and watt.
    None,
    /// Finite is enough.
    Any,
}

struct Row {
    name: &'static str,
    medium: Medium,
    mm_per_unit: f32,
    model: Mat4,
    lights: Vec<Light>,
    energy: Energy,
}

fn sun() -> Light {
    Light::Directional(DirectionalLight { to_light: [0.3, 0.8, 0.5], ..Default::default() })
}

fn lamp(position: [f32; 3]) -> Light {
    Light::Point(PointLight { position, intensity: [1e3; 3], ..Default::default() })
}

/// A sphere of radius 50 units, 1 mm each, in the sun.
fn usual(name: &'static str, change: impl FnOnce(&mut Row)) -> Row {
    let mut row = Row {
        name,
        medium: Medium::SKIN1,
        mm_per_unit: 1.0,
        model: Mat4::IDENTITY,
        lights: vec![sun()],
        energy: Energy::AtMost(0.01),
    };
    change(&mut row);
    row
}

fn scaled(factor: f32) -> Medium {
    let by = |x: [f32; 3]| x.map(|x| x * factor);
    Medium {
        sigma_s_prime: by(Medium::MARBLE.sigma_s_prime),
        sigma_a: by(Medium::MARBLE.sigma_a),
        ..Medium::MARBLE
    }
}

fn rows() -> Vec<Row> {
    vec![
        usual("as usual", |_| ()),
        // Nothing is absorbed, and texels of 7 mm are far wider than the mean free path: at seams discs overlap. Measured 8 %.
        usual("no absorption", |r| (r.medium, r.energy) = (Medium::SPECTRALON, Energy::AtMost(0.1))),
        usual("no scattering", |r| {
            (r.medium.sigma_s_prime, r.energy) = ([0.0; 3], Energy::None);
        }),
        usual("nothing inside", |r| {
            (r.medium.sigma_s_prime, r.medium.sigma_a, r.energy) = ([0.0; 3], [0.0; 3], Energy::None);
        }),
        usual("index matched", |r| r.medium.ior = 1.0),
        usual("index below one", |r| r.medium.ior = 0.8),
        usual("index of diamond", |r| r.medium.ior = 2.4),
        usual("mean free path far below a texel", |r| r.medium = scaled(1e3)),
        usual("mean free path far above the body", |r| r.medium = scaled(1e-6)),
        usual("1 mm across", |r| r.mm_per_unit = 0.01),
        usual("100 m across", |r| r.mm_per_unit = 1000.0),
        usual("light inside", |r| (r.lights, r.energy) = (vec![lamp([1.0, 2.0, 3.0])], Energy::Any)),
        usual("light on the surface", |r| r.lights = vec![lamp([0.0, 50.0, 0.0])]),
        usual("light at a vertex of a far body", |r| {
            r.model = Mat4::from_translation(Vec3::new(1e4, 0.0, 0.0));
            r.lights = vec![lamp([1e4, 50.0, 0.0])];
        }),
        usual("light at zero intensity", |r| {
            let dark = PointLight { position: [0.0, 90.0, 0.0], intensity: [0.0; 3], ..Default::default() };
            (r.lights, r.energy) = (vec![Light::Point(dark)], Energy::None);
        }),
        usual("no light", |r| (r.lights, r.energy) = (Vec::new(), Energy::None)),
        usual("crushed flat", |r| r.model = Mat4::from_scale(Vec3::new(1.0, 1e-6, 1.0))),
        usual("stretched fourfold", |r| r.model = Mat4::from_scale(Vec3::new(4.0, 1.0, 1.0))),
        usual("mirrored", |r| r.model = Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0))),
    ]
}

fn bounded(row: &Row, model: &Arc<Model>) -> Check {
    let atlas = model.atlas.size;
    let mut fixture = Fixture::new(model, |d| {
        (d.medium, d.mm_per_unit) = (row.medium, row.mm_per_unit);
        d.shadows.resolution = 64;
    });
    fixture.run(&Pose { model: row.model, ..Pose::rest(0) }.frame(&row.lights));
    let (sources, exitance) = (fixture.sources(), fixture.exitance());
    sane(row.name, &exitance)?;
    sane(row.name, &luminous(&sources))?;
    let leaving: f64 = sum(&exitance, &sources).iter().sum();
    let entering: f64 = sum(&luminous(&sources), &sources).iter().sum();
    match row.energy {
        Energy::AtMost(share) => {
            let excess = leaving / entering - 1.0;
            at_most(
                &format!("hard case: {}, {atlas}²: leaving over entering less 1", row.name),
                excess,
                share,
            )
        }
        Energy::None => at_most(&format!("hard case: {}, {atlas}²: leaving", row.name), leaving, 1e-20),
        Energy::Any => Ok(()),
    }
}

fn sane(name: &str, values: &[[f64; 3]]) -> Check {
    let wrong = values.iter().flatten().filter(|x| !(0.0..=1e30).contains(*x)).count();
    if wrong == 0 { Ok(()) } else { Err(format!("{name}: {wrong} values are negative or not finite")) }
}

#[test]
fn hard_cases_stay_finite_and_bounded() {
    let model = sphere_with(32);
    for row in rows() {
        holds(bounded(&row, &model));
    }
}

#[test]
fn the_smallest_atlas_will_do() {
    let model = sphere_with(16);
    for name in ["as usual", "index matched", "stretched fourfold", "no light"] {
        let row = rows().into_iter().find(|row| row.name == name).unwrap();
        holds(bounded(&row, &model));
    }
}

#[test]
fn an_excess_is_noticed() {
    let model = sphere_with(32);
    notices(bounded(&usual("light where none is allowed", |r| r.energy = Energy::None), &model));
    notices(bounded(&usual("more light than allowed", |r| r.energy = Energy::AtMost(-0.9)), &model));
    notices(sane("NaN", &[[0.0, f64::NAN, 0.0]]));
    notices(sane("negative", &[[0.0, -1e-9, 0.0]]));
}

/// Many poses leave nothing behind: the first pose comes back bit for bit.
#[test]
fn many_poses_do_not_drift() {
    let mut fixture = Fixture::new(&creature(), |d| d.shadows.resolution = 16);
    let lights = [Light::Directional(DirectionalLight { shadow: false, ..Default::default() })];
    let mut show = |weight: f32| {
        let pose = Pose { weights: vec![weight], ..Pose::rest(1) };
        fixture.run(&pose.frame(&lights));
    };
    show(0.25);
    for k in 0..20 {
        show(k as f32 / 20.0);
    }
    show(0.25);
    let again = fixture.exitance();
    let mut fresh = Fixture::new(&creature(), |d| d.shadows.resolution = 16);
    fresh.run(&Pose { weights: vec![0.25], ..Pose::rest(1) }.frame(&lights));
    assert_eq!(again, fresh.exitance(), "[{}]", gpu().adapter_name);
}
