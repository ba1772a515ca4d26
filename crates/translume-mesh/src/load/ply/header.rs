//! The header of a PLY file.

#[derive(Clone, Copy, Default, PartialEq)]
pub(super) enum Encoding {
    #[default]
    Ascii,
    LittleEndian,
    BigEndian,
}

#[derive(Clone, Copy)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// The statements before the numbers.
#[derive(Default)]
pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    pub ended: bool,
}

/// Rows of the same properties.
pub(super) struct Element {
    pub name: String,
    pub count: usize,
    pub properties: Vec<Property>,
}

/// A number of each row, or a list of numbers.
pub(super) struct Property {
    pub name: String,
    /// The type of a list's length; `None` for a single number.
    pub length: Option<Scalar>,
    pub scalar: Scalar,
}

impl Header {
    /// Takes in one line, without its end.
    pub fn line(&mut self, line: &[u8]) -> Result<(), String> {
        // Comments come in any encoding.
        let line = String::from_utf8_lossy(line);
        let words: Vec<&str> = line.split_ascii_whitespace().take(6).collect();
        match words[..] {
            ["format", encoding, _] => {
                self.encoding = match encoding {
                    "ascii" => Encoding::Ascii,
                    "binary_little_endian" => Encoding::LittleEndian,
                    "binary_big_endian" => Encoding::BigEndian,
                    _ => {
                        return Err(
                            "the format is none of ascii, binary_little_endian, binary_big_endian".into()
                        );
                    }
                };
            }
            ["element", name, count] => {
                let count = count.parse().map_err(|_| "the element's count is no number")?;
                if self.elements.iter().any(|element| element.name == name) {
                    return Err("the element is declared twice".into());
                }
                self.elements.push(Element { name: name.into(), count, properties: Vec::new() });
            }
            ["property", "list", length, scalar, name] => {
                self.property(name, Some(Scalar::named(length)?), Scalar::named(scalar)?)?;
            }
            ["property", scalar, name] => self.property(name, None, Scalar::named(scalar)?)?,
            ["end_header"] => self.ended = true,
            [] | ["ply"] | ["comment" | "obj_info", ..] => {}
            _ => return Err("it is no statement of a PLY header".into()),
        }
        Ok(())
    }

    fn property(&mut self, name: &str, length: Option<Scalar>, scalar: Scalar) -> Result<(), String> {
        let element = self.elements.last_mut().ok_or("the property belongs to no element")?;
        element.properties.push(Property { name: name.into(), length, scalar });
        Ok(())
    }
}

impl Scalar {
    fn named(name: &str) -> Result<Self, String> {
        Ok(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return Err("the property's type is unknown".into()),
        })
    }
}
