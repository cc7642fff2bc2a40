use crate::num::Interval;
use crate::num::lanes::{Interval8, LANES};
use fearless_simd::{Simd, f64x8, prelude::*};

/// Covers the round-off of the few operations behind a weight.
const SLACK: f64 = 1e-12;

/// How feature distances become weights that sum to one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Weighting {
    /// C1 and positive: phi(d)^(power/2) with phi = (1 + depth/e)^2 inside, (1 + d/e)^-2 outside.
    Smooth {
        /// e, mm.
        epsilon: f64,
        /// 2 unless told otherwise; 4 is sharper.
        power: f64,
    },
    /// Paper 001, eq. 5, to the letter: depths inside, inverse distances outside all features. It
    /// jumps where features share a face; two or more distances of zero share equally.
    Transfinite,
    /// Paper 001, eq. 4 (Lerios 1995): (d + e)^-2 of the distance outside, 0 inside.
    InverseSquare {
        /// e, mm.
        epsilon: f64,
    },
}

impl Weighting {
    /// Weights of the features at distances `d`; `out` is as long as `d` and sums to one.
    pub fn weigh(&self, d: &[f64], out: &mut [f64]) {
        match *self {
            Self::Smooth { .. } | Self::InverseSquare { .. } => {
                for (w, &d) in out.iter_mut().zip(d) {
                    *w = self.kernel(d);
                }
            }
            Self::Transfinite => transfinite(d, out),
        }
        normalise(out);
    }

    /// [`Weighting::weigh`] at eight points, to the bit; `out` is as long as `d`.
    #[inline(always)]
    pub(crate) fn weigh_all<S: Simd>(&self, s: S, d: &[f64x8<S>], out: &mut [f64x8<S>]) {
        let mut sum = f64x8::splat(s, 0.0);
        if let Some(smooth) = self.smooth() {
            for (w, &d) in out.iter_mut().zip(d) {
                *w = smooth.kernels(s, d);
                sum += *w;
            }
        }
        let fine = sum.simd_gt(f64x8::splat(s, 0.0)) & sum.simd_lt(f64x8::splat(s, f64::INFINITY));
        if fine.all_true() {
            for w in out {
                *w /= sum;
            }
            return;
        }
        for lane in 0..LANES {
            let row: Vec<f64> = d.iter().map(|d| d[lane]).collect();
            let mut weights = vec![0.0; row.len()];
            self.weigh(&row, &mut weights);
            for (out, w) in out.iter_mut().zip(weights) {
                out[lane] = w;
            }
        }
    }

    /// [`Weighting::enclose`] over eight boxes; `out` is as long as `d`.
    #[inline(always)]
    pub(crate) fn enclose_all<S: Simd>(&self, s: S, d: &[Interval8<S>], out: &mut [Interval8<S>]) {
        if let Some(smooth) = self.smooth() {
            return smooth.shares(s, d, out);
        }
        for lane in 0..LANES {
            let row: Vec<_> = d.iter().map(|d| Interval::new(d.lo[lane], d.hi[lane])).collect();
            let mut ranges = vec![Interval::ALL; row.len()];
            self.enclose(&row, &mut ranges);
            for (out, range) in out.iter_mut().zip(ranges) {
                (out.lo[lane], out.hi[lane]) = (range.lo, range.hi);
            }
        }
    }

    /// The smooth form where it is made of products alone.
    fn smooth(&self) -> Option<Smooth> {
        match *self {
            Self::Smooth { epsilon, power } if power == 2.0 || power == 4.0 => {
                Some(Smooth { epsilon, twice: power == 4.0 })
            }
            _ => None,
        }
    }

    /// Enclosures of the weights when each distance lies in its interval.
    ///
    /// With kernels in `[lo, hi]` a weight lies between `lo_i / (lo_i + sum of the others' hi)` and
    /// `hi_i / (hi_i + sum of the others' lo)` (METHODS D).
    pub fn enclose(&self, d: &[Interval], out: &mut [Interval]) {
        match *self {
            Self::Smooth { .. } | Self::InverseSquare { .. } => {
                shares(d, out, |d| Interval::new(self.kernel(d.hi), self.kernel(d.lo)));
            }
            Self::Transfinite => enclose_transfinite(d, out),
        }
    }

