//! The WGSL of translume: one file per stage, shared pieces with one subject each, joined here.
//!
//! ```
//! for shader in translume_shaders::ALL {
//!     assert!(shader.source.contains("fn "));
//! }
//! ```

/// One stage's complete WGSL.
#[derive(Clone, Copy, Debug)]
pub struct Shader {
    /// The stage's name, for labels and captures.
    pub name: &'static str,
    /// A complete module.
    pub source: &'static str,
}

macro_rules! shader {
    ($name:literal, $($file:literal),+) => {
        Shader { name: $name, source: concat!($(include_str!(concat!("../", $file)), "\n"),+) }
    };
}

macro_rules! scatter {
    ($name:literal, $($file:literal),+) => {
        shader!(
            $name,
            "shared/dispatch.wgsl",
            "shared/cluster.wgsl",
            "shared/kernel_table.wgsl",
            "shared/source.wgsl",
            "shared/term.wgsl",
            "shared/expansion.wgsl",
            $($file),+
        )
    };
}

macro_rules! transport {
    ($name:literal, $($file:literal),+) => {
        shader!(
            $name,
            "shared/dispatch.wgsl",
            "shared/cluster.wgsl",
            "shared/diffusion.wgsl",
            $($file),+
        )
    };
}

macro_rules! composite {
    ($name:literal, $($file:literal),+) => {
        shader!(
            $name,
            "shared/fresnel.wgsl",
            "shared/vector.wgsl",
            "shared/lights.wgsl",
            "shared/area_light.wgsl",
            "shared/environment.wgsl",
            "shared/shadow_map.wgsl",
            "shared/gloss.wgsl",
            "shared/exitance.wgsl",
            "composite.wgsl",
            $($file),+
        )
    };
}

/// Rest pose, morph targets, joints and warp → positions, and normals of a rigid body.
pub const DEFORM: Shader =
    shader!("deform", "shared/dispatch.wgsl", "shared/warp.wgsl", "shared/deform.wgsl", "deform.wgsl");
/// Vertices that the host deformed → positions and normals.
pub const ADOPT: Shader =
    shader!("adopt", "shared/dispatch.wgsl", "shared/warp.wgsl", "shared/deform.wgsl", "adopt.wgsl");
/// Deformed positions → normals.
pub const NORMALS: Shader =
    shader!("normals", "shared/dispatch.wgsl", "shared/warp.wgsl", "shared/deform.wgsl", "normals.wgsl");
/// Both → the same for each vertex of the atlas.
pub const CORNERS: Shader = shader!("corners", "shared/dispatch.wgsl", "corners.wgsl");
/// Depth maps from lights.
pub const SHADOW: Shader = shader!("shadow", "shadow.wgsl");
/// Depth maps along directions of the sky → the share of every texel that sees them.
pub const VISIBILITY: Shader = shader!(
    "visibility",
    "shared/dispatch.wgsl",
    "shared/vector.wgsl",
    "shared/lights.wgsl",
    "shared/shadow_map.wgsl",
    "shared/receiver.wgsl",
    "visibility.wgsl"
);
/// Lights → position, normal, area, irradiance of every texel.
pub const GATHER: Shader = shader!(
    "gather",
    "shared/dispatch.wgsl",
    "shared/fresnel.wgsl",
    "shared/vector.wgsl",
    "shared/lights.wgsl",
    "shared/area_light.wgsl",
    "shared/environment.wgsl",
    "shared/shadow_map.wgsl",
    "shared/receiver.wgsl",
    "gather.wgsl"
);
/// Texels → their tree of clusters.
pub const CLUSTER: Shader =
    shader!("cluster", "shared/dispatch.wgsl", "shared/cluster.wgsl", "shared/level.wgsl", "cluster.wgsl");
/// Irradiance → radiant exitance.
pub const SCATTER: Shader = scatter!("scatter", "kernel/chord.wgsl", "scatter.wgsl");
/// The same with sources off the surface, whose flux leaves.
pub const SCATTER_ORIENTED: Shader = scatter!("scatter, oriented", "kernel/oriented.wgsl", "scatter.wgsl");
/// Irradiance → radiant exitance with groups of texels at both ends.
pub const DUAL: Shader = scatter!(
    "dual",
    "shared/lists.wgsl",
    "shared/walk.wgsl",
    "kernel/chord.wgsl",
    "shared/exitance_sum.wgsl",
    "dual.wgsl"
);
/// The same with sources off the surface, whose flux leaves.
pub const DUAL_ORIENTED: Shader = scatter!(
    "dual, oriented",
    "shared/lists.wgsl",
    "shared/walk.wgsl",
    "kernel/oriented.wgsl",
    "shared/exitance_sum.wgsl",
    "dual.wgsl"
);
/// Texels → sites, fewer of them, for the boundary solver.
pub const GROUP: Shader = transport!("group", "shared/site_light.wgsl", "transport/group.wgsl");
/// Sites → their tree of discs.
pub const SITES: Shader = transport!(
    "sites",
    "shared/vector.wgsl",
    "shared/shape.wgsl",
    "shared/node.wgsl",
    "shared/level.wgsl",
    "transport/sites.wgsl"
);
/// Light that entered → where it scatters first.
pub const SOURCE: Shader = transport!(
    "source",
    "shared/shape.wgsl",
    "shared/fresnel.wgsl",
    "shared/vector.wgsl",
    "shared/lights.wgsl",
    "shared/node.wgsl",
    "shared/ray.wgsl",
    "shared/fan.wgsl",
    "shared/beam.wgsl",
    "shared/site_light.wgsl",
    "shared/stratum.wgsl",
    "shared/surroundings.wgsl",
    "shared/sky_way.wgsl",
    "transport/source.wgsl"
);
/// What texels send, summed up their tree.
pub const MERGE: Shader =
    transport!("merge", "shared/shape.wgsl", "shared/level.wgsl", "transport/merge.wgsl");
