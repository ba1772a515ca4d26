//! PLY: vertices with their normals, and faces; every other element and property is skipped.
//!
//! Source: Greg Turk, "The PLY Polygon File Format", 1994; names with sizes (`float32`) have become common since.

mod header;
mod numbers;

use super::LoadError;
use super::listener::Listener;
use super::polygon::Cutter;
use crate::mesh::Mesh;
use header::{Element, Header, Property};
use numbers::Numbers;

/// Reads a file, in text or binary of either byte order.
pub(super) fn read(bytes: &[u8], listener: &Listener<'_>) -> Result<Mesh, LoadError> {
    let file = listener.file;
    let (header, rest) = read_header(bytes, file)?;
    let mut numbers = Numbers { encoding: header.encoding, rest };
    let mut body = Body::default();
    let mut next_report = 0;
    for element in &header.elements {
        let error = |element, reason| LoadError::Ply { file: file.into(), element, reason };
        let roles = roles(element).map_err(|reason| error(format!("element `{}`", element.name), reason))?;
        // Rows without properties take no room, so nothing would bound their number.
        let rows = if roles.is_empty() { 0 } else { element.count };
        for row in 0..rows {
            listener.tell_parsed(bytes.len() - numbers.rest.len(), bytes.len(), &mut next_report)?;
            body.row(element, &roles, &mut numbers)
                .map_err(|reason| error(format!("{} {row} (from 0)", element.name), reason))?;
        }
    }
    body.into_mesh(file)
}

/// The header, and the bytes after it.
fn read_header<'a>(bytes: &'a [u8], file: &str) -> Result<(Header, &'a [u8]), LoadError> {
    let not_a_mesh = |reason: &str| LoadError::NotAMesh { file: file.into(), reason: reason.into() };
    if !bytes.starts_with(b"ply") {
        return Err(not_a_mesh("it does not begin with `ply`"));
    }
    let mut header = Header::default();
    let mut rest = bytes;
    for line in 1.. {
        let end =
            rest.iter().position(|&b| b == b'\n').ok_or_else(|| not_a_mesh("its header does not end"))?;
        header.line(&rest[..end]).map_err(|reason| LoadError::Line { file: file.into(), line, reason })?;
        rest = &rest[end + 1..];
        if header.ended {
            break;
        }
    }
    Ok((header, rest))
}

/// What a property is to a mesh.
#[derive(Clone, Copy, PartialEq)]
enum Role {
    /// x, y, z or nx, ny, nz of a vertex.
    Coordinate(usize),
    /// The vertices of a face.
    Corners,
    Nothing,
}

/// Coordinates of a vertex, in the order of [`Role::Coordinate`].
const COORDINATES: [&str; 6] = ["x", "y", "z", "nx", "ny", "nz"];

fn roles(element: &Element) -> Result<Vec<Role>, String> {
    let role = |property: &Property| match (element.name.as_str(), property.length) {
        ("vertex", None) => {
            COORDINATES.iter().position(|name| *name == property.name).map_or(Role::Nothing, Role::Coordinate)
        }
        ("face", Some(_)) if ["vertex_indices", "vertex_index"].contains(&property.name.as_str()) => {
            Role::Corners
        }
        _ => Role::Nothing,
    };
    let roles: Vec<Role> = element.properties.iter().map(role).collect();
    let times = |role| roles.iter().filter(|other| **other == role).count();
    match element.name.as_str() {
        "vertex" if (0..3).any(|axis| times(Role::Coordinate(axis)) != 1) => {
            Err("it must have x, y and z, each once".into())
        }
        "face" if times(Role::Corners) != 1 => Err("it must have one list `vertex_indices`".into()),
        _ => Ok(roles),
    }
}

#[derive(Default)]
struct Body {
    positions: Vec<[f32; 3]>,
    /// As many as positions, or none.
    normals: Vec<[f32; 3]>,
    corners: Vec<u32>,
    /// Where each face ends in `corners`.
    ends: Vec<usize>,
}

impl Body {
    fn row(&mut self, element: &Element, roles: &[Role], numbers: &mut Numbers<'_>) -> Result<(), String> {
        let mut vertex = [0.0; 6];
        for (property, role) in element.properties.iter().zip(roles) {
            let Some(length) = property.length else {
                let number = numbers.next(property.scalar)?;
                if let Role::Coordinate(axis) = role {
                    vertex[*axis] = number as f32;
                }
                continue;
            };
            for _ in 0..numbers.length(length)? {
                let number = numbers.next(property.scalar)?;
                if *role == Role::Corners {
                    self.corners.push(index(number)?);
                }
            }
        }
        let [x, y, z, nx, ny, nz] = vertex;
        match element.name.as_str() {
            "vertex" => {
                self.positions.push([x, y, z]);
                if (3..6).all(|axis| roles.contains(&Role::Coordinate(axis))) {
                    self.normals.push([nx, ny, nz]);
                }
            }
            "face" => self.ends.push(self.corners.len()),
            _ => {}
        }
        Ok(())
    }

    fn into_mesh(self, file: &str) -> Result<Mesh, LoadError> {
        if self.ends.is_empty() {
            return Err(LoadError::NotAMesh { file: file.into(), reason: "it holds no face".into() });
        }
        let mut triangles = Vec::with_capacity(self.corners.len() / 3);
        let mut begin = 0;
        let mut cutter = Cutter::new();
        for (face, end) in self.ends.into_iter().enumerate() {
            let corners = &self.corners[std::mem::replace(&mut begin, end)..end];
            if let Some(vertex) = corners.iter().find(|v| **v as usize >= self.positions.len()) {
                return Err(LoadError::Ply {
                    file: file.into(),
                    element: format!("face {face} (from 0)"),
                    reason: format!("it uses vertex {vertex}, but there are {}", self.positions.len()),
                });
            }
            let first = triangles.len();
            let points = corners.iter().map(|&v| self.positions[v as usize]);
            cutter.cut(points, &mut triangles).map_err(|_| LoadError::Polygon {
                file: file.into(),
                face: face + 1,
                corners: corners.len(),
            })?;
            triangles[first..].iter_mut().flatten().for_each(|k| *k = corners[*k as usize]);
        }
        Ok(Mesh { positions: self.positions, normals: self.normals, triangles, ..Mesh::default() })
    }
}

fn index(number: f64) -> Result<u32, String> {
    let fits = number.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&number);
    if fits { Ok(number as u32) } else { Err(format!("it uses vertex {number}, which cannot be")) }
}
