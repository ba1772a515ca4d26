//! Wavefront OBJ: the statements `v`, `vn` and `f`; everything else carries no geometry.
//!
//! Source: "Appendix B1. Object Files (.obj)", Wavefront Advanced Visualizer manual, 1992.

use std::collections::HashMap;
use std::str::SplitWhitespace;

use super::LoadError;
use crate::mesh::Mesh;

/// Reads the text of an OBJ file. Vertices keep their numbers; copies for further normals follow after them.
pub(super) fn read(file: &str, bytes: &[u8]) -> Result<Mesh, LoadError> {
    let not_a_mesh = |reason: &str| LoadError::NotAMesh { file: file.into(), reason: reason.into() };
    if bytes.contains(&0) {
        return Err(not_a_mesh("it holds binary data"));
    }
    // Comments and names come in any encoding; numbers do not.
    let text = String::from_utf8_lossy(bytes);
    let statements = Statements::parse(file, &text)?;
    if statements.faces.is_empty() {
        return Err(not_a_mesh("it holds no face"));
    }
    statements.check(file)?;
    Ok(statements.into_mesh())
}

/// A corner of a face, from 0.
#[derive(Clone, Copy)]
struct Corner {
    vertex: u32,
    normal: Option<u32>,
}

#[derive(Default)]
struct Statements {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    corners: Vec<Corner>,
    /// Where each face begins and ends in `corners`.
    faces: Vec<std::ops::Range<usize>>,
}

impl Statements {
    fn parse(file: &str, text: &str) -> Result<Self, LoadError> {
        let mut all = Self::default();
        let mut begun = String::new();
        for (line, content) in (1..).zip(text.lines()) {
            // A backslash at the end continues the statement on the next line.
            let statement = if let Some(head) = content.trim_end().strip_suffix('\\') {
                begun.push_str(head);
                begun.push(' ');
                continue;
            } else if begun.is_empty() {
                content
            } else {
                begun.push_str(content);
                begun.as_str()
            };
            let error = |reason| LoadError::Line { file: file.into(), line, reason };
            let mut words = statement.split_whitespace();
            match words.next() {
                Some("v") => {
                    let vertex = all.positions.len() + 1;
                    all.positions.push(triple(words).map_err(|e| error(format!("vertex {vertex} {e}")))?);
                }
                Some("vn") => {
                    let normal = all.normals.len() + 1;
                    all.normals.push(triple(words).map_err(|e| error(format!("normal {normal} {e}")))?);
                }
                Some("f") => all.face(words, file, line)?,
                _ => {}
            }
            begun.clear();
        }
        Ok(all)
    }

    fn face(&mut self, words: SplitWhitespace<'_>, file: &str, line: usize) -> Result<(), LoadError> {
        let face = self.faces.len() + 1;
        let begin = self.corners.len();
        // A comment may follow a statement.
        for word in words.take_while(|word| !word.starts_with('#')) {
            let malformed = || LoadError::Line {
                file: file.into(),
                line,
                reason: format!("face {face} has the corner {word:?}, which is no v, v/vt, v//vn or v/vt/vn"),
            };
            let number = |text: &str| text.parse::<i64>().map_err(|_| malformed());
            let zero_based = |index: i64, count: usize, element| {
                let from_zero = if index < 0 { index.saturating_add(count as i64) } else { index - 1 };
                u32::try_from(from_zero).map_err(|_| LoadError::Face {
                    file: file.into(),
                    face,
                    element,
                    index,
                    count,
                })
            };
            let mut indices = word.split('/');
            let vertex = number(indices.next().unwrap_or_default())?;
            let normal = indices.nth(1).filter(|text| !text.is_empty()).map(number).transpose()?;
            self.corners.push(Corner {
                vertex: zero_based(vertex, self.positions.len(), "vertex")?,
                normal: normal.map(|n| zero_based(n, self.normals.len(), "normal")).transpose()?,
            });
        }
        self.faces.push(begin..self.corners.len());
        Ok(())
    }

    /// Faces may come before their vertices, so ranges are known only at the end.
    fn check(&self, file: &str) -> Result<(), LoadError> {
        let outside = |face, element, index: u32, count| LoadError::Face {
            file: file.into(),
            face,
            element,
            index: i64::from(index) + 1,
            count,
        };
        for (face, range) in (1..).zip(&self.faces) {
            for corner in &self.corners[range.clone()] {
                let Some(&position) = self.positions.get(corner.vertex as usize) else {
                    return Err(outside(face, "vertex", corner.vertex, self.positions.len()));
                };
                if !position.iter().all(|x| x.is_finite()) {
                    return Err(LoadError::Vertex {
                        file: file.into(),
                        vertex: corner.vertex as usize + 1,
                        position,
                    });
                }
                if let Some(normal) = corner.normal.filter(|&n| n as usize >= self.normals.len()) {
                    return Err(outside(face, "normal", normal, self.normals.len()));
                }
            }
        }
        Ok(())
    }

    fn into_mesh(self) -> Mesh {
        let mut vertices = Vertices::new(&self);
        let mut triangles = Vec::with_capacity(self.corners.len());
        for range in &self.faces {
            let corners: Vec<u32> =
                self.corners[range.clone()].iter().map(|&corner| vertices.index(corner)).collect();
            triangles.extend((2..corners.len()).map(|k| [corners[0], corners[k - 1], corners[k]]));
        }
        Mesh { positions: vertices.positions, normals: vertices.normals, triangles, ..Mesh::default() }
    }
}

fn triple(mut words: SplitWhitespace<'_>) -> Result<[f32; 3], String> {
    let mut numbers = [0.0; 3];
    for number in &mut numbers {
        let word = words.next().ok_or("has fewer than three coordinates")?;
        *number = word.parse().map_err(|_| format!("has the coordinate {word:?}, which is no number"))?;
    }
    Ok(numbers)
}

/// Gives each pair of position and normal one vertex.
struct Vertices<'a> {
    statements: &'a Statements,
    /// The number of the first normal of equal value: exporters repeat them.
    canonical: Vec<u32>,
    /// The normal that a vertex of the file stands for, once a face has used it.
    first_normal: Vec<Option<Option<u32>>>,
    copies: HashMap<(u32, Option<u32>), u32>,
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
}

impl<'a> Vertices<'a> {
    fn new(statements: &'a Statements) -> Self {
        Self {
            statements,
            canonical: crate::weld::weld(&statements.normals),
            first_normal: vec![None; statements.positions.len()],
            copies: HashMap::new(),
            positions: statements.positions.clone(),
            normals: vec![[0.0; 3]; statements.positions.len()],
        }
    }

    fn index(&mut self, Corner { vertex, normal }: Corner) -> u32 {
        let normal = normal.map(|n| self.canonical[n as usize]);
        let value = normal.map_or([0.0; 3], |n| self.statements.normals[n as usize]);
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
}
