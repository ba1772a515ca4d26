use std::ops::ControlFlow;

use glam::{DVec3, Vec3};
use proptest::prelude::*;
use translume_mesh::normals::{NormalAdjacency, deformed_normals};
use translume_mesh::repair::repair_with;
use translume_mesh::spherical::{Egg, EggOptions, Spherical, SphericalError, to_egg, to_sphere};
use translume_mesh::{Mesh, RepairOptions, Skin};

use crate::fixtures::{Random, Topology, area, clean, cube, sphere, tetrahedron, volume};

fn egg(mesh: &Mesh) -> Result<Spherical, SphericalError> {
    to_egg(mesh, &EggOptions::default(), |_| true)
}

/// A sphere of 2·4ˡᵉᵛᵉˡˢ⁺² triangles, its points moved.
fn moulded(levels: usize, mould: impl Fn(Vec3) -> Vec3) -> Mesh {
    let mut mesh = sphere(levels);
    mesh.positions.iter_mut().for_each(|p| *p = mould(Vec3::from(*p)).to_array());
    clean(mesh)
}

/// About as lumpy as an animal.
fn lumpy() -> Mesh {
    let lump = |p: Vec3| 1.0 + 0.3 * (5.0 * p.x).sin() * (4.0 * p.y).cos() + 0.2 * (7.0 * p.z + p.x).sin();
    moulded(4, |p| p * lump(p))
}

fn morphed(laid: &Spherical, weight: f32) -> Mesh {
    let mut mesh = laid.mesh.clone();
    let deltas = &laid.mesh.targets.last().unwrap().position_deltas;
    for (p, d) in mesh.positions.iter_mut().zip(deltas) {
        *p = std::array::from_fn(|k| p[k] + weight * d[k]);
    }
    mesh
}

fn double(p: [f32; 3]) -> DVec3 {
    DVec3::from(p.map(f64::from))
}

/// The egg as a level set, 1 on it, from the formula in its documentation.
fn level(egg: &Egg, p: DVec3) -> f64 {
    let p = p - double(egg.center);
    let y = p.y / (f64::from(egg.height) / 2.0);
    let radius = f64::from(egg.radius) * (-f64::from(egg.taper) * y).exp();
    (p.x * p.x + p.z * p.z) / (radius * radius) + y * y
}

fn egg_normal(egg: &Egg, p: DVec3) -> DVec3 {
    let step = 1e-4 * f64::from(egg.radius);
    let slope = DVec3::AXES.map(|axis| level(egg, p + step * axis) - level(egg, p - step * axis));
    DVec3::from(slope).normalize()
}

/// Triangles of the egg that its middle sees from outside.
fn flipped(laid: &Spherical) -> usize {
    let egg = morphed(laid, 1.0);
    let inward = |t: &usize| {
        let [a, b, c] = egg.corners(*t).map(|p| double(p) - double(laid.egg.center));
        a.dot(b.cross(c)) <= 0.0
    };
    (0..egg.triangles.len()).filter(inward).count()
}

/// The mesh is kept, lies on the egg without a fold, and shrinks to nothing nowhere on its way.
fn check(mesh: &Mesh, laid: &Spherical) {
    assert_eq!(laid.mesh.triangles[..mesh.triangles.len()], mesh.triangles);
    assert_eq!(laid.mesh.positions[..mesh.positions.len()], mesh.positions);
    assert_eq!(laid.mesh.targets.len(), mesh.targets.len() + 1);
    assert_eq!((flipped(laid), laid.report.flipped), (0, 0), "{}", mesh.name);
    let egg = morphed(laid, 1.0);
    // Delta and sum are rounded to 6e-8 of the largest coordinate each, and the level changes by 2 per radius.
    let largest = egg.positions.as_flattened().iter().fold(0.0, |m: f32, x| m.max(x.abs()));
    let rounding = 4e-7 * largest / laid.egg.radius.min(laid.egg.height / 2.0);
    for &p in &egg.positions {
        assert!((level(&laid.egg, double(p)) - 1.0).abs() < rounding.into(), "{}: {p:?}", mesh.name);
    }
    assert_eq!((Topology::of(&egg).euler, Topology::of(&egg).bad_edges), (2, 0));
    for step in 0..=10 {
        let pose = morphed(laid, step as f32 / 10.0);
        assert!(pose.positions.as_flattened().iter().all(|x| x.is_finite()));
        for t in 0..pose.triangles.len() {
            let [a, b, c] = pose.corners(t).map(double);
            assert!((b - a).cross(c - a) != DVec3::ZERO, "{}: triangle {t} at {step}/10", mesh.name);
        }
    }
}

