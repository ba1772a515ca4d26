// Krylov: the fluence that solves the boundary equation, A φ = φ_Q, by few applications of A: generalised conjugate residuals (Eisenstat, Elman and
// Schultz 1983), whose last few directions are kept with what A makes of them, from frame to frame too.

// Directions there is room for.
const DIRECTIONS: u32 = 6u;
// Of pairs of directions.
const PAIRS: u32 = DIRECTIONS * (DIRECTIONS + 1u) / 2u;
// Those, of each with a target, the target's square and that of what is given.
const PRODUCTS: u32 = PAIRS + DIRECTIONS + 2u;
// What is darker than this share of the mean weighs no more.
const DARK: f32 = 1e-3;
// A direction of which less than this is its own, squared, is rounding.
const ROUNDING: f32 = 1e-6;
// What is left of a site's equation that is much, over its fluence.
const ALONE: f32 = 0.15;
// What leaves so much more than is given, squared, is no approximation.
const HOPELESS: f32 = 1e8;

// Share of what is given that is left, squared, above which directions of former frames are given up: of a body that is another by then they say what is not so.
override STALE: f32 = 1e30;

struct State {
    // Mean of what is given, and the area.
    mean: vec4f,
    // Of each direction.
    weights: array<vec4f, DIRECTIONS>,
    // Of the newest direction.
    scale: vec4f,
    // Share of what is given that is left, in the weighted norm.
    residual: vec4f,
    // Place of the next direction, and how many there are.
    next: u32,
    count: u32,
    // Whether what was found is no approximation, and how often that was so.
    failed: u32,
    failures: u32,
}

@group(0) @binding(0) var<uniform> transport: Transport;
// φ_Q.
@group(0) @binding(1) var<storage, read> given: array<vec4f>;
// Σ A [c_G (φ − 4 η² Γ) G + φ H] of the trial, and c in w.
@group(0) @binding(2) var<storage, read> sums: array<vec4f>;
@group(0) @binding(3) var<storage, read> shapes: array<Shape>;
// Each direction, what A makes of it and what of it comes in again, then the same of the solution so far.
@group(0) @binding(4) var<storage, read_write> directions: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> state: State;
@group(0) @binding(6) var<storage, read_write> partial: array<vec4f>;
// φ of the trial, then the best there is and its Γ.
@group(0) @binding(7) var<storage, read_write> fluence: array<vec4f>;
// From `source_count` on: Γ, of the trial, and before that is sent of the solution that it begins with.
@group(0) @binding(8) var<storage, read_write> leaving: array<vec4f>;

var<workgroup> shared_sums: array<vec4f, 64>;

fn place(direction: u32, site: u32) -> u32 {
    return (direction * transport.site_count + site) * 3u;
}

fn solution(site: u32) -> u32 {
    return place(DIRECTIONS, site);
}

fn found(site: u32) -> u32 {
    return transport.site_count + site;
}

fn found_coming_in(site: u32) -> u32 {
    return 2u * transport.site_count + site;
}

fn closure(site: u32) -> f32 {
    return clamp(sums[site].w, 0.2, 1.2);
}

// What A makes of the trial.
fn made(site: u32) -> vec3f {
    return closure(site) * fluence[site].rgb + sums[site].rgb;
}

fn comes_in(site: u32) -> vec4f {
    return leaving[transport.source_count + site];
}

// Sum over the workgroup.
fn reduced(value: vec4f, local: u32) -> vec4f {
    shared_sums[local] = value;
    workgroupBarrier();
    for (var half = 32u; half > 0u; half /= 2u) {
        if local < half { shared_sums[local] += shared_sums[local + half]; }
        workgroupBarrier();
    }
    let sum = shared_sums[0];
    workgroupBarrier();
    return sum;
}

// What is given, summed up.
@compute @workgroup_size(64)
fn measure(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    var sum = vec4f(0.0);
    for (var index = group.x * 64u + local; index < transport.site_count; index += transport.groups * 64u) {
        let area = shapes[index].area;
        sum += vec4f(given[index].rgb * area, area);
    }
    let all = reduced(sum, local);
    if local == 0u { partial[group.x * PRODUCTS] = all; }
}

@compute @workgroup_size(64)
fn settle_mean(@builtin(local_invocation_index) local: u32) {
    var sum = vec4f(0.0);
    for (var k = local; k < transport.groups; k += 64u) { sum += partial[k * PRODUCTS]; }
    let all = reduced(sum, local);
    if local == 0u { state.mean = vec4f(all.rgb / max(all.w, 1e-30), all.w); }
}

// Nothing is the solution of a body that was not solved before, else the trial is what was found last.
@compute @workgroup_size(64)
fn start(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index >= transport.site_count { return; }
    if state.count == 0u {
        directions[solution(index)] = vec4f(0.0);
        directions[solution(index) + 1u] = vec4f(0.0);
        directions[solution(index) + 2u] = vec4f(0.0);
    }
    fluence[index] = directions[solution(index)];
    leaving[transport.source_count + index] = directions[solution(index) + 2u];
}

