//! Across the edge of a lit half, on a block too thick to shine through.

use crate::scene::{Scene, before_camera, burley, error, sun};
use translume::{DirectionalLight, Light, Medium, Region};
use translume_mesh::builtin;
use translume_rivals::{Rival, ScreenSpace, TranslucentShadowMap};
use translume_tests::{Check, at_most, dipoles, holds, notices};

const SIZE: u32 = 64;

/// A block whose left half is lit up to `edge` mm. 40 mm of the front fill the picture.
fn block(edge: f32) -> Scene {
    let block = builtin::cuboid([-48.0, -48.0, -96.0], [48.0, 48.0, 0.0], [8, 8, 8]);
    let region = Some(Region { low: [-1e3; 3], high: [edge, 1e3, 1e3] });
    let light = Light::Directional(DirectionalLight { region, ..sun([0.0, 0.0, 1.0]) });
    before_camera(block, Medium::SKIN1, light, SIZE, 0.2)
}

fn compare(rival: Rival, edge: f32, tolerance: f64) -> Check {
    let judge = match rival {
        // The mesh has an edge where light ends: patches as long as its triangles hold that exactly.
        Rival::TranslucentShadowMap(_) => block(0.0).judge(dipoles(&Medium::SKIN1), 8, 20.0),
        _ => block(0.0).judge(burley(&Medium::SKIN1), 8, 20.0),
    };
    let [rmse, _] = error(&block(edge).picture(rival), &judge, SIZE as usize);
    at_most(&format!("{rival:?} across an edge at {edge} mm"), rmse, tolerance)
}

#[test]
fn the_edge_of_light_has_the_shape_of_the_profile() {
    let fine = TranslucentShadowMap { rings: 10, spokes: 12, ..Default::default() };
    let maps = Rival::TranslucentShadowMap(fine);
    // A texel of the map is 0.2 mm, a mean free path 0.7 to 1.3 mm; measured 1.6 %.
    holds(compare(maps, 0.0, 0.03));
    notices(compare(maps, 1.0, 0.03));
    // A pixel is 0.6 mm, and the profile infinite in its middle; measured 0.7 %.
    let screen = Rival::ScreenSpace(ScreenSpace { samples: 500, ..Default::default() });
    holds(compare(screen, 0.0, 0.02));
    notices(compare(screen, 1.0, 0.02));
}
