//! The morphing function f_m: from the values of k shapes at corresponding points and their weights
//! to one value.

use super::convex::combine;
use super::space_time::Bounded;
use crate::num::Interval;
use crate::num::lanes::LANES;
use fearless_simd::{Simd, f64x8, prelude::*};

/// A morphing function with its parameters chosen.
#[derive(Clone, Debug)]
pub(super) enum Mix {
    Linear,
    SpaceTime(Bounded),
    Grow,
    Erode,
    Auto,
}

/// What a morphing function knows of the place, blended from the features like the weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Local {
    /// Largest one-sided Hausdorff distance between the shapes here, mm: how far they grow.
    pub reach: f64,
    /// Largest depth of a shape here, mm: how far they erode.
    pub depth: f64,
    /// 0 where the shapes overlap well, 1 where they do not.
    pub apart: f64,
    /// Level that keeps the mean volume of the linear form here, mm.
    pub level: f64,
}

impl Local {
    /// Nothing yet.
    pub const NONE: Self = Self { reach: 0.0, depth: 0.0, apart: 0.0, level: 0.0 };
}

/// Eight [`Local`]s.
pub(super) struct Local8<S: Simd> {
    reach: f64x8<S>,
    depth: f64x8<S>,
    apart: f64x8<S>,
    level: f64x8<S>,
}

impl<S: Simd> Local8<S> {
    /// The same in all lanes.
    #[inline(always)]
    pub fn splat(s: S, l: &Local) -> Self {
        Self {
            reach: f64x8::splat(s, l.reach),
            depth: f64x8::splat(s, l.depth),
            apart: f64x8::splat(s, l.apart),
            level: f64x8::splat(s, l.level),
        }
    }

    /// Adds one by its weights.
    #[inline(always)]
    pub fn add(&mut self, w: f64x8<S>, l: &Local) {
        self.reach += w * l.reach;
        self.depth += w * l.depth;
        self.apart += w * l.apart;
        self.level += w * l.level;
    }

    #[inline(always)]
    fn lane(&self, i: usize) -> Local {
        let Self { reach, depth, apart, level } = self;
        Local { reach: reach[i], depth: depth[i], apart: apart[i], level: level[i] }
    }
}

/// A range of [`Local`]s.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocalRange {
    pub reach: Interval,
    pub depth: Interval,
    pub apart: Interval,
    pub level: Interval,
}

impl Mix {
    /// The value at fields `g` (f < 0 inside) with weights `lam` that sum to one.
    pub fn value(&self, g: &[f64], lam: &[f64], at: &Local) -> f64 {
        match self {
            Self::Linear => linear(g, lam),
            Self::SpaceTime(b) => b.value(g, lam),
            Self::Grow => grow(g, lam, at.reach),
            Self::Erode => least_shifted(g, lam, at.depth, None),
            Self::Auto => {
                let (l, u) = (linear(g, lam) - at.level, grow(g, lam, at.reach));
                l + (u - l) * at.apart
            }
        }
    }

    /// [`Mix::value`] of eight points, to the bit.
    #[inline(always)]
    pub fn values<S: Simd>(
        &self,
        s: S,
        g: &[f64x8<S>],
        lam: &[f64x8<S>],
        at: &Local8<S>,
    ) -> f64x8<S> {
        match self {
            Self::Linear => linears(s, g, lam),
            Self::Grow => grown(s, g, lam, at.reach),
            Self::Auto => {
                let l = linears(s, g, lam) - at.level;
                let u = grown(s, g, lam, at.reach);
                l + (u - l) * at.apart
            }
            Self::SpaceTime(_) | Self::Erode => {
                let mut out = [0.0; LANES];
                for (lane, out) in out.iter_mut().enumerate() {
                    let g: Vec<f64> = g.iter().map(|g| g[lane]).collect();
                    let lam: Vec<f64> = lam.iter().map(|l| l[lane]).collect();
                    *out = self.value(&g, &lam, &at.lane(lane));
                }
                f64x8::simd_from(s, out)
            }
        }
    }

