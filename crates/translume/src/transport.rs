//! How light goes through the body.

use crate::layout::TransportLayout;
use crate::stages::cluster::Tree;
use crate::stages::transport::Sites;
use crate::{Error, Medium, fresnel, phase};

/// What the way of light from where it enters to where it leaves is taken to be.
///
/// ```
/// use translume::Transport;
///
/// assert_eq!("layers".parse(), Ok(Transport::BoundaryLayers));
/// assert_eq!(Transport::default().name(), "auto");
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Transport {
    /// What serves: [`BoundaryLayers`](Self::BoundaryLayers) where light crosses the body and a frame can afford it, [`Classic`](Self::Classic) for bodies
    /// of so many mean free paths that as many sites as keep a frame short could not tell their surface, and for whoever chose what only classic transport
    /// knows: another [`Profile`](crate::Profile) than the default, another method than the dual scatter, points in place of texels, light that wanders
    /// differently far from place to place, or bodies that take turns with memory. [`Body::transport_in_use`](crate::Body::transport_in_use) says which.
    #[default]
    Auto,
    /// Every texel as if the body were a half-space around it: the [`Profile`](crate::Profile) of the straight line from where light entered. One sum a
    /// frame. Right on thick, smooth bodies; tens of percent off, and more, in thin parts and with the light behind.
    Classic,
    /// Diffusion with the boundary that the body has, as an integral equation for the fluence on its surface that a few sums a frame solve,
    /// each from where the last frame stopped. Light that scattered first is put where it did, crosses thin parts that are in their own shadow,
    /// and leaves a concave body to enter it again. What leaves is as bright in all directions. The profile is not used.
    Boundary,
    /// The same, and light leaves as the field under the surface says: gathered along the ray of view from φ at the surface and below it, with light that
    /// scattered once or twice; through a surface that refracts, along the refracted ray. Needs [`Frame::view`](crate::Frame::view), for the texture is
    /// then that camera's; without one, and with an index of refraction below 1, it is [`Boundary`](Self::Boundary).
    BoundaryLayers,
}

impl Transport {
    /// The choice, then all there is to choose from, the cheapest first.
    pub const ALL: [Self; 4] = [Self::Auto, Self::Classic, Self::Boundary, Self::BoundaryLayers];

    /// As it is written in files and on command lines.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Classic => "classic",
            Self::Boundary => "boundary",
            Self::BoundaryLayers => "layers",
        }
    }
}

impl std::str::FromStr for Transport {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        Self::ALL.into_iter().find(|transport| transport.name() == name).ok_or_else(|| Error::Frame {
            problem: format!("no transport is called {name}"),
            remedy: "take auto, classic, boundary or layers",
        })
    }
}

/// What neither scatters nor absorbs is taken to absorb this much, 1/mm.
const CLEAR: f64 = 1e-6;

/// A site is no wider than this, in mean free paths of the channel where they are shortest.
const WIDEST_SITE: f32 = 2.0;
/// Where a frame has to be short: what goes through the body is as right, but light's edges are less sharp.
const WIDEST_SITE_IN_HASTE: f32 = 4.0;
/// Nor are there fewer of them: the shape counts, too.
const FEWEST_SITES: u32 = 4096;
/// More of them take longer than a frame has.
const MOST_SITES: u32 = 20_000;
/// 256 texels.
pub(crate) const COARSEST_LEVEL: u32 = 4;

/// Of the texels' tree, that whose nodes are the sites; `texel` is the width of one, mm.
pub(crate) fn site_level(medium: &Medium, texels: u32, texel: f32, is_hasty: bool) -> u32 {
    let widest = if is_hasty { WIDEST_SITE_IN_HASTE } else { WIDEST_SITE };
    let serves = |level: &u32| {
        width_in_paths(medium, texel, *level) <= widest && texels >> (2 * level) >= FEWEST_SITES
    };
    (1..=COARSEST_LEVEL).take_while(serves).last().unwrap_or(0)
}

/// Whether a solver in haste can tell the surface of a body, and a frame of it is short.
pub(crate) fn pays(medium: &Medium, texels: u32, texel: f32) -> bool {
    let level = site_level(medium, texels, texel, true);
    texels >> (2 * level) <= MOST_SITES && width_in_paths(medium, texel, level) <= WIDEST_SITE_IN_HASTE
}

/// Of a site, in mean free paths of the channel where they are shortest.
fn width_in_paths(medium: &Medium, texel: f32, level: u32) -> f32 {
    let densest = (0..3).map(|k| medium.sigma_s_prime[k] + medium.sigma_a[k]).fold(0.0, f32::max);
    texel * (1 << level) as f32 * densest
}

