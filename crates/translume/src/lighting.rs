//! The lights of a frame, translated into what WGSL reads.

use crate::boundary::Boundary;
use crate::layout::{
    AmbientLayout, GatherLayout, LightLayout, MAX_EMITTERS, MAX_VIEWS, NO_SHADOW, ShadowViewLayout, SkyLayout,
};
use crate::shadow_view::{self, LightViews, Subject, View};
use crate::stages::gather::Kinds;
use crate::{AmbientLight, EnvironmentLight, Error, Light, ShadowOptions, light};
use glam::Vec3;

/// What the gather needs of a body beside the lights.
pub(crate) struct GatherBody<'a> {
    pub texels: u32,
    pub flat_normals: bool,
    pub boundary: Boundary,
    pub winding: f32,
    pub mm_per_unit: f32,
    pub subject: &'a Subject<'a>,
    pub shadows: &'a ShadowOptions,
    /// Where the sky is looked at.
    pub directions: &'a [Vec3],
}

/// Uniforms, the views they refer to, and how many layers of depth maps those fill.
pub(crate) struct Gathering {
    pub layout: Box<GatherLayout>,
    pub views: Vec<View>,
    pub layers: u32,
    /// Index of the light that each view belongs to.
    pub owners: Vec<usize>,
}

/// Whether a light is shadowed by what is known of the sky.
fn is_shadowed_sky(light: &Light, options: &ShadowOptions) -> bool {
    match light {
        Light::Ambient(light) => light.shadow && !light.is_shadowed_by_points(options),
        Light::Environment(light) => light.shadow,
        _ => false,
    }
}

/// Whether some light is.
pub(crate) fn has_shadowed_sky(lights: &[Light], options: &ShadowOptions) -> bool {
    lights.iter().any(|light| is_shadowed_sky(light, options))
}

/// What the gather's pipeline has to contain.
pub(crate) fn kinds(lights: &[Light], options: &ShadowOptions) -> Kinds {
    let area = |light: &Light| match light {
        Light::Rectangle(_) | Light::Sphere(_) => true,
        Light::Ambient(light) => light.is_shadowed_by_points(options),
        _ => false,
    };
    Kinds { area_lights: lights.iter().any(area), shadowed_sky: has_shadowed_sky(lights, options) }
}

pub(crate) fn gather(lights: &[Light], body: &GatherBody<'_>) -> Result<Gathering, Error> {
    let mut layout: Box<GatherLayout> = bytemuck::zeroed_box();
    layout.texel_count = body.texels;
    layout.flat_normals = u32::from(body.flat_normals);
    layout.eta = body.boundary.eta;
    layout.slant = body.boundary.slant;
    layout.on_surface = body.boundary.on_surface.into();
    layout.winding = body.winding;
    layout.filter_side = body.shadows.filter;
    let (mut views, mut owners, mut emitters) = (Vec::new(), Vec::new(), 0);
    for (index, light) in lights.iter().enumerate() {
        let own = shadow_view::light_views(light, body.mm_per_unit, body.subject, body.shadows);
        check_room(emitters + own.emitters.len(), views.len() + own.views.len())?;
        for (slot, point) in layout.emitters[emitters..].iter_mut().zip(&own.emitters) {
            *slot = point.to_array();
        }
        match light {
            Light::Ambient(ambient) => {
                let slot = &mut layout.ambients[layout.ambient_count as usize];
                *slot = ambient_layout(ambient, &body.boundary, &own, views.len(), emitters);
                layout.ambient_count += 1;
            }
            Light::Environment(_) => {}
            _ => {
                layout.lights[layout.light_count as usize] =
                    light_layout(light, body.mm_per_unit, &own, views.len(), emitters);
                layout.light_count += 1;
            }
        }
        emitters += own.emitters.len();
        owners.extend(own.views.iter().map(|_| index));
        views.extend(own.views);
    }
    let resolution = body.shadows.resolution;
    let layers = shadow_view::pack(&mut views, resolution);
    for (slot, view) in layout.views.iter_mut().zip(&views) {
        *slot = view_layout(view, resolution);
    }
    sky_layout(&mut layout, lights, body);
    Ok(Gathering { layout, views, layers, owners })
}

fn check_room(emitters: usize, views: usize) -> Result<(), Error> {
    const REMEDY: &str =
        "switch some shadows off or take fewer area_points: a light near the body takes six maps a point";
    for (what, count, limit) in
        [("points of area lights", emitters, MAX_EMITTERS), ("depth maps", views, MAX_VIEWS)]
    {
        if count > limit {
            return Err(Error::Frame {
                problem: format!("{count} {what} or more, but at most {limit} fit"),
                remedy: REMEDY,
            });
        }
    }
    Ok(())
}

/// `width` is that of the layer that holds the view's tile.
pub(crate) fn view_layout(view: &View, width: u32) -> ShadowViewLayout {
    let share = |texels: u32| texels as f32 / width as f32;
    ShadowViewLayout {
        matrix: view.matrix.to_cols_array_2d(),
        tile: [share(view.tile.x), share(view.tile.y), share(view.tile.width)],
        layer: view.tile.layer,
        texel: view.texel,
        perspective: f32::from(u8::from(view.perspective)),
        padding0: 0.0,
        padding1: 0.0,
    }
}

