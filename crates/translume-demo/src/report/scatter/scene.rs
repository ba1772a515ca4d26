//! What is lit, and by what.

use crate::error::Error;
use crate::model;
use crate::report::scenes;
use crate::report::subject::Subject;
use std::f32::consts::FRAC_PI_2;
use translume::{DirectionalLight, Light, PointLight};
use translume_mesh::{Warp, builtin};

/// A scene of the suite, at any size of the atlas.
pub enum Kind {
    /// A model in the sun.
    Model(String),
    /// The same, its top turned by 90° against its foot.
    Twisted(String),
    /// 50 mm × 50 mm × 1 mm in the sun, and a lamp near the other side.
    Sheet,
    /// 50 mm × 50 mm × 4 mm, lit from below.
    Slab,
    /// A model with a lamp behind it.
    Behind(String),
}

/// A subject in its light; no light casts shadows.
pub struct Scene {
    pub name: String,
    pub subject: Subject,
    pub lights: Vec<Light>,
}

impl Kind {
    pub fn open(&self, size: u32) -> Result<Scene, Error> {
        let sun = Light::Directional(DirectionalLight { shadow: false, ..scenes::sun() });
        Ok(match self {
            Self::Model(name) => {
                let subject = Subject::open(name, size)?;
                Scene { name: subject.name.clone(), subject, lights: vec![sun] }
            }
            Self::Twisted(name) => {
                let mut subject = Subject::open(name, size)?;
                subject.warp = Warp { twist: FRAC_PI_2, ..Warp::default() };
                Scene { name: format!("{} twisted", subject.name), subject, lights: vec![sun] }
            }
            Self::Sheet => {
                let lights = vec![sun, lamp([8.0, -6.0, -5.0], 40.0)];
                Scene { name: "sheet".to_owned(), subject: plate(1.0, size)?, lights }
            }
            Self::Slab => {
                let lights = vec![lamp([0.0, -15.0, 0.0], 225.0)];
                Scene { name: "slab from behind".to_owned(), subject: plate(4.0, size)?, lights }
            }
            Self::Behind(name) => {
                let subject = Subject::open(name, size)?;
                let place = subject.place([-0.3, 0.4, -1.0], 0.9).to_array();
                let lights = vec![lamp(place, subject.diagonal.powi(2))];
                Scene { name: format!("{} from behind", subject.name), subject, lights }
            }
        })
    }
}

fn lamp(position: [f32; 3], intensity: f32) -> Light {
    Light::Point(PointLight { position, intensity: [intensity; 3], shadow: false, ..Default::default() })
}

/// A square plate around the origin, 50 mm wide; 1 unit is 1 mm.
fn plate(thickness: f32, size: u32) -> Result<Subject, Error> {
    let half = [25.0, 0.5 * thickness, 25.0];
    let mesh = builtin::cuboid(half.map(|x| -x), half, [16, 1, 16]);
    Subject::new(model::clean(mesh)?, 1.0, size)
}
