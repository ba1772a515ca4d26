//! The model's surface under the mouse, for lights that are put onto it.

use super::loaded::Loaded;
use super::task::Task;
use crate::error::Error;
use crate::motion::{Motion, Wish};
use crate::scene::{Scene, SceneLight};
use crate::setup::Opened;
use eframe::egui;
use glam::{Quat, Vec3};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use translume_reference::Surface;

/// How far a light stands off the surface, of the model's diagonal.
const OFF: f32 = 0.08;

/// A model in some pose, units of the scene.
pub struct Ground {
    surface: Surface,
    /// How far lights stand off it.
    off: f32,
}

impl Ground {
    /// Takes as long as a picture or two: not for the window's thread.
    fn new(wish: &Wish, Opened { model, flat_normals }: &Opened) -> Result<Self, Error> {
        let motion = Motion::new(model, wish, 1)?;
        let pose = motion.moment(0).pose;
        let surface = translume_twin::surface(&model.mesh, &pose, motion.warp, 1.0, *flat_normals);
        Ok(Self { surface, off: OFF * model.diagonal()? })
    }

    /// Where a ray meets it, and the normal there on the side that the ray comes from.
    fn hit(&self, eye: Vec3, direction: Vec3) -> Option<(Vec3, Vec3)> {
        let hit = self.surface.closest_hit(eye.as_dvec3().to_array(), direction.as_dvec3().to_array())?;
        let vector = |v: [f64; 3]| Vec3::from(v.map(|x| x as f32));
        let point = vector(self.surface.point(hit.triangle, hit.barycentric));
        let normal = vector(self.surface.normal(hit.triangle, hit.barycentric));
        let is_behind = vector(self.surface.face_normal(hit.triangle)).dot(direction) > 0.0;
        Some((point, if is_behind { -normal } else { normal }))
    }

    /// Puts a light over the place that a ray meets, so that it shines there. Where the ray meets nothing, the light stays.
    pub fn put(&self, light: &mut SceneLight, eye: Vec3, direction: Vec3) {
        let Some((point, normal)) = self.hit(eye, direction) else { return };
        let place = (point + self.off * normal).to_array();
        match light {
            SceneLight::Point { position, .. } => *position = place,
            SceneLight::Spot { position, direction, .. } => {
                (*position, *direction) = (place, (-normal).to_array());
            }
            SceneLight::Rectangle { center, half_right, half_up, .. } => {
                let shines = Vec3::from(*half_right).cross((*half_up).into()).normalize_or(-normal);
                let turn = Quat::from_rotation_arc(shines, -normal);
                for half in [half_right, half_up] {
                    *half = (turn * Vec3::from(*half)).to_array();
                }
                *center = place;
            }
            SceneLight::Sphere { center, radius, .. } => {
                *center = (point + (self.off + *radius) * normal).to_array();
            }
            SceneLight::Directional { to_light: direction, .. }
            | SceneLight::CapEnv { axis: direction, .. } => *direction = normal.to_array(),
            SceneLight::ConstantEnv { .. } | SceneLight::Environment(_) => {}
        }
    }
}

/// Of which model, and its pose.
type Key = (u64, Wish);

/// The newest ground, and the one to come.
#[derive(Default)]
pub struct Grounds {
    ready: Option<(Key, Ground)>,
    building: Option<(Key, Receiver<Ground>, Task)>,
}

impl Grounds {
    /// The ground of this model in the pose of a scene, or in one before while that is being built; `None` before the first.
    pub fn of(&mut self, scene: &Scene, loaded: &Loaded, context: &egui::Context) -> Option<&Ground> {
        self.take();
        let key = (loaded.id, scene.wish());
        let is_there = self.ready.as_ref().is_some_and(|(ready, _)| *ready == key);
        if !is_there && self.building.is_none() {
            let (sender, receiver) = channel();
            let (wish, opened, context) = (key.1.clone(), Arc::clone(&loaded.opened), context.clone());
            let task = Task::start(async move |_, _| {
                // What cannot be posed cannot be drawn either, and the picture says why.
                if let Ok(ground) = Ground::new(&wish, &opened) {
                    // Nobody may wait for it any more.
                    let _ = sender.send(ground);
                    context.request_repaint();
                }
            });
            self.building = Some((key, receiver, task));
        }
        let (_, ground) = self.ready.as_ref().filter(|((id, _), _)| *id == loaded.id)?;
        Some(ground)
    }

