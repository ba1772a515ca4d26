//! The GPU memory of a body.

use crate::Error;
use crate::gpu::{self, UNIFORM_STRIDE};
use crate::layout::{
    AtlasVertexLayout, Cluster, DeformLayout, GatherLayout, InfluenceLayout, LampLayout, LightPointLayout,
    NeedLayout, ReceiverLayout, TexelLayout,
};
use crate::light_points::{LightPoint, light_points};
use crate::stages::cluster::Tree;
use crate::stages::scatter::SOURCES_PER_DISPATCH;
use crate::stages::scatter::dual::DualMemory;
use crate::stages::shadow::DepthMaps;
use crate::standing::Standing;
use glam::Vec3;
use translume_mesh::normals::{NormalAdjacency, smooth_normals};
use translume_mesh::{Atlas, Mesh};
use wgpu::BufferUsages;

/// Every buffer of a body, named as the shaders name them.
pub(crate) struct Buffers {
    pub deform_uniform: wgpu::Buffer,
    pub rest: wgpu::Buffer,
    pub deltas: wgpu::Buffer,
    pub weights: wgpu::Buffer,
    pub influences: wgpu::Buffer,
    pub joints: wgpu::Buffer,
    pub triangles: wgpu::Buffer,
    pub adjacency: wgpu::Buffer,
    pub positions: wgpu::Buffer,
    pub normals: wgpu::Buffer,
    pub gather_uniform: wgpu::Buffer,
    pub texels: wgpu::Buffer,
    pub texel_positions: wgpu::Buffer,
    pub texel_normals: wgpu::Buffer,
    pub irradiance: wgpu::Buffer,
    pub cluster_uniforms: wgpu::Buffer,
    pub need: wgpu::Buffer,
    pub vertex_texels: wgpu::Buffer,
    pub marks: wgpu::Buffer,
    pub clusters: wgpu::Buffer,
    pub receivers: wgpu::Buffer,
    pub bounds: wgpu::Buffer,
    pub lamps: wgpu::Buffer,
    pub scatter_uniforms: wgpu::Buffer,
    pub exitance: wgpu::Buffer,
    pub pixels: wgpu::Buffer,
    pub atlas_vertices: wgpu::Buffer,
    pub corners: wgpu::Buffer,
    pub atlas_indices: wgpu::Buffer,
}

/// Sizes of a body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    pub vertices: u32,
    /// Vertices of the atlas.
    pub corners: u32,
    pub triangles: u32,
    pub targets: u32,
    pub joints: u32,
    /// 0 for a mesh without a skin.
    pub influences_per_vertex: u32,
    pub texels: u32,
    pub atlas_size: u32,
}

impl Extent {
    pub fn new(mesh: &Mesh, atlas: &Atlas) -> Self {
        Self {
            vertices: mesh.positions.len() as u32,
            corners: atlas.vertices.len() as u32,
            triangles: mesh.triangles.len() as u32,
            targets: mesh.targets.len() as u32,
            joints: mesh.skin.as_ref().map_or(0, |skin| skin.joints as u32),
            influences_per_vertex: mesh.skin.as_ref().map_or(0, |skin| skin.per_vertex as u32),
            texels: atlas.texels.len() as u32,
            atlas_size: atlas.size,
        }
    }

