//! The ways from a scene to its exitance.

use super::scene::Scene;
use std::collections::HashMap;
use std::f64::consts::PI;
use std::sync::{Arc, Mutex, OnceLock};
use translume::{Entry, Evaluate, Frame, Medium, Method, Profile, View, readback};
use translume_reference::converged::Converged;
use translume_reference::path::{Ball, PathTracer, Volume};
use translume_reference::profile::{self, Channel, Profile as _};
use translume_reference::scatter;
use translume_tests::{Fixture, Model, Shot, dipoles, gpu, light, luminous, profiles};
use translume_twin::medium as twin;

/// How exitance is computed.
#[derive(Clone, Debug, PartialEq)]
pub enum Way {
    /// At every texel, with the dipole.
    Method(&'static str, Method),
    /// At every texel by the dual scatter, with one of `Profile::NAMES`.
    Profile(&'static str, Profile),
    /// At vertices or fragments, with the dipole.
    Points(Evaluate),
    /// The reference's own gather and sum, with the dipole, at some texels.
    Pairs,
    /// The reference's integral over the triangles, with the dipole, at fewer.
    Converged,
    /// The reference's path tracer: mean radiance times π of an exact ball under the sky.
    Paths,
}

/// A column of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    Methods,
    Profiles,
    Points,
    Cpu,
}

impl Column {
    pub const ALL: [Self; 4] = [Self::Methods, Self::Profiles, Self::Points, Self::Cpu];
}

/// What entered and what left.
#[derive(Clone, Debug, Default)]
pub struct Glow {
    /// Irradiance of every texel.
    pub entering: Vec<[f64; 3]>,
    /// Exitance of each receiver.
    pub leaving: Vec<[f64; 3]>,
    /// Where the receivers are, mm; empty for fragments.
    pub places: Vec<[f64; 3]>,
    /// Area of each receiver, mm², where the receivers are all the texels; else empty.
    pub areas: Vec<f64>,
}

/// The bodies of a row: ways with the same profile share the kernel table, which takes longer to make than a frame.
#[derive(Default)]
pub struct Bodies(Vec<(Arc<Model>, Medium, f32, Profile, Fixture)>);

impl Bodies {
    fn of(&mut self, scene: &Scene, profile: &Profile) -> &mut Fixture {
        let Scene { model, medium, mm_per_unit, .. } = scene;
        let known = self.0.iter().position(|(m, medium_of, mm, profile_of, _)| {
            Arc::ptr_eq(m, model) && (medium_of, mm, profile_of) == (medium, mm_per_unit, profile)
        });
        let index = known.unwrap_or_else(|| {
            let fixture = Fixture::new(model, |d| {
                (d.medium, d.mm_per_unit, d.profile) = (*medium, *mm_per_unit, profile.clone());
                (d.shadows.resolution, d.shadows.direction_resolution) = (64, 32);
            });
            self.0.push((Arc::clone(model), *medium, *mm_per_unit, profile.clone(), fixture));
            self.0.len() - 1
        });
        &mut self.0[index].4
    }
}

impl Way {
    pub fn all() -> Vec<Self> {
        let methods = [
            ("all pairs", Method::AllPairs),
            ("tree", Method::Tree { theta: 0.4 }),
            ("dual", Method::default()),
            ("pattern", Method::Pattern),
        ];
        let profiles = Profile::NAMES.iter().map(|(name, profile)| Self::Profile(name, profile.clone()));
        let points = [Evaluate::PerVertex, Evaluate::PerFragment].map(Self::Points);
        let methods = methods.into_iter().map(|(name, method)| Self::Method(name, method));
        methods.chain(points).chain(profiles).chain([Self::Pairs, Self::Converged, Self::Paths]).collect()
    }

    /// As [`all`](Self::all) with the default profile and the one whose sources lie off the surface, where the case is not one of the medium.
    pub fn few() -> Vec<Self> {
        let kinds = ["half-space", "dipole-oriented"];
        let kept = |way: &Self| !matches!(way, Self::Profile(name, _) if !kinds.contains(name));
        Self::all().into_iter().filter(kept).collect()
    }

    pub fn name(&self) -> &'static str {
        match self {
            Self::Method(name, _) | Self::Profile(name, _) => name,
            Self::Points(Evaluate::PerVertex) => "per vertex",
            Self::Points(_) => "per fragment",
            Self::Pairs => "CPU all pairs",
            Self::Converged => "converged",
            Self::Paths => "paths",
        }
    }

    pub fn column(&self) -> Column {
        match self {
            Self::Method(..) => Column::Methods,
            Self::Profile(..) => Column::Profiles,
            Self::Points(_) => Column::Points,
            Self::Pairs | Self::Converged | Self::Paths => Column::Cpu,
        }
    }

