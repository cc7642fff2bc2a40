//! Words and numbers of text files, as bytes: names in them need not be UTF-8.

use crate::mesh::error::{Parsed, fault};
use glam::DVec3;

/// The next word, split off at blanks.
pub(super) fn word<'a>(line: &mut &'a [u8]) -> Option<&'a [u8]> {
    let start = line.iter().position(|b| !b.is_ascii_whitespace())?;
    let rest = &line[start..];
    let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
    *line = &rest[end..];
    Some(&rest[..end])
}

/// A number, as Rust or C write it.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// Three numbers from the front of `line`; `number` of the line goes into the error.
pub(super) fn three(line: &mut &[u8], at: u64) -> Parsed<DVec3> {
    let mut p = [0.0; 3];
    for (value, axis) in p.iter_mut().zip(["x", "y", "z"]) {
        let Some(w) = word(line) else {
            return fault(place(at), format!("{axis} is missing"));
        };
        match number(w) {
            Some(x) => *value = x,
            None => return fault(place(at), format!("{axis} is `{}`, not a number", shown(w))),
        }
    }
    Ok(p.into())
}

/// `line 12`.
pub(super) fn place(line: u64) -> String {
    format!("line {line}")
}

/// A line number as it is kept for each point and face.
pub(super) fn short(line: u64) -> u32 {
    u32::try_from(line).unwrap_or(u32::MAX)
}

/// A word as it can be shown: at most 40 bytes, no control characters.
pub(super) fn shown(word: &[u8]) -> String {
    let text = String::from_utf8_lossy(&word[..word.len().min(40)]);
    text.chars().map(|c| if c.is_control() { '?' } else { c }).collect()
}

/// The lines of a file with their numbers from 1; ends at `\n`, and `\r` is a blank.
pub(super) fn lines(bytes: &[u8]) -> impl Iterator<Item = (u64, &[u8])> {
    (1..).zip(bytes.split(|&b| b == b'\n'))
}
