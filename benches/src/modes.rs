//! The ways to evaluate the scatter sum.

use translume::{BodyDescriptor, Evaluate, Method};

/// From what to what light is scattered, by the names of Gong et al. 2008. A new one is a line in [`MODES`].
pub struct Mode {
    /// The paper's abbreviation.
    pub name: &'static str,
    /// What of a body makes it so.
    pub describe: fn(&mut BodyDescriptor<'_>),
}

/// Every mode that whole frames are measured in.
pub const MODES: &[Mode] = &[
    Mode { name: "TTF", describe: |_| () },
    Mode { name: "VTF", describe: |body| body.evaluate = Evaluate::PerVertex },
    Mode { name: "FTF", describe: |body| body.evaluate = Evaluate::PerFragment },
];

/// The methods of the scatter stage that suit the large atlas. [`Method::AllPairs`] takes minutes there.
pub const METHODS: &[(&str, Method)] =
    &[("dual, 1 %", Method::Within { tolerance: 0.01 }), ("tree 0.4", Method::Tree { theta: 0.4 })];
