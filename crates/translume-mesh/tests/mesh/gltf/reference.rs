//! An evaluation of animated glTF in double precision, written from the specification over raw JSON and bytes.
//! It shares nothing with the loader.

use std::path::Path;

use serde_json::Value;

use super::algebra::{IDENTITY, Matrix, hermite, normalized, product, slerp, transform, trs};

/// A document and the bytes of its buffers.
pub struct Reference {
    json: Value,
    buffers: Vec<Vec<u8>>,
}

impl Reference {
    pub fn from_glb(bytes: &[u8]) -> Self {
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        let end = 20 + word(12);
        let json = serde_json::from_slice(&bytes[20..end]).unwrap();
        Self { json, buffers: vec![bytes[end + 8..end + 8 + word(end)].to_vec()] }
    }

    pub fn from_file(path: &Path) -> Self {
        let bytes = std::fs::read(path).unwrap();
        if bytes.starts_with(b"glTF") {
            return Self::from_glb(&bytes);
        }
        let json: Value = serde_json::from_slice(&bytes).unwrap();
        let data = |buffer: &Value| base64(buffer["uri"].as_str().unwrap().split_once(',').unwrap().1);
        let buffers = list(&json["buffers"]).iter().map(data).collect();
        Self { json, buffers }
    }

    pub fn animations(&self) -> usize {
        list(&self.json["animations"]).len()
    }

    /// Every vertex of every triangle primitive, in the order of the scene, at a time of an animation.
    pub fn vertices(&self, animation: Option<usize>, seconds: f64) -> Vec<[f64; 3]> {
        let animation = animation.map_or(&Value::Null, |a| &self.json["animations"][a]);
        let roots = &self.json["scenes"][index(&self.json["scene"]).unwrap_or(0)]["nodes"];
        let mut globals = vec![IDENTITY; list(&self.json["nodes"]).len()];
        let mut order = Vec::new();
        for root in list(roots) {
            self.walk(animation, seconds, index(root).unwrap(), IDENTITY, &mut globals, &mut order);
        }
        order.into_iter().flat_map(|node| self.node_vertices(animation, seconds, node, &globals)).collect()
    }

    fn walk(
        &self,
        animation: &Value,
        seconds: f64,
        node: usize,
        parent: Matrix,
        globals: &mut [Matrix],
        order: &mut Vec<usize>,
    ) {
        order.push(node);
        globals[node] = product(parent, self.local(animation, seconds, node));
        for child in list(&self.json["nodes"][node]["children"]) {
            self.walk(animation, seconds, index(child).unwrap(), globals[node], globals, order);
        }
    }

    fn local(&self, animation: &Value, seconds: f64, node: usize) -> Matrix {
        let json = &self.json["nodes"][node];
        if let Some(matrix) = json["matrix"].as_array() {
            return std::array::from_fn(|c| std::array::from_fn(|r| matrix[4 * c + r].as_f64().unwrap()));
        }
        let property = |path: &str, default: &[f64]| {
            let stated = json[path].as_array().map(|a| a.iter().map(|x| x.as_f64().unwrap()).collect());
            let width = default.len();
            self.sampled(animation, seconds, node, path, width).or(stated).unwrap_or(default.to_vec())
        };
        trs(
            &property("translation", &[0.0; 3]),
            &property("rotation", &[0.0, 0.0, 0.0, 1.0]),
            &property("scale", &[1.0; 3]),
        )
    }

    fn weights(&self, animation: &Value, seconds: f64, node: usize, count: usize) -> Vec<f64> {
        let json = &self.json["nodes"][node];
        let mesh = &self.json["meshes"][index(&json["mesh"]).unwrap()];
        let stated = [&json["weights"], &mesh["weights"]].into_iter().find(|w| !w.is_null());
        let stated = stated.map(|w| list(w).iter().map(|x| x.as_f64().unwrap()).collect());
        self.sampled(animation, seconds, node, "weights", count).or(stated).unwrap_or(vec![0.0; count])
    }

