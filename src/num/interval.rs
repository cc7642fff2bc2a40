use std::ops::{Add, Neg, Sub};

/// A closed range of reals `[lo, hi]`; the enclosure of a field's values over a box.
///
/// Arithmetic is plain `f64`: round-off is covered by [`Interval::widen`], which whoever
/// derives a bound from arithmetic of its own applies once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub lo: f64,
    /// Upper end, not below `lo`.
    pub hi: f64,
}

impl Interval {
    /// The whole line: the honest answer where no enclosure is known.
    pub const ALL: Self = Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY };

    /// `[lo, hi]`.
    pub const fn new(lo: f64, hi: f64) -> Self {
        Self { lo, hi }
    }

    /// `[x, x]`.
    pub const fn point(x: f64) -> Self {
        Self { lo: x, hi: x }
    }

    /// `[centre - radius, centre + radius]`.
    pub fn ball(centre: f64, radius: f64) -> Self {
        Self { lo: centre - radius, hi: centre + radius }
    }

    /// The smallest range that holds both.
    pub fn hull(self, o: Self) -> Self {
        Self { lo: self.lo.min(o.lo), hi: self.hi.max(o.hi) }
    }

    /// The common part of two enclosures of the same value; where round-off leaves none, their gap.
    pub fn meet(self, o: Self) -> Self {
        let (lo, hi) = (self.lo.max(o.lo), self.hi.min(o.hi));
        Self { lo: lo.min(hi), hi: hi.max(lo) }
    }

    /// Whether `x` lies in the range, ends included.
    pub fn contains(self, x: f64) -> bool {
        self.lo <= x && x <= self.hi
    }

    /// `hi - lo`.
    pub fn width(self) -> f64 {
        self.hi - self.lo
    }

    /// Values of `min(a, b)`.
    pub fn min(self, o: Self) -> Self {
        Self { lo: self.lo.min(o.lo), hi: self.hi.min(o.hi) }
    }

    /// Values of `max(a, b)`.
    pub fn max(self, o: Self) -> Self {
        Self { lo: self.lo.max(o.lo), hi: self.hi.max(o.hi) }
    }

    /// Values of `|a|`.
    pub fn abs(self) -> Self {
        if self.lo >= 0.0 {
            self
        } else if self.hi <= 0.0 {
            -self
        } else {
            Self { lo: 0.0, hi: self.hi.max(-self.lo) }
        }
    }

    /// Values of `s * a`.
    pub fn scale(self, s: f64) -> Self {
        // 0 * inf would be NaN; a factor of zero makes every finite value zero
        if s == 0.0 {
            return Self::point(0.0);
        }
        let (a, b) = (self.lo * s, self.hi * s);
        Self { lo: a.min(b), hi: a.max(b) }
    }

    /// Values of `a + d`.
    pub fn shift(self, d: f64) -> Self {
        Self { lo: self.lo + d, hi: self.hi + d }
    }

    /// Values of `clamp(a, lo, hi)`.
    pub fn clamp(self, lo: f64, hi: f64) -> Self {
        Self { lo: self.lo.clamp(lo, hi), hi: self.hi.clamp(lo, hi) }
    }

    /// Grown at both ends by `by`, to cover round-off.
    pub fn widen(self, by: f64) -> Self {
        Self { lo: self.lo - by, hi: self.hi + by }
    }
}

impl Add for Interval {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self { lo: self.lo + o.lo, hi: self.hi + o.hi }
    }
}

impl Sub for Interval {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Self { lo: self.lo - o.hi, hi: self.hi - o.lo }
    }
}

impl Neg for Interval {
    type Output = Self;
    fn neg(self) -> Self {
        Self { lo: -self.hi, hi: -self.lo }
    }
}

#[cfg(test)]
mod tests {
    use super::Interval;

    #[test]
    fn arithmetic_encloses() {
        let (a, b) = (Interval::new(-1.0, 2.0), Interval::new(0.5, 3.0));
        for i in 0..=10 {
            for j in 0..=10 {
                let x = a.lo + a.width() * f64::from(i) / 10.0;
                let y = b.lo + b.width() * f64::from(j) / 10.0;
                assert!((a + b).widen(1e-12).contains(x + y));
                assert!((a - b).widen(1e-12).contains(x - y));
                assert!(a.min(b).contains(x.min(y)) && a.max(b).contains(x.max(y)));
                assert!(a.abs().contains(x.abs()) && a.scale(-2.0).contains(-2.0 * x));
            }
        }
    }

    #[test]
    fn zero_times_everything_is_zero() {
        assert_eq!(Interval::ALL.scale(0.0), Interval::point(0.0));
    }
}
