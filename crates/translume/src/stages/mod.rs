//! One stage of the way of the data each: bindings, sizes and dispatch. The WGSL of a stage has the stage's name.

pub(crate) mod cluster;
pub(crate) mod composite;
pub(crate) mod deform;
pub(crate) mod gather;
pub(crate) mod resolve;
pub(crate) mod scatter;
pub(crate) mod shadow;
pub(crate) mod transport;
pub(crate) mod visibility;

use crate::kernel_texture::KernelTables;
use crate::memory::Ledger;
use crate::scratch::Scratch;
use std::sync::{Arc, OnceLock};

/// A stage of a frame.
///
/// ```
/// use translume::Stage;
///
/// let names: Vec<_> = Stage::ALL.iter().map(|stage| stage.name()).collect();
/// assert_eq!(names, ["deform", "visibility", "shadow", "gather", "cluster", "scatter", "resolve"]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Stage {
    /// Rest pose → positions and normals.
    Deform,
    /// Depth along directions of the sky → what every texel sees of it. Only where a light of the sky is shadowed.
    Visibility,
    /// Depth maps of shadowed lights.
    Shadow,
    /// Lights → irradiance per texel.
    Gather,
    /// Texels → tree of clusters.
    Cluster,
    /// Irradiance → radiant exitance.
    Scatter,
    /// Dense texels → texture.
    Resolve,
}

impl Stage {
    /// Every stage, in the order light flows.
    pub const ALL: [Self; 7] = [
        Self::Deform,
        Self::Visibility,
        Self::Shadow,
        Self::Gather,
        Self::Cluster,
        Self::Scatter,
        Self::Resolve,
    ];

    /// The name of the stage's file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Deform => "deform",
            Self::Visibility => "visibility",
            Self::Shadow => "shadow",
            Self::Gather => "gather",
            Self::Cluster => "cluster",
            Self::Scatter => "scatter",
            Self::Resolve => "resolve",
        }
    }
}

/// A set of stages.
///
/// ```
/// use translume::{Stage, StageSet};
///
/// let lit = StageSet::from_stage_on(Stage::Gather);
/// assert!(lit.contains(Stage::Scatter) && !lit.contains(Stage::Deform));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StageSet(u8);

impl StageSet {
    /// A stage and everything that reads what it writes.
    #[must_use]
    pub fn from_stage_on(first: Stage) -> Self {
        Self(
            Stage::ALL
                .into_iter()
                .filter(|stage| *stage as u8 >= first as u8)
                .fold(0, |set, stage| set | 1 << stage as u8),
        )
    }

    /// Whether the stage is in the set.
    #[must_use]
    pub fn contains(self, stage: Stage) -> bool {
        self.0 & (1 << stage as u8) != 0
    }

    /// Whether no stage is in the set.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    pub(crate) fn len(self) -> u32 {
        self.0.count_ones()
    }

    pub(crate) fn set(&mut self, stage: Stage, member: bool) {
        self.0 = self.0 & !(1 << stage as u8) | u8::from(member) << stage as u8;
    }

    /// Takes out the stages up to and including `last`.
    pub(crate) fn take_through(&mut self, last: Stage) -> Self {
        let later = Self::from_stage_on(last).0 & !(1 << last as u8);
        let taken = Self(self.0 & !later);
        self.0 &= later;
        taken
    }

    pub(crate) fn insert(&mut self, other: Self) {
        self.0 |= other.0;
    }
}

/// The pipelines of every stage that a frame records, and what bodies share.
pub(crate) struct Stages {
    pub deform: deform::Deform,
    pub visibility: visibility::Visibility,
    pub shadow: shadow::Shadow,
    pub gather: gather::Gather,
    pub cluster: cluster::ClusterStage,
    pub scatter: scatter::Scatter,
    /// Made for the first body that needs it.
    pub transport: OnceLock<transport::TransportStage>,
    pub resolve: resolve::Resolve,
    pub scratch: Scratch,
    pub kernel_tables: KernelTables,
}

impl Stages {
    pub fn new(device: &wgpu::Device, ledger: &Arc<Ledger>) -> Self {
        Self {
            deform: deform::Deform::new(device),
            visibility: visibility::Visibility::new(device),
            shadow: shadow::Shadow::new(device),
            gather: gather::Gather::new(device),
            cluster: cluster::ClusterStage::new(device),
            scatter: scatter::Scatter::new(device),
            transport: OnceLock::new(),
            resolve: resolve::Resolve::new(device),
            scratch: Scratch::new(device, ledger),
            kernel_tables: KernelTables::default(),
        }
    }
}
