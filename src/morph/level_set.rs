//! Level-set morph (Breen and Whitaker 2001): the source's surface moves along its normal by the
//! target's signed distance d_T, `φ_t + d_T |∇φ| = 0` with φ < 0 inside.
//!
//! The speed depends on the place only and has one sign on each side of the target's surface, so
//! every point is crossed at most once. The whole evolution is therefore its arrival time τ,
//! `|∇τ| |d_T| = 1` with τ = 0 on the source's surface, which fast marching (Sethian 1996) finds in
//! one pass: all times at once, without steps in time and without reinitialisation.
//!
//! **The clock.** The target is reached only in the limit. Time t is the share of what has to change
//! (source without target and target without source, by volume) that has changed; t = 1 is the limit.
//!
//! **The limit of the method.** The front grows only out of what both shapes hold: a part of the
//! target that does not touch the common part never appears ([`Morph::notes`] says how much), and
//! what the source has elsewhere shrinks away.

use super::plan::{Course, MorphError, Part};
use super::{Morph, whole};
use crate::field::Shared;
use crate::field::dense::Dense;
use crate::grid::Lattice;
use crate::job::{Cancelled, Job, check};
use crate::num::Aabb;
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::sync::{Arc, OnceLock};

/// Samples of the lattice at most: 12 bytes each while the front marches, 8 kept.
const MOST: f64 = 8e6;
/// Bytes a sample needs at the peak: three arrays and the front's own.
pub(super) const BYTES: f64 = 20.0;
/// Least speed, in steps: keeps the way to the target's surface finite.
const SLOWEST: f64 = 1e-3;
/// Largest exponent of the profile ahead of the front; farther off only the sign counts.
const AHEAD: f32 = 1.0;

/// Samples of the lattice of a domain.
pub(super) fn count(domain: &Aabb, step: f64) -> f64 {
    whole::count(domain, step, MOST)
}

pub(super) struct LevelSet {
    source: Part,
    target: Part,
    course: Course,
    lattice: Lattice,
    evolution: OnceLock<Evolution>,
}

impl LevelSet {
    pub fn new(shapes: Vec<Part>, course: Course, step: f64) -> Result<Self, MorphError> {
        let got = shapes.len();
        let Ok([source, target]) = <[Part; 2]>::try_from(shapes) else {
            return Err(MorphError::TwoShapes { method: "level-set", got });
        };
        let domain = whole::bounded([&source.field, &target.field])?;
        let lattice = whole::lattice(&domain, step, MOST);
        if !whole::meet(&[&source.field, &target.field], 0.5 * lattice.step) {
            return Err(MorphError::Apart { a: source.name, b: target.name });
        }
        Ok(Self { source, target, course, lattice, evolution: OnceLock::new() })
    }

    fn evolution(&self, job: &dyn Job) -> Result<&Evolution, Cancelled> {
        if let Some(made) = self.evolution.get() {
            return Ok(made);
        }
        let made = Evolution::new(&self.source.field, &self.target.field, &self.lattice, job)?;
        Ok(self.evolution.get_or_init(|| made))
    }
}

impl Morph for LevelSet {
    fn at(&self, t: f64, job: &dyn Job) -> Result<Shared, Cancelled> {
        let share = self.course.at(t)[1];
        if share <= 0.0 {
            return Ok(self.source.field.clone());
        }
        let evolution = self.evolution(job)?;
        if share >= 1.0 && evolution.missing == 0 {
            return Ok(self.target.field.clone());
        }
        let samples = evolution.at(share);
        check(job)?;
        Ok(Arc::new(Dense::new(self.lattice, samples)))
    }

    fn domain(&self) -> Aabb {
        whole::domain([&self.source.field, &self.target.field])
    }

    fn notes(&self) -> Vec<String> {
        let Some(e) = self.evolution.get().filter(|e| e.missing > 0) else { return Vec::new() };
        vec![format!(
            "level-set: {:.1}% of `{}` does not touch what it has in common with `{}` and cannot \
             appear",
            100.0 * e.missing as f64 / e.target_samples.max(1) as f64,
            self.target.name,
            self.source.name,
        )]
    }
}

/// The arrival times of a whole evolution.
struct Evolution {
    /// Signed distance to the target, never 0.
    target: Vec<f32>,
    /// Where one shape has what the other has not: 1 + τ, at least 1. Elsewhere: 1 - d_S / d_T, less
    /// than 1.
    code: Vec<f32>,
    /// Arrival times where something changes, in order.
    clock: Vec<f32>,
    /// Samples inside the target, and those of them that the front never reaches.
    target_samples: usize,
    missing: usize,
}

impl Evolution {
    fn new(
        source: &Shared,
        target: &Shared,
        lattice: &Lattice,
        job: &dyn Job,
    ) -> Result<Self, Cancelled> {
        job.stage("level-set");
        let from = whole::samples(&**source, lattice, job)?;
        let mut to = whole::samples(&**target, lattice, job)?;
        to.iter_mut().for_each(|d| *d = d.abs().max(1e-6).copysign(*d));
        let mut code = March::new(lattice, &from, &to).run(job)?;
        let mut clock = Vec::new();
        let (mut target_samples, mut missing) = (0, 0);
        for (n, v) in code.iter_mut().enumerate() {
            let (s, d) = (from[n], to[n]);
            target_samples += usize::from(d < 0.0);
            if (s < 0.0) == (d < 0.0) {
                *v = 1.0 - s / d;
                continue;
            }
            if d > 0.0 && v.is_infinite() {
                // slivers of the source without a neighbour outside of it
                *v = (s / d).abs();
            }
            if v.is_finite() {
                clock.push(*v)
            } else {
                missing += 1
            }
            *v += 1.0;
        }
        check(job)?;
        clock.sort_unstable_by(f32::total_cmp);
        Ok(Self { target: to, code, clock, target_samples, missing })
    }