/// What the shaders need to know of a medium and of the sites of a body; `texel` is the width of one, mm.
pub(crate) fn layout(
    (medium, spread): (&Medium, &phase::Table),
    sites: &Sites,
    groups: u32,
    texel: f32,
) -> TransportLayout {
    let tree = &sites.tree;
    let site = texel * (1 << sites.level) as f32;
    let eta = f64::from(medium.ior);
    let boundary = Boundary::of(eta);
    let robin = (1.0 / (3.0 * boundary.end)) as f32;
    let channel = |k: usize| {
        let scattering = f64::from(medium.sigma_s_prime[k]);
        let absorption = f64::from(medium.sigma_a[k]).max(CLEAR - scattering);
        let extinction = scattering + absorption;
        // Grosjean's.
        let diffusion = (2.0 * absorption + scattering) / (3.0 * extinction * extinction);
        [extinction, scattering / extinction, diffusion, (absorption / diffusion).sqrt()]
    };
    let channels = [0, 1, 2].map(channel);
    let row = |k: usize, geometry: f32| {
        [channels[0][k] as f32, channels[1][k] as f32, channels[2][k] as f32, geometry]
    };
    let lacking = channels.map(|[_, albedo, ..]| shortfall(albedo, eta) as f32);
    TransportLayout {
        extinction: row(0, 0.0),
        albedo: row(1, 0.0),
        diffusion: row(2, 1.0),
        decay: row(3, 0.0),
        robin: [robin, robin, robin, 0.0],
        shortfall: [lacking[0], lacking[1], lacking[2], 0.0],
        site_count: tree.counts[0],
        top_level: tree.top_level(),
        eta: medium.ior,
        source_count: tree.sources(),
        groups,
        // Half a diagonal of a square.
        reach_squared: 0.5 * site * site,
        texel_count: sites.texels,
        texels_per_site: sites.texels_per_site(),
        hopf: boundary.hopf().map(|x| x as f32),
        open: fresnel::hemispherical_transmittance(eta) as f32,
        bend: boundary.bend as f32,
        along: boundary.along as f32,
        lean: boundary.lean as f32,
        anisotropy: medium.g,
        eye: [0.0; 3],
        light_bounds: tree.sources() + tree.clusters(),
        offsets: Tree::packed(&tree.offsets),
        sources: Tree::packed(&tree.source_offsets),
        spread: *spread,
    }
}

/// What Milne's problem says of a surface: deep inside φ ∝ z + z_e, near the surface z + q(z), in mean free paths. Fits to its solution by discrete
/// ordinates, with Fresnel's reflection inside, as in `translume_reference`.
struct Boundary {
    /// z_e.
    end: f64,
    /// z_e − q(z) = a e^(−bz): a and b.
    shift: [f64; 2],
    /// Around a ball, over D/R, how much more leaves per fluence, from walks in balls of 8 to 16 mean free paths with a lamp in the middle: light that is
    /// thrown back inside runs along the surface and knows less of the bend.
    bend: f64,
    /// And over mean free paths by R how much more diffusion lacks, so that white balls of 7 to 40 mean free paths under a white sky are.
    along: f64,
    /// What diffusion lacks, over what scattered twice, grows towards flat views by this power of the cosine inside.
    lean: f64,
}

impl Boundary {
    fn of(eta: f64) -> Self {
        let beyond = (eta - 1.0).max(0.0);
        // An index beyond any real one would seal the surface.
        let [open, open_flux] = [1, 2].map(|n| fresnel::transmitted_moment(1.0 / eta, n).max(5e-3));
        Self {
            end: 2.0 / 3.0 * (2.0 - open_flux) / open + 0.0438 - beyond / (1.22 + 3.62 * beyond),
            shift: [0.1331 - beyond / (0.32 + 1.64 * beyond), (1.2 + 0.2 / beyond.max(1e-9)).min(3.4)],
            bend: (1.26 / eta).powf(4.4).min(1.0),
            along: 11.0 * beyond * beyond / (0.088 + beyond * beyond),
            lean: 1.6 * -(-3.2 * beyond).exp_m1(),
        }
    }
}

impl Boundary {
    /// a, b and the depth x that is moved to the surface, x = a e^(−bx).
    fn hopf(&self) -> [f64; 3] {
        let [most, rate] = self.shift;
        let surface = (0..60).fold(0.0, |x: f64, _| 0.5 * (x + most.max(0.0) * (-rate * x).exp()));
        [most, rate, surface]
    }
}

/// Factor on what leaves by the diffuse law, L = `exit_scale`·F_t·B/π.
pub(crate) fn exit_scale(ior: f32) -> f32 {
    (1.0 / fresnel::hemispherical_transmittance(ior.into())) as f32
}

