//! Boundary curves and their Fourier sums.

use crate::surface::SurfaceError;
use glam::DVec3;
use std::f64::consts::TAU;

/// Most points or terms of one curve: the direct sums of the transform take the square of it.
pub const MOST_POINTS: usize = 4096;

/// Two curves this close, as a part of their size, are one.
const SAME: f64 = 1e-6;

/// A closed curve over v in [0, 2 pi).
#[derive(Clone, Debug, PartialEq)]
pub enum Curve {
    /// Points at v = 2 pi j / M, mm; the first is not repeated at the end. Between the points the
    /// curve is their trigonometric interpolant.
    Points(Vec<DVec3>),
    /// A Fourier sum: the mean, then the factors of cos(nv) and sin(nv) for n = 1, 2, ...
    Terms {
        /// Mean, mm.
        mean: DVec3,
        /// Factors of cos(nv) and sin(nv), from n = 1, mm.
        terms: Vec<[DVec3; 2]>,
    },
}

impl Curve {
    /// A curve through points at equal steps of v.
    pub fn points(points: &[[f64; 3]]) -> Self {
        Self::Points(points.iter().map(|&p| p.into()).collect())
    }

    /// A curve that is a single point: a pole.
    pub fn pole(at: DVec3) -> Self {
        Self::Terms { mean: at, terms: vec![] }
    }

    /// Its Fourier sum, all terms that the points determine.
    ///
    /// # Errors
    /// Too few points for `modes`, too many, a number that is not finite; `at` names the curve.
    pub(super) fn fourier(&self, modes: usize, at: &str) -> Result<Fourier, SurfaceError> {
        let wrong = |why| Err(SurfaceError::new(at, why));
        let (count, least) = match self {
            Self::Points(points) => (points.len(), modes.saturating_mul(2).saturating_add(1)),
            Self::Terms { terms, .. } => (terms.len(), 0),
        };
        if count < least {
            return wrong(format!("{count} points; {modes} modes need at least {least}"));
        }
        if count > MOST_POINTS {
            return wrong(format!("{count} points or terms; at most {MOST_POINTS}"));
        }
        if let Some(i) = self.numbers().position(|p| !p.is_finite()) {
            return wrong(format!("entry {i} is not finite"));
        }
        Ok(match self {
            Self::Points(points) => transform(points),
            Self::Terms { mean, terms } => {
                Fourier::trimmed(*mean, terms.clone(), f64::MIN_POSITIVE)
            }
        })
    }

    fn numbers(&self) -> Box<dyn Iterator<Item = DVec3> + '_> {
        match self {
            Self::Points(points) => Box::new(points.iter().copied()),
            Self::Terms { mean, terms } => {
                Box::new(std::iter::once(*mean).chain(terms.iter().flatten().copied()))
            }
        }
    }
}

/// A Fourier sum: mean and the factors of cos(nv), sin(nv) from n = 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Fourier {
    pub mean: DVec3,
    pub terms: Vec<[DVec3; 2]>,
}

impl Fourier {
    /// Without the factors below `least` in size (set to zero; dropped at the end).
    fn trimmed(mean: DVec3, mut terms: Vec<[DVec3; 2]>, least: f64) -> Self {
        for factor in terms.iter_mut().flatten() {
            *factor = factor.map(|x| if x.abs() < least { 0.0 } else { x });
        }
        while terms.last() == Some(&[DVec3::ZERO; 2]) {
            terms.pop();
        }
        Self { mean, terms }
    }

    /// Factors of cos(nv) and sin(nv), n from 1; zero past the last term.
    pub fn term(&self, n: usize) -> [DVec3; 2] {
        self.terms.get(n.wrapping_sub(1)).copied().unwrap_or_default()
    }

    /// The point at `v`.
    #[cfg(test)]
    pub fn point(&self, v: f64) -> DVec3 {
        self.terms.iter().zip(1u32..).fold(self.mean, |sum, ([cos, sin], n)| {
            let (s, c) = (f64::from(n) * v).sin_cos();
            sum + *cos * c + *sin * s
        })
    }

    /// Largest coordinate the curve could reach.
    pub fn reach(&self) -> f64 {
        let sum = self.terms.iter().flatten().fold(self.mean.abs(), |sum, f| sum + f.abs());
        sum.max_element()
    }

    /// Whether both sums give the same points.
    pub fn same(&self, other: &Self) -> bool {
        let far = SAME * self.reach().max(other.reach());
        let count = self.terms.len().max(other.terms.len());
        (self.mean - other.mean).abs().max_element() <= far
            && (1..=count).all(|n| {
                let (a, b) = (self.term(n), other.term(n));
                (0..2).all(|k| (a[k] - b[k]).abs().max_element() <= far)
            })
    }
}

/// The real discrete Fourier transform by direct sums. With an even number of points the last
/// cosine, which alternates from point to point, has half the usual factor and no sine.
fn transform(points: &[DVec3]) -> Fourier {
    let count = points.len();
    let roots: Vec<(f64, f64)> =
        (0..count).map(|j| (TAU * j as f64 / count as f64).sin_cos()).collect();
    let factor = |n: usize| {
        let mut sums = [DVec3::ZERO; 2];
        for (j, &p) in points.iter().enumerate() {
            let (s, c) = roots[n * j % count];
            sums[0] += p * c;
            sums[1] += p * s;
        }
        if 2 * n == count {
            [sums[0] / count as f64, DVec3::ZERO]
        } else {
            sums.map(|sum| sum * 2.0 / count as f64)
        }
    };
    let mean = points.iter().sum::<DVec3>() / count as f64;
    let largest = points.iter().fold(0.0, |most: f64, p| most.max(p.abs().max_element()));
    // What the sums round to when the true factor is zero; such terms would cost time and say nothing.
    let noise = 4.0 * f64::EPSILON * largest;
    Fourier::trimmed(mean, (1..=count / 2).map(factor).collect(), noise)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    fn wave(v: f64) -> DVec3 {
        dvec3(1.0 + 3.0 * v.cos(), -2.0 + (2.0 * v).sin(), 0.5 * (3.0 * v).cos() - v.sin())
    }

    #[test]
    fn finds_the_terms_of_a_sum() {
        for count in [8, 9, 64] {
            let points = (0..count).map(|j| wave(TAU * f64::from(j) / f64::from(count))).collect();
            let sum = Curve::Points(points).fourier(3, "curve").unwrap();
            assert_eq!(sum.terms.len(), 3, "{count} points");
            assert!((sum.mean - dvec3(1.0, -2.0, 0.0)).length() < 1e-14);
            assert!((sum.term(1)[0] - dvec3(3.0, 0.0, 0.0)).length() < 1e-14);
            assert!((sum.term(2)[1] - dvec3(0.0, 1.0, 0.0)).length() < 1e-14);
            for v in [0.1, 2.0, 5.5] {
                assert!((sum.point(v) - wave(v)).length() < 1e-13);
            }
        }
    }

    #[test]
    fn passes_through_points_of_any_shape() {
        for count in [6u32, 7] {
            let points: Vec<_> = (0..count)
                .map(|j| f64::from(j * j % 5))
                .map(|x| dvec3(x, x * x, 1.0 - x))
                .collect();
            let sum = Curve::Points(points.clone()).fourier(1, "curve").unwrap();
            for (j, p) in points.iter().enumerate() {
                let at = sum.point(TAU * j as f64 / f64::from(count));
                assert!((at - *p).length() < 1e-13);
            }
        }
    }
}