    /// Whether the device can hold it.
    pub fn check(&self, limits: &wgpu::Limits) -> Result<(), Error> {
        let texture = u64::from(limits.max_texture_dimension_2d);
        let binding = gpu::binding_limit(limits);
        let tree = Tree::new(self.texels);
        let clusters = u64::from(tree.clusters()) * size_of::<Cluster>() as u64;
        let lamps = u64::from(tree.sources()) * size_of::<LampLayout>() as u64;
        let bounds = 16 * u64::from(tree.sources() + tree.clusters());
        let pixels = 4 * u64::from(self.atlas_size) * u64::from(self.atlas_size);
        let deltas = 12 * u64::from(self.vertices) * u64::from(self.targets);
        let influences = 8 * u64::from(self.vertices) * u64::from(self.influences_per_vertex);
        // Every triangle is adjacent to its three corners, and to the copies of those at seams of the mesh.
        let adjacency = 4 * (u64::from(self.vertices) + 6 * u64::from(self.triangles));
        let bindings = [
            ("atlas", pixels, SMALLER_ATLAS),
            ("texels", size_of::<TexelLayout>() as u64 * u64::from(self.texels), SMALLER_ATLAS),
            ("clusters", clusters, SMALLER_ATLAS),
            ("lamps", lamps, SMALLER_ATLAS),
            ("bounds", bounds, SMALLER_ATLAS),
            ("mesh", 36 * u64::from(self.vertices), SMALLER_MESH),
            ("mesh", adjacency, SMALLER_MESH),
            ("mesh", 32 * u64::from(self.corners), SMALLER_MESH),
            ("morph targets", deltas, "use fewer morph targets"),
            ("skin", influences, "let fewer joints move a vertex"),
            ("skin", 64 * u64::from(self.joints), "use fewer joints"),
        ];
        let limit = |what: &str, limit, required, actual, remedy| {
            Err(Error::Limit { what: what.to_owned(), limit, required, actual, remedy })
        };
        if u64::from(self.atlas_size) > texture {
            return limit(
                "atlas",
                "max_texture_dimension_2d",
                self.atlas_size.into(),
                texture,
                SMALLER_ATLAS,
            );
        }
        match bindings.into_iter().find(|(_, required, _)| *required > binding) {
            Some((what, required, remedy)) => {
                limit(what, "max_storage_buffer_binding_size", required, binding, remedy)
            }
            None => Ok(()),
        }
    }
}

const SMALLER_ATLAS: &str = "use a smaller atlas, or create the device with higher limits";
const SMALLER_MESH: &str = "use a smaller mesh, or create the device with higher limits";

