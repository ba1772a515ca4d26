//! Vertices that the host deforms in buffers of its own.

use glam::{DVec3, Mat4, Vec3};
use std::sync::Arc;
use translume::{
    Deformation, DirectionalLight, Error, Frame, HostVertices, Light, Lighting, Region, Stage, VertexVectors,
    Work, wgpu,
};
use translume_mesh::normals::{NormalAdjacency, deformed_normals};
use translume_mesh::{Warp, repair};
use translume_tests::{Check, Fixture, Model, Pose, at_most, creature, gpu, holds, notices, relative_rmse};
use wgpu::BufferUsages;

const MODEL: Mat4 = Mat4::from_cols_array(&[
    0.9, 0.1, 0.0, 0.0, -0.1, 1.1, 0.2, 0.0, 0.0, -0.2, 1.0, 0.0, 3.0, -2.0, 1.0, 1.0,
]);

/// Without a shadow, for depth maps reach as far as the host says and not as the library guesses: edges of shadows are drawn to another grid.
fn sun() -> [Light; 1] {
    [Light::Directional(DirectionalLight { to_light: [0.4, 0.8, -0.6], shadow: false, ..Default::default() })]
}

/// Where the host keeps its vertices.
struct Layout {
    /// Floats in front of the first.
    lead: usize,
    /// Floats from one to the next.
    stride: usize,
    /// From the position to the normal.
    normal: usize,
}

const TIGHT: Layout = Layout { lead: 0, stride: 6, normal: 3 };
/// Neither offset nor stride is a multiple of what bindings are aligned to.
const ODD: Layout = Layout { lead: 1003, stride: 11, normal: 7 };

/// The host's buffer: mesh vertex `k` is its vertex `numbers[k]`.
struct Host {
    buffer: wgpu::Buffer,
    layout: Layout,
    bounds: Region,
}

impl Host {
    fn new(layout: Layout, positions: &[[f32; 3]], normals: &[[f32; 3]], numbers: &[u32]) -> Self {
        let count = *numbers.iter().max().unwrap() as usize + 1;
        // What is nobody's must not matter.
        let mut floats = vec![f32::NAN; layout.lead + layout.stride * count];
        for (k, number) in numbers.iter().enumerate() {
            let at = layout.lead + layout.stride * *number as usize;
            floats[at..at + 3].copy_from_slice(&positions[k]);
            floats[at + layout.normal..at + layout.normal + 3].copy_from_slice(&normals[k]);
        }
        let buffer = buffer(4 * floats.len() as u64, BufferUsages::STORAGE | BufferUsages::COPY_DST);
        gpu().queue.write_buffer(&buffer, 0, bytemuck::cast_slice(&floats));
        let corner = |pick: fn(Vec3, Vec3) -> Vec3| {
            positions.iter().map(|p| Vec3::from(*p)).reduce(pick).unwrap().to_array()
        };
        Self { buffer, layout, bounds: Region { low: corner(Vec3::min), high: corner(Vec3::max) } }
    }

    fn vertices(&self, with_normals: bool, revision: u64) -> HostVertices<'_> {
        let of = |first: usize| VertexVectors {
            buffer: &self.buffer,
            offset: 4 * (self.layout.lead + first) as u64,
            stride: 4 * self.layout.stride as u64,
        };
        HostVertices {
            positions: of(0),
            normals: with_normals.then(|| of(self.layout.normal)),
            bounds: self.bounds,
            revision,
        }
    }
}

fn buffer(size: u64, usage: BufferUsages) -> wgpu::Buffer {
    gpu().device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("host"),
        size,
        usage,
        mapped_at_creation: false,
    })
}

fn frame<'a>(vertices: HostVertices<'a>, lights: &'a [Light]) -> Frame<'a> {
    Frame {
        model: MODEL.to_cols_array_2d(),
        deformation: Deformation::Vertices(vertices),
        lighting: Lighting::Lights(lights),
        ..Frame::default()
    }
}