    /// The unnormalised weight at distance `d`; falls as `d` grows.
    fn kernel(&self, d: f64) -> f64 {
        match *self {
            Self::Smooth { epsilon, power } => {
                let base = 1.0 + d.abs() / epsilon;
                let base = if d < 0.0 { base } else { 1.0 / base };
                // powers of two are what is used, and powf is slow
                match power {
                    2.0 => base * base,
                    4.0 => (base * base) * (base * base),
                    _ => base.powf(power),
                }
            }
            Self::InverseSquare { epsilon } => (d.max(0.0) + epsilon).powi(-2),
            Self::Transfinite => 1.0 / d.abs(),
        }
    }
}

/// [`Weighting::Smooth`] of power 2, or 4.
#[derive(Clone, Copy)]
struct Smooth {
    epsilon: f64,
    /// Whether the power is 4.
    twice: bool,
}

impl Smooth {
    /// [`Weighting::kernel`] of eight distances.
    #[inline(always)]
    fn kernels<S: Simd>(&self, s: S, d: f64x8<S>) -> f64x8<S> {
        let one = f64x8::splat(s, 1.0);
        let base = d.abs() / self.epsilon + one;
        let base = d.simd_lt(f64x8::splat(s, 0.0)).select(base, one / base);
        let square = base * base;
        if self.twice { square * square } else { square }
    }
}

impl Smooth {
    /// [`shares`] of eight boxes.
    #[inline(always)]
    fn shares<S: Simd>(&self, s: S, d: &[Interval8<S>], out: &mut [Interval8<S>]) {
        let mut left = Interval8::point(s, 0.0);
        for (o, d) in out.iter_mut().zip(d) {
            *o = left;
            left.lo += self.kernels(s, d.hi);
            left.hi += self.kernels(s, d.lo);
        }
        let (zero, one) = (f64x8::splat(s, 0.0), f64x8::splat(s, 1.0));
        let mut right = Interval8::point(s, 0.0);
        for (o, d) in out.iter_mut().zip(d).rev() {
            let (own_lo, own_hi) = (self.kernels(s, d.hi), self.kernels(s, d.lo));
            let lo = own_lo / (own_lo + (o.hi + right.hi));
            let hi = own_hi / (own_hi + (o.lo + right.lo));
            let lo = lo.is_nan().select(zero, lo) - SLACK;
            let hi = hi.is_nan().select(one, hi) + SLACK;
            *o = Interval8 { lo: lo.max(zero).min(one), hi: hi.max(zero).min(one) };
            right.lo += own_lo;
            right.hi += own_hi;
        }
    }
}

/// Eq. 5 before the division by the sum.
fn transfinite(d: &[f64], out: &mut [f64]) {
    let least = d.iter().copied().fold(f64::INFINITY, f64::min);
    for (w, &d) in out.iter_mut().zip(d) {
        *w = if least == f64::INFINITY {
            0.0
        } else if least < 0.0 {
            (-d).max(0.0)
        } else if least == 0.0 {
            // the limit of the products: what touches a surface takes everything
            f64::from(u8::from(d == 0.0))
        } else {
            least / d
        };
    }
}

/// Divides by the sum. Where that cannot be done (all kernels 0, or one infinite) those with the
/// largest kernel share equally.
fn normalise(out: &mut [f64]) {
    let sum: f64 = out.iter().sum();
    if sum > 0.0 && sum.is_finite() {
        out.iter_mut().for_each(|w| *w /= sum);
        return;
    }
    let most = out.iter().copied().fold(0.0, f64::max);
    let count = out.iter().filter(|w| **w == most).count().max(1);
    let share = 1.0 / count as f64;
    out.iter_mut().for_each(|w| *w = if *w == most { share } else { 0.0 });
}

