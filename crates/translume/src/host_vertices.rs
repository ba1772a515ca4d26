//! Vertices that the host computes in buffers of its own, and what it takes to read them.

use crate::bounds::Bounds;
use crate::buffers::Buffers;
use crate::gpu;
use crate::layout::AdoptLayout;
use crate::stages::deform::Deform;
use crate::{Error, Region};
use wgpu::BufferUsages;

/// A frame's vertices in the host's own buffers, as its skinning left them: model space, numbered as the body's mesh or as
/// [`BodyDescriptor::host_vertices`](crate::BodyDescriptor::host_vertices) says. Copies of a vertex at seams of the mesh each have their own.
///
/// ```
/// # fn example(vertex_buffer: &translume::wgpu::Buffer, frame_number: u64) {
/// use translume::{Deformation, Frame, HostVertices, Region, VertexVectors};
///
/// // Position, normal and texture coordinate, 32 bytes a vertex.
/// let of = |offset| VertexVectors { buffer: vertex_buffer, offset, stride: 32 };
/// let vertices = HostVertices {
///     positions: of(0),
///     normals: Some(of(12)),
///     bounds: Region { low: [-1.0, 0.0, -1.0], high: [1.0, 2.0, 1.0] },
///     revision: frame_number,
/// };
/// let frame = Frame { deformation: Deformation::Vertices(vertices), ..Default::default() };
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HostVertices<'a> {
    /// Positions.
    pub positions: VertexVectors<'a>,
    /// Normals of any length but 0, or `None` to have them computed from the triangles.
    pub normals: Option<VertexVectors<'a>>,
    /// A box around the positions, model space: what depth maps and the kernel table reach. What lies outside casts no shadow.
    pub bounds: Region,
    /// Another number than in the last frame says that the content has changed.
    pub revision: u64,
}

/// One vector of each vertex: three 32-bit floats.
///
/// ```
/// # fn example(positions: &translume::wgpu::Buffer) {
/// use translume::VertexVectors;
///
/// // Tightly packed, from vertex 100 on.
/// let vectors = VertexVectors { buffer: positions, offset: 100 * 12, stride: 12 };
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VertexVectors<'a> {
    /// Where they are. The buffer needs the usage `STORAGE`.
    pub buffer: &'a wgpu::Buffer,
    /// Bytes in front of the first one; a multiple of 4.
    pub offset: u64,
    /// Bytes from one to the next; a multiple of 4, 12 at least.
    pub stride: u64,
}

/// Bytes of a vector.
const VECTOR: u64 = 12;
/// So many places of vertices are remembered: hosts that take turns have two or three.
const PLACES: usize = 4;

/// What a pose keeps of them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Adopted {
    positions: Place,
    normals: Option<Place>,
    pub bounds: Bounds,
    revision: u64,
}

#[derive(Clone, Debug, PartialEq)]
struct Place {
    buffer: wgpu::Buffer,
    offset: u64,
    stride: u64,
}

impl Adopted {
    pub fn new(vertices: &HostVertices<'_>) -> Result<Self, Error> {
        let Region { low, high } = vertices.bounds;
        let bounds = Bounds { low: low.into(), high: high.into() };
        if !(bounds.low.is_finite() && bounds.high.is_finite() && bounds.low.cmple(bounds.high).all()) {
            return Err(Error::Frame {
                problem: format!("the host's vertices lie between {low:?} and {high:?}"),
                remedy: "give finite corners, the lower one first",
            });
        }
        let place = |vectors: &VertexVectors<'_>| Place {
            buffer: vectors.buffer.clone(),
            offset: vectors.offset,
            stride: vectors.stride,
        };
        let (positions, normals) = (place(&vertices.positions), vertices.normals.as_ref().map(place));
        Ok(Self { positions, normals, bounds, revision: vertices.revision })
    }

    pub fn has_normals(&self) -> bool {
        self.normals.is_some()
    }
}

impl Place {
    /// Bytes up to the end of vertex `last`.
    fn end(&self, last: u32) -> u64 {
        self.offset.saturating_add(self.stride.saturating_mul(last.into())).saturating_add(VECTOR)
    }

    /// Where a binding may begin.
    fn base(&self, limits: &wgpu::Limits) -> u64 {
        self.offset - self.offset % u64::from(limits.min_storage_buffer_offset_alignment)
    }

    /// Words from there.
    fn words(&self, limits: &wgpu::Limits) -> [u32; 2] {
        [self.offset - self.base(limits), self.stride].map(|bytes| (bytes / 4) as u32)
    }

