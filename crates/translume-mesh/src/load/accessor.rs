//! Numbers out of glTF buffers. Every range is checked against the bytes that are there before anything is read or reserved.
//!
//! Source: Khronos, glTF 2.0 specification, section 3.6.2.

use gltf::Accessor;
use gltf::accessor::{DataType, Dimensions, sparse};

use super::buffers::Buffer;

/// Elements of one size at a stride within some bytes.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
    count: usize,
}

impl<'a> Elements<'a> {
    fn new(
        buffers: &'a [Buffer],
        view: &gltf::buffer::View<'_>,
        offset: usize,
        size: usize,
        count: usize,
    ) -> Result<Self, String> {
        let buffer = buffers.get(view.buffer().index()).map_or(&[][..], Buffer::bytes);
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

/// Reads `of.0` elements of `N` numbers, one for each of what `of.1` names; integers where the format or
/// `KHR_mesh_quantization` allows them.
pub(super) fn numbers<const N: usize>(
    accessor: &Accessor<'_>,
    buffers: &[Buffer],
    of: (usize, &str),
) -> Result<Vec<[f32; N]>, String> {
    let (dimensions, kind) = match N {
        1 => (Dimensions::Scalar, "plain numbers"),
        2 => (Dimensions::Vec2, "vectors of two numbers"),
        3 => (Dimensions::Vec3, "vectors of three numbers"),
        _ => (Dimensions::Vec4, "vectors of four numbers"),
    };
    let (data_type, normalized) = (accessor.data_type(), accessor.normalized());
    if accessor.dimensions() != dimensions || data_type == DataType::U32 {
        return Err(format!("it holds {:?} of {data_type:?}, not {kind}", accessor.dimensions()));
    }
    check_count(accessor, of)?;
    elements(accessor, buffers, of.0, |bytes| number(bytes, data_type, normalized))
}

/// Reads the inverse bind matrices of `joints` joints; there may be more.
pub(super) fn inverse_binds(
    accessor: &Accessor<'_>,
    buffers: &[Buffer],
    joints: usize,
) -> Result<Vec<[f32; 16]>, String> {
    if accessor.dimensions() != Dimensions::Mat4 || accessor.data_type() != DataType::F32 {
        return Err(format!(
            "it holds {:?} of {:?}, not matrices of four by four numbers",
            accessor.dimensions(),
            accessor.data_type()
        ));
    }
    if accessor.count() < joints {
        check_count(accessor, (joints, "joints"))?;
    }
    elements(accessor, buffers, joints, |bytes| number(bytes, DataType::F32, false))
}

/// Reads the joints that each vertex names.
pub(super) fn joints(
    accessor: &Accessor<'_>,
    buffers: &[Buffer],
    vertices: usize,
) -> Result<Vec<[u32; 4]>, String> {
    let data_type = accessor.data_type();
    let small = matches!(data_type, DataType::U8 | DataType::U16);
    if accessor.dimensions() != Dimensions::Vec4 || !small || accessor.normalized() {
        return Err(format!(
            "it holds {:?} of {data_type:?}, not vectors of four joints in 8 or 16 bits",
            accessor.dimensions()
        ));
    }
    check_count(accessor, (vertices, "vertices"))?;
    elements(accessor, buffers, vertices, unsigned)
}

fn check_count(accessor: &Accessor<'_>, (expected, of): (usize, &str)) -> Result<(), String> {
    let count = accessor.count();
    if count == expected {
        Ok(())
    } else {
        Err(format!("it has {count} elements, but there are {expected} {of}"))
    }
}

/// Reads the first `count` elements of `N` components, zero where the accessor has no data; then what its sparse part
/// replaces.
fn elements<T: Copy + Default, const N: usize>(
    accessor: &Accessor<'_>,
    buffers: &[Buffer],
    count: usize,
    component: impl Fn(&[u8]) -> T,
) -> Result<Vec<[T; N]>, String> {
    let size = accessor.data_type().size();
    let decode = |bytes: &[u8]| {
        let mut components = bytes.chunks_exact(size);
        std::array::from_fn(|_| components.next().map_or(T::default(), &component))
    };
    let mut read: Vec<[T; N]> = match accessor.view() {
        Some(view) => {
            let elements =
                Elements::new(buffers, &view, accessor.offset(), accessor.size(), accessor.count())?;
            elements.iter().take(count).map(decode).collect()
        }
        None => vec![[T::default(); N]; count],
    };
    if let Some(sparse) = accessor.sparse() {
        if sparse.count() > count {
            return Err(format!("its sparse data replaces {} elements of {count}", sparse.count()));
        }
        let values = sparse.values();
        let values =
            Elements::new(buffers, &values.view(), values.offset(), accessor.size(), sparse.count())?;
        for (at, bytes) in sparse_indices(&sparse, buffers)?.into_iter().zip(values.iter()) {
            *read
                .get_mut(at as usize)
                .ok_or_else(|| format!("its sparse data replaces element {at}, but there are {count}"))? =
                decode(bytes);
        }
    }
    Ok(read)
}

/// Number of elements, all of them within the bytes: without a buffer view it would be bounded by nothing.
pub(super) fn count(accessor: &Accessor<'_>, buffers: &[Buffer], what: &str) -> Result<usize, String> {
    let view = accessor.view().ok_or_else(|| format!("{what} have no buffer view"))?;
    Elements::new(buffers, &view, accessor.offset(), accessor.size(), accessor.count())?;
    Ok(accessor.count())
}

/// Reads vertex indices.
pub(super) fn indices(accessor: &Accessor<'_>, buffers: &[Buffer]) -> Result<Vec<u32>, String> {
    let integer = matches!(accessor.data_type(), DataType::U8 | DataType::U16 | DataType::U32);
    if accessor.dimensions() != Dimensions::Scalar || !integer || accessor.sparse().is_some() {
        return Err("indices must be plain unsigned integers".into());
    }
    let view = accessor.view().ok_or("indices have no buffer view")?;
    let elements = Elements::new(buffers, &view, accessor.offset(), accessor.size(), accessor.count())?;
    Ok(elements.iter().map(unsigned).collect())
}

fn sparse_indices(sparse: &sparse::Sparse<'_>, buffers: &[Buffer]) -> Result<Vec<u32>, String> {
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
