// A plane through the exitance of sites around a texel, by moving least squares (Lancaster, Salkauskas 1981). The module declares `site_positions`,
// `site_normals` and `site_exitance`.

// A plane is not told from sites in a line.
const FLAT: f32 = 0.02;

// Beside a texel's exitance: that the sites around its own know nothing of it.
const STRANGE: f32 = -1.0;

struct Plane {
    position: vec3f,
    normal: vec3f,
    // Axes in the surface.
    u: vec3f,
    v: vec3f,
    // Square of how far sites count, mm².
    reach2: f32,
    // Sums over the sites, each counting for its area and by how near it is and faces the same way: of ones, of places, of their products, of exitance
    // and of that times places.
    weights: f32,
    first: vec2f,
    second: vec3f,
    sum: vec3f,
    along_u: vec3f,
    along_v: vec3f,
}

fn plane_at(position: vec3f, normal: vec3f, reach: f32) -> Plane {
    var plane: Plane;
    plane.position = position;
    plane.normal = normal;
    plane.u = any_perpendicular(normal);
    plane.v = cross(normal, plane.u);
    plane.reach2 = reach * reach;
    return plane;
}

fn add_site(plane: ptr<function, Plane>, site: u32) {
    let offset = site_positions[site].xyz - (*plane).position;
    let left = max(1.0 - dot(offset, offset) / (*plane).reach2, 0.0);
    let facing = max(dot(site_normals[site].xyz, (*plane).normal), 0.0);
    let weight = left * left * facing * facing * site_positions[site].w;
    let at = vec2f(dot(offset, (*plane).u), dot(offset, (*plane).v));
    let value = weight * site_exitance[site].rgb;
    (*plane).weights += weight;
    (*plane).first += weight * at;
    (*plane).second += weight * vec3f(at * at, at.x * at.y);
    (*plane).sum += value;
    (*plane).along_u += at.x * value;
    (*plane).along_v += at.y * value;
}

// Its value at the texel.
fn value_of(plane: Plane) -> vec3f {
    let middle = plane.first / plane.weights;
    // About the middle.
    let blunt = vec3f(vec2f(FLAT * plane.weights * plane.reach2), 0.0);
    let spread = plane.second - plane.weights * vec3f(middle * middle, middle.x * middle.y) + blunt;
    let det = spread.x * spread.y - spread.z * spread.z;
    let rise_u = plane.along_u - middle.x * plane.sum;
    let rise_v = plane.along_v - middle.y * plane.sum;
    let slope_u = (spread.y * rise_u - spread.z * rise_v) / det;
    let slope_v = (spread.x * rise_v - spread.z * rise_u) / det;
    return max(plane.sum / plane.weights - middle.x * slope_u - middle.y * slope_v, vec3f(0.0));
}