    /// The evolution's own time at which `share` of the change is done.
    fn time(&self, share: f64) -> f64 {
        if share >= 1.0 {
            return f64::INFINITY;
        }
        let at = share.max(0.0) * self.clock.len() as f64;
        let i = at as usize;
        let tau = |i: usize| self.clock.get(i).map_or(0.0, |&t| f64::from(t));
        let low = if i == 0 { 0.0 } else { tau(i - 1) };
        low + (tau(i) - low) * (at - i as f64)
    }

    /// Samples of the shape. Where both shapes agree the two distances are mixed, elsewhere the value
    /// is d_T (1 - exp(τ - s)): both are the distance itself where shapes are concentric balls.
    fn at(&self, share: f64) -> Vec<f32> {
        let s = self.time(share) as f32;
        let w = (-s).exp();
        let value = |(&d, &v): (&f32, &f32)| {
            if v < 1.0 {
                return d - d * (w * v);
            }
            let ahead = if v.is_infinite() { AHEAD } else { (v - 1.0 - s).min(AHEAD) };
            d * (1.0 - ahead.exp())
        };
        self.target.iter().zip(&self.code).map(value).collect()
    }
}

/// Fast marching where exactly one of the shapes is.
struct March<'a> {
    from: &'a [f32],
    to: &'a [f32],
    size: [usize; 3],
    step: f64,
    time: Vec<f32>,
    done: Vec<bool>,
    front: BinaryHeap<Reverse<(u32, u32)>>,
}

impl<'a> March<'a> {
    fn new(lattice: &Lattice, from: &'a [f32], to: &'a [f32]) -> Self {
        Self {
            from,
            to,
            size: lattice.size.map(|n| n as usize),
            step: lattice.step,
            time: vec![f32::INFINITY; to.len()],
            done: vec![false; to.len()],
            front: BinaryHeap::new(),
        }
    }

    fn run(mut self, job: &dyn Job) -> Result<Vec<f32>, Cancelled> {
        for n in 0..self.to.len() {
            if self.starts(n) {
                self.put(n, (self.from[n] / self.to[n]).abs());
            }
        }
        let mut count = 0u32;
        while let Some(Reverse((bits, n))) = self.front.pop() {
            let n = n as usize;
            if self.done[n] || f32::from_bits(bits) > self.time[n] {
                continue;
            }
            self.done[n] = true;
            for m in self.around(n).into_iter().flatten() {
                if !self.done[m] && self.same_side(n, m) {
                    let t = self.arrival(m);
                    if t < self.time[m] {
                        self.put(m, t);
                    }
                }
            }
            count += 1;
            if count.is_multiple_of(4096) {
                check(job)?;
            }
        }
        Ok(self.time)
    }

    fn put(&mut self, n: usize, time: f32) {
        self.time[n] = time;
        // times are not negative, so their bits are in their order
        self.front.push(Reverse((time.to_bits(), n as u32)));
    }

    /// Whether exactly one shape has this sample.
    fn changes(&self, n: usize) -> bool {
        (self.from[n] < 0.0) != (self.to[n] < 0.0)
    }

    fn same_side(&self, n: usize, m: usize) -> bool {
        self.changes(m) && (self.to[n] < 0.0) == (self.to[m] < 0.0)
    }

    /// Whether the source's surface passes beside sample `n` on its side of the target's surface.
    fn starts(&self, n: usize) -> bool {
        if !self.changes(n) {
            return false;
        }
        let (s, d) = (f64::from(self.from[n].abs()), f64::from(self.to[n].abs()));
        // nearer to the source's surface than to the target's: its foot lies on this side
        let near = s < d && s < self.step;
        let beside = |m: usize| !self.changes(m) && (self.to[n] < 0.0) == (self.to[m] < 0.0);
        near || self.around(n).into_iter().flatten().any(beside)
    }

    /// The six neighbours of a sample.
    fn around(&self, n: usize) -> [Option<usize>; 6] {
        let [x, y, z] = self.size;
        let (i, j, k) = (n % x, n / x % y, n / (x * y));
        [
            (i > 0).then(|| n - 1),
            (i + 1 < x).then(|| n + 1),
            (j > 0).then(|| n - x),
            (j + 1 < y).then(|| n + x),
            (k > 0).then(|| n - x * y),
            (k + 1 < z).then(|| n + x * y),
        ]
    }

    /// Arrival at `n` from the neighbours already passed: `Σ max(t - t_a, 0)² = (step / speed)²`.
    fn arrival(&self, n: usize) -> f32 {
        let around = self.around(n);
        let known = |m: &Option<usize>| match *m {
            Some(m) if self.done[m] && self.same_side(n, m) => f64::from(self.time[m]),
            _ => f64::INFINITY,
        };
        let mut a: [f64; 3] =
            std::array::from_fn(|c| known(&around[2 * c]).min(known(&around[2 * c + 1])));
        a.sort_unstable_by(f64::total_cmp);
        let cost = self.step / f64::from(self.to[n].abs()).max(SLOWEST * self.step);
        let mut t = a[0] + cost;
        for count in 2..=3 {
            if t <= a[count - 1] {
                break;
            }
            let of = &a[..count];
            let (sum, squares): (f64, f64) = (of.iter().sum(), of.iter().map(|x| x * x).sum());
            let m = count as f64;
            let under = sum * sum - m * (squares - cost * cost);
            t = (sum + under.max(0.0).sqrt()) / m;
        }
        t as f32
    }
}
