//! The lights of a scene.

use super::is_default;
use crate::environment::Environment;
use crate::error::Error;
use serde::{Deserialize, Serialize};
use std::path::Path;
use translume::{
    AmbientLight, DirectionalLight, Light, PointLight, RectangleLight, Region, SphereLight, SpotLight,
};

fn lit() -> bool {
    true
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum SceneLight {
    Directional {
        to_light: [f32; 3],
        irradiance: [f32; 3],
        #[serde(default = "lit")]
        shadow: bool,
        #[serde(skip_serializing_if = "Option::is_none")]
        lit_region: Option<LitRegion>,
    },
    Point {
        position: [f32; 3],
        intensity: [f32; 3],
        #[serde(default = "lit")]
        shadow: bool,
        #[serde(skip_serializing_if = "Option::is_none")]
        lit_region: Option<LitRegion>,
    },
    Spot {
        position: [f32; 3],
        direction: [f32; 3],
        intensity: [f32; 3],
        #[serde(default)]
        inner_angle_deg: f32,
        #[serde(default = "spot_outer_angle_deg")]
        outer_angle_deg: f32,
        #[serde(default = "lit")]
        shadow: bool,
        #[serde(skip_serializing_if = "Option::is_none")]
        lit_region: Option<LitRegion>,
    },
    ConstantEnv {
        radiance: [f32; 3],
        #[serde(default = "lit")]
        shadow: bool,
    },
    CapEnv {
        radiance: [f32; 3],
        axis: [f32; 3],
        half_angle_deg: f32,
        #[serde(default = "lit")]
        shadow: bool,
    },
    Environment(Environment),
    Rectangle {
        center: [f32; 3],
        half_right: [f32; 3],
        half_up: [f32; 3],
        radiance: [f32; 3],
        #[serde(default = "lit")]
        shadow: bool,
    },
    Sphere {
        center: [f32; 3],
        radius: f32,
        radiance: [f32; 3],
        #[serde(default = "lit")]
        shadow: bool,
    },
}

/// As in the glTF extension.
fn spot_outer_angle_deg() -> f32 {
    45.0
}

/// Light enters only through the face y = 0, and only where the coordinate is at least `min`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LitRegion {
    pub axis: Axis,
    pub min: f32,
    #[serde(default, skip_serializing_if = "is_default")]
    pub note: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    X,
    Y,
    Z,
}

impl LitRegion {
    fn region(&self, surface: f32) -> Region {
        let mut low = [f32::MIN; 3];
        low[1] = surface;
        let axis = self.axis as usize;
        low[axis] = low[axis].max(self.min);
        Region { low, high: [f32::MAX; 3] }
    }
}

