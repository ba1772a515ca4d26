//! Where on the surface the light of a texel is looked up: the middles of its four quarters, each on the triangle that lies there.
//!
//! One triangle cannot stand for a texel that holds several, least of all where some of them face a light and others do not.

use glam::{DVec2, Vec2};
use translume_mesh::Atlas;

/// Points of a texel along each side.
const SIDE: u32 = 2;
pub(crate) const PER_TEXEL: usize = (SIDE * SIDE) as usize;
/// Marks a quarter of a texel whose middle lies on no triangle.
pub(crate) const NOWHERE: u32 = u32::MAX;

/// A point of a triangle, by the weights of its second and third corner, from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LightPoint {
    pub triangle: u32,
    pub weights: [f32; 2],
}

/// The points of every texel, in the atlas' order. At least one of each lies somewhere: where no triangle lies under any, as on the rim of
/// a chart, all four are moved to the edge of the triangle that stands for the texel.
pub(crate) fn light_points(atlas: &Atlas) -> Vec<[LightPoint; PER_TEXEL]> {
    let nowhere = LightPoint { triangle: NOWHERE, weights: [0.0; 2] };
    let mut grid = vec![nowhere; (atlas.size * SIDE).pow(2) as usize];
    for triangle in 0..atlas.triangles.len() as u32 {
        fill(&mut grid, atlas, triangle);
    }
    atlas
        .texels
        .iter()
        .map(|texel| {
            let [column, row] = texel.pixel.map(|k| u32::from(k) * SIDE);
            let quarters = [(0, 0), (1, 0), (0, 1), (1, 1)];
            let own = quarters.map(|(x, y)| grid[((row + y) * atlas.size * SIDE + column + x) as usize]);
            if own.iter().any(|point| point.triangle != NOWHERE) {
                return own;
            }
            let placed = Placed::new(atlas, texel.triangle);
            quarters.map(|(x, y)| {
                let step = [x, y].map(|k| (f64::from(k) + 0.5) / f64::from(SIDE) - 0.5);
                let moved = placed.as_ref().map_or(DVec2::ZERO, |placed| placed.step(step.into()));
                let weights = clamped(Vec2::from(texel.barycentric) + moved.as_vec2());
                LightPoint { triangle: texel.triangle, weights }
            })
        })
        .collect()
}

/// Writes a triangle under every point of the grid that it covers and no earlier one does.
fn fill(grid: &mut [LightPoint], atlas: &Atlas, triangle: u32) {
    let width = atlas.size * SIDE;
    let Some(placed) = Placed::new(atlas, triangle) else { return };
    let scale = f64::from(SIDE);
    let corners = [placed.a, placed.a + placed.b, placed.a + placed.c].map(|p| p * scale - 0.5);
    let low = corners[0].min(corners[1]).min(corners[2]).ceil().max(DVec2::ZERO);
    let high = corners[0].max(corners[1]).max(corners[2]).floor().min(DVec2::splat(f64::from(width) - 1.0));
    for row in low.y as u32..(high.y + 1.0).max(0.0) as u32 {
        for column in low.x as u32..(high.x + 1.0).max(0.0) as u32 {
            let point = (DVec2::new(column.into(), row.into()) + 0.5) / scale;
            let weights = placed.step(point - placed.a);
            let slot = &mut grid[(row * width + column) as usize];
            let inside = weights.min_element() >= 0.0 && weights.element_sum() <= 1.0;
            if inside && slot.triangle == NOWHERE {
                *slot = LightPoint { triangle, weights: weights.as_vec2().to_array() };
            }
        }
    }
}

/// A triangle in the atlas, in texels: a corner and the two sides from it.
struct Placed {
    a: DVec2,
    b: DVec2,
    c: DVec2,
}

impl Placed {
    /// `None` for a triangle without area.
    fn new(atlas: &Atlas, triangle: u32) -> Option<Self> {
        let [a, b, c] = atlas.triangles[triangle as usize]
            .map(|v| Vec2::from(atlas.vertices[v as usize].uv).as_dvec2() * f64::from(atlas.size));
        let placed = Self { a, b: b - a, c: c - a };
        (placed.b.perp_dot(placed.c) != 0.0).then_some(placed)
    }

