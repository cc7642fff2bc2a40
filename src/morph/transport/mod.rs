//! Morph by optimal transport: the Wasserstein barycentre of the shapes' matter, found by
//! convolutions (Solomon et al. 2015).
//!
//! Each shape is a unit of mass spread evenly over its inside. With H the Gaussian
//! exp(-r² / γ), scaling makes every shape's plan marginals agree:
//!
//! ```text
//! a_j = m_j / H b_j,   m = d Π (H a_j)^λ_j,   b_j = m / H a_j,   d = √(d m / H d)
//! ```
//!
//! The last factor takes the Gaussian's blur out again (Janati et al. 2020), so that a single shape
//! is its own barycentre and edges stay sharp. γ falls to (2 samples)² in stages, the first of them on
//! a lattice of half the samples a side: that finds the far moves first. A Gaussian reaches some 15
//! times its width; shapes farther apart begin with a wider one, and the stages end with the
//! narrowest that still reaches. The result is where the density exceeds the level that encloses the
//! weighted mean volume, made a signed distance on the same lattice.
//!
//! **The lattice** is coarser than the final one ([`Morph::notes`] says how coarse): what is thinner
//! than a cell of it smears. A shape with all the weight is given back exactly, by itself and not by
//! the lattice. Topology is not kept.

mod gauss;

use super::plan::{Course, MorphError, Part};
use super::{Morph, whole};
use crate::field::Shared;
use crate::field::dense::Dense;
use crate::grid::{Lattice, redistance};
use crate::job::{Cancelled, Job};
use crate::num::Aabb;
use gauss::{Gauss, SHARE, flushed};
use glam::DVec3;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};
use std::sync::{Arc, OnceLock};

/// Least and largest width of the Gaussian to begin with on the halved lattice, in its samples: the
/// first, doubled until it reaches from shape to shape. The last does across any lattice.
const FIRST: [f64; 2] = [4.0, 16.0];
/// The width that the stages on either lattice end with, in its samples.
const LAST: f64 = 2.0;
/// Rounds of a stage at most: on the halved lattice, at its last width, on the whole one, and where
/// no narrower one follows.
const ROUNDS: [u32; 4] = [15, 20, 40, 100];
/// Share of a shape's mass that a Gaussian may fail to reach.
const LOST: f64 = 1e-3;
/// A stage ends when the mass that a round moves falls below this share.
const STILL: f64 = 1e-3;
/// Samples along the longest side at least and at most.
const SIDES: [u32; 2] = [16, 256];

/// Bytes held at the peak: three arrays a shape, six of the iteration.
pub(super) fn bytes(domain: &Aabb, samples: u32, shapes: usize) -> f64 {
    let n = f64::from(samples);
    let size = domain.size() / domain.size().max_element();
    let count = ((size * n).ceil() + 5.0).element_product();
    let count = if count.is_finite() { count } else { n * n * n };
    8.0 * count * (3.0 * shapes as f64 + 6.0)
}

pub(super) struct Transport {
    shapes: Vec<Part>,
    course: Course,
    lattice: Lattice,
    masses: OnceLock<Vec<Mass>>,
    /// The widest Gaussian, in samples, that a time had to stop at.
    stopped: AtomicU32,
}

/// The matter of a shape on the lattice.
struct Mass {
    /// Share of the whole at each sample.
    density: Vec<f64>,
    /// Samples' worth of volume.
    volume: f64,
    /// Rows along x that hold any.
    rows: Vec<bool>,
}

impl Transport {
    pub fn new(shapes: Vec<Part>, course: Course, samples: u32) -> Result<Self, MorphError> {
        if !(SIDES[0]..=SIDES[1]).contains(&samples) {
            return Err(MorphError::Range {
                what: "transport.samples".to_owned(),
                expected: "16 to 256",
                got: f64::from(samples),
            });
        }
        let domain = whole::bounded(shapes.iter().map(|s| &s.field))?;
        let step = domain.size().max_element() / f64::from(samples);
        let lattice = whole::lattice(&domain, step, f64::INFINITY);
        if let Some(empty) = shapes.iter().find(|s| !whole::meet(&[&s.field], step / 16.0)) {
            return Err(MorphError::Hollow(empty.name.clone()));
        }
        Ok(Self { shapes, course, lattice, masses: OnceLock::new(), stopped: AtomicU32::new(0) })
    }

