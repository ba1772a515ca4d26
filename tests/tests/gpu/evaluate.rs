//! Exitance at vertices and fragments, and only where a picture needs it.

use std::sync::Arc;
use translume::{DirectionalLight, Error, Evaluate, Frame, Light, Medium, Method, View, readback};
use translume_reference::gather::Source;
use translume_reference::scatter;
use translume_tests::{
    Check, Fixture, Model, Pose, Shot, at_least, at_most, creature, cuboids, dipoles, gpu, holds, limb,
    notices, plane,
};

const SHOT: Shot = Shot { eye: [80.0, 90.0, 240.0], target: [0.0, 48.0, 0.0], fov: 0.45, size: 96 };
const SHADES: [Evaluate; 3] = [Evaluate::PerTexel, Evaluate::PerVertex, Evaluate::PerFragment];

fn sun() -> [Light; 1] {
    [Light::Directional(DirectionalLight { to_light: [0.5, 0.7, -0.3], ..Default::default() })]
}

fn view() -> View {
    View { camera: SHOT.camera(), pixels: [SHOT.size; 2] }
}

/// A tenth as large as it is drawn: texels of about a quarter of a millimetre, shorter than the mean free paths of these media.
fn body(model: &Arc<Model>, medium: Medium, evaluate: Evaluate, list_entries: u32) -> Fixture {
    Fixture::new(model, |d| {
        (d.medium, d.evaluate, d.list_entries, d.mm_per_unit) = (medium, evaluate, list_entries, 0.1);
    })
}

fn run(fixture: &mut Fixture, view: Option<View>) {
    let pose = Pose::rest(fixture.model.mesh.targets.len());
    fixture.run(&Frame { view, ..pose.frame(&sun()) });
}

/// Root mean square and mean of the difference of two pictures over the mean of the second, where that shows the body; worst channel.
fn apart(a: &[[f32; 4]], b: &[[f32; 4]]) -> (f64, f64) {
    let mut worst = (0.0_f64, 0.0_f64);
    for channel in 0..3 {
        let both = a.iter().zip(b).filter(|(_, b)| b[3] > 0.0);
        let pairs: Vec<_> = both.map(|(a, b)| (f64::from(a[channel]), f64::from(b[channel]))).collect();
        let count = pairs.len() as f64;
        let mean = pairs.iter().map(|(_, b)| b).sum::<f64>() / count;
        let rms = (pairs.iter().map(|(a, b)| (a - b).powi(2)).sum::<f64>() / count).sqrt();
        let bias = pairs.iter().map(|(a, b)| a - b).sum::<f64>() / count;
        worst = (worst.0.max(rms / mean), worst.1.max((bias / mean).abs()));
    }
    worst
}

/// Exitance of the vertices against the sum over all texels, `gain` times too bright.
fn vertices(medium: Medium, list_entries: u32, gain: f64) -> Check {
    let mut fixture = body(&creature(), medium, Evaluate::PerVertex, list_entries);
    run(&mut fixture, None);
    let buffer = fixture.body.outputs().vertex_exitance.expect("exitance is at the vertices");
    let measured: Vec<[f32; 4]> = readback::buffer(&gpu().device, &gpu().queue, buffer).unwrap();
    // A vertex is a receiver of its own that sends nothing.
    let mut sources = fixture.sources();
    let texels = sources.len();
    sources.extend(fixture.positions().into_iter().map(|position| Source {
        position,
        normal: [0.0; 3],
        area: 0.0,
        irradiance: [0.0; 3],
    }));
    let receivers: Vec<usize> = (texels..sources.len()).step_by(7).collect();
    let exact = scatter::all_pairs(&sources, &dipoles(&medium), &receivers);
    let found = receivers.iter().map(|k| measured[k - texels].map(f64::from));
    let found: Vec<_> = found.map(|[r, g, b, n]| [gain * r, gain * g, gain * b, n]).collect();
    for channel in 0..3 {
        let count = exact.len() as f64;
        let mean = exact.iter().map(|b| b[channel]).sum::<f64>() / count;
        let squares = found.iter().zip(&exact).map(|(a, b)| (a[channel] - b[channel]).powi(2));
        let rms = (squares.sum::<f64>() / count).sqrt();
        at_most(&format!("vertices, {list_entries} entries: error over the mean"), rms / mean, 0.01)?;
    }
    let evaluations = found.iter().map(|b| b[3]).sum::<f64>() / found.len() as f64;
    at_least("vertices: evaluations", evaluations, 5.0)
}