    /// Change of the two weights over a step in texels.
    fn step(&self, step: DVec2) -> DVec2 {
        DVec2::new(step.perp_dot(self.c), self.b.perp_dot(step)) / self.b.perp_dot(self.c)
    }
}

/// Weights moved into the triangle.
fn clamped(weights: Vec2) -> [f32; 2] {
    let [a, b, c] = [1.0 - weights.element_sum(), weights.x, weights.y].map(|weight| weight.max(0.0));
    [b / (a + b + c), c / (a + b + c)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use translume_mesh::{AtlasVertex, Mesh};

    /// A fan of eight triangles around (½, ½), cut off so that its edge crosses texels.
    fn fan() -> Atlas {
        let angle = |k: u32| (k as f32 * std::f32::consts::FRAC_PI_4 + 0.1).sin_cos();
        let rim = (0..8).map(|k| [0.5 + 0.45 * angle(k).1, 0.5 + 0.45 * angle(k).0]);
        let uv: Vec<[f32; 2]> = std::iter::once([0.5; 2]).chain(rim).collect();
        let mesh = Mesh {
            positions: uv.iter().map(|[u, v]| [*u, 0.0, -*v]).collect(),
            normals: vec![[0.0, 1.0, 0.0]; uv.len()],
            triangles: (0..8).map(|k| [0, 1 + k, 1 + (k + 1) % 8]).collect(),
            ..Mesh::default()
        };
        let vertices = (0..).zip(uv).map(|(xref, uv)| AtlasVertex { xref, uv }).collect();
        Atlas::from_uvs(&mesh, 32, vertices, mesh.triangles.clone()).unwrap()
    }

    /// Where a point lies in the atlas, in texels.
    fn place(atlas: &Atlas, point: &LightPoint) -> DVec2 {
        let placed = Placed::new(atlas, point.triangle).unwrap();
        let [b, c] = point.weights.map(f64::from);
        placed.a + placed.b * b + placed.c * c
    }

    #[test]
    fn points_lie_in_the_middle_of_their_quarters() {
        let atlas = fan();
        let (mut found, mut nowhere) = (0, 0);
        for (texel, points) in atlas.texels.iter().zip(light_points(&atlas)) {
            assert!(points.iter().any(|point| point.triangle != NOWHERE));
            for (k, point) in points.iter().enumerate() {
                assert!(point.weights.iter().all(|weight| (0.0..=1.0).contains(weight)), "{point:?}");
                if point.triangle == NOWHERE {
                    nowhere += 1;
                } else if texel.area > 0.0 && points.iter().any(|other| other.triangle != point.triangle) {
                    let quarter = DVec2::new((k % 2) as f64, (k / 2) as f64) * 0.5 + 0.25;
                    let expected = DVec2::new(texel.pixel[0].into(), texel.pixel[1].into()) + quarter;
                    // Single-precision weights of triangles up to ten texels wide.
                    assert!(place(&atlas, point).distance(expected) < 1e-4);
                    found += 1;
                }
            }
        }
        assert!(found > 100 && nowhere > 20, "{found} found, {nowhere} nowhere");
    }

    /// On the rim all four lie on the edge of the triangle that stands for the texel.
    #[test]
    fn the_rim_looks_at_the_edge() {
        let atlas = fan();
        let rim: Vec<_> =
            atlas.texels.iter().zip(light_points(&atlas)).filter(|(texel, _)| texel.area == 0.0).collect();
        assert!(rim.len() > 20, "{}", rim.len());
        for (texel, points) in rim {
            for LightPoint { triangle, weights: [b, c] } in points {
                assert_eq!(triangle, texel.triangle);
                assert!((1.0 - b - c).min(b).min(c).abs() < 1e-6, "{b} {c} is not on an edge");
            }
        }
    }
}
