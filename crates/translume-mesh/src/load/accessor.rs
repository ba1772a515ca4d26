//! Numbers out of glTF buffers. Every range is checked against the bytes that are there before anything is read or reserved.
//!
//! Source: Khronos, glTF 2.0 specification, section 3.6.2.

use gltf::Accessor;
use gltf::accessor::{DataType, Dimensions, sparse};

/// Elements of one size at a stride within some bytes.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
    count: usize,
}

impl<'a> Elements<'a> {
    fn new(
        buffers: &'a [Vec<u8>],
        view: &gltf::buffer::View<'_>,
        offset: usize,
        size: usize,
        count: usize,
    ) -> Result<Self, String> {
        let buffer = buffers.get(view.buffer().index()).map_or(&[][..], Vec::as_slice);
        let end = view.offset().checked_add(view.length());
        let bytes = end.and_then(|end| buffer.get(view.offset()..end)).ok_or_else(|| {
            format!(
                "bufferViews[{}] is {} bytes from byte {}, but its buffer has {}",
                view.index(),
                view.length(),
                view.offset(),
                buffer.len()
            )
        })?;
        let stride = view.stride().unwrap_or(size);
        let needed = count
            .checked_sub(1)
            .map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(size)?.checked_add(offset));
        if needed.is_none_or(|needed| needed > bytes.len()) {
            return Err(format!(
                "{count} elements of {size} bytes from byte {offset} do not fit bufferViews[{}] of {} bytes",
                view.index(),
                bytes.len()
            ));
        }
        Ok(Self { bytes: bytes.get(offset..).unwrap_or_default(), stride, size, count })
    }

    fn iter(&self) -> impl Iterator<Item = &'a [u8]> {
        let (bytes, stride, size) = (self.bytes, self.stride, self.size);
        (0..self.count).map(move |k| &bytes[k * stride..k * stride + size])
    }
}

/// Reads `expected` three-component vectors; integers where `KHR_mesh_quantization` allows them.
pub(super) fn vectors(
    accessor: &Accessor<'_>,
    buffers: &[Vec<u8>],
    expected: usize,
) -> Result<Vec<[f32; 3]>, String> {
    if accessor.dimensions() != Dimensions::Vec3 || accessor.data_type() == DataType::U32 {
        return Err(format!(
            "it holds {:?} of {:?}, not vectors of three numbers",
            accessor.dimensions(),
            accessor.data_type()
        ));
    }
    if accessor.count() != expected {
        return Err(format!("it has {} elements, but there are {expected} vertices", accessor.count()));
    }
    let decode = |bytes: &[u8]| {
        let size = accessor.data_type().size();
        let mut components = bytes.chunks_exact(size);
        std::array::from_fn(|_| {
            components.next().map_or(0.0, |bytes| number(bytes, accessor.data_type(), accessor.normalized()))
        })
    };
    let mut vectors: Vec<[f32; 3]> = match accessor.view() {
        Some(view) => {
            let elements = Elements::new(buffers, &view, accessor.offset(), accessor.size(), expected)?;
            elements.iter().map(decode).collect()
        }
        None => vec![[0.0; 3]; expected],
    };
    if let Some(sparse) = accessor.sparse() {
        let values = sparse.values();
        let values =
            Elements::new(buffers, &values.view(), values.offset(), accessor.size(), sparse.count())?;
        for (at, bytes) in sparse_indices(&sparse, buffers)?.into_iter().zip(values.iter()) {
            *vectors.get_mut(at as usize).ok_or_else(|| {
                format!("its sparse data replaces element {at}, but there are {expected}")
            })? = decode(bytes);
        }
    }
    Ok(vectors)
}

/// Number of positions that an accessor can hold: without a buffer view the count would be bounded by nothing.
pub(super) fn position_count(accessor: &Accessor<'_>) -> Result<usize, String> {
    if accessor.view().is_none() {
        return Err("positions have no buffer view".into());
    }
    Ok(accessor.count())
}

/// Reads vertex indices.
pub(super) fn indices(accessor: &Accessor<'_>, buffers: &[Vec<u8>]) -> Result<Vec<u32>, String> {
    let integer = matches!(accessor.data_type(), DataType::U8 | DataType::U16 | DataType::U32);
    if accessor.dimensions() != Dimensions::Scalar || !integer || accessor.sparse().is_some() {
        return Err("indices must be plain unsigned integers".into());
    }
    let view = accessor.view().ok_or("indices have no buffer view")?;
    let elements = Elements::new(buffers, &view, accessor.offset(), accessor.size(), accessor.count())?;
    Ok(elements.iter().map(unsigned).collect())
}

fn sparse_indices(sparse: &sparse::Sparse<'_>, buffers: &[Vec<u8>]) -> Result<Vec<u32>, String> {
    let indices = sparse.indices();
    let size = indices.index_type().size();
    let elements = Elements::new(buffers, &indices.view(), indices.offset(), size, sparse.count())?;
    Ok(elements.iter().map(unsigned).collect())
}

/// One to four bytes, little-endian.
fn unsigned(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |value, &byte| value << 8 | u32::from(byte))
}

/// One component, little-endian; normalised integers as in the specification's section 3.11.
fn number(bytes: &[u8], data_type: DataType, normalized: bool) -> f32 {
    let bits = unsigned(bytes);
    let (value, largest) = match data_type {
        DataType::I8 => (f32::from(bits as u8 as i8), 127.0),
        DataType::U8 => (f32::from(bits as u8), 255.0),
        DataType::I16 => (f32::from(bits as u16 as i16), 32767.0),
        DataType::U16 => (f32::from(bits as u16), 65535.0),
        DataType::U32 => (bits as f32, u32::MAX as f32),
        DataType::F32 => return f32::from_bits(bits),
    };
    if normalized { (value / largest).max(-1.0) } else { value }
}
