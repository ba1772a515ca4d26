//! A window that is not on a screen, and hands for it.

use super::super::App;
use super::super::order::FINE;
use eframe::egui;
use egui::accesskit::Role;
use egui::{Key, Modifiers, Pos2, Rect, TextureId, Vec2};
use egui_kittest::kittest::Queryable as _;
use egui_kittest::wgpu::WgpuTestRenderer;
use egui_kittest::{Harness, Node, TestRenderer};
use std::cell::RefCell;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;
use std::time::{Duration, Instant};
use translume_mesh::{Mesh, builtin};

/// What is waited for at most: a machine that builds beside the tests is slow.
pub(super) const PATIENCE: Duration = Duration::from_secs(240);
/// Between looks at what the other threads have done.
const NAP: Duration = Duration::from_millis(2);

/// Every texture as it was last set.
type Textures = Rc<RefCell<HashMap<TextureId, Arc<egui::ColorImage>>>>;

/// Keeps what is shown, so that pictures can be looked at without being drawn into a window first.
struct Recorder {
    textures: Textures,
    /// For tests that look at the whole window.
    painter: Option<WgpuTestRenderer>,
}

impl TestRenderer for Recorder {
    fn handle_delta(&mut self, delta: &mut egui::TexturesDelta) {
        let mut textures = self.textures.borrow_mut();
        for (id, images) in &delta.set {
            for image in images.iter().filter(|image| image.is_whole()) {
                let egui::ImageData::Color(image) = &image.image;
                textures.insert(*id, Arc::clone(image));
            }
        }
        for id in &delta.free {
            textures.remove(id);
        }
        match &mut self.painter {
            Some(painter) => painter.handle_delta(delta),
            None => delta.clear(),
        }
    }

    fn render(
        &mut self,
        context: &egui::Context,
        output: &egui::FullOutput,
    ) -> Result<image::RgbaImage, String> {
        self.painter.as_mut().ok_or("made without a painter")?.render(context, output)
    }
}

pub struct Window {
    pub harness: Harness<'static, App>,
    textures: Textures,
    desk: tempfile::TempDir,
}

/// How a window is made.
pub struct Setup {
    pub size: [f32; 2],
    pub pixels_per_point: f32,
    pub theme: egui::Theme,
    pub paints: bool,
    /// Seconds from step to step.
    pub step: f32,
    /// Whether letters may be shown that no font has.
    pub allows_tofu: bool,
}

impl Default for Setup {
    fn default() -> Self {
        let (size, theme) = ([900.0, 600.0], egui::Theme::Dark);
        Self { size, pixels_per_point: 1.0, theme, paints: false, step: 1.0 / 30.0, allows_tofu: false }
    }
}

/// A sphere of 320 triangles with so little asked of it that a picture takes some milliseconds.
pub const SPHERE: &str = r#"{
    "shape": { "type": "mesh", "file": "sphere.obj" }, "mm_per_unit": 1, "medium": "wax",
    "quality": { "transport": "classic", "atlas": 64, "shadow": 256, "directions": 8 },
    "lights": [
        { "type": "point", "position": [10, 22, 40], "intensity": [3000, 3000, 3000] },
        { "type": "constant_env", "radiance": [0.2, 0.2, 0.2], "shadow": false }
    ]
}"#;

