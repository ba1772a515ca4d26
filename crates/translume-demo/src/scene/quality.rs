//! How a scene is computed, and how its picture is developed.

use crate::error::Error;
use crate::profile;
use serde::{Deserialize, Serialize};
use std::path::Path;
use translume::{Evaluate, Gloss, Method, Profile, ShadowOptions, Transport};
use translume_mesh::{AtlasOptions, ChartSource};

/// Everything that trades error for time. The names are those of the command line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Quality {
    /// auto, classic, boundary or layers.
    pub transport: String,
    /// By name, or the name of a table's .json. Of classic transport.
    pub profile: String,
    /// dual, tree, all-pairs or pattern.
    pub method: String,
    /// Of dual, 0.0001 to 0.1; by default 0.01.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f32>,
    /// Of tree, or of dual in place of a tolerance; 0.05 to 2.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub theta: Option<f32>,
    /// texel, vertex, fragment or auto.
    pub evaluate: String,
    /// Width of the atlas in texels.
    pub atlas: u32,
    /// unwrap, own or auto.
    pub charts: String,
    /// Whether charts are evened out.
    pub even: bool,
    /// Thickness below which texels are finer, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub finer_below: Option<f32>,
    /// Width of a shadow map in texels.
    pub shadow: u32,
    /// Directions in which the body's shadow on the sky is known.
    pub directions: u32,
}

impl Default for Quality {
    fn default() -> Self {
        Self {
            transport: Transport::default().name().to_owned(),
            profile: "half-space".to_owned(),
            method: "dual".to_owned(),
            tolerance: None,
            theta: None,
            evaluate: "texel".to_owned(),
            atlas: 512,
            charts: "unwrap".to_owned(),
            even: false,
            finer_below: None,
            shadow: 2048,
            directions: 256,
        }
    }
}

/// How the picture is developed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Look {
    /// Roughness of the surface's own reflection, 0.03 to 1; 0 for none.
    pub gloss: f32,
    /// Stops.
    pub exposure: f32,
}

/// The tolerance of dual where none is given.
pub const TOLERANCE: f32 = 0.01;
/// The opening angle of tree where none is given.
pub const THETA: f32 = 0.4;

impl Quality {
    pub const METHODS: [&'static str; 4] = ["dual", "tree", "all-pairs", "pattern"];
    pub const CHARTS: [&'static str; 3] = ["unwrap", "own", "auto"];

    /// The profile, a table's file taken relative to `directory`.
    pub fn profile(&self, directory: &Path) -> Result<Profile, Error> {
        profile::open(&self.profile, directory)
    }

    /// How light goes through the body. Only dual solves for its boundary, and only at texels.
    pub fn transport(&self) -> Result<Transport, Error> {
        let fail = |problem| Err(Error::Option { option: "--transport", problem });
        let name = self.transport.as_str();
        let Ok(transport) = name.parse::<Transport>() else {
            let known = Transport::ALL.map(Transport::name).join(", ");
            return fail(format!("\"{name}\" is no transport; known are {known}"));
        };
        let is_solved = !matches!(transport, Transport::Auto | Transport::Classic);
        if is_solved && self.method != "dual" {
            return fail(format!("{name} is not summed up by {}; use dual", self.method));
        }
        if is_solved && matches!(self.evaluate.as_str(), "vertex" | "fragment") {
            return fail(format!("{name} is evaluated per texel, not per {}", self.evaluate));
        }
        Ok(transport)
    }

    pub fn method(&self) -> Result<Method, Error> {
        let name = self.method.as_str();
        let fail = |option, problem| Err(Error::Option { option, problem });
        if self.tolerance.is_some() && name != "dual" {
            return fail("--tolerance", format!("{name} has none; only dual keeps a tolerance"));
        }
        if self.theta.is_some() && !matches!(name, "dual" | "tree") {
            return fail("--theta", format!("{name} has no opening angle; dual and tree have"));
        }
        let tolerance = self.tolerance.unwrap_or(TOLERANCE);
        if !(0.0001..=0.1).contains(&tolerance) {
            return fail("--tolerance", format!("{tolerance} is not between 0.0001 and 0.1"));
        }
        if let Some(theta) = self.theta.filter(|theta| !(0.05..=2.0).contains(theta)) {
            return fail("--theta", format!("{theta} is not between 0.05 and 2"));
        }
        match (name, self.theta) {
            ("dual", None) => Ok(Method::Within { tolerance }),
            ("dual", Some(theta)) => Ok(Method::Dual { theta }),
            ("tree", theta) => Ok(Method::Tree { theta: theta.unwrap_or(THETA) }),
            ("all-pairs", _) => Ok(Method::AllPairs),
            ("pattern", _) => Ok(Method::Pattern),
            (other, _) => fail(
                "--method",
                format!("no method is called \"{other}\"; known are {}", Self::METHODS.join(", ")),
            ),
        }
    }

    pub fn evaluate(&self) -> Result<Evaluate, Error> {
        let name = self.evaluate.as_str();
        let fail = |problem| Err(Error::Option { option: "--evaluate", problem });
        match Evaluate::NAMES.iter().find(|(known, _)| *known == name) {
            None => fail(format!("\"{name}\" is no place; known are texel, vertex, fragment, auto")),
            Some((_, Evaluate::PerVertex | Evaluate::PerFragment)) if self.method != "dual" => {
                fail(format!("{} is evaluated at texels alone; use dual", self.method))
            }
            Some((_, evaluate)) => Ok(*evaluate),
        }
    }

    /// For a model of so many millimetres a unit.
    pub fn atlas(&self, mm_per_unit: f32) -> Result<AtlasOptions, Error> {
        let charts = match self.charts.as_str() {
            "unwrap" => ChartSource::Unwrap,
            "own" => ChartSource::Own,
            "auto" => ChartSource::OwnOrUnwrap,
            other => {
                let known = Self::CHARTS.join(", ");
                let problem = format!("no source of charts is called \"{other}\"; known are {known}");
                return Err(Error::Option { option: "--charts", problem });
            }
        };
        if let Some(below) = self.finer_below.filter(|below| !(*below > 0.0 && below.is_finite())) {
            let problem = format!("{below} mm is no thickness; give one above 0");
            return Err(Error::Option { option: "--finer-below", problem });
        }
        Ok(AtlasOptions {
            size: self.atlas,
            charts,
            equiareal: self.even,
            finer_below: self.finer_below.map(|mm| mm / mm_per_unit),
            ..Default::default()
        })
    }

    pub fn shadows(&self) -> ShadowOptions {
        ShadowOptions { resolution: self.shadow, directions: self.directions, ..Default::default() }
    }
}

impl Look {
    pub fn gloss(&self) -> Result<Gloss, Error> {
        match self.gloss {
            0.0 => Ok(Gloss::None),
            roughness if (0.03..=1.0).contains(&roughness) => Ok(Gloss::Rough(roughness)),
            other => Err(Error::Option {
                option: "--gloss",
                problem: format!("{other} is neither 0 nor between 0.03 and 1"),
            }),
        }
    }
}
