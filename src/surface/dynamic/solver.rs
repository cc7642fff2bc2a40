//! The matrix of a step, taken apart by symmetry and factored.

use super::Control;
use super::grid::Grid;
use crate::num::{Band, Ldl, Singular};
use std::f64::consts::FRAC_1_SQRT_2;

/// Operator plus shift on the unknowns, factored.
///
/// The operator does not change when the square is reflected in u or in v, so nets that are even
/// or odd in each of them never mix: four systems of a quarter of the unknowns and half the band,
/// together half the work of a solve and a quarter of the factoring.
#[derive(Debug)]
pub struct Solver {
    parts: Vec<(Half, Half, Ldl)>,
}

/// The nets along one axis that are even, or odd, about its middle: an orthonormal basis of
/// (eᵢ ± e₋ᵢ) / √2, with the middle itself if there is one and they are even.
#[derive(Clone, Copy, Debug)]
struct Half {
    /// Unknowns along the axis.
    full: usize,
    odd: bool,
}

impl Half {
    fn size(self) -> usize {
        if self.odd { self.full / 2 } else { self.full.div_ceil(2) }
    }

    /// The two places of basis vector `i` and its value there; the middle counts twice by half.
    fn images(self, i: usize) -> [(usize, f64); 2] {
        let mirror = self.full - 1 - i;
        let x = if mirror == i { 0.5 } else { FRAC_1_SQRT_2 };
        [(i, x), (mirror, if self.odd { -x } else { x })]
    }

    /// An entry, in this basis, of a matrix along the axis.
    fn entry(self, i: usize, k: usize, full: impl Fn(usize, usize) -> f64) -> f64 {
        let terms = self.images(i).into_iter().flat_map(|a| self.images(k).map(|b| (a, b)));
        terms.map(|((i, x), (k, y))| x * y * full(i, k)).sum()
    }

    /// Minus the second difference, times h².
    fn second(self, i: usize, k: usize) -> f64 {
        self.entry(i, k, |i, k| match i.abs_diff(k) {
            0 => 2.0,
            1 => -1.0,
            _ => 0.0,
        })
    }

    /// The fourth difference, times h⁴; a ghost is its mirror node plus data, which adds 1 to the
    /// 6 of nodes next to the boundary.
    fn fourth(self, i: usize, k: usize) -> f64 {
        let end = |i: usize| u8::from(i == 0) + u8::from(i + 1 == self.full);
        self.entry(i, k, |i, k| match i.abs_diff(k) {
            0 => 6.0 + f64::from(end(i)),
            1 => -4.0,
            2 => 1.0,
            _ => 0.0,
        })
    }
}

impl Solver {
    /// Factors operator plus `shift` times the identity.
    ///
    /// # Errors
    /// A zero eigenvalue.
    pub fn new(grid: &Grid, control: &Control, shift: f64) -> Result<Self, Singular> {
        let [b, c, d] = grid.coefficients(control);
        let (s4, f4) = if grid.order()[0] == 0 { (b, d) } else { (d, b) };
        let parts = halves(grid).map(|(slow, fast)| {
            let ldl = matrix(slow, fast, [s4, c, f4], shift).factor()?;
            Ok((slow, fast, ldl))
        });
        Ok(Self { parts: parts.into_iter().collect::<Result<_, _>>()? })
    }

    /// Numbers the factors of a grid store, `None` beyond what can be counted.
    pub fn entries(size: [usize; 2]) -> Option<usize> {
        let [u, v] = size.map(|n| n.saturating_sub(2));
        Band::entries(u.checked_mul(v)?, u.min(v))
    }

    /// Number of negative eigenvalues.
    pub fn negative(&self) -> usize {
        self.parts.iter().map(|(.., ldl)| ldl.negative()).sum()
    }

    /// Solves in place for several right sides, a number an unknown.
    pub fn solve(&self, sides: &mut [&mut [f64]]) {
        let mut solved: Vec<Vec<f64>> = sides.iter().map(|s| vec![0.0; s.len()]).collect();
        for (slow, fast, ldl) in &self.parts {
            let mut folded: Vec<Vec<f64>> = sides.iter().map(|s| fold(*slow, *fast, s)).collect();
            // A symmetric plate under a symmetric force has nothing odd, exactly.
            let mut some: Vec<&mut [f64]> = folded
                .iter_mut()
                .filter(|s| s.iter().any(|x| *x != 0.0))
                .map(Vec::as_mut_slice)
                .collect();
            if !some.is_empty() {
                ldl.solve(&mut some);
            }
            for (out, part) in solved.iter_mut().zip(&folded) {
                unfold(*slow, *fast, part, out);
            }
        }
        sides.iter_mut().zip(solved).for_each(|(side, x)| side.copy_from_slice(&x));
    }
}

/// Even and odd along the slow and the fast axis of the unknowns.
fn halves(grid: &Grid) -> [(Half, Half); 4] {
    let [slow, fast] = grid.order().map(|axis| grid.size[axis] - 2);
    [(false, false), (false, true), (true, false), (true, true)]
        .map(|(s, f)| (Half { full: slow, odd: s }, Half { full: fast, odd: f }))
}

fn matrix(slow: Half, fast: Half, [s4, c, f4]: [f64; 3], shift: f64) -> Band {
    let (rows, m) = (slow.size(), fast.size());
    let mut matrix = Band::zero(rows * m, 2 * m);
    let same = |a: usize, b: usize| f64::from(u8::from(a == b));
    for s in 0..rows {
        for t in s.saturating_sub(2)..=s {
            let (second, fourth) = (c * slow.second(s, t), s4 * slow.fourth(s, t));
            for f in 0..m {
                for g in f.saturating_sub(2)..=(f + 2).min(m - 1) {
                    let (row, column) = (s * m + f, t * m + g);
                    if column <= row {
                        let across = second * fast.second(f, g) + fourth * same(f, g);
                        let along = same(s, t) * (f4 * fast.fourth(f, g) + shift * same(f, g));
                        matrix.add(row, row - column, across + along);
                    }
                }
            }
        }
    }
    matrix
}

/// The four places of a basis net and its value there.
fn images(slow: Half, fast: Half, s: usize, f: usize) -> impl Iterator<Item = (usize, f64)> {
    let pairs = slow.images(s).into_iter().flat_map(move |a| fast.images(f).map(|b| (a, b)));
    pairs.map(move |((s, x), (f, y))| (s * fast.full + f, x * y))
}

/// The part of a net of unknowns with these symmetries, in the basis of halves.
fn fold(slow: Half, fast: Half, net: &[f64]) -> Vec<f64> {
    let places = (0..slow.size()).flat_map(|s| (0..fast.size()).map(move |f| (s, f)));
    places.map(|(s, f)| images(slow, fast, s, f).map(|(p, x)| x * net[p]).sum()).collect()
}

/// Adds a folded part to a net of unknowns.
fn unfold(slow: Half, fast: Half, part: &[f64], out: &mut [f64]) {
    let places = (0..slow.size()).flat_map(|s| (0..fast.size()).map(move |f| (s, f)));
    for ((s, f), y) in places.zip(part) {
        images(slow, fast, s, f).for_each(|(p, x)| out[p] += x * y);
    }
}