/// Both → fluence, with groups of texels at both ends.
pub const POTENTIAL: Shader = transport!(
    "potential",
    "shared/vector.wgsl",
    "shared/shape.wgsl",
    "shared/kernel_table.wgsl",
    "shared/term.wgsl",
    "shared/lists.wgsl",
    "shared/walk.wgsl",
    "kernel/potential.wgsl",
    "dual.wgsl"
);
/// What leaves a concave body → what comes in again.
pub const RETURNING: Shader = transport!(
    "returning",
    "shared/shape.wgsl",
    "shared/level.wgsl",
    "shared/node.wgsl",
    "shared/surroundings.wgsl",
    "transport/returning.wgsl"
);
/// The boundary equation's next try.
pub const KRYLOV: Shader = transport!("krylov", "shared/shape.wgsl", "transport/krylov.wgsl");
/// Fluence → radiant exitance.
pub const LAYER: Shader = transport!(
    "layer",
    "shared/shape.wgsl",
    "shared/parabola.wgsl",
    "shared/stratum.wgsl",
    "transport/layer.wgsl"
);
/// The same as it is seen from the eye.
pub const PICTURE: Shader = transport!(
    "picture",
    "shared/parabola.wgsl",
    "shared/vector.wgsl",
    "shared/fresnel.wgsl",
    "shared/lights.wgsl",
    "shared/node.wgsl",
    "shared/ray.wgsl",
    "shared/beam.wgsl",
    "shared/sky_way.wgsl",
    "shared/shape.wgsl",
    "shared/stratum.wgsl",
    "transport/twice.wgsl",
    "transport/picture.wgsl"
);
/// Sites → those around each.
pub const NEAR: Shader =
    transport!("near", "shared/node.wgsl", "shared/surroundings.wgsl", "transport/near.wgsl");
/// Radiant exitance of sites → of texels.
pub const SMOOTH: Shader = transport!(
    "smooth",
    "shared/vector.wgsl",
    "shared/surroundings.wgsl",
    "shared/plane.wgsl",
    "transport/smooth.wgsl"
);
/// The same of texels about which the sites around their own say nothing.
pub const STRANGERS: Shader = transport!(
    "strangers",
    "shared/vector.wgsl",
    "shared/node.wgsl",
    "shared/plane.wgsl",
    "transport/strangers.wgsl"
);
/// What the groups leave for points → radiant exitance of every vertex.
pub const VERTICES: Shader = scatter!(
    "vertices",
    "shared/lists.wgsl",
    "shared/walk.wgsl",
    "kernel/chord.wgsl",
    "shared/point.wgsl",
    "vertices.wgsl"
);
/// The same from a fixed pattern of the atlas, for comparison.
pub const PATTERN: Shader = shader!(
    "pattern",
    "shared/dispatch.wgsl",
    "shared/cluster.wgsl",
    "shared/kernel_table.wgsl",
    "pattern.wgsl"
);
/// Dense texels → texture.
pub const RESOLVE: Shader = shader!("resolve", "resolve.wgsl");
/// The camera pass.
pub const COMPOSITE: Shader = composite!("composite", "composite/texels.wgsl");
/// The same with exitance at the vertices.
pub const COMPOSITE_VERTICES: Shader = composite!("composite of vertices", "composite/vertices.wgsl");
/// The same with exitance summed up at every fragment.
pub const COMPOSITE_FRAGMENTS: Shader = composite!(
    "composite of fragments",
    "shared/cluster.wgsl",
    "shared/kernel_table.wgsl",
    "shared/source.wgsl",
    "shared/term.wgsl",
    "shared/expansion.wgsl",
    "shared/lists.wgsl",
    "shared/walk.wgsl",
    "kernel/chord.wgsl",
    "shared/point.wgsl",
    "composite/fragments.wgsl"
);

/// Every module, in the order light flows through them.
pub const ALL: [Shader; 30] = [
    DEFORM,
    ADOPT,
    NORMALS,
    CORNERS,
    VISIBILITY,
    SHADOW,
    GATHER,
    CLUSTER,
    SCATTER,
    SCATTER_ORIENTED,
    DUAL,
    DUAL_ORIENTED,
    VERTICES,
    PATTERN,
    GROUP,
    SITES,
    SOURCE,
    MERGE,
    POTENTIAL,
    RETURNING,
    KRYLOV,
    LAYER,
    PICTURE,
    NEAR,
    SMOOTH,
    STRANGERS,
    RESOLVE,
    COMPOSITE,
    COMPOSITE_VERTICES,
    COMPOSITE_FRAGMENTS,
];

/// WGSL functions for a host's own material: `translume_exitance(texture, uv)` samples radiant exitance B, and
/// `fresnel_transmittance(eta, cosine)` weighs what leaves towards the eye: L = F_t·B/π.
pub const MATERIAL: &str =
    concat!(include_str!("../shared/exitance.wgsl"), "\n", include_str!("../shared/fresnel.wgsl"));
