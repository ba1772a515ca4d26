//! Gather: every light → position, normal, live area and irradiance of every texel.
//!
//! reads  texels, triangles, positions, normals, lights, depth maps, visibility      writes  texel positions, normals, irradiance
//! twin   `translume_reference::gather`                                  WGSL    `gather.wgsl`

use crate::buffers::Buffers;
use crate::gpu::{self, DEPTH_MAPS, Pass, READ, UNIFORM, WRITE};
use crate::stages::shadow::DepthMaps;

pub(crate) struct Gather {
    layout: wgpu::BindGroupLayout,
    /// By [`Kinds::index`].
    irradiance: [wgpu::ComputePipeline; 4],
}

/// Which costly kinds of light a frame has. The pipelines of the others do not contain them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Kinds {
    pub area_lights: bool,
    pub shadowed_sky: bool,
}

impl Kinds {
    /// Place of their pipeline.
    fn index(self) -> usize {
        usize::from(self.area_lights) + 2 * usize::from(self.shadowed_sky)
    }
}

impl Gather {
    pub fn new(device: &wgpu::Device) -> Self {
        let types = [UNIFORM, READ, READ, READ, READ, READ, WRITE, WRITE, WRITE, DEPTH_MAPS];
        let layout = gpu::layout(device, "gather", wgpu::ShaderStages::COMPUTE, &types);
        let module = gpu::module(device, translume_shaders::GATHER);
        let irradiance = [(false, false), (true, false), (false, true), (true, true)];
        let irradiance = irradiance.map(|(area_lights, shadowed_sky)| {
            let constants = [("AREA_LIGHTS", area_lights), ("SHADOWED_SKY", shadowed_sky)];
            let constants = constants.map(|(name, on)| (name, f64::from(u8::from(on))));
            gpu::specialised_pipeline(device, &layout, &module, "irradiance", &constants)
        });
        Self { layout, irradiance }
    }

    /// `visible` where some light of the sky is shadowed.
    pub fn bind(
        &self,
        device: &wgpu::Device,
        buffers: &Buffers,
        depth_maps: &DepthMaps,
        visible: Option<&wgpu::Buffer>,
    ) -> wgpu::BindGroup {
        let resources = [
            buffers.gather_uniform.as_entire_binding(),
            buffers.texels.as_entire_binding(),
            buffers.triangles.as_entire_binding(),
            buffers.positions.as_entire_binding(),
            buffers.normals.as_entire_binding(),
            // Unread where there is none, but a binding may not be empty.
            visible.unwrap_or(&buffers.texels).as_entire_binding(),
            buffers.texel_positions.as_entire_binding(),
            buffers.texel_normals.as_entire_binding(),
            buffers.irradiance.as_entire_binding(),
            wgpu::BindingResource::TextureView(&depth_maps.layers.sampled),
        ];
        gpu::bind(device, "gather", &self.layout, &resources)
    }

    pub fn encode(&self, pass: &mut Pass<'_>, group: &wgpu::BindGroup, kinds: Kinds, texels: u32) {
        pass.set_pipeline(&self.irradiance[kinds.index()]);
        pass.set_bind_group(group, &[]);
        pass.dispatch(texels);
    }
}
