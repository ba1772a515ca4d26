//! glTF 2.0 and GLB: the default scene as one mesh, what moves it, and what it is made of.
//!
//! | module | what it reads |
//! | --- | --- |
//! | [`document`] | bytes into a validated document |
//! | [`scene`] | the nodes of the default scene |
//! | [`primitive`] | surfaces on nodes into one mesh |
//! | [`morph`] | which targets nodes share, names, default weights |
//! | [`skin`] | joints and influences |
//! | [`animation`] | channels with their keys |
//! | [`material`] | materials and their extensions |
//! | [`budget`] | a bound on what all of it may unfold to |
//!
//! Source: Khronos, glTF 2.0 specification.

mod animation;
mod budget;
mod document;
mod material;
mod morph;
mod primitive;
mod scene;
mod skin;

use std::collections::BTreeMap;
use std::path::Path;

use super::buffers::{self, Buffer};
use super::{LoadError, Model};
use crate::material::Material;
use crate::mesh::Influence;
use crate::rig::{Node, Rig};
use animation::Reader;
use budget::{Budget, cost};
use morph::Morphs;
use primitive::{Hold, Merged, Part};
use scene::{Placed, Scene};
use skin::Joints;

/// Reads a document; the bytes decide between JSON and binary.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Model, LoadError> {
    let file = path.display().to_string();
    let (document, blob) = document::parse(bytes).map_err(|fault| fault.in_file(&file))?;
    let (buffers, beside) = buffers::load(path, &document, blob)?;
    let budget = Budget::new(bytes.len().saturating_add(beside));
    model(&document, &buffers, budget).map_err(|fault| fault.in_file(&file))
}

fn model(document: &gltf::Document, buffers: &[Buffer], mut budget: Budget) -> Result<Model, Fault> {
    budget.take(document.nodes().len(), cost::NODE)?;
    let scene = Scene::new(document)?;
    let parts = Part::of_scene(&scene, buffers, &mut budget)?;
    let morphs = Morphs::new(document, &scene, &parts, &mut budget)?;
    let skinned = parts.iter().any(|part| scene.nodes[part.place].node.skin().is_some());
    let moves = skinned || document.animations().len() > 0;
    let stride = if moves { primitive::stride(&scene, &parts)? } else { 0 };
    let mut merged = Merged::new(&parts, &morphs, stride, &mut budget)?;
    let mut joints = Joints::default();
    for part in &parts {
        let hold = hold(part, &scene, &mut joints, stride, buffers, &mut budget)?;
        let first = morphs.range(part.place).start;
        merged.append(part, &hold, first, buffers).map_err(|reason| part.fault(reason))?;
    }
    if merged.mesh.triangles.is_empty() {
        return Err("its scene holds no triangle".into());
    }
    let material = widest_medium(document, &merged.areas)?;
    let rig = if moves {
        let reader = Reader { scene: &scene, morphs: &morphs, buffers };
        let animations = reader.animations(document, &mut budget)?;
        let nodes = scene.nodes.iter().map(node).collect();
        Some(Rig { nodes, joints: joints.joints, weights: morphs.weights, animations })
    } else {
        // Default weights are worth keeping where nothing else is.
        let stands = morphs.weights.iter().any(|&weight| weight != 0.0);
        stands.then(|| Rig { weights: morphs.weights, ..Rig::default() })
    };
    let count = rig.as_ref().map_or(0, |rig| rig.joints.len());
    Ok(Model { mesh: merged.finish(count), rig, material })
}

fn hold(
    part: &Part<'_>,
    scene: &Scene<'_>,
    joints: &mut Joints,
    stride: usize,
    buffers: &[Buffer],
    budget: &mut Budget,
) -> Result<Hold, Fault> {
    let placed = &scene.nodes[part.place];
    if let Some(skin) = placed.node.skin() {
        // A skin places its mesh by itself (specification, section 3.7.3.3).
        let bound = joints.of_skin(&skin, scene, buffers, budget)?;
        let influences = bound.influences(&part.primitive, buffers, part.vertices, stride);
        return Ok(Hold {
            placement: bound.placement,
            influences: influences.map_err(|reason| part.fault(reason))?,
        });
    }
    let mut influences = vec![Influence::default(); part.vertices * stride];
    if stride > 0 {
        let joint = joints.of_node(scene, part.place);
        influences.iter_mut().step_by(stride).for_each(|first| *first = Influence { joint, weight: 1.0 });
    }
    Ok(Hold { placement: placed.global, influences })
}

fn node(placed: &Placed<'_>) -> Node {
    Node {
        name: placed.node.name().unwrap_or_default().into(),
        parent: placed.parent.map(|parent| parent as u32),
        local: placed.local,
    }
}

/// The material of the largest area among those that describe a scattering medium; where none does, of the largest area.
fn widest_medium(document: &gltf::Document, areas: &BTreeMap<usize, f64>) -> Result<Option<Material>, Fault> {
    let mut widest: Option<(bool, f64, Material)> = None;
    for (&index, &area) in areas {
        let Some(material) = document.materials().nth(index) else { continue };
        let material = material::read(&material)?;
        let scatters = material.scattering().is_some();
        let wider = widest.as_ref().is_none_or(|(known, largest, _)| (scatters, area) > (*known, *largest));
        if wider {
            widest = Some((scatters, area, material));
        }
    }
    Ok(widest.map(|(_, _, material)| material))
}

/// The element of a document that is wrong, and what is wrong with it.
struct Fault {
    /// Empty where the whole file is no mesh.
    element: String,
    reason: String,
}

impl Fault {
    fn at(element: impl Into<String>, reason: impl Into<String>) -> Self {
        Self { element: element.into(), reason: reason.into() }
    }

    fn in_file(self, file: &str) -> LoadError {
        let Self { element, reason } = self;
        let file = file.into();
        if element.is_empty() {
            LoadError::NotAMesh { file, reason }
        } else {
            LoadError::Gltf { file, element, reason }
        }
    }
}

impl<T: Into<String>> From<T> for Fault {
    fn from(reason: T) -> Self {
        Self::at("", reason)
    }
}

/// Says which number of a list is none.
fn finite(numbers: &[f32]) -> Result<(), String> {
    match numbers.iter().position(|x| !x.is_finite()) {
        Some(k) => Err(format!("number {k} (from 0) is {}", numbers[k])),
        None => Ok(()),
    }
}
