//! Enclosures of convex combinations whose weights are known only to lie in intervals.

use crate::num::Interval;
use crate::num::lanes::Interval8;
use fearless_simd::{Simd, f64x8, prelude::*};

/// Values of `Σ w_i x_i` for weights in their intervals with `Σ w_i = 1`, x_i in theirs
/// (METHODS D, item 2: greedy over the box-simplex).
pub(super) fn combine(w: &[Interval], x: &[Interval], order: &mut Vec<usize>) -> Interval {
    order.clear();
    order.extend(0..w.len());
    order.sort_unstable_by(|&a, &b| x[b].hi.total_cmp(&x[a].hi));
    let hi = greedy(w, order, |i| x[i].hi);
    order.sort_unstable_by(|&a, &b| x[a].lo.total_cmp(&x[b].lo));
    let lo = greedy(w, order, |i| x[i].lo);
    Interval::new(lo, hi)
}

/// Gives each weight its least, then hands the rest to the terms in order.
fn greedy(w: &[Interval], order: &[usize], x: impl Fn(usize) -> f64) -> f64 {
    let least: f64 = w.iter().map(|w| w.lo).sum();
    let mut rest = (1.0 - least).max(0.0);
    let mut sum = 0.0;
    for &i in order {
        let extra = rest.min(w[i].hi - w[i].lo).max(0.0);
        rest -= extra;
        let weight = w[i].lo + extra;
        // a weight of zero makes even an unbounded term vanish
        if weight > 0.0 {
            sum += weight * x(i);
        }
    }
    sum
}

/// [`combine`] over eight boxes, for numbers that are known.
#[inline(always)]
pub(super) fn combine_known<S: Simd>(
    s: S,
    w: &[Interval8<S>],
    x: &[f64],
    order: &mut Vec<usize>,
) -> Interval8<S> {
    if let Some(&first) = x.first()
        && x.iter().all(|&x| x == first)
    {
        return Interval8::point(s, first);
    }
    order.clear();
    order.extend(0..x.len());
    order.sort_unstable_by(|&a, &b| x[a].total_cmp(&x[b]));
    let zero = f64x8::splat(s, 0.0);
    let (mut least, mut sum) = (zero, zero);
    for (w, &x) in w.iter().zip(x) {
        least += w.lo;
        sum += w.lo * x;
    }
    let rest = (f64x8::splat(s, 1.0) - least).max(zero);
    let mut out = Interval8 { lo: sum, hi: sum };
    let mut left = rest;
    for &i in order.iter() {
        let extra = left.min(w[i].hi - w[i].lo);
        left -= extra;
        out.lo += extra * x[i];
    }
    left = rest;
    for &i in order.iter().rev() {
        let extra = left.min(w[i].hi - w[i].lo);
        left -= extra;
        out.hi += extra * x[i];
    }
    out
}

/// A weight with less than this share of the greatest slack hardly ever is the one that takes the last
/// of the rest.
const LOOSE: f64 = 1.0 / 64.0;

/// [`combine`] over eight boxes, for finite x_i.
///
/// No order differs from lane to lane: for every m, `Σ w_i x_i = m + Σ w_i (x_i - m)` is at most
/// `m + Σ max(lo_i (x_i - m), hi_i (x_i - m))`, and this is least where m is the x_i of the term
/// that takes the last of the rest.
#[inline(always)]
pub(super) fn combine_all<S: Simd>(s: S, w: &[Interval8<S>], x: &[Interval8<S>]) -> Interval8<S> {
    let none = f64x8::splat(s, f64::INFINITY);
    let mut loose = f64x8::splat(s, 0.0);
    for w in w {
        loose = loose.max((w.hi - w.lo) * LOOSE);
    }
    let mut out = Interval8 { lo: -none, hi: none };
    for (own, at) in w.iter().zip(x) {
        // the one with the greatest slack is always tried
        if !(own.hi - own.lo).simd_ge(loose).any_true() {
            continue;
        }
        let Interval8 { mut lo, mut hi } = *at;
        for (w, x) in w.iter().zip(x) {
            let (below, above) = (x.lo - at.lo, x.hi - at.hi);
            lo += (w.lo * below).min(w.hi * below);
            hi += (w.lo * above).max(w.hi * above);
        }
        out.lo = out.lo.max(lo);
        out.hi = out.hi.min(hi);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};
    use proptest::prelude::*;

    #[test]
    fn holds_every_combination_and_is_reached() {
        let w = [Interval::new(0.1, 0.5), Interval::new(0.2, 0.9), Interval::new(0.0, 0.3)];
        let x = [Interval::new(-1.0, 2.0), Interval::new(0.5, 0.75), Interval::new(3.0, 4.0)];
        let f = combine(&w, &x, &mut Vec::new());
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for i in 0..=40 {
            for j in 0..=40 {
                let a = w[0].lo + w[0].width() * f64::from(i) / 40.0;
                let c = w[2].lo + w[2].width() * f64::from(j) / 40.0;
                let b = 1.0 - a - c;
                if !w[1].widen(1e-12).contains(b) {
                    continue;
                }
                let lo = a * x[0].lo + b * x[1].lo + c * x[2].lo;
                let hi = a * x[0].hi + b * x[1].hi + c * x[2].hi;
                assert!(f.widen(1e-12).contains(lo) && f.widen(1e-12).contains(hi));
                (least, most) = (least.min(lo), most.max(hi));
            }
        }
        assert!((least - f.lo).abs() < 1e-9 && (most - f.hi).abs() < 1e-9);
    }

    fn ranges(lo: f64, width: f64) -> impl Strategy<Value = Vec<Interval>> {
        let one = (-lo..lo, 0.0..width).prop_map(|(lo, width)| Interval::new(lo, lo + width));
        prop::collection::vec(one, 5)
    }

    proptest! {
        /// In every lane no less than what one box gives alone, and no more where weights are loose.
        #[test]
        fn eight_at_once_are_eight_alone(
            shares in prop::array::uniform5((0.05..1.0f64, 0.02..0.1f64)),
            x in ranges(100.0, 20.0),
        ) {
            let sum: f64 = shares.iter().map(|(w, _)| w).sum();
            let w = shares.map(|(w, r)| Interval::ball(w / sum, r).clamp(0.0, 1.0));
            let known: Vec<f64> = x.iter().map(|x| x.lo).collect();
            let points: Vec<_> = known.iter().map(|&x| Interval::point(x)).collect();
            let (all, all_known) = dispatch!(Level::new(), s => {
                let lanes = |x: &Interval| Interval8 {
                    lo: f64x8::splat(s, x.lo),
                    hi: f64x8::splat(s, x.hi),
                };
                let (w, x) = (w.each_ref().map(lanes), x.iter().map(lanes).collect::<Vec<_>>());
                let some = combine_all(s, &w, &x).lanes();
                (some, combine_known(s, &w, &known, &mut Vec::new()).lanes())
            });
            for (all, x) in [(all, &x), (all_known, &points)] {
                let alone = combine(&w, x, &mut Vec::new());
                for got in all {
                    prop_assert!((got.lo - alone.lo).abs() < 1e-9, "{got:?} {alone:?}");
                    prop_assert!((got.hi - alone.hi).abs() < 1e-9, "{got:?} {alone:?}");
                }
            }
        }
    }
}
