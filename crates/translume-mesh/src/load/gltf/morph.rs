//! Which morph targets the nodes of a scene share, their names and default weights.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use gltf::animation::Property;
use gltf::json::{Value, deserialize};

use super::budget::{Budget, cost};
use super::primitive::Part;
use super::scene::Scene;
use super::{Fault, finite};

/// The targets of the merged mesh.
pub(super) struct Morphs {
    /// Of each node of the scene that morphs, its targets.
    ranges: BTreeMap<usize, Range<usize>>,
    /// The name of each target; may be empty.
    pub(super) names: Vec<String>,
    /// The default weight of each target.
    pub(super) weights: Vec<f32>,
}

/// A node whose mesh has targets.
struct Morphing {
    place: usize,
    mesh: usize,
    weights: Vec<f32>,
}

impl Morphs {
    /// Targets merge by their number where all nodes that morph are driven alike; else each node has its own.
    pub(super) fn new(
        document: &gltf::Document,
        scene: &Scene<'_>,
        parts: &[Part<'_>],
        budget: &mut Budget,
    ) -> Result<Self, Fault> {
        let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
        for part in parts.iter().filter(|part| part.targets() > 0) {
            let count = counts.entry(part.place).or_default();
            *count = part.targets().max(*count);
        }
        let morphing: Vec<Morphing> =
            counts.iter().map(|(&place, &count)| morphing(scene, place, count)).collect::<Result<_, _>>()?;
        let animated = animated(document, scene);
        let alike = morphing.len() < 2
            || !morphing.iter().any(|node| animated.contains(&node.place)) && agree(&morphing);
        let meshes: BTreeSet<usize> = morphing.iter().map(|node| node.mesh).collect();
        let names = document.meshes().filter(|mesh| meshes.contains(&mesh.index()));
        let names = names.map(|mesh| (mesh.index(), target_names(&mesh))).collect();
        let mut morphs = Self { ranges: BTreeMap::new(), names: Vec::new(), weights: Vec::new() };
        for node in morphing {
            morphs
                .add(&node, &names, alike, budget)
                .map_err(|reason| Fault::at(format!("meshes[{}].extras", node.mesh), reason))?;
        }
        Ok(morphs)
    }

    /// The targets of a node of the scene; none for one that does not morph.
    pub(super) fn range(&self, place: usize) -> Range<usize> {
        self.ranges.get(&place).cloned().unwrap_or_default()
    }

    fn add(
        &mut self,
        node: &Morphing,
        names: &BTreeMap<usize, Vec<String>>,
        alike: bool,
        budget: &mut Budget,
    ) -> Result<(), String> {
        let first = if alike { 0 } else { self.names.len() };
        let end = first + node.weights.len();
        self.ranges.insert(node.place, first..end);
        if self.names.len() < end {
            self.weights.extend_from_slice(&node.weights[self.names.len() - first..]);
            self.names.resize(end, String::new());
        }
        let known = names.get(&node.mesh).map_or(&[][..], Vec::as_slice);
        for (target, name) in self.names[first..end].iter_mut().zip(known) {
            if target.is_empty() {
                budget.take(name.len(), cost::BYTE)?;
                target.clone_from(name);
            }
        }
        Ok(())
    }
}

fn morphing(scene: &Scene<'_>, place: usize, count: usize) -> Result<Morphing, Fault> {
    let node = &scene.nodes[place].node;
    let mesh = node.mesh();
    let index = mesh.as_ref().map_or(0, gltf::Mesh::index);
    let (element, weights) = match (node.weights(), mesh.as_ref().and_then(gltf::Mesh::weights)) {
        (Some(weights), _) => (format!("nodes[{}].weights", node.index()), weights),
        (None, weights) => (format!("meshes[{index}].weights"), weights.unwrap_or_default()),
    };
    let fault = |reason| Fault::at(element.clone(), reason);
    if !weights.is_empty() && weights.len() != count {
        return Err(fault(format!("it has {} weights for {count} morph targets", weights.len())));
    }
    finite(weights).map_err(fault)?;
    let mut weights = weights.to_vec();
    weights.resize(count, 0.0);
    Ok(Morphing { place, mesh: index, weights })
}

/// `mesh.extras.targetNames`, where most programs keep the names (specification, section 3.7.2.2).
fn target_names(mesh: &gltf::Mesh<'_>) -> Vec<String> {
    let extras = mesh.extras().as_ref().and_then(|raw| deserialize::from_str::<Value>(raw.get()).ok());
    let names = extras.as_ref().and_then(|extras| extras.get("targetNames")).and_then(Value::as_array);
    let name = |name: &Value| name.as_str().unwrap_or_default().to_owned();
    names.map_or_else(Vec::new, |names| names.iter().map(name).collect())
}

/// Nodes of the scene whose weights an animation moves.
fn animated(document: &gltf::Document, scene: &Scene<'_>) -> BTreeSet<usize> {
    document
        .animations()
        .flat_map(|animation| animation.channels().collect::<Vec<_>>())
        .filter(|channel| channel.target().property() == Property::MorphTargetWeights)
        .filter_map(|channel| scene.place(channel.target().node().index()))
        .collect()
}

/// Whether no two nodes want different default weights of the same number.
fn agree(morphing: &[Morphing]) -> bool {
    let mut common: Vec<f32> = Vec::new();
    morphing.iter().all(|node| {
        let known = common.len().min(node.weights.len());
        let same = common[..known] == node.weights[..known];
        common.extend_from_slice(&node.weights[known..]);
        same
    })
}
