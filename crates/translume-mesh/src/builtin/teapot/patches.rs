//! The control points of Newell's teapot, in his units, z up.
//!
//! Published facts: Martin Newell, University of Utah, 1975; the shortened height is the one everybody knows.

/// Quarter-turn profiles of the surfaces of revolution, seen along the way from the top to the bottom. Each point is
/// (radius, Newell's control distance beside it ≈ 0.56 radius, height).
pub const RIM: [[f64; 3]; 4] =
    [[1.4, 0.784, 2.4], [1.3375, 0.749, 2.53125], [1.4375, 0.805, 2.53125], [1.5, 0.84, 2.4]];
pub const UPPER_BODY: [[f64; 3]; 4] =
    [[1.5, 0.84, 2.4], [1.75, 0.98, 1.875], [2.0, 1.12, 1.35], [2.0, 1.12, 0.9]];
pub const LOWER_BODY: [[f64; 3]; 4] =
    [[2.0, 1.12, 0.9], [2.0, 1.12, 0.45], [1.5, 0.84, 0.225], [1.5, 0.84, 0.15]];
pub const BOTTOM: [[f64; 3]; 4] =
    [[1.5, 0.84, 0.15], [1.5, 0.84, 0.075], [1.425, 0.798, 0.0], [0.0, 0.0, 0.0]];
pub const KNOB: [[f64; 3]; 4] = [[0.0, 0.0, 3.15], [0.8, 0.45, 3.15], [0.0, 0.0, 2.85], [0.2, 0.112, 2.7]];
pub const LID: [[f64; 3]; 4] = [[0.2, 0.112, 2.7], [0.4, 0.224, 2.55], [1.3, 0.728, 2.55], [1.3, 0.728, 2.4]];

/// Half cross-sections of a tube that is symmetric in y: the four points run from y = 0 through the given −y back to
/// y = 0, as (x of the first two, z of the first two, x of the last two, z of the last two, −y of the middle two).
pub type HalfTube = [[f64; 5]; 4];

pub const UPPER_HANDLE: HalfTube = [
    [-1.6, 2.025, -1.5, 2.25, 0.3],
    [-2.3, 2.025, -2.5, 2.25, 0.3],
    [-2.7, 2.025, -3.0, 2.25, 0.3],
    [-2.7, 1.8, -3.0, 1.8, 0.3],
];
/// Its last section starts on the body's wall, (−2, 0.9).
pub const LOWER_HANDLE: HalfTube = [
    [-2.7, 1.8, -3.0, 1.8, 0.3],
    [-2.7, 1.575, -3.0, 1.35, 0.3],
    [-2.5, 1.125, -2.65, 0.9375, 0.3],
    [-2.0, 0.9, -1.9, 0.6, 0.3],
];
pub const LOWER_SPOUT: HalfTube = [
    [1.7, 1.425, 1.7, 0.6, 0.66],
    [2.6, 1.425, 3.1, 0.825, 0.66],
    [2.3, 2.1, 2.4, 2.025, 0.25],
    [2.7, 2.4, 3.3, 2.4, 0.25],
];
pub const UPPER_SPOUT: HalfTube = [
    [2.7, 2.4, 3.3, 2.4, 0.25],
    [2.8, 2.475, 3.525, 2.49375, 0.25],
    [2.9, 2.475, 3.45, 2.5125, 0.15],
    [2.8, 2.4, 3.2, 2.4, 0.15],
];
