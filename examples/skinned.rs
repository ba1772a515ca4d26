//! An engine that skins its characters itself, in a compute shader, into its own vertex buffer. Translume reads positions and normals from
//! there: any stride and offset, the topology stays.
//!
//! `cargo run --release -p translume-examples --example skinned` writes `out/skinned.png`: a creature that sways. With a file that has a
//! skin and an animation, `-- fox.glb`, it shows that one half-way through its first.

#![allow(clippy::print_stdout, reason = "a program talks to its terminal")]

use std::error::Error;
use translume::{
    AmbientLight, BodyDescriptor, Config, Deformation, DirectionalLight, Frame, Gloss, HostVertices, Light,
    Lighting, Medium, PointLight, Region, Translume, VertexVectors, wgpu,
};
use translume_examples::{Compute, Host, Picture, camera};
use translume_mesh::{Atlas, AtlasOptions, Influence, Mesh, Skin, builtin, load, rig};

/// Joint matrices from the rest pose to the model, column-major.
type Joints = Vec<[[f32; 4]; 4]>;

/// Position, normal and texture coordinate: what this engine's vertices hold.
const STRIDE: u64 = 32;
const NORMAL: u64 = 12;

fn main() -> Result<(), Box<dyn Error>> {
    let host = Host::new()?;
    let (mesh, joints) = match std::env::args_os().nth(1) {
        Some(path) => from_file(path.as_ref())?,
        None => swaying(builtin::creature_with(20_000)),
    };
    let [low, high] = reach(&mesh, &joints)?;
    let size = (0..3).map(|k| high[k] - low[k]).fold(0.0, f32::max);

    // Once: the engine's buffers, and its skinning. The vertex buffer needs STORAGE besides VERTEX, for its own shader and for Translume's.
    let vertices = host.buffer(&interleaved(&mesh), wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::STORAGE);
    let storage = wgpu::BufferUsages::STORAGE;
    let buffers = [
        &host.buffer(&interleaved(&mesh), storage),
        &host.buffer(&influences(&mesh), storage),
        &host.buffer(&joints, storage),
        &vertices,
    ];
    let skinning = Compute::new(&host, include_str!("skinned.wgsl"), "skin", &buffers);
    let count = mesh.positions.len() as u32;

    // Once: the body, of the mesh in the engine's own numbering. Translume copies vertices at the seams of its atlas by itself (`xref`). Had
    // the mesh been repaired, `host_vertices: Some(&report.origins)` would say which vertices are left. Translume needs no skin.
    let translume = Translume::new(&host.device, &Config::default())?;
    let still = Mesh { skin: None, targets: Vec::new(), ..mesh };
    let atlas = Atlas::build(&still, &AtlasOptions { size: 256, ..Default::default() }, |_| true)?;
    let descriptor = BodyDescriptor {
        medium: Medium::SKIN1,
        // Whatever it is, it is 60 mm long.
        mm_per_unit: 60.0 / size,
        ..BodyDescriptor::new(&still, &atlas)
    };
    let mut body = translume.create_body(&host.device, &descriptor)?;

    // Each frame: skin, then light, in one encoder. `bounds` is what depth maps have to reach, `revision` says that vertices have moved.
    let of = |offset| VertexVectors { buffer: &vertices, offset, stride: STRIDE };
    let vertices = HostVertices {
        positions: of(0),
        normals: Some(of(NORMAL)),
        bounds: Region { low, high },
        revision: 1,
    };
    let at = |x: f32, y: f32, z: f32| std::array::from_fn(|k| 0.5 * (low[k] + high[k]) + size * [x, y, z][k]);
    let lamp = PointLight {
        position: at(-0.6, 0.6, -0.9),
        intensity: [6.0, 5.5, 5.0].map(|x| x * size * size),
        ..Default::default()
    };
    let sun = DirectionalLight { to_light: [0.9, 0.8, 0.4], irradiance: [2.2; 3], ..Default::default() };
    let sky = AmbientLight { radiance: [0.06; 3], ..Default::default() };
    let lights = [Light::Point(lamp), Light::Directional(sun), Light::Ambient(sky)];
    let frame = Frame {
        deformation: Deformation::Vertices(vertices),
        lighting: Lighting::Lights(&lights),
        ..Default::default()
    };
    body.prepare(&host.device, &host.queue, &frame)?;
    let mut encoder = host.encoder();
    skinning.encode(&mut encoder, count);
    body.encode(&mut encoder);

    let picture = Picture::new(&host, [480, 400]);
    let composite = translume.composite(&host.device, Picture::TARGET);
    let mut view = composite.view(&host.device, &body);
    let camera = camera(at(1.2, 0.3, 1.9), at(0.0, 0.0, 0.0), picture.aspect());
    view.prepare(&host.device, &host.queue, &body, &camera, Gloss::Rough(0.4));
    composite.draw(&mut picture.pass(&mut encoder), &view);
    host.queue.submit([encoder.finish()]);
    println!("wrote {}", picture.save(&host, "skinned")?.display());
    Ok(())
}