/// Mean angle between the vertex normals at weight 1 and the egg's own, degrees.
fn normal_error(laid: &Spherical) -> f64 {
    let egg = morphed(laid, 1.0);
    let normals = deformed_normals(&NormalAdjacency::build(&laid.mesh), &egg.positions, &egg.triangles);
    let errors = egg.positions.iter().zip(&normals).map(|(&p, &n)| {
        let own = egg_normal(&laid.egg, double(p));
        double(n).angle_between(own).to_degrees()
    });
    errors.sum::<f64>() / egg.positions.len() as f64
}

#[test]
fn a_sphere_stays_as_it_is() {
    let mesh = clean(sphere(3));
    let laid = to_sphere(&mesh, |_| true).unwrap();
    check(&mesh, &laid);
    assert_eq!(laid.mesh.targets[0].name, "sphere");
    // Chords lie within 1 % of the ball that they approximate.
    assert!((laid.egg.radius - 1.0).abs() < 0.01 && (laid.egg.height - 2.0).abs() < 0.02, "{:?}", laid.egg);
    assert_eq!((laid.egg.taper, laid.egg.center[0], laid.egg.center[2]), (0.0, 0.0, 0.0));
    // The octahedron's corners have four neighbours and its own areas differ by a half.
    let [low, _, high] = laid.report.area_ratio;
    assert!(low > 0.7 && high < 1.4, "{:?}", laid.report);
    // It was turned to lie where it was: the mean over vertices that move along the ball by a triangle's side, 0.15.
    let moved: f32 = laid.mesh.targets[0].position_deltas.iter().map(|&d| Vec3::from(d).length()).sum();
    assert!(moved / (mesh.positions.len() as f32) < 0.15, "{}", moved / mesh.positions.len() as f32);
}

#[test]
fn normals_are_those_of_the_egg() {
    let mesh = lumpy();
    let laid = egg(&mesh).unwrap();
    check(&mesh, &laid);
    assert_eq!((laid.report.leaning, laid.mesh.targets[0].name.as_str()), (0, "egg"));
    assert!(normal_error(&laid) < 1.0, "{}", normal_error(&laid));
    let [low, _, high] = laid.report.area_ratio;
    assert!(low > 0.3 && high < 3.0, "{:?}", laid.report);
}

/// Two neighbours that change places fold the map, and a dent of a tenth of a triangle's side bends its normals.
#[test]
fn a_fold_and_a_dent_are_noticed() {
    let mut laid = egg(&lumpy()).unwrap();
    let egg = morphed(&laid, 1.0);
    let deltas = &mut laid.mesh.targets[0].position_deltas;
    let [a, b, _] = laid.mesh.triangles[100].map(|v| v as usize);
    for (v, w) in [(a, b), (b, a)] {
        deltas[v] = std::array::from_fn(|k| egg.positions[w][k] - laid.mesh.positions[v][k]);
    }
    assert_ne!(flipped(&laid), 0);
    let mut random = Random(1);
    for d in laid.mesh.targets[0].position_deltas.iter_mut().flatten() {
        *d += 0.01 * (random.below(100) as f32 / 50.0 - 1.0);
    }
    assert!(normal_error(&laid) > 1.0, "{}", normal_error(&laid));
}

#[test]
fn the_smallest_meshes_will_do() {
    for mesh in [tetrahedron(), cube()] {
        let mesh = clean(mesh);
        for laid in [egg(&mesh).unwrap(), to_sphere(&mesh, |_| true).unwrap()] {
            check(&mesh, &laid);
        }
    }
    let laid = to_sphere(&clean(tetrahedron()), |_| true).unwrap();
    assert!(laid.report.least_angle > 55.0, "{:?}: it was regular", laid.report);
}

