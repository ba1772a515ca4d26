//! Which scenes: those that come with the program, files, models.

use crate::error::Error;
use crate::report::subject;
use crate::scene::Scene;
use std::path::{Path, PathBuf};

/// Where a scene comes from.
#[derive(Clone, Debug)]
pub enum Source {
    /// One that comes with the program; what it refers to is in this folder.
    Own { name: &'static str, text: &'static str, folder: PathBuf },
    /// A scene file.
    File(PathBuf),
    /// A model by name or file, in the light that `render` gives it.
    Model(String),
}

macro_rules! own {
    ($($name:literal),*) => { [$(($name, include_str!(concat!("../../../scenes/", $name, ".json")))),*] };
}

/// Scenes whose shapes come with the program.
const OWN: [(&str, &str); 9] = own!(
    "slab",
    "spheres",
    "ball-sky",
    "creature",
    "creature-sky",
    "knot-ketchup",
    "knot-cream",
    "twist",
    "teapot"
);
/// Scenes of a model that may be at hand.
const SCANS: [(&str, &str); 2] = own!("bunny", "spot");
/// Enough to see whether all is well.
const QUICK: [&str; 2] = ["slab", "creature"];

/// Scenes that come with the program, those of models as far as `TRANSLUME_MODELS` says where to find them.
pub fn own(quick: bool) -> Vec<Source> {
    let folder = subject::models();
    let here = OWN.iter().filter(|(name, _)| !quick || QUICK.contains(name));
    let source = |folder: &Path, &(name, text)| Source::Own { name, text, folder: folder.to_owned() };
    let mut all: Vec<_> = here.map(|scene| source(Path::new(""), scene)).collect();
    if let Some(folder) = folder.filter(|_| !quick) {
        all.extend(SCANS.iter().map(|scene| source(&folder, scene)).filter(Source::is_there));
    }
    all
}

/// Files that end in .json are scenes, everything else is a model.
pub fn named(name: &str) -> Source {
    let path = Path::new(name);
    let is_scene = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"));
    if is_scene { Source::File(path.to_owned()) } else { Source::Model(name.to_owned()) }
}

impl Source {
    /// Short, and fit for a file's name.
    pub fn name(&self) -> String {
        let stem = |path: &Path| path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        match self {
            Self::Own { name, .. } => (*name).to_owned(),
            Self::File(path) => stem(path),
            Self::Model(name) => stem(Path::new(name)),
        }
    }

    /// The scene, and where its file is or would be.
    pub fn scene(&self) -> Result<(Scene, PathBuf), Error> {
        match self {
            Self::Own { name, text, folder } => {
                let path = folder.join(format!("{name}.json"));
                Ok((Scene::parse(text, &path)?, path))
            }
            Self::File(path) => Ok((Scene::read(path)?, path.clone())),
            Self::Model(name) => Ok((Scene::of_model(name), PathBuf::new())),
        }
    }

    /// Whether the file that its shape names exists.
    fn is_there(&self) -> bool {
        self.scene().is_ok_and(|(scene, path)| scene.shape.file(&path).is_none_or(|file| file.is_file()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_of_our_own_can_be_read() {
        for (name, text) in OWN.iter().chain(&SCANS) {
            let scene =
                Scene::parse(text, Path::new("scene.json")).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_eq!(scene.name, *name);
            assert!(
                scene.lights.is_some_and(|lights| !lights.is_empty()) && scene.camera.is_some(),
                "{name}"
            );
        }
        assert!(Scene::parse("{", Path::new("scene.json")).is_err());
    }

    #[test]
    fn names_are_scenes_or_models() {
        assert!(matches!(named("a/b.json"), Source::File(_)));
        assert!(matches!(named("teapot"), Source::Model(_)));
        assert_eq!(named("a/b.json").name(), "b");
        assert_eq!(named("a/c.obj").name(), "c");
    }
}