    /// An enclosure of [`Mix::value`].
    pub fn bound(
        &self,
        g: &[Interval],
        lam: &[Interval],
        at: &LocalRange,
        order: &mut Vec<usize>,
    ) -> Interval {
        match self {
            Self::Linear => combine(lam, g, order),
            Self::SpaceTime(b) => b.bound(g, lam, order),
            Self::Grow => grow_bound(g, lam, at.reach),
            Self::Erode => least_shifted_bound(g, lam, at.depth, None),
            Self::Auto => {
                let l = combine(lam, g, order) - at.level;
                let u = grow_bound(g, lam, at.reach);
                let w = [Interval::new(1.0 - at.apart.hi, 1.0 - at.apart.lo), at.apart];
                combine(&w, &[l, u], order)
            }
        }
    }
}

fn linear(g: &[f64], lam: &[f64]) -> f64 {
    g.iter().zip(lam).map(|(g, l)| if *l > 0.0 { g * l } else { 0.0 }).sum()
}

fn greatest(lam: &[f64]) -> f64 {
    lam.iter().copied().fold(0.0, f64::max)
}

/// `min_j (g_j + by (1 - ratio_j))` over the shapes with weight but `skip`, ratio_j the weight over
/// the greatest weight.
fn least_shifted(g: &[f64], lam: &[f64], by: f64, skip: Option<usize>) -> f64 {
    let top = greatest(lam);
    let mut least = f64::INFINITY;
    for (j, (&g, &l)) in g.iter().zip(lam).enumerate() {
        if l > 0.0 && skip != Some(j) {
            least = least.min(g + by * (1.0 - l / top));
        }
    }
    least
}

/// The dominant shape whole, and of every other shape what lies within `reach * ratio` of the rest
/// (GRAFT.md, recipe E, in the house's sign). The rest leaves the shape itself out: with it the
/// whole of a lesser shape would be there from half the greatest weight on.
pub(super) fn grow(g: &[f64], lam: &[f64], reach: f64) -> f64 {
    let top = greatest(lam);
    let mut least = f64::INFINITY;
    for (j, (&v, &l)) in g.iter().zip(lam).enumerate() {
        if l >= top {
            least = least.min(v);
        } else if l > 0.0 {
            let near = least_shifted(g, lam, reach, Some(j));
            least = least.min(v.max(near - reach * l / top));
        }
    }
    least
}

/// [`linear`] of eight points.
#[inline(always)]
fn linears<S: Simd>(s: S, g: &[f64x8<S>], lam: &[f64x8<S>]) -> f64x8<S> {
    let zero = f64x8::splat(s, 0.0);
    let mut sum = zero;
    for (&g, &l) in g.iter().zip(lam) {
        sum += l.simd_gt(zero).select(g * l, zero);
    }
    sum
}

/// [`grow`] of eight points.
#[inline(always)]
fn grown<S: Simd>(s: S, g: &[f64x8<S>], lam: &[f64x8<S>], reach: f64x8<S>) -> f64x8<S> {
    let (zero, one) = (f64x8::splat(s, 0.0), f64x8::splat(s, 1.0));
    let none = f64x8::splat(s, f64::INFINITY);
    let mut top = zero;
    for &l in lam {
        top = top.max(l);
    }
    let mut least = none;
    for (j, (&v, &l)) in g.iter().zip(lam).enumerate() {
        let (whole, some) = (l.simd_ge(top), l.simd_gt(zero));
        let mut own = v;
        if !whole.all_true() {
            let mut near = none;
            for (i, (&g, &l)) in g.iter().zip(lam).enumerate() {
                if i != j {
                    let shifted = g + reach * (one - l / top);
                    near = l.simd_gt(zero).select(near.min(shifted), near);
                }
            }
            let lesser = v.max(near - reach * l / top);
            own = whole.select(v, some.select(lesser, none));
        }
        least = least.min(own);
    }
    least
}

