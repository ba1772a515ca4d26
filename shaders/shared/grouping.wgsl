// How texels make up sites.
struct Grouping {
    texel_count: u32,
    site_count: u32,
    texels_per_site: u32,
    padding: u32,
}
