//! A body in front of a camera, for the rivals and for the integral over its surface.

use translume::{DirectionalLight, Light, Medium, readback};
use translume_mesh::Mesh;
use translume_reference::composite::{self, Exit};
use translume_reference::converged::Converged;
use translume_reference::profile::{Channel, Entry, Profile, normalised_diffusion};
use translume_reference::{Hit, Surface};
use translume_rivals::{Frame, Geometry, Renderer, Rival, ScreenSpace, TranslucentShadowMap};
use translume_tests::{Shot, gpu, light};

/// All lengths are millimetres.
pub struct Scene {
    pub mesh: Mesh,
    pub medium: Medium,
    pub lights: Vec<Light>,
    pub shot: Shot,
}

/// Radiance of every pixel, alpha 1 where the body is.
pub type Picture = Vec<[f32; 4]>;

impl Scene {
    pub fn bounds(&self) -> [[f32; 3]; 2] {
        let fold = |start: f32, f: fn(f32, f32) -> f32| {
            [0, 1, 2].map(|k| self.mesh.positions.iter().map(|p| p[k]).fold(start, f))
        };
        [fold(f32::INFINITY, f32::min), fold(f32::NEG_INFINITY, f32::max)]
    }

    pub fn frame(&self) -> Frame<'_> {
        Frame {
            medium: self.medium,
            lights: &self.lights,
            camera: self.shot.camera(),
            mm_per_unit: 1.0,
            bounds: self.bounds(),
        }
    }

    pub fn geometry(&self) -> Geometry {
        let wide = |vectors: &[[f32; 3]]| vectors.iter().map(|&[x, y, z]| [x, y, z, 0.0]).collect::<Vec<_>>();
        let Mesh { positions, normals, triangles, .. } = &self.mesh;
        let geometry = Geometry::new(&gpu().device, &gpu().queue, positions.len(), triangles).unwrap();
        geometry.write(&gpu().queue, &wide(positions), &wide(normals)).unwrap();
        geometry
    }

    /// A renderer that has drawn the scene.
    pub fn render(&self, rival: Rival) -> Renderer {
        let mut renderer = Renderer::new(&gpu().device, rival, [self.shot.size; 2]).unwrap();
        renderer.prepare(&gpu().queue, &self.frame()).unwrap();
        self.encode(&renderer, &self.geometry());
        renderer
    }

    pub fn encode(&self, renderer: &Renderer, geometry: &Geometry) {
        let mut encoder = gpu().device.create_command_encoder(&Default::default());
        renderer.encode(&mut encoder, geometry);
        gpu().queue.submit([encoder.finish()]);
    }

    pub fn picture(&self, rival: Rival) -> Picture {
        read(&self.render(rival))
    }

    pub fn surface(&self) -> Surface {
        let wide = |vectors: &[[f32; 3]]| vectors.iter().map(|p| p.map(f64::from)).collect::<Vec<_>>();
        let Mesh { positions, normals, triangles, .. } = &self.mesh;
        Surface::new(wide(positions), wide(normals), triangles.clone(), false)
    }

    /// What of every pixel's surface the eye sees: its middle, on the body.
    pub fn hits(&self, surface: &Surface) -> Vec<Option<Hit>> {
        let camera = self.shot.twin(1.0);
        let size = camera.width;
        (0..size * size)
            .map(|k| surface.closest_hit(camera.eye, camera.direction(k % size, k / size)))
            .collect()
    }

    /// The integral's picture by these profiles, at every `stride`th pixel each way; the others are empty. Light is cast onto patches of
    /// `edge` mm.
    pub fn judge<P: Profile>(&self, profiles: [P; 3], stride: usize, edge: f64) -> Picture {
        let surface = self.surface();
        let lights: Vec<_> = self.lights.iter().map(|each| light(each, 1.0)).collect();
        let converged =
            Converged::with_profiles(&surface, &lights, f64::from(self.medium.ior), profiles, edge);
        let size = self.shot.size as usize;
        let picked = |k: &usize| (k % size) % stride == stride / 2 && (k / size) % stride == stride / 2;
        let hits = self.hits(&surface);
        let pixels: Vec<_> = (0..hits.len()).filter(picked).filter(|&k| hits[k].is_some()).collect();
        let places: Vec<_> = pixels
            .iter()
            .filter_map(|&k| hits[k].as_ref())
            .map(|hit| surface.point(hit.triangle, hit.barycentric))
            .collect();
        let exitance = converged.exitance(&places);
        // The factor of each pixel: a picture of exitance 1.
        let exit = Exit { eta: self.medium.ior.into(), normalised: true };
        let factor = composite::render(&self.shot.twin(1.0), &surface, exit, |_| [1.0; 3]);
        let mut picture = vec![[0.0; 4]; hits.len()];
        for (k, b) in pixels.into_iter().zip(exitance) {
            let [r, g, b] = b.map(|b| b as f32 * factor.radiance[k][0]);
            picture[k] = [r, g, b, 1.0];
        }
        picture
    }
}