    fn masses(&self, job: &dyn Job) -> Result<&[Mass], Cancelled> {
        if let Some(made) = self.masses.get() {
            return Ok(made);
        }
        let one = |s: &Part| Mass::new(&s.field, &self.lattice, job);
        let made: Vec<Mass> = self.shapes.iter().map(one).collect::<Result<_, _>>()?;
        Ok(self.masses.get_or_init(|| made))
    }
}

impl Morph for Transport {
    fn at(&self, t: f64, job: &dyn Job) -> Result<Shared, Cancelled> {
        let weights = self.course.at(t);
        if let Some(j) = weights.iter().position(|&w| w >= 1.0 - 1e-12) {
            return Ok(self.shapes[j].field.clone());
        }
        let masses = self.masses(job)?;
        job.stage("transport");
        let taking: Vec<(&Mass, f64)> =
            masses.iter().zip(weights).filter(|(_, w)| *w > 0.0).collect();
        let Found { density, width } = barycentre(self.lattice.size, &taking, job)?;
        if width > LAST {
            self.stopped.fetch_max(width as u32, Relaxed);
        }
        let volume: f64 = taking.iter().map(|(m, w)| m.volume * w).sum();
        let level = level(&density, volume);
        // as shares of the level, so that the samples fit f32
        let samples: Vec<f32> = density.iter().map(|m| (1.0 - m / level) as f32).collect();
        let distance = redistance(&self.lattice, &samples, job)?;
        Ok(Arc::new(Dense::new(self.lattice, distance)))
    }

    fn domain(&self) -> Aabb {
        whole::domain(self.shapes.iter().map(|s| &s.field))
    }

    fn notes(&self) -> Vec<String> {
        let ([x, y, z], step) = (self.lattice.size, self.lattice.step);
        let mut notes = vec![format!(
            "transport: moved on a lattice of {x} x {y} x {z} samples, {step:.2} mm apart"
        )];
        match self.stopped.load(Relaxed) {
            0 => {}
            width => notes.push(format!(
                "transport: shapes so far apart are moved with a blur of {width} samples ({:.1} mm), \
                 the least that reaches; edges are rounder",
                f64::from(width) * step
            )),
        }
        notes
    }
}

impl Mass {
    fn new(field: &Shared, lattice: &Lattice, job: &dyn Job) -> Result<Self, Cancelled> {
        let step = lattice.step as f32;
        let distance = whole::samples(&**field, lattice, job)?;
        // the share of a sample's cube that lies inside, to first order
        let share = |d: f32| f64::from((0.5 - d / step).clamp(0.0, 1.0));
        let mut density: Vec<f64> = distance.into_iter().map(share).collect();
        let volume: f64 = density.iter().sum();
        density.iter_mut().for_each(|m| *m /= volume.max(f64::MIN_POSITIVE));
        Ok(Self { rows: rows(&density, lattice.size), density, volume })
    }

    /// On a lattice of half the samples a side.
    fn halved(&self, size: [u32; 3]) -> Self {
        let half = size.map(halved);
        let [x, y, _] = size.map(|n| n as usize);
        let [hx, hy, hz] = half.map(|n| n as usize);
        let mut density = vec![0.0; hx * hy * hz];
        for (n, &m) in self.density.iter().enumerate().filter(|(_, m)| **m > 0.0) {
            let [i, j, k] = [n % x, n / x % y, n / (x * y)].map(|i| i / 2);
            density[i + hx * (j + hy * k)] += m;
        }
        Self { rows: rows(&density, half), density, volume: self.volume / 8.0 }
    }
}

/// Rows along x that hold any mass.
fn rows(density: &[f64], size: [u32; 3]) -> Vec<bool> {
    density.chunks_exact(size[0] as usize).map(|r| r.iter().any(|&m| m > 0.0)).collect()
}

fn halved(samples: u32) -> u32 {
    samples.div_ceil(2)
}

/// Scalings of a halved lattice on the whole one of `size`: their logarithms, which are potentials,
/// are linear in between.
fn doubled_scalings(coarse: &[f64], half: [u32; 3], size: [u32; 3]) -> Vec<f64> {
    let logs: Vec<f64> = coarse.iter().map(|x| x.max(1e-200).ln()).collect();
    let mut fine = doubled(&logs, half, size);
    fine.par_iter_mut().with_min_len(SHARE).for_each(|x| *x = flushed(x.exp()));
    fine
}