impl Buffers {
    pub fn new(device: &wgpu::Device, mesh: &Mesh, atlas: &Atlas, tree: &Tree, standing: &Standing) -> Self {
        let storage =
            |label, content: &[u32]| gpu::buffer_with(device, label, BufferUsages::STORAGE, content);
        let floats = |label, content: &[f32]| gpu::buffer_with(device, label, BufferUsages::STORAGE, content);
        let vectors = |label, count: usize| gpu::buffer(device, label, 16 * count as u64);
        let extent = Extent::new(mesh, atlas);

        let vertices = mesh.positions.iter().zip(&mesh.normals);
        let vertices = vertices.zip(smooth_normals(&mesh.positions, &mesh.triangles));
        let rest: Vec<f32> = vertices
            .flat_map(|((position, normal), direction)| [*position, *normal, direction])
            .flatten()
            .collect();
        let deltas: Vec<f32> =
            mesh.targets.iter().flat_map(|target| target.position_deltas.iter().flatten()).copied().collect();
        let influences: Vec<_> = mesh
            .skin
            .iter()
            .flat_map(|skin| &skin.influences)
            .map(|influence| InfluenceLayout { joint: influence.joint, weight: influence.weight })
            .collect();
        let triangles: Vec<u32> = mesh.triangles.iter().flatten().copied().collect();
        let adjacency = NormalAdjacency::build(mesh);
        let adjacency: Vec<u32> = adjacency.offsets.iter().chain(&adjacency.triangles).copied().collect();
        let atlas_vertices: Vec<_> =
            atlas.vertices.iter().map(|v| AtlasVertexLayout { xref: v.xref, uv: v.uv }).collect();
        let atlas_indices: Vec<u32> = atlas.triangles.iter().flatten().copied().collect();
        let dispatches = extent.texels.div_ceil(SOURCES_PER_DISPATCH).max(1);

        let positions = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("positions"),
            size: 16 * u64::from(extent.vertices),
            usage: BufferUsages::STORAGE | BufferUsages::VERTEX | BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        Self {
            deform_uniform: gpu::uniform_buffer(device, "deform", size_of::<DeformLayout>() as u64),
            rest: floats("rest pose", &rest),
            deltas: floats("morph deltas", &deltas),
            weights: gpu::buffer(device, "morph weights", 4 * u64::from(extent.targets)),
            influences: gpu::buffer_with(device, "influences", BufferUsages::STORAGE, &influences),
            // One at least: WGSL's array has elements of this size.
            joints: gpu::buffer(device, "joints", 64 * u64::from(extent.joints.max(1))),
            triangles: gpu::buffer_with(
                device,
                "triangles",
                BufferUsages::STORAGE | BufferUsages::INDEX,
                &triangles,
            ),
            adjacency: storage("adjacency", &adjacency),
            positions,
            normals: vectors("normals", mesh.positions.len()),
            gather_uniform: gpu::uniform_buffer(device, "gather", size_of::<GatherLayout>() as u64),
            texels: gpu::buffer_with(device, "texels", BufferUsages::STORAGE, &texel_layouts(mesh, atlas)),
            texel_positions: vectors("texel positions", atlas.texels.len()),
            texel_normals: vectors("texel normals", atlas.texels.len()),
            irradiance: vectors("irradiance", atlas.texels.len()),
            cluster_uniforms: gpu::buffer_with(
                device,
                "cluster levels",
                BufferUsages::UNIFORM,
                &tree.uniforms(),
            ),
            need: gpu::uniform_buffer(device, "need", size_of::<NeedLayout>() as u64),
            vertex_texels: storage("vertex texels", &standing.texels),
            marks: gpu::buffer_with(
                device,
                "marks",
                BufferUsages::STORAGE | BufferUsages::COPY_DST,
                &standing.words(),
            ),
            clusters: gpu::buffer(
                device,
                "clusters",
                // One at least: WGSL's array has elements of this size.
                u64::from(tree.clusters().max(1)) * size_of::<Cluster>() as u64,
            ),
            receivers: gpu::buffer(
                device,
                "receivers",
                u64::from(tree.clusters()) * size_of::<ReceiverLayout>() as u64,
            ),
            bounds: vectors("bounds", (tree.sources() + tree.clusters()) as usize),
            lamps: gpu::buffer(device, "lamps", u64::from(tree.sources()) * size_of::<LampLayout>() as u64),
            scatter_uniforms: gpu::uniform_buffer(device, "scatter", UNIFORM_STRIDE * u64::from(dispatches)),
            exitance: vectors("exitance", atlas.texels.len()),
            pixels: storage("pixels", &atlas.pixels),
            atlas_vertices: gpu::buffer_with(
                device,
                "atlas vertices",
                BufferUsages::VERTEX | BufferUsages::STORAGE,
                &atlas_vertices,
            ),
            corners: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("corners"),
                size: 32 * atlas_vertices.len() as u64,
                usage: BufferUsages::VERTEX | BufferUsages::STORAGE,
                mapped_at_creation: false,
            }),
            atlas_indices: gpu::buffer_with(device, "atlas indices", BufferUsages::INDEX, &atlas_indices),
        }
    }

    /// Bytes of the mesh, and of everything per texel.
    pub fn bytes(&self) -> [u64; 2] {
        let Self { deform_uniform, rest, deltas, weights, influences, joints, triangles, adjacency, .. } =
            self;
        let Self { positions, normals, atlas_vertices, corners, atlas_indices, vertex_texels, .. } = self;
        let Self {
            gather_uniform, texels, texel_positions, texel_normals, irradiance, cluster_uniforms, ..
        } = self;
        let Self {
            need, marks, clusters, receivers, bounds, lamps, scatter_uniforms, exitance, pixels, ..
        } = self;
        let mesh = [
            deform_uniform,
            rest,
            deltas,
            weights,
            influences,
            joints,
            triangles,
            adjacency,
            positions,
            normals,
            atlas_vertices,
            corners,
            atlas_indices,
            vertex_texels,
        ];
        let atlas = [
            gather_uniform,
            texels,
            texel_positions,
            texel_normals,
            irradiance,
            cluster_uniforms,
            need,
            marks,
            clusters,
            receivers,
            bounds,
            lamps,
            scatter_uniforms,
            exitance,
            pixels,
        ];
        [mesh.iter().map(|buffer| buffer.size()).sum(), atlas.iter().map(|buffer| buffer.size()).sum()]
    }

    pub fn outputs<'a>(
        &'a self,
        depth_maps: &'a DepthMaps,
        dual: Option<&'a DualMemory>,
        solver: Option<&'a wgpu::Buffer>,
    ) -> Outputs<'a> {
        Outputs {
            positions: &self.positions,
            normals: &self.normals,
            depth_maps: &depth_maps.layers.texture,
            texel_positions: &self.texel_positions,
            texel_normals: &self.texel_normals,
            irradiance: &self.irradiance,
            clusters: &self.clusters,
            exitance: &self.exitance,
            vertex_exitance: dual.and_then(DualMemory::vertex_exitance),
            solver,
            lists: dual.map(|memory| &memory.lists.lists),
        }
    }
}

