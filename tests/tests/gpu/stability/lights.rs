//! Hard cases of light.

use super::demand::Demand::{Dark, Falling, Like};
use super::scene::{Scene, USUAL};
use super::{Row, SEAMS, row};
use glam::{Mat4, Vec3};
use translume::{Light, PointLight};

fn lamp(position: [f32; 3], intensity: f32) -> Light {
    Light::Point(PointLight { position, intensity: [intensity; 3], ..Default::default() })
}

pub fn rows() -> Vec<Row> {
    let ball = || Scene::ball(USUAL);
    let near = [30.0, 60.0, 20.0];
    // 20 m away f32 rounds to 0.2 µm, a thousandth of the smallest disc.
    let far = ball()
        .lit(&[lamp([20_000.0 + near[0], near[1], near[2]], 1e3)])
        .moved(Mat4::from_translation(Vec3::new(20_000.0, 0.0, 0.0)))
        .with(|scene| {
            scene.shot.eye[0] += 20_000.0;
            scene.shot.target[0] += 20_000.0;
        });
    vec![
        row("light inside the body", ball().lit(&[lamp([1.0, 2.0, 3.0], 1e3)]), vec![Dark]),
        row("light on the surface", ball().lit(&[lamp([0.0, 50.0, 0.0], 1e3)]), vec![Falling]),
        row("light at zero intensity", ball().lit(&[lamp([0.0, 90.0, 0.0], 0.0)]), vec![Dark]),
        row("no light", ball().lit(&[]), vec![Dark]),
        row("light 10²⁰ times as bright", ball().lit(&[lamp(near, 1e23)]), vec![Falling]).excess(SEAMS),
        row(
            "light near the body",
            ball().lit(&[lamp(near, 1e3)]),
            vec![
                Falling,
                Like("as 200 diameters from the origin", Box::new(far), 0.01),
                Like("as two lights of half its power", Box::new(ball().lit(&[lamp(near, 500.0); 2])), 1e-3),
            ],
        )
        .excess(SEAMS),
    ]
}
