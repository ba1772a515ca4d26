//! Gather: position, normal, live area and irradiance of every texel (twin of the GPU's gather stage).
//!
//! Shadows are cast as rays, with no correction of the shadow terminator: a texel whose triangle faces away from a
//! shadowing light is dark even where the interpolated normal still sees the light.

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;
use translume_mesh::{Atlas, Texel};

use crate::lights::{Lighting, Place};
use crate::rgb::accumulate;
use crate::surface::{interpolate, triangle_area};
use crate::{Boundary, Light, Surface};

/// A texel that gives and receives light: one entry of the diffusion source map.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Source {
    /// Position, mm.
    pub position: [f64; 3],
    /// Unit shading normal, or the zero vector where none exists.
    pub normal: [f64; 3],
    /// Live area of the surface inside the texel, mm².
    pub area: f64,
    /// Irradiance that entered, W/m².
    pub irradiance: [f64; 3],
}

impl Source {
    /// Power E·A that entered, in W/m² · mm².
    #[must_use]
    pub fn power(&self) -> [f64; 3] {
        crate::rgb::scale(self.irradiance, self.area)
    }

    /// Rms radius of a disc of the same area, √(A / 2π), mm.
    #[must_use]
    pub fn spread(&self) -> f64 {
        (self.area / (2.0 * PI)).sqrt()
    }
}

/// What a gather needs to know.
#[derive(Clone, Copy)]
pub struct Gather<'a> {
    /// The atlas; its triangles are those of `surface`.
    pub atlas: &'a Atlas,
    /// Vertex positions at rest, mm, indexed by the surface's triangles.
    pub rest: &'a [[f64; 3]],
    /// Millimetres per unit of the atlas's rest areas.
    pub mm_per_unit: f64,
    /// The surface as it is now.
    pub surface: &'a Surface,
    /// The lights.
    pub lights: &'a [Light],
    /// How light enters.
    pub boundary: Boundary,
    /// Light is the mean over this number squared of points inside the texel's square, those on the surface; 0 and 1 take
    /// the texel's centre, moved to the edge of its triangle if it lies outside.
    pub samples: u32,
    /// Light from an extended source that casts a shadow is taken along this number squared of directions from each point,
    /// spread evenly and jittered anew at each point; 0 counts as 1. It is exact where all of the source is seen, or none. In
    /// a penumbra a single direction is off in the mean too, as the cosine cannot weigh it; with 4 or more, within 0.2 %.
    pub rays: u32,
}

impl Gather<'_> {
    /// All texels, in the atlas's order.
    #[must_use]
    pub fn run(&self) -> Vec<Source> {
        let lighting = Lighting::new(self.surface, self.lights, self.boundary, self.rays);
        let grid = (self.samples > 1).then(|| TriangleGrid::new(self.atlas));
        self.atlas.texels.par_iter().map(|texel| self.source(texel, &lighting, grid.as_ref())).collect()
    }

    fn source(&self, texel: &Texel, lighting: &Lighting<'_>, grid: Option<&TriangleGrid<'_>>) -> Source {
        let barycentric = texel.barycentric.map(f64::from);
        let centre = self.place(texel.triangle, clamped(barycentric));
        let irradiance = grid
            .and_then(|grid| self.mean_irradiance(texel, lighting, grid))
            .unwrap_or_else(|| lighting.irradiance(centre));
        Source {
            position: self.surface.point(texel.triangle, barycentric),
            normal: centre.normal.to_array(),
            area: self.live_area(texel),
            irradiance,
        }
    }

    fn place(&self, triangle: u32, barycentric: [f64; 2]) -> Place {
        Place {
            position: self.surface.point(triangle, barycentric).into(),
            normal: self.surface.normal(triangle, barycentric).into(),
            triangle,
        }
    }

    fn live_area(&self, texel: &Texel) -> f64 {
        let rest = f64::from(texel.area) * self.mm_per_unit * self.mm_per_unit;
        let corners =
            self.surface.triangles[texel.triangle as usize].map(|v| DVec3::from(self.rest[v as usize]));
        let rest_triangle = triangle_area(corners);
        if rest_triangle > 0.0 { rest * self.surface.area(texel.triangle) / rest_triangle } else { rest }
    }

    /// `None` if no sample point lies on the surface.
    fn mean_irradiance(
        &self,
        texel: &Texel,
        lighting: &Lighting<'_>,
        grid: &TriangleGrid<'_>,
    ) -> Option<[f64; 3]> {
        let n = self.samples;
        let (mut sum, mut count) = ([0.0; 3], 0u32);
        for k in 0..n * n {
            let within = [k % n, k / n].map(|step| (f64::from(step) + 0.5) / f64::from(n));
            let uv =
                [0, 1].map(|axis| (f64::from(texel.pixel[axis]) + within[axis]) / f64::from(self.atlas.size));
            if let Some((triangle, barycentric)) = grid.locate(texel.pixel, uv) {
                accumulate(&mut sum, lighting.irradiance(self.place(triangle, barycentric)), 1.0);
                count += 1;
            }
        }
        if count == 0 {
            let [per_column, per_row] = weights_per_pixel(self.atlas, texel.triangle)?;
            let centre = texel.barycentric.map(f64::from);
            for k in 0..n * n {
                let [column, row] = [k % n, k / n].map(|step| (f64::from(step) + 0.5) / f64::from(n) - 0.5);
                let weights = [0, 1].map(|w| centre[w] + per_column[w] * column + per_row[w] * row);
                accumulate(&mut sum, lighting.irradiance(self.place(texel.triangle, clamped(weights))), 1.0);
            }
            count = n * n;
        }
        Some(crate::rgb::scale(sum, 1.0 / f64::from(count)))
    }
}

