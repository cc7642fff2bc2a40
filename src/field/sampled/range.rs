//! Ranges: least, greatest and steepest value of every leaf, and of blocks of them. Of leaves that the
//! surface may go through they are exact, of others what the field promises.

use super::{CELLS, Leaf, SIDE, Sampled};
use crate::num::{Aabb, Interval};
use glam::{DVec3, IVec3};
use rayon::prelude::*;

/// Range and slope of a leaf or of a block of leaves.
#[derive(Clone, Copy, Debug)]
struct Span {
    lo: f32,
    hi: f32,
    /// Largest change of the trilinear value a mm; infinite where it is not known.
    slope: f32,
}

impl Span {
    const NONE: Self = Self { lo: f32::INFINITY, hi: f32::NEG_INFINITY, slope: 0.0 };

    fn hull(self, o: Self) -> Self {
        Self { lo: self.lo.min(o.lo), hi: self.hi.max(o.hi), slope: self.slope.max(o.slope) }
    }
}

/// One span a leaf, and a pyramid over the table in which each level halves the resolution.
#[derive(Default)]
pub(super) struct Ranges {
    leaves: Vec<Span>,
    levels: Vec<(IVec3, Vec<Span>)>,
}

impl Ranges {
    /// `promised` is what the field promises over each leaf.
    pub(super) fn new(s: &Sampled, promised: &[Interval]) -> Self {
        let span = |(leaf, &range): (usize, &Interval)| match s.samples[leaf].get() {
            Some(samples) if crossed(range) => span(&samples[..], s.step(), s.leaves[leaf].level),
            _ => Span { lo: range.lo as f32, hi: range.hi as f32, slope: f32::INFINITY },
        };
        let leaves: Vec<Span> = promised.par_iter().enumerate().map(span).collect();
        let mut size = s.table_size;
        let mut spans: Vec<Span> = s.table.iter().map(|&l| leaves[l as usize]).collect();
        let mut levels = Vec::new();
        while size.max_element() > 1 {
            let half = (size + 1) / 2;
            let mut up = vec![Span::NONE; (half.x * half.y * half.z) as usize];
            for z in 0..size.z {
                for y in 0..size.y {
                    for x in 0..size.x {
                        let from = spans[((z * size.y + y) * size.x + x) as usize];
                        let to = ((z / 2 * half.y + y / 2) * half.x + x / 2) as usize;
                        up[to] = up[to].hull(from);
                    }
                }
            }
            levels.push((half, up.clone()));
            (size, spans) = (half, up);
        }
        Self { leaves, levels }
    }

    pub(super) fn leaf(&self, l: usize) -> Interval {
        Interval::new(f64::from(self.leaves[l].lo), f64::from(self.leaves[l].hi))
    }
}

/// Whether the surface may go through a leaf over which the field promises that range.
pub(super) fn crossed(range: Interval) -> bool {
    range.lo <= 0.0 && range.hi >= 0.0
}

fn span(s: &[f32], step: f64, level: u32) -> Span {
    let (mut lo, mut hi) = ([f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]);
    for row in s.chunks(LANES) {
        for ((lo, hi), &v) in lo.iter_mut().zip(&mut hi).zip(row) {
            (*lo, *hi) = (lo.min(v), hi.max(v));
        }
    }
    let lo = lo.into_iter().fold(f32::INFINITY, f32::min);
    let hi = hi.into_iter().fold(f32::NEG_INFINITY, f32::max);
    let rows = s.chunks_exact(SIDE).map(|row| steepest(&row[1..], row));
    let planes = s.chunks_exact(SIDE * SIDE).map(|plane| steepest(&plane[SIDE..], plane));
    let rise =
        [rows.fold(0.0, f32::max), planes.fold(0.0, f32::max), steepest(&s[SIDE * SIDE..], s)];
    let h = step * f64::from(1u32 << level);
    let slope = DVec3::from(rise.map(f64::from)).length() / h;
    Span { lo, hi, slope: (slope * 1.000_001) as f32 }
}

/// Values looked at together.
const LANES: usize = 8;

