//! A field from samples on a whole lattice, for methods that have to hold one.
//!
//! Between samples the value is trilinear; outside the lattice it is the value at its side plus the
//! way there. Bounds are exact: the least and largest of the samples touched.

use super::Field;
use crate::grid::Lattice;
use crate::num::{Aabb, Interval};
use glam::{DVec3, UVec3};

/// Cells along a side of a block of which the range is kept.
const BLOCK: u32 = 4;

/// Samples on a lattice as a field.
pub struct Dense {
    lattice: Lattice,
    samples: Vec<f32>,
    bounds: Aabb,
    support: Aabb,
    /// Ranges of blocks of cells of 4, 8, 16, ... a side.
    levels: Vec<Level>,
}

/// Ranges of equal blocks of cells.
struct Level {
    side: u32,
    size: [u32; 3],
    ranges: Vec<[f32; 2]>,
}

/// The positions of a lattice's samples in plane `k`, x fastest.
pub fn plane(lattice: &Lattice, k: u32) -> impl Iterator<Item = DVec3> {
    let [x, y, _] = lattice.size;
    let lattice = *lattice;
    (0..y).flat_map(move |j| (0..x).map(move |i| lattice.point(i, j, k)))
}

impl Dense {
    /// From samples, x fastest, two or more along each axis. What is not finite counts as far outside.
    /// Outermost samples should be outside, so that the field is that of a bounded shape.
    pub fn new(lattice: Lattice, mut samples: Vec<f32>) -> Self {
        samples.resize(lattice.samples() as usize, f32::MAX);
        samples.iter_mut().filter(|s| !s.is_finite()).for_each(|s| *s = 1e30);
        let mut levels = vec![finest(&lattice, &samples)];
        while let Some(next) = levels.last().and_then(coarser) {
            levels.push(next);
        }
        let inside = inside(&lattice, &samples);
        Self { bounds: lattice.bounds(), support: inside, lattice, samples, levels }
    }

    /// Where the samples lie.
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// Least and largest value over cells `lo` to `hi`, both included.
    fn range(&self, lo: UVec3, hi: UVec3) -> Interval {
        let span = (hi - lo).max_element() + 1;
        if span <= BLOCK {
            return self.exact(lo, hi);
        }
        // two to three blocks along each axis
        let fits = |l: &&Level| span <= 2 * l.side;
        let level = self.levels.iter().find(fits).or(self.levels.last());
        level.map_or(Interval::ALL, |l| l.range(lo / l.side, hi / l.side))
    }

    /// From the samples themselves.
    fn exact(&self, lo: UVec3, hi: UVec3) -> Interval {
        let [x, y, _] = self.lattice.size;
        let mut range = [f32::INFINITY, f32::NEG_INFINITY];
        for k in lo.z..=hi.z + 1 {
            for j in lo.y..=hi.y + 1 {
                let row = (x * (j + y * k)) as usize;
                let row = &self.samples[row + lo.x as usize..=row + hi.x as usize + 1];
                range = row.iter().fold(range, |[a, b], &s| [a.min(s), b.max(s)]);
            }
        }
        Interval::new(f64::from(range[0]), f64::from(range[1]))
    }

    /// The cell of a point of the lattice's box.
    fn cell(&self, p: DVec3) -> UVec3 {
        let last = UVec3::from_array(self.lattice.size).saturating_sub(UVec3::splat(2));
        ((p - self.lattice.origin) / self.lattice.step).max(DVec3::ZERO).as_uvec3().min(last)
    }

    fn interpolate(&self, p: DVec3) -> f64 {
        let [x, y, _] = self.lattice.size;
        let cell = self.cell(p);
        let f = (p - self.lattice.origin) / self.lattice.step - cell.as_dvec3();
        let at = |j: u32, k: u32| {
            let n = (cell.x + x * (cell.y + j + y * (cell.z + k))) as usize;
            let (a, b) = (f64::from(self.samples[n]), f64::from(self.samples[n + 1]));
            a + (b - a) * f.x
        };
        let side = |k: u32| {
            let (a, b) = (at(0, k), at(1, k));
            a + (b - a) * f.y
        };
        let (a, b) = (side(0), side(1));
        a + (b - a) * f.z
    }
}

impl Level {
    fn range(&self, lo: UVec3, hi: UVec3) -> Interval {
        let mut range = [f32::INFINITY, f32::NEG_INFINITY];
        for k in lo.z..=hi.z {
            for j in lo.y..=hi.y {
                for i in lo.x..=hi.x {
                    let n = i + self.size[0] * (j + self.size[1] * k);
                    range = join(range, self.ranges[n as usize]);
                }
            }
        }
        Interval::new(f64::from(range[0]), f64::from(range[1]))
    }
}

fn join([a, b]: [f32; 2], [c, d]: [f32; 2]) -> [f32; 2] {
    [a.min(c), b.max(d)]
}

