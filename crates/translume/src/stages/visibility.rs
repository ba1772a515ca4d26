//! Visibility: how much of every texel sees the sky, along a fixed set of directions.
//!
//! reads  texels, triangles, positions, normals, depth along each direction    writes  four bits per texel and direction
//! twin   `translume_reference::lights`, by tracing rays                        WGSL    `visibility.wgsl`
//!
//! What a texel sees stays with it while the body moves, so a frame may renew some directions and keep the others.

use crate::ShadowOptions;
use crate::buffers::Buffers;
use crate::gpu::{self, DEPTH_MAPS, Pass, READ, UNIFORM, UNIFORM_ARRAY, WRITE};
use crate::layout::{DirectionLayout, DirectionsLayout};
use crate::shadow_view::{Subject, Tile, View, sky_view};
use crate::stages::Stage;
use crate::stages::shadow::{DepthLayers, DepthMaps, DrawCasters, Shadow};
use crate::timings::Recording;
use glam::{Vec3, Vec4};
use std::sync::Arc;

/// Directions that share a word of a texel.
const PER_WORD: usize = 8;
/// Directions that share the depth texture, four squares along each side.
const PER_BATCH: usize = 16;
const SQUARES: u32 = 4;
/// Uniforms of a word stand this far apart.
const STRIDE: u64 = 1024;

pub(crate) struct Visibility {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
}

/// What a body remembers of the sky.
pub(crate) struct SkyMemory {
    pub directions: Vec<Vec3>,
    /// Allocated when a light first needs it.
    memory: Option<Memory>,
    /// Whether words may show nothing, or the body of long ago.
    blank: bool,
    /// Words that do not show the body as it is.
    stale: usize,
    /// The word that is renewed next.
    cursor: usize,
    /// What the next frame renews.
    pub views: Vec<View>,
}

struct Memory {
    visible: wgpu::Buffer,
    maps: DepthMaps,
    uniforms: wgpu::Buffer,
    group: wgpu::BindGroup,
}

/// Directions spread evenly over the sphere: the spherical Fibonacci lattice. Those of one word are spread evenly, too.
fn directions(count: u32) -> Vec<Vec3> {
    const GOLDEN_ANGLE: f32 = 2.399_963_2;
    let words = count as usize / PER_WORD;
    let place = |k: usize| (k % PER_WORD) * words + k / PER_WORD;
    let direction = |k: usize| {
        let height = 1.0 - (2 * place(k) + 1) as f32 / count as f32;
        let (sine, cosine) = (place(k) as f32 * GOLDEN_ANGLE).sin_cos();
        let ring = (1.0 - height * height).sqrt();
        Vec3::new(ring * cosine, height, ring * sine)
    };
    (0..count as usize).map(direction).collect()
}

impl SkyMemory {
    pub fn new(options: &ShadowOptions) -> Self {
        let directions = directions(options.directions);
        let stale = directions.len() / PER_WORD;
        Self { directions, memory: None, blank: true, stale, cursor: 0, views: Vec::new() }
    }

    /// The body has moved, while nobody `watches` the sky perhaps: then all of it is renewed when somebody does.
    pub fn forget(&mut self, watched: bool) {
        self.stale = self.directions.len() / PER_WORD;
        self.blank |= !watched;
    }

    /// The buffer that the gather reads, if there is one.
    pub fn visible(&self) -> Option<&wgpu::Buffer> {
        self.memory.as_ref().map(|memory| &memory.visible)
    }

    /// Bytes of that buffer.
    pub fn size(options: &ShadowOptions, texels: u32) -> u64 {
        4 * u64::from(options.directions / PER_WORD as u32) * u64::from(texels)
    }

    /// Width of the one layer of depth that the directions take turns with.
    pub fn width(options: &ShadowOptions) -> u32 {
        SQUARES * options.direction_resolution
    }

    /// Bytes of its own, apart from the layers of depth.
    pub fn bytes(&self) -> u64 {
        self.memory.as_ref().map_or(0, |memory| memory.visible.size() + memory.uniforms.size())
    }

    /// The layer of depth, once there is one.
    pub fn depth(&self) -> Option<&Arc<DepthLayers>> {
        self.memory.as_ref().map(|memory| &memory.maps.layers)
    }

    /// Draws into another layer of depth from now on.
    pub fn take_turns(
        &mut self,
        device: &wgpu::Device,
        visibility: &Visibility,
        buffers: &Buffers,
        depth: Arc<DepthLayers>,
    ) {
        if let Some(memory) = self.memory.as_mut().filter(|memory| !Arc::ptr_eq(&memory.maps.layers, &depth))
        {
            memory.maps.layers = depth;
            let Memory { visible, maps, uniforms, .. } = memory;
            memory.group = visibility.bind(device, buffers, visible, maps, uniforms);
        }
    }

