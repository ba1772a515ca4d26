//! Composite: the camera's picture (twin of the GPU's composite stage).

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;
use translume_mesh::Atlas;

use crate::fresnel::{hemispherical_transmittance, transmittance};
use crate::gather::texture_coordinate;
use crate::rgb::{accumulate, scale};
use crate::{Hit, Surface};

/// A pinhole camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Position, mm.
    pub eye: [f64; 3],
    /// A point on the axis of view, mm.
    pub target: [f64; 3],
    /// A direction that points up in the picture; not along the axis of view.
    pub up: [f64; 3],
    /// Full horizontal angle of view, radians, below π.
    pub fov: f64,
    /// Width of the picture in pixels.
    pub width: usize,
    /// Height of the picture in pixels.
    pub height: usize,
}

/// How light leaves the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exit {
    /// Index of refraction, inside over outside.
    pub eta: f64,
    /// Divide by 1 − F_dr,ext, the diffuse reflectance from outside, so that a diffuse boundary loses nothing.
    pub normalised: bool,
}

/// A picture in linear RGB, row 0 on top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Radiance, W/(m² sr), row by row; 0 where nothing is.
    pub radiance: Vec<[f32; 3]>,
    /// Whether the pixel's centre meets the surface.
    pub mask: Vec<bool>,
}

impl Camera {
    /// Direction of view, not normalised, through the centre of a pixel: f + X r + Y u with f = unit(target − eye),
    /// r = unit(f × up), u = r × f.
    #[must_use]
    pub fn direction(&self, column: usize, row: usize) -> [f64; 3] {
        self.direction_at(column as f64 + 0.5, row as f64 + 0.5)
    }

    /// The same through a place of the picture, in pixels from its left and its top.
    #[must_use]
    pub fn direction_at(&self, across: f64, down: f64) -> [f64; 3] {
        let forward = (DVec3::from(self.target) - DVec3::from(self.eye)).normalize_or_zero();
        let right = forward.cross(self.up.into()).normalize_or_zero();
        let up = right.cross(forward);
        let (width, height) = (self.width as f64, self.height as f64);
        let extent = (0.5 * self.fov).tan();
        let x = (2.0 * across / width - 1.0) * extent;
        let y = (1.0 - 2.0 * down / height) * extent * height / width;
        (forward + right * x + up * y).to_array()
    }
}

/// The picture of a surface whose exitance, W/m², the caller tells for every hit: L = F_t(eta, cos) · B / π.
///
/// The back of a triangle is shaded like its front. Where an interpolated normal turns away from the eye, cos is 0.
#[must_use]
pub fn render(
    camera: &Camera,
    surface: &Surface,
    exit: Exit,
    exitance: impl Fn(&Hit) -> [f64; 3] + Sync,
) -> Picture {
    let diffuse = if exit.normalised { hemispherical_transmittance(exit.eta) } else { 1.0 };
    expose(camera, |index| {
        let direction = camera.direction(index % camera.width, index / camera.width);
        let hit = surface.closest_hit(camera.eye, direction)?;
        let cos = view_cosine(surface, &hit, direction.into());
        let factor = transmittance(exit.eta, cos) / (PI * diffuse);
        Some(scale(exitance(&hit), factor))
    })
}

/// The picture of what the caller tells for the number of every pixel; `None` where nothing is.
pub(crate) fn expose(camera: &Camera, radiance: impl Fn(usize) -> Option<[f64; 3]> + Sync) -> Picture {
    let pixels: Vec<Option<[f64; 3]>> =
        (0..camera.width * camera.height).into_par_iter().map(&radiance).collect();
    Picture {
        width: camera.width,
        height: camera.height,
        radiance: pixels.iter().map(|pixel| pixel.unwrap_or_default().map(|value| value as f32)).collect(),
        mask: pixels.iter().map(Option::is_some).collect(),
    }
}

/// Exitance at a hit by bilinear look-up among the texels of an atlas, in the atlas's order. Pixels of the texture that
/// hold nothing are left out of the mean; 0 if all four do.
#[must_use]
pub fn look_up(atlas: &Atlas, exitance: &[[f64; 3]], hit: &Hit) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (texel, weight) in texels_at(atlas, hit) {
        accumulate(&mut sum, exitance[texel], weight);
    }
    sum
}

/// Up to four texels around a hit and their weights, which add up to 1.
pub(crate) fn texels_at(atlas: &Atlas, hit: &Hit) -> impl Iterator<Item = (usize, f64)> + use<> {
    let size = f64::from(atlas.size);
    let place = texture_coordinate(atlas, hit.triangle, hit.barycentric).map(|x| x * size - 0.5);
    let corner = place.map(f64::floor);
    let texels = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(dx, dy)| {
        let (x, y) = (corner[0] + dx, corner[1] + dy);
        let weight = (1.0 - (place[0] - x).abs()) * (1.0 - (place[1] - y).abs());
        let [column, row] = [x, y].map(|k| k.clamp(0.0, size - 1.0) as usize);
        let texel = atlas.pixels[row * atlas.size as usize + column];
        (texel as usize, if texel == Atlas::EMPTY { 0.0 } else { weight })
    });
    let total: f64 = texels.iter().map(|(_, weight)| weight).sum();
    texels.into_iter().filter(|(_, weight)| *weight > 0.0).map(move |(texel, weight)| (texel, weight / total))
}