#[test]
fn needles_and_spikes_become_eggs() {
    let needle = moulded(3, |p| p * Vec3::new(0.01, 1.0, 0.01));
    let spike = |p: Vec3| p * (1.0 + 8.0 * (p.x.abs().max(p.y.abs()) > 0.97) as u8 as f32);
    let horn = |p: Vec3| p * (1.0 + 4.0 * ((p.x - 0.9).max(0.0) * 10.0));
    for mesh in [needle, moulded(3, spike), moulded(4, horn)] {
        let laid = egg(&mesh).unwrap();
        check(&mesh, &laid);
        // What f32 resolves: 1e-7 of the egg, whose triangles are 1e-3 of its area.
        assert!(laid.report.least_area > 1e-3, "{:?}", laid.report);
    }
}

/// A vertex with 500 neighbours.
#[test]
fn a_cone_has_a_crowded_tip() {
    let n = 500;
    let rim = |k: u32| (std::f32::consts::TAU * k as f32 / n as f32).sin_cos();
    let mut mesh =
        Mesh { name: "cone".into(), positions: vec![[0.0, 3.0, 0.0], [0.0; 3]], ..Mesh::default() };
    mesh.positions.extend((0..n).map(|k| [rim(k).0, 0.0, rim(k).1]));
    mesh.triangles =
        (0..n).flat_map(|k| [[0, 2 + k, 2 + (k + 1) % n], [1, 2 + (k + 1) % n, 2 + k]]).collect();
    let mesh = clean(mesh);
    check(&mesh, &egg(&mesh).unwrap());
}

#[test]
#[cfg(feature = "builtin")]
fn a_sheet_with_hard_edges_stays_closed() {
    use translume_mesh::builtin::cuboid;
    for mesh in
        [cuboid([0.0; 3], [100.0, 100.0, 0.1], [12, 12, 1]), cuboid([0.0; 3], [100.0, 100.0, 0.1], [1; 3])]
    {
        // Vertices on edges come twice, at corners three times; that they move together, check sees from the topology.
        check(&mesh, &egg(&mesh).unwrap());
    }
}

/// Flips edges at random, without regard to shape, as long as no two vertices are joined twice.
fn scrambled(mesh: &mut Mesh, flips: usize, random: &mut Random) {
    for _ in 0..flips {
        let (t, k) = (random.below(mesh.triangles.len()), random.below(3));
        let [a, b, c] = [0, 1, 2].map(|step| mesh.triangles[t][(k + step) % 3]);
        let edge = |t: &[u32; 3], from, to| (0..3).find(|&k| t[k] == from && t[(k + 1) % 3] == to);
        let twin = mesh.triangles.iter().position(|t| edge(t, b, a).is_some()).unwrap();
        let d = mesh.triangles[twin][(edge(&mesh.triangles[twin], b, a).unwrap() + 2) % 3];
        if !mesh.triangles.iter().any(|t| t.contains(&c) && t.contains(&d)) {
            (mesh.triangles[t], mesh.triangles[twin]) = ([c, a, d], [d, b, c]);
        }
    }
}

/// A ball of 128 triangles whose edges were flipped and whose vertices were moved at random, repaired.
fn star(seed: u64, noise: f32, flips: usize) -> Mesh {
    let mut random = Random(seed);
    let mut mesh = sphere(2);
    scrambled(&mut mesh, flips, &mut random);
    for p in &mut mesh.positions {
        let radius = 1.0 - noise * random.below(1000) as f32 / 1000.0;
        *p = p.map(|x| x * radius);
    }
    let mut mesh = clean(mesh);
    if volume(&mesh) <= 0.0 {
        mesh.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    }
    mesh
}