/// Ratios of the weights to the greatest of them; `hi` is 0 for a shape that has no weight at all.
fn ratio(lam: &[Interval], i: usize) -> Interval {
    let mine = lam[i];
    let (mut lo, mut hi) = (0.0f64, 0.0f64);
    for l in lam {
        (lo, hi) = (lo.max(l.lo), hi.max(l.hi));
    }
    if mine.hi <= 0.0 {
        return Interval::point(0.0);
    }
    // the greatest weight is at least the greatest lower end, and at least this very weight
    let least = if hi > 0.0 { mine.lo / hi } else { 0.0 };
    let others = (0..lam.len()).filter(|&j| j != i).map(|j| lam[j].hi).fold(0.0, f64::max);
    let least = if mine.lo >= others { 1.0 } else { least };
    let most = if lo > 0.0 { (mine.hi / lo).min(1.0) } else { 1.0 };
    Interval::new(least.min(most), most)
}

/// Encloses [`least_shifted`]; with a shape skipped, for the case that it is not the dominant one.
fn least_shifted_bound(
    g: &[Interval],
    lam: &[Interval],
    by: Interval,
    skip: Option<usize>,
) -> Interval {
    let (mut lo, mut hi) = (f64::INFINITY, f64::INFINITY);
    let mut dominant = f64::NEG_INFINITY;
    for i in (0..g.len()).filter(|&i| lam[i].hi > 0.0 && skip != Some(i)) {
        let r = ratio(lam, i);
        lo = lo.min(g[i].lo + by.lo * (1.0 - r.hi));
        if lam[i].lo > 0.0 {
            hi = hi.min(g[i].hi + by.hi * (1.0 - r.lo));
        }
        if r.hi >= 1.0 {
            dominant = dominant.max(g[i].hi);
        }
    }
    Interval::new(lo, hi.min(dominant).max(lo))
}