/// Normalised diffusion of each channel.
pub fn burley(medium: &Medium) -> [translume_reference::profile::Numeric; 3] {
    [0, 1, 2].map(|k| {
        let channel = Channel {
            sigma_s_prime: medium.sigma_s_prime[k].into(),
            sigma_a: medium.sigma_a[k].into(),
            ior: medium.ior.into(),
        };
        normalised_diffusion(&channel, Entry::Diffuse, None)
    })
}

pub fn read(renderer: &Renderer) -> Picture {
    readback::texture(&gpu().device, &gpu().queue, renderer.picture(), 0).unwrap()
}

/// Relative RMSE over the pixels that both show and whose neighbours are covered too, of the mean of the reference; and the bias.
pub fn error(found: &Picture, expected: &Picture, size: usize) -> [f64; 2] {
    let covered = |k: usize| found[k][3] > 0.0;
    let whole = |k: usize| {
        let (x, y) = (k % size, k / size);
        x > 0
            && y > 0
            && x + 1 < size
            && y + 1 < size
            && [k, k - 1, k + 1, k - size, k + size].into_iter().all(covered)
    };
    let pixels: Vec<_> = (0..found.len()).filter(|&k| expected[k][3] > 0.0 && whole(k)).collect();
    let take = |picture: &Picture| -> Vec<f64> {
        pixels.iter().flat_map(|&k| picture[k][..3].iter().map(|&x| f64::from(x))).collect()
    };
    let figures = translume_reference::metrics::compare(&take(found), &take(expected), None).unwrap();
    [figures.relative_rmse, figures.bias]
}

/// A mesh at this many millimetres from corner to corner, around the origin.
pub fn scaled(mut mesh: Mesh, diagonal: f32) -> Mesh {
    let scale = diagonal / mesh.diagonal();
    let low = [0, 1, 2].map(|k| mesh.positions.iter().map(|p| p[k]).fold(f32::INFINITY, f32::min));
    let high = [0, 1, 2].map(|k| mesh.positions.iter().map(|p| p[k]).fold(f32::NEG_INFINITY, f32::max));
    for p in &mut mesh.positions {
        *p = [0, 1, 2].map(|k| (p[k] - 0.5 * (low[k] + high[k])) * scale);
    }
    mesh
}

/// In front of a camera that looks along −z.
pub fn before_camera(mesh: Mesh, medium: Medium, light: Light, size: u32, fov: f32) -> Scene {
    let shot = Shot { eye: [0.0, 0.0, 200.0], target: [0.0; 3], fov, size };
    Scene { mesh, medium, lights: vec![light], shot }
}

/// Facing a light in this direction.
pub fn sun(to_light: [f32; 3]) -> DirectionalLight {
    DirectionalLight { to_light, ..Default::default() }
}

/// A square of 400 mm in the plane z = 0 that faces the camera.
pub fn wall() -> Mesh {
    let mut mesh = translume_tests::plane(400.0, 16).mesh.clone();
    for v in mesh.positions.iter_mut().chain(&mut mesh.normals) {
        *v = [v[0], -v[2], v[1]];
    }
    mesh
}

pub fn default_rivals() -> [Rival; 2] {
    [Rival::TranslucentShadowMap(TranslucentShadowMap::default()), Rival::ScreenSpace(ScreenSpace::default())]
}
