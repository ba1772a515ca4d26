//! What can go wrong, in words.

/// Everything the rivals refuse, with the element and the remedy.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A number of a method or of its picture cannot be.
    #[error("rival: {field} is {value}, but must be {range}")]
    Setting {
        /// Which number.
        field: &'static str,
        /// Its value.
        value: u64,
        /// What it may be.
        range: String,
    },
    /// A light that the method cannot show.
    #[error("rival: light {index} {problem}; {remedy}")]
    Light {
        /// Its place among the frame's lights.
        index: usize,
        /// What is wrong.
        problem: &'static str,
        /// What to do about it.
        remedy: &'static str,
    },
    /// The frame's camera, bounds or number of lights cannot be.
    #[error("rival: {problem}; {remedy}")]
    Frame {
        /// What is wrong.
        problem: String,
        /// What to do about it.
        remedy: &'static str,
    },
    /// The mesh cannot be.
    #[error("rival: the mesh {problem}; {remedy}")]
    Mesh {
        /// What is wrong, naming the element.
        problem: String,
        /// What to do about it.
        remedy: &'static str,
    },
    /// The medium's coefficients cannot be.
    #[error(transparent)]
    Medium(#[from] translume::Error),
}
