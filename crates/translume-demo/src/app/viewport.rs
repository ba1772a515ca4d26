//! The picture, and the hands on it: the camera and the lights.

use super::ground::Grounds;
use super::loaded::Loaded;
use super::panels::Beside;
use super::{App, orbit};
use crate::scene::{Scene, SceneCamera, SceneLight};
use eframe::egui;
use egui::{Color32, Pos2, Rect, Sense, Stroke};
use glam::{Vec2, Vec3};

/// Pixels of a picture per point of the screen, at most: fewer than a dense screen has are soft, and quick.
const MOST_PIXELS: u32 = 2048;
/// Points around a handle that take hold of it.
const HANDLE: f32 = 12.0;
/// How far away from the middle the handle of a direction is, of the distance to the target.
const SUN: f32 = 0.2;

/// Where the picture is on the screen.
pub struct Viewport {
    rect: Option<Rect>,
    pixels_per_point: f32,
    /// The light in the hand, by its number.
    held: Option<usize>,
    /// What it is put onto.
    grounds: Grounds,
    /// Where the line between two pictures is, of the width.
    split: f32,
}

impl Default for Viewport {
    fn default() -> Self {
        Self { rect: None, pixels_per_point: 1.0, held: None, grounds: Grounds::default(), split: 0.5 }
    }
}

impl Viewport {
    /// Where a small window hides the least of it.
    pub fn corner(&self) -> Pos2 {
        self.rect.map_or(Pos2::ZERO, |rect| rect.left_top() + egui::Vec2::splat(8.0))
    }

    /// Width and height of the picture.
    pub fn pixels(&self) -> Option<[u32; 2]> {
        let size = self.rect?.size() * self.pixels_per_point;
        let most = size.max_elem();
        let size = if most > MOST_PIXELS as f32 { size * (MOST_PIXELS as f32 / most) } else { size };
        Some([size.x, size.y].map(|x| (x.round() as u32).max(16)))
    }
}

pub fn show(app: &mut App, ui: &mut egui::Ui) {
    egui::CentralPanel::default().frame(egui::Frame::NONE).show(ui, |ui| {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Picture"));
        (app.view.rect, app.view.pixels_per_point) = (Some(rect), ui.ctx().pixels_per_point());
        ui.painter().rect_filled(rect, 0.0, Color32::from_gray(60));
        pictures(app, ui, rect);
        if let Some(job) = &app.job {
            let share = job.share.map_or(String::new(), |share| format!(" {:.0} %", 100.0 * share));
            let words = format!("{}{share}", job.stage);
            let font = egui::FontId::proportional(16.0);
            ui.painter().text(
                rect.center_bottom() - egui::vec2(0.0, 24.0),
                egui::Align2::CENTER_BOTTOM,
                words,
                font,
                Color32::WHITE,
            );
        }
        act(app, ui, rect, &response);
    });
}

/// One picture, or two with a line between.
fn pictures(app: &mut App, ui: &mut egui::Ui, rect: Rect) {
    let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
    if let Some(picture) = &app.picture {
        ui.painter().image(picture.id(), rect, whole, Color32::WHITE);
    }
    let right = match app.beside {
        Beside::Nothing => return,
        Beside::Other(_) => &app.other,
        Beside::Paths => &app.paths,
    };
    let x = rect.left() + rect.width() * app.view.split;
    let part = Rect::from_min_max(Pos2::new(x, rect.top()), rect.max);
    if let Some(right) = right {
        ui.painter().with_clip_rect(part).image(right.id(), rect, whole, Color32::WHITE);
    }
    ui.painter().vline(x, rect.y_range(), Stroke::new(2.0, Color32::from_white_alpha(160)));
    let bar = Rect::from_center_size(Pos2::new(x, rect.center().y), egui::vec2(10.0, rect.height()));
    let hand = ui
        .interact(bar, ui.scope_id().with("split"), Sense::drag())
        .on_hover_cursor(egui::CursorIcon::ResizeHorizontal);
    // Side panels may leave no width at all.
    let moved = hand.drag_delta().x / rect.width().max(1.0);
    app.view.split = (app.view.split + moved).clamp(0.02, 0.98);
}

fn act(app: &mut App, ui: &egui::Ui, rect: Rect, response: &egui::Response) {
    let Some(camera) = app.scene.camera else { return };
    let Some(pixels) = app.view.pixels() else { return };
    let Some(loaded) = app.loaded.clone() else { return };
    let seen = app.moment(&loaded, pixels);
    let frame = orbit::Frame::of(&seen.camera.unwrap_or(camera));
    let pointer = response.interact_pointer_pos().or(response.hover_pos());
    let handles = handles(app, &frame, rect);
    // A drag is known for one after some points of way.
    if response.drag_started_by(egui::PointerButton::Primary)
        && let Some(pointer) = ui.input(|input| input.pointer.press_origin())
    {
        // A drag is one only some way from where it began.
        let near = handles.iter().filter(|handle| handle.place.distance(pointer) < HANDLE);
        let nearest = near.min_by(|a, b| a.place.distance(pointer).total_cmp(&b.place.distance(pointer)));
        app.view.held = nearest.map(|handle| handle.light);
    }
    if response.drag_stopped() {
        app.view.held = None;
        app.view.grounds.clear();
    }
    let drag = response.drag_delta();
    if drag != egui::Vec2::ZERO {
        let is_panning = response.dragged_by(egui::PointerButton::Secondary)
            || response.dragged_by(egui::PointerButton::Middle)
            || ui.input(|input| input.modifiers.shift);
        let drag = Vec2::new(drag.x, drag.y);
        match (app.view.held, &mut app.scene.camera) {
            (Some(light), _) => {
                if !put_onto(app, light, (&seen, &loaded), &frame, ui, (rect, pointer)) {
                    drag_light(app, light, &frame, drag / Vec2::new(rect.width(), rect.height()));
                }
            }
            (None, Some(camera)) if is_panning => orbit::pan(camera, drag / rect.height()),
            (None, Some(camera)) => orbit::turn(camera, drag),
            (None, None) => {}
        }
    }
    if response.hovered()
        && let Some(camera) = &mut app.scene.camera
    {
        let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        let factor = (scroll * 0.002).exp() * pinch;
        if factor != 1.0 {
            orbit::zoom(camera, factor);
        }
    }
    if response.double_clicked() {
        app.frame_all();
    }
    let is_near = |handle: &Handle| pointer.is_some_and(|pointer| handle.place.distance(pointer) < HANDLE);
    if response.hovered() || app.view.held.is_some() {
        for handle in &handles {
            let held = app.view.held == Some(handle.light) || app.view.held.is_none() && is_near(handle);
            paint(ui, handle, held);
        }
    }
}

