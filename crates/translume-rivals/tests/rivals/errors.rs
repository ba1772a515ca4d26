//! What is refused, and in which words.

use crate::scene::{Scene, before_camera, default_rivals, sun, wall};
use translume::{AmbientLight, Camera, DirectionalLight, Light, Medium, PointLight};
use translume_rivals::{Frame, Geometry, Renderer, Rival, ScreenSpace, TranslucentShadowMap};
use translume_tests::gpu;

fn scene() -> Scene {
    before_camera(wall(), Medium::SKIN1, Light::Directional(sun([0.0, 0.0, 1.0])), 16, 0.1)
}

/// What a renderer says of a scene after `change`.
fn refusal(rival: Rival, change: impl FnOnce(&mut Scene)) -> String {
    let mut scene = scene();
    change(&mut scene);
    let mut renderer = Renderer::new(&gpu().device, rival, [16; 2]).unwrap();
    renderer.prepare(&gpu().queue, &scene.frame()).map_or_else(|error| error.to_string(), |()| String::new())
}

#[test]
fn settings_are_checked() {
    let maps = TranslucentShadowMap::default();
    let screen = ScreenSpace::default();
    let wrong = [
        (Rival::TranslucentShadowMap(TranslucentShadowMap { rings: 0, ..maps }), "rings is 0"),
        (Rival::TranslucentShadowMap(TranslucentShadowMap { spokes: 65, ..maps }), "spokes is 65"),
        (Rival::TranslucentShadowMap(TranslucentShadowMap { map: 500, ..maps }), "a power of two"),
        (Rival::ScreenSpace(ScreenSpace { samples: 0, ..screen }), "samples is 0"),
        (Rival::ScreenSpace(ScreenSpace { map: 8, ..screen }), "map is 8"),
    ];
    for (rival, words) in wrong {
        let message = Renderer::new(&gpu().device, rival, [16; 2]).err().unwrap().to_string();
        assert!(message.contains(words), "{message}");
    }
    let message = Renderer::new(&gpu().device, default_rivals()[0], [16, 0]).err().unwrap().to_string();
    assert!(message.contains("height is 0"), "{message}");
}

#[test]
fn frames_are_checked() {
    let [maps, screen] = default_rivals();
    for rival in [maps, screen] {
        assert_eq!(refusal(rival, |_| ()), "");
        let lights = |lights: Vec<Light>| refusal(rival, |scene| scene.lights = lights);
        assert!(lights(vec![Light::Ambient(AmbientLight::default())]).contains("light 0 is neither"));
        let near = PointLight { position: [0.0, 0.0, 10.0], ..Default::default() };
        assert!(lights(vec![scene().lights[0], Light::Point(near)]).contains("light 1 is so near"));
        let dark = DirectionalLight { irradiance: [f32::NAN; 3], ..Default::default() };
        assert!(lights(vec![Light::Directional(dark)]).contains("light 0 has a colour"));
        let aimless = DirectionalLight { to_light: [0.0; 3], ..Default::default() };
        assert!(lights(vec![Light::Directional(aimless)]).contains("light 0 has no direction"));
        assert!(lights(scene().lights.repeat(5)).contains("5 lights"));
        let opaque = refusal(rival, |scene| scene.medium.ior = 0.0);
        assert!(opaque.contains("ior"), "{opaque}");
        let empty = refusal(rival, |scene| scene.mesh.positions.clear());
        assert!(empty.contains("bounds"), "{empty}");
        let mut renderer = Renderer::new(&gpu().device, rival, [16; 2]).unwrap();
        let scene = scene();
        let mut message = |frame| renderer.prepare(&gpu().queue, &frame).unwrap_err().to_string();
        let nothing = message(Frame { mm_per_unit: 0.0, ..scene.frame() });
        assert!(nothing.contains("a unit is no length"), "{nothing}");
        let flat = Camera { view_projection: glam::Mat4::IDENTITY.to_cols_array_2d(), eye: [0.0; 3] };
        let flat = message(Frame { camera: flat, ..scene.frame() });
        assert!(flat.contains("no perspective"), "{flat}");
    }
    let open = DirectionalLight { shadow: false, ..sun([0.0, 0.0, 1.0]) };
    let change = |scene: &mut Scene| scene.lights = vec![Light::Directional(open)];
    assert!(refusal(maps, change).contains("light 0 casts no shadow"));
    assert_eq!(refusal(screen, change), "");
}

#[test]
fn meshes_are_checked() {
    let (device, queue) = (&gpu().device, &gpu().queue);
    let message = Geometry::new(device, queue, 3, &[[0, 1, 2], [0, 1, 3]]).err().unwrap().to_string();
    assert!(message.contains("triangle 1 [0, 1, 3]"), "{message}");
    let geometry = Geometry::new(device, queue, 3, &[[0, 1, 2]]).unwrap();
    let message = geometry.write(queue, &[[0.0; 4]; 3], &[[0.0; 4]; 2]).unwrap_err().to_string();
    assert!(message.contains("2 vertices now and had 3"), "{message}");
}
