//! PLY, ASCII and binary of either byte order. Elements and properties other than the points and
//! the corners of faces are passed over.

use super::{
    ply_header::{Element, Encoding, Header, Property, Scalar, header},
    text::{number, place, short, shown},
};
use crate::mesh::{
    error::{Parsed, fault},
    soup::Soup,
};
use glam::DVec3;

pub(super) fn read(bytes: &[u8]) -> Parsed<Soup> {
    if bytes.is_empty() {
        return Ok(Soup::default());
    }
    let head = header(bytes)?;
    let mut soup = Soup::default();
    let mut values = Values::after(&head, bytes);
    for element in &head.elements {
        values.has_room(element)?;
        match element.name.as_slice() {
            b"vertex" => points(element, &mut values, &mut soup)?,
            b"face" => faces(element, &mut values, &mut soup)?,
            b"tristrips" => {
                return fault("element tristrips", "triangle strips in PLY are not read");
            }
            _ => skip(element, &mut values)?,
        }
    }
    Ok(soup)
}

fn points<'a>(element: &'a Element, values: &mut Values<'a>, soup: &mut Soup) -> Parsed<()> {
    let axis = |name: &[u8]| element.properties.iter().position(|p| p.name == name);
    let (Some(x), Some(y), Some(z)) = (axis(b"x"), axis(b"y"), axis(b"z")) else {
        return fault("element vertex", "no properties x, y and z");
    };
    let mut row = vec![0.0; element.properties.len()];
    for i in 0..element.count {
        let line = values.start(element, i)?;
        for (value, property) in row.iter_mut().zip(&element.properties) {
            *value = values.property(property, |_| {})?;
        }
        soup.points.push(DVec3::new(row[x], row[y], row[z]));
        soup.point_lines.extend(line);
    }
    Ok(())
}

fn faces<'a>(element: &'a Element, values: &mut Values<'a>, soup: &mut Soup) -> Parsed<()> {
    let is_corners = |p: &Property| {
        p.list.is_some() && (p.name == b"vertex_indices" || p.name == b"vertex_index")
    };
    let Some(which) = element.properties.iter().position(is_corners) else {
        return fault("element face", "no list property vertex_indices");
    };
    for i in 0..element.count {
        let line = values.start(element, i)?;
        let before = soup.corners.len();
        for (k, property) in element.properties.iter().enumerate() {
            if k != which {
                values.property(property, |_| {})?;
                continue;
            }
            let mut wrong = None;
            values.property(property, |v| {
                if v >= 0.0 && v < f64::from(u32::MAX) && v.fract() == 0.0 {
                    soup.corners.push(v as u32);
                } else {
                    wrong = Some(v);
                }
            })?;
            if let Some(v) = wrong {
                return fault(values.place(), format!("corner {v} is no index of a point"));
            }
        }
        soup.sizes.push((soup.corners.len() - before) as u32);
        soup.lines.extend(line);
    }
    Ok(())
}

fn skip<'a>(element: &'a Element, values: &mut Values<'a>) -> Parsed<()> {
    if element.properties.is_empty() {
        return Ok(()); // rows of no bytes, however many
    }
    for i in 0..element.count {
        values.start(element, i)?;
        for property in &element.properties {
            values.property(property, |_| {})?;
        }
    }
    Ok(())
}

/// The numbers after the header, one by one.
struct Values<'a> {
    rest: &'a [u8],
    encoding: Encoding,
    line: u64,
    element: &'a [u8],
    row: u64,
}

impl<'a> Values<'a> {
    fn after(head: &Header, bytes: &'a [u8]) -> Self {
        let rest = bytes.get(head.length..).unwrap_or_default();
        Self { rest, encoding: head.encoding, line: head.lines + 1, element: b"", row: 0 }
    }

    /// Refuses a count that the bytes left cannot hold.
    fn has_room(&self, element: &Element) -> Parsed<()> {
        let least = element.least(self.encoding);
        // The blank after the last number of a text file may be missing.
        if element.count.checked_mul(least).is_none_or(|n| n > self.rest.len() as u64 + 1) {
            let (name, count, left) = (shown(&element.name), element.count, self.rest.len());
            let why = format!("{count} rows of at least {least} bytes, but only {left} are left");
            return fault(format!("element {name}"), why);
        }
        Ok(())
    }

    /// Goes to a row; its line, in a text file.
    fn start(&mut self, element: &'a Element, row: u64) -> Parsed<Option<u32>> {
        (self.element, self.row) = (&element.name, row);
        if self.encoding == Encoding::Ascii {
            self.skip_blanks();
            return Ok(Some(short(self.line)));
        }
        Ok(None)
    }

    fn place(&self) -> String {
        let row = format!("{} {}", shown(self.element), self.row);
        match self.encoding {
            Encoding::Ascii => format!("{} ({row})", place(self.line)),
            _ => row,
        }
    }

    /// Reads a property: each value of a list goes to `each`; a scalar is returned.
    fn property(&mut self, property: &Property, mut each: impl FnMut(f64)) -> Parsed<f64> {
        let Some(length) = property.list else {
            return self.value(property.of);
        };
        let n = self.value(length)?;
        if !(n >= 0.0 && n <= self.rest.len() as f64 && n.fract() == 0.0) {
            return fault(self.place(), format!("a list of {n} values, more than the file has"));
        }
        for _ in 0..n as usize {
            each(self.value(property.of)?);
        }
        Ok(n)
    }

    fn value(&mut self, of: Scalar) -> Parsed<f64> {
        if self.encoding == Encoding::Ascii {
            return self.word();
        }
        let Some((b, rest)) = self.rest.split_at_checked(of.size()) else {
            return fault(self.place(), "the file ends here: it was cut short");
        };
        self.rest = rest;
        Ok(decode(b, of, self.encoding == Encoding::Big))
    }

    fn skip_blanks(&mut self) {
        while let [b, rest @ ..] = self.rest {
            if !b.is_ascii_whitespace() {
                break;
            }
            self.line += u64::from(*b == b'\n');
            self.rest = rest;
        }
    }

    fn word(&mut self) -> Parsed<f64> {
        self.skip_blanks();
        let end = self.rest.iter().position(u8::is_ascii_whitespace).unwrap_or(self.rest.len());
        let (w, rest) = self.rest.split_at(end);
        self.rest = rest;
        match number(w) {
            Some(v) => Ok(v),
            None if w.is_empty() => fault(self.place(), "the file ends here: it was cut short"),
            None => fault(self.place(), format!("`{}` is not a number", shown(w))),
        }
    }
}

/// A number from exactly the bytes of its type.
fn decode(b: &[u8], of: Scalar, big: bool) -> f64 {
    let mut raw = [0; 8];
    for (i, &x) in b.iter().take(8).enumerate() {
        raw[if big { b.len() - 1 - i } else { i }] = x;
    }
    let word = u64::from_le_bytes(raw);
    match of {
        Scalar::I8 => f64::from(word as i8),
        Scalar::U8 => f64::from(word as u8),
        Scalar::I16 => f64::from(word as i16),
        Scalar::U16 => f64::from(word as u16),
        Scalar::I32 => f64::from(word as i32),
        Scalar::U32 => f64::from(word as u32),
        Scalar::F32 => f64::from(f32::from_bits(word as u32)),
        Scalar::F64 => f64::from_bits(word),
    }
}
