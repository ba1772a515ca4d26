//! The kernel table on the GPU: sized for a body, written for a medium.

use crate::gpu;
use crate::kernel_table::{self, KernelRange, KernelTableLayout};
use crate::profile::Channels;
use crate::{Medium, Profile};
use std::sync::{Arc, Mutex, PoisonError};
use translume_mesh::{Atlas, Mesh};

/// How much longer than the body's diagonal the table reaches.
const REACH: f32 = 4.0;
/// Texels this much narrower than a typical one still find themselves in the table.
const NARROW_TEXELS: f32 = 16.0;

pub(crate) struct KernelTexture {
    texture: wgpu::Texture,
    pub view: wgpu::TextureView,
    /// Rms radius of a typical texel over the diagonal of the rest pose. The range of the table keeps these proportions at any scale,
    /// and so its size.
    relative_spread: f32,
    columns: u32,
    rows: u32,
    /// The longest diagonal the content was made for, mm.
    diagonal: f32,
}

impl KernelTexture {
    pub fn new(device: &wgpu::Device, mesh: &Mesh, atlas: &Atlas) -> Self {
        let covered = atlas.texels.iter().filter(|texel| texel.area > 0.0).count().max(1);
        let area: f32 = atlas.texels.iter().map(|texel| texel.area).sum();
        let spread = (area / covered as f32 / std::f32::consts::TAU).sqrt();
        let relative_spread = spread / mesh.diagonal().max(f32::MIN_POSITIVE);
        let KernelTableLayout { columns, rows, .. } = KernelTableLayout::new(range(1.0, relative_spread));
        let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
        let texture = gpu::float_texture(device, "kernel table", (columns + 1, 2 * rows), usage);
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Self { texture, view, relative_spread, columns, rows, diagonal: 0.0 }
    }

    pub fn bytes(&self) -> u64 {
        16 * u64::from(self.texture.width()) * u64::from(self.texture.height())
    }

    /// Whether the content serves a body of this diagonal, mm.
    pub fn fits(&self, diagonal: f32) -> bool {
        (0.25..=1.0).contains(&(diagonal / self.diagonal))
    }

    /// Computes the content for a medium, or takes it from `known`. A body that outgrew the old content gets room to grow.
    pub fn write(
        &mut self,
        queue: &wgpu::Queue,
        known: &KernelTables,
        (profile, medium, channels): (&Profile, &Medium, &Channels),
        diagonal: f32,
    ) -> KernelTableLayout {
        if !self.fits(diagonal) {
            self.diagonal = roomy(diagonal.max(f32::MIN_POSITIVE));
        }
        let fresh = KernelTableLayout::new(range(self.diagonal, self.relative_spread));
        // The same proportions at another scale may round to another cell.
        let table = KernelTableLayout { columns: self.columns, rows: self.rows, ..fresh };
        let texels = known.get(table, profile, medium, channels);
        let rows = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(16 * (table.columns + 1)),
            rows_per_image: None,
        };
        queue.write_texture(
            self.texture.as_image_copy(),
            bytemuck::cast_slice(texels.as_slice()),
            rows,
            self.texture.size(),
        );
        table
    }
}

/// Contents made last: bodies of one shape and medium have the same.
#[derive(Default)]
pub(crate) struct KernelTables {
    /// The newest last.
    made: Mutex<Vec<Made>>,
}

/// So many are remembered.
const REMEMBERED: usize = 16;

struct Made {
    layout: KernelTableLayout,
    profile: Profile,
    medium: Medium,
    texels: Arc<Vec<[f32; 4]>>,
}

impl KernelTables {
    fn get(
        &self,
        layout: KernelTableLayout,
        profile: &Profile,
        medium: &Medium,
        channels: &Channels,
    ) -> Arc<Vec<[f32; 4]>> {
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        let known = made
            .iter()
            .position(|made| made.layout == layout && made.medium == *medium && made.profile == *profile);
        let newest = match known {
            Some(k) => made.remove(k),
            None => {
                let texels = Arc::new(kernel_table::build(layout, channels));
                Made { layout, profile: profile.clone(), medium: *medium, texels }
            }
        };
        let texels = Arc::clone(&newest.texels);
        if made.len() == REMEMBERED {
            made.remove(0);
        }
        made.push(newest);
        texels
    }
}

/// A tenth to half as much again, in steps of half octaves: bodies of about one size then share a table.
fn roomy(diagonal: f32) -> f32 {
    (0.5 * (2.0 * (1.1 * diagonal).log2()).ceil()).exp2()
}

fn range(diagonal: f32, relative_spread: f32) -> KernelRange {
    KernelRange { least_spread: diagonal * relative_spread / NARROW_TEXELS, longest: REACH * diagonal }
}
