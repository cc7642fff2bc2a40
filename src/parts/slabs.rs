//! A guess for what is no chair: slabs from top to bottom.

use super::{Note, Paired, fit};
use crate::num::Aabb;

/// Three slabs of each box, or one of the whole where a box is flat; none round nothing.
pub(super) fn slabs(boxes: &[Aabb]) -> Vec<Paired> {
    if boxes.is_empty() || boxes.iter().any(|b| b.is_empty() || !b.is_finite()) {
        return Vec::new();
    }
    let flat = |b: &Aabb| b.size().z < 0.2 * b.size().x.max(b.size().y);
    let names: &[&str] =
        if boxes.iter().any(flat) { &["whole"] } else { &["bottom", "middle", "top"] };
    let slab = |i: usize, name: &str| {
        let part = |n: usize| n as f64 / names.len() as f64;
        let cut = |b: &Aabb| {
            let level = |n: usize| b.min.z + part(n) * b.size().z;
            fit::block(b.min.with_z(level(i)), b.max.with_z(level(i + 1)))
        };
        let elements = boxes.iter().map(cut).collect::<Result<Vec<_>, _>>().ok()?;
        Some(Paired { name: name.to_owned(), elements, confidence: 0.2, note: Note::Slab })
    };
    names.iter().enumerate().filter_map(|(i, name)| slab(i, name)).collect()
}