/// Enclosures of the shares of kernels known as intervals.
fn shares(d: &[Interval], out: &mut [Interval], kernel: impl Fn(&Interval) -> Interval) {
    // the others' sum as left plus right: total minus own would cancel
    let mut left = Interval::point(0.0);
    for (o, d) in out.iter_mut().zip(d) {
        *o = left;
        left = left + kernel(d);
    }
    let mut right = Interval::point(0.0);
    for (o, d) in out.iter_mut().zip(d).rev() {
        let own = kernel(d);
        let others = *o + right;
        *o = Interval::new(share(own.lo, others.hi, 0.0), share(own.hi, others.lo, 1.0));
        *o = o.widen(SLACK).clamp(0.0, 1.0);
        right = right + own;
    }
}

fn share(own: f64, others: f64, unknown: f64) -> f64 {
    let s = own / (own + others);
    if s.is_nan() { unknown } else { s }
}

fn enclose_transfinite(d: &[Interval], out: &mut [Interval]) {
    let inside = d.iter().any(|d| d.hi < 0.0);
    let outside = d.iter().all(|d| d.lo > 0.0);
    if inside {
        shares(d, out, |d| Interval::new((-d.hi).max(0.0), (-d.lo).max(0.0)));
    } else {
        // Outside all features, or not known. A feature that is certainly left takes nothing inside
        // another and its inverse distance outside; one that may be touched takes anything.
        shares(d, out, |d| Interval::new(inverse(d.hi), inverse(d.lo)));
        if !outside {
            let alone = d.len() == 1;
            for (o, d) in out.iter_mut().zip(d) {
                let hi = if d.lo > 0.0 { o.hi } else { 1.0 };
                *o = Interval::new(if alone { 1.0 } else { 0.0 }, hi);
            }
        }
    }
}

