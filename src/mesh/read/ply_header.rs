//! The header of a PLY file: which elements follow, with which properties.

use super::text::{lines, place, shown, word};
use crate::mesh::error::{Parsed, fault};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    Little,
    Big,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

impl Scalar {
    fn named(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

#[derive(Debug)]
pub(super) struct Property {
    pub name: Vec<u8>,
    /// The type of the length, for a list.
    pub list: Option<Scalar>,
    pub of: Scalar,
}

#[derive(Debug)]
pub(super) struct Element {
    pub name: Vec<u8>,
    pub count: u64,
    pub properties: Vec<Property>,
}

impl Element {
    /// The bytes that one row takes at least.
    pub fn least(&self, encoding: Encoding) -> u64 {
        let bytes = |p: &Property| match encoding {
            Encoding::Ascii => 2, // a digit and a blank
            _ => p.list.unwrap_or(p.of).size() as u64,
        };
        self.properties.iter().map(bytes).sum()
    }
}

pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Bytes up to the first row.
    pub length: usize,
    /// Lines up to the first row.
    pub lines: u64,
}

pub(super) fn header(bytes: &[u8]) -> Parsed<Header> {
    let mut input = lines(bytes);
    let magic = input.next().map_or(&[][..], |l| l.1);
    if magic.trim_ascii_end() != b"ply" {
        return fault(place(1), format!("`{}`; a PLY file begins with `ply`", shown(magic)));
    }
    let mut length = magic.len() + 1;
    let mut encoding = None;
    let mut elements: Vec<Element> = vec![];
    for (at, line) in input {
        length += line.len() + 1;
        let mut rest = line;
        let Some(key) = word(&mut rest) else { continue };
        match key {
            b"comment" | b"obj_info" => {}
            b"format" => encoding = Some(format(&mut rest, at)?),
            b"element" => elements.push(element(&mut rest, at)?),
            b"property" => match elements.last_mut() {
                Some(e) => e.properties.push(property(&mut rest, at)?),
                None => return fault(place(at), "property before any element"),
            },
            b"end_header" => {
                let Some(encoding) = encoding else {
                    return fault(place(at), "no format line");
                };
                return Ok(Header { encoding, elements, length, lines: at });
            }
            _ => return fault(place(at), format!("unknown header word `{}`", shown(key))),
        }
    }
    fault("header", "no end_header: the file was cut short")
}

fn format(rest: &mut &[u8], at: u64) -> Parsed<Encoding> {
    match word(rest) {
        Some(b"ascii") => Ok(Encoding::Ascii),
        Some(b"binary_little_endian") => Ok(Encoding::Little),
        Some(b"binary_big_endian") => Ok(Encoding::Big),
        w => fault(place(at), format!("unknown format `{}`", shown(w.unwrap_or_default()))),
    }
}

fn element(rest: &mut &[u8], at: u64) -> Parsed<Element> {
    let name = word(rest).unwrap_or_default();
    let count = word(rest).unwrap_or_default();
    match std::str::from_utf8(count).ok().and_then(|s| s.parse().ok()) {
        Some(count) => Ok(Element { name: name.into(), count, properties: vec![] }),
        None => {
            let (name, count) = (shown(name), shown(count));
            fault(place(at), format!("element {name} counts `{count}`, not a number"))
        }
    }
}

fn property(rest: &mut &[u8], at: u64) -> Parsed<Property> {
    let scalar = |w: Option<&[u8]>| match w.and_then(Scalar::named) {
        Some(s) => Ok(s),
        None => fault(place(at), format!("unknown type `{}`", shown(w.unwrap_or_default()))),
    };
    let first = word(rest);
    let (list, of) = if first == Some(b"list") {
        (Some(scalar(word(rest))?), scalar(word(rest))?)
    } else {
        (None, scalar(first)?)
    };
    match word(rest) {
        Some(name) => Ok(Property { name: name.into(), list, of }),
        None => fault(place(at), "a property without a name"),
    }
}
