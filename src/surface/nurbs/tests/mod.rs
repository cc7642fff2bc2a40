//! Numbers known without the code, and identities that hold for every net.

mod basis;
mod data;
mod hostile;
mod knots;
mod morph;
mod solids;

use super::super::Surface;
use super::{Curve, RationalCurve, RationalSurface, Rows};
use glam::{DVec2, DVec3};

/// Numbers in [0, 1), the same every time (a linear congruence, upper bits).
pub(super) struct Dice(pub u64);

impl Dice {
    pub fn roll(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.roll() * n as f64) as usize
    }
}

/// Clamped knots on `[a, b]`: inner ones spread at random, some repeated.
pub(super) fn knots(dice: &mut Dice, degree: usize, points: usize, [a, b]: [f64; 2]) -> Vec<f64> {
    let inner = points - degree - 1;
    let mut values: Vec<f64> = vec![];
    while values.len() < inner {
        let t = a + (b - a) * (0.05 + 0.9 * dice.roll());
        let times = (1 + dice.below(degree.min(2))).min(inner - values.len());
        values.extend(std::iter::repeat_n(t, times));
    }
    values.sort_by(f64::total_cmp);
    let end = |t| std::iter::repeat_n(t, degree + 1);
    end(a).chain(values).chain(end(b)).collect()
}

pub(super) fn point(dice: &mut Dice) -> [f64; 4] {
    [dice.roll() - 0.5, dice.roll() - 0.5, dice.roll() - 0.5, 0.3 + 2.0 * dice.roll()]
}

pub(super) fn curve(dice: &mut Dice, degree: usize, n: usize, domain: [f64; 2]) -> RationalCurve {
    let knots = knots(dice, degree, n, domain);
    let points: Vec<_> = (0..n).map(|_| point(dice)).collect();
    RationalCurve::new(degree, knots, &points).unwrap()
}

pub(super) fn surface(dice: &mut Dice, degree: [usize; 2], n: [usize; 2]) -> RationalSurface {
    let u = knots(dice, degree[0], n[0], [0.0, 1.0]);
    let v = knots(dice, degree[1], n[1], [-1.0, 2.0]);
    let net: Vec<Vec<_>> = (0..n[1]).map(|_| (0..n[0]).map(|_| point(dice)).collect()).collect();
    RationalSurface::new(degree, u, v, &net).unwrap()
}

pub(super) fn rows(dice: &mut Dice, [width, height]: [usize; 2]) -> Rows {
    (0..height).map(|_| (0..width).map(|_| 0.2 + 0.6 * dice.roll()).collect()).collect()
}

/// Parameters all over a domain, its ends among them.
pub(super) fn spread([a, b]: [f64; 2], n: usize) -> impl Iterator<Item = f64> + Clone {
    (0..=n).map(move |i| a + (b - a) * (i as f64 / n as f64))
}

/// The largest distance of two surfaces at the same share of their domains.
pub(super) fn apart(a: &dyn Surface, b: &dyn Surface, n: usize) -> f64 {
    let (d, e) = (a.domain(0), b.domain(0));
    let mut worst = 0f64;
    for (u, w) in spread(d.u, n).zip(spread(e.u, n)) {
        for (v, x) in spread(d.v, n).zip(spread(e.v, n)) {
            worst = worst.max(a.point(0, [u, v].into()).distance(b.point(0, [w, x].into())));
        }
    }
    worst
}

pub(super) fn curves_apart(a: &dyn Curve, b: &dyn Curve, n: usize) -> f64 {
    let pairs = spread(a.domain(), n).zip(spread(b.domain(), n));
    pairs.map(|(u, w)| a.point(u).distance(b.point(w))).fold(0.0, f64::max)
}

/// The largest difference of the derivatives from central differences, relative to their size,
/// taken inside the domain; the step keeps both errors near 1e-7.
pub(super) fn slope_error(surface: &dyn Surface, patch: usize, n: usize) -> f64 {
    let d = surface.domain(patch);
    let inside = |[a, b]: [f64; 2], s: f64| a + (b - a) * (0.013 + 0.97 * s);
    let mut worst = 0f64;
    for i in 0..n {
        for j in 0..n {
            let [s, r] = [i, j].map(|k| k as f64 / n as f64);
            let uv = DVec2::new(inside(d.u, s), inside(d.v, r));
            let jet = surface.jet(patch, uv);
            for (axis, exact) in [(DVec2::X, jet.su), (DVec2::Y, jet.sv)] {
                let h = 1e-6;
                let [p, q] = [1.0, -1.0].map(|k| surface.point(patch, uv + axis * h * k));
                let rough: DVec3 = (p - q) / (2.0 * h);
                worst = worst.max(rough.distance(exact) / (1.0 + exact.length()));
            }
        }
    }
    worst
}