/// What diffusion lacks of light that scattered twice, over that, so that a half-space in an even light returns what it does: a row for each of `INDICES`,
/// over the fourth root of 1 − α' in steps of .1, `translume_reference::transport::shortfall`, against which a test holds it.
const SHORTFALL: [[f64; 11]; 9] = [
    [0.6386, 0.6374, 0.6305, 0.6104, 0.5712, 0.5122, 0.4393, 0.3616, 0.2882, 0.2251, 0.1741],
    [0.7647, 0.7641, 0.7571, 0.7322, 0.6813, 0.6057, 0.5146, 0.4202, 0.3327, 0.2581, 0.1982],
    [0.9566, 0.9558, 0.9456, 0.9109, 0.8433, 0.7474, 0.6363, 0.5241, 0.4209, 0.3320, 0.2593],
    [1.0978, 1.0991, 1.0889, 1.0433, 0.9550, 0.8376, 0.7108, 0.5890, 0.4794, 0.3846, 0.3055],
    [1.1451, 1.1480, 1.1355, 1.0757, 0.9676, 0.8355, 0.7033, 0.5829, 0.4772, 0.3860, 0.3088],
    [1.1685, 1.1722, 1.1541, 1.0771, 0.9500, 0.8077, 0.6749, 0.5593, 0.4597, 0.3738, 0.3004],
    [1.1830, 1.1866, 1.1604, 1.0647, 0.9212, 0.7726, 0.6421, 0.5323, 0.4388, 0.3582, 0.2887],
    [1.1987, 1.2001, 1.1520, 1.0201, 0.8537, 0.7023, 0.5799, 0.4811, 0.3982, 0.3266, 0.2639],
    [1.2058, 1.1995, 1.1127, 0.9402, 0.7623, 0.6185, 0.5083, 0.4213, 0.3490, 0.2867, 0.2327],
];
/// Indices of refraction.
const INDICES: [f64; SHORTFALL.len()] = [1.0, 1.05, 1.1, 1.2, 1.3, 1.4, 1.5, 1.7, 2.0];

fn shortfall(albedo: f64, eta: f64) -> f64 {
    let x = (1.0 - albedo.clamp(0.0, 1.0)).powf(0.25) * (SHORTFALL[0].len() - 1) as f64;
    let cell = (x as usize).min(SHORTFALL[0].len() - 2);
    let row = (1..INDICES.len() - 1).rfind(|k| INDICES[*k] <= eta).unwrap_or(0);
    let between = |low: f64, high: f64, part: f64| low * (1.0 - part) + high * part;
    let of = |row: usize| between(SHORTFALL[row][cell], SHORTFALL[row][cell + 1], x - cell as f64);
    let part = (eta - INDICES[row]) / (INDICES[row + 1] - INDICES[row]);
    between(of(row), of(row + 1), part.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use translume_reference::path::Volume;
    use translume_reference::transport;

    #[test]
    fn shortfall_is_that_of_the_exact_half_space() {
        for ior in [1.0, 1.07, 1.33, 1.4, 1.6] {
            for albedo in [1.0, 0.999, 0.99, 0.96, 0.9, 0.84, 0.68, 0.4, 0.1] {
                let volume = Volume { sigma_s: [albedo; 3], sigma_a: [1.0 - albedo; 3], g: 0.0, ior };
                let (found, exact) = (shortfall(albedo, ior), transport::shortfall(&volume)[0]);
                // Linear between the steps.
                assert!((found - exact).abs() < 0.02, "{ior}, {albedo}: {found} {exact}");
            }
        }
    }

    #[test]
    fn sites_are_as_wide_as_light_wanders() {
        let medium =
            |scattering| Medium { sigma_s_prime: [scattering; 3], sigma_a: [0.0; 3], ior: 1.0, g: 0.0 };
        let level = |scattering, texels| site_level(&medium(scattering), texels, 0.2, false);
        assert_eq!([11.0, 4.0, 2.0, 0.1].map(|scattering| level(scattering, 200_000)), [0, 1, 2, 2]);
        assert_eq!([10_000, 40_000, 70_000].map(|texels| level(0.1, texels)), [0, 1, 2]);
    }

    #[test]
    fn a_solver_pays_where_light_crosses_a_site() {
        let medium =
            |scattering| Medium { sigma_s_prime: [scattering; 3], sigma_a: [0.0; 3], ior: 1.0, g: 0.0 };
        let is_worth = |scattering, texels, texel| pays(&medium(scattering), texels, texel);
        assert!(is_worth(4.0, 200_000, 0.2), "sixteen texels to a site");
        assert!(!is_worth(6.0, 200_000, 0.2), "too many sites, or too wide");
        assert!(is_worth(6.0, 10_000, 0.6), "texels will do");
        assert!(!is_worth(10.0, 10_000, 0.6), "they are too wide");
        assert!(is_worth(4.0, 800_000, 0.1), "of a finer atlas sites hold more");
    }

    #[test]
    fn names_are_read_back() {
        for transport in Transport::ALL {
            assert_eq!(transport.name().parse(), Ok(transport));
        }
        assert!("dipole".parse::<Transport>().is_err());
    }
}
