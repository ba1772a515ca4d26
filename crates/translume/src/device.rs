//! What a device has to offer.

use crate::Error;
use crate::error::MissingLimit;
use crate::layout::GatherLayout;
use wgpu::Limits;

/// The limits that [`Translume::new`](crate::Translume::new) needs, none of them above WebGPU's defaults; where it needs none, the least that any
/// backend of wgpu has. Bodies need more memory the larger their atlas is, and say so.
///
/// A host with wishes of its own asks for the better of each:
/// `translume::required_limits().or_better_values_from(&mine)`.
#[must_use]
pub fn required_limits() -> Limits {
    Limits {
        max_storage_buffers_per_shader_stage: 8,
        max_storage_textures_per_shader_stage: 1,
        max_uniform_buffer_binding_size: size_of::<GatherLayout>() as u64,
        max_storage_buffer_binding_size: Limits::defaults().max_storage_buffer_binding_size,
        max_compute_invocations_per_workgroup: 64,
        max_compute_workgroup_size_x: 64,
        max_compute_workgroup_size_y: 8,
        max_compute_workgroup_size_z: 1,
        max_compute_workgroup_storage_size: 8192,
        max_compute_workgroups_per_dimension: 65_535,
        ..Limits::downlevel_webgl2_defaults()
    }
}

/// Names every limit that is missed.
pub(crate) fn check(limits: &Limits) -> Result<(), Error> {
    let mut missing = Vec::new();
    required_limits().check_limits_with_fail_fn(limits, false, |limit, required, actual| {
        missing.push(MissingLimit { limit, required, actual });
    });
    if missing.is_empty() { Ok(()) } else { Err(Error::Device { missing }) }
}

/// The largest atlas whose texture a device with these limits can surely address, in texels. How many texels a surface fills also counts:
/// [`Translume::create_body`](crate::Translume::create_body) has the last word.
#[must_use]
pub fn largest_atlas(limits: &Limits) -> u32 {
    let pixels = crate::gpu::binding_limit(limits) / 4;
    limits.max_texture_dimension_2d.min(pixels.isqrt() as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn webgpu_s_defaults_are_enough() {
        assert_eq!(check(&Limits::default()), Ok(()));
        assert_eq!(check(&required_limits()), Ok(()));
        assert!(required_limits().check_limits(&Limits::default()));
    }

    #[test]
    fn everything_that_is_missing_is_named_with_both_numbers() {
        let poor = Limits {
            max_storage_buffers_per_shader_stage: 4,
            max_compute_invocations_per_workgroup: 32,
            ..Limits::default()
        };
        let Err(error) = check(&poor) else { panic!("a poor device was taken") };
        let text = error.to_string();
        for words in [
            "max_storage_buffers_per_shader_stage ≥ 8 (it has 4)",
            "max_compute_invocations_per_workgroup ≥ 64 (it has 32)",
            "required_limits()",
        ] {
            assert!(text.contains(words), "{text}");
        }
        assert!(!text.contains("max_bind_groups"), "{text}");
    }
}
