//! The value of a channel at a moment.
//!
//! Source: Khronos, glTF 2.0 specification, appendix C.

use glam::DQuat;

use super::{Channel, Interpolation};

/// Cosine above which two rotations are so close that a straight line between them is an arc: the error is below
/// 1e-9 of the angle.
const STRAIGHT: f64 = 1.0 - 1e-9;

/// Where a moment lies among the keys: at or after `key`, a share `t` of the way to `next`.
#[derive(Clone, Copy)]
pub(super) struct Moment {
    key: usize,
    next: usize,
    t: f64,
    /// Seconds from `key` to `next`.
    duration: f64,
}

impl Channel {
    /// Before the first key and after the last, the moment is that key; no number counts as before the first.
    pub(super) fn moment(&self, seconds: f32) -> Option<Moment> {
        let last = self.times.len().checked_sub(1)?;
        let later = self.times.partition_point(|&time| time <= seconds);
        let key = later.saturating_sub(1);
        let next = later.min(last);
        let [from, to] = [key, next].map(|k| f64::from(self.times[k]));
        let duration = to - from;
        let t = if later == 0 || duration <= 0.0 { 0.0 } else { (f64::from(seconds) - from) / duration };
        Some(Moment { key, next, t, duration })
    }

    /// Component `k` of values that have `width` of them; `None` where the channel holds too few numbers.
    pub(super) fn component(&self, at: Moment, width: usize, k: usize) -> Option<f64> {
        let Moment { key, next, t, duration } = at;
        match self.interpolation {
            Interpolation::Step => self.stored(key, 1, 0, width, k),
            Interpolation::Linear => {
                let [from, to] = [self.stored(key, 1, 0, width, k)?, self.stored(next, 1, 0, width, k)?];
                Some((1.0 - t) * from + t * to)
            }
            Interpolation::CubicSpline => {
                let [from, out_tangent] =
                    [self.stored(key, 3, 1, width, k)?, self.stored(key, 3, 2, width, k)?];
                let [to, in_tangent] =
                    [self.stored(next, 3, 1, width, k)?, self.stored(next, 3, 0, width, k)?];
                let (t2, t3) = (t * t, t * t * t);
                Some(
                    (2.0 * t3 - 3.0 * t2 + 1.0) * from
                        + duration * (t3 - 2.0 * t2 + t) * out_tangent
                        + (3.0 * t2 - 2.0 * t3) * to
                        + duration * (t3 - t2) * in_tangent,
                )
            }
        }
    }

    /// Three numbers.
    pub(super) fn vector(&self, seconds: f32) -> Option<[f32; 3]> {
        let at = self.moment(seconds)?;
        let mut vector = [0.0; 3];
        for (k, number) in vector.iter_mut().enumerate() {
            *number = self.component(at, 3, k)? as f32;
        }
        Some(vector)
    }

    /// A unit quaternion, x, y, z, w.
    pub(super) fn rotation(&self, seconds: f32) -> Option<[f32; 4]> {
        let at = self.moment(seconds)?;
        let rotation = match self.interpolation {
            Interpolation::Linear => slerp(self.key_rotation(at.key)?, self.key_rotation(at.next)?, at.t),
            Interpolation::Step | Interpolation::CubicSpline => {
                let mut numbers = [0.0; 4];
                for (k, number) in numbers.iter_mut().enumerate() {
                    *number = self.component(at, 4, k)?;
                }
                unit(numbers)
            }
        };
        Some(rotation.as_quat().to_array())
    }

    fn key_rotation(&self, key: usize) -> Option<DQuat> {
        let mut numbers = [0.0; 4];
        for (k, number) in numbers.iter_mut().enumerate() {
            *number = self.stored(key, 1, 0, 4, k)?;
        }
        Some(unit(numbers))
    }

    /// One number: component `k` of the given one of the `parts` (tangents and value) of a key.
    fn stored(&self, key: usize, parts: usize, part: usize, width: usize, k: usize) -> Option<f64> {
        self.values.get((key * parts + part) * width + k).copied().map(f64::from)
    }
}

/// Unit quaternion along the given one; no rotation for one without a direction.
pub(crate) fn unit(quaternion: [f64; 4]) -> DQuat {
    let [x, y, z, w] = quaternion;
    // Divided by the largest number first, so that the squares of tiny and huge ones neither vanish nor overflow.
    let largest = x.abs().max(y.abs()).max(z.abs()).max(w.abs());
    if !(largest > 0.0 && largest.is_finite()) {
        return DQuat::IDENTITY;
    }
    DQuat::from_xyzw(x / largest, y / largest, z / largest, w / largest).normalize()
}

/// Along the shorter arc, at even speed.
fn slerp(from: DQuat, to: DQuat, t: f64) -> DQuat {
    let cosine = from.dot(to);
    let to = if cosine < 0.0 { -to } else { to };
    let cosine = cosine.abs();
    if cosine > STRAIGHT {
        return (from * (1.0 - t) + to * t).normalize();
    }
    let angle = cosine.acos();
    (from * (angle * (1.0 - t)).sin() + to * (angle * t).sin()).normalize()
}