    pub fn profile(&self) -> Profile {
        match self {
            Self::Profile(_, profile) => profile.clone(),
            _ => Profile::DipoleNormalised,
        }
    }

    pub fn is_pattern(&self) -> bool {
        matches!(self, Self::Method(_, Method::Pattern))
    }

    /// Whether its profile has no bound at r = 0. Where discs of texels overlap, what it sends from the middle of one counts.
    pub fn is_peaked(&self) -> bool {
        let smooth = ["dipole", "dipole-normalised", "dipole-oriented", "better-dipole"];
        matches!(self, Self::Profile(name, _) if !smooth.contains(name))
    }

    /// Whether its sources lie off the surface.
    pub fn is_oriented(&self) -> bool {
        matches!(self, Self::Profile(_, Profile::DipoleOriented))
    }

    /// Whether it can compute a scene.
    pub fn knows(&self, scene: &Scene) -> bool {
        *self != Self::Paths || scene.round
    }

    /// Computes a scene.
    pub fn glow(&self, scene: &Scene, bodies: &mut Bodies) -> Glow {
        match self {
            Self::Paths => paths(scene),
            Self::Pairs => pairs(bodies.of(scene, &self.profile()), scene),
            Self::Converged => converged(bodies.of(scene, &self.profile()), scene),
            _ => self.on_gpu(bodies.of(scene, &self.profile()), scene),
        }
    }

    fn on_gpu(&self, fixture: &mut Fixture, scene: &Scene) -> Glow {
        let (method, place) = match self {
            Self::Method(_, method) => (*method, Evaluate::PerTexel),
            Self::Points(place) => (Method::default(), *place),
            _ => (Method::default(), Evaluate::PerTexel),
        };
        // Not all methods know all places: by way of what all know.
        fixture.body.set_evaluate(Evaluate::PerTexel).unwrap();
        fixture.body.set_method(method).unwrap();
        fixture.body.set_evaluate(place).unwrap();
        let in_fragments = *self == Self::Points(Evaluate::PerFragment);
        let view = View { camera: scene.shot.camera(), pixels: [scene.shot.size; 2] };
        let view = in_fragments.then_some(view);
        fixture.run(&Frame { view, ..scene.pose.frame(&scene.lights) });
        let sources = fixture.sources();
        let entering = luminous(&sources);
        match self {
            Self::Points(Evaluate::PerVertex) => {
                let buffer = fixture.body.outputs().vertex_exitance.expect("exitance is at the vertices");
                let values: Vec<[f32; 4]> = readback::buffer(&gpu().device, &gpu().queue, buffer).unwrap();
                let leaving = values.into_iter().map(|[r, g, b, _]| [r, g, b].map(f64::from)).collect();
                Glow { entering, leaving, places: fixture.positions(), areas: Vec::new() }
            }
            Self::Points(_) => {
                // L = scale · F_t · B/π with F_t ≤ 1: no more than B, and B itself where η = 1.
                let scale = PI / f64::from(fixture.body.profile().exit_scale(scene.medium.ior));
                let shown = scene.shot.take(fixture).into_iter().filter(|pixel| pixel[3] > 0.0);
                let leaving = shown.map(|[r, g, b, _]| [r, g, b].map(|x| scale * f64::from(x))).collect();
                Glow { entering, leaving, ..Glow::default() }
            }
            _ => {
                let places = sources.iter().map(|source| source.position).collect();
                let areas = sources.iter().map(|source| source.area).collect();
                Glow { entering, leaving: fixture.exitance(), places, areas }
            }
        }
    }
}

/// Some of the texels with an area, whatever the pose: half of them spread over the body, half next to the origin.
fn receivers(model: &Model, count: usize) -> Vec<usize> {
    let texels = &model.atlas.texels;
    let mut inside: Vec<usize> = (0..texels.len()).filter(|&k| texels[k].area > 0.0).collect();
    let nearest = inside.len().min(count / 2);
    let mut picked: Vec<usize> = (0..count / 2).map(|k| inside[(2 * k + 1) * inside.len() / count]).collect();
    let distance = |k: &usize| {
        let at = texels[*k].interpolate(model.mesh.corners(texels[*k].triangle as usize));
        at.iter().map(|x| x * x).sum::<f32>()
    };
    inside.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
    picked.extend(&inside[..nearest]);
    picked
}

fn pairs(fixture: &Fixture, scene: &Scene) -> Glow {
    let sources = fixture.twin_sources(&scene.pose, &scene.lights, 1);
    let receivers = receivers(&scene.model, 48);
    let leaving = scatter::all_pairs(&sources, &dipoles(&scene.medium), &receivers);
    let places = receivers.iter().map(|&k| sources[k].position).collect();
    Glow { entering: luminous(&sources), leaving, places, areas: Vec::new() }
}