#[test]
fn a_star_with_three_corners_on_a_line_becomes_an_egg() {
    let mesh = star(8_575_960_023_708_183_098, 0.290_495_25, 221);
    check(&mesh, &egg(&mesh).unwrap());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// Stars of any shape with vertices of degree 3 and far above 12, slivers and creases.
    #[test]
    fn any_star_becomes_an_egg(seed in any::<u64>(), noise in 0.0f32..0.9, flips in 0usize..400, taper in -0.5f32..0.5) {
        let mesh = star(seed, noise, flips);
        let laid = to_egg(&mesh, &EggOptions { taper, ..EggOptions::default() }, |_| true).unwrap();
        check(&mesh, &laid);
    }
}

#[test]
fn holes_are_filled_first() {
    let mut mesh = sphere(3);
    mesh.targets.push(Default::default());
    mesh.targets[0].position_deltas = vec![[0.1; 3]; mesh.positions.len()];
    // Half of the ball and a triangle are missing.
    let mut kept = 0..;
    mesh.triangles.retain(|t| {
        let upper = t.iter().all(|&v| mesh.positions[v as usize][1] >= 0.0);
        upper && kept.next() != Some(7)
    });
    let mesh = clean(mesh);
    let laid = egg(&mesh).unwrap();
    check(&mesh, &laid);
    assert_eq!(laid.report.holes_filled, 2);
    assert!(laid.mesh.triangles.len() > mesh.triangles.len());
    let lengths = laid.mesh.targets.iter().map(|target| target.position_deltas.len());
    assert!(lengths.into_iter().all(|n| n == laid.mesh.positions.len()));
}

#[test]
fn the_egg_fits_the_mesh_and_stands_under_it() {
    let mesh = moulded(3, |p| p * Vec3::new(1.0, 2.0, 0.5) + Vec3::new(5.0, 7.0, -3.0));
    let laid = egg(&mesh).unwrap();
    check(&mesh, &laid);
    let Egg { center, radius, height, taper } = laid.egg;
    assert!((height / radius - 2.0 * 41.0 / 31.0).abs() < 1e-5 && taper == 0.2);
    // Rounding of coordinates below 10.
    assert!((center[0] - 5.0).abs() < 1e-5 && (center[2] + 3.0).abs() < 1e-5, "{center:?}");
    assert!((center[1] - height / 2.0 - 5.0).abs() < 1e-5, "{center:?} {height}");
    let egg = morphed(&laid, 1.0);
    let growth = [area(&egg) / area(&mesh), volume(&egg) / volume(&mesh)];
    assert!(growth[0] > 0.5 && growth[0] < 1.0 && growth[1] > 1.0 && growth[1] < 2.0, "{growth:?}");
}

#[test]
fn an_egg_to_order() {
    let mesh = lumpy();
    let options = EggOptions { radius: Some(3.0), slenderness: 0.5, taper: -0.4 };
    let laid = to_egg(&mesh, &options, |_| true).unwrap();
    check(&mesh, &laid);
    assert_eq!((laid.egg.radius, laid.egg.height, laid.egg.taper), (3.0, 3.0, -0.4));
    for (options, option) in [
        (EggOptions { radius: Some(0.0), ..options }, "radius is 0"),
        (EggOptions { radius: Some(f32::NAN), ..options }, "radius is NaN"),
        (EggOptions { slenderness: 5.0, ..options }, "slenderness is 5"),
        (EggOptions { taper: f32::NAN, ..options }, "taper is NaN"),
    ] {
        let error = to_egg(&mesh, &options, |_| true).unwrap_err().to_string();
        assert!(error.contains(option) && error.contains("choose"), "{error}");
    }
}

#[test]
fn is_deterministic_and_tells_how_far_it_is() {
    let mesh = lumpy();
    let mut reports = Vec::new();
    let record = |progress| {
        reports.push(progress);
        true
    };
    let laid = to_egg(&mesh, &EggOptions::default(), record).unwrap();
    assert_eq!(laid.mesh, egg(&mesh).unwrap().mesh);
    let stages = reports.chunk_by(|a, b| a.stage == b.stage).map(|chunk| chunk[0].stage).collect::<Vec<_>>();
    assert_eq!(stages, ["coarsening", "laying", "checking"]);
    let laying = reports.iter().filter(|report| report.stage == "laying").collect::<Vec<_>>();
    assert!(laying.windows(2).all(|pair| pair[0].done < pair[1].done));
    assert_eq!(laying.last().unwrap().total, Some(mesh.positions.len()));
    assert_eq!(laying.last().unwrap().done, mesh.positions.len());
}