// What A makes of the solution, when it was the trial.
@compute @workgroup_size(64)
fn adopt(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index >= transport.site_count { return; }
    directions[solution(index) + 1u] = vec4f(made(index), 0.0);
    directions[solution(index) + 2u] = comes_in(index);
}

// The way from the solution to the trial is a new direction.
@compute @workgroup_size(64)
fn take(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index >= transport.site_count { return; }
    let own = solution(index);
    let newest = place(state.next, index);
    directions[newest] = vec4f(fluence[index].rgb - directions[own].rgb, 0.0);
    directions[newest + 1u] = vec4f(made(index) - directions[own + 1u].rgb, 0.0);
    directions[newest + 2u] = comes_in(index) - directions[own + 2u];
}

// Its products with the others.
@compute @workgroup_size(64)
fn project_direction(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    project(group.x, local, true);
}

// Products of the residual with all.
@compute @workgroup_size(64)
fn project_residual(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) local: u32) {
    project(group.x, local, false);
}

fn project(group: u32, local: u32, of_direction: bool) {
    var products: array<vec3f, PRODUCTS>;
    let mean = max(state.mean.rgb, vec3f(1e-30));
    for (var index = group * 64u + local; index < transport.site_count; index += transport.groups * 64u) {
        let area = shapes[index].area;
        if area <= 0.0 { continue; }
        // √A over φ_Q^¾: a body lit from behind is dark where it is seen, and errors there count.
        let bright = max(given[index].rgb / mean, vec3f(DARK));
        let weight = sqrt(area / max(state.mean.w, 1e-30)) / (mean * sqrt(bright) * sqrt(sqrt(bright)));
        var columns: array<vec3f, DIRECTIONS>;
        for (var k = 0u; k < state.count; k++) {
            if of_direction && k == state.next { continue; }
            columns[k] = weight * directions[place(k, index) + 1u].rgb;
        }
        var goal = given[index].rgb - directions[solution(index) + 1u].rgb;
        if of_direction { goal = directions[place(state.next, index) + 1u].rgb; }
        goal *= weight;
        var at = 0u;
        for (var a = 0u; a < DIRECTIONS; a++) {
            for (var b = 0u; b <= a; b++) {
                products[at] += columns[a] * columns[b];
                at += 1u;
            }
            products[PAIRS + a] += columns[a] * goal;
        }
        products[PAIRS + DIRECTIONS] += goal * goal;
        products[PRODUCTS - 1u] += weight * weight * given[index].rgb * given[index].rgb;
    }
    for (var k = 0u; k < PRODUCTS; k++) {
        let all = reduced(vec4f(products[k], 0.0), local);
        if local == 0u { partial[group * PRODUCTS + k] = all; }
    }
}

var<workgroup> totals: array<vec4f, PRODUCTS>;

// How much of each direction comes closest to the target.
fn weigh(local: u32) {
    for (var k = 0u; k < PRODUCTS; k++) {
        var sum = vec4f(0.0);
        for (var g = local; g < transport.groups; g += 64u) { sum += partial[g * PRODUCTS + k]; }
        let all = reduced(sum, local);
        if local == 0u { totals[k] = all; }
    }
    workgroupBarrier();
    if local > 0u { return; }
    var weights: array<vec3f, DIRECTIONS>;
    for (var channel = 0u; channel < 3u; channel++) {
        let solved = least_squares(channel);
        for (var k = 0u; k < DIRECTIONS; k++) { weights[k][channel] = solved[k]; }
    }
    for (var k = 0u; k < DIRECTIONS; k++) { state.weights[k] = vec4f(weights[k], 0.0); }
}

// What is left of the target's square.
fn rest() -> vec4f {
    var square = totals[PAIRS + DIRECTIONS];
    for (var k = 0u; k < DIRECTIONS; k++) { square -= state.weights[k] * totals[PAIRS + k]; }
    return square;
}

@compute @workgroup_size(64)
fn weigh_direction(@builtin(local_invocation_index) local: u32) {
    weigh(local);
    if local > 0u { return; }
    let own = rest();
    let counts = own > ROUNDING * totals[PAIRS + DIRECTIONS];
    state.scale = select(vec4f(0.0), inverseSqrt(max(own, vec4f(1e-37))), counts);
}

