use super::*;
use crate::{DirectionalLight, PointLight, RectangleLight, SphereLight};

fn unit_box() -> [Vec3; 8] {
    std::array::from_fn(|k| Vec3::new((k & 1) as f32, (k >> 1 & 1) as f32, (k >> 2) as f32) * 2.0 - 1.0)
}

fn views(light: &Light) -> Vec<View> {
    let corners = unit_box();
    light_views(light, 1.0, &Subject { corners: &corners, casters: None }, &ShadowOptions::default()).views
}

fn holds(view: &View, point: Vec3) -> bool {
    let ndc = view.matrix.project_point3(point);
    ndc.x.abs() <= 1.0 && ndc.y.abs() <= 1.0 && (0.0..=1.0).contains(&ndc.z)
}

#[test]
fn every_corner_is_inside_the_map() {
    for direction in [[0.0, 1.0, 0.0], [1.0, 2.0, -3.0], [0.0, 0.0, -1.0]] {
        let light = Light::Directional(DirectionalLight { to_light: direction, ..Default::default() });
        let views = views(&light);
        assert_eq!(views.len(), 1);
        assert!(unit_box().iter().all(|corner| holds(&views[0], *corner)), "{direction:?}");
        assert!(!holds(&views[0], Vec3::splat(3.0)), "a map that holds everything resolves nothing");
    }
}

#[test]
fn nearer_is_deeper_in_the_other_direction() {
    let light = Light::Point(PointLight { position: [0.0, 9.0, 0.0], ..Default::default() });
    let depth = |y| views(&light)[0].matrix.project_point3(Vec3::new(0.0, y, 0.0)).z;
    assert!(depth(1.0) > depth(0.0) && depth(0.0) > depth(-1.0));
}

#[test]
fn a_near_point_light_looks_all_around() {
    let at = |position| Light::Point(PointLight { position, ..Default::default() });
    let far = views(&at([0.0, 9.0, 0.0]));
    assert_eq!(far.len(), 1);
    assert!(unit_box().iter().all(|corner| holds(&far[0], *corner)));
    for position in [[0.0; 3], [0.0, 1.0, 0.0], [0.9, 0.2, -0.4]] {
        let near = views(&at(position));
        assert_eq!(near.len(), 6);
        for corner in unit_box() {
            assert!(near.iter().any(|view| holds(view, corner)), "{position:?} misses {corner}");
        }
    }
}

#[test]
fn every_point_of_an_area_light_sees_the_body() {
    let window = RectangleLight { center: [0.0, 0.0, -9.0], ..Default::default() };
    let bulb = SphereLight { center: [5.0, 5.0, 5.0], ..Default::default() };
    for (light, count) in [(Light::Rectangle(window), 16), (Light::Sphere(bulb), 16)] {
        let views = views(&light);
        assert_eq!(views.len(), count);
        assert!(views.iter().all(|view| unit_box().iter().all(|corner| holds(view, *corner))));
    }
    let inside = Light::Sphere(SphereLight { radius: 0.5, ..Default::default() });
    assert_eq!(views(&inside).len(), 16 * 6);
}

#[test]
fn a_light_without_shadow_needs_no_map() {
    assert!(views(&Light::Point(PointLight { shadow: false, ..Default::default() })).is_empty());
    assert!(views(&Light::Sphere(SphereLight { shadow: false, ..Default::default() })).is_empty());
}

#[test]
fn casters_lie_in_front_of_the_far_plane() {
    let (corners, beam) = (unit_box(), Light::Directional(DirectionalLight::default()));
    let roof = unit_box().map(|corner| corner + Vec3::new(0.0, 40.0, 0.0));
    let view = |casters| {
        let subject = Subject { corners: &corners, casters };
        light_views(&beam, 1.0, &subject, &ShadowOptions::default()).views[0]
    };
    assert!(roof.iter().all(|corner| holds(&view(Some(&roof)), *corner)));
    assert!(!roof.iter().any(|corner| holds(&view(None), *corner)));
}

/// A morph target may gather a body in one point, even in that where the light is.
#[test]
fn a_body_without_extent_has_finite_views() {
    let corners = [Vec3::new(1.0, 2.0, 3.0); 8];
    let subject = Subject { corners: &corners, casters: None };
    let options = ShadowOptions::default();
    let beam = Light::Directional(DirectionalLight::default());
    let point = |position| Light::Point(PointLight { position, ..Default::default() });
    for light in [beam, point([1.0, 9.0, 3.0]), point([1.0, 2.0, 3.0])] {
        let views = light_views(&light, 1.0, &subject, &options).views;
        assert!(!views.is_empty() && views.iter().all(|view| view.matrix.is_finite()), "{light:?}");
    }
}

/// Mixed widths fill layers without gap or overlap.
#[test]
fn tiles_share_layers() {
    let plain = views(&Light::Directional(DirectionalLight::default()))[0];
    let shifts = [2, 0, 2, 1, 2, 4, 2, 1, 0];
    let mut views: Vec<_> = shifts.iter().map(|&shift| View { shift, ..plain }).collect();
    // 2 whole layers, 2 quarters, 4 sixteenths and one of 1/256: three layers.
    assert_eq!(pack(&mut views, 256), 3);
    let mut taken = vec![false; 3 * 256 * 256];
    for (view, shift) in views.iter().zip(shifts) {
        let Tile { layer, x, y, width } = view.tile;
        assert_eq!(width, 256 >> shift);
        for row in y..y + width {
            for column in x..x + width {
                let texel = &mut taken[((layer * 256 + row) * 256 + column) as usize];
                assert!(!std::mem::replace(texel, true), "two views share a texel");
            }
        }
    }
}