/// Where lists have no room every vertex walks the tree by itself.
#[test]
fn vertices_collect_from_all_texels() {
    for medium in [Medium::SKIMMILK, Medium::SKIN1, Medium::JADE] {
        holds(vertices(medium, 32, 1.0));
        notices(vertices(medium, 32, 1.02));
    }
    holds(vertices(Medium::SKIN1, 0, 1.0));
}

/// Pictures of the same body evaluated elsewhere.
fn pictures(list_entries: u32, other: Medium) -> Check {
    let pictures = SHADES.map(|evaluate| {
        let medium = if evaluate == Evaluate::PerTexel { Medium::SKIMMILK } else { other };
        let mut fixture = body(&creature(), medium, evaluate, list_entries);
        run(&mut fixture, None);
        assert_eq!(fixture.body.evaluated(), evaluate);
        SHOT.take(&fixture)
    });
    for (evaluate, picture) in SHADES.iter().zip(&pictures).skip(1) {
        let (error, bias) = apart(picture, &pictures[0]);
        at_most(&format!("{evaluate:?} against texels"), error, 0.03)?;
        at_most(&format!("{evaluate:?} against texels: bias"), bias, 0.005)?;
    }
    Ok(())
}

/// Light in skim milk wanders over several texels of this body, so that it hardly matters where it is looked up.
#[test]
fn vertices_and_fragments_show_what_texels_show() {
    holds(pictures(32, Medium::SKIMMILK));
    holds(pictures(0, Medium::SKIMMILK));
    let scale = |x: f32| 1.05 * x;
    let brighter = Medium { sigma_s_prime: Medium::SKIMMILK.sigma_s_prime.map(scale), ..Medium::SKIMMILK };
    notices(pictures(32, brighter));
}

/// The picture of a view against that of a body which every picture may show; kernel evaluations of the former over the latter.
fn partial(model: &Arc<Model>, evaluate: Evaluate, prepared: View) -> Result<f64, String> {
    let shown = |view: Option<View>| {
        let mut fixture = body(model, Medium::SKIMMILK, evaluate, 32);
        fixture.body.set_method(Method::Within { tolerance: 0.002 }).unwrap();
        run(&mut fixture, view);
        let all: Vec<[f32; 4]> =
            readback::buffer(&gpu().device, &gpu().queue, fixture.body.outputs().exitance).unwrap();
        (SHOT.take(&fixture), all.iter().map(|b| f64::from(b[3])).sum::<f64>())
    };
    let ((part, some), (whole, all)) = (shown(Some(prepared)), shown(None));
    // Groups of fewer receivers are other groups, with other errors: the tolerance of both.
    at_most(&format!("{evaluate:?} in view"), apart(&part, &whole).0, 0.004)?;
    Ok(some / all)
}

#[test]
fn what_a_view_needs_is_there_and_the_rest_is_not() {
    for model in [creature(), limb()] {
        for evaluate in [Evaluate::PerTexel, Evaluate::PerFragment] {
            let share = partial(&model, evaluate, view()).unwrap();
            if evaluate == Evaluate::PerTexel {
                // Texels turned away are spared, but this coarse atlas turns far within a group of them: measured 0.88.
                holds(at_most("share of the evaluations", share, 0.92));
            }
        }
    }
    // From behind, the texels that this picture shows are dark.
    let [x, y, z] = SHOT.eye;
    let behind = Shot { eye: [-x, y, -z], ..SHOT };
    let elsewhere = View { camera: behind.camera(), ..view() };
    notices(partial(&creature(), Evaluate::PerTexel, elsewhere).map(|_| ()));
    // Fragments that were not expected take longer, but are right.
    holds(partial(&creature(), Evaluate::PerFragment, elsewhere).map(|_| ()));
}

/// Texels of both sides of a sheet lie in one group, whose normals cancel.
#[test]
fn a_sheet_is_seen_whole() {
    let sheet = cuboids(&[([-45.0, 3.0, -0.3], [45.0, 93.0, 0.3])]);
    let shown = |view: Option<View>| {
        let mut fixture = body(&sheet, Medium::SKIMMILK, Evaluate::PerTexel, 32);
        run(&mut fixture, view);
        SHOT.take(&fixture)
    };
    let whole = shown(None);
    let darkest = |picture: &[[f32; 4]]| {
        let lit = whole.iter().zip(picture).filter(|(whole, _)| whole[3] > 0.0);
        lit.map(|(whole, pixel)| f64::from(pixel[0] / whole[0])).fold(f64::INFINITY, f64::min)
    };
    // The tolerance of both, at single texels: measured 0.99.
    let check = |picture: &[[f32; 4]]| {
        at_least("darkest pixel over the same of a whole body", darkest(picture), 0.95)
    };
    holds(check(&shown(Some(view()))));
    let away = Shot { target: [0.0, 400.0, 0.0], ..SHOT };
    notices(check(&shown(Some(View { camera: away.camera(), ..view() }))));
}

