// Radiant exitance around a point, to second order: what a group of receivers shares, RGB per mm⁰, mm¹, mm².
struct Expansion {
    value: vec3f,
    // Kernel evaluations spent on one of the texels below, its share of what its ancestors spent.
    evaluations: f32,
    // Gradient.
    x: vec3f,
    y: vec3f,
    z: vec3f,
    // Hessian.
    xx: vec3f,
    yy: vec3f,
    zz: vec3f,
    xy: vec3f,
    xz: vec3f,
    yz: vec3f,
}

// The expansion about a point `d` away.
fn moved(e: Expansion, d: vec3f) -> Expansion {
    var m = e;
    let hx = e.xx * d.x + e.xy * d.y + e.xz * d.z;
    let hy = e.xy * d.x + e.yy * d.y + e.yz * d.z;
    let hz = e.xz * d.x + e.yz * d.y + e.zz * d.z;
    m.value += (e.x + 0.5 * hx) * d.x + (e.y + 0.5 * hy) * d.y + (e.z + 0.5 * hz) * d.z;
    m.x += hx;
    m.y += hy;
    m.z += hz;
    return m;
}

// The kernel and its first two derivatives by r².
struct Jet {
    value: vec3f,
    first: vec3f,
    second: vec3f,
}

// How much more a source that is long towards the receiver may send than a disc, in the logarithm.
const STEEPEST: f32 = 0.7;

// As `area_averaged_profile`, but blended in the logarithm: what is far enough to be shared looks much the same lying and facing.
// Derivatives are those of the parabolas through neighbouring columns, blended, for the slope of the interpolated table jumps.
fn profile_jet(table: KernelTable, texels: texture_2d<f32>, r2: f32, s2: f32, facing: f32) -> Jet {
    let cell = table_cell(table, r2, s2);
    let column = cell.column;
    let row = cell.row;
    let fx = cell.share.x;
    let fy = cell.share.y;
    var v: array<vec3f, 4>;
    for (var k = 0; k < 4; k++) {
        let at = clamp(column + k - 1, 1, i32(table.columns));
        v[k] = mix(textureLoad(texels, vec2i(at, row), 0).rgb, textureLoad(texels, vec2i(at, row + 1), 0).rgb, fy);
    }
    const CELLS: f32 = R2_CELLS_PER_OCTAVE * 1.44269504;
    // By ln r².
    let first = CELLS * 0.5 * mix(v[2] - v[0], v[3] - v[1], fx);
    let second = CELLS * CELLS * mix(v[2] - 2.0 * v[1] + v[0], v[3] - 2.0 * v[2] + v[1], fx);
    // To second order in s a disc that lies along the line sends more than one that faces it by s²/2·(K″ − K′/r).
    let slope = clamp(s2 / r2 * (second + first * first - first), vec3f(-STEEPEST), vec3f(STEEPEST));
    let logarithm = mix(v[1], v[2], fx) - facing * slope;
    if MONOCHROME {
        let value = exp(logarithm.r);
        let slope = value * first.r / r2;
        let bend = value * (first.r * first.r + second.r - first.r) / r2 / r2;
        return Jet(vec3f(value), vec3f(slope), vec3f(bend));
    }
    let value = exp(logarithm);
    return Jet(value, value * first / r2, value * (first * first + second - first) / r2 / r2);
}

// From sources to a receiver, RGB, component by component, mm: each channel may have its source elsewhere.
struct Offsets {
    x: vec3f,
    y: vec3f,
    z: vec3f,
}

// Adds what sources of this power send to the receivers about a point so far from them.
fn add(e: ptr<function, Expansion>, power: vec3f, jet: Jet, o: Offsets) {
    let first = 2.0 * power * jet.first;
    let second = 4.0 * power * jet.second;
    (*e).value += power * jet.value;
    (*e).x += first * o.x;
    (*e).y += first * o.y;
    (*e).z += first * o.z;
    (*e).xx += second * (o.x * o.x) + first;
    (*e).yy += second * (o.y * o.y) + first;
    (*e).zz += second * (o.z * o.z) + first;
    (*e).xy += second * (o.x * o.y);
    (*e).xz += second * (o.x * o.z);
    (*e).yz += second * (o.y * o.z);
}
