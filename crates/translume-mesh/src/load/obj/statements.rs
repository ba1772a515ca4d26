//! The statements of an OBJ file.

use std::num::NonZeroU32;

use crate::load::LoadError;
use crate::load::listener::Listener;

/// What the statements add up to.
#[derive(Default)]
pub(super) struct Statements {
    pub positions: Vec<[f32; 3]>,
    /// v grows downwards, as in [`Mesh::uvs`](crate::Mesh::uvs).
    pub uvs: Vec<[f32; 2]>,
    pub normals: Vec<[f32; 3]>,
    pub corners: Vec<Corner>,
    /// Where each face ends in `corners`.
    ends: Vec<usize>,
}

/// A corner of a face: numbers of statements, from 1.
#[derive(Clone, Copy)]
pub(super) struct Corner {
    pub vertex: NonZeroU32,
    pub uv: Option<NonZeroU32>,
    pub normal: Option<NonZeroU32>,
}

/// Where the statement of a number is in its list.
pub(super) fn place(number: NonZeroU32) -> usize {
    number.get() as usize - 1
}

type Words<'a> = &'a mut dyn Iterator<Item = &'a [u8]>;

impl Statements {
    pub fn parse(bytes: &[u8], listener: &Listener<'_>) -> Result<Self, LoadError> {
        let mut all = Self::default();
        let (mut done, mut next_report) = (0, 0);
        let mut begun = Vec::new();
        for (line, content) in (1..).zip(bytes.split(|&b| b == b'\n')) {
            listener.tell_parsed(done, bytes.len(), &mut next_report)?;
            done += content.len() + 1;
            // A backslash at the end continues the statement on the next line.
            let statement = if let Some(head) = content.trim_ascii_end().strip_suffix(b"\\") {
                begun.extend_from_slice(head);
                begun.push(b' ');
                continue;
            } else if begun.is_empty() {
                content
            } else {
                begun.extend_from_slice(content);
                begun.as_slice()
            };
            all.statement(statement, listener.file, line)?;
            begun.clear();
        }
        Ok(all)
    }

    fn statement(&mut self, statement: &[u8], file: &str, line: usize) -> Result<(), LoadError> {
        let error = |reason| LoadError::Line { file: file.into(), line, reason };
        let mut words = statement.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        match words.next() {
            Some(b"v") => {
                let vertex = self.positions.len() + 1;
                let position = triple(&mut words).map_err(|e| error(format!("vertex {vertex} {e}")))?;
                self.positions.push(position);
            }
            Some(b"vn") => {
                let normal = self.normals.len() + 1;
                self.normals.push(triple(&mut words).map_err(|e| error(format!("normal {normal} {e}")))?);
            }
            Some(b"vt") => {
                let uv = self.uvs.len() + 1;
                let numbers = pair(&mut words).map_err(|e| error(format!("texture coordinate {uv} {e}")))?;
                self.uvs.push(numbers);
            }
            Some(b"f") => self.face(&mut words, file, line)?,
            _ => {}
        }
        Ok(())
    }

    fn face(&mut self, words: Words<'_>, file: &str, line: usize) -> Result<(), LoadError> {
        let face = self.ends.len() + 1;
        // A comment may follow a statement.
        for word in words.take_while(|word| !word.starts_with(b"#")) {
            let malformed = || LoadError::Line {
                file: file.into(),
                line,
                reason: format!(
                    "face {face} has the corner {}, which is no v, v/vt, v//vn or v/vt/vn",
                    shown(word)
                ),
            };
            let mut indices = word.split(|&b| b == b'/');
            let mut index = |element, count| -> Result<Option<NonZeroU32>, LoadError> {
                let Some(text) = indices.next().filter(|text| !text.is_empty()) else { return Ok(None) };
                let index = parse(text).ok_or_else(malformed)?;
                let outside = || LoadError::Face { file: file.into(), face, element, index, count };
                numbered(index, count).map(Some).ok_or_else(outside)
            };
            let vertex = index("vertex", self.positions.len())?.ok_or_else(malformed)?;
            let uv = index("texture coordinate", self.uvs.len())?;
            let normal = index("normal", self.normals.len())?;
            self.corners.push(Corner { vertex, uv, normal });
        }
        self.ends.push(self.corners.len());
        Ok(())
    }

    /// The corners of each face.
    pub fn faces(&self) -> impl Iterator<Item = &[Corner]> {
        let mut begin = 0;
        self.ends.iter().map(move |&end| &self.corners[std::mem::replace(&mut begin, end)..end])
    }

    /// Faces may come before their vertices, so ranges are known only at the end.
    pub fn check(&self, file: &str) -> Result<(), LoadError> {
        for (face, corners) in (1..).zip(self.faces()) {
            for corner in corners {
                let inside = |element, number: Option<NonZeroU32>, count| match number {
                    Some(n) if place(n) >= count => Err(LoadError::Face {
                        file: file.into(),
                        face,
                        element,
                        index: n.get().into(),
                        count,
                    }),
                    _ => Ok(()),
                };
                inside("vertex", Some(corner.vertex), self.positions.len())?;
                inside("texture coordinate", corner.uv, self.uvs.len())?;
                inside("normal", corner.normal, self.normals.len())?;
                let position = self.positions[place(corner.vertex)];
                if !position.iter().all(|x| x.is_finite()) {
                    let vertex = corner.vertex.get() as usize;
                    return Err(LoadError::Vertex { file: file.into(), vertex, position });
                }
            }
        }
        Ok(())
    }
}

/// A number from 1; negative indices count backwards from the last statement.
fn numbered(index: i64, count: usize) -> Option<NonZeroU32> {
    let number = if index < 0 { index.saturating_add(count as i64 + 1) } else { index };
    u32::try_from(number).ok().and_then(NonZeroU32::new)
}

fn triple(words: Words<'_>) -> Result<[f32; 3], String> {
    let mut numbers = [0.0; 3];
    for number in &mut numbers {
        *number = coordinate(words.next().ok_or("has fewer than three coordinates")?)?;
    }
    Ok(numbers)
}

/// u and v, where v may be missing. That of the file grows upwards.
fn pair(words: Words<'_>) -> Result<[f32; 2], String> {
    let u = coordinate(words.next().ok_or("has no coordinate")?)?;
    let v = words.next().filter(|word| !word.starts_with(b"#")).map_or(Ok(0.0), coordinate)?;
    Ok([u, 1.0 - v])
}

fn coordinate(word: &[u8]) -> Result<f32, String> {
    parse(word).ok_or_else(|| format!("has the coordinate {}, which is no number", shown(word)))
}

fn parse<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// A word as a message quotes it: not all of it, if it is long.
fn shown(word: &[u8]) -> String {
    const LONGEST: usize = 40;
    let start = String::from_utf8_lossy(&word[..word.len().min(LONGEST)]);
    if word.len() > LONGEST { format!("{start:?}…") } else { format!("{start:?}") }
}
