//! Shadows of triangles on an axis, eight at a time: what has a gap between its shadows is apart.

use crate::num::lanes::Vec8;
use fearless_simd::{Simd, SimdMask, f64x8, prelude::*};

/// Least and greatest height of some points along an axis.
#[inline(always)]
pub(super) fn shadow<S: Simd>(axis: Vec8<S>, points: &[Vec8<S>; 3]) -> [f64x8<S>; 2] {
    let [a, b, c] = points;
    let (a, b, c) = (a.dot(axis), b.dot(axis), c.dot(axis));
    [a.min(b).min(c), a.max(b).max(c)]
}

/// In which lanes shadows on an axis are more than `slack` from each other, which is not negative, a bit
/// for each; in none where the axis has no direction but round-off.
#[inline(always)]
pub(super) fn parts<S: Simd>(
    axis: Vec8<S>,
    [a, b]: [f64x8<S>; 2],
    [c, d]: [f64x8<S>; 2],
    slack: f64,
) -> u8 {
    let s = axis.x.token();
    let gap = (a - d).max(c - b);
    if !gap.simd_gt(f64x8::splat(s, 0.0)).any_true() {
        return 0;
    }
    let length = axis.dot(axis).sqrt();
    let told =
        length.simd_gt(f64x8::splat(s, 1e-9)) & (gap / length).simd_gt(f64x8::splat(s, slack));
    told.to_bitmask() as u8
}
