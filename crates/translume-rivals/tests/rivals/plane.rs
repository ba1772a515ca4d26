//! An evenly lit plane gives back what the profile does in all.

use crate::scene::{before_camera, burley, default_rivals, sun, wall};
use translume::{Light, Medium};
use translume_reference::fresnel::{hemispherical_transmittance, transmittance};
use translume_reference::profile::Profile as _;
use translume_rivals::{Rival, TranslucentShadowMap};
use translume_tests::{Check, at_most, dipoles, holds, notices};

/// Light from the side, 35° off the normal.
const TO_LIGHT: [f32; 3] = [0.5, 0.28, 0.82];

fn totals(rival: Rival, medium: &Medium) -> [f64; 3] {
    match rival {
        Rival::TranslucentShadowMap(_) => dipoles(medium).map(|dipole| dipole.total()),
        _ => burley(medium).map(|profile| profile.total()),
    }
}

/// Radiance in the middle of the picture over that of the closed form with a light `gain` times as strong.
fn closure(rival: Rival, medium: Medium, gain: f64, tolerance: f64) -> Check {
    let scene = before_camera(wall(), medium, Light::Directional(sun(TO_LIGHT)), 33, 0.1);
    let found = scene.picture(rival)[16 * 33 + 16];
    let cosine = f64::from(TO_LIGHT[2]) / TO_LIGHT.map(f64::from).iter().map(|x| x * x).sum::<f64>().sqrt();
    let eta = medium.ior.into();
    let entered = gain * std::f64::consts::PI * cosine * transmittance(eta, cosine);
    let exit = transmittance(eta, 1.0) / (std::f64::consts::PI * hemispherical_transmittance(eta));
    for (total, found) in totals(rival, &medium).into_iter().zip(found) {
        let off = (f64::from(found) / (entered * total * exit) - 1.0).abs();
        at_most(&format!("{rival:?} on a plane"), off, tolerance)?;
    }
    Ok(())
}

#[test]
fn an_evenly_lit_plane_gives_the_total() {
    let [maps, screen] = default_rivals();
    for medium in [Medium::SKIN1, Medium::MARBLE] {
        // The map's half floats; rings are exact where the pattern lies on the surface. Measured 0.04 %.
        holds(closure(maps, medium, 1.0, 1e-3));
        notices(closure(maps, medium, 1.003, 1e-3));
        // Both sources of an entry on the receiver's own plane are where the chord has them.
        let displaced = TranslucentShadowMap { displaced: true, ..Default::default() };
        holds(closure(Rival::TranslucentShadowMap(displaced), medium, 1.0, 1e-2));
        // Weights are normalised, so that only rounding is left, and the fit of two quadratures of the albedo; measured 3·10⁻⁷.
        holds(closure(screen, medium, 1.0, 1e-4));
        notices(closure(screen, medium, 1.001, 1e-4));
    }
}
