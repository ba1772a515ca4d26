//! What moves on its own: an animation, a morph, or the camera around what does neither.

use super::orbit;
use crate::model::Model;
use crate::scene::{Scene, SceneAnimation};
use serde::{Deserialize, Serialize};
use std::f32::consts::TAU;

/// Seconds of a morph there and back, and of a turn.
const ROUND: f32 = 8.0;

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Playback {
    pub playing: bool,
    pub speed: f32,
    /// 0..1 of a round.
    pub phase: f32,
}

impl Default for Playback {
    fn default() -> Self {
        Self { playing: true, speed: 1.0, phase: 0.0 }
    }
}

/// What a model does when it is played.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Play {
    /// So many seconds long.
    Animation(f32),
    Morph,
    Turn,
}

impl Play {
    /// What a scene of this model plays.
    pub fn of(scene: &Scene, model: &Model) -> Self {
        let animations = &model.rig.animations;
        let named = scene.animation.as_ref().and_then(|wanted| {
            let index = match wanted {
                SceneAnimation::Index(index) => Some(*index),
                SceneAnimation::Name(name) => animations.iter().position(|animation| animation.name == *name),
            };
            animations.get(index?)
        });
        match named {
            Some(animation) => Self::Animation(animation.duration),
            None if !model.mesh.targets.is_empty() => Self::Morph,
            None => Self::Turn,
        }
    }

    fn seconds(self) -> f32 {
        match self {
            Self::Animation(duration) => duration.max(0.01),
            Self::Morph | Self::Turn => ROUND,
        }
    }
}

impl Playback {
    /// Time goes by.
    pub fn advance(&mut self, play: Play, seconds: f32) {
        if self.playing {
            self.phase = (self.phase + seconds * self.speed / play.seconds()).rem_euclid(1.0);
        }
    }

    /// The scene of a model at this moment, seen through a view of so many pixels.
    pub fn moment(&self, scene: &Scene, model: &Model, pixels: [u32; 2]) -> Scene {
        let mut scene = scene.clone();
        self.apply(Play::of(&scene, model), &mut scene, model.mesh.targets.len());
        scene.camera = scene.camera.map(|camera| orbit::shaped(camera, pixels));
        scene
    }

    /// What is played at this moment, in its scene.
    pub fn apply(&self, play: Play, scene: &mut Scene, targets: usize) {
        match play {
            Play::Animation(duration) => scene.time = Some((self.phase * duration).min(duration)),
            Play::Morph if self.playing || self.phase > 0.0 => {
                scene.morph.resize(targets, 0.0);
                scene.morph[0] = 0.5 - 0.5 * (TAU * self.phase).cos();
            }
            Play::Turn => {
                if let Some(camera) = &mut scene.camera {
                    orbit::carousel(camera, TAU * self.phase);
                }
            }
            Play::Morph => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_round_ends_where_it_began() {
        let mut playback = Playback { speed: 2.0, ..Playback::default() };
        playback.advance(Play::Morph, 0.25 * ROUND);
        assert!((playback.phase - 0.5).abs() < 1e-6);
        playback.advance(Play::Animation(4.0), 1.0);
        assert!(playback.phase < 1e-6);
        playback.playing = false;
        playback.advance(Play::Turn, 1.0);
        assert!(playback.phase < 1e-6);
    }

    #[test]
    fn a_morph_goes_there_and_back() {
        let mut scene = Scene::of_model("creature");
        let weight = |phase, scene: &mut Scene| {
            Playback { phase, ..Playback::default() }.apply(Play::Morph, scene, 1);
            scene.morph[0]
        };
        assert!(weight(0.0, &mut scene) < 1e-6 && weight(0.5, &mut scene) > 1.0 - 1e-6);
        assert!((weight(0.25, &mut scene) - weight(0.75, &mut scene)).abs() < 1e-6);
    }
}
