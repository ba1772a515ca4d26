//! The creature's body, part by part: where to change its looks.

use glam::{Vec2, Vec3};

use super::field::{Field, Part, Shape};

/// The creature's distance field: it sits on y = 0 and looks along +z.
pub fn creature() -> Field {
    let mut parts = Vec::new();
    parts.extend(torso());
    parts.extend(limbs());
    parts.extend(head());
    Field::new(&parts, 2.0)
}

fn torso() -> [Part; 3] {
    [
        ellipsoid([0.0, 26.0, -2.0], [23.0, 27.0, 21.0], 1.0),
        ellipsoid([0.0, 20.0, 3.0], [27.0, 21.0, 24.0], 14.0), // belly
        ellipsoid([0.0, 11.0, -26.0], [6.0, 6.0, 6.5], 6.0),   // tail
    ]
}

fn limbs() -> [Part; 4] {
    [
        pair(limb([15.0, 9.0, 10.0], [19.5, 8.0, 26.0], [9.5, 8.0], 9.0)),
        // The feet show their soles.
        pair(Part {
            turn: Vec3::new(-12.0, 16.0, 0.0),
            ..ellipsoid([20.0, 10.5, 30.0], [9.0, 11.0, 6.0], 5.0)
        }),
        pair(limb([19.0, 38.0, 6.0], [17.0, 30.0, 21.5], [6.5, 5.2], 8.0)),
        pair(ellipsoid([15.5, 29.5, 24.0], [5.8, 5.4, 5.0], 4.0)),
    ]
}

fn head() -> [Part; 9] {
    [
        ellipsoid([0.0, 59.0, 2.0], [23.5, 19.0, 20.5], 9.0),
        pair(ellipsoid([12.0, 53.5, 12.5], [9.0, 7.5, 8.0], 8.0)), // cheeks
        ellipsoid([0.0, 54.0, 19.5], [8.5, 6.0, 6.0], 6.0),        // bridge of the snout
        pair(ellipsoid([4.1, 52.2, 22.6], [5.2, 4.5, 5.0], 1.6)),  // lips
        ellipsoid([0.0, 48.4, 19.6], [4.8, 3.2, 4.6], 3.0),        // chin
        ellipsoid([0.0, 56.4, 26.6], [3.4, 2.4, 2.3], 2.0),        // nose
        pair(ellipsoid([10.5, 67.5, 16.0], [4.6, 2.6, 3.0], 8.0)), // brows
        pair(ellipsoid([11.2, 60.4, 18.4], [4.3, 5.0, 4.0], 0.9)), // eyes
        ear(),
    ]
}

/// The middle of the left ear.
const EAR: Vec3 = Vec3::new(24.0, 80.0, 0.0);

fn ear() -> Part {
    let shape = Shape::Leaf {
        half: Vec2::new(12.5, 19.0),
        taper: 0.18,
        bend: Vec2::new(0.018, -0.004),
        thickness: 2.7,
    };
    pair(Part { shape, at: EAR, turn: Vec3::new(-6.0, 12.0, -34.0), blend: 5.0, paired: false })
}

fn ellipsoid(at: [f32; 3], radii: [f32; 3], blend: f32) -> Part {
    Part {
        shape: Shape::Ellipsoid { radii: radii.into() },
        at: at.into(),
        turn: Vec3::ZERO,
        blend,
        paired: false,
    }
}

fn limb(from: [f32; 3], to: [f32; 3], ends: [f32; 2], blend: f32) -> Part {
    let shape = Shape::Limb { to: Vec3::from(to) - Vec3::from(from), ends };
    Part { shape, ..ellipsoid(from, [1.0; 3], blend) }
}

fn pair(part: Part) -> Part {
    Part { paired: true, ..part }
}