/// The creature half melted, in the library's own way, and where its vertices are in model space.
fn melted(model: &Arc<Model>) -> (Fixture, Vec<[f32; 3]>) {
    let pose = Pose { model: MODEL, weights: vec![0.5], ..Pose::rest(1) };
    let mut fixture = Fixture::new(model, |_| ());
    let lights = sun();
    fixture.run(&pose.frame(&lights));
    let deltas = &model.mesh.targets[0].position_deltas;
    let moved = |(p, d): (&[f32; 3], &[f32; 3])| std::array::from_fn(|k| p[k] + 0.5 * d[k]);
    (fixture, model.mesh.positions.iter().zip(deltas).map(moved).collect())
}

/// A body that finds its vertices by these numbers.
fn numbered(model: &Arc<Model>, numbers: Option<&[u32]>) -> Fixture {
    Fixture::new(model, |d| d.host_vertices = numbers)
}

/// The unit normals of a pose in model space, as a host would skin them.
fn normals(model: &Model, positions: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let adjacency = NormalAdjacency::build(&model.mesh);
    deformed_normals(&adjacency, positions, &model.mesh.triangles)
}

/// Positions over the size of the body, normals, and radiant exitance.
fn agree(fixture: &Fixture, expected: &Fixture) -> Check {
    let furthest = |a: Vec<[f64; 3]>, b: Vec<[f64; 3]>| {
        a.iter().zip(&b).map(|(a, b)| DVec3::from(*a).distance((*b).into())).fold(0.0, f64::max)
    };
    // Roundings of 6e-8 in another order, as for poses against their twin.
    at_most("host vertices: positions", furthest(fixture.positions(), expected.positions()) / 150.0, 1e-6)?;
    at_most("host vertices: normals", furthest(fixture.normals(), expected.normals()), 2e-4)?;
    // The kernel table begins elsewhere, and the interpolation in each is right to 0.5 %.
    at_most("host vertices: exitance", relative_rmse(&fixture.exitance(), &expected.exitance()), 0.01)
}

#[test]
fn any_layout_gives_what_the_library_deforms() {
    let model = creature();
    let (expected, positions) = melted(&model);
    let normals = normals(&model, &positions);
    let count = positions.len() as u32;
    let straight: Vec<u32> = (0..count).collect();
    let backwards: Vec<u32> = (0..count).map(|k| count + 4 - k).collect();
    let lights = sun();
    for (layout, numbers) in [(TIGHT, None), (ODD, None), (ODD, Some(backwards.as_slice()))] {
        let host = Host::new(layout, &positions, &normals, numbers.unwrap_or(&straight));
        for with_normals in [true, false] {
            let mut fixture = numbered(&model, numbers);
            fixture.run(&frame(host.vertices(with_normals, 0), &lights));
            holds(agree(&fixture, &expected));
        }
    }
}