    fn take(&mut self) {
        let Some((key, receiver, task)) = self.building.take() else { return };
        match receiver.try_recv() {
            Ok(ground) => self.ready = Some((key, ground)),
            Err(TryRecvError::Empty) => self.building = Some((key, receiver, task)),
            Err(TryRecvError::Disconnected) => {}
        }
    }

    /// The drag has ended.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// A sphere of radius 1, made larger by so much.
    fn ball(inflate: f32) -> Ground {
        let text = format!(
            r#"{{ "shape": {{ "type": "sphere", "center": [0, 0, 0], "radius": 1 }}, "warp": {{ "inflate": {inflate} }} }}"#
        );
        let scene = Scene::parse(&text, Path::new("")).unwrap();
        let opened = Opened::new(&scene, Path::new(""), &|_| true).unwrap();
        Ground::new(&scene.wish(), &opened).unwrap()
    }

    fn point() -> SceneLight {
        SceneLight::Point { position: [9.0; 3], intensity: [1.0; 3], shadow: true, lit_region: None }
    }

    /// Where a light by a ray along −z at some height stands.
    fn placed(ground: &Ground, mut light: SceneLight, height: f32) -> Vec3 {
        ground.put(&mut light, Vec3::new(0.0, height, 10.0), Vec3::NEG_Z);
        match light {
            SceneLight::Point { position: v, .. }
            | SceneLight::Sphere { center: v, .. }
            | SceneLight::Directional { to_light: v, .. } => v.into(),
            other => panic!("{other:?}"),
        }
    }

    /// Facets of the sphere lie up to 0.02 % of its radius below it, and smooth normals are as far off.
    const FACETS: f32 = 1e-3;

    #[test]
    fn lights_stand_off_the_surface_along_its_normal() {
        let off = OFF * 12.0_f32.sqrt();
        for height in [0.0, 0.6] {
            let normal = Vec3::new(0.0, height, (1.0 - height * height).sqrt());
            let ground = ball(0.0);
            assert!(placed(&ground, point(), height).distance((1.0 + off) * normal) < FACETS);
            let sun = SceneLight::Directional {
                to_light: [1.0, 0.0, 0.0],
                irradiance: [1.0; 3],
                shadow: true,
                lit_region: None,
            };
            assert!(placed(&ground, sun, height).distance(normal) < FACETS);
            let lamp = SceneLight::Sphere { center: [9.0; 3], radius: 0.5, radiance: [1.0; 3], shadow: true };
            assert!(placed(&ground, lamp, height).distance((1.5 + off) * normal) < FACETS);
            // A surface in another pose is noticed.
            assert!(placed(&ball(0.25), point(), height).distance((1.0 + off) * normal) > 0.1);
        }
        assert_eq!(placed(&ball(0.0), point(), 1.1), Vec3::splat(9.0), "beside the model it stays");
    }

    #[test]
    fn lights_shine_onto_the_side_that_is_seen() {
        let ground = ball(0.0);
        let mut light = point();
        ground.put(&mut light, Vec3::ZERO, Vec3::X);
        let off = OFF * 12.0_f32.sqrt();
        let SceneLight::Point { position, .. } = light else { panic!("{light:?}") };
        assert!(Vec3::from(position).distance((1.0 - off) * Vec3::X) < FACETS, "seen from inside");
        let mut light = SceneLight::Rectangle {
            center: [9.0; 3],
            half_right: [0.5, 0.0, 0.0],
            half_up: [0.0, 0.25, 0.0],
            radiance: [1.0; 3],
            shadow: true,
        };
        ground.put(&mut light, Vec3::new(10.0, 0.0, 0.0), Vec3::NEG_X);
        let SceneLight::Rectangle { half_right, half_up, .. } = light else { panic!("{light:?}") };
        let area = Vec3::from(half_right).cross(half_up.into());
        assert!(area.distance(0.125 * Vec3::NEG_X) < FACETS, "{area}");
    }
}
