//! The boundary solver against its dense twin, whose rays are cast through the mesh.

use std::sync::Arc;
use translume::{DirectionalLight, Light, Medium, Transport};
use translume_reference::path::{Closed, Volume};
use translume_reference::transport::{Body, Solution, sites};
use translume_tests::{Check, Fixture, Model, Pose, at_most, holds, light, notices, sphere_with};

/// Five mean free paths across a radius in red, none in blue to speak of.
fn medium() -> Medium {
    Medium { sigma_s_prime: [0.1, 0.5, 1.5], sigma_a: [0.0, 0.01, 0.1], ior: 1.0 }
}

fn agrees(model: &Arc<Model>, medium: Medium, lights: &[Light], bound: f64) -> Check {
    let mut fixture = Fixture::new(model, |d| {
        (d.medium, d.transport, d.method) = (medium, Transport::Boundary, translume::Method::Dual { theta: std::env::var("TH").map_or(0.65, |t| t.parse().unwrap()) });
    });
    let pose = Pose::rest(model.mesh.targets.len());
    fixture.run(&pose.frame(lights));
    let exitance = fixture.exitance();
    let wide = |values: [f32; 3]| values.map(f64::from);
    let volume = Volume {
        sigma_s: wide(medium.sigma_s_prime),
        sigma_a: wide(medium.sigma_a),
        g: 0.0,
        ior: medium.ior.into(),
    };
    let surface = fixture.twin_surface(&pose);
    let shape = Closed::new(&surface).expect("a closed mesh");
    let twins: Vec<_> = lights.iter().map(|each| light(each, 1.0)).collect();
    let body = Body { shape: &shape, volume, lights: &twins };
    let sources = fixture.sources();
    let solution = Solution::new(body, sites(&model.atlas, &surface, &sources), 8);
    eprintln!("residual {:?}", solution.residual());
    let read = |k: usize| -> Vec<[f32; 4]> { translume::readback::buffer(&translume_tests::gpu().device, &translume_tests::gpu().queue, &fixture.body.debug()[k]).unwrap() };
    let show = |what: &str, mine: &[[f32; 4]], exact: &dyn Fn(usize) -> [f64; 4]| {
        for k in 0..4 {
            let (mut square, mut sum, mut count, mut signed) = (0.0, 0.0, 0.0, 0.0);
            for (i, source) in sources.iter().enumerate().filter(|(_, source)| source.area > 0.0) {
                let e = exact(i)[k];
                square += source.area * (f64::from(mine[i][k]) - e).powi(2);
                signed += source.area * (f64::from(mine[i][k]) - e);
                sum += source.area * e;
                count += source.area;
            }
            eprintln!("{what} {k}: rms {:.4} bias {:+.4} mean {:.4e}", (square / count).sqrt() / (sum / count), signed / sum, sum / count);
        }
    };
    let four = |v: [f64; 3], w: f64| [v[0], v[1], v[2], w];
    show("given", &read(0), &|i| four(solution.given()[i], solution.closure(i)));
    show("fluence", &read(1), &|i| four(solution.fluence()[i], 1.0));
    let g = read(0); let nan: Vec<_> = (0..g.len()).filter(|&i| g[i].iter().any(|x| x.is_nan())).collect(); eprintln!("NaN {nan:?} of {}", g.len());
    for &i in nan.iter().take(3) { eprintln!("{:?} {:?}", g[i], sources[i]); }
    let mut order: Vec<usize> = (0..g.len()).filter(|&i| sources[i].area > 0.0).collect();
    order.sort_by(|&a, &b| { let d = |i: usize| (f64::from(g[i][3]) - solution.closure(i)).abs() * sources[i].area.sqrt(); d(b).total_cmp(&d(a)) });
    for &i in order.iter().take(8) {
        let near: Vec<_> = (0..g.len()).filter(|&j| j != i && sources[j].area > 0.0).map(|j| { let d = glam::DVec3::from(sources[j].position) - glam::DVec3::from(sources[i].position); (d.length(), d.dot(sources[j].normal.into()), sources[j].area) }).filter(|x| x.0 < 7.0).collect();
        eprintln!("worst {i}: gpu {} twin {} area {:.2} near {:.2?}", g[i][3], solution.closure(i), sources[i].area, near); }
    for i in [100, 500, 1000] { eprintln!("{i}: {:?} {:?} {:?} | {:?}", read(0)[i], solution.given()[i], solution.closure(i), read(1)[i]); }
    {
        let s = read(3); for i in [100, 500, 1000] { eprintln!("strata {:?}", &s[4*i..4*i+4]); }
        let s = read(4); for i in [100, 500, 1000] { eprintln!("charge {:?}", &s[4*i..4*i+4]); }
        let s = read(5); for i in [100, 500, 1000] { eprintln!("shape {:?}", &s[2*i..2*i+2]); }
    }
    let mut worst: f64 = 0.0;
    for k in 0..3 {
        let (mut square, mut sum, mut count, mut signed) = (0.0, 0.0, 0.0, 0.0);
        for (i, source) in sources.iter().enumerate().filter(|(_, source)| source.area > 0.0) {
            let exact = solution.exitance(i)[k];
            square += source.area * (exitance[i][k] - exact).powi(2);
            signed += source.area * (exitance[i][k] - exact);
            sum += source.area * exact;
            count += source.area;
        }
        let rms = (square / count).sqrt() / (sum / count);
        eprintln!("channel {k}: rms {rms:.4} bias {:+.4} mean {:.4e}", signed / sum, sum / count);
        worst = worst.max(rms);
    }
    at_most("boundary against dense sums", worst, bound)
}

#[test]
fn exitance_is_that_of_dense_sums() {
    let model = sphere_with(48);
    let sun = Light::Directional(DirectionalLight { irradiance: [3.0; 3], ..Default::default() });
    holds(agrees(&model, medium(), &[sun], 0.02));
    notices(agrees(&model, medium(), &[sun], 1e-6));
}