fn light_layout(
    light: &Light,
    scale: f32,
    own: &LightViews,
    first_view: usize,
    first_emitter: usize,
) -> LightLayout {
    let mut layout: LightLayout = bytemuck::Zeroable::zeroed();
    // Intensity over distance² in world units is intensity·scale² over distance² in millimetres.
    let in_mm = |intensity: [f32; 3]| intensity.map(|i| i * scale * scale);
    let mm = |vector: [f32; 3]| vector.map(|x| x * scale);
    // As bright in every direction, wherever the light enters.
    (layout.cone_scale, layout.cone_offset) = (0.0, 1.0);
    let mut region = None;
    (layout.kind, layout.vector, layout.colour) = match light {
        Light::Directional(light) => {
            region = light.region;
            (0, Vec3::from(light.to_light).normalize().to_array(), light.irradiance)
        }
        Light::Point(light) => {
            region = light.region;
            (1, mm(light.position), in_mm(light.intensity))
        }
        Light::Spot(light) => {
            region = light.region;
            layout.axis = Vec3::from(light.direction).normalize().to_array();
            [layout.cone_scale, layout.cone_offset] = light.falloff();
            (1, mm(light.position), in_mm(light.intensity))
        }
        Light::Rectangle(light) => {
            layout.half_right = mm(light.half_right);
            layout.half_up = mm(light.half_up);
            let across = Vec3::from(light.half_right).cross(light.half_up.into());
            layout.axis = across.normalize().to_array();
            (2, mm(light.center), light.radiance)
        }
        Light::Sphere(light) => {
            layout.half_right = [light.radius * scale, 0.0, 0.0];
            (3, mm(light.center), light.radiance)
        }
        Light::Ambient(_) | Light::Environment(_) => return layout,
    };
    // Far corners stay finite, so that infinity minus infinity never arises.
    let bound = |x: f32| (x * scale).clamp(-1e30, 1e30);
    layout.region_low = region.map_or([-1e30; 3], |region| region.low.map(bound));
    layout.region_high = region.map_or([1e30; 3], |region| region.high.map(bound));
    layout.first_view = if own.views.is_empty() { NO_SHADOW } else { first_view as u32 };
    layout.view_count = own.views_per_emitter;
    layout.first_emitter = first_emitter as u32;
    layout.emitter_count = own.emitters.len() as u32;
    layout
}

fn ambient_layout(
    ambient: &AmbientLight,
    boundary: &Boundary,
    own: &LightViews,
    first_view: usize,
    first_emitter: usize,
) -> AmbientLayout {
    let axis = Vec3::from(ambient.axis).normalize_or(Vec3::Y).to_array();
    AmbientLayout {
        radiance: ambient.radiance,
        cone_cosine: ambient.half_angle.cos(),
        axis,
        shadow: u32::from(ambient.shadow && own.emitters.is_empty()),
        table: light::ambient_table(ambient.half_angle, boundary),
        first_view: first_view as u32,
        first_emitter: first_emitter as u32,
        emitter_count: own.emitters.len() as u32,
        padding: 0,
    }
}

/// Environments add up; those that the body shadows apart from the others. Along the directions in which the shadow is known, all shadowed
/// light of the sky together.
fn sky_layout(layout: &mut GatherLayout, lights: &[Light], body: &GatherBody<'_>) {
    for light in lights {
        if let Light::Environment(environment) = light {
            let sum = if environment.shadow { &mut layout.shadowed_sky } else { &mut layout.open_sky };
            for (sum, term) in
                sum.iter_mut().flatten().zip(environment.through(&body.boundary).as_flattened())
            {
                *sum += term;
            }
        }
    }
    let shadowed: Vec<_> = lights.iter().filter(|light| is_shadowed_sky(light, body.shadows)).collect();
    if shadowed.is_empty() {
        return;
    }
    layout.direction_count = body.directions.len() as u32;
    for (slot, direction) in layout.sky.iter_mut().zip(body.directions) {
        let mut radiance = Vec3::ZERO;
        for light in &shadowed {
            radiance += match light {
                Light::Ambient(light) => cone_radiance(light, *direction, body.directions.len()),
                Light::Environment(light) => environment_radiance(light, *direction),
                _ => Vec3::ZERO,
            };
        }
        *slot = SkyLayout {
            direction: direction.to_array(),
            padding0: 0,
            radiance: radiance.to_array(),
            padding1: 0,
        };
    }
}

/// Harmonics swing below zero beside a bright place; light does not.
fn environment_radiance(light: &EnvironmentLight, direction: Vec3) -> Vec3 {
    Vec3::from(light.radiance(direction.to_array())).max(Vec3::ZERO)
}

/// A cone's edge, softened over the width of the part of the sky that one of `count` directions stands for: a narrow cone would fall
/// between them otherwise.
fn cone_radiance(light: &AmbientLight, direction: Vec3, count: usize) -> Vec3 {
    let width = (4.0 / count as f32).sqrt();
    let angle = direction.angle_between(light.axis.into());
    let share = ((light.half_angle + width - angle) / (2.0 * width)).clamp(0.0, 1.0);
    Vec3::from(light.radiance) * if light.half_angle >= std::f32::consts::PI { 1.0 } else { share }
}
