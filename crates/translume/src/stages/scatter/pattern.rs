//! Pattern: 57 samples at fixed places of the atlas around every texel, the way of Gong et al. 2008. For comparison.
//!
//! reads  texel positions, irradiance, which texel fills which pixel, kernel table      writes  exitance per texel, linear RGB
//! twin   in the tests                                                                  WGSL    `pattern.wgsl`

use crate::Medium;
use crate::buffers::Buffers;
use crate::gpu::{self, FLOAT_TEXTURE, Pass, READ, UNIFORM, WRITE};
use crate::kernel_table::KernelTableLayout;
use crate::layout::PatternLayout;
use translume_mesh::Atlas;

/// From the middle of the near samples' square to its sides, in mean free paths, the geometric mean of the channels'. At 5 the error is
/// least: against all pairs, mean of skim milk, marble, skin1 and ketchup on the creature and the bunny, 100 mm, atlas 256²,
/// directional light, RMS over mean is 0.81 at 4, 0.75 at 5, 0.76 at 6 and 0.84 at 7 (test `pattern_radius_in_figures`). A radius
/// of its own for each channel gains nothing.
const RADIUS: f64 = 5.0;
/// Samples along a side of that square.
const NEAR: f32 = 7.0;

/// Where texels lie in the atlas: what a body keeps in case this method is asked for.
pub(crate) struct Plan {
    /// Row · size + column of each texel.
    pixels: Vec<u32>,
    size: u32,
    /// Side of a pixel, mm, at rest, were all alike.
    pixel: f64,
}

impl Plan {
    pub fn new(atlas: &Atlas, mm_per_unit: f32) -> Self {
        let covered = atlas.texels.iter().filter(|texel| texel.area > 0.0).count().max(1);
        let area: f64 = atlas.texels.iter().map(|texel| f64::from(texel.area)).sum();
        let pixels = atlas.texels.iter().map(|texel| {
            let [column, row] = texel.pixel.map(u32::from);
            row * atlas.size + column
        });
        Self {
            pixels: pixels.collect(),
            size: atlas.size,
            pixel: (area / covered as f64).sqrt() * f64::from(mm_per_unit),
        }
    }

    fn layout(&self, table: KernelTableLayout, medium: &Medium) -> PatternLayout {
        let paths = medium.mean_free_paths().map(|path| f64::from(path).ln());
        let (sum, count) = paths.fold((0.0, 0.0), |(sum, count), ln| (sum + ln, count + 1.0));
        // The geometric mean is nearest to all channels; a medium without any has no light to collect.
        let path = if count > 0.0 { (sum / count).exp() } else { 0.0 };
        // Samples closer than pixels would find the same texels again and again; one beyond the atlas is none.
        let near = 2.0 * RADIUS * path / f64::from(NEAR) / self.pixel.max(f64::MIN_POSITIVE);
        let near_step = near.clamp(1.0, self.size.into()) as f32;
        let near_area = (f64::from(near_step) * self.pixel).powi(2) as f32;
        PatternLayout {
            table,
            texel_count: self.pixels.len() as u32,
            size: self.size,
            near_step,
            // Eight squares like that of all near samples together lie around it.
            far_step: NEAR * near_step,
            near_area,
            far_area: NEAR * NEAR * near_area,
            padding: [0; 2],
        }
    }
}

/// Made by the first body that asks for the method.
pub(crate) struct Pattern {
    layout: wgpu::BindGroupLayout,
    collect: wgpu::ComputePipeline,
}

impl Pattern {
    pub fn new(device: &wgpu::Device) -> Self {
        let types = [UNIFORM, READ, READ, READ, READ, WRITE, FLOAT_TEXTURE, READ];
        let layout = gpu::layout(device, "pattern", wgpu::ShaderStages::COMPUTE, &types);
        let module = gpu::module(device, translume_shaders::PATTERN);
        Self { collect: gpu::compute_pipeline(device, &layout, &module, "collect"), layout }
    }

    pub fn encode(&self, pass: &mut Pass<'_>, memory: &PatternMemory, texels: u32) {
        pass.set_pipeline(&self.collect);
        pass.set_bind_group(&memory.group, &[]);
        pass.dispatch(texels);
    }
}

/// What one body reads; nobody keeps it who does not ask for the method.
pub(crate) struct PatternMemory {
    uniform: wgpu::Buffer,
    pixels: wgpu::Buffer,
    group: wgpu::BindGroup,
}

impl PatternMemory {
    pub fn new(
        device: &wgpu::Device,
        stage: &Pattern,
        buffers: &Buffers,
        kernel_table: &wgpu::TextureView,
        plan: &Plan,
    ) -> Self {
        let uniform = gpu::uniform_buffer(device, "pattern", size_of::<PatternLayout>() as u64);
        let pixels =
            gpu::buffer_with(device, "texel pixels", wgpu::BufferUsages::STORAGE, plan.pixels.as_slice());
        let resources = [
            uniform.as_entire_binding(),
            buffers.texel_positions.as_entire_binding(),
            buffers.irradiance.as_entire_binding(),
            pixels.as_entire_binding(),
            buffers.pixels.as_entire_binding(),
            buffers.exitance.as_entire_binding(),
            wgpu::BindingResource::TextureView(kernel_table),
            buffers.marks.as_entire_binding(),
        ];
        let group = gpu::bind(device, "pattern", &stage.layout, &resources);
        Self { uniform, pixels, group }
    }

    pub fn bytes(&self) -> u64 {
        self.uniform.size() + self.pixels.size()
    }

    pub fn write(&self, queue: &wgpu::Queue, plan: &Plan, table: KernelTableLayout, medium: &Medium) {
        queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&plan.layout(table, medium)));
    }
}
