//! Resolve and composite: from texels to a texture to a picture.

use translume::{AmbientLight, DirectionalLight, Light, Medium, Profile, readback};
use translume_mesh::Atlas;
use translume_reference::composite::{self, Exit};
use translume_tests::{
    Check, Fixture, Pose, Shot, at_least, at_most, creature, gpu, holds, notices, relative_rmse,
};

const SHOT: Shot = Shot { eye: [80.0, 90.0, 240.0], target: [0.0, 48.0, 0.0], fov: 0.45, size: 96 };

fn pose() -> Pose {
    Pose { weights: vec![0.2], ..Pose::rest(1) }
}

fn lit(flat: bool, profile: Profile) -> Fixture {
    let mut fixture = Fixture::new(&creature(), |d| {
        (d.medium, d.flat_normals, d.profile) = (Medium::JADE, flat, profile);
    });
    let sun = Light::Directional(DirectionalLight { to_light: [0.5, 0.7, -0.3], ..Default::default() });
    fixture.run(&pose().frame(&[sun, Light::Ambient(AmbientLight::default())]));
    fixture
}

/// Texels of the texture that are not those of the buffer.
fn resolved(fixture: &Fixture, pixels: &[u32]) -> Check {
    let texture: Vec<[f32; 4]> =
        readback::texture(&gpu().device, &gpu().queue, fixture.body.exitance_texture(), 0).unwrap();
    let dense = fixture.exitance();
    let wrong = texture.iter().zip(pixels).filter(|&(&[r, g, b, a], &texel)| {
        let expected = if texel == Atlas::EMPTY {
            [0.0; 4]
        } else {
            let [r, g, b] = dense[texel as usize];
            [r, g, b, 1.0]
        };
        [r, g, b, a].map(f64::from) != expected
    });
    at_most("resolve: wrong texels", wrong.count() as f64, 0.0)
}

#[test]
fn the_texture_holds_the_texels() {
    let fixture = lit(false, Profile::DipoleNormalised);
    let mut pixels = fixture.model.atlas.pixels.clone();
    holds(resolved(&fixture, &pixels));
    let filled: Vec<usize> = (0..pixels.len()).filter(|&k| pixels[k] != Atlas::EMPTY).collect();
    pixels.swap(filled[0], filled[filled.len() / 2]);
    notices(resolved(&fixture, &pixels));
}

/// The picture against the twin's, fed with the GPU's own exitance.
fn picture(fixture: &Fixture, shot: &Shot, exit: Exit) -> Check {
    let exitance = fixture.exitance();
    let twin =
        composite::render(&shot.twin(fixture.mm_per_unit), &fixture.twin_surface(&pose()), exit, |hit| {
            composite::look_up(&fixture.model.atlas, &exitance, hit)
        });
    let taken = SHOT.take(fixture);
    let covered: Vec<bool> = taken.iter().map(|pixel| pixel[3] > 0.0).collect();
    // Where an interpolated normal turns away from the eye the twin shows nothing and the GPU turns it round: a choice at the
    // silhouette, not an error. Measured 0.4 % of the pixels.
    let turned_away = |k: &usize| twin.mask[*k] && twin.radiance[*k] == [0.0; 3];
    let mut both: Vec<usize> = (0..taken.len()).filter(|&k| covered[k] && twin.mask[k]).collect();
    let all = both.len();
    both.retain(|k| !turned_away(k));
    at_most("composite: share of normals that turn away", (all - both.len()) as f64 / all as f64, 0.02)?;
    let either = (0..taken.len()).filter(|&k| covered[k] || twin.mask[k]).count();
    at_least("composite: share of pixels covered by both", both.len() as f64 / either as f64, 0.95)?;
    let [r, g, b] = [0, 1, 2].map(|c| both.iter().map(|&k| f64::from(taken[k][c])).collect::<Vec<_>>());
    let measured: Vec<_> = (0..both.len()).map(|k| [r[k], g[k], b[k]]).collect();
    let expected: Vec<_> = both.iter().map(|&k| twin.radiance[k].map(f64::from)).collect();
    // Smooth: f32 coordinates and a look-up that mixes in f32; measured 2e-4. Flat: four pixels of a silhouette seen
    // edge-on, where f32 decides which triangle is in front; measured 1 %, the other pixels 1e-5.
    let bound = if fixture.flat_normals { 0.02 } else { 1e-3 };
    at_most("composite: relative RMSE", relative_rmse(&measured, &expected), bound)
}

fn exit(normalised: bool) -> Exit {
    Exit { eta: Medium::JADE.ior.into(), normalised }
}

#[test]
fn pictures_follow_the_twin() {
    for flat in [false, true] {
        holds(picture(&lit(flat, Profile::DipoleNormalised), &SHOT, exit(true)));
        holds(picture(&lit(flat, Profile::Dipole), &SHOT, exit(false)));
    }
}

#[test]
fn another_exit_or_camera_is_noticed() {
    let fixture = lit(false, Profile::DipoleNormalised);
    notices(picture(&fixture, &SHOT, exit(false)));
    notices(picture(&fixture, &SHOT, Exit { eta: 1.4, normalised: true }));
    let aside = Shot { target: [0.5, 48.0, 0.0], ..SHOT };
    notices(picture(&fixture, &aside, exit(true)));
}
