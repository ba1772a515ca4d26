//! Chooses the triangle that stands for each texel, and adds the rim around each chart.

use glam::DVec2;

use super::raster::{Fragments, signed_area};
use super::{Atlas, Texel};

/// What is left of a triangle's determinant, in texel squares, that barycentric weights can be divided by.
const MIN_DETERMINANT: f64 = 1e-12;

/// The layout in texel units, as the choice of triangles needs it.
#[derive(Clone, Copy)]
pub(super) struct Charted<'a> {
    pub size: u32,
    pub corners: &'a [[DVec2; 3]],
    /// Surface of each triangle, squared model units.
    pub areas: &'a [f64],
    /// Chart of each triangle.
    pub charts: &'a [u32],
}

impl Charted<'_> {
    /// Covered texels and the rim around them, in the order of the pixels.
    pub fn texels(&self, fragments: &Fragments) -> Vec<Texel> {
        let pixels = 0..(self.size * self.size) as usize;
        pixels
            .filter_map(|pixel| self.covered(pixel, fragments).or_else(|| self.rim(pixel, fragments)))
            .collect()
    }

    fn covered(&self, pixel: usize, fragments: &Fragments) -> Option<Texel> {
        let found = fragments.at(pixel);
        let triangles = found.iter().map(|f| f.triangle);
        let area = found.iter().map(|f| f64::from(f.share) * self.areas[f.triangle as usize]).sum::<f64>();
        self.texel(pixel, triangles, area as f32)
    }

    /// A texel next to a covered one: the nearest chart claims it.
    fn rim(&self, pixel: usize, fragments: &Fragments) -> Option<Texel> {
        let mut near: Vec<u32> = neighbours(pixel, self.size)
            .flat_map(|neighbour| fragments.at(neighbour).iter().map(|f| f.triangle))
            .collect();
        near.sort_unstable();
        near.dedup();
        let centre = centre(pixel, self.size);
        let distance = |t: u32| distance_squared(&self.corners[t as usize], centre);
        let (_, nearest) = near.iter().map(|&t| (distance(t), t)).min_by(|(a, _), (b, _)| a.total_cmp(b))?;
        let chart = self.charts[nearest as usize];
        let of_chart = near.into_iter().filter(|&t| self.charts[t as usize] == chart);
        self.texel(pixel, of_chart, 0.0)
    }

    /// The texel for the triangle that has to be extended least to reach the centre; the first among equals.
    fn texel(&self, pixel: usize, triangles: impl Iterator<Item = u32>, area: f32) -> Option<Texel> {
        let centre = centre(pixel, self.size);
        let weighed = triangles.map(|t| (t, Weights::at(&self.corners[t as usize], centre)));
        let (triangle, weights) = weighed.min_by(|(_, x), (_, y)| x.beyond.total_cmp(&y.beyond))?;
        let [column, row] = [pixel as u32 % self.size, pixel as u32 / self.size].map(|x| x as u16);
        let [_, second, third] = weights.limited();
        Some(Texel { pixel: [column, row], triangle, barycentric: [second as f32, third as f32], area })
    }
}

/// The eight pixels around one, without those outside the texture.
pub(super) fn neighbours(pixel: usize, size: u32) -> impl Iterator<Item = usize> {
    let size = size as usize;
    let (row, column) = (pixel / size, pixel % size);
    let around = move |x: usize| x.saturating_sub(1)..=(x + 1).min(size - 1);
    around(row)
        .flat_map(move |y| around(column).map(move |x| y * size + x))
        .filter(move |&neighbour| neighbour != pixel)
}

/// Centre of a pixel, texel units.
fn centre(pixel: usize, size: u32) -> DVec2 {
    let size = size as usize;
    DVec2::new((pixel % size) as f64 + 0.5, (pixel / size) as f64 + 0.5)
}

/// Barycentric weights of a point, and how far it lies beyond the triangle.
struct Weights {
    weights: [f64; 3],
    /// Minus the sum of the negative weights; infinite where the triangle has no shape in UV.
    beyond: f64,
}

impl Weights {
    fn at(corners: &[DVec2; 3], p: DVec2) -> Self {
        let double = 2.0 * signed_area(corners);
        if double.abs() < MIN_DETERMINANT {
            return Self { weights: [1.0 / 3.0; 3], beyond: f64::INFINITY };
        }
        let [a, b, c] = *corners;
        let second = (p - a).perp_dot(c - a) / double;
        let third = (b - a).perp_dot(p - a) / double;
        let weights = [1.0 - second - third, second, third];
        Self { weights, beyond: weights.iter().map(|w| (-w).max(0.0)).sum() }
    }

    /// Weights pulled towards the triangle until they reach no further than [`Atlas::MAX_EXTRAPOLATION`].
    fn limited(&self) -> [f64; 3] {
        let limit = f64::from(Atlas::MAX_EXTRAPOLATION);
        if !self.beyond.is_finite() || self.beyond <= limit {
            return self.weights;
        }
        // The clamped point has weight 0 wherever this one is negative, so the excess shrinks linearly.
        let inside = self.weights.map(|w| w.max(0.0) / (1.0 + self.beyond));
        let reach = limit / self.beyond;
        std::array::from_fn(|k| inside[k] + reach * (self.weights[k] - inside[k]))
    }
}

fn distance_squared(corners: &[DVec2; 3], p: DVec2) -> f64 {
    if Weights::at(corners, p).beyond == 0.0 {
        return 0.0;
    }
    let to_edge = |from: DVec2, to: DVec2| {
        let along = to - from;
        let t = (p - from).dot(along) / along.length_squared();
        // An edge without length gives NaN, which clamp keeps and max discards.
        p.distance_squared(from + along * t.clamp(0.0, 1.0).max(0.0))
    };
    let [a, b, c] = *corners;
    to_edge(a, b).min(to_edge(b, c)).min(to_edge(c, a))
}
