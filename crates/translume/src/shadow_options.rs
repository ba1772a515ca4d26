//! How finely shadows are computed.

use crate::Error;

/// How finely shadows are computed: cost against error. Every number may change from frame to frame; no pipeline is rebuilt.
///
/// ```no_run
/// # fn example(device: &translume::wgpu::Device, queue: &translume::wgpu::Queue, body: &mut translume::Body) -> Result<(), translume::Error> {
/// use translume::ShadowOptions;
///
/// // Half as fine, and an eighth of the sky renewed in each frame.
/// body.set_shadows(ShadowOptions { resolution: 512, directions_per_frame: 8, ..Default::default() })?;
/// # Ok(()) }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShadowOptions {
    /// Width of the depth map of a directional, point or spot light in texels, from 16 to the device's
    /// `max_texture_dimension_2d`. The maps of an area light share one of this width.
    pub resolution: u32,
    /// Comparisons with a depth map along each side of a texel's square, 1..=8; at least two are made.
    pub filter: u32,
    /// Points of an area light, or of a cone of the sky that holds fewer `directions`, that cast a shadow each, 1..=64.
    pub area_points: u32,
    /// Directions from which the body's own shadow on sky light is known, a multiple of 8 from 8 to 256.
    pub directions: u32,
    /// How many of them are looked along anew in a frame in which the body moved; the others keep what they saw. A multiple of 8 from 8 on;
    /// beyond `directions` it counts as all.
    pub directions_per_frame: u32,
    /// Width of the depth map of each direction in texels, from 16 to a quarter of `max_texture_dimension_2d`.
    pub direction_resolution: u32,
}

impl Default for ShadowOptions {
    fn default() -> Self {
        Self {
            resolution: 1024,
            filter: 4,
            area_points: 16,
            directions: 64,
            directions_per_frame: 256,
            direction_resolution: 256,
        }
    }
}

impl ShadowOptions {
    pub(crate) const MAX_FILTER: u32 = 8;
    pub(crate) const MAX_AREA_POINTS: u32 = 64;
    pub(crate) const MAX_DIRECTIONS: u32 = 256;

    /// `limit` is the widest texture of the device.
    pub(crate) fn validate(&self, limit: u32) -> Result<(), Error> {
        let ranges = [
            ("resolution", self.resolution, 16, limit),
            ("filter", self.filter, 1, Self::MAX_FILTER),
            ("area_points", self.area_points, 1, Self::MAX_AREA_POINTS),
            ("directions", self.directions, 8, Self::MAX_DIRECTIONS),
            ("directions_per_frame", self.directions_per_frame, 8, u32::MAX),
            ("direction_resolution", self.direction_resolution, 16, limit / 4),
        ];
        for (field, value, least, most) in ranges {
            if !(least..=most).contains(&value) {
                return Err(Error::Shadow { field, value, range: format!("from {least} to {most}") });
            }
        }
        for (field, value) in
            [("directions", self.directions), ("directions_per_frame", self.directions_per_frame)]
        {
            if !value.is_multiple_of(8) {
                return Err(Error::Shadow { field, value, range: "a multiple of 8".to_owned() });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_field_is_checked() {
        let fine = ShadowOptions::default();
        assert!(fine.validate(8192).is_ok());
        let wrong = [
            ShadowOptions { resolution: 15, ..fine },
            ShadowOptions { resolution: 8193, ..fine },
            ShadowOptions { filter: 0, ..fine },
            ShadowOptions { area_points: 65, ..fine },
            ShadowOptions { directions: 0, ..fine },
            ShadowOptions { directions: 12, ..fine },
            ShadowOptions { directions_per_frame: 9, ..fine },
            ShadowOptions { direction_resolution: 2049, ..fine },
        ];
        let fields = [
            "resolution",
            "resolution",
            "filter",
            "area_points",
            "directions",
            "directions",
            "directions_per_frame",
            "direction_resolution",
        ];
        for (options, field) in wrong.iter().zip(fields) {
            let message = options.validate(8192).unwrap_err().to_string();
            assert!(message.starts_with(&format!("shadows: {field} is ")), "{message}");
        }
    }
}
