//! The numbers of a PLY file.

use super::header::{Encoding, Scalar};

/// The numbers after the header, one after the other.
pub(super) struct Numbers<'a> {
    pub encoding: Encoding,
    /// What has not been read.
    pub rest: &'a [u8],
}

impl Numbers<'_> {
    /// The next number; an f64 holds every one of the format.
    pub fn next(&mut self, scalar: Scalar) -> Result<f64, String> {
        Ok(match scalar {
            _ if self.encoding == Encoding::Ascii => return self.word(),
            Scalar::I8 => i8::from_le_bytes(self.take()?).into(),
            Scalar::U8 => u8::from_le_bytes(self.take()?).into(),
            Scalar::I16 => i16::from_le_bytes(self.take()?).into(),
            Scalar::U16 => u16::from_le_bytes(self.take()?).into(),
            Scalar::I32 => i32::from_le_bytes(self.take()?).into(),
            Scalar::U32 => u32::from_le_bytes(self.take()?).into(),
            Scalar::F32 => f32::from_le_bytes(self.take()?).into(),
            Scalar::F64 => f64::from_le_bytes(self.take()?),
        })
    }

    /// The next bytes, lowest first.
    fn take<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let (&bytes, rest) = self.rest.split_first_chunk().ok_or("the file ends before it")?;
        self.rest = rest;
        Ok(if self.encoding == Encoding::BigEndian {
            std::array::from_fn(|k| bytes[N - 1 - k])
        } else {
            bytes
        })
    }

    fn word(&mut self) -> Result<f64, String> {
        let text = self.rest.trim_ascii_start();
        let end = text.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len());
        let (word, rest) = text.split_at(end);
        self.rest = rest;
        if word.is_empty() {
            return Err("the file ends before it".into());
        }
        let number = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        number.ok_or_else(|| "it holds a word that is no number".into())
    }

    /// The next number as a list's length, which the file need not be long enough for.
    pub fn length(&mut self, scalar: Scalar) -> Result<u64, String> {
        let length = self.next(scalar)?;
        if length >= 0.0 && length.fract() == 0.0 {
            Ok(length as u64)
        } else {
            Err(format!("it has a list of {length} entries"))
        }
    }
}