@compute @workgroup_size(64)
fn weigh_residual(@builtin(local_invocation_index) local: u32) {
    weigh(local);
    if local > 0u { return; }
    let left = max(rest(), vec4f(0.0)) / max(totals[PRODUCTS - 1u], vec4f(1e-30));
    state.residual = sqrt(left);
    // Not `>`: that lets NaN pass.
    let before = totals[PAIRS + DIRECTIONS] / max(totals[PRODUCTS - 1u], vec4f(1e-30));
    if max(before.x, max(before.y, before.z)) > STALE {
        for (var k = 0u; k < DIRECTIONS; k++) { state.weights[k] = vec4f(0.0); }
        state.next = 0u;
        state.count = 0u;
        state.residual = sqrt(before);
    }
    let failed = !(before.x < HOPELESS && before.y < HOPELESS && before.z < HOPELESS);
    state.failed = select(0u, 1u, failed);
    state.failures += state.failed;
}

// By Cholesky's factors of the matrix of products; a direction that the others before it make up is left out.
fn least_squares(channel: u32) -> array<f32, DIRECTIONS> {
    var factor: array<array<f32, DIRECTIONS>, DIRECTIONS>;
    var right: array<f32, DIRECTIONS>;
    for (var a = 0u; a < DIRECTIONS; a++) {
        for (var b = 0u; b < a; b++) {
            var entry = totals[a * (a + 1u) / 2u + b][channel];
            for (var k = 0u; k < b; k++) { entry -= factor[a][k] * factor[b][k]; }
            factor[a][b] = select(0.0, entry / factor[b][b], factor[b][b] > 0.0);
        }
        let own = totals[a * (a + 1u) / 2u + a][channel];
        var left = own;
        for (var k = 0u; k < a; k++) { left -= factor[a][k] * factor[a][k]; }
        let counts = left > ROUNDING * own && own > 0.0;
        factor[a][a] = select(0.0, sqrt(max(left, 0.0)), counts);
        var entry = totals[PAIRS + a][channel];
        for (var k = 0u; k < a; k++) { entry -= factor[a][k] * right[k]; }
        right[a] = select(0.0, entry / factor[a][a], counts);
    }
    var weights: array<f32, DIRECTIONS>;
    for (var k = 0u; k < DIRECTIONS; k++) {
        let a = DIRECTIONS - 1u - k;
        var entry = right[a];
        for (var b = a + 1u; b < DIRECTIONS; b++) { entry -= factor[b][a] * weights[b]; }
        weights[a] = select(0.0, entry / factor[a][a], factor[a][a] > 0.0);
    }
    return weights;
}

// What the new direction has of the others is taken from it.
@compute @workgroup_size(64)
fn part(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index >= transport.site_count { return; }
    let own = place(state.next, index);
    for (var part = 0u; part < 3u; part++) {
        var left = directions[own + part];
        for (var k = 0u; k < state.count; k++) {
            if k != state.next { left -= state.weights[k] * directions[place(k, index) + part]; }
        }
        directions[own + part] = left * state.scale;
    }
}

@compute @workgroup_size(1)
fn turn() {
    state.count = min(state.count + 1u, DIRECTIONS);
    state.next = (state.next + 1u) % DIRECTIONS;
}

// The solution goes as far along all directions as leaves least, and the next trial is what is then left beyond it.
@compute @workgroup_size(64)
fn advance(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let index = item_index(group, groups, local);
    if index >= transport.site_count || state.failed == 1u { return; }
    let own = solution(index);
    var value = directions[own].rgb;
    var image = directions[own + 1u].rgb;
    var comes = directions[own + 2u].rgb;
    for (var k = 0u; k < state.count; k++) {
        value += state.weights[k].rgb * directions[place(k, index)].rgb;
        image += state.weights[k].rgb * directions[place(k, index) + 1u].rgb;
        comes += state.weights[k].rgb * directions[place(k, index) + 2u].rgb;
    }
    // Who has no area is no unknown: its row gives its fluence.
    if shapes[index].area <= 0.0 {
        value += (given[index].rgb - image) / closure(index);
        image = given[index].rgb;
    }
    directions[own] = vec4f(value, 0.0);
    directions[own + 1u] = vec4f(image, 0.0);
    directions[own + 2u] = vec4f(comes, 0.0);
    leaving[transport.source_count + index] = vec4f(comes, 0.0);
    let left = given[index].rgb - image;
    fluence[index] = vec4f(value + left / closure(index), 0.0);
    // Steps are those that serve most sites. Of whose own equation much is left then, that is settled with nobody else: it would be a speck.
    let alone = left / (closure(index) + transport.robin.rgb * sqrt(shapes[index].area * 0.31830988) / (2.0 * transport.diffusion.rgb));
    let much = smoothstep(vec3f(ALONE), vec3f(4.0 * ALONE), abs(alone) / max(value, vec3f(1e-30)));
    fluence[found(index)] = vec4f(max(value + much * alone, vec3f(0.0)), 0.0);
    fluence[found_coming_in(index)] = vec4f(max(comes, vec3f(0.0)), 0.0);
}

// Nothing that was found on the way to no approximation is kept.
@compute @workgroup_size(1)
fn give_up() {
    state.count = select(state.count, 0u, state.failed == 1u);
}
