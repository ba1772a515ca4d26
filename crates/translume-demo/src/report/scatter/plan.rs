//! How much is measured.

use super::scene::Kind;
use crate::cli::Report;
use crate::report::bench::Repeats;
use crate::report::subject;
use translume::Method;

/// Atlases, media and methods, and how many texels are looked at.
pub struct Plan {
    pub scenes: Vec<Kind>,
    /// Lit from behind.
    pub behind: Vec<Kind>,
    /// What is timed.
    pub timed: Kind,
    pub media: &'static [&'static str],
    /// Atlases compared with all pairs, with the converged integral, and timed; the same for all pairs.
    pub sizes: Vec<u32>,
    pub total_sizes: Vec<u32>,
    pub time_sizes: Vec<u32>,
    pub all_pairs_sizes: Vec<u32>,
    pub methods: Vec<Method>,
    /// Texels that all pairs and the converged integral are computed at, about.
    pub samples: usize,
    pub converged_samples: usize,
    /// Every so manieth texel instead.
    pub every: Option<usize>,
    pub repeats: Repeats,
    /// Where times alone count.
    pub times_repeats: Repeats,
}

impl Plan {
    pub fn new(arguments: &Report) -> Self {
        let names = subject::names(arguments);
        let last = names.last().cloned().unwrap_or_default();
        let first = names.first().cloned().unwrap_or_default();
        let mut scenes: Vec<_> = names.into_iter().map(Kind::Model).chain([Kind::Sheet]).collect();
        if arguments.models.is_empty() {
            scenes.extend(subject::scan("spot.obj").map(Kind::Twisted));
        }
        let (quick, atlas) = (arguments.quick, arguments.atlas);
        let sizes = |factors: &[f64]| -> Vec<u32> {
            factors.iter().map(|factor| (f64::from(atlas) * factor) as u32).collect()
        };
        let within = |tolerance| Method::Within { tolerance };
        let tree = Method::Tree { theta: 0.4 };
        let methods = if quick {
            vec![Method::default(), tree, Method::Pattern]
        } else {
            vec![within(0.003), Method::default(), within(0.03), tree, Method::Pattern]
        };
        Self {
            scenes,
            behind: vec![Kind::Slab, Kind::Behind(last)],
            timed: Kind::Model(first),
            media: if quick {
                &["skimmilk", "skin1"]
            } else {
                &["skimmilk", "marble", "skin1", "ketchup", "spectralon"]
            },
            sizes: sizes(if quick { &[1.0] } else { &[0.5, 1.0] }),
            total_sizes: sizes(if quick { &[1.0] } else { &[0.25, 0.5, 1.0] }),
            time_sizes: sizes(if quick { &[0.5, 1.0] } else { &[0.25, 0.5, 1.0, 2.0] }),
            all_pairs_sizes: sizes(if quick { &[0.5, 1.0] } else { &[0.25, 0.5] }),
            methods,
            samples: if quick { 100 } else { 320 },
            converged_samples: if quick { 30 } else { 120 },
            every: arguments.every.map(|every| every as usize),
            repeats: Repeats { warm_up: 0, timed: if quick { 1 } else { 3 } },
            times_repeats: if quick {
                Repeats { warm_up: 0, timed: 1 }
            } else {
                Repeats { warm_up: 1, timed: 5 }
            },
        }
    }

    pub fn largest(&self) -> u32 {
        self.time_sizes.iter().copied().max().unwrap_or(0)
    }

    /// Cases, for the bar.
    pub fn steps(&self) -> u64 {
        let sizes = self.sizes.len() + self.total_sizes.len();
        let cases = self.scenes.len() * sizes * self.media.len() + self.behind.len() * self.media.len();
        (cases + self.time_sizes.len()) as u64
    }

    /// From one texel that is looked at to the next, to find about so many among `texels`. Texels come in groups of four, so the
    /// number is odd.
    pub fn stride(&self, texels: usize, samples: usize) -> usize {
        self.every.unwrap_or_else(|| (texels / samples.max(1)) | 1)
    }
}
