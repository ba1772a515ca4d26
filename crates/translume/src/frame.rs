//! What changes from frame to frame.

use crate::layout::{MAX_AMBIENTS, MAX_LIGHTS};
use crate::{Error, HostVertices, Light, Region, View};
use glam::{Mat4, Vec3};
use translume_mesh::{Warp, rig};

/// The inputs of one frame.
///
/// ```
/// use translume::{AmbientLight, Frame, Light, Lighting};
/// use translume_mesh::Warp;
///
/// let sky = [Light::Ambient(AmbientLight::default())];
/// let frame = Frame {
///     warp: Warp { twist: 0.5, ..Default::default() },
///     lighting: Lighting::Lights(&sky),
///     ..Default::default()
/// };
/// ```
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
    /// What else casts shadows on the body: the host draws it, see [`Body::encode_with`](crate::Body::encode_with).
    pub casters: Option<Casters>,
    /// The only picture of the body in this frame, if there is but one. What it cannot show is then not scattered, and the exitance there is 0;
    /// a camera that moves makes clusters and scatter run again. `None` serves any number of pictures. From here
    /// [`Transport::BoundaryLayers`](crate::Transport::BoundaryLayers) is seen.
    pub view: Option<View>,
}

/// Opaque things of the host that cast shadows on a body.
///
/// ```
/// use translume::{Casters, Frame, Region};
///
/// let room = Region { low: [-3.0, 0.0, -3.0], high: [3.0, 2.5, 3.0] };
/// let frame = Frame { casters: Some(Casters { bounds: room, revision: 1 }), ..Default::default() };
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Casters {
    /// A box around them, world units. What lies beyond it casts no shadow.
    pub bounds: Region,
    /// Another number than in the last frame says that they have changed.
    pub revision: u64,
}

/// The pose of a body.
///
/// ```
/// use translume::{Deformation, Frame};
///
/// let half_way = Frame { deformation: Deformation::Morph(&[0.5]), ..Default::default() };
/// ```
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
    /// Vertices that the host deformed itself, in its own buffers. The warp must be none.
    Vertices(HostVertices<'a>),
}

impl<'a> From<&'a rig::Pose> for Deformation<'a> {
    fn from(pose: &'a rig::Pose) -> Self {
        Self::Pose { weights: &pose.weights, joints: &pose.joints }
    }
}

/// Where light comes from.
///
/// ```
/// use translume::{DirectionalLight, Frame, Light, Lighting};
///
/// let sun = [Light::Directional(DirectionalLight { to_light: [0.3, 1.0, 0.2], ..Default::default() })];
/// let frame = Frame { lighting: Lighting::Lights(&sun), ..Default::default() };
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Lighting<'a> {
    /// Any mix of lights: up to 64 directional, point, spot and area lights, 8 ambient ones, and environments without limit.
    Lights(&'a [Light]),
    /// The host's own: irradiance E that entered each texel, four floats (RGB and one unread) in the order of the atlas' texels. It is
    /// copied in [`Body::encode`](crate::Body::encode), so the host may write it in the same submission, from the positions and normals
    /// of [`Body::outputs`](crate::Body::outputs) after [`Body::encode_through`](crate::Body::encode_through). The buffer needs the usage `COPY_SRC`.
    Irradiance(&'a wgpu::Buffer),
}

impl Default for Frame<'_> {
    /// The rest pose at the origin, in the dark.
    fn default() -> Self {
        Self {
            model: Mat4::IDENTITY.to_cols_array_2d(),
            deformation: Deformation::Rest,
            warp: Warp::default(),
            lighting: Lighting::Lights(&[]),
            casters: None,
            view: None,
        }
    }
}

/// Checks what can be checked without the body.
pub(crate) fn validate_lights(lights: &[Light]) -> Result<(), Error> {
    for (index, light) in lights.iter().enumerate() {
        light.validate(index)?;
    }
    let count = |of: fn(&Light) -> bool| lights.iter().filter(|light| of(light)).count();
    let ambients = count(|light| matches!(light, Light::Ambient(_)));
    let skies = count(|light| matches!(light, Light::Environment(_)));
    let limits = [
        (lights.len() - ambients - skies, MAX_LIGHTS, "directional, point, spot and area"),
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

/// Corners of the box around the host's casters, mm.
pub(crate) fn caster_corners(casters: &Casters, scale: f32) -> Result<[Vec3; 8], Error> {
    let [low, high] = [casters.bounds.low, casters.bounds.high].map(|corner| Vec3::from(corner) * scale);
    if !(low.is_finite() && high.is_finite() && low.cmple(high).all()) {
        return Err(Error::Frame {
            problem: format!("casters lie between {:?} and {:?}", casters.bounds.low, casters.bounds.high),
            remedy: "give finite corners, the lower one first",
        });
    }
    Ok(std::array::from_fn(|k| Vec3::select(glam::BVec3::new(k & 1 > 0, k & 2 > 0, k & 4 > 0), high, low)))
}

/// Checks that irradiance can be copied for this many texels.
pub(crate) fn validate_irradiance(buffer: &wgpu::Buffer, texels: u32) -> Result<(), Error> {
    let required = 16 * u64::from(texels);
    if buffer.size() < required {
        return Err(Error::Frame {
            problem: format!("irradiance has {} bytes, but {texels} texels take {required}", buffer.size()),
            remedy: "give four floats for each texel of the atlas",
        });
    }
    if !buffer.usage().contains(wgpu::BufferUsages::COPY_SRC) {
        return Err(Error::Frame {
            problem: "irradiance cannot be copied".to_owned(),
            remedy: "create the buffer with the usage COPY_SRC",
        });
    }
    Ok(())
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