    /// Appendix C of the specification.
    fn sampled(
        &self,
        animation: &Value,
        seconds: f64,
        node: usize,
        path: &str,
        width: usize,
    ) -> Option<Vec<f64>> {
        let channel = list(&animation["channels"]).iter().rfind(|channel| {
            index(&channel["target"]["node"]) == Some(node) && channel["target"]["path"] == path
        })?;
        let sampler = &animation["samplers"][index(&channel["sampler"])?];
        let times = self.accessor(index(&sampler["input"])?).concat();
        let values = self.accessor(index(&sampler["output"])?).concat();
        let mode = sampler["interpolation"].as_str().unwrap_or("LINEAR");
        let (parts, middle) = if mode == "CUBICSPLINE" { (3, 1) } else { (1, 0) };
        let part = |key: usize, part: usize| {
            let first = (key * parts + part) * width;
            values[first..first + width].to_vec()
        };
        let last = times.len() - 1;
        let clamped = seconds.clamp(times[0], times[last]);
        let key = (0..times.len()).rfind(|&k| times[k] <= clamped)?;
        let value = if key == last || times[key] == clamped {
            part(key, middle)
        } else {
            let span = times[key + 1] - times[key];
            let t = (clamped - times[key]) / span;
            let [from, to] = [part(key, middle), part(key + 1, middle)];
            match mode {
                "STEP" => from,
                "CUBICSPLINE" => hermite(t, span, &from, &part(key, 2), &to, &part(key + 1, 0)),
                _ if path == "rotation" => slerp(t, &from, &to),
                _ => from.iter().zip(&to).map(|(a, b)| (1.0 - t) * a + t * b).collect(),
            }
        };
        Some(if path == "rotation" { normalized(&value) } else { value })
    }

    fn node_vertices(
        &self,
        animation: &Value,
        seconds: f64,
        node: usize,
        globals: &[Matrix],
    ) -> Vec<[f64; 3]> {
        let json = &self.json["nodes"][node];
        let Some(mesh) = index(&json["mesh"]) else { return Vec::new() };
        let skin = index(&json["skin"]).map(|skin| self.joint_matrices(&self.json["skins"][skin], globals));
        let mut vertices = Vec::new();
        for primitive in list(&self.json["meshes"][mesh]["primitives"]) {
            let attributes = &primitive["attributes"];
            let mut positions = self.accessor(index(&attributes["POSITION"]).unwrap());
            let targets = list(&primitive["targets"]);
            let weights = self.weights(animation, seconds, node, targets.len());
            for (target, weight) in targets.iter().zip(weights) {
                let Some(deltas) = index(&target["POSITION"]) else { continue };
                for (position, delta) in positions.iter_mut().zip(self.accessor(deltas)) {
                    position.iter_mut().zip(delta).for_each(|(x, d)| *x += weight * d);
                }
            }
            let influences = skin.as_ref().map(|_| self.influences(attributes, positions.len()));
            for (v, p) in positions.iter().enumerate() {
                let p = [p[0], p[1], p[2]];
                vertices.push(match (&skin, &influences) {
                    (Some(matrices), Some(influences)) => blended(p, matrices, &influences[v]),
                    _ => transform(globals[node], p),
                });
            }
        }
        vertices
    }

    fn joint_matrices(&self, skin: &Value, globals: &[Matrix]) -> Vec<Matrix> {
        let binds = index(&skin["inverseBindMatrices"]).map(|a| self.accessor(a));
        let joints = list(&skin["joints"]).iter().map(|joint| index(joint).unwrap());
        joints
            .enumerate()
            .map(|(k, joint)| {
                let bind = binds.as_ref().map_or(IDENTITY, |binds| {
                    std::array::from_fn(|c| std::array::from_fn(|r| binds[k][4 * c + r]))
                });
                product(globals[joint], bind)
            })
            .collect()
    }

