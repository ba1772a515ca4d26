//! Motion: what a body does from frame to frame.

use crate::error::Error;
use crate::model::Model;
use glam::{Mat4, Vec3};
use std::f32::consts::TAU;
use translume_mesh::rig::{Animation, Pose, Rig};
use translume_mesh::warp::{Axis, Warp};

/// What the command line or a scene asks for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wish {
    /// Weight of each morph target, or fewer; none for what the file says.
    pub morph: Vec<f32>,
    /// An animation by name or index.
    pub animation: Option<String>,
    /// Seconds.
    pub time: Option<f32>,
    pub twist_deg: f32,
    pub bend_deg: f32,
    /// Model units.
    pub inflate: f32,
}

/// A model's poses over the frames of a picture.
pub struct Motion<'a> {
    model: &'a Model,
    rig: Rig,
    clip: Option<Clip<'a>>,
    frames: u32,
    pub warp: Warp,
    middle: Vec3,
}

struct Clip<'a> {
    animation: &'a Animation,
    start: f32,
}

/// What differs from frame to frame.
pub struct Moment {
    pub model: Mat4,
    pub pose: Pose,
}

/// More moments than these tell a camera nothing new.
const FRAMED_MOMENTS: u32 = 48;

impl<'a> Motion<'a> {
    /// Holds a wish against what the model can do.
    pub fn new(model: &'a Model, wish: &Wish, frames: u32) -> Result<Self, Error> {
        let mut rig = model.rig.clone();
        if !wish.morph.is_empty() {
            rig.weights = morph_weights(&wish.morph, model)?;
        }
        let (low, high) = model.bounds()?;
        let warp = Warp { axis: Some(Axis::within(low, high)), ..warp(wish)? };
        let middle = 0.5 * (Vec3::from(low) + Vec3::from(high));
        Ok(Self { model, rig, clip: clip(model, wish)?, frames, warp, middle })
    }

    /// Frame k: a moment of the animation; without one, of a way through the first morph target and back; without that, of a turn
    /// around the upright axis.
    pub fn moment(&self, k: u32) -> Moment {
        let still = |pose| Moment { model: Mat4::IDENTITY, pose };
        let share = k as f32 / self.frames as f32;
        if let Some(Clip { animation, start }) = &self.clip {
            let seconds = if self.frames > 1 {
                (start + share * animation.duration).rem_euclid(animation.duration.max(f32::MIN_POSITIVE))
            } else {
                *start
            };
            return still(self.model.pose(&self.rig, Some(animation), seconds));
        }
        let mut pose = self.model.pose(&self.rig, None, 0.0);
        if self.frames == 1 {
            return still(pose);
        }
        if let Some(weight) = pose.weights.first_mut() {
            *weight = 0.5 - 0.5 * (TAU * share).cos();
            return still(pose);
        }
        let to_middle = Mat4::from_translation(self.middle);
        Moment { model: to_middle * Mat4::from_rotation_y(TAU * share) * to_middle.inverse(), pose }
    }

    /// Where the surface is at some time or other.
    pub fn points(&self) -> Result<Vec<Vec3>, Error> {
        let moments = self.frames.min(FRAMED_MOMENTS);
        let mut points = Vec::new();
        for k in 0..moments {
            let frame = u64::from(k) * u64::from(self.frames) / u64::from(moments);
            let Moment { model, pose } = self.moment(frame as u32);
            let posed = self.warp.posed(&self.model.mesh, &pose)?;
            points.extend(posed.into_iter().map(|p| model.transform_point3(p.into())));
        }
        Ok(points)
    }

    /// How long a frame lasts, seconds, where an animation says so.
    pub fn frame_seconds(&self) -> Option<f32> {
        self.clip.as_ref().map(|clip| clip.animation.duration / self.frames as f32)
    }
}

fn morph_weights(given: &[f32], model: &Model) -> Result<Vec<f32>, Error> {
    let targets = model.mesh.targets.len();
    if given.len() > targets {
        let problem = format!("{} weights, but {} has {targets} morph targets", given.len(), model.mesh.name);
        return Err(Error::Option { option: "--morph", problem });
    }
    let mut weights = given.to_vec();
    weights.resize(targets, 0.0);
    Ok(weights)
}

fn warp(wish: &Wish) -> Result<Warp, Error> {
    let most = Warp::MAX_ANGLE.to_degrees();
    for (option, angle) in [("--twist", wish.twist_deg), ("--bend", wish.bend_deg)] {
        if !(-most..=most).contains(&angle) {
            let problem = format!("{angle} degrees; give an angle between −{most:.0} and {most:.0}");
            return Err(Error::Option { option, problem });
        }
    }
    if !wish.inflate.is_finite() {
        let problem = format!("{} units; give a finite distance", wish.inflate);
        return Err(Error::Option { option: "--inflate", problem });
    }
    Ok(Warp {
        twist: wish.twist_deg.to_radians().clamp(-Warp::MAX_ANGLE, Warp::MAX_ANGLE),
        bend: wish.bend_deg.to_radians().clamp(-Warp::MAX_ANGLE, Warp::MAX_ANGLE),
        inflate: wish.inflate,
        axis: None,
    })
}

/// A time alone is one of the first animation.
fn clip<'a>(model: &'a Model, wish: &Wish) -> Result<Option<Clip<'a>>, Error> {
    let animations = &model.rig.animations;
    let fail = |option, problem| Err(Error::Option { option, problem });
    let animation = match (&wish.animation, wish.time) {
        (None, None) => return Ok(None),
        (None, Some(_)) => animations.first(),
        (Some(name), _) => animations
            .iter()
            .find(|animation| animation.name == *name)
            .or_else(|| animations.get(name.parse::<usize>().ok()?)),
    };
    let Some(animation) = animation else {
        let (option, problem) = match &wish.animation {
            Some(name) => ("--animation", format!("nothing is called \"{name}\"")),
            None => ("--time", "there is nothing to play".to_owned()),
        };
        return fail(option, format!("{problem}; {} has {}", model.mesh.name, model.animations()));
    };
    let start = wish.time.unwrap_or(0.0);
    if !(0.0..=animation.duration).contains(&start) {
        let problem = format!("{start} s is outside the animation, which lasts {} s", animation.duration);
        return fail("--time", problem);
    }
    Ok(Some(Clip { animation, start }))
}
