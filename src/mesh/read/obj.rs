//! Wavefront OBJ: `v` and `f` lines; everything else is passed over.
//!
//! An own reader, not `tobj`: that one holds points in f32, names no line in its errors, cuts
//! polygons by fans, and refuses names that are not UTF-8.

use super::text::{lines, place, short, shown, three, word};
use crate::mesh::{
    error::{Parsed, fault},
    soup::Soup,
};
use std::borrow::Cow;

pub(super) fn read(bytes: &[u8]) -> Parsed<Soup> {
    let mut soup = Soup { first: 1, ..Soup::default() };
    let mut input = lines(bytes);
    while let Some((at, line)) = input.next() {
        let mut rest = line;
        let key = word(&mut rest);
        if !matches!(key, Some(b"v" | b"f" | b"fo")) {
            continue;
        }
        let mut rest = Cow::Borrowed(rest);
        while let Some(start) = continued(&rest) {
            rest.to_mut().truncate(start);
            rest.to_mut().push(b' ');
            rest.to_mut().extend_from_slice(input.next().map_or(&[][..], |l| l.1));
        }
        if key == Some(b"v") {
            soup.points.push(three(&mut &*rest, at)?);
            soup.point_lines.push(short(at));
        } else {
            face(&rest, at, &mut soup)?;
        }
    }
    Ok(soup)
}

/// Where the backslash stands, for a line that goes on in the next.
fn continued(line: &[u8]) -> Option<usize> {
    let line = line.strip_suffix(b"\r").unwrap_or(line);
    line.ends_with(b"\\").then(|| line.len() - 1)
}

fn face(mut rest: &[u8], at: u64, soup: &mut Soup) -> Parsed<()> {
    let before = soup.corners.len();
    while let Some(w) = word(&mut rest) {
        if w.starts_with(b"#") {
            break;
        }
        soup.corners.push(corner(w, at, soup.points.len())?);
    }
    soup.sizes.push((soup.corners.len() - before) as u32);
    soup.lines.push(short(at));
    Ok(())
}

/// The point of `7`, `7/1`, `7//3` or `-1/...`, counted from 0. A positive number may name a point
/// that comes later; whether it exists is checked at the end.
fn corner(w: &[u8], at: u64, points: usize) -> Parsed<u32> {
    let head = w.split(|&b| b == b'/').next().unwrap_or(w);
    let index: Option<i64> = std::str::from_utf8(head).ok().and_then(|s| s.parse().ok());
    let from_zero = match index {
        None => {
            return fault(place(at), format!("`{}` is not a corner of a face", shown(w)));
        }
        Some(0) => return fault(place(at), "point 0, but OBJ counts from 1"),
        Some(i) if i < 0 => i64::try_from(points).ok().and_then(|n| n.checked_add(i)),
        Some(i) => Some(i - 1),
    };
    match from_zero.and_then(|i| u32::try_from(i).ok()) {
        Some(i) => Ok(i),
        None => {
            fault(place(at), format!("point {}, but there are {points} points so far", shown(head)))
        }
    }
}
