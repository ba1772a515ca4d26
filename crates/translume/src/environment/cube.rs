//! Irradiance as a cube map, to be looked at.

use super::harmonics::{EnvironmentLight, irradiance};
use crate::boundary::Boundary;

impl EnvironmentLight {
    /// Irradiance for the normal through the middle of every texel of a cube map: faces +x, −x, +y, −y, +z, −z of `size`² texels, row by
    /// row, as WebGPU lays out the layers of a cube texture.
    #[must_use]
    pub fn irradiance_cube(&self, eta: f32, size: u32) -> [Vec<[f32; 3]>; 6] {
        let factors = self.through(&Boundary { eta, slant: [0.0; 3], on_surface: false });
        let coordinate = |k: u32| 2.0 * (k as f32 + 0.5) / size as f32 - 1.0;
        std::array::from_fn(|face| {
            let texels = (0..size).flat_map(|t| (0..size).map(move |s| (s, t)));
            texels.map(|(s, t)| irradiance(&factors, direction(face, coordinate(s), coordinate(t)))).collect()
        })
    }
}

/// Unit vector through a point of a face: `s` to the right and `t` downwards from −1 to 1, as seen from inside the cube.
fn direction(face: usize, s: f32, t: f32) -> [f32; 3] {
    let v = match face {
        0 => [1.0, -t, -s],
        1 => [-1.0, -t, s],
        2 => [s, 1.0, t],
        3 => [s, -1.0, -t],
        4 => [s, -t, 1.0],
        _ => [-s, -t, -1.0],
    };
    glam::Vec3::from(v).normalize().to_array()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Face and texture coordinates of a direction: the table of "Cube Map Face Selection" in the Vulkan specification, which WebGPU's
    /// cube textures follow on every backend.
    fn look_up([x, y, z]: [f32; 3]) -> (usize, [f32; 2]) {
        let (ax, ay, az) = (x.abs(), y.abs(), z.abs());
        let (face, s, t, major) = if az >= ax && az >= ay {
            if z > 0.0 { (4, x, -y, az) } else { (5, -x, -y, az) }
        } else if ay >= ax {
            if y > 0.0 { (2, x, z, ay) } else { (3, x, -z, ay) }
        } else if x > 0.0 {
            (0, -z, -y, ax)
        } else {
            (1, z, -y, ax)
        };
        (face, [s, t].map(|c| 0.5 * (c / major + 1.0)))
    }

    #[test]
    fn a_sampler_finds_what_was_written() {
        let mut light = EnvironmentLight::default();
        for (k, coefficient) in light.coefficients.iter_mut().enumerate() {
            *coefficient =
                [8.0, 4.0, 0.1 * k as f32].map(|c| if k == 0 { c } else { 0.1 * c + 0.03 * k as f32 });
        }
        let size = 8;
        let cube = light.irradiance_cube(1.3, size);
        let mut least_turned = f32::INFINITY;
        for (face, texels) in cube.iter().enumerate() {
            for k in 0..size * size {
                let [s, t] = [k % size, k / size].map(|c| 2.0 * (c as f32 + 0.5) / size as f32 - 1.0);
                let d = direction(face, s, t);
                let (found, uv) = look_up(d);
                let [column, row] = uv.map(|c| (c * size as f32) as usize);
                assert_eq!((found, row * size as usize + column), (face, k as usize));
                assert_eq!(texels[k as usize], light.irradiance(1.3, d));
            }
            // A face that is transposed is another picture.
            let transposed = |k: usize| texels[k % 8 * 8 + k / 8];
            let apart: f32 = (0..64).map(|k| (transposed(k)[1] - texels[k][1]).abs()).sum();
            least_turned = least_turned.min(apart);
        }
        assert!(least_turned > 0.1, "{least_turned}");
    }
}
