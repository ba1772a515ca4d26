//! The Monte Carlo of half-spaces and slabs against exact results.

use std::ops::ControlFlow;
use translume_reference::half_space::{Entry, Estimate, Light, Setup};
use translume_reference::profile::{Entry as From, half_space_albedo};

const ALBEDOS: [f64; 4] = [0.5, 0.9, 0.99, 0.0];

fn setup() -> Setup {
    Setup { albedos: ALBEDOS.to_vec(), photons: 60_000, ..Setup::default() }
}

/// How many standard errors lie between.
fn sigmas(found: Estimate, expected: f64) -> f64 {
    (found.value - expected).abs() / found.error
}

/// R(μ₀) = 1 − H(μ₀)√(1 − α) and its mean by the cosine. Four standard errors: one run in 16,000 is farther off, and runs repeat
/// themselves.
#[test]
fn half_spaces_return_chandrasekhars_albedo() {
    for (entry, exact) in
        [(Entry::Normal, From::Normal), (Entry::Cosine, From::Diffuse), (Entry::Diffuse, From::Diffuse)]
    {
        let light = Setup { entry, ..setup() }.finish();
        for (k, albedo) in ALBEDOS.into_iter().enumerate().take(3) {
            let total = light.reflected[k].all.total;
            let off = sigmas(total, half_space_albedo(albedo, exact));
            assert!(off < 4.0, "{entry:?} {albedo}: {total:?}, {off} σ");
            assert!(total.error < 0.01 * total.value, "{entry:?} {albedo}: {total:?}");
            let other = half_space_albedo(albedo - 0.05 * (1.0 - albedo) - 0.005, exact);
            assert!(
                sigmas(total, other) > 4.0,
                "{entry:?} {albedo}: a little more absorption must be noticed"
            );
        }
        assert_eq!(light.reflected[3].all.total.value, 0.0);
    }
}

/// Everything that entered is somewhere, though each part is counted on its own.
fn balance(light: &Light, k: usize) -> f64 {
    let face = |face: &translume_reference::half_space::Face| face.all.total.value + face.unscattered.value;
    face(&light.reflected[k])
        + face(&light.transmitted[k])
        + light.absorbed[k].value
        + light.unfinished[k].value
}

#[test]
fn light_is_reflected_transmitted_or_absorbed() {
    for (ior, thickness, anisotropy) in
        [(1.0, 2.0, 0.0), (1.5, 0.3, 0.7), (1.3, f64::INFINITY, -0.4), (0.8, 5.0, 0.0)]
    {
        for entry in [Entry::Normal, Entry::Diffuse] {
            let light = Setup { entry, ior, thickness, anisotropy, ..setup() }.finish();
            for k in 0..ALBEDOS.len() {
                let sum = balance(&light, k);
                // The noise of 60,000 walks. Measured up to 0.3 %.
                assert!((sum - 1.0).abs() < 6e-3, "{entry:?} {ior} {thickness} {k}: {sum}");
            }
            let without = balance(&light, 0) - light.absorbed[0].value;
            assert!((without - 1.0).abs() > 6e-3, "what is absorbed must be missed");
        }
    }
}

/// Without absorption a slab keeps nothing.
#[test]
fn a_white_slab_lets_everything_go() {
    let white = |albedo: f64| {
        let setup = Setup { albedos: vec![albedo], thickness: 3.0, ior: 1.4, ..setup() };
        let light = setup.finish();
        balance(&light, 0) - light.absorbed[0].value
    };
    // Noise.
    assert!((white(1.0) - 1.0).abs() < 5e-3, "{}", white(1.0));
    assert!((white(0.99) - 1.0).abs() > 5e-3, "{}", white(0.99));
}

/// What passes a clear slab unscattered, and never more than once through.
#[test]
fn beer_and_lambert() {
    let light = Setup { thickness: 1.5, ..setup() }.finish();
    let unscattered = light.transmitted[0].unscattered.value;
    assert!((unscattered / (-1.5_f64).exp() - 1.0).abs() < 1e-12, "{unscattered}");
    assert_eq!(light.reflected[0].unscattered.value, 0.0);
}

