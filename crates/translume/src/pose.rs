//! The pose that a frame asks for, complete and checked.

use crate::buffers::Extent;
use crate::host_vertices::Adopted;
use crate::layout::{DeformLayout, WarpLayout};
use crate::{Deformation, Error};
use glam::Mat4;
use std::f32::consts::TAU;
use translume_mesh::warp::{Axis, Warp};

/// A weight for every morph target, a matrix for every joint, and the warp; or the host's vertices in place of all that.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Pose {
    pub weights: Vec<f32>,
    /// From the mesh at rest to model space, column-major.
    pub joints: Vec<[[f32; 4]; 4]>,
    pub warp: Warp,
    pub adopted: Option<Adopted>,
}

impl Pose {
    /// As the mesh was loaded.
    pub fn rest(extent: &Extent) -> Self {
        Self {
            weights: vec![0.0; extent.targets as usize],
            joints: vec![Mat4::IDENTITY.to_cols_array_2d(); extent.joints as usize],
            warp: Warp::default(),
            adopted: None,
        }
    }

    /// Becomes what a frame asks for, in the memory it has. After an error it is neither the old pose nor the new one.
    pub fn set(&mut self, deformation: Deformation<'_>, warp: Warp) -> Result<(), Error> {
        let (weights, joints, vertices) = match deformation {
            Deformation::Rest => (None, None, None),
            Deformation::Morph(weights) => (Some(weights), None, None),
            Deformation::Pose { weights, joints } => (Some(weights), Some(joints), None),
            Deformation::Vertices(vertices) => (None, None, Some(vertices)),
        };
        validate_warp(&warp)?;
        if vertices.is_some() && !warp.is_identity() {
            let problem = "a warp of vertices that the host deforms".to_owned();
            return Err(Error::Frame { problem, remedy: "warp them in the host, or let the library deform" });
        }
        self.warp = warp;
        self.adopted = vertices.as_ref().map(Adopted::new).transpose()?;
        self.set_weights(weights)?;
        self.set_joints(joints)
    }

    /// Whether normals have to follow the pose.
    pub fn deforms(&self) -> bool {
        match &self.adopted {
            Some(adopted) => !adopted.has_normals(),
            None => !self.weights.is_empty() || !self.joints.is_empty() || !self.warp.is_identity(),
        }
    }

    /// As WGSL reads it, but for the arrays. `axis` is that of warps that bring none.
    pub fn layout(&self, extent: &Extent, axis: Axis, to_mm: Mat4) -> DeformLayout {
        DeformLayout {
            model: to_mm.to_cols_array_2d(),
            normal: to_mm.inverse().transpose().to_cols_array_2d(),
            warp: warp_layout(&self.warp, self.warp.axis.unwrap_or(axis)),
            vertex_count: extent.vertices,
            target_count: extent.targets,
            influences_per_vertex: extent.influences_per_vertex,
            winding: to_mm.determinant().signum(),
        }
    }

    fn set_weights(&mut self, weights: Option<&[f32]>) -> Result<(), Error> {
        let Some(weights) = weights else {
            self.weights.fill(0.0);
            return Ok(());
        };
        if weights.len() != self.weights.len() {
            let problem = format!("{} morph weights for {} targets", weights.len(), self.weights.len());
            return Err(Error::Frame { problem, remedy: "give one weight per target" });
        }
        if let Some(k) = weights.iter().position(|weight| !weight.is_finite()) {
            let problem = format!("morph weight {k} is {}", weights[k]);
            return Err(Error::Frame { problem, remedy: "give finite weights" });
        }
        self.weights.copy_from_slice(weights);
        Ok(())
    }

    fn set_joints(&mut self, joints: Option<&[[[f32; 4]; 4]]>) -> Result<(), Error> {
        let Some(joints) = joints else {
            self.joints.fill(Mat4::IDENTITY.to_cols_array_2d());
            return Ok(());
        };
        if joints.len() != self.joints.len() {
            let problem = format!("{} joint matrices for {} joints", joints.len(), self.joints.len());
            return Err(Error::Frame { problem, remedy: "give one matrix per joint of the mesh's skin" });
        }
        if let Some(k) = joints.iter().position(|joint| !joint.iter().flatten().all(|x| x.is_finite())) {
            let problem = format!("the matrix of joint {k} is {:?}", joints[k]);
            return Err(Error::Frame { problem, remedy: "give finite matrices" });
        }
        self.joints.copy_from_slice(joints);
        Ok(())
    }
}

fn validate_warp(warp: &Warp) -> Result<(), Error> {
    for (field, angle) in [("twist", warp.twist), ("bend", warp.bend)] {
        if !(-Warp::MAX_ANGLE..=Warp::MAX_ANGLE).contains(&angle) {
            let problem = format!("warp.{field} is {angle} rad");
            return Err(Error::Frame { problem, remedy: "give an angle between −1000 and 1000 rad" });
        }
    }
    if !warp.inflate.is_finite() {
        let problem = format!("warp.inflate is {}", warp.inflate);
        return Err(Error::Frame { problem, remedy: "give a finite distance" });
    }
    match warp.axis {
        Some(axis)
            if !(axis.foot.iter().all(|x| x.is_finite())
                && axis.height >= 0.0
                && axis.height.is_finite()) =>
        {
            let problem = format!("warp.axis rises from {:?} by {}", axis.foot, axis.height);
            Err(Error::Frame { problem, remedy: "give a finite foot and a finite height of 0 or more" })
        }
        _ => Ok(()),
    }
}

fn warp_layout(warp: &Warp, axis: Axis) -> WarpLayout {
    // One over less would be infinite.
    let upright = axis.height >= f32::MIN_POSITIVE;
    WarpLayout {
        foot: axis.foot,
        inflate: warp.inflate,
        height: axis.height,
        per_height: if upright { 1.0 / axis.height } else { 0.0 },
        twist: warp.twist / TAU,
        bend: warp.bend / TAU,
    }
}