/// Weights outside the triangle are moved into it and renormalised. They end a little inside: a ray from the very edge of a crease starts
/// on both of its triangles, and neither shadows it.
pub(crate) fn clamped([b, c]: [f64; 2]) -> [f64; 2] {
    const INSIDE: f64 = 1e-4;
    if (1.0 - b - c).min(b).min(c) >= 0.0 {
        return [b, c];
    }
    let [a, b, c] = [1.0 - b - c, b, c].map(|weight| weight.max(INSIDE));
    [b / (a + b + c), c / (a + b + c)]
}

/// The atlas triangles whose bounding box meets each pixel.
struct TriangleGrid<'a> {
    atlas: &'a Atlas,
    cells: Vec<Vec<u32>>,
}

impl<'a> TriangleGrid<'a> {
    fn new(atlas: &'a Atlas) -> Self {
        let size = f64::from(atlas.size);
        let mut cells = vec![Vec::new(); (atlas.size * atlas.size) as usize];
        let pixel = |x: f64| (x * size).floor().clamp(0.0, size - 1.0) as usize;
        for triangle in 0..atlas.triangles.len() as u32 {
            let uv = corners(atlas, triangle);
            let low = [0, 1].map(|k| pixel(uv[0][k].min(uv[1][k]).min(uv[2][k])));
            let high = [0, 1].map(|k| pixel(uv[0][k].max(uv[1][k]).max(uv[2][k])));
            for row in low[1]..=high[1] {
                for column in low[0]..=high[0] {
                    cells[row * atlas.size as usize + column].push(triangle);
                }
            }
        }
        Self { atlas, cells }
    }

    /// The triangle that holds a texture coordinate inside the given pixel, and the weights there.
    fn locate(&self, pixel: [u16; 2], uv: [f64; 2]) -> Option<(u32, [f64; 2])> {
        let cell = usize::from(pixel[1]) * self.atlas.size as usize + usize::from(pixel[0]);
        self.cells[cell].iter().find_map(|&triangle| {
            let [b, c] = barycentric(corners(self.atlas, triangle), uv)?;
            (b >= 0.0 && c >= 0.0 && b + c <= 1.0).then_some((triangle, [b, c]))
        })
    }
}

fn corners(atlas: &Atlas, triangle: u32) -> [[f64; 2]; 3] {
    atlas.triangles[triangle as usize].map(|v| atlas.vertices[v as usize].uv.map(f64::from))
}

/// Change of a triangle's weights over the width and the height of a pixel.
fn weights_per_pixel(atlas: &Atlas, triangle: u32) -> Option<[[f64; 2]; 2]> {
    let uv = corners(atlas, triangle);
    let pixel = 1.0 / f64::from(atlas.size);
    let at = |u, v| barycentric(uv, [uv[0][0] + u, uv[0][1] + v]);
    Some([at(pixel, 0.0)?, at(0.0, pixel)?])
}