#[test]
fn may_be_cancelled_at_any_report() {
    let mesh = clean(sphere(2));
    let run = |patience: usize| {
        let mut left = patience;
        let progress = |_| {
            left = left.saturating_sub(1);
            left > 0
        };
        to_egg(&mesh, &EggOptions::default(), progress)
    };
    let finished = (1..100).try_for_each(|patience| match run(patience) {
        Err(SphericalError::Cancelled { mesh }) if mesh == "sphere" => ControlFlow::Continue(()),
        Err(error) => panic!("{error}"),
        Ok(_) => ControlFlow::Break(patience),
    });
    assert!(matches!(finished, ControlFlow::Break(reports) if reports > 4), "{finished:?}");
}

/// What it says about a mesh that is no closed surface without handles.
fn refusal(mesh: &Mesh) -> String {
    egg(mesh).err().map_or("nothing".into(), |error| error.to_string())
}

fn joined(parts: &[Mesh]) -> Mesh {
    let mut mesh = Mesh { name: "parts".into(), ..Mesh::default() };
    for part in parts {
        let base = mesh.positions.len() as u32;
        mesh.positions.extend(&part.positions);
        mesh.triangles.extend(part.triangles.iter().map(|t| t.map(|v| v + base)));
    }
    mesh
}

fn shifted(mesh: Mesh, by: f32) -> Mesh {
    let positions = mesh.positions.iter().map(|p| p.map(|x| x + by)).collect();
    Mesh { positions, ..mesh }
}

/// Clean, but with every triangle facing where it faced.
fn as_it_is(mesh: Mesh) -> Mesh {
    repair_with(mesh, &RepairOptions { orient: false, ..Default::default() }).unwrap().0
}

#[test]
fn says_why_not() {
    let far = clean(joined(&[cube(), shifted(cube(), 5.0), shifted(tetrahedron(), 9.0)]));
    assert!(refusal(&far).starts_with("parts: 3 separate pieces"), "{}", refusal(&far));

    let corner = clean(joined(&[cube(), shifted(cube(), 2.0)]));
    assert!(refusal(&corner).contains("2 separate pieces"), "{}: they share a corner", refusal(&corner));

    let mut edge = cube();
    edge.positions.push([2.0; 3]);
    edge.triangles.push([0, 1, 8]);
    let edge = clean(edge);
    assert!(
        refusal(&edge).contains("3 triangles meet at the edge from [1.0, -1.0, -1.0] to [-1.0, -1.0, -1.0]"),
        "{}",
        refusal(&edge)
    );

    let mut turned = cube();
    turned.triangles[3].swap(0, 1);
    let turned = as_it_is(turned);
    assert!(refusal(&turned).contains("face opposite sides"), "{}", refusal(&turned));

    let mut inside_out = cube();
    inside_out.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    assert!(refusal(&as_it_is(inside_out)).contains("face inwards"));

    let few = Mesh { triangles: tetrahedron().triangles[..1].to_vec(), ..tetrahedron() };
    assert!(refusal(&clean(few)).contains("2 triangles; a closed surface has at least 4"));

    let nothing = Mesh { positions: vec![[f32::NAN; 3]; 4], ..tetrahedron() };
    assert!(refusal(&nothing).contains("NaN"), "{}", refusal(&nothing));
    let missing = Mesh { positions: vec![[0.0; 3]], ..tetrahedron() };
    assert!(refusal(&missing).contains("uses vertex"), "{}", refusal(&missing));
    let mut twice = tetrahedron();
    twice.triangles.push([0, 0, 1]);
    assert!(refusal(&twice).contains("triangle 4 (from 0) has no area"), "{}", refusal(&twice));
    let skinless =
        Mesh { skin: Some(Skin { joints: 1, per_vertex: 2, influences: vec![] }), ..tetrahedron() };
    assert!(
        refusal(&skinless).contains("its skin has 0 influences for 4 vertices of 2"),
        "{}",
        refusal(&skinless)
    );
}