/// A phase function of mean cosine g over mean free paths that are 1 − g as long looks like isotropic scattering where light has forgotten
/// where it came from: behind a thick white slab.
#[test]
fn similarity() {
    let through = |g: f64, thickness: f64| {
        let setup = Setup {
            entry: Entry::Diffuse,
            anisotropy: g,
            thickness,
            albedos: vec![1.0],
            photons: 10_000,
            ..setup()
        };
        setup.finish().transmitted[0].all.total
    };
    let (isotropic, forward) = (through(0.0, 8.0), through(0.7, 8.0 / 0.3));
    // 8 %: noise of 2 % each, and similarity is an approximation.
    assert!((forward.value / isotropic.value - 1.0).abs() < 0.08, "{isotropic:?} {forward:?}");
    let other = through(0.7, 8.0);
    assert!((other.value / isotropic.value - 1.0).abs() > 0.08, "another length must be noticed: {other:?}");
}

/// 30 runs with other seeds scatter about the exact value as their errors say.
#[test]
fn errors_are_honest() {
    let exact = half_space_albedo(0.9, From::Normal);
    let runs: Vec<f64> = (0..30)
        .map(|seed| {
            Setup { albedos: vec![0.9], photons: 3000, seed, ..setup() }.finish().reflected[0].all.total
        })
        .map(|total| (total.value - exact) / total.error)
        .collect();
    let spread = (runs.iter().map(|x| x * x).sum::<f64>() / 30.0).sqrt();
    // χ² of 30: 0.7 to 1.3 with 98 %.
    assert!((0.7..1.3).contains(&spread), "{spread}");
    // Errors twice too small or large would not pass.
    assert!(!(0.7..1.3).contains(&(2.0 * spread)) && !(0.7..1.3).contains(&(0.5 * spread)), "{spread}");
}

#[test]
fn runs_repeat_themselves_on_any_number_of_threads() {
    let run = |threads: usize, seed: u64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| Setup { photons: 1000, seed, ..setup() }.finish())
    };
    assert_eq!(run(1, 5), run(3, 5));
    assert_ne!(run(1, 5), run(1, 6));
}

#[test]
fn a_run_can_be_ended() {
    let setup = Setup { photons: 1000, ..setup() };
    assert!(setup.run(&|_| ControlFlow::Break(())).is_none());
    assert_eq!(setup.run(&|_| ControlFlow::Continue(())), Some(setup.finish()));
}

/// Walks of another hand, where the environment has a folder of them: the cosine there is the one inside, and light counts once it has
/// entered.
#[test]
fn published_walks_agree() {
    let Some(folder) = std::env::var_os("TRANSLUME_REFERENCES") else { return };
    let read = |name: &str| std::fs::read_to_string(std::path::Path::new(&folder).join(name)).unwrap();
    let row = |line: &str| line.split(',').map(|x| x.parse().unwrap()).collect::<Vec<f64>>();
    let profiles: Vec<_> = read("halfspace_profiles.csv").lines().skip(1).map(row).collect();
    for total in read("halfspace_totals.csv").lines().skip(1).map(row) {
        let entry = if total[2] == 0.0 { Entry::Normal } else { Entry::Cosine };
        let rings: Vec<_> = profiles.iter().filter(|row| row[..3] == total[..3]).collect();
        let edges = rings.iter().map(|row| row[4]).collect();
        let setup =
            Setup { entry, ior: total[0], albedos: vec![total[1]], edges, photons: 60_000, ..setup() };
        let face = &setup.finish().reflected[0];
        // Our noise, four standard errors, and theirs: 0.3 %.
        let allowed = |e: Estimate| 4.0 * e.error + 3e-3 * e.value;
        let agrees = |e: Estimate, value: f64| (e.value - value).abs() < allowed(e);
        assert!(agrees(face.all.total, total[3]), "{total:?} {:?}", face.all.total);
        assert!(agrees(face.single.total, total[4]), "{total:?} {:?}", face.single.total);
        assert!(!agrees(face.all.total, 0.97 * total[3]), "3 % less must be noticed");
        // Neighbours in fours, for noise: their energy between a twentieth of a mean free path and some.
        for four in (8..44).step_by(4).map(|k| k..k + 4) {
            let area = |row: &[f64]| std::f64::consts::PI * (row[4] - row[3]) * (row[4] + row[3]);
            let theirs: f64 = four.clone().map(|k| rings[k][5] * area(rings[k])).sum();
            let ours: f64 = four.clone().map(|k| face.all.rings[k].value).sum();
            let noise: f64 = four.map(|k| rings[k][7] * area(rings[k])).sum::<f64>() + 0.004 * total[3];
            assert!((ours - theirs).abs() < 0.02 * theirs + noise, "{total:?}: {ours} {theirs}");
        }
    }
}