pub(crate) fn view_cosine(surface: &Surface, hit: &Hit, direction: DVec3) -> f64 {
    let normal = DVec3::from(surface.normal(hit.triangle, hit.barycentric));
    let seen_from_behind = DVec3::from(surface.face_normal(hit.triangle)).dot(direction) > 0.0;
    let cos = -normal.dot(direction.normalize_or_zero());
    if seen_from_behind { -cos } else { cos }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{octasphere, square, square_atlas};
    use std::f64::consts::FRAC_PI_2;

    fn from_above(width: usize, height: usize) -> Camera {
        Camera { eye: [0.0, 1.0, 0.0], target: [0.0; 3], up: [0.0, 0.0, -1.0], fov: FRAC_PI_2, width, height }
    }

    #[test]
    fn pixels_look_where_the_convention_says() {
        let camera = from_above(4, 2);
        // Left of centre by 3/4 of the half width, up by half the half height: −x and −z.
        let direction = camera.direction(0, 0);
        let expected = [-0.75, -1.0, -0.25];
        assert!((0..3).all(|k| (direction[k] - expected[k]).abs() < 1e-15), "{direction:?}");
        assert!(camera.direction(0, 1)[2] > 0.0);
    }

    #[test]
    fn linear_exitance_survives_the_atlas() {
        let (positions, triangles) = square(1.0, 0.0);
        let surface = Surface::flat(positions, triangles);
        let atlas = square_atlas(16, 1.0);
        let ramp = |p: [f64; 3]| [2.0 + p[0], 3.0 - p[2], 1.0];
        let exitance: Vec<[f64; 3]> = atlas
            .texels
            .iter()
            .map(|t| ramp(surface.point(t.triangle, t.barycentric.map(f64::from))))
            .collect();
        let camera = from_above(32, 32);
        let exit = Exit { eta: 1.0, normalised: false };
        let picture = render(&camera, &surface, exit, |hit| look_up(&atlas, &exitance, hit));
        let mut inner = 0;
        for (index, radiance) in picture.radiance.iter().enumerate() {
            let [x, _, z] = camera.direction(index % 32, index / 32);
            assert!(picture.mask[index]);
            // Bilinear look-up repeats a ramp between texel centres; f32 output.
            if x.abs() < 1.0 - 1.0 / 16.0 && z.abs() < 1.0 - 1.0 / 16.0 {
                let expected = ramp([x, 0.0, z]).map(|b| b / PI);
                (0..3).for_each(|k| assert!((f64::from(radiance[k]) - expected[k]).abs() < 1e-6));
                let shifted = ramp([x + 0.01, 0.0, z])[0] / PI;
                assert!(
                    (f64::from(radiance[0]) - shifted).abs() > 1e-3,
                    "a fraction of a texel must be noticed"
                );
                inner += 1;
            }
        }
        assert!(inner > 500);
    }

    #[test]
    fn empty_pixels_do_not_darken_the_rim() {
        let mut atlas = square_atlas(4, 1.0);
        atlas.pixels[1] = Atlas::EMPTY;
        let hit = Hit { t: 1.0, triangle: 0, barycentric: [0.25, 0.02] };
        assert_eq!(look_up(&atlas, &vec![[2.0; 3]; 16], &hit), [2.0; 3]);
        atlas.pixels.fill(Atlas::EMPTY);
        assert_eq!(look_up(&atlas, &vec![[2.0; 3]; 16], &hit), [0.0; 3]);
    }

    #[test]
    fn sphere_shows_the_exit_transmittance() {
        let (positions, triangles) = octasphere(1.0, 5);
        let surface = Surface::smooth(positions, triangles);
        let camera = Camera {
            eye: [0.0, 0.0, 5.0],
            target: [0.0; 3],
            up: [0.0, 1.0, 0.0],
            fov: 0.5,
            width: 33,
            height: 33,
        };
        let centre = 16 * 33 + 16;
        let picture = |exit| render(&camera, &surface, exit, |_| [PI, 2.0 * PI, 0.0]);
        let plain = picture(Exit { eta: 1.3, normalised: false });
        let normal = transmittance(1.3, 1.0);
        assert!((f64::from(plain.radiance[centre][0]) - normal).abs() < 1e-6);
        assert!((f64::from(plain.radiance[centre][1]) - 2.0 * normal).abs() < 1e-6);
        assert!(!plain.mask[0] && plain.radiance[0] == [0.0; 3]);
        let normalised = picture(Exit { eta: 1.3, normalised: true });
        let gain = f64::from(normalised.radiance[centre][0] / plain.radiance[centre][0]);
        assert!((gain - 1.0 / hemispherical_transmittance(1.3)).abs() < 1e-6);
        assert!((gain - 1.0).abs() > 0.05);
        let matched = picture(Exit { eta: 1.0, normalised: true });
        assert!((matched.radiance[centre][0] - 1.0).abs() < 1e-6);
    }
}
