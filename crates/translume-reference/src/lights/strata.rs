//! Directions to look along: one at random in each cell of a square, and the maps from the square.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use glam::{DMat3, DVec3};

/// Cells of the unit square, `side` along each edge, with a seed that places a point in each.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Strata {
    side: u32,
    seed: u64,
}

impl Strata {
    /// `side` of 0 counts as 1. The seed depends on nothing but its arguments, so that runs repeat bit for bit; every
    /// position and `stream` has its own, so that what is left of the noise averages out over texels.
    pub fn new(side: u32, position: DVec3, stream: usize) -> Self {
        let bits = position.to_array().map(f64::to_bits);
        let seed = bits.into_iter().fold(mix(stream as u64), |seed, bits| mix(seed ^ bits));
        Self { side: side.max(1), seed }
    }

    pub fn side(&self) -> u32 {
        self.side
    }

    /// One point of the unit square in each of side² cells.
    pub fn points(&self) -> impl Iterator<Item = [f64; 2]> + use<> {
        self.grid(self.side, 0)
    }

    /// One point of the unit square in each of side·`rows` cells; grids with another `first` are independent.
    pub fn grid(&self, rows: u32, first: u32) -> impl Iterator<Item = [f64; 2]> + use<> {
        let Self { side, seed } = *self;
        let offset = u64::from(first) * u64::from(side);
        (0..u64::from(rows) * u64::from(side)).map(move |k| {
            let jitter = [0, 1].map(|axis| unit(mix(seed.wrapping_add(2 * (offset + k) + axis))));
            let (column, row) = (k % u64::from(side), k / u64::from(side));
            [(column as f64 + jitter[0]) / f64::from(side), (row as f64 + jitter[1]) / f64::from(rows)]
        })
    }
}

/// The output step of `SplitMix64` on its next state. Source: Steele, Lea and Flood 2014, "Fast splittable pseudorandom
/// number generators".
pub(crate) fn mix(state: u64) -> u64 {
    let z = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A number in 0..1 from the upper 53 bits.
pub(crate) fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 * 2.0f64.powi(-53)
}

/// The unit square onto the unit disc, areas and neighbourhoods kept.
///
/// Source: Shirley and Chiu 1997, "A low distortion map between disk and square".
pub(crate) fn disc(point: [f64; 2]) -> [f64; 2] {
    let [a, b] = point.map(|x| 2.0 * x - 1.0);
    let (radius, angle) = if a.abs() > b.abs() {
        (a, FRAC_PI_4 * (b / a))
    } else if b != 0.0 {
        (b, FRAC_PI_2 - FRAC_PI_4 * (a / b))
    } else {
        (0.0, 0.0)
    };
    [radius * angle.cos(), radius * angle.sin()]
}

/// The unit square onto the hemisphere around a unit vector, with density cos/π.
pub(crate) fn hemisphere(axis: DVec3, point: [f64; 2]) -> DVec3 {
    let [x, y] = disc(point);
    frame(axis) * DVec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt())
}

/// The unit square onto a cone around a unit vector, with uniform density; and 1 − cos of the angle from the axis.
/// `opening` is 1 − cos of the half opening angle, 0..=2.
pub(crate) fn cone(axis: DVec3, opening: f64, point: [f64; 2]) -> (DVec3, f64) {
    let [x, y] = disc(point);
    let height = opening * (x * x + y * y);
    let across = (opening * (2.0 - height)).max(0.0).sqrt();
    (frame(axis) * DVec3::new(x * across, y * across, 1.0 - height), height)
}

pub(crate) fn frame(axis: DVec3) -> DMat3 {
    let (x, y) = axis.any_orthonormal_pair();
    DMat3::from_cols(x, y, axis)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_cell_holds_one_point() {
        for side in [0, 1, 5] {
            let strata = Strata::new(side, DVec3::new(1.0, 2.0, 3.0), 0);
            let side = side.max(1);
            let mut cells: Vec<_> =
                strata.points().map(|p| p.map(|x| (x * f64::from(side)) as u32)).collect();
            cells.sort_unstable();
            let all: Vec<_> = (0..side).flat_map(|x| (0..side).map(move |y| [x, y])).collect();
            assert_eq!(cells, all);
        }
    }

    #[test]
    fn seeds_repeat_and_differ() {
        let points =
            |position: DVec3, stream| -> Vec<_> { Strata::new(4, position, stream).points().collect() };
        let here = DVec3::new(0.25, 0.0, 0.0);
        assert_eq!(points(here, 0), points(here, 0));
        assert_ne!(points(here, 0), points(here, 1));
        assert_ne!(points(here, 0), points(DVec3::new(0.25 + 1e-15, 0.0, 0.0), 0));
        assert_ne!(
            points(here, 0),
            points(DVec3::new(0.0, 0.25, 0.0), 0),
            "axes must not be interchangeable"
        );
    }

    /// Places on a regular grid must not share their jitter: its mean and its correlation between neighbours vanish.
    #[test]
    fn neighbours_are_uncorrelated() {
        let jitter = |k: i32| {
            let [x, _] =
                Strata::new(1, DVec3::new(f64::from(k) * 0.5, 0.0, 0.0), 0).points().next().expect("one");
            x - 0.5
        };
        let count = 4000;
        let mean = (0..count).map(jitter).sum::<f64>() / f64::from(count);
        let pairs = (0..count).map(|k| jitter(k) * jitter(k + 1)).sum::<f64>() / f64::from(count) * 12.0;
        // Standard errors are √(1/12/4000) = 0.0046 and √(1/4000) = 0.016; four of each.
        assert!(mean.abs() < 0.018 && pairs.abs() < 0.064, "{mean} {pairs}");
    }

    /// Moments of a density over the sphere: ∫ z over the cosine hemisphere is 2/3, over a cone the middle of its cap.
    #[test]
    fn maps_have_their_densities() {
        let axis = DVec3::new(0.6, 0.0, -0.8);
        let strata = Strata::new(64, DVec3::ZERO, 0);
        let mean = |map: &dyn Fn([f64; 2]) -> DVec3| strata.points().map(map).sum::<DVec3>() / 4096.0;
        let cosine = mean(&|point| hemisphere(axis, point));
        // A cell's spread of about 1/64 over 4096 cells: measured 1.2e-4.
        assert!((cosine - axis * 2.0 / 3.0).length() < 2e-4, "{cosine}");
        for opening in [0.1, 1.0, 2.0] {
            // Cells grow with the cone; at the back of the whole sphere they are 0.03 wide: measured 9e-4.
            let middle = mean(&|point| cone(axis, opening, point).0);
            assert!((middle - axis * (1.0 - 0.5 * opening)).length() < 2e-3, "{opening} {middle}");
            let wrong = mean(&|point| cone(axis, 0.9 * opening, point).0);
            assert!(
                (wrong - axis * (1.0 - 0.5 * opening)).length() > 2e-3,
                "a tenth narrower must be noticed"
            );
        }
        for point in strata.points() {
            let (direction, height) = cone(axis, 0.1, point);
            assert!((direction.length() - 1.0).abs() < 1e-14);
            assert!((direction.dot(axis) - (1.0 - height)).abs() < 1e-15 && height <= 0.1);
        }
    }
}
