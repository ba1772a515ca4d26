//! Who runs: a method, its settings, and where it stands in a plot.

use translume::{Evaluate, Method, Profile};
use translume_rivals::{Rival, ScreenSpace, TranslucentShadowMap};

/// Methods of one kind, drawn as one line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Family {
    Dual,
    PerVertex,
    PerFragment,
    Tree,
    AllPairs,
    Pattern,
    ShadowMap,
    ScreenSpace,
}

impl Family {
    pub const ALL: [Self; 8] = [
        Self::Dual,
        Self::PerVertex,
        Self::PerFragment,
        Self::Tree,
        Self::AllPairs,
        Self::Pattern,
        Self::ShadowMap,
        Self::ScreenSpace,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Dual => "dual tree",
            Self::PerVertex => "dual tree per vertex",
            Self::PerFragment => "dual tree per fragment",
            Self::Tree => "one-sided tree",
            Self::AllPairs => "all pairs",
            Self::Pattern => "the paper's pattern",
            Self::ShadowMap => "translucent shadow maps",
            Self::ScreenSpace => "screen-space diffusion",
        }
    }

    /// Whether it is the library's recommended way, wherever it is evaluated.
    pub fn is_dual(self) -> bool {
        matches!(self, Self::Dual | Self::PerVertex | Self::PerFragment)
    }
}

/// How a picture is made.
#[derive(Clone, Debug, PartialEq)]
pub enum Way {
    Ours { atlas: u32, method: Method, evaluate: Evaluate, profile: &'static str },
    Rival(Rival),
}

/// One way with one setting.
#[derive(Clone, Debug, PartialEq)]
pub struct Entrant {
    pub family: Family,
    /// As in tables.
    pub setting: String,
    /// The profile whose integral it approximates.
    pub profile: &'static str,
    pub way: Way,
}

impl Entrant {
    /// Whether a frame takes seconds.
    pub fn is_slow(&self) -> bool {
        self.family == Family::AllPairs
    }
}

/// The profile that Dachsbacher and Stamminger sum, and the paper's.
const DIPOLE: &str = "dipole-normalised";
/// The profile of screen-space diffusion.
const BURLEY: &str = "normalised-diffusion";

/// The name of the profile that a body has unless told otherwise.
pub fn default_profile() -> &'static str {
    let default = Profile::default();
    Profile::NAMES.iter().find(|(_, profile)| *profile == default).map_or("", |(name, _)| *name)
}

/// All that run, cheap ones first.
pub fn all(quick: bool) -> Vec<Entrant> {
    let mut all = Vec::new();
    let sizes: &[u32] = if quick { &[128, 256] } else { &[64, 128, 256, 512] };
    let tolerances: &[f32] = if quick { &[0.01] } else { &[0.1, 0.03, 0.01, 0.003] };
    for &atlas in sizes {
        // A coarse atlas hides a fine sum, and a fine one is wasted on a coarse sum.
        let fits =
            |tolerance: &&f32| !(atlas == 64 && **tolerance < 0.01 || atlas == 512 && **tolerance > 0.03);
        for &tolerance in tolerances.iter().filter(fits) {
            all.push(dual(atlas, tolerance, Evaluate::PerTexel, Family::Dual));
        }
    }
    for (evaluate, family) in
        [(Evaluate::PerVertex, Family::PerVertex), (Evaluate::PerFragment, Family::PerFragment)]
    {
        all.extend(sizes[1..].iter().take(2).map(|&atlas| dual(atlas, 0.01, evaluate, family)));
    }
    let thetas: &[f32] = if quick { &[0.4] } else { &[0.8, 0.4] };
    // At 512² a frame takes seconds.
    for &atlas in sizes.iter().filter(|&&atlas| atlas <= 256) {
        for &theta in thetas {
            let setting = format!("{atlas}², θ {theta}");
            all.push(ours(Family::Tree, setting, atlas, Method::Tree { theta }, Evaluate::PerTexel));
        }
    }
    // The square of the texels: at 256² a frame takes half a minute of a processor.
    for &atlas in sizes.iter().filter(|&&atlas| atlas < 256) {
        all.push(ours(Family::AllPairs, format!("{atlas}²"), atlas, Method::AllPairs, Evaluate::PerTexel));
    }
    for &atlas in sizes {
        let setting = format!("{atlas}²");
        // With the paper's own profile: single samples of one without a bound at r = 0 would be its ruin.
        all.push(Entrant {
            profile: DIPOLE,
            way: Way::Ours { atlas, method: Method::Pattern, evaluate: Evaluate::PerTexel, profile: DIPOLE },
            ..ours(Family::Pattern, setting, atlas, Method::Pattern, Evaluate::PerTexel)
        });
    }
    all.extend(rivals(quick));
    all
}

