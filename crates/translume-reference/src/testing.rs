//! Shapes and assertions that several tests share.

use crate::lights::{Lighting, Place};
use crate::{Light, Surface};
use translume_mesh::{Atlas, AtlasReport, AtlasVertex, Texel};

pub(crate) fn assert_rel(measured: f64, expected: f64, tolerance: f64, what: &str) {
    let error = (measured - expected).abs();
    assert!(
        error <= tolerance * expected.abs(),
        "{what}: {measured:e} against {expected:e}, relative error {:e}",
        error / expected.abs()
    );
}

/// A square of side `2·half` in the plane y = `height`, facing up: two triangles. In a square atlas u runs along x and
/// v along −z.
pub(crate) fn square(half: f64, height: f64) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let corner = |x: f64, z: f64| [x * half, height, z * half];
    (
        vec![corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)],
        vec![[0, 1, 2], [0, 2, 3]],
    )
}

/// The atlas of [`square`] with the whole texture covered by `size`² texels, in rows.
pub(crate) fn square_atlas(size: u32, half: f64) -> Atlas {
    let uv = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let side = 2.0 * half / f64::from(size);
    let texel = |k: u32| {
        let (column, row) = (k % size, k / size);
        let at = |k: u32| (k as f32 + 0.5) / size as f32;
        let (u, v) = (at(column), at(row));
        // (u, v) = b·(1, 0) + c·(1, 1) below the diagonal and b·(1, 1) + c·(0, 1) above it.
        let (triangle, barycentric) = if u >= v { (0, [u - v, v]) } else { (1, [u, v - u]) };
        Texel { pixel: [column as u16, row as u16], triangle, barycentric, area: (side * side) as f32 }
    };
    Atlas {
        size,
        vertices: uv.iter().enumerate().map(|(k, &uv)| AtlasVertex { xref: k as u32, uv }).collect(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        texels: (0..size * size).map(texel).collect(),
        pixels: (0..size * size).collect(),
        report: AtlasReport::default(),
    }
}

/// A thick shell: a sphere of radius 3 with a hollow one of radius 1 in its middle.
pub(crate) fn shell() -> Surface {
    let (mut positions, mut triangles) = octasphere(3.0, 4);
    let (more, others) = octasphere(1.0, 4);
    let count = positions.len() as u32;
    positions.extend(more);
    triangles.extend(others.into_iter().map(|[a, b, c]| [a + count, c + count, b + count]));
    Surface::flat(positions, triangles)
}

/// A sphere of triangles with vertices on the radius: an octahedron split `levels` times.
pub(crate) fn octasphere(radius: f64, levels: u32) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let mut positions: Vec<glam::DVec3> =
        [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]
            .map(|p: [i32; 3]| glam::DVec3::from(p.map(f64::from)))
            .to_vec();
    let mut triangles: Vec<[u32; 3]> =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for _ in 0..levels {
        let mut middles = std::collections::HashMap::new();
        let mut middle = |positions: &mut Vec<glam::DVec3>, a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push((positions[a as usize] + positions[b as usize]).normalize());
                positions.len() as u32 - 1
            })
        };
        let split = |[a, b, c]: [u32; 3]| {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(i, j)| middle(&mut positions, i, j));
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        triangles = triangles.into_iter().flat_map(split).collect();
    }
    (positions.into_iter().map(|p| (p * radius).to_array()).collect(), triangles)
}

/// B/E on a sphere of radius `r` under uniform irradiance: a/2 [g(z_r) + g(z_v)],
/// g(z) = e^(−σ_tr z) − z/D e^(−σ_tr D), D² = 4 r² + z². The chord measure of a sphere is that of a disc of radius 2r.
pub(crate) fn sphere_exitance(dipole: &crate::Dipole, r: f64) -> f64 {
    let g = |z: f64| {
        let d = (4.0 * r * r + z * z).sqrt();
        (-dipole.sigma_tr * z).exp() - z / d * (-dipole.sigma_tr * d).exp()
    };
    0.5 * dipole.albedo * (g(dipole.z[0]) + g(dipole.z[1]))
}

/// What one light lets into a place of no triangle.
pub(crate) fn entering(
    surface: &Surface,
    light: &Light,
    eta: f64,
    rays: u32,
    position: [f64; 3],
    normal: [f64; 3],
) -> [f64; 3] {
    let lighting = Lighting::new(surface, std::slice::from_ref(light), eta.into(), rays);
    lighting.irradiance(Place { position: position.into(), normal: normal.into(), triangle: u32::MAX })
}

pub(crate) fn nothing() -> Surface {
    Surface::flat(Vec::new(), Vec::new())
}

/// The part with x > `from` of a plane at a height, as far as 10⁴ mm.
pub(crate) fn half_roof(from: f64, height: f64) -> Surface {
    let far = 1e4;
    let corners = [[from, -far], [far, -far], [far, far], [from, far]];
    Surface::flat(corners.map(|[x, z]| [x, height, z]).to_vec(), vec![[0, 1, 2], [0, 2, 3]])
}

/// A wall that hides all with x > 0 from the origin, to a millionth.
pub(crate) fn wall() -> Surface {
    let (x, far) = (1e-3, 1e3);
    let corners = [[-far, -far], [far, -far], [far, far], [-far, far]];
    Surface::flat(corners.map(|[y, z]| [x, y, z]).to_vec(), vec![[0, 1, 2], [0, 2, 3]])
}

/// A horizontal ring of 256 corners around the y axis between two radii; a disc if the first is 0.
pub(crate) fn ring(radii: [f64; 2], height: f64) -> Surface {
    let count = 256;
    let at = |k: u32, radius: f64| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(count)).sin_cos();
        [radius * cos, height, radius * sin]
    };
    let positions = (0..count).flat_map(|k| radii.map(|radius| at(k, radius))).collect();
    let quad = |k: u32| {
        let [a, b, c, d] = [2 * k, 2 * k + 1, 2 * k + 2, 2 * k + 3].map(|v| v % (2 * count));
        [[a, b, c], [b, d, c]]
    };
    Surface::flat(positions, (0..count).flat_map(quad).collect())
}