/// The greatest difference between two runs of values, as far as both go.
fn steepest(next: &[f32], here: &[f32]) -> f32 {
    let mut most = [0f32; LANES];
    for (next, here) in next.chunks(LANES).zip(here.chunks(LANES)) {
        for ((m, n), h) in most.iter_mut().zip(next).zip(here) {
            *m = m.max((n - h).abs());
        }
    }
    most.into_iter().fold(0.0, f32::max)
}

impl Sampled {
    /// Range of the trilinear values on a box inside the sampled box, and their slope.
    pub(super) fn range(&self, b: &Aabb) -> (Interval, f64) {
        let low = ((b.min - self.grid.origin) * self.inverse).max(DVec3::ZERO);
        let high = ((b.max - self.grid.origin) * self.inverse).max(DVec3::ZERO);
        let cells = self.table_size * CELLS - 1;
        let (first, last) = (low.as_ivec3().min(cells), high.as_ivec3().min(cells));
        let (b0, b1) = (first / CELLS, last / CELLS);
        let span = if (b1 - b0).max_element() <= 1 {
            self.touched(b0, b1, low, high)
        } else {
            self.blocks(b0, b1)
        };
        (Interval::new(f64::from(span.lo), f64::from(span.hi)), f64::from(span.slope))
    }

    /// The samples of the cells that the box touches, in the few leaves it lies in.
    fn touched(&self, b0: IVec3, b1: IVec3, low: DVec3, high: DVec3) -> Span {
        let mut span = Span::NONE;
        let mut seen = [u32::MAX; 8];
        let mut count = 0;
        for z in b0.z..=b1.z {
            for y in b0.y..=b1.y {
                for x in b0.x..=b1.x {
                    let t = (z * self.table_size.y + y) * self.table_size.x + x;
                    let leaf = self.table[t as usize];
                    if !seen[..count].contains(&leaf) {
                        seen[count] = leaf;
                        count += 1;
                        span = span.hull(self.touched_in(leaf as usize, low, high));
                    }
                }
            }
        }
        span
    }

    fn touched_in(&self, leaf: usize, low: DVec3, high: DVec3) -> Span {
        let Leaf { corner, level } = self.leaves[leaf];
        let scale = 1.0 / f64::from(1u32 << level);
        let top = DVec3::splat(f64::from(CELLS));
        let place = |p: DVec3| ((p - corner.as_dvec3()) * scale).clamp(DVec3::ZERO, top);
        let (a, to) = (place(low).as_ivec3(), place(high));
        // rounded up
        let b = to.as_ivec3();
        let b = b + IVec3::from(b.as_dvec3().cmplt(to));
        let whole = self.ranges.leaves[leaf];
        if whole.slope == f32::INFINITY || a == IVec3::ZERO && b == IVec3::splat(CELLS) {
            return whole;
        }
        let samples = self.samples(leaf);
        let (mut lo, mut hi) = (f32::INFINITY, f32::NEG_INFINITY);
        for k in a.z..=b.z {
            for j in a.y..=b.y {
                let row = SIDE * (j as usize + SIDE * k as usize);
                for &v in &samples[row + a.x as usize..=row + b.x as usize] {
                    (lo, hi) = (lo.min(v), hi.max(v));
                }
            }
        }
        Span { lo, hi, slope: whole.slope }
    }

    /// Whole blocks of the pyramid, at the level where few of them cover the box.
    fn blocks(&self, b0: IVec3, b1: IVec3) -> Span {
        let mut level = 0;
        while level + 1 < self.ranges.levels.len()
            && ((b1 >> (level as i32 + 1)) - (b0 >> (level as i32 + 1))).max_element() > 2
        {
            level += 1;
        }
        let (size, spans) = &self.ranges.levels[level];
        let (a, b) = (b0 >> (level as i32 + 1), b1 >> (level as i32 + 1));
        let mut span = Span::NONE;
        for z in a.z..=b.z {
            for y in a.y..=b.y {
                for x in a.x..=b.x {
                    span = span.hull(spans[((z * size.y + y) * size.x + x) as usize]);
                }
            }
        }
        span
    }
}