    /// Joint and weight pairs of every vertex, over all sets; the weights add up to 1.
    fn influences(&self, attributes: &Value, vertices: usize) -> Vec<Vec<(usize, f64)>> {
        let mut influences = vec![Vec::new(); vertices];
        for set in 0.. {
            let get = |name: &str| index(&attributes[format!("{name}_{set}")]).map(|a| self.accessor(a));
            let (Some(joints), Some(weights)) = (get("JOINTS"), get("WEIGHTS")) else { break };
            for (v, (joints, weights)) in joints.iter().zip(&weights).enumerate() {
                influences[v].extend(joints.iter().map(|&j| j as usize).zip(weights.iter().copied()));
            }
        }
        for influences in &mut influences {
            let sum: f64 = influences.iter().map(|(_, weight)| weight).sum();
            influences.iter_mut().for_each(|(_, weight)| *weight /= sum);
        }
        influences
    }

    /// Every element of an accessor, as numbers.
    fn accessor(&self, accessor: usize) -> Vec<Vec<f64>> {
        let json = &self.json["accessors"][accessor];
        let width = match json["type"].as_str().unwrap() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        let count = index(&json["count"]).unwrap();
        let component = json["componentType"].as_u64().unwrap();
        let normalized = json["normalized"].as_bool().unwrap_or(false);
        let read = |json: &Value, component: u64, width: usize, count: usize| {
            let view = &self.json["bufferViews"][index(&json["bufferView"]).unwrap()];
            let size = [1, 1, 2, 2, 0, 4, 4][component as usize - 5120];
            let stride = index(&view["byteStride"]).unwrap_or(width * size);
            let first = index(&view["byteOffset"]).unwrap_or(0) + index(&json["byteOffset"]).unwrap_or(0);
            let buffer = &self.buffers[index(&view["buffer"]).unwrap()];
            let element = |k: usize| {
                let at = |c: usize| &buffer[first + k * stride + c * size..][..size];
                (0..width).map(|c| number(at(c), component, normalized)).collect::<Vec<f64>>()
            };
            (0..count).map(element).collect::<Vec<_>>()
        };
        let mut elements = if json["bufferView"].is_null() {
            vec![vec![0.0; width]; count]
        } else {
            read(json, component, width, count)
        };
        if let Some(replaced) = index(&json["sparse"]["count"]) {
            let sparse = &json["sparse"];
            let component_of_indices = sparse["indices"]["componentType"].as_u64().unwrap();
            let indices = read(&sparse["indices"], component_of_indices, 1, replaced);
            let values = read(&sparse["values"], component, width, replaced);
            for (at, value) in indices.into_iter().zip(values) {
                elements[at[0] as usize] = value;
            }
        }
        elements
    }
}

fn blended(p: [f64; 3], matrices: &[Matrix], influences: &[(usize, f64)]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for &(joint, weight) in influences {
        let moved = transform(matrices[joint], p);
        sum = std::array::from_fn(|k| sum[k] + weight * moved[k]);
    }
    sum
}

/// The specification, sections 3.6.2.2 and 3.11.
fn number(bytes: &[u8], component: u64, normalized: bool) -> f64 {
    let (value, largest) = match component {
        5120 => (f64::from(i8::from_le_bytes([bytes[0]])), 127.0),
        5121 => (f64::from(bytes[0]), 255.0),
        5122 => (f64::from(i16::from_le_bytes([bytes[0], bytes[1]])), 32767.0),
        5123 => (f64::from(u16::from_le_bytes([bytes[0], bytes[1]])), 65535.0),
        5125 => (f64::from(u32::from_le_bytes(bytes.try_into().unwrap())), 0.0),
        _ => return f64::from(f32::from_le_bytes(bytes.try_into().unwrap())),
    };
    if normalized { (value / largest).max(-1.0) } else { value }
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn index(value: &Value) -> Option<usize> {
    value.as_u64().map(|x| x as usize)
}

fn base64(text: &str) -> Vec<u8> {
    const DIGITS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let digits = text.bytes().filter_map(|c| DIGITS.iter().position(|&d| d == c));
    let (mut bytes, mut bits, mut held) = (Vec::new(), 0_usize, 0);
    for digit in digits {
        bits = (bits << 6 | digit) & 0xffff;
        held += 6;
        if held >= 8 {
            held -= 8;
            bytes.push((bits >> held & 0xff) as u8);
        }
    }
    bytes
}
