//! What changes from frame to frame, and its translation into uniforms.

use crate::layout::{
    AmbientLayout, GatherLayout, LightLayout, MAX_AMBIENTS, MAX_LIGHTS, MAX_VIEWS, NO_SHADOW,
};
use crate::stages::shadow::{self, View};
use crate::{Error, Light, light};
use glam::{Mat4, Vec3};
use translume_mesh::{Warp, rig};

/// The inputs of one frame.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// Model space to world space, column-major.
    pub model: [[f32; 4]; 4],
    /// The pose.
    pub deformation: Deformation<'a>,
    /// Twist, bend and inflation of that pose. Finite; angles up to [`Warp::MAX_ANGLE`].
    pub warp: Warp,
    /// The light.
    pub lighting: Lighting<'a>,
}

/// The pose of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Deformation<'a> {
    /// As the mesh was loaded.
    #[default]
    Rest,
    /// One weight per morph target of the mesh. Any finite number; 0 is the rest pose, 1 the target. Joints stay at the identity.
    Morph(&'a [f32]),
    /// Morph targets, then joints.
    Pose {
        /// As for [`Morph`](Self::Morph).
        weights: &'a [f32],
        /// One matrix per joint of the mesh's skin, from the mesh at rest to model space: column-major, finite, affine (the last row is
        /// taken to be 0, 0, 0, 1).
        joints: &'a [[[f32; 4]; 4]],
    },
}

impl<'a> From<&'a rig::Pose> for Deformation<'a> {
    fn from(pose: &'a rig::Pose) -> Self {
        Self::Pose { weights: &pose.weights, joints: &pose.joints }
    }
}

/// Where light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Lighting<'a> {
    /// Any mix of lights; up to 64 directional, point and spot lights and 8 ambient ones.
    Lights(&'a [Light]),
}

impl Default for Frame<'_> {
    /// The rest pose at the origin, in the dark.
    fn default() -> Self {
        Self {
            model: Mat4::IDENTITY.to_cols_array_2d(),
            deformation: Deformation::Rest,
            warp: Warp::default(),
            lighting: Lighting::Lights(&[]),
        }
    }
}

/// Checks what can be checked without the body.
pub(crate) fn validate_lights(lights: &[Light]) -> Result<(), Error> {
    for (index, light) in lights.iter().enumerate() {
        light.validate(index)?;
    }
    let ambients = lights.iter().filter(|light| matches!(light, Light::Ambient(_))).count();
    let limits = [
        (lights.len() - ambients, MAX_LIGHTS, "directional, point and spot"),
        (ambients, MAX_AMBIENTS, "ambient"),
    ];
    for (count, limit, kind) in limits {
        if count > limit {
            return Err(Error::Frame {
                problem: format!("{count} {kind} lights, but at most {limit} fit"),
                remedy: "merge or drop lights",
            });
        }
    }
    Ok(())
}

/// Checks the model matrix.
pub(crate) fn validate_model(model: Mat4) -> Result<(), Error> {
    if model.is_finite() && model.determinant() != 0.0 {
        return Ok(());
    }
    Err(Error::Frame {
        problem: format!("model matrix {model} cannot be inverted"),
        remedy: "give a finite matrix that keeps three dimensions",
    })
}

/// Checks that a pose has a place: `corners` of the box around it, mm.
pub(crate) fn validate_corners(corners: &[Vec3; 8]) -> Result<(), Error> {
    if corners.iter().all(|corner| corner.is_finite()) {
        return Ok(());
    }
    Err(Error::Frame {
        problem: "the pose reaches further than a 32-bit number".to_owned(),
        remedy: "give smaller weights, joints, inflation or model matrix",
    })
}

pub(crate) fn diagonal(corners: &[Vec3; 8]) -> f32 {
    corners[0].distance(corners[7])
}

/// What the gather needs of a body beside the lights.
pub(crate) struct GatherBody<'a> {
    pub texels: u32,
    pub flat_normals: bool,
    pub eta: f32,
    pub winding: f32,
    pub mm_per_unit: f32,
    pub corners: &'a [Vec3; 8],
    pub shadow_resolution: u32,
}

