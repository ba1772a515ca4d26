//! Models on their way into the window: read, repaired and unwrapped beside it.

use super::events::{Event, Events};
use super::task::Task;
use crate::error::Error;
use crate::model::Watch;
use crate::scene::{Quality, Round, Scene, SceneLight, Shape, Up};
use crate::setup::{ASSUMED_DIAGONAL_MM, DEFAULT_ROUGHNESS, Opened, VIEW, camera};
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};
use translume_mesh::{Atlas, Progress};

/// A model with its atlas.
pub struct Loaded {
    /// No two are the same.
    pub id: u64,
    pub opened: Arc<Opened>,
    pub atlas: Atlas,
    pub layout: LayoutKey,
    pub mesh: MeshKey,
}

/// What of a scene its mesh depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshKey {
    shape: Shape,
    up: Up,
    into: Option<Round>,
}

/// What of a scene the atlas depends on, besides the mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct LayoutKey {
    size: u32,
    charts: String,
    even: bool,
    finer_below: Option<f32>,
}

impl MeshKey {
    pub fn of(scene: &Scene) -> Self {
        Self { shape: scene.shape.clone(), up: scene.up, into: scene.into }
    }
}

impl LayoutKey {
    pub fn of(scene: &Scene) -> Self {
        let quality = &scene.quality;
        Self {
            size: quality.atlas,
            charts: quality.charts.clone(),
            even: quality.even,
            finer_below: quality.finer_below.map(|mm| mm / scene.mm_per_unit()),
        }
    }
}

impl Loaded {
    /// Whether a scene is made of this model.
    pub fn fits(&self, scene: &Scene) -> bool {
        self.mesh == MeshKey::of(scene) && self.layout == LayoutKey::of(scene)
    }
}

/// A scene to open.
#[derive(Clone)]
pub struct Wanted {
    pub scene: Scene,
    /// Whether its unit is unknown, so that the model is taken to be as large as something held in a hand.
    pub assumes_size: bool,
}

/// The opening of a model, which ends when it is dropped.
pub struct Job {
    pub stage: &'static str,
    /// 0..=1, where known.
    pub share: Option<f32>,
    task: Task,
}

impl Job {
    /// Opens the model of a scene beside the window. `known` is kept as far as it fits.
    pub fn start(wanted: Wanted, known: Option<&Arc<Loaded>>, events: &Events) -> Self {
        let known = known
            .filter(|known| known.mesh == MeshKey::of(&wanted.scene))
            .map(|known| Arc::clone(&known.opened));
        let events = events.clone();
        let task = Task::start(async move |number, cancelled| {
            let last = Mutex::new("");
            let watch = |Progress { stage, done, total }| {
                // Everything in one stage's first hearing, and about a hundred times more.
                let step = total.map_or(1, |total| (total / 100).max(1));
                let is_new = last.lock().is_ok_and(|mut last| std::mem::replace(&mut *last, stage) != stage);
                if is_new || done % step == 0 {
                    let share = total.filter(|&total| total > 0).map(|total| done as f32 / total as f32);
                    events.send(Event::Progress { job: number, stage, share });
                }
                !cancelled.load(Ordering::Relaxed)
            };
            let result = open(wanted, known, number, &watch);
            if !cancelled.load(Ordering::Relaxed) {
                events.send(Event::Opened { job: number, result: result.map(Box::new) });
            }
        });
        Self { stage: "starting", share: None, task }
    }

    pub fn is(&self, number: u64) -> bool {
        self.task.is(number)
    }
}

/// A scene as it is shown: nothing is left to what suits the subject.
fn open(
    Wanted { mut scene, assumes_size }: Wanted,
    known: Option<Arc<Opened>>,
    id: u64,
    watch: Watch<'_>,
) -> Result<(Scene, Arc<Loaded>), Error> {
    let opened = match known {
        Some(known) => known,
        None => Arc::new(Opened::new(&scene, Path::new(""), watch)?),
    };
    if assumes_size && scene.mm_per_unit.is_none() {
        scene.mm_per_unit = Some(ASSUMED_DIAGONAL_MM / opened.model.diagonal()?);
    }
    let options = scene.quality.atlas(scene.mm_per_unit())?;
    let subject = opened.subject(&scene)?;
    scene.camera = Some(camera(&scene, &subject, VIEW));
    scene.lights.get_or_insert_with(|| subject.lamps(VIEW));
    let atlas = Atlas::build(&opened.model.mesh, &options, watch)?;
    let (mesh, layout) = (MeshKey::of(&scene), LayoutKey::of(&scene));
    Ok((scene, Arc::new(Loaded { id, opened, atlas, layout, mesh })))
}

/// A model or a scene by the name of its file, or a built-in, with all paths made absolute. A model, which does not say how it is to be
/// computed, gets a `quality` that suits the adapter.
pub fn scene_of(name: &str, quality: Quality) -> Result<Wanted, Error> {
    let path = Path::new(name);
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    if ending.as_deref() == Some("json") {
        let mut scene = Scene::read(path)?;
        place(&mut scene, path);
        return Ok(Wanted { scene, assumes_size: false });
    }
    let mut scene = Scene::of_model(name);
    scene.look.gloss = DEFAULT_ROUGHNESS;
    scene.quality = quality;
    place(&mut scene, Path::new(""));
    Ok(Wanted { scene, assumes_size: true })
}

fn place(scene: &mut Scene, path: &Path) {
    let absolute = |path: PathBuf| std::path::absolute(&path).unwrap_or(path);
    scene.albedo = scene.albedo.take().map(absolute);
    let found = scene.shape.file(path);
    if let (Shape::Mesh { file, .. }, Some(found)) = (&mut scene.shape, found) {
        *file = absolute(found);
    }
    for light in scene.lights.iter_mut().flatten() {
        if let SceneLight::Environment(environment) = light {
            environment.file = absolute(std::mem::take(&mut environment.file));
        }
    }
    if scene.quality.profile.ends_with(".json") {
        let table = path.parent().unwrap_or(Path::new("")).join(&scene.quality.profile);
        scene.quality.profile = absolute(table).display().to_string();
    }
}