/// A box whose lid and floor meet in the middle: two corners of a hole in it are one.
#[test]
fn a_pinch_is_named() {
    let mut mesh = sphere(3);
    // The poles sink to the middle.
    mesh.positions[2] = [0.0; 3];
    mesh.positions[3] = [0.0; 3];
    let mesh = clean(mesh);
    let error = refusal(&mesh);
    assert!(error.contains("touches itself at vertex 2 (from 0), [0.0, 0.0, 0.0]"), "{error}");
}

/// A crack of three edges in a row has no area to be filled with.
#[test]
fn a_crack_is_counted() {
    let mut mesh = cube();
    mesh.positions.push([0.0, -1.0, -1.0]);
    let at = |t: &[u32; 3]| (0..3).find(|&k| t[k] + t[(k + 1) % 3] == 1);
    let (t, k) = mesh.triangles.iter().enumerate().find_map(|(t, corners)| Some((t, at(corners)?))).unwrap();
    let [a, b, c] = [0, 1, 2].map(|step| mesh.triangles[t][(k + step) % 3]);
    mesh.triangles[t] = [a, 8, c];
    mesh.triangles.push([8, b, c]);
    let error = refusal(&clean(mesh));
    assert!(error.contains("not closed, 3 edges"), "{error}");
}

#[test]
#[cfg(feature = "builtin")]
fn handles_are_counted() {
    use translume_mesh::builtin::{teapot_with, torus_knot};
    assert!(refusal(&torus_knot()).contains("its genus is 1; only a surface without handles"));
    assert!(refusal(&teapot_with(4)).contains("4 separate pieces"), "{}", refusal(&teapot_with(4)));
}

/// Ten thousand units from the origin coordinates step by a thousandth: enough for an egg of one unit, not for a tiny one.
#[test]
fn f32_has_its_limits() {
    let mesh = clean(shifted(lumpy(), 1e4));
    check(&mesh, &egg(&mesh).unwrap());
    let options = EggOptions { radius: Some(0.01), ..EggOptions::default() };
    let error = to_egg(&mesh, &options, |_| true).err().unwrap().to_string();
    assert!(error.contains("of 2048 triangles are too small on the egg for 32-bit coordinates"), "{error}");
}

#[cfg(feature = "load")]
fn model(name: &str) -> Option<Mesh> {
    let folder = std::env::var_os("TRANSLUME_MODELS")?;
    Some(translume_mesh::load::load(&std::path::Path::new(&folder).join(name)).unwrap().mesh)
}

#[test]
#[cfg(feature = "load")]
fn models_become_eggs_or_say_why_not() {
    for (name, reason) in [("teapot.obj", "4 separate pieces"), ("rocker-arm.obj", "its genus is 1")] {
        let Some(mesh) = model(name) else { return };
        assert!(refusal(&mesh).contains(reason), "{}", refusal(&mesh));
    }
    let Some(mesh) = model("spot.obj") else { return };
    let laid = egg(&mesh).unwrap();
    check(&mesh, &laid);
    assert!(normal_error(&laid) < 1.0, "{}", normal_error(&laid));
}

#[test]
#[cfg(feature = "load")]
#[cfg_attr(debug_assertions, ignore = "seconds without optimisation")]
fn scans_become_eggs() {
    for (name, holes) in [("stanford-bunny.obj", 5), ("nefertiti.obj", 0)] {
        let Some(mesh) = model(name) else { return };
        let laid = egg(&mesh).unwrap();
        println!("{name}: normals within {:.2}°, {:?}", normal_error(&laid), laid.report);
        check(&mesh, &laid);
        assert_eq!((laid.report.holes_filled, laid.report.leaning), (holes, 0));
        assert!(normal_error(&laid) < 1.0);
        // Measured 0.42 and 0.57, 1.72 and 1.76.
        let [low, _, high] = laid.report.area_ratio;
        assert!(low > 0.35 && high < 2.0, "{:?}", laid.report);
    }
}