/// Ranges over the closed blocks of the finest level.
fn finest(lattice: &Lattice, samples: &[f32]) -> Level {
    let cells = lattice.size.map(|n| n.saturating_sub(1).max(1));
    let size = cells.map(|n| n.div_ceil(BLOCK));
    let [x, y, z] = lattice.size;
    let mut ranges = Vec::with_capacity(size.iter().product::<u32>() as usize);
    for c in 0..size[2] {
        for b in 0..size[1] {
            for a in 0..size[0] {
                let mut range = [f32::INFINITY, f32::NEG_INFINITY];
                let end = |n: u32, of: u32| (BLOCK * n + BLOCK + 1).min(of);
                for k in BLOCK * c..end(c, z) {
                    for j in BLOCK * b..end(b, y) {
                        let row = x * (j + y * k);
                        let row = (row + BLOCK * a) as usize..(row + end(a, x)) as usize;
                        range = samples[row].iter().fold(range, |r, &s| join(r, [s, s]));
                    }
                }
                ranges.push(range);
            }
        }
    }
    Level { side: BLOCK, size, ranges }
}

/// Blocks of twice the side; none beyond a single one.
fn coarser(of: &Level) -> Option<Level> {
    if of.size.iter().all(|&n| n <= 1) {
        return None;
    }
    let size = of.size.map(|n| n.div_ceil(2));
    let none = [f32::INFINITY, f32::NEG_INFINITY];
    let mut ranges = vec![none; size.iter().product::<u32>() as usize];
    for (n, &range) in of.ranges.iter().enumerate() {
        let [x, y] = [of.size[0] as usize, of.size[1] as usize];
        let [i, j, k] = [n % x / 2, n / x % y / 2, n / (x * y) / 2];
        let to = i + size[0] as usize * (j + size[1] as usize * k);
        ranges[to] = join(ranges[to], range);
    }
    Some(Level { side: 2 * of.side, size, ranges })
}

/// A box round all cells that touch an inside sample.
fn inside(lattice: &Lattice, samples: &[f32]) -> Aabb {
    let [x, y] = [lattice.size[0] as usize, lattice.size[1] as usize];
    let mut found = Aabb::EMPTY;
    for (n, _) in samples.iter().enumerate().filter(|(_, s)| **s < 0.0) {
        let [i, j, k] = [n % x, n / x % y, n / (x * y)].map(|i| i as u32);
        found = found.with(lattice.point(i, j, k));
    }
    if found.is_empty() { found } else { found.grow(lattice.step) }
}

impl Field for Dense {
    fn value(&self, p: DVec3) -> f64 {
        let inside = self.bounds.clamp(p);
        self.interpolate(inside) + (p - inside).length()
    }

    fn bound(&self, b: &Aabb) -> Interval {
        let (lo, hi) = (self.bounds.clamp(b.min), self.bounds.clamp(b.max));
        let range = self.range(self.cell(lo), self.cell(hi));
        let away = b.corners().iter().map(|&p| self.bounds.distance(p)).fold(0.0, f64::max);
        let scale = range.lo.abs().max(range.hi.abs());
        Interval::new(range.lo, range.hi + away).widen(1e-12 * (scale + away + self.lattice.step))
    }

    fn support(&self) -> Aabb {
        self.support
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn some(size: [u32; 3], f: impl Fn(DVec3) -> f64) -> Dense {
        let lattice = Lattice { origin: DVec3::new(-2.0, 1.0, 0.5), step: 0.7, size };
        let samples = (0..size[2]).flat_map(|k| plane(&lattice, k)).map(|p| f(p) as f32);
        Dense::new(lattice, samples.collect())
    }

    #[test]
    fn a_linear_field_is_given_back() {
        let f = |p: DVec3| 3.0 + p.x - 2.0 * p.y + 0.5 * p.z;
        let d = some([9, 4, 6], f);
        for n in 0..200 {
            let share = DVec3::new(
                f64::from(n % 7) / 6.0,
                f64::from(n % 11) / 10.0,
                f64::from(n % 5) / 4.0,
            );
            let b = d.lattice().bounds();
            let p = b.min + share * b.size();
            assert!((d.value(p) - f(p)).abs() < 1e-5, "{p}");
        }
        // outside: the side's value and the way there
        let top = d.lattice().bounds().max;
        assert!((d.value(top + DVec3::X * 5.0) - f(top) - 5.0).abs() < 1e-5);
    }

    proptest! {
        /// The bound holds and, inside the lattice, is reached by a sample touched.
        #[test]
        fn bounds_hold(
            seed in 0..1000u32, centre in prop::array::uniform3(-0.2..1.2f64),
            half in prop::array::uniform3(0.0..1.0f64), small in 0..6i32,
        ) {
            let rough = |p: DVec3| (p.x * 7.0 + f64::from(seed)).sin() + (p.y * 5.0).cos() * (p.z * 3.0).sin();
            let d = some([37, 12, 21], rough);
            let b = d.lattice().bounds();
            let centre = b.min + DVec3::from(centre) * b.size();
            let half = DVec3::from(half) * b.size() * 0.5f64.powi(small);
            let bound = d.bound(&Aabb::around(centre, half));
            prop_assert!(bound.lo >= -2.0 - 1e-6);
            for n in 0..64 {
                let q = DVec3::new(f64::from(n % 4), f64::from(n / 4 % 4), f64::from(n / 16)) / 1.5 - 1.0;
                let v = d.value(centre + q * half);
                prop_assert!(bound.contains(v), "{v} not in {bound:?}");
            }
        }
    }
}
