//! Enclosures of convex combinations whose weights are known only to lie in intervals.

use crate::num::Interval;

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

#[cfg(test)]
mod tests {
    use super::*;

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
}
