//! STL, binary and ASCII.

use super::text::{lines, place, short, shown, three, word};
use crate::mesh::{
    error::{Parsed, fault},
    soup::Soup,
};
use glam::DVec3;

const HEADER: usize = 84;
const FACET: usize = 50;

/// Binary or ASCII: some binary files begin with `solid` too, so the size decides first.
pub(super) fn read(bytes: &[u8]) -> Parsed<Soup> {
    let claimed = bytes.get(80..HEADER).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
    let fits = claimed.is_some_and(|n| bytes.len() as u64 == size_of(n));
    let mut text = bytes;
    let solid = word(&mut text).is_some_and(|w| w.eq_ignore_ascii_case(b"solid"));
    let head = &bytes[..bytes.len().min(HEADER)];
    match claimed {
        _ if bytes.is_empty() => Ok(Soup::default()),
        _ if !fits && solid && !head.contains(&0) => ascii(bytes),
        Some(n) => binary(bytes, n),
        None => fault("header", format!("{} bytes; a binary STL has at least 84", bytes.len())),
    }
}

fn size_of(facets: u32) -> u64 {
    HEADER as u64 + FACET as u64 * u64::from(facets)
}

fn binary(bytes: &[u8], facets: u32) -> Parsed<Soup> {
    let body = usize::try_from(size_of(facets)).ok().and_then(|end| bytes.get(HEADER..end));
    let Some(body) = body else {
        let (wants, has) = (size_of(facets), bytes.len());
        let why = format!("{facets} triangles would take {wants} bytes, the file has {has}");
        return fault("header", why);
    };
    let mut soup = Soup::default();
    soup.points.reserve_exact(facets as usize * 3);
    for facet in body.chunks_exact(FACET) {
        // Twelve bytes of normal, three corners, two bytes of attributes.
        for corner in facet[12..48].chunks_exact(12) {
            let mut p = [0.0; 3];
            for (x, b) in p.iter_mut().zip(corner.chunks_exact(4)) {
                *x = f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
            }
            soup.points.push(DVec3::from(p));
        }
    }
    number(&mut soup)?;
    Ok(soup)
}

/// Every corner is a point of its own.
fn number(soup: &mut Soup) -> Parsed<()> {
    match u32::try_from(soup.points.len()) {
        Ok(n) => soup.corners = (0..n).collect(),
        Err(_) => return fault("size", "more than 2^32 corners"),
    }
    Ok(())
}

fn ascii(bytes: &[u8]) -> Parsed<Soup> {
    let mut soup = Soup::default();
    let (mut open, mut last, mut solid) = (None, 1, false);
    for (at, line) in lines(bytes) {
        let mut rest = line;
        let Some(key) = word(&mut rest) else { continue };
        last = at;
        let is = |s: &str| key.eq_ignore_ascii_case(s.as_bytes());
        if is("solid") || is("endsolid") || is("end") {
            solid = is("solid");
        } else if is("outer") {
            open = Some(soup.points.len());
        } else if is("vertex") {
            soup.points.push(three(&mut rest, at)?);
            soup.point_lines.push(short(at));
        } else if is("endloop") {
            let Some(from) = open.take() else {
                return fault(place(at), "endloop without loop");
            };
            soup.sizes.push((soup.points.len() - from) as u32);
            soup.lines.push(short(at));
        } else if !is("facet") && !is("endfacet") {
            return fault(place(at), format!("`{}` is no word of an ASCII STL", shown(key)));
        }
        if (is("facet") || is("endfacet") || is("endsolid")) && open.is_some() {
            return fault(place(at), format!("`{}` before endloop", shown(key)));
        }
        if is("vertex") && open.is_none() {
            return fault(place(at), "vertex outside a loop");
        }
    }
    if solid {
        return fault(place(last), "the file ends before endsolid: it was cut short");
    }
    number(&mut soup)?;
    Ok(soup)
}
