//! The same curve on other knots, by polar forms: insertion, clamping and degree elevation at once.
//!
//! The polar form of a polynomial piece of degree p is the symmetric map f(u1, ..., up), affine in
//! each argument, with f(u, ..., u) = C(u). Pole j of a B-spline is f(t[j+1], ..., t[j+p]) of *any*
//! piece in its support. So poles on finer knots are polar values at the finer knots, and the polar
//! form one degree up is the mean of those with one argument left out: elevation needs no knots
//! beyond the least (each distinct knot once more), with nothing to remove afterwards.

use super::knots::Knots;
use glam::DVec4;

/// The poles on `new` of the curve with these poles on `old`. The new knots hold the old ones (within
/// the domain), at the same degree or one degree more with each distinct knot once more.
pub(super) fn poles_on(old: &Knots, poles: &[DVec4], new: &Knots) -> Vec<DVec4> {
    if old == new {
        return poles.to_vec();
    }
    let q = new.degree;
    let mut work = Vec::with_capacity(old.degree + 1);
    let mut pole = |j: usize| {
        let support = &new.values[j..=j + q + 1];
        let k = old.span(widest(support));
        let arguments = &support[1..=q];
        if q == old.degree {
            return polar(old, poles, k, arguments.iter().copied(), &mut work);
        }
        let without = |i: usize| {
            let rest = arguments.iter().enumerate().filter(move |&(n, _)| n != i);
            rest.map(|(_, &t)| t)
        };
        let mut sum = DVec4::ZERO;
        for i in 0..q {
            sum += polar(old, poles, k, without(i), &mut work);
        }
        sum / q as f64
    };
    (0..new.count()).map(&mut pole).collect()
}

/// The middle of the widest gap. All arguments then lie within a few widths of the piece that is
/// chosen by it, however narrow its neighbours, and rounding is not blown up.
fn widest(support: &[f64]) -> f64 {
    let gap = |w: &&[f64]| w[1] - w[0];
    let wide = support.windows(2).max_by(|a, b| gap(a).total_cmp(&gap(b)));
    wide.map_or(0.0, |w| 0.5 * (w[0] + w[1]))
}

/// f(arguments) of the piece on span `k` (de Boor's recurrence, one argument a step).
fn polar(
    knots: &Knots,
    poles: &[DVec4],
    k: usize,
    arguments: impl Iterator<Item = f64>,
    work: &mut Vec<DVec4>,
) -> DVec4 {
    let (p, t) = (knots.degree, &knots.values);
    work.clear();
    work.extend_from_slice(&poles[k - p..=k]);
    for (r, u) in arguments.enumerate() {
        for i in 0..p - r {
            let [left, right] = [t[k - p + r + 1 + i], t[k + 1 + i]];
            let a = (u - left) / (right - left);
            work[i] = work[i] * (1.0 - a) + work[i + 1] * a;
        }
    }
    work[0]
}
