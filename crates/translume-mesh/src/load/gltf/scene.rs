//! The nodes of the default scene and where they stand.

use glam::DMat4;
use gltf::scene::Transform;

use super::Fault;
use crate::rig::{Local, unit};

/// The default scene, parents before their children.
pub(super) struct Scene<'a> {
    pub(super) nodes: Vec<Placed<'a>>,
    /// For each node of the document its place in [`nodes`](Self::nodes), if it is in the scene.
    places: Vec<Option<usize>>,
}

/// A node of the scene.
pub(super) struct Placed<'a> {
    pub(super) node: gltf::Node<'a>,
    pub(super) parent: Option<usize>,
    pub(super) local: Local,
    /// To the scene, while nothing is animated. Finite, also in `f32`.
    pub(super) global: DMat4,
}

impl<'a> Scene<'a> {
    pub(super) fn new(document: &'a gltf::Document) -> Result<Self, Fault> {
        let mut pending: Vec<_> = roots(document).into_iter().map(|node| (node, None)).collect();
        pending.reverse();
        let mut scene = Self { nodes: Vec::new(), places: vec![None; document.nodes().len()] };
        while let Some((node, parent)) = pending.pop() {
            let place = scene.nodes.len();
            let first_child = pending.len();
            pending.extend(node.children().map(|child| (child, Some(place))));
            pending[first_child..].reverse();
            scene.push(node, parent)?;
        }
        Ok(scene)
    }

    /// Where in [`nodes`](Self::nodes) a node is, given its index in the document.
    pub(super) fn place(&self, index: usize) -> Option<usize> {
        self.places.get(index).copied().flatten()
    }

    fn push(&mut self, node: gltf::Node<'a>, parent: Option<usize>) -> Result<(), Fault> {
        let element = || format!("nodes[{}]", node.index());
        let place = &mut self.places[node.index()];
        if place.replace(self.nodes.len()).is_some() {
            return Err(Fault::at(element(), "it has two parents or is its own ancestor"));
        }
        let local = local(&node);
        let global = parent.map_or(DMat4::IDENTITY, |p| self.nodes[p].global) * local.matrix();
        if !global.as_mat4().is_finite() {
            return Err(Fault::at(element(), "its transform is not finite"));
        }
        self.nodes.push(Placed { node, parent, local, global });
        Ok(())
    }
}

fn local(node: &gltf::Node<'_>) -> Local {
    match node.transform() {
        Transform::Matrix { matrix } => Local::Matrix(matrix),
        Transform::Decomposed { translation, rotation, scale } => {
            let rotation = unit(rotation.map(f64::from)).as_quat().to_array();
            Local::Trs { translation, rotation, scale }
        }
    }
}

/// The roots of the default scene; of everything where the file has no scene.
fn roots(document: &gltf::Document) -> Vec<gltf::Node<'_>> {
    if let Some(scene) = document.default_scene().or_else(|| document.scenes().next()) {
        return scene.nodes().collect();
    }
    let mut roots: Vec<_> = document.nodes().map(Some).collect();
    for child in document.nodes().flat_map(|node| node.children().collect::<Vec<_>>()) {
        roots[child.index()] = None;
    }
    roots.into_iter().flatten().collect()
}
