//! Bounded blending in space-time (Pasko et al. 2002, 2004; METHODS B) for two and for k shapes.
//!
//! The formulas stand as in the papers, f > 0 inside; [`Bounded::value`] and [`Bounded::bound`]
//! take and give the house's sign.

use super::convex::combine;
use super::plan::Form;
use crate::num::Interval;

/// The blend with all parameters chosen.
#[derive(Clone, Debug)]
pub(super) struct Bounded {
    pub form: Form,
    /// Height of the blend, mm.
    pub a0: f64,
    /// Reach in space, mm, one a shape.
    pub a: Vec<f64>,
    /// Reach in time.
    pub a3: f64,
    /// Largest of the shapes' one-sided Hausdorff distances, mm: the scale of S and half-cylinders.
    pub reach: f64,
}

/// Share of `reach` by which the S form lowers a shape of half weight.
const LOWERING: f64 = 0.25;

/// disp(r) of METHODS B with r in [0, 1]: 1 at 0, falling to 0 with zero slope at 1.
fn disp(r: f64) -> f64 {
    if r < 1.0 { (1.0 - r).powi(3) / (1.0 + r) } else { 0.0 }
}

/// disp as a function of q >= 0 and of the time term g >= 0: falls with q, rises with g.
fn bump(q: f64, g: f64) -> f64 {
    if g <= 0.0 {
        return 0.0;
    }
    if q.is_infinite() { 0.0 } else { disp(q / (q + g * g)) }
}

/// 4 a b / (a + b), zero when either is: 4 t (1 - t) for a pair.
fn pair_time(a: f64, b: f64) -> f64 {
    if a <= 0.0 || b <= 0.0 { 0.0 } else { 4.0 * a * b / (a + b) }
}

fn union(a: f64, b: f64) -> f64 {
    a + b + a.hypot(b)
}

fn meet(a: f64, b: f64) -> f64 {
    a + b - a.hypot(b)
}

impl Bounded {
    /// Base and unit blend, f > 0 inside: the value is `base + a0 * blend`.
    pub fn parts(&self, g: &[f64], lam: &[f64]) -> (f64, f64) {
        match self.form {
            Form::L => {
                let base = -g
                    .iter()
                    .zip(lam)
                    .map(|(g, l)| if *l > 0.0 { g * l } else { 0.0 })
                    .sum::<f64>();
                (base, self.pairs(|i| -g[i], lam))
            }
            Form::S => {
                let low = |i: usize| self.lowered(-g[i], lam[i]);
                let base = (0..g.len()).map(low).fold(f64::NEG_INFINITY, f64::max);
                (base, self.pairs(low, lam))
            }
            Form::HalfCylinders => self.cylinders(-g[0], -g[1], lam[1]),
        }
    }

    fn lowered(&self, f: f64, lam: f64) -> f64 {
        if lam <= 0.0 { f64::NEG_INFINITY } else { f - LOWERING * self.reach * (1.0 - lam) / lam }
    }

    fn pairs(&self, f: impl Fn(usize) -> f64, lam: &[f64]) -> f64 {
        let mut sum = 0.0;
        for i in 0..lam.len() {
            for j in 0..i {
                let g = pair_time(lam[i], lam[j]) / self.a3;
                if g > 0.0 {
                    sum += bump((f(i) / self.a[i]).powi(2) + (f(j) / self.a[j]).powi(2), g);
                }
            }
        }
        sum
    }

    /// Time runs from -10 to 10 while t runs from 0 to 1; one unit of it is a tenth of the reach.
    fn cylinders(&self, f1: f64, f2: f64, t: f64) -> (f64, f64) {
        let tau = 20.0 * t - 10.0;
        let unit = 0.1 * self.reach;
        let (c1, c2) = (meet(f1, -tau * unit), meet(f2, (tau - 1.0) * unit));
        let f3 = meet(tau + 10.0, 10.0 - tau).max(0.0);
        let q = (c1 / self.a[0]).powi(2) + (c2 / self.a[1]).powi(2);
        (union(c1, c2), bump(q, f3 / self.a3))
    }