fn inverse(d: f64) -> f64 {
    if d > 0.0 { 1.0 / d } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};
    use proptest::prelude::*;

    const ALL: [Weighting; 4] = [
        Weighting::Smooth { epsilon: 27.0, power: 2.0 },
        Weighting::Smooth { epsilon: 9.0, power: 4.0 },
        Weighting::Transfinite,
        Weighting::InverseSquare { epsilon: 9.0 },
    ];

    fn weights(w: Weighting, d: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; d.len()];
        w.weigh(d, &mut out);
        out
    }

    fn close(a: &[f64], b: &[f64]) {
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-15), "{a:?} {b:?}");
    }

    #[test]
    fn known_values() {
        // phi = 1/4 one epsilon outside, 4 one epsilon inside
        let w = Weighting::Smooth { epsilon: 10.0, power: 2.0 };
        close(&weights(w, &[10.0, -10.0]), &[0.25 / 4.25, 4.0 / 4.25]);
        close(&weights(Weighting::Transfinite, &[-3.0, -1.0, 5.0]), &[0.75, 0.25, 0.0]);
        // eq. 5 outside: the products of the others' distances, 12 : 6 : 4... of 2, 4, 6
        let s = 24.0 + 12.0 + 8.0;
        close(&weights(Weighting::Transfinite, &[2.0, 4.0, 6.0]), &[24.0 / s, 12.0 / s, 8.0 / s]);
        close(&weights(Weighting::Transfinite, &[0.0, 4.0, 0.0]), &[0.5, 0.0, 0.5]);
        close(&weights(Weighting::InverseSquare { epsilon: 1.0 }, &[-5.0, 1.0]), &[0.8, 0.2]);
    }

    #[test]
    fn extremes_stay_weights() {
        for w in ALL {
            for d in [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2], [1e300, -1e300], [0.0, 0.0]] {
                let got = weights(w, &d);
                assert!((got.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{w:?} {d:?} {got:?}");
            }
        }
    }

    #[test]
    fn the_smooth_form_is_c1_through_the_surface() {
        let w = Weighting::Smooth { epsilon: 10.0, power: 2.0 };
        let at = |d: f64| weights(w, &[d, 7.0])[0];
        let h = 1e-6;
        assert!(((at(h) - at(0.0)) - (at(0.0) - at(-h))).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn weights_share_one(d in prop::collection::vec(-200.0..500.0f64, 1..9)) {
            for w in ALL {
                let got = weights(w, &d);
                prop_assert!((got.iter().sum::<f64>() - 1.0).abs() < 1e-12);
                prop_assert!(got.iter().all(|w| (0.0..=1.0).contains(w)));
            }
        }

        /// What a point or box gives alone and among eight.
        #[test]
        fn eight_at_once_are_eight_alone(
            d in prop::collection::vec(prop::array::uniform8((-200.0..500.0f64, 0.0..30.0f64)), 1..9)
        ) {
            for w in ALL {
                let (values, ranges) = dispatch!(Level::new(), s => {
                    let at: Vec<_> =
                        d.iter().map(|d| f64x8::simd_from(s, d.map(|(d, _)| d))).collect();
                    let of = |sign: f64| move |(d, r): (f64, f64)| d + sign * r;
                    let over: Vec<_> = d
                        .iter()
                        .map(|d| Interval8 {
                            lo: f64x8::simd_from(s, d.map(of(-1.0))),
                            hi: f64x8::simd_from(s, d.map(of(1.0))),
                        })
                        .collect();
                    let (mut values, mut ranges) = (at.clone(), over.clone());
                    w.weigh_all(s, &at, &mut values);
                    w.enclose_all(s, &over, &mut ranges);
                    let values: Vec<[f64; LANES]> = values.into_iter().map(Into::into).collect();
                    (values, ranges.into_iter().map(Interval8::lanes).collect::<Vec<_>>())
                });
                for lane in 0..LANES {
                    let row: Vec<f64> = d.iter().map(|d| d[lane].0).collect();
                    let alone = weights(w, &row);
                    prop_assert!(values.iter().zip(&alone).all(|(v, a)| v[lane] == *a));
                    let row: Vec<_> =
                        d.iter().map(|d| Interval::ball(d[lane].0, d[lane].1)).collect();
                    let mut alone = vec![Interval::ALL; row.len()];
                    w.enclose(&row, &mut alone);
                    prop_assert!(ranges.iter().zip(&alone).all(|(r, a)| r[lane] == *a));
                }
            }
        }

        #[test]
        fn small_steps_change_little(d in prop::collection::vec(-200.0..500.0f64, 2..9), at in 0usize..9, h in -1e-3..1e-3f64) {
            let mut e = d.clone();
            let at = at % d.len();
            e[at] += h;
            // |grad w| <= (2 power / e) w (1 - w) <= power / (2 e)
            for (w, slope) in [(ALL[0], 1.0 / 27.0), (ALL[1], 2.0 / 9.0), (ALL[3], 1.0 / 9.0)] {
                for (a, b) in weights(w, &d).iter().zip(weights(w, &e)) {
                    prop_assert!((a - b).abs() <= slope * h.abs() * 1.001 + 1e-14);
                }
            }
        }

        #[test]
        fn enclosures_hold(d in prop::collection::vec((-60.0..60.0f64, 0.0..40.0f64), 1..7),
                           u in prop::collection::vec(0.0..=1.0f64, 7)) {
            let boxes: Vec<_> = d.iter().map(|&(lo, w)| Interval::new(lo, lo + w)).collect();
            let at: Vec<_> = d.iter().zip(&u).map(|(&(lo, w), u)| lo + w * u).collect();
            for w in ALL {
                let mut out = vec![Interval::ALL; d.len()];
                w.enclose(&boxes, &mut out);
                for (o, x) in out.iter().zip(weights(w, &at)) {
                    prop_assert!(o.contains(x), "{:?} {:?} {}", w, o, x);
                }
            }
        }

        #[test]
        fn points_are_enclosed_tightly(d in prop::collection::vec(-200.0..500.0f64, 1..9)) {
            let boxes: Vec<_> = d.iter().map(|&d| Interval::point(d)).collect();
            for w in [ALL[0], ALL[1], ALL[3]] {
                let mut out = vec![Interval::ALL; d.len()];
                w.enclose(&boxes, &mut out);
                prop_assert!(out.iter().all(|o| o.width() < 1e-11));
            }
        }
    }
}