    fn check(&self, what: &str, last: u32, limits: &wgpu::Limits) -> Result<(), Error> {
        let fail =
            |problem: String, remedy| Err(Error::Frame { problem: format!("{what} {problem}"), remedy });
        let Self { buffer, offset, stride } = self;
        if !buffer.usage().contains(BufferUsages::STORAGE) {
            return fail("cannot be read by shaders".to_owned(), "create the buffer with the usage STORAGE");
        }
        if offset % 4 != 0 || stride % 4 != 0 || *stride < VECTOR {
            let remedy = "give multiples of 4, and a stride of 12 or more";
            return fail(format!("have offset {offset} and stride {stride}"), remedy);
        }
        if self.end(last) > buffer.size() {
            let (has, needs) = (buffer.size(), self.end(last));
            return fail(
                format!("end after {has} bytes, but vertex {last} after {needs}"),
                "give the buffer of this body's mesh, or say which vertices are its own (`BodyDescriptor::host_vertices`)",
            );
        }
        let (required, actual) = (self.end(last) - self.base(limits), limits.max_storage_buffer_binding_size);
        if required > actual {
            return Err(Error::Limit {
                what: what.to_owned(),
                limit: "max_storage_buffer_binding_size",
                required,
                actual,
                remedy: "keep the vertices of a body close together, or create the device with higher limits",
            });
        }
        Ok(())
    }

    fn binding(&self, last: u32, limits: &wgpu::Limits) -> wgpu::BindingResource<'_> {
        let offset = self.base(limits);
        let size = wgpu::BufferSize::new(self.end(last) - offset);
        wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer: &self.buffer, offset, size })
    }
}

/// Which vertices of the host are a body's, and the bindings of the places where they were found.
pub(crate) struct HostNumbers {
    /// `None` where they are numbered alike.
    numbers: Option<Vec<u32>>,
    last: u32,
    memory: Option<Memory>,
}

struct Memory {
    uniform: wgpu::Buffer,
    numbers: wgpu::Buffer,
    /// The newest first.
    groups: Vec<([Place; 2], wgpu::BindGroup)>,
}

impl HostNumbers {
    pub fn new(numbers: Option<&[u32]>, vertices: u32) -> Self {
        let last = match numbers {
            Some(numbers) => numbers.iter().copied().max().unwrap_or_default(),
            None => vertices.saturating_sub(1),
        };
        Self { numbers: numbers.map(<[u32]>::to_vec), last, memory: None }
    }

    pub fn check(&self, adopted: &Adopted, limits: &wgpu::Limits) -> Result<(), Error> {
        adopted.positions.check("the host's positions", self.last, limits)?;
        let normals = adopted.normals.as_ref();
        normals.map_or(Ok(()), |place| place.check("the host's normals", self.last, limits))
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.memory.as_ref().map_or(0, |memory| memory.uniform.size() + memory.numbers.size())
    }

    /// What the next frame reads.
    pub fn group(&self) -> Option<&wgpu::BindGroup> {
        self.memory.as_ref()?.groups.first().map(|(_, group)| group)
    }

    pub fn prepare(
        &mut self,
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        (stage, buffers): (&Deform, &Buffers),
        adopted: &Adopted,
        limits: &wgpu::Limits,
    ) {
        let memory = self.memory.get_or_insert_with(|| {
            let alike = || (0..=self.last).collect();
            let numbers = self.numbers.clone().unwrap_or_else(alike);
            Memory {
                uniform: gpu::uniform_buffer(device, "adopt", size_of::<AdoptLayout>() as u64),
                numbers: gpu::buffer_with(device, "host vertices", BufferUsages::STORAGE, &numbers),
                groups: Vec::with_capacity(PLACES + 1),
            }
        });
        let positions = &adopted.positions;
        let normals = adopted.normals.as_ref();
        let [first_position, position_stride] = positions.words(limits);
        let [first_normal, normal_stride] = normals.map_or([0; 2], |place| place.words(limits));
        let layout = AdoptLayout { first_position, position_stride, first_normal, normal_stride };
        queue.write_buffer(&memory.uniform, 0, bytemuck::bytes_of(&layout));
        // Unread where there are none, but a binding may not be empty.
        let places = [positions, normals.unwrap_or(positions)];
        let known = memory.groups.iter().position(|(known, _)| known.iter().eq(places));
        match known {
            Some(k) => memory.groups[..=k].rotate_right(1),
            None => {
                let host = places.map(|place| place.binding(self.last, limits));
                let group = stage.bind_host(device, buffers, &memory.uniform, host, &memory.numbers);
                memory.groups.insert(0, (places.map(Clone::clone), group));
                memory.groups.truncate(PLACES);
            }
        }
    }
}
