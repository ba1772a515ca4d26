// What falls on a site.
struct SiteLight {
    // RGB, W/m².
    irradiance: vec4f,
    // Share of it that albedo lets in.
    tint: vec4f,
}