#[test]
fn a_wrong_stride_or_offset_is_noticed() {
    let model = creature();
    let (expected, positions) = melted(&model);
    let normals = normals(&model, &positions);
    let straight: Vec<u32> = (0..positions.len() as u32).collect();
    let host = Host::new(Layout { lead: 8, stride: 8, ..TIGHT }, &positions, &normals, &straight);
    let lights = sun();
    let wrong: [fn(&mut HostVertices<'_>); 3] = [
        |v| v.positions.stride = 12,
        |v| v.positions.offset += 4,
        |v| v.normals.iter_mut().for_each(|n| n.offset -= 12),
    ];
    for change in wrong {
        let mut vertices = host.vertices(true, 0);
        change(&mut vertices);
        let mut fixture = Fixture::new(&model, |_| ());
        fixture.run(&frame(vertices, &lights));
        notices(agree(&fixture, &expected));
    }
}

#[test]
fn a_repaired_mesh_finds_its_vertices() {
    // The host's mesh has vertices that no triangle uses.
    let model = creature();
    let mut mesh = model.mesh.clone();
    mesh.targets.clear();
    for k in [0, 100, 1000] {
        mesh.positions.insert(k, [f32::MAX; 3]);
        mesh.normals.insert(k, [0.0, 1.0, 0.0]);
        mesh.triangles.iter_mut().flatten().filter(|v| **v as usize >= k).for_each(|v| *v += 1);
    }
    let (positions, normals) = (mesh.positions.clone(), mesh.normals.clone());
    let numbers: Vec<u32> = (0..positions.len() as u32).collect();
    let (repaired, report) = repair::repair(mesh).unwrap();
    assert_eq!(report.dropped_vertices, 3);
    let mut host = Host::new(TIGHT, &positions, &normals, &numbers);
    host.bounds = Region { low: [-100.0; 3], high: [150.0; 3] };
    let model = Model::new(repaired, 64);
    let lights = sun();
    let mut expected = Fixture::new(&model, |_| ());
    expected.run(&Pose { model: MODEL, ..Pose::rest(0) }.frame(&lights));
    let mut fixture = numbered(&model, Some(&report.origins));
    fixture.run(&frame(host.vertices(true, 0), &lights));
    holds(agree(&fixture, &expected));
    let mut fixture = Fixture::new(&model, |_| ());
    fixture.run(&frame(host.vertices(true, 0), &lights));
    notices(agree(&fixture, &expected));
}

#[test]
fn nothing_runs_until_the_host_says_so() {
    let model = creature();
    let (_, positions) = melted(&model);
    let numbers: Vec<u32> = (0..positions.len() as u32).collect();
    let [first, second] = [(); 2].map(|()| Host::new(TIGHT, &positions, &model.mesh.normals, &numbers));
    let mut fixture = Fixture::new(&model, |_| ());
    let lights = sun();
    fixture.run(&frame(first.vertices(true, 7), &lights));
    fixture.prepare(&frame(first.vertices(true, 7), &lights)).unwrap();
    assert_eq!(fixture.encode(), Work::default());
    // Another revision, another buffer, as of a host that takes turns with two, and back to the library's own pose.
    for vertices in [first.vertices(true, 8), second.vertices(true, 8), first.vertices(false, 8)] {
        fixture.prepare(&frame(vertices, &lights)).unwrap();
        assert!(fixture.body.pending().contains(Stage::Deform));
        fixture.encode();
    }
    let rest = Pose { model: MODEL, ..Pose::rest(1) };
    fixture.run(&rest.frame(&lights));
    let mut expected = Fixture::new(&model, |_| ());
    expected.run(&rest.frame(&lights));
    holds(agree(&fixture, &expected));
}

#[test]
fn what_cannot_be_read_is_refused_in_words() {
    let model = creature();
    let (_, positions) = melted(&model);
    let numbers: Vec<u32> = (0..positions.len() as u32).collect();
    let host = Host::new(TIGHT, &positions, &model.mesh.normals, &numbers);
    let (small, deaf) =
        (buffer(256, BufferUsages::STORAGE), buffer(host.buffer.size(), BufferUsages::VERTEX));
    let good = host.vertices(true, 0);
    let positions = good.positions;
    let refused = [
        (
            HostVertices { positions: VertexVectors { buffer: &small, ..positions }, ..good },
            "end after 256 bytes",
        ),
        (HostVertices { positions: VertexVectors { buffer: &deaf, ..positions }, ..good }, "usage STORAGE"),
        (HostVertices { positions: VertexVectors { stride: 8, ..positions }, ..good }, "stride 8"),
        (HostVertices { positions: VertexVectors { offset: 2, ..positions }, ..good }, "offset 2"),
        (
            HostVertices { normals: Some(VertexVectors { buffer: &small, ..positions }), ..good },
            "normals end after",
        ),
        (
            HostVertices { positions: VertexVectors { stride: u64::MAX - 3, ..positions }, ..good },
            "end after",
        ),
        (HostVertices { bounds: Region { low: [1.0; 3], high: [0.0; 3] }, ..good }, "lie between"),
        (HostVertices { bounds: Region { low: [f32::NAN; 3], high: [0.0; 3] }, ..good }, "lie between"),
    ];
    let mut fixture = Fixture::new(&model, |_| ());
    for (vertices, words) in refused {
        let error = fixture.prepare(&frame(vertices, &[])).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
    }
    let warped = Frame { warp: Warp { twist: 1.0, ..Default::default() }, ..frame(good, &[]) };
    assert!(matches!(fixture.prepare(&warped), Err(Error::Frame { .. })));
    fixture.prepare(&frame(good, &[])).unwrap();
    let made = vec![repair::RepairReport::NEW; numbers.len()];
    for (numbers, words) in
        [(&made[..], "vertex 0 is none of the host's"), (&numbers[1..], "numbers of the host for")]
    {
        let error = Fixture::try_new(&model, |d| d.host_vertices = Some(numbers)).map(|_| ()).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
    }
}
