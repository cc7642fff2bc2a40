//! Patches that close by themselves between two folds.

use super::{
    basis::Basis,
    curve::Curve,
    patch::{Boundary, NODES, Options},
};
use glam::DVec3;

impl Boundary {
    /// A patch that closes by itself, like a cushion, between a fold at u = 0 and one at u = 1: it
    /// leaves both level, so that no crease is seen there, and is as wide as `rim` half way.
    ///
    /// `first` and `last` are factors of cos(nv), n = 0, 1, ...: curves that run along a line and back.
    /// `rim` are factors of sin(nv), n = 1, 2, ...: how far the two ways along are apart half way from
    /// fold to fold. All in mm. The two inner curves follow, for the `a` and the modes of `options`.
    pub fn pillow(first: &[DVec3], last: &[DVec3], rim: &[DVec3], options: &Options) -> Self {
        let factor = |list: &[DVec3], n: usize| list.get(n).copied().unwrap_or_default();
        let inner = |n: usize| {
            let rate = options.a * n.min(options.modes.saturating_add(1)) as f64;
            Inner::of(rate).unwrap_or_default()
        };
        let shares = |n: usize, k: usize| {
            let Inner { near, far, .. } = inner(n);
            [[1.0, 0.0], [near, far], [far, near], [0.0, 1.0]][k]
        };
        let upright = |n: usize, k: usize| {
            let [a, b] = shares(n, k);
            factor(first, n) * a + factor(last, n) * b
        };
        let across = |n: usize, k: usize| match k {
            1 | 2 => factor(rim, n - 1) * inner(n).rim,
            _ => DVec3::ZERO,
        };
        let most = first.len().max(last.len()).max(rim.len() + 1);
        Self::new([0, 1, 2, 3].map(|k| Curve::Terms {
            mean: upright(0, k),
            terms: (1..most).map(|n| [upright(n, k), across(n, k)]).collect(),
        }))
    }
}

/// What one mode of an inner curve takes of the folds and of the rim.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Inner {
    /// Of the fold nearby, so that the patch leaves both folds level.
    near: f64,
    /// Of the other fold.
    far: f64,
    /// Of the rim, so that it is met half way.
    rim: f64,
}

impl Inner {
    /// For one rate; nothing if it overflows. The default nodes lie the same from both ends, so the
    /// sum of the folds and their difference can be solved for one by one.
    fn of(rate: f64) -> Option<Self> {
        if rate == 0.0 {
            // the spine is the cubic 1 - 3 u^2 + 2 u^3; it takes nothing of the rim
            return Some(Self { near: 20.0 / 27.0, far: 7.0 / 27.0, rim: 0.0 });
        }
        let basis = Basis { rate, nodes: NODES };
        let inverse = basis.inverse()?;
        // slope at u = 0, and value half way, for a unit at each of the four curves
        let cardinal = |f: [f64; 4]| -> [f64; 4] {
            std::array::from_fn(|k| (0..4).map(|i| f[i] * inverse[i][k]).sum())
        };
        let slope = cardinal(basis.derivative(0.0, 1));
        let half = cardinal(basis.derivative(0.5, 0));
        let even = -(slope[0] + slope[3]) / (slope[1] + slope[2]);
        let odd = -(slope[0] - slope[3]) / (slope[1] - slope[2]);
        let out = Self {
            near: (even + odd) / 2.0,
            far: (even - odd) / 2.0,
            rim: 1.0 / (half[1] + half[2]),
        };
        [out.near, out.far, out.rim].iter().all(|x| x.is_finite()).then_some(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{Surface, pde::PdeSurface};
    use glam::{DVec2, dvec3};
    use std::f64::consts::PI;

    #[test]
    fn leaves_its_folds_level_and_meets_its_rim() {
        let first = [dvec3(0.0, 1.0, 5.0), dvec3(0.0, 30.0, 0.5), DVec3::ZERO, DVec3::Z * 0.2];
        let last = [dvec3(0.0, 1.0, -4.0), DVec3::Y * 28.0];
        let rim = [DVec3::X * 8.0, DVec3::ZERO, DVec3::X, DVec3::ZERO, DVec3::ZERO, DVec3::X * 0.1];
        for a in [1.0, 1.7] {
            let options = Options { a, modes: 4, remainder: true };
            let patch = Boundary::pillow(&first, &last, &rim, &options);
            let surface = PdeSurface::new(&[patch], options).unwrap();
            for v in [0.1, 1.3, 2.9, PI] {
                let at = |u, v| surface.jet(0, DVec2::new(u, v));
                for u in [0.0, 1.0] {
                    assert!((at(u, v).s - at(u, -v).s).length() < 1e-12, "a fold");
                    let su = at(u, v).su;
                    assert!(su.y.abs().max(su.z.abs()) < 1e-11, "level: {su}");
                }
                let wide = rim.iter().zip(1u32..).map(|(r, n)| r.x * (f64::from(n) * v).sin());
                assert!((at(0.5, v).s.x - wide.sum::<f64>()).abs() < 1e-12);
            }
        }
    }
}