/// Lights and their depth maps' views, as WGSL reads them.
pub(crate) fn gather_layout(
    lights: &[Light],
    body: &GatherBody<'_>,
) -> Result<(Box<GatherLayout>, Vec<View>), Error> {
    let mut layout: Box<GatherLayout> = bytemuck::zeroed_box();
    layout.texel_count = body.texels;
    layout.flat_normals = u32::from(body.flat_normals);
    layout.eta = body.eta;
    layout.winding = body.winding;
    let mut views = Vec::new();
    for light in lights {
        if let Light::Ambient(ambient) = light {
            layout.ambients[layout.ambient_count as usize] = ambient_layout(ambient, body.eta);
            layout.ambient_count += 1;
            continue;
        }
        let own = shadow::views(light, body.mm_per_unit, body.corners, body.shadow_resolution);
        let first = if own.is_empty() { NO_SHADOW } else { views.len() as u32 };
        layout.lights[layout.light_count as usize] =
            light_layout(light, body.mm_per_unit, first, own.len() as u32);
        layout.light_count += 1;
        views.extend(own);
    }
    if views.len() > MAX_VIEWS {
        return Err(Error::Frame {
            problem: format!("{} depth maps, but at most {MAX_VIEWS} fit", views.len()),
            remedy: "a point light near the body takes six: switch some shadows off",
        });
    }
    for (slot, view) in layout.views.iter_mut().zip(&views) {
        slot.matrix = view.matrix.to_cols_array_2d();
        slot.texel = view.texel;
        slot.perspective = f32::from(u8::from(view.perspective));
    }
    Ok((layout, views))
}

fn light_layout(light: &Light, scale: f32, first_view: u32, view_count: u32) -> LightLayout {
    // Intensity over distance² in world units is intensity·scale² over distance² in millimetres.
    let in_mm = |intensity: [f32; 3]| intensity.map(|i| i * scale * scale);
    let (axis, [cone_scale, cone_offset]) = match light {
        Light::Spot(light) => (Vec3::from(light.direction).normalize(), light.falloff()),
        // As bright in every direction.
        _ => (Vec3::ZERO, [0.0, 1.0]),
    };
    let (kind, vector, colour, region) = match light {
        Light::Directional(light) => {
            (0, Vec3::from(light.to_light).normalize().to_array(), light.irradiance, light.region)
        }
        Light::Point(light) => (1, light.position.map(|x| x * scale), in_mm(light.intensity), light.region),
        Light::Spot(light) => (1, light.position.map(|x| x * scale), in_mm(light.intensity), light.region),
        Light::Ambient(light) => (2, light.axis, light.radiance, None),
        Light::Environment(_) => (2, [0.0; 3], [0.0; 3], None),
    };
    // Far corners stay finite, so that infinity minus infinity never arises.
    let bound = |x: f32| (x * scale).clamp(-1e30, 1e30);
    LightLayout {
        vector,
        kind,
        colour,
        first_view,
        region_low: region.map_or([-1e30; 3], |region| region.low.map(bound)),
        view_count,
        region_high: region.map_or([1e30; 3], |region| region.high.map(bound)),
        cone_scale,
        axis: axis.to_array(),
        cone_offset,
    }
}

fn ambient_layout(ambient: &crate::AmbientLight, eta: f32) -> AmbientLayout {
    let values: [f32; 33] = light::ambient_table(ambient.half_angle, eta);
    let mut table = [[0.0; 4]; 9];
    for (k, value) in values.into_iter().enumerate() {
        table[k / 4][k % 4] = value;
    }
    let axis = Vec3::from(ambient.axis).normalize_or(Vec3::Y).to_array();
    AmbientLayout {
        radiance: ambient.radiance,
        cone_cosine: ambient.half_angle.cos(),
        axis,
        padding: 0,
        table,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AmbientLight, DirectionalLight};

    #[test]
    fn too_many_lights_are_counted() {
        let sun = Light::Directional(DirectionalLight::default());
        assert!(validate_lights(&[sun; MAX_LIGHTS]).is_ok());
        assert!(validate_lights(&[sun; MAX_LIGHTS + 1]).unwrap_err().to_string().contains("65 directional"));
        let sky = Light::Ambient(AmbientLight::default());
        assert!(validate_lights(&[sky; MAX_AMBIENTS + 1]).is_err());
    }
}