fn converged(fixture: &Fixture, scene: &Scene) -> Glow {
    let mm = f64::from(scene.mm_per_unit);
    let sources = fixture.twin_sources(&scene.pose, &scene.lights, 1);
    let places: Vec<_> = receivers(&scene.model, 6).iter().map(|&k| sources[k].position).collect();
    let surface = fixture.twin_surface(&scene.pose);
    let lights: Vec<_> = scene.lights.iter().map(|each| light(each, mm)).collect();
    let edge = 0.1 * mm * f64::from(scene.model.mesh.diagonal());
    let leaving = Converged::new(&surface, &lights, &twin(&scene.medium), edge).exitance(&places);
    Glow { entering: luminous(&sources), leaving, places, areas: Vec::new() }
}

/// 4,096 paths: the mean is known to 1 to 2 %.
fn paths(scene: &Scene) -> Glow {
    let mm = f64::from(scene.mm_per_unit);
    let ball = Ball { center: [0.0; 3], radius: 50.0 * mm };
    let lights: Vec<_> = scene.lights.iter().map(|each| light(each, mm)).collect();
    let tracer = PathTracer::new(&ball, Volume::new(&twin(&scene.medium), 0.0), &lights)
        .unwrap_or_else(|error| panic!("{error}"));
    let shot = Shot { size: 8, fov: 0.2, ..scene.shot };
    let mut trace = tracer.trace(shot.twin(mm), 7);
    trace.pass(64, |_| true);
    let picture = trace.estimate().radiance;
    let mean = [0, 1, 2].map(|k| picture.iter().map(|pixel| pixel[k]).sum::<f64>() / picture.len() as f64);
    let shining = if scene.lights.is_empty() { 0.0 } else { PI };
    Glow { entering: vec![[shining; 3]], leaving: vec![mean.map(|x| PI * x)], ..Glow::default() }
}

/// The share of what enters that can come back at most, each channel: what paths have scattered at least once, else ∫ R_d dA over a plane.
pub fn ceiling(way: &Way, medium: &Medium) -> [f64; 3] {
    if *way != Way::Paths {
        return totals(&way.profile(), medium);
    }
    std::array::from_fn(|k| {
        let [scattering, absorption] = [medium.sigma_s_prime[k], medium.sigma_a[k]].map(f64::from);
        scattering / (scattering + absorption)
    })
}

/// ∫ R_d dA over a plane, each channel: a matter of albedo and index alone.
fn totals(profile: &Profile, medium: &Medium) -> [f64; 3] {
    type Known = Mutex<HashMap<String, [f64; 3]>>;
    static KNOWN: OnceLock<Known> = OnceLock::new();
    let albedo: [f32; 3] = std::array::from_fn(|k| {
        let [scattering, absorption] = [medium.sigma_s_prime[k], medium.sigma_a[k]];
        scattering / (scattering + absorption)
    });
    let medium = &Medium { sigma_s_prime: albedo, sigma_a: albedo.map(|a| 1.0 - a), ior: medium.ior, g: 0.0 };
    let key = format!("{profile:?} {medium:?}");
    let known = KNOWN.get_or_init(Known::default);
    if let Some(totals) = known.lock().unwrap().get(&key) {
        return *totals;
    }
    let totals = match profile {
        // Its two sources are those of the dipole.
        Profile::Dipole | Profile::DipoleNormalised | Profile::DipoleOriented => {
            dipoles(medium).map(|dipole| dipole.total())
        }
        Profile::HalfSpace(entry) => [0, 1, 2].map(|k| returned(medium, k, *entry)),
        _ => profiles(profile, medium).map(|profile| profile.total()),
    };
    known.lock().unwrap().insert(key, totals);
    totals
}

/// What 10,000 random walks return: known to 1.5 %.
fn returned(medium: &Medium, index: usize, entry: Entry) -> f64 {
    let [sigma_s_prime, sigma_a] = [medium.sigma_s_prime[index], medium.sigma_a[index]].map(f64::from);
    let albedo = sigma_s_prime / (sigma_s_prime + sigma_a);
    if albedo > 0.98 {
        // Walks would be long; nothing more can come back.
        return albedo;
    }
    let channel = Channel { sigma_s_prime, sigma_a, ior: medium.ior.into() };
    let entry = if entry == Entry::Normal { profile::Entry::Normal } else { profile::Entry::Diffuse };
    profile::half_space(&channel, entry, &profile::walks(&channel, entry, 10_000).finish()).total()
}