/// Values of a halved lattice on the whole one of `size`, linear in between.
fn doubled(coarse: &[f64], half: [u32; 3], size: [u32; 3]) -> Vec<f64> {
    let [x, y, _] = size.map(|n| n as usize);
    let [hx, hy, hz] = half.map(|n| n as usize);
    // a sample of the whole lattice lies a quarter of a coarse cell from its coarse one
    let ends = |i: usize, n: usize| {
        let other =
            if i.is_multiple_of(2) { (i / 2).saturating_sub(1) } else { (i / 2 + 1).min(n - 1) };
        [(i / 2, 0.75), (other, 0.25)]
    };
    let at = |n: usize| {
        let [i, j, k] = [ends(n % x, hx), ends(n / x % y, hy), ends(n / (x * y), hz)];
        let mut sum = 0.0;
        for (k, wk) in k {
            for (j, wj) in j {
                for (i, wi) in i {
                    sum += wi * wj * wk * coarse[i + hx * (j + hy * k)];
                }
            }
        }
        sum
    };
    let count = size.iter().map(|&n| n as usize).product();
    (0..count).into_par_iter().with_min_len(SHARE).map(at).collect()
}

/// The density above which `volume` samples lie.
fn level(density: &[f64], volume: f64) -> f64 {
    let mut sorted: Vec<f64> = density.iter().copied().filter(|&m| m > 0.0).collect();
    let rank = (volume.round() as usize).clamp(1, sorted.len().max(1));
    if sorted.len() < 2 {
        return f64::MIN_POSITIVE;
    }
    let rank = rank.min(sorted.len() - 1);
    let (above, at, _) = sorted.select_nth_unstable_by(rank, |a, b| b.total_cmp(a));
    // between the last one inside and the first one outside
    let last = above.iter().copied().fold(f64::INFINITY, f64::min);
    0.5 * (last + *at)
}

/// A barycentre.
struct Found {
    density: Vec<f64>,
    /// Width of the last Gaussian, in samples of the whole lattice.
    width: f64,
}

/// Density of the barycentre of masses with their weights.
fn barycentre(size: [u32; 3], masses: &[(&Mass, f64)], job: &dyn Job) -> Result<Found, Cancelled> {
    let halves: Vec<(Mass, f64)> = masses.iter().map(|(m, w)| (m.halved(size), *w)).collect();
    let coarse: Vec<(&Mass, f64)> = halves.iter().map(|(m, w)| (m, *w)).collect();
    let half = size.map(halved);
    let mut start = Barycentre::new(half, &coarse);
    let mut width = FIRST[0];
    while !start.run(width, ROUNDS[0], job)? && width < FIRST[1] {
        start = Barycentre::new(half, &coarse);
        width *= 2.0;
    }
    while start.width() > LAST {
        let (wider, width) = (start.clone(), start.width() / 2.0);
        if !start.run(width, if width > LAST { ROUNDS[0] } else { ROUNDS[1] }, job)? {
            start = wider;
            start.run(2.0 * width, ROUNDS[3], job)?;
            break;
        }
    }
    let finer = |x: &Vec<f64>| doubled_scalings(x, half, size);
    let (blur, density) = (2.0 * start.width(), std::mem::take(&mut start.m));
    if start.width() <= LAST {
        let mut whole = Barycentre {
            b: start.b.iter().map(finer).collect(),
            d: finer(&start.d),
            // in samples of the whole lattice
            gamma: 4.0 * start.gamma,
            ..Barycentre::new(size, masses)
        };
        drop(start);
        if whole.run(LAST, ROUNDS[2], job)? {
            return Ok(Found { density: whole.m, width: LAST });
        }
    }
    Ok(Found { density: doubled(&density, half, size), width: blur })
}

/// The scaling iteration.
#[derive(Clone)]
struct Barycentre<'a> {
    size: [u32; 3],
    masses: &'a [(&'a Mass, f64)],
    /// Squared width of the Gaussian that the scalings are for; infinite before the first.
    gamma: f64,
    /// The scalings b_j.
    b: Vec<Vec<f64>>,
    /// The factor against the blur.
    d: Vec<f64>,
    m: Vec<f64>,
}

