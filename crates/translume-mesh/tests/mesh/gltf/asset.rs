//! Small glTF files made by hand.

use serde_json::{Value, json};
use translume_mesh::load::{LoadError, Loaded};

use super::reference::Reference;
use crate::fixtures::{Folder, tetrahedron};

pub const BYTE: u32 = 5120;
pub const UNSIGNED_BYTE: u32 = 5121;
pub const UNSIGNED_SHORT: u32 = 5123;
pub const FLOAT: u32 = 5126;

/// A document and its one buffer. Node 0 is the root of the scene.
#[derive(Clone, Debug)]
pub struct Asset {
    pub json: Value,
    pub bytes: Vec<u8>,
}

impl Asset {
    pub fn new() -> Self {
        let json = json!({ "asset": { "version": "2.0" }, "scenes": [{ "nodes": [0] }] });
        Self { json, bytes: Vec::new() }
    }

    /// One root with a tetrahedron.
    pub fn tetrahedron() -> Self {
        let mut asset = Self::new();
        let primitive = asset.tetrahedron_primitive();
        asset.push("meshes", json!({ "primitives": [primitive] }));
        asset.push("nodes", json!({ "name": "root", "mesh": 0 }));
        asset
    }

    /// A primitive of four vertices and triangles.
    pub fn tetrahedron_primitive(&mut self) -> Value {
        let mesh = tetrahedron();
        let positions = self.floats("VEC3", mesh.positions.as_flattened());
        self.json["accessors"][positions]["min"] = json!([-1, -1, -1]);
        self.json["accessors"][positions]["max"] = json!([1, 1, 1]);
        let indices: Vec<u8> = mesh.triangles.as_flattened().iter().map(|&v| v as u8).collect();
        let indices = self.accessor(UNSIGNED_BYTE, "SCALAR", 12, &indices);
        json!({ "attributes": { "POSITION": positions }, "indices": indices })
    }

    /// Adds to a list of the document and returns the place in it.
    pub fn push(&mut self, list: &str, value: Value) -> usize {
        if self.json[list].is_null() {
            self.json[list] = json!([]);
        }
        let list = self.json[list].as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    }

    pub fn accessor(&mut self, component: u32, kind: &str, count: usize, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        self.bytes.extend(bytes);
        let view = self.push("bufferViews", view);
        self.push(
            "accessors",
            json!({ "bufferView": view, "componentType": component, "count": count, "type": kind }),
        )
    }

    pub fn floats(&mut self, kind: &str, numbers: &[f32]) -> usize {
        let width = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.accessor(FLOAT, kind, numbers.len() / width, &bytes)
    }

    /// Adds an animation of one channel, or a channel to the animation that is there.
    pub fn animate(&mut self, node: usize, path: &str, mode: &str, times: &[f32], values: &[f32]) {
        let kind = match path {
            "weights" => "SCALAR",
            "rotation" => "VEC4",
            _ => "VEC3",
        };
        let input = self.floats("SCALAR", times);
        let output = self.floats(kind, values);
        if self.json["animations"].is_null() {
            self.json["animations"] = json!([{ "channels": [], "samplers": [] }]);
        }
        let animation = &mut self.json["animations"][0];
        let samplers = animation["samplers"].as_array_mut().unwrap();
        samplers.push(json!({ "input": input, "output": output, "interpolation": mode }));
        let sampler = samplers.len() - 1;
        let target = json!({ "node": node, "path": path });
        animation["channels"].as_array_mut().unwrap().push(json!({ "sampler": sampler, "target": target }));
    }

    pub fn glb(&self) -> Vec<u8> {
        let mut bin = self.bytes.clone();
        bin.resize(bin.len().next_multiple_of(4), 0);
        let mut json = self.json.clone();
        json["buffers"] = json!([{ "byteLength": bin.len() }]);
        let mut json = serde_json::to_vec(&json).unwrap();
        json.resize(json.len().next_multiple_of(4), b' ');
        let word = |n: usize| (n as u32).to_le_bytes();
        let mut bytes = b"glTF\x02\0\0\0".to_vec();
        bytes.extend(word(28 + json.len() + bin.len()));
        bytes.extend(word(json.len()));
        bytes.extend(b"JSON");
        bytes.extend(json);
        bytes.extend(word(bin.len()));
        bytes.extend(b"BIN\0");
        bytes.extend(bin);
        bytes
    }

    pub fn load(&self) -> Result<Loaded, LoadError> {
        Folder::new().load("model.glb", self.glb())
    }

    pub fn refuse(&self) -> String {
        let error = self.load().unwrap_err().to_string();
        assert!(error.contains("model.glb: "), "{error}");
        error
    }

    pub fn reference(&self) -> Reference {
        Reference::from_glb(&self.glb())
    }
}