    /// Makes room.
    pub fn allocate(
        &mut self,
        device: &wgpu::Device,
        (visibility, shadow): (&Visibility, &Shadow),
        buffers: &Buffers,
        (options, texels): (&ShadowOptions, u32),
        depth: Arc<DepthLayers>,
    ) {
        let visible = gpu::buffer(device, "visible sky", Self::size(options, texels));
        let views = self.directions.len() as u64;
        let maps = shadow.depth_maps(device, depth, views);
        let uniforms = gpu::uniform_buffer(device, "directions", STRIDE * views / PER_WORD as u64);
        let group = visibility.bind(device, buffers, &visible, &maps, &uniforms);
        self.memory = Some(Memory { visible, maps, uniforms, group });
        self.forget(false);
    }

    /// Chooses what the next frame renews and uploads its views. Says whether that is anything.
    pub fn prepare(&mut self, queue: &wgpu::Queue, subject: &Subject<'_>, options: &ShadowOptions) -> bool {
        self.views.clear();
        let Some(memory) = &self.memory else { return false };
        let all = self.directions.len() / PER_WORD;
        let most = if self.blank { all } else { options.directions_per_frame as usize / PER_WORD };
        let width = options.direction_resolution;
        for k in 0..self.stale.min(most) {
            let word = (self.cursor + k) % all;
            let mut layout: DirectionsLayout = bytemuck::Zeroable::zeroed();
            layout.word = word as u32;
            for (slot, direction) in (0..).zip(&self.directions[word * PER_WORD..][..PER_WORD]) {
                let square = (k % (PER_BATCH / PER_WORD) * PER_WORD) as u32 + slot;
                let tile = Tile { layer: 0, x: square % SQUARES * width, y: square / SQUARES * width, width };
                let view = sky_view(*direction, subject, tile);
                layout.eight[slot as usize] = direction_layout(&view, *direction);
                self.views.push(view);
            }
            queue.write_buffer(&memory.uniforms, STRIDE * k as u64, bytemuck::bytes_of(&layout));
        }
        memory.maps.write_views(queue, &self.views);
        self.stale > 0
    }
}

/// The rows of a parallel view's matrix, in texels of the map.
fn direction_layout(view: &View, to_sky: Vec3) -> DirectionLayout {
    let half = 0.5 * view.tile.width as f32;
    let middle = |corner: u32| Vec4::W * (corner as f32 + half - 0.5);
    DirectionLayout {
        column: (view.matrix.row(0) * half + middle(view.tile.x)).to_array(),
        row: (view.matrix.row(1) * -half + middle(view.tile.y)).to_array(),
        depth: view.matrix.row(2).to_array(),
        to_sky: to_sky.to_array(),
        texel: view.texel,
    }
}

impl Visibility {
    pub fn new(device: &wgpu::Device) -> Self {
        let types = [UNIFORM, READ, READ, READ, READ, WRITE, DEPTH_MAPS, UNIFORM_ARRAY];
        let layout = gpu::layout(device, "visibility", wgpu::ShaderStages::COMPUTE, &types);
        let module = gpu::module(device, translume_shaders::VISIBILITY);
        Self { pipeline: gpu::compute_pipeline(device, &layout, &module, "visibility"), layout }
    }

    fn bind(
        &self,
        device: &wgpu::Device,
        buffers: &Buffers,
        visible: &wgpu::Buffer,
        maps: &DepthMaps,
        uniforms: &wgpu::Buffer,
    ) -> wgpu::BindGroup {
        let resources = [
            buffers.gather_uniform.as_entire_binding(),
            buffers.texels.as_entire_binding(),
            buffers.triangles.as_entire_binding(),
            buffers.positions.as_entire_binding(),
            buffers.normals.as_entire_binding(),
            visible.as_entire_binding(),
            wgpu::BindingResource::TextureView(&maps.layers.sampled),
            gpu::uniform_slot::<DirectionsLayout>(uniforms),
        ];
        gpu::bind(device, "visibility", &self.layout, &resources)
    }

    /// For each batch of directions: their depth, then what every texel sees of it.
    pub fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        shadow: &Shadow,
        sky: &mut SkyMemory,
        buffers: &Buffers,
        (texels, indices): (u32, u32),
        (recording, casters): (&mut Recording<'_>, DrawCasters<'_>),
    ) {
        let Some(memory) = &sky.memory else { return };
        for (batch, views) in sky.views.chunks(PER_BATCH).enumerate() {
            let (stage, views_from) = (Stage::Visibility, batch * PER_BATCH);
            let body = (buffers, indices);
            shadow.encode(encoder, (stage, recording), &memory.maps, (views_from, views), body, casters);
            let mut pass = Pass::begin(encoder, stage, recording);
            pass.set_pipeline(&self.pipeline);
            for k in 0..views.len() / PER_WORD {
                let slot = batch * (PER_BATCH / PER_WORD) + k;
                pass.set_bind_group(&memory.group, &[slot as u32 * STRIDE as u32]);
                pass.dispatch(texels);
            }
        }
        let all = sky.directions.len() / PER_WORD;
        let renewed = sky.views.len() / PER_WORD;
        sky.stale -= renewed.min(sky.stale);
        sky.cursor = (sky.cursor + renewed) % all;
        sky.blank = false;
    }
}