/// A light to take hold of.
struct Handle {
    light: usize,
    place: Pos2,
    colour: Color32,
}

fn handles(app: &App, frame: &orbit::Frame, rect: Rect) -> Vec<Handle> {
    let lights = app.scene.lights.iter().flatten().enumerate();
    let handle = |(light, scene_light): (usize, &SceneLight)| {
        let camera = app.scene.camera.as_ref()?;
        let (place, _) = frame.project(spot(scene_light, camera)?)?;
        let place = rect.lerp_inside(egui::vec2(place.x, place.y));
        rect.contains(place).then(|| Handle { light, place, colour: colour(scene_light.brightness()) })
    };
    lights.filter_map(handle).collect()
}

/// Where a light's handle is: a direction's lies that way from what is looked at.
fn spot(light: &SceneLight, camera: &SceneCamera) -> Option<Vec3> {
    let target = Vec3::from(camera.target);
    let reach = SUN * Vec3::from(camera.eye).distance(target);
    match light {
        SceneLight::Point { position, .. } | SceneLight::Spot { position, .. } => Some((*position).into()),
        SceneLight::Rectangle { center, .. } | SceneLight::Sphere { center, .. } => Some((*center).into()),
        SceneLight::Directional { to_light, .. } => {
            Some(target + Vec3::from(*to_light).normalize_or(Vec3::Y) * reach)
        }
        SceneLight::CapEnv { axis, .. } => Some(target + Vec3::from(*axis).normalize_or(Vec3::Y) * reach),
        SceneLight::ConstantEnv { .. } | SceneLight::Environment(_) => None,
    }
}

/// Onto the surface under the mouse, if that is asked for and known yet.
fn put_onto(
    app: &mut App,
    light: usize,
    (seen, loaded): (&Scene, &Loaded),
    frame: &orbit::Frame,
    ui: &egui::Ui,
    (rect, pointer): (Rect, Option<Pos2>),
) -> bool {
    let is_asked = ui.input(|input| input.modifiers.command || input.modifiers.ctrl);
    let (true, Some(pointer)) = (is_asked, pointer) else { return false };
    let Some(ground) = app.view.grounds.of(seen, loaded, ui.ctx()) else { return false };
    let place = (pointer - rect.min) / rect.size();
    let point = frame.point(Vec2::new(place.x, place.y), frame.distance);
    if let Some(light) = app.scene.lights.as_mut().and_then(|lights| lights.get_mut(light)) {
        ground.put(light, frame.eye, point - frame.eye);
    }
    true
}

/// By so much of the picture, at the depth where it is; a direction turns.
fn drag_light(app: &mut App, light: usize, frame: &orbit::Frame, drag: Vec2) {
    let Some(camera) = app.scene.camera else { return };
    let Some(light) = app.scene.lights.as_mut().and_then(|lights| lights.get_mut(light)) else { return };
    let Some((place, depth)) = spot(light, &camera).and_then(|spot| frame.project(spot)) else { return };
    let moved = frame.point(place + drag, depth);
    let target = Vec3::from(camera.target);
    match light {
        SceneLight::Point { position, .. } | SceneLight::Spot { position, .. } => {
            *position = moved.to_array();
        }
        SceneLight::Rectangle { center, .. } | SceneLight::Sphere { center, .. } => {
            *center = moved.to_array();
        }
        SceneLight::Directional { to_light: direction, .. } | SceneLight::CapEnv { axis: direction, .. } => {
            *direction = (moved - target).normalize_or(Vec3::Y).to_array();
        }
        SceneLight::ConstantEnv { .. } | SceneLight::Environment(_) => {}
    }
}

/// As bright as a screen is, whatever the light's power.
fn colour(rgb: [f32; 3]) -> Color32 {
    let most = rgb.into_iter().fold(0.0, f32::max).max(f32::MIN_POSITIVE);
    let [r, g, b] = rgb.map(|c| c / most);
    egui::Rgba::from_rgb(r, g, b).into()
}

fn paint(ui: &egui::Ui, handle: &Handle, held: bool) {
    let radius = if held { 8.0 } else { 5.0 };
    ui.painter().circle(
        handle.place,
        radius,
        handle.colour,
        Stroke::new(1.5, Color32::from_black_alpha(160)),
    );
}