impl SceneLight {
    /// What people call it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Directional { .. } => "sun",
            Self::Point { .. } => "point",
            Self::Spot { .. } => "spot",
            Self::ConstantEnv { .. } => "sky",
            Self::CapEnv { .. } => "cone of the sky",
            Self::Environment(_) => "sky from a file",
            Self::Rectangle { .. } => "rectangle",
            Self::Sphere { .. } => "sphere",
        }
    }

    /// Irradiance, intensity or radiance; a map has its own.
    pub fn brightness_mut(&mut self) -> Option<&mut [f32; 3]> {
        match self {
            Self::Directional { irradiance: rgb, .. }
            | Self::Point { intensity: rgb, .. }
            | Self::Spot { intensity: rgb, .. }
            | Self::ConstantEnv { radiance: rgb, .. }
            | Self::CapEnv { radiance: rgb, .. }
            | Self::Rectangle { radiance: rgb, .. }
            | Self::Sphere { radiance: rgb, .. } => Some(rgb),
            Self::Environment(_) => None,
        }
    }

    /// The same to look at; 1 for a map.
    pub fn brightness(&self) -> [f32; 3] {
        self.clone().brightness_mut().map_or([1.0; 3], |rgb| *rgb)
    }

    /// Whether the body shadows it.
    pub fn shadow_mut(&mut self) -> &mut bool {
        match self {
            Self::Directional { shadow, .. }
            | Self::Point { shadow, .. }
            | Self::Spot { shadow, .. }
            | Self::ConstantEnv { shadow, .. }
            | Self::CapEnv { shadow, .. }
            | Self::Rectangle { shadow, .. }
            | Self::Sphere { shadow, .. } => shadow,
            Self::Environment(environment) => &mut environment.shadow,
        }
    }

    /// Takes the file it names, if it names one, from this directory.
    pub fn find(&mut self, directory: &Path) {
        if let Self::Environment(environment) = self {
            environment.file = directory.join(&environment.file);
        }
    }

    /// As the reference takes it, in millimetres.
    pub fn twins(
        &self,
        just_below_y0: f32,
        mm_per_unit: f64,
    ) -> Result<Vec<translume_reference::Light>, Error> {
        if let Self::Environment(environment) = self {
            return Ok(vec![environment.twin()?]);
        }
        let lights = self.lights(just_below_y0)?;
        Ok(lights.iter().filter_map(|light| translume_twin::light(light, mm_per_unit)).collect())
    }

    /// As the library takes it: an environment may become several. `just_below_y0` is the height that still counts as the face y = 0.
    pub fn lights(&self, just_below_y0: f32) -> Result<Vec<Light>, Error> {
        let region = |lit: &Option<LitRegion>| lit.as_ref().map(|lit| lit.region(just_below_y0));
        let light = match self {
            Self::Directional { to_light, irradiance, shadow, lit_region } => {
                Light::Directional(DirectionalLight {
                    to_light: *to_light,
                    irradiance: *irradiance,
                    shadow: *shadow,
                    region: region(lit_region),
                })
            }
            Self::Point { position, intensity, shadow, lit_region } => Light::Point(PointLight {
                position: *position,
                intensity: *intensity,
                shadow: *shadow,
                region: region(lit_region),
            }),
            Self::Spot {
                position,
                direction,
                intensity,
                inner_angle_deg,
                outer_angle_deg,
                shadow,
                lit_region,
            } => Light::Spot(SpotLight {
                position: *position,
                direction: *direction,
                intensity: *intensity,
                inner_angle: inner_angle_deg.to_radians(),
                outer_angle: outer_angle_deg.to_radians(),
                shadow: *shadow,
                region: region(lit_region),
            }),
            Self::Rectangle { center, half_right, half_up, radiance, shadow } => {
                Light::Rectangle(RectangleLight {
                    center: *center,
                    half_right: *half_right,
                    half_up: *half_up,
                    radiance: *radiance,
                    shadow: *shadow,
                })
            }
            Self::Sphere { center, radius, radiance, shadow } => Light::Sphere(SphereLight {
                center: *center,
                radius: *radius,
                radiance: *radiance,
                shadow: *shadow,
            }),
            Self::ConstantEnv { radiance, shadow } => {
                Light::Ambient(AmbientLight { radiance: *radiance, shadow: *shadow, ..Default::default() })
            }
            Self::CapEnv { radiance, axis, half_angle_deg, shadow } => Light::Ambient(AmbientLight {
                radiance: *radiance,
                axis: *axis,
                half_angle: half_angle_deg.to_radians(),
                shadow: *shadow,
            }),
            Self::Environment(environment) => return environment.lights(),
        };
        Ok(vec![light])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lit_region_cuts_one_axis_and_the_face() {
        let region = LitRegion { axis: Axis::X, min: 2.0, note: String::new() }.region(-0.1);
        assert_eq!((region.low[0], region.low[1]), (2.0, -0.1));
        assert_eq!(region.low[2], f32::MIN);
    }

    #[test]
    fn skies_are_shadowed_unless_told_otherwise() {
        let shadow = |text: &str| {
            let light: SceneLight = serde_json::from_str(text).unwrap();
            match light.lights(0.0).unwrap()[..] {
                [Light::Ambient(sky)] => sky.shadow,
                ref other => panic!("{other:?}"),
            }
        };
        assert!(shadow(r#"{ "type": "constant_env", "radiance": [1, 1, 1] }"#));
        assert!(!shadow(r#"{ "type": "constant_env", "radiance": [1, 1, 1], "shadow": false }"#));
        let cap = r#"{ "type": "cap_env", "radiance": [1, 1, 1], "axis": [0, 1, 0], "half_angle_deg": 9"#;
        assert!(shadow(&format!("{cap} }}")) && !shadow(&format!(r#"{cap}, "shadow": false }}"#)));
    }

    #[test]
    fn an_environment_is_found_beside_its_scene() {
        let mut light: SceneLight =
            serde_json::from_str(r#"{ "type": "environment", "file": "sky.exr" }"#).unwrap();
        light.find(Path::new("/scenes"));
        let SceneLight::Environment(sky) = light else { panic!("{light:?}") };
        assert_eq!(sky.file, Path::new("/scenes/sky.exr"));
        assert_eq!((sky.scale, sky.rotation_deg, sky.split, sky.shadow), (1.0, 0.0, true, true));
        let tinted =
            serde_json::from_str::<SceneLight>(r#"{ "type": "environment", "file": "sky.exr", "tint": 1 }"#);
        assert!(tinted.unwrap_err().to_string().contains("tint"));
    }
}