/// What the stages wrote, as buffers in the order of the atlas' texels or the mesh's vertices. Every entry is four floats but the
/// clusters' ([`Cluster`](crate::Cluster)).
///
/// ```no_run
/// # fn example(device: &translume::wgpu::Device, queue: &translume::wgpu::Queue, body: &mut translume::Body) -> Result<(), translume::Error> {
/// // For a test or a tool; a frame never waits like that.
/// let exitance: Vec<[f32; 4]> = translume::readback::buffer(device, queue, body.outputs().exitance)?;
/// assert_eq!(exitance.len(), body.texels() as usize);
/// # Ok(()) }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Outputs<'a> {
    /// Deformed positions of the mesh's vertices, mm, w = 1.
    pub positions: &'a wgpu::Buffer,
    /// Unit normals of the mesh's vertices.
    pub normals: &'a wgpu::Buffer,
    /// `Depth32Float`, a layer per view.
    pub depth_maps: &'a wgpu::Texture,
    /// Position of each texel, mm, and its live area, mm².
    pub texel_positions: &'a wgpu::Buffer,
    /// Unit shading normal of each texel, and the cosine of how far the triangles under it lean from it.
    pub texel_normals: &'a wgpu::Buffer,
    /// Irradiance E of each texel, RGB.
    pub irradiance: &'a wgpu::Buffer,
    /// Clusters of every level above the texels. With a boundary solver nothing is written here.
    pub clusters: &'a wgpu::Buffer,
    /// Radiant exitance B of each texel, RGB; from [`Method::Dual`](crate::Method::Dual) with the number of kernel evaluations, where a
    /// group's are shared out among its texels; from [`Method::Pattern`](crate::Method::Pattern) with the number of samples that hit a surface.
    pub exitance: &'a wgpu::Buffer,
    /// With [`Evaluate::PerVertex`](crate::Evaluate::PerVertex): radiant exitance B of each vertex, RGB, and kernel evaluations.
    pub vertex_exitance: Option<&'a wgpu::Buffer>,
    /// With [`Transport::Boundary`](crate::Transport::Boundary) and beyond: where the solver is, in words of four bytes. From the 32nd on, counted
    /// from 0, the share of the light that is not explained yet, RGB, as floats; the 39th is how often it found nothing, so that the last good solution stayed.
    pub solver: Option<&'a wgpu::Buffer>,
    /// Once [`Method::Dual`](crate::Method::Dual) was used: its lists of open sources. The first word is how many words they
    /// would have filled, the second how many groups of receivers found no room. Those do not err, but take longer: their texels
    /// walk the tree on their own.
    pub lists: Option<&'a wgpu::Buffer>,
}

fn texel_layouts(mesh: &Mesh, atlas: &Atlas) -> Vec<TexelLayout> {
    let area = |triangle: u32| {
        let [a, b, c] = mesh.corners(triangle as usize).map(Vec3::from);
        0.5 * (b - a).cross(c - a).length()
    };
    let texels = atlas.texels.iter().zip(light_points(atlas));
    texels
        .map(|(texel, points)| TexelLayout {
            triangle: texel.triangle,
            barycentric_1: texel.barycentric[0],
            barycentric_2: texel.barycentric[1],
            area_ratio: if texel.area > 0.0 {
                texel.area / area(texel.triangle).max(f32::MIN_POSITIVE)
            } else {
                0.0
            },
            points: points.map(|LightPoint { triangle, weights }| {
                let [b, c] = weights.map(|weight| (weight * 65_535.0).round() as u32);
                LightPointLayout { triangle, weights: b | c << 16 }
            }),
        })
        .collect()
}
