// What the boundary solver knows of a medium and of its tree. Channels are RGB; in w stands geometry: a medium without absorption and with D = 1.

struct Transport {
    // σ_t, 1/mm.
    extinction: vec4f,
    // σ_s'/σ_t.
    albedo: vec4f,
    // D, mm.
    diffusion: vec4f,
    // √(σ_a/D), 1/mm.
    decay: vec4f,
    // What leaves per fluence at the surface.
    robin: vec4f,
    // What diffusion lacks of light that scattered twice, over that.
    shortfall: vec4f,
    site_count: u32,
    top_level: u32,
    // Index of refraction, inside over outside.
    eta: f32,
    // Sources of both kinds, and where the second kind begins.
    source_count: u32,
    // Workgroups of the solver's sums.
    groups: u32,
    // Square of how far a site of usual size reaches from its middle, mm²: those at a rim hold less than what lies around theirs.
    reach_squared: f32,
    // Of the atlas, and 4^l of them make up a site.
    texel_count: u32,
    texels_per_site: u32,
    // By how many mean free paths the exact field at the surface is that of a shallower place, how fast that falls off with them, and the depth that it makes
    // the surface of.
    hopf: vec3f,
    // Of diffuse light outside, what gets in.
    open: f32,
    // Around a ball: how much more leaves per fluence, over D/R, and over mean free paths by R how much more diffusion lacks.
    bend: f32,
    along: f32,
    // Power of the cosine inside by which what diffusion lacks is less than its share of what scattered twice.
    lean: f32,
    // Mean cosine of the phase function.
    anisotropy: f32,
    // Millimetres.
    eye: vec3f,
    // Where light begins among the bounds of sources.
    light_bounds: u32,
    // Where each level above the sites begins among the nodes.
    offsets: array<vec4u, 4>,
    // Where each level begins among the sources.
    sources: array<vec4u, 4>,
    // How much more of a beam turns than if it scattered evenly: by depth, and four to an entry by the angle.
    spread: array<vec4f, 64>,
}

// What a source sends, channel by channel: power about its middle, and its first moment with what else sends as a dipole does.
struct Charge {
    power: vec4f,
    x: vec4f,
    y: vec4f,
    z: vec4f,
}

// Light that entered scatters first in strata of these shares of its power: what gets far is little, and most of what gets into the shade.
const STRATA: u32 = 4u;
const SHARES: array<f32, STRATA> = array<f32, STRATA>(0.4, 0.3, 0.2, 0.1);

// Where that is: so far along a direction, and above that by what Hopf's function makes of its
// depth.
struct Strata {
    // Mean direction, inwards; shorter where directions differ.
    direction: vec3f,
    // Mean cosine to the inward normal.
    cosine: f32,
    // RGB, mm. In w: of the first the share of what entered that comes from all around, of the second the way straight inwards to the other side, mm.
    ways: array<vec4f, STRATA>,
    // RGB, mm, outwards along the normal.
    rises: array<vec4f, STRATA>,
    // Of all of them the mean way, mm, and in w the longest in any channel; the mean rise; and the mean square of how far ways are from their mean, mm².
    mean: vec4f,
    rise: vec4f,
    square: vec4f,
}

// Strata whose ways and rises are known, with what they are together.
fn summed_up(s: Strata) -> Strata {
    var all = s;
    all.mean = vec4f(0.0);
    all.rise = vec4f(0.0);
    all.square = vec4f(0.0);
    for (var k = 0u; k < STRATA; k++) {
        let way = vec4f(s.ways[k].rgb, 0.0);
        all.mean += SHARES[k] * way;
        all.square += SHARES[k] * way * way;
        all.rise += SHARES[k] * vec4f(s.rises[k].rgb, 0.0);
    }
    all.square -= all.mean * all.mean;
    let last = s.ways[STRATA - 1u];
    all.mean.w = max(last.x, max(last.y, last.z));
    return all;
}

fn node_index(level: u32, node: u32) -> u32 {
    return transport.offsets[level / 4u][level % 4u] + node;
}

// By how many mean free paths the exact field at an optical depth is that of a shallower one: z_e − q, with Hopf's function q.
fn hopf_shift(depth: vec3f) -> vec3f {
    return transport.hopf.x * exp(-transport.hopf.y * max(depth, vec3f(0.0)));
}

// Depth of the value below the surface, in mean free paths, and no deeper than this share of the way to the other side.
const LAYER: f32 = 0.9;
const LAYER_SHARE: f32 = 0.5;

// How deep that is, mm; in w the mean.
fn layer_depth(thickness: f32) -> vec4f {
    let depth = min(LAYER / transport.extinction.rgb, vec3f(LAYER_SHARE * thickness));
    return vec4f(depth, dot(depth, vec3f(1.0 / 3.0)));
}

// What leaves per fluence at a surface of this mean curvature, 1/mm. In a ball r φ is what φ is in a slab, so that its slope is steeper by φ / R than under a
// plane (Davison and Sykes, Neutron Transport Theory, 1957); around a cavity it is less steep, and around a small one about half. Behind a surface that
// refracts that counts less: what it throws back inside runs along it.
// Balls smaller than a mean free path and a half are no matter of diffusion.
fn robin(bulge: f32) -> vec3f {
    let plane = transport.robin.rgb;
    return plane + clamp(transport.bend * transport.diffusion.rgb * bulge, -0.5 * plane, 0.5 * plane);
}

// Cosine inside from which on light gets in and out.
fn critical_cosine() -> f32 {
    return sqrt(max(1.0 - 1.0 / (transport.eta * transport.eta), 0.0));
}

// Mean cosine inside of an even sky.
fn mean_sky_cosine() -> f32 {
    let critical = critical_cosine();
    return min(2.0 / 3.0 * (1.0 - critical * critical * critical) * transport.eta * transport.eta, 1.0);
}

// How much more a beam that enters at this cosine inside leaves to diffusion than if it scattered evenly, and how much more leaves so of what entered here.
// What goes nearly straight on and out again does not, and what does not turn back does: under a half-space the two are what this balances. They are alike at
// 60°, whatever g is. A fit.
fn balanced(cosine: f32) -> f32 {
    let g = transport.anisotropy;
    let steep = (cosine - 0.5) / (cosine + 0.12 * (1.0 - abs(g)));
    return max(1.0 + 0.381 * g / (0.985 + abs(g)) * steep, 0.0);
}

// What crosses a surface outwards, less what comes in, Γ. Light that is the same everywhere is η² times as bright inside.
fn net_flux(robin: vec3f, fluence: vec3f, comes_in: vec3f) -> vec3f {
    return robin * (fluence - 4.0 * transport.eta * transport.eta * comes_in);
}

fn luminance(light: vec3f) -> f32 {
    return dot(light, vec3f(1.0 / 3.0));
}
