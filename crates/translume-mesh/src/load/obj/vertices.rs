//! One vertex for each pair of position and normal.

use std::collections::HashMap;
use std::num::NonZeroU32;

use super::statements::{Corner, place};
use crate::weld::weld;

/// Hands out vertices: those of the file first, then copies of them for further normals.
pub(super) struct Vertices {
    pub positions: Vec<[f32; 3]>,
    /// Zero where a corner has none; no entry at all where no corner has one.
    normals: Vec<[f32; 3]>,
    file_normals: Vec<[f32; 3]>,
    /// The first normal of equal value: exporters repeat them.
    canonical: Vec<u32>,
    /// The normal that a vertex of the file stands for, once a face has used it.
    first_normal: Vec<Option<Option<u32>>>,
    copies: HashMap<(u32, Option<u32>), u32>,
}

impl Vertices {
    pub fn new(positions: Vec<[f32; 3]>, file_normals: Vec<[f32; 3]>) -> Self {
        let count = if file_normals.is_empty() { 0 } else { positions.len() };
        Self {
            positions,
            normals: vec![[0.0; 3]; count],
            canonical: weld(&file_normals),
            file_normals,
            first_normal: vec![None; count],
            copies: HashMap::new(),
        }
    }

    pub fn index(&mut self, corner: Corner) -> u32 {
        let vertex = corner.vertex.get() - 1;
        if self.file_normals.is_empty() {
            return vertex;
        }
        let normal = corner.normal.map(|n: NonZeroU32| self.canonical[place(n)]);
        let value = normal.map_or([0.0; 3], |n| self.file_normals[n as usize]);
        match self.first_normal[vertex as usize] {
            Some(first) if first == normal => vertex,
            None => {
                self.first_normal[vertex as usize] = Some(normal);
                self.normals[vertex as usize] = value;
                vertex
            }
            Some(_) => *self.copies.entry((vertex, normal)).or_insert_with(|| {
                self.positions.push(self.positions[vertex as usize]);
                self.normals.push(value);
                (self.positions.len() - 1) as u32
            }),
        }
    }

    /// Positions and normals.
    pub fn finish(self) -> (Vec<[f32; 3]>, Vec<[f32; 3]>) {
        (self.positions, self.normals)
    }
}
