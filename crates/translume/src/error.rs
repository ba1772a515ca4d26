//! What can go wrong, in words.

/// A limit of a device that is too low.
///
/// ```
/// use translume::{Error, MissingLimit};
///
/// let missing = vec![MissingLimit { limit: "max_storage_buffers_per_shader_stage", required: 8, actual: 4 }];
/// assert!(Error::Device { missing }.to_string().contains("max_storage_buffers_per_shader_stage ≥ 8 (it has 4)"));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MissingLimit {
    /// The limit's name in [`wgpu::Limits`].
    pub limit: &'static str,
    /// The worst value that would do.
    pub required: u64,
    /// The device's value.
    pub actual: u64,
}

fn list(missing: &[MissingLimit]) -> String {
    let name = |MissingLimit { limit, required, actual }: &MissingLimit| {
        // The only limits where less is better.
        let better = if limit.starts_with("min_") { '≤' } else { '≥' };
        format!("{limit} {better} {required} (it has {actual})")
    };
    missing.iter().map(name).collect::<Vec<_>>().join(", ")
}

/// Everything translume refuses, with the element and the remedy.
///
/// ```
/// use translume::{Error, Medium};
///
/// let error = Medium { ior: -1.0, ..Medium::JADE }.validate().unwrap_err();
/// assert!(matches!(error, Error::Medium { .. }));
/// assert!(error.to_string().starts_with("medium: "));
/// ```
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The device was created with limits below what the library needs.
    #[error(
        "translume needs {}; create the device with at least `translume::required_limits()`",
        list(missing)
    )]
    Device {
        /// All of them.
        missing: Vec<MissingLimit>,
    },
    /// Bodies would take more memory than [`Config::memory`](crate::Config::memory) allows.
    #[error(
        "the body needs {required} bytes of GPU memory, but {available} of the {budget} allowed are left; \
         take a smaller atlas, smaller depth maps or shared scratch memory, trim bodies that stand still, or allow more"
    )]
    Memory {
        /// Bytes of this body.
        required: u64,
        /// Bytes that others leave.
        available: u64,
        /// Bytes for all.
        budget: u64,
    },
    /// The device was created with a limit below what is needed.
    #[error("{what} needs {limit} ≥ {required}, but the device has {actual}; {remedy}")]
    Limit {
        /// What needs it.
        what: String,
        /// The limit's name in [`wgpu::Limits`].
        limit: &'static str,
        /// The least value that would do.
        required: u64,
        /// The device's value.
        actual: u64,
        /// What to change.
        remedy: &'static str,
    },
    /// A medium's coefficient cannot be.
    #[error("medium: {field} is {value}, but must be {range}")]
    Medium {
        /// Which coefficient and channel.
        field: &'static str,
        /// Its value.
        value: f32,
        /// What it may be.
        range: &'static str,
    },
    /// No preset has this name.
    #[error("no medium is called \"{name}\"; known are {known}")]
    UnknownMedium {
        /// The name asked for.
        name: String,
        /// All names.
        known: String,
    },
    /// No profile has this name.
    #[error("no profile is called \"{name}\"; known are {known}")]
    UnknownProfile {
        /// The name asked for.
        name: String,
        /// All names.
        known: String,
    },
    /// A parameter of a profile cannot be.
    #[error("profile: {problem}; {remedy}")]
    Profile {
        /// What is wrong, naming the entry.
        problem: String,
        /// What to do about it.
        remedy: &'static str,
    },
    /// Mesh and atlas do not belong together, or hold numbers that cannot be.
    #[error("{mesh}: {problem}; {remedy}")]
    Body {
        /// The mesh's name.
        mesh: String,
        /// What is wrong, naming the element.
        problem: String,
        /// What to do about it.
        remedy: &'static str,
    },
    /// A number of [`ShadowOptions`](crate::ShadowOptions) cannot be.
    #[error("shadows: {field} is {value}, but must be {range}")]
    Shadow {
        /// Which number.
        field: &'static str,
        /// Its value.
        value: u32,
        /// What it may be.
        range: String,
    },
    /// A map of the environment cannot be.
    #[error("environment map: {problem}; {remedy}")]
    Environment {
        /// What is wrong, naming the pixel.
        problem: String,
        /// What to do about it.
        remedy: &'static str,
    },
    /// An input of a frame cannot be.
    #[error("frame: {problem}; {remedy}")]
    Frame {
        /// What is wrong, naming the element.
        problem: String,
        /// What to do about it.
        remedy: &'static str,
    },
    /// Reading back from the GPU failed.
    #[error("reading back from the GPU failed: {0}; the device may be lost")]
    ReadBack(String),
}