/// One that has somewhere to go.
pub fn melting() -> String {
    SPHERE.replace(r#""medium""#, r#""into": "egg", "warp": { "twist_deg": 20 }, "medium""#)
}

impl Window {
    /// The sphere, standing still, with its first fine picture.
    pub fn sphere() -> Self {
        Self::with(&Setup::default(), SPHERE)
    }

    pub fn with(setup: &Setup, scene: &str) -> Self {
        let mut window = Self::bare(setup, scene);
        window.settle();
        window
    }

    /// A window that has just been opened on a scene, or on a built-in.
    pub fn bare(setup: &Setup, scene: &str) -> Self {
        let desk = tempfile::tempdir().unwrap();
        let [mesh, path] = ["sphere.obj", "scene.json"].map(|name| desk.path().join(name));
        std::fs::write(mesh, obj(&builtin::sphere([0.0; 3], 20.0, 2))).unwrap();
        std::fs::write(&path, scene).unwrap();
        let name = if scene.contains('{') { path.to_str().unwrap() } else { scene };
        let textures = Textures::default();
        let painter = setup.paints.then(WgpuTestRenderer::new);
        let builder = Harness::builder();
        let builder = if setup.allows_tofu { builder.allow_missing_glyphs() } else { builder };
        let harness = builder
            .with_size(setup.size)
            .with_pixels_per_point(setup.pixels_per_point)
            .with_theme(setup.theme)
            .with_step_dt(setup.step)
            .with_render_cursor(false)
            .renderer(Recorder { textures: Rc::clone(&textures), painter })
            .build_eframe(|context| {
                let mut app = App::new(context, Some(name));
                app.playback.playing = false;
                app
            });
        Self { harness, textures, desk }
    }

    pub fn app(&self) -> &App {
        self.harness.state()
    }

    pub fn app_mut(&mut self) -> &mut App {
        self.harness.state_mut()
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.desk.path().join(name)
    }

    pub fn file(&self, name: &str, text: &str) -> PathBuf {
        std::fs::write(self.path(name), text).unwrap();
        self.path(name)
    }

    /// Steps until something is so.
    pub fn until(&mut self, what: &str, is_so: impl Fn(&App) -> bool) {
        let start = Instant::now();
        while !is_so(self.app()) {
            let troubles = &self.app().troubles;
            assert!(start.elapsed() < PATIENCE, "{what} has not come; troubles: {troubles:?}");
            self.harness.step();
            std::thread::sleep(NAP);
        }
    }

    /// Until the picture is of what is set, and fine.
    pub fn settle(&mut self) {
        self.harness.step();
        self.until("a fine picture of what is set", |app| {
            let (Some(loaded), Some(pixels), Some(wish)) = (&app.loaded, app.view.pixels(), &app.ordered)
            else {
                return false;
            };
            let fits = wish.pixels == pixels && wish.scene == app.moment(loaded, pixels);
            app.job.is_none() && !app.is_waiting && wish.samples == FINE && fits
        });
    }

    /// Until the picture differs so much from another.
    pub fn until_unlike(&mut self, other: &egui::ColorImage, least: f64) {
        let start = Instant::now();
        while difference(&self.picture(), other) <= least {
            assert!(start.elapsed() < PATIENCE, "the picture stays as it was");
            self.harness.step();
            std::thread::sleep(NAP);
        }
    }

    fn texture(&self, texture: Option<&egui::TextureHandle>) -> Option<Arc<egui::ColorImage>> {
        self.textures.borrow().get(&texture?.id()).cloned()
    }

    pub fn picture(&self) -> Arc<egui::ColorImage> {
        self.texture(self.app().picture.as_ref()).expect("a picture")
    }

    pub fn other(&self) -> Option<Arc<egui::ColorImage>> {
        self.texture(self.app().other.as_ref())
    }

    pub fn paths(&self) -> Option<Arc<egui::ColorImage>> {
        self.texture(self.app().paths.as_ref())
    }

    pub fn atlas(&self) -> Option<Arc<egui::ColorImage>> {
        self.texture(self.app().atlas.as_ref())
    }

    /// Where the picture is.
    pub fn view(&self) -> Rect {
        self.harness.get_by_label("Picture").rect()
    }

    pub fn says(&self, words: &str) -> bool {
        self.harness.query_all_by_label_contains(words).next().is_some()
    }

    /// Brings something into sight and clicks it.
    pub fn click(&mut self, label: &'static str) {
        self.press(|harness| harness.get_by_label(label));
    }

    pub fn click_role(&mut self, role: Role, label: &'static str) {
        self.press(|harness| harness.get_by_role_and_label(role, label));
    }

    /// What is in a menu comes before what is in a panel and has the same name.
    pub fn click_first(&mut self, label: &'static str) {
        self.press(|harness| harness.get_all_by_label(label).next().expect("found one at least"));
    }

    fn press(&mut self, find: impl for<'a> Fn(&'a Harness<'static, App>) -> Node<'a>) {
        find(&self.harness).scroll_to_me();
        // What scrolls takes some steps to come to rest.
        let mut rests = 0;
        let mut place = Rect::NOTHING;
        while rests < 3 {
            self.harness.step();
            let now = find(&self.harness).rect();
            rests = if now == place { rests + 1 } else { 0 };
            place = now;
        }
        find(&self.harness).click();
        self.harness.run_steps(2);
    }

    /// A name from a drop-down list.
    pub fn choose(&mut self, list: &'static str, name: &'static str) {
        self.click_role(Role::ComboBox, list);
        self.click_first(name);
    }

    /// Sets a slider as a screen reader would.
    pub fn slide(&mut self, label: &'static str, value: f64) {
        self.harness.get_by_role_and_label(Role::Slider, label).set_value_accesskit(value);
        self.harness.run_steps(2);
    }

    /// With the left button, in steps.
    pub fn drag(&mut self, from: Pos2, by: Vec2) {
        self.harness.hover_at(from);
        self.harness.drag_at(from);
        for k in 1..=4 {
            self.harness.hover_at(from + by * (k as f32 / 4.0));
        }
        self.harness.drop_at(from + by);
        self.harness.step();
    }

    pub fn key(&mut self, modifiers: Modifiers, key: Key) {
        self.harness.key_press_modifiers(modifiers, key);
        self.harness.step();
    }

    pub fn wheel(&mut self, at: Pos2, points: f32) {
        self.harness.hover_at(at);
        self.harness.event(egui::Event::MouseWheel {
            unit: egui::MouseWheelUnit::Point,
            delta: Vec2::new(0.0, points),
            phase: egui::TouchPhase::Move,
            source: egui::MouseWheelSource::Wheel,
            modifiers: Modifiers::NONE,
        });
        self.harness.run_steps(10);
    }

    pub fn drop_file(&mut self, path: &Path) {
        let file: egui::DroppedFileHandle = Arc::new(Dropped(path.to_owned()));
        self.harness.input_mut().dropped_files.push(file);
        self.harness.step();
    }
}

#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        Err("is opened by its path".to_owned())
    }
}