fn grow_bound(g: &[Interval], lam: &[Interval], reach: Interval) -> Interval {
    let (mut lo, mut hi) = (f64::INFINITY, f64::INFINITY);
    let mut dominant = f64::NEG_INFINITY;
    for i in (0..g.len()).filter(|&i| lam[i].hi > 0.0) {
        let r = ratio(lam, i);
        if r.hi >= 1.0 {
            // perhaps dominant: as low as the shape itself, and if dominant no higher
            lo = lo.min(g[i].lo);
            dominant = dominant.max(g[i].hi);
        }
        if r.lo < 1.0 {
            let near = least_shifted_bound(g, lam, reach, Some(i));
            if r.hi < 1.0 {
                lo = lo.min(g[i].lo.max(near.lo - reach.hi * r.hi));
            }
            if lam[i].lo > 0.0 {
                hi = hi.min(g[i].hi.max(near.hi - reach.lo * r.lo));
            }
        } else {
            hi = hi.min(g[i].hi);
        }
    }
    Interval::new(lo, hi.min(dominant).max(lo))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::morph::plan::Form;
    use fearless_simd::{Level, dispatch};
    use proptest::prelude::*;

    fn mixes() -> Vec<Mix> {
        let bounded = |form| Bounded { form, a0: 3.0, a: vec![2.0, 3.0, 1.5], a3: 1.2, reach: 4.0 };
        vec![
            Mix::Linear,
            Mix::SpaceTime(bounded(Form::L)),
            Mix::SpaceTime(bounded(Form::S)),
            Mix::Grow,
            Mix::Erode,
            Mix::Auto,
        ]
    }

    fn between(lo: f64, width: f64, at: f64) -> (Interval, f64) {
        (Interval::new(lo, lo + width), lo + width * at)
    }

    proptest! {
        /// Any value with all arguments in their intervals lies in the bound.
        #[test]
        fn bound_encloses(
            g in prop::array::uniform3((-5.0..5.0f64, 0.0..3.0f64, 0.0..=1.0f64)),
            raw in prop::array::uniform3((0.0..1.0f64, prop::bool::weighted(0.2))),
            slack in prop::array::uniform3((0.0..0.3f64, 0.0..0.3f64)),
            reach in (0.5..6.0f64, 0.0..2.0f64, 0.0..=1.0f64),
            apart in (0.0..0.6f64, 0.0..0.4f64, 0.0..=1.0f64),
        ) {
            let raw = raw.map(|(x, zero)| if zero { 0.0 } else { x });
            let sum: f64 = raw.iter().sum();
            prop_assume!(sum > 1e-3);
            let lam = raw.map(|x| x / sum);
            let lam_range: Vec<Interval> = (0..3)
                .map(|i| Interval::new((lam[i] - slack[i].0).max(0.0), (lam[i] + slack[i].1).min(1.0)))
                .collect();
            let (gi, gv): (Vec<_>, Vec<_>) = g.iter().map(|&(a, b, c)| between(a, b, c)).unzip();
            let (ri, rv) = between(reach.0, reach.1, reach.2);
            let (ai, av) = between(apart.0, apart.1, apart.2);
            let at = Local { reach: rv, depth: rv, apart: av, level: 0.4 };
            let range = LocalRange { reach: ri, depth: ri, apart: ai, level: Interval::point(0.4) };
            for mix in mixes() {
                let v = mix.value(&gv, &lam, &at);
                let b = mix.bound(&gi, &lam_range, &range, &mut Vec::new());
                prop_assert!(b.widen(1e-9).contains(v), "{mix:?}: {v} not in {b:?}");
            }
        }

        /// What a point gives alone and among eight.
        #[test]
        fn eight_at_once_are_eight_alone(
            g in prop::array::uniform3(prop::array::uniform8(-5.0..5.0f64)),
            raw in prop::array::uniform3(prop::array::uniform8((0.0..1.0f64, prop::bool::weighted(0.3)))),
            reach in 0.5..6.0f64,
        ) {
            let raw = raw.map(|r| r.map(|(x, zero)| if zero { 0.0 } else { x }));
            let sum: [f64; LANES] = std::array::from_fn(|i| raw.iter().map(|r| r[i]).sum());
            prop_assume!(sum.iter().all(|&s| s > 1e-3));
            let lam: [[f64; LANES]; 3] =
                raw.map(|r| std::array::from_fn(|i| r[i] / sum[i]));
            let at = Local { reach, depth: reach, apart: 0.3, level: 0.4 };
            for mix in mixes() {
                let all: [f64; LANES] = dispatch!(Level::new(), s => {
                    let (g, lam) = (g.map(|g| f64x8::simd_from(s, g)), lam.map(|l| f64x8::simd_from(s, l)));
                    mix.values(s, &g, &lam, &Local8::splat(s, &at)).into()
                });
                for i in 0..LANES {
                    let alone = mix.value(&g.map(|g| g[i]), &lam.map(|l| l[i]), &at);
                    prop_assert_eq!(all[i], alone, "{:?}", mix);
                }
            }
        }

        /// A weight of one gives that shape's value back, whatever the function.
        #[test]
        fn corners_are_exact(g in prop::array::uniform3(-5.0..5.0f64), j in 0..3usize) {
            let mut lam = [0.0; 3];
            lam[j] = 1.0;
            let at = Local { reach: 2.0, depth: 2.0, apart: 1.0, level: 0.0 };
            for mix in mixes() {
                prop_assert_eq!(mix.value(&g, &lam, &at), g[j]);
            }
        }
    }

    #[test]
    fn grow_reveals_the_lesser_shape_outward_from_the_dominant_one() {
        // dominant: x < 0; lesser: x < 10; half weight reveals half the way
        let at = |x: f64| grow(&[x, x - 10.0], &[2.0 / 3.0, 1.0 / 3.0], 10.0);
        assert!(at(4.9) < 0.0 && at(5.1) > 0.0);
        // equal weights give the union
        assert!((grow(&[3.0, -1.0], &[0.5, 0.5], 10.0) + 1.0).abs() < 1e-15);
    }
}