fn interleaved(mesh: &Mesh) -> Vec<[f32; 8]> {
    let vertices = mesh.positions.iter().zip(&mesh.normals);
    vertices.map(|(&[x, y, z], &[nx, ny, nz])| [x, y, z, nx, ny, nz, 0.0, 0.0]).collect()
}

/// Four joints and their weights, as bits.
fn influences(mesh: &Mesh) -> Vec<[u32; 8]> {
    let Some(skin) = &mesh.skin else { return vec![[0; 8]; mesh.positions.len()] };
    let vertex = |bound: &[Influence]| {
        let mut words = [0; 8];
        for (k, influence) in bound.iter().take(4).enumerate() {
            (words[k], words[4 + k]) = (influence.joint, influence.weight.to_bits());
        }
        words
    };
    skin.influences.chunks(skin.per_vertex).map(vertex).collect()
}

/// A mesh between two joints, of which the upper one leans.
fn swaying(mut mesh: Mesh) -> (Mesh, Joints) {
    let heights = || mesh.positions.iter().map(|p| p[1]);
    let (low, high) = (heights().fold(f32::MAX, f32::min), heights().fold(f32::MIN, f32::max));
    let influences = heights().flat_map(|y| {
        let share = ((y - low) / (high - low)).powi(2);
        [Influence { joint: 0, weight: 1.0 - share }, Influence { joint: 1, weight: share }]
    });
    mesh.skin = Some(Skin { joints: 2, per_vertex: 2, influences: influences.collect() });
    let (sine, cosine) = 0.5_f32.sin_cos();
    let identity = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    // A turn about z through the foot.
    let lean = [
        [cosine, sine, 0.0, 0.0],
        [-sine, cosine, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
        [sine * low, low - cosine * low, 0.0, 1.0],
    ];
    (mesh, vec![identity, lean])
}

/// A file's mesh, half-way through its first animation.
fn from_file(path: &std::path::Path) -> Result<(Mesh, Joints), Box<dyn Error>> {
    let loaded = load::load(path)?;
    let rig = loaded.rig.ok_or("this file moves nothing; give one with a skin, or none")?;
    let animation = rig.animations.first();
    let pose = rig.pose(animation, animation.map_or(0.0, |animation| 0.5 * animation.duration));
    Ok((loaded.mesh, pose.joints))
}

/// The corners of a box around the pose. An engine has one for culling.
fn reach(mesh: &Mesh, joints: &Joints) -> Result<[[f32; 3]; 2], Box<dyn Error>> {
    let pose = rig::Pose { weights: vec![0.0; mesh.targets.len()], joints: joints.clone() };
    let posed = rig::posed(mesh, &pose)?;
    let corner = |pick: fn(f32, f32) -> f32, first| {
        posed.iter().fold([first; 3], |corner: [f32; 3], p| std::array::from_fn(|k| pick(corner[k], p[k])))
    };
    Ok([corner(f32::min, f32::MAX), corner(f32::max, f32::MIN)])
}