fn barycentric([a, b, c]: [[f64; 2]; 3], p: [f64; 2]) -> Option<[f64; 2]> {
    let cross = |q: [f64; 2], r: [f64; 2]| (q[0] - a[0]) * (r[1] - a[1]) - (q[1] - a[1]) * (r[0] - a[0]);
    let area = cross(b, c);
    (area != 0.0).then(|| [cross(p, c) / area, cross(b, p) / area])
}

/// Texture coordinate of a point of an atlas triangle.
pub(crate) fn texture_coordinate(atlas: &Atlas, triangle: u32, barycentric: [f64; 2]) -> [f64; 2] {
    let uv = corners(atlas, triangle).map(|[u, v]| DVec3::new(u, v, 0.0));
    let point = interpolate(uv, barycentric);
    [point.x, point.y]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fresnel::transmittance;
    use crate::testing::{assert_rel, square, square_atlas};

    fn floor() -> (Surface, Atlas) {
        let (positions, triangles) = square(8.0, 0.0);
        (Surface::flat(positions, triangles), square_atlas(16, 8.0))
    }

    fn sun(to_light: [f64; 3], shadow: bool) -> Light {
        Light::Directional { to_light, irradiance: [3.0, 2.0, 1.0], shadow, region: None }
    }

    fn run(surface: &Surface, atlas: &Atlas, lights: &[Light], ior: f64, samples: u32) -> Vec<Source> {
        let (rest, boundary) = (&surface.positions, ior.into());
        Gather { atlas, rest, mm_per_unit: 1.0, surface, lights, boundary, samples, rays: 1 }.run()
    }

    #[test]
    fn directional_light_on_a_floor() {
        let (surface, atlas) = floor();
        let to_light = [0.6, 0.8, 0.0];
        let sources = run(&surface, &atlas, &[sun(to_light, true)], 1.3, 1);
        let expected = transmittance(1.3, 0.8) * 0.8;
        for source in &sources {
            assert_eq!(source.normal, [0.0, 1.0, 0.0]);
            assert_rel(source.irradiance[0], 3.0 * expected, 1e-12, "E");
            assert_rel(source.area, 1.0, 1e-6, "f32 rest area");
        }
        // Texel 0 is centred half a texel from the corner (−8, 8).
        assert!((DVec3::from(sources[0].position) - DVec3::new(-7.5, 0.0, 7.5)).length() < 1e-5);
        assert!((sources[0].irradiance[0] - 3.0 * 0.8).abs() > 0.01, "without Fresnel it must differ");
        let below = run(&surface, &atlas, &[sun([0.0, -1.0, 0.0], false)], 1.3, 1);
        assert!(below.iter().all(|source| source.irradiance == [0.0; 3]));
    }

    #[test]
    fn smooth_shading_takes_the_interpolated_normal() {
        let (floor, atlas) = floor();
        let lean = |x: f64| DVec3::new(x, 1.0, 0.0).normalize().to_array();
        let normals = floor.positions.iter().map(|p| lean(p[0] / 8.0)).collect();
        let surface = Surface::new(floor.positions.clone(), normals, floor.triangles.clone(), false);
        for (source, flat) in run(&surface, &atlas, &[sun([0.0, 1.0, 0.0], true)], 1.0, 1).iter().zip(run(
            &floor,
            &atlas,
            &[],
            1.0,
            1,
        )) {
            // Corner normals lean to −x and +x, so between them they interpolate linearly before normalising.
            let expected = lean(source.position[0] / 8.0);
            assert!((DVec3::from(source.normal) - DVec3::from(expected)).length() < 1e-6);
            assert_rel(source.irradiance[0], 3.0 * expected[1], 1e-6, "f32 barycentrics");
            assert!((DVec3::from(flat.normal) - DVec3::from(expected)).length() > 0.01);
        }
    }

    #[test]
    fn point_light_falls_off_with_the_square() {
        let (surface, atlas) = floor();
        let lamp = |height: f64| {
            [Light::Point { position: [0.5, height, 0.5], intensity: [1.0; 3], shadow: true, region: None }]
        };
        let at = |height: f64| run(&surface, &atlas, &lamp(height), 1.0, 1)[7 * 16 + 8].irradiance[0];
        assert_rel(at(2.0), 0.25, 1e-6, "f32 barycentrics");
        assert_rel(at(4.0), 1.0 / 16.0, 1e-6, "f32 barycentrics");
        assert!(at(0.0).is_finite(), "a light on the surface");
    }

    #[test]
    fn region_and_several_lights() {
        let (surface, atlas) = floor();
        let half = Some(([0.0, -1e-6, -100.0], [100.0, 1e-6, 100.0]));
        let lights = [
            Light::Directional {
                to_light: [0.0, 1.0, 0.0],
                irradiance: [1.0; 3],
                shadow: false,
                region: half,
            },
            Light::Ambient { radiance: [1.0 / PI; 3], axis: [0.0, 1.0, 0.0], half_angle: PI, shadow: false },
        ];
        for source in run(&surface, &atlas, &lights, 1.0, 1) {
            let expected = if source.position[0] > 0.0 { 2.0 } else { 1.0 };
            assert_rel(source.irradiance[0], expected, 1e-9, "E");
        }
    }

    /// A roof whose shadow ends in the middle of a texel: the centre is all or nothing, the mean is a share.
    #[test]
    fn samples_resolve_the_shadow_edge() {
        let (mut positions, mut triangles) = square(8.0, 0.0);
        let (mut roof, _) = square(8.0, 2.0);
        roof.iter_mut().for_each(|p| p[0] = p[0].min(0.25));
        positions.extend(roof);
        triangles.extend([[4, 5, 6], [4, 6, 7]]);
        let surface = Surface::flat(positions, triangles);
        let atlas = square_atlas(16, 8.0);
        let lit = |samples: u32| {
            run(&surface, &atlas, &[sun([0.0, 1.0, 0.0], true)], 1.0, samples)[8 * 16 + 8].irradiance[2]
        };
        assert_eq!(lit(1), 1.0);
        // The texel spans x 0..1; 6 of 8 columns lie beyond 0.25.
        assert_rel(lit(8), 0.75, 1e-12, "columns");
        let open = run(&surface, &atlas, &[sun([0.0, 1.0, 0.0], false)], 1.0, 8);
        assert!(open.iter().all(|source| (source.irradiance[2] - 1.0).abs() < 1e-12));
    }

    #[test]
    fn area_follows_the_deformation() {
        let (rest, atlas) = floor();
        let stretched: Vec<[f64; 3]> =
            rest.positions.iter().map(|p| [2.0 * p[0], p[1], 3.0 * p[2]]).collect();
        let surface = Surface::flat(stretched, rest.triangles.clone());
        let gather = Gather {
            atlas: &atlas,
            rest: &rest.positions,
            mm_per_unit: 1.0,
            surface: &surface,
            lights: &[],
            boundary: 1.3.into(),
            samples: 1,
            rays: 1,
        };
        let total: f64 = gather.run().iter().map(|source| source.area).sum();
        assert_rel(total, 6.0 * 256.0, 1e-6, "f32 rest areas");
        let unscaled = Gather { mm_per_unit: 0.5, ..gather }.run();
        assert_rel(unscaled[0].area, 1.5, 1e-6, "a quarter of the unit's square");
        let crushed = Surface::flat(vec![[0.0; 3]; 4], rest.triangles.clone());
        let flat = Gather { surface: &crushed, ..gather }.run();
        assert!(flat.iter().all(|s| s.area == 0.0 && s.normal == [0.0; 3] && s.irradiance == [0.0; 3]));
    }

    #[test]
    fn weights_beyond_the_triangle_are_clamped_for_light_only() {
        let (surface, mut atlas) = floor();
        atlas.texels[0] = Texel { triangle: 0, barycentric: [1.5, -0.25], ..atlas.texels[0] };
        let half = Some(([-100.0; 3], [8.0 + 1e-9, 100.0, 100.0]));
        let light = [Light::Directional {
            to_light: [0.0, 1.0, 0.0],
            irradiance: [1.0; 3],
            shadow: true,
            region: half,
        }];
        let source = run(&surface, &atlas, &light, 1.0, 1)[0];
        assert!(source.position[0] > 8.5, "{:?}", source.position);
        assert_eq!(source.irradiance, [1.0; 3], "light is taken at the corner, inside the region");
        assert_eq!(clamped([0.25, 0.5]), [0.25, 0.5]);
        let [b, c] = clamped([1.5, -0.25]);
        assert!((b - 1.0).abs() < 2e-4 && c > 5e-5 && c < 2e-4, "a little inside the corner: {b} {c}");
    }
}