/// From inside of a closed body everything faces away.
#[test]
fn an_eye_inside_sees_the_inside() {
    let inside = Shot { eye: [0.0, 40.0, 0.0], target: [0.0, 48.0, 60.0], fov: 1.5, size: 32 };
    let shown = |view: Option<View>| {
        let mut fixture = body(&creature(), Medium::SKIMMILK, Evaluate::PerTexel, 32);
        run(&mut fixture, view);
        inside.take(&fixture)
    };
    let whole = shown(None);
    let check = |part: &[[f32; 4]]| at_most("from inside", apart(part, &whole).0, 0.02);
    holds(check(&shown(Some(View { camera: inside.camera(), pixels: [32; 2] }))));
    let [x, y, z] = SHOT.eye;
    let behind = Shot { eye: [-x, y, -z], ..SHOT };
    notices(check(&shown(Some(View { camera: behind.camera(), ..view() }))));
}

#[test]
fn auto_chooses_by_cost() {
    let chosen = |model: &Arc<Model>, medium: Medium, view: Option<View>| {
        let mut fixture = body(model, medium, Evaluate::Auto, 32);
        run(&mut fixture, view);
        fixture.body.evaluated()
    };
    let small = View { pixels: [16; 2], ..view() };
    // 5,000 vertices and 2,600 texels; a mean free path of .5 to 1.4 mm.
    assert_eq!(chosen(&creature(), Medium::SKIMMILK, None), Evaluate::PerTexel);
    let thin = Medium { sigma_s_prime: [0.05; 3], sigma_a: [0.001; 3], ior: 1.3, g: 0.0 };
    assert_eq!(chosen(&creature(), thin, Some(small)), Evaluate::PerFragment);
    assert_eq!(chosen(&plane(50.0, 64), thin, None), Evaluate::PerVertex);
    assert_eq!(chosen(&plane(50.0, 64), Medium::SPECTRALON, None), Evaluate::PerTexel);
}

#[test]
fn points_need_the_dual_scatter() {
    let with = |method, evaluate| {
        Fixture::try_new(&plane(10.0, 16), |d| (d.method, d.evaluate) = (method, evaluate)).err()
    };
    assert!(matches!(with(Method::AllPairs, Evaluate::PerVertex), Some(Error::Frame { .. })));
    assert!(matches!(with(Method::Tree { theta: 0.4 }, Evaluate::PerFragment), Some(Error::Frame { .. })));
    assert_eq!(with(Method::AllPairs, Evaluate::Auto), None);
    assert_eq!(with(Method::default(), Evaluate::PerVertex), None);
    let mut fixture = body(&plane(10.0, 16), Medium::SKIN1, Evaluate::PerVertex, 32);
    assert!(fixture.body.set_method(Method::AllPairs).is_err());
    let camera = translume::Camera { eye: [f32::NAN; 3], ..SHOT.camera() };
    let unseen = View { camera, ..view() };
    let frame = Frame { view: Some(unseen), ..Frame::default() };
    assert!(fixture.prepare(&frame).unwrap_err().to_string().contains("camera"));
}

/// From one place to another and back without a trace.
#[test]
fn places_can_change() {
    let mut fixture = body(&creature(), Medium::SKIMMILK, Evaluate::PerTexel, 32);
    let mut first = None;
    for evaluate in [SHADES[0], SHADES[1], SHADES[2], SHADES[0], SHADES[2], SHADES[1], SHADES[0]] {
        fixture.body.set_evaluate(evaluate).unwrap();
        run(&mut fixture, (evaluate == Evaluate::PerFragment).then(view));
        let picture = SHOT.take(&fixture);
        if evaluate == Evaluate::PerTexel {
            let first = first.get_or_insert_with(|| picture.clone());
            assert_eq!(bytemuck::cast_slice::<_, u8>(first), bytemuck::cast_slice::<_, u8>(&picture));
        }
        let at_vertices = fixture.body.outputs().vertex_exitance.is_some();
        assert_eq!(at_vertices, evaluate == Evaluate::PerVertex);
    }
    fixture.body.set_method(Method::AllPairs).unwrap();
    run(&mut fixture, None);
    assert!(fixture.body.outputs().vertex_exitance.is_none() && fixture.body.outputs().lists.is_none());
}