    /// The blend at fields `g` (f < 0 inside) and weights `lam`.
    pub fn value(&self, g: &[f64], lam: &[f64]) -> f64 {
        let (base, blend) = self.parts(g, lam);
        -(base + self.a0 * blend)
    }

    /// An enclosure of [`Bounded::value`].
    pub fn bound(&self, g: &[Interval], lam: &[Interval], order: &mut Vec<usize>) -> Interval {
        match self.form {
            Form::L => {
                let base = combine(lam, g, order);
                base - self.pairs_bound(|i| -g[i], lam)
            }
            Form::S => {
                let low = |i: usize| {
                    Interval::new(
                        self.lowered(-g[i].hi, lam[i].lo),
                        self.lowered(-g[i].lo, lam[i].hi),
                    )
                };
                let base =
                    (0..g.len()).map(low).fold(Interval::point(f64::NEG_INFINITY), Interval::max);
                -(base + self.pairs_bound(low, lam))
            }
            Form::HalfCylinders => self.cylinders_bound(-g[0], -g[1], lam[1]),
        }
    }

    /// `a0` times the enclosure of the pairs' blends.
    fn pairs_bound(&self, f: impl Fn(usize) -> Interval, lam: &[Interval]) -> Interval {
        let mut sum = Interval::point(0.0);
        for i in 0..lam.len() {
            for j in 0..i {
                let (fi, fj) = (f(i).abs(), f(j).abs());
                let q = |x: f64, y: f64| (x / self.a[i]).powi(2) + (y / self.a[j]).powi(2);
                let time = |a: f64, b: f64| pair_time(a, b) / self.a3;
                let lo = bump(q(fi.hi, fj.hi), time(lam[i].lo, lam[j].lo));
                let hi = bump(q(fi.lo, fj.lo), time(lam[i].hi, lam[j].hi));
                sum = sum + Interval::new(lo, hi);
            }
        }
        sum.scale(self.a0)
    }

    /// Both R-functions rise in both arguments, so the ends give the ends; t is one number, since
    /// only whole shapes are blended in this form or the weights enclose it.
    fn cylinders_bound(&self, f1: Interval, f2: Interval, t: Interval) -> Interval {
        let unit = 0.1 * self.reach;
        let tau = t.scale(20.0).shift(-10.0);
        let both = |f: fn(f64, f64) -> f64, a: Interval, b: Interval| {
            Interval::new(f(a.lo, b.lo), f(a.hi, b.hi))
        };
        let c1 = both(meet, f1, (-tau).scale(unit));
        let c2 = both(meet, f2, tau.shift(-1.0).scale(unit));
        let f3 = both(meet, tau.shift(10.0), (-tau).shift(10.0));
        let q = |a: f64, b: f64| (a / self.a[0]).powi(2) + (b / self.a[1]).powi(2);
        let (n1, n2) = (c1.abs(), c2.abs());
        let lo = bump(q(n1.hi, n2.hi), f3.lo.max(0.0) / self.a3);
        let hi = bump(q(n1.lo, n2.lo), f3.hi.max(0.0) / self.a3);
        -(both(union, c1, c2) + Interval::new(lo, hi).scale(self.a0))
    }
}

/// The least height of the blend at which `wanted` of the samples lie inside, between 0 and `cap`.
/// Each sample is its (base, blend) from [`Bounded::parts`]; more height never loses a sample, so
/// the height is an order statistic (METHODS B).
pub(super) fn height_for_volume(samples: &[(f64, f64)], wanted: f64, cap: f64) -> f64 {
    let mut at: Vec<f64> = samples
        .iter()
        .filter_map(|&(base, blend)| match base {
            b if b > 0.0 => Some(0.0),
            b if blend > 0.0 => Some(-b / blend),
            _ => None,
        })
        .collect();
    let rank = wanted.round() as usize;
    if rank == 0 || at.is_empty() {
        return 0.0;
    }
    if rank > at.len() {
        return cap;
    }
    let (_, height, _) = at.select_nth_unstable_by(rank - 1, f64::total_cmp);
    height.clamp(0.0, cap)
}