/// The default with other profiles: the same picture by another model.
pub fn profiles() -> Vec<Entrant> {
    let asked = |name: &&'static str| !matches!(*name, "dipole" | "dipole-oriented");
    let names = Profile::NAMES.iter().map(|(name, _)| *name).filter(asked);
    names
        .map(|profile| Entrant {
            family: Family::Dual,
            setting: format!("512², 1 %, {profile}"),
            profile,
            way: Way::Ours {
                atlas: 512,
                method: Method::Within { tolerance: 0.01 },
                evaluate: Evaluate::PerTexel,
                profile,
            },
        })
        .collect()
}

fn dual(atlas: u32, tolerance: f32, evaluate: Evaluate, family: Family) -> Entrant {
    let setting = format!("{atlas}², {} %", (1e4 * tolerance).round() / 100.0);
    ours(family, setting, atlas, Method::Within { tolerance }, evaluate)
}

fn ours(family: Family, setting: String, atlas: u32, method: Method, evaluate: Evaluate) -> Entrant {
    let profile = default_profile();
    Entrant { family, setting, profile, way: Way::Ours { atlas, method, evaluate, profile } }
}

fn rivals(quick: bool) -> Vec<Entrant> {
    // The paper's 21 samples, fewer and more of them, on smaller and larger maps.
    let maps: &[(u32, u32, u32)] = if quick {
        &[(4, 5, 256)]
    } else {
        &[(2, 5, 128), (4, 5, 256), (4, 5, 512), (8, 8, 512), (16, 16, 1024)]
    };
    let samples: &[u32] = if quick { &[55] } else { &[11, 55, 200] };
    let shadow_maps = maps.iter().map(|&(rings, spokes, map)| {
        let rival = TranslucentShadowMap { rings, spokes, map, ..Default::default() };
        Entrant {
            family: Family::ShadowMap,
            setting: format!("{} samples, map {map}²", rival.samples()),
            profile: DIPOLE,
            way: Way::Rival(Rival::TranslucentShadowMap(rival)),
        }
    });
    let screens = samples.iter().map(|&samples| {
        let rival = ScreenSpace { samples, ..Default::default() };
        Entrant {
            family: Family::ScreenSpace,
            setting: format!("{samples} samples"),
            profile: BURLEY,
            way: Way::Rival(Rival::ScreenSpace(rival)),
        }
    });
    shadow_maps.chain(screens).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everybody_runs_and_nobody_twice() {
        for quick in [false, true] {
            let all = all(quick);
            for family in Family::ALL {
                assert!(all.iter().any(|entrant| entrant.family == family), "{}", family.name());
            }
            for (k, entrant) in all.iter().enumerate() {
                let again =
                    |other: &&Entrant| other.family == entrant.family && other.setting == entrant.setting;
                assert_eq!(all.iter().filter(again).count(), 1, "{k}: {}", entrant.setting);
            }
        }
        assert!(!default_profile().is_empty());
        assert!(profiles().iter().any(|entrant| entrant.profile == BURLEY));
        assert!(profiles().iter().any(|entrant| entrant.profile == DIPOLE));
    }
}