impl<'a> Barycentre<'a> {
    fn new(size: [u32; 3], masses: &'a [(&'a Mass, f64)]) -> Self {
        let n = size.iter().map(|&n| n as usize).product();
        Self {
            size,
            masses,
            gamma: f64::INFINITY,
            b: vec![vec![1.0; n]; masses.len()],
            d: vec![1.0; n],
            m: vec![0.0; n],
        }
    }

    /// Width of the Gaussian that the scalings are for, samples.
    fn width(&self) -> f64 {
        self.gamma.sqrt()
    }

    /// A stage; whether its Gaussian reaches all of the mass.
    fn run(&mut self, width: f64, rounds: u32, job: &dyn Job) -> Result<bool, Cancelled> {
        let gamma = width * width;
        let gauss = Gauss::new(self.size, gamma);
        if self.gamma.is_finite() {
            // a scaling is exp(potential / γ), and potentials carry over
            let power = self.gamma / gamma;
            let fields = self.b.iter_mut().chain([&mut self.d]);
            fields.for_each(|x| {
                x.par_iter_mut().with_min_len(SHARE).for_each(|x| *x = scaled(*x, power))
            });
        }
        self.gamma = gamma;
        let mut lost = 0.0;
        for round in 0..rounds {
            job.done(f64::from(round) / f64::from(rounds));
            let moved;
            (moved, lost) = self.round(&gauss, job)?;
            if moved < STILL || lost >= 1.0 {
                break;
            }
        }
        Ok(lost < LOST && self.astray() < 1.0)
    }

    /// How far (samples) the centre of the mass is from the mean of the shapes' centres, where it
    /// must be: farther than rounding only if the Gaussian keeps the mass too near to a shape.
    fn astray(&self) -> f64 {
        let [x, y, _] = self.size.map(|n| n as usize);
        let centre = |density: &[f64]| {
            let at =
                |n: usize| DVec3::new((n % x) as f64, (n / x % y) as f64, (n / (x * y)) as f64);
            let some = density.iter().enumerate().filter(|(_, m)| **m > 0.0);
            some.map(|(n, &m)| at(n) * m).sum::<DVec3>()
        };
        let wanted: DVec3 = self.masses.iter().map(|(m, w)| centre(&m.density) * *w).sum();
        centre(&self.m).distance(wanted)
    }

    /// One round; the share of the mass that it moved, and the share of a shape's mass from which
    /// the Gaussian reaches nothing.
    fn round(&mut self, gauss: &Gauss, job: &dyn Job) -> Result<(f64, f64), Cancelled> {
        let (mut spread, mut lost) = (Vec::with_capacity(self.masses.len()), 0.0f64);
        for ((mass, _), b) in self.masses.iter().zip(&self.b) {
            let mut a = gauss.onto(b, &mass.rows, job)?;
            let ratio = |(a, &m): (&mut f64, &f64)| *a = divided(m, *a);
            a.par_iter_mut().with_min_len(SHARE).zip(&mass.density).for_each(ratio);
            let left = a.iter().zip(&mass.density).filter(|(a, _)| **a <= 0.0);
            lost = lost.max(left.map(|(_, m)| m).sum());
            spread.push(gauss.from(a, job)?);
        }
        let weights: Vec<f64> = self.masses.iter().map(|m| m.1).collect();
        let mean = |n: usize| {
            let logs: f64 = spread.iter().zip(&weights).map(|(s, w)| w * s[n].ln()).sum();
            let m = self.d[n] * logs.exp();
            if m.is_finite() { flushed(m) } else { 0.0 }
        };
        let mut m: Vec<f64> =
            (0..self.d.len()).into_par_iter().with_min_len(SHARE).map(mean).collect();
        // one unit of mass, whatever the last width left: else stages begin with a long swing;
        // summed in one order, so that every number of threads gives the same
        let total: f64 = m.iter().sum();
        if total <= 0.0 {
            return Ok((0.0, 1.0));
        }
        m.par_iter_mut().with_min_len(SHARE).for_each(|m| *m = flushed(*m / total));
        for (b, s) in self.b.iter_mut().zip(&spread) {
            b.par_iter_mut()
                .with_min_len(SHARE)
                .zip(s)
                .zip(&m)
                .for_each(|((b, s), m)| *b = divided(*m, *s));
        }
        drop(spread);
        let back = gauss.from(self.d.clone(), job)?;
        let factor = |((d, h), m): ((&mut f64, &f64), &f64)| *d = divided(*d * m, *h).sqrt();
        self.d.par_iter_mut().with_min_len(SHARE).zip(&back).zip(&m).for_each(factor);
        let moved: f64 = m.iter().zip(&self.m).map(|(a, b)| (a - b).abs()).sum();
        self.m = m;
        Ok((moved, lost))
    }
}

/// 0 where there is nothing to divide by: what is so far off takes no part.
fn divided(a: f64, b: f64) -> f64 {
    let q = a / b;
    if b > 0.0 && q.is_finite() { flushed(q) } else { 0.0 }
}

fn scaled(x: f64, power: f64) -> f64 {
    flushed(x.powf(power)).min(1e200)
}