/// A mesh as an OBJ file.
pub fn obj(mesh: &Mesh) -> String {
    let corner = |k: &u32| (k + 1).to_string();
    let vertices = mesh.positions.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n"));
    let faces = mesh
        .triangles
        .iter()
        .map(|triangle| format!("f {}\n", triangle.iter().map(corner).collect::<Vec<_>>().join(" ")));
    vertices.chain(faces).collect()
}

/// Mean absolute difference of two pictures, in steps of 8 bits; without bound where their sizes differ, as on a slow machine while something moves.
pub fn difference(one: &egui::ColorImage, other: &egui::ColorImage) -> f64 {
    if one.size != other.size {
        return f64::INFINITY;
    }
    let pairs = one.pixels.iter().zip(&other.pixels);
    let of = |(a, b): (&egui::Color32, &egui::Color32)| -> u32 {
        (0..3).map(|k| u32::from(a[k].abs_diff(b[k]))).sum()
    };
    f64::from(pairs.map(of).sum::<u32>()) / (3 * one.pixels.len()) as f64
}

/// Mean colour of the middle ninth.
pub fn middle(picture: &egui::ColorImage) -> [f64; 3] {
    let [width, height] = picture.size;
    let pixels = (height / 3..2 * height / 3).flat_map(|y| (width / 3..2 * width / 3).map(move |x| (x, y)));
    let mut sum = [0.0; 3];
    let mut count = 0.0;
    for (x, y) in pixels {
        let pixel = picture.pixels[y * width + x];
        sum = std::array::from_fn(|k| sum[k] + f64::from(pixel[k]));
        count += 1.0;
    }
    sum.map(|c| c / count)
}
