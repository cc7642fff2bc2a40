//! The functions F_j(v, t) that the boundary data are sums of, and how the equation couples them.

use super::{Handles, Side};
use crate::num::expr::{Program, Sums, sums};
use crate::num::lsq::{self, Dense};
use crate::num::{Expr, ExprError};
use crate::surface::SurfaceError;
use glam::DVec3;

/// Variables of the functions, in this order.
pub const V: usize = 0;
pub const T: usize = 1;

/// One F_j with what it is multiplied by in the boundary data.
#[derive(Clone, Debug)]
pub struct Function {
    /// F(v, t).
    pub f: Expr,
    /// Position and tangent at u = 0, position and tangent at u = 1 (paper: b, b-bar, d, d-bar).
    pub ends: [DVec3; 4],
}

/// A function counts as a sum of others when it is so to this part of its size. Boundary data are
/// rewritten by such sums, so it must stay near round-off; functions nearer than this to each other
/// are caught as a near-singular system instead.
const DEPENDENT: f64 = 1e-13;
/// A derivative counts as a sum of functions when it is so to this part of its size; only the
/// grouping of the unknowns depends on it, not the data.
const CLOSED: f64 = 1e-9;
/// Most functions: far above any boundary written by hand.
const MOST: usize = 64;

/// The functions of both ends, none a sum of the others.
pub fn functions(sides: &[Side; 2], v: [f64; 2]) -> Result<Vec<Function>, SurfaceError> {
    let rows = sides.iter().flat_map(|s| [&s.position, &s.tangent]);
    let all: Vec<Expr> = rows.flatten().cloned().collect();
    let Sums { functions, terms } = sums(&all);
    if functions.len() > MOST {
        let n = functions.len();
        return Err(SurfaceError::new("at-0", format!("{n} different functions, at most {MOST}")));
    }
    let mut list: Vec<Function> =
        functions.into_iter().map(|f| Function { f, ends: [DVec3::ZERO; 4] }).collect();
    for (i, row) in terms.iter().enumerate() {
        for &(j, x) in row {
            list[j].ends[i / 3][i % 3] += x;
        }
    }
    independent(list, v)
}

/// Folds what is a sum of other functions into them, such as `sin(-v)` into `sin(v)`.
fn independent(list: Vec<Function>, v: [f64; 2]) -> Result<Vec<Function>, SurfaceError> {
    let points = samples(v, 61, 7);
    let mut kept: Vec<(Function, Vec<f64>)> = Vec::new();
    for new in list {
        let column = column(&new.f, &points).map_err(|e| at_end(&e))?;
        if norm(&column) == 0.0 {
            continue;
        }
        let known: Vec<&[f64]> = kept.iter().map(|k| k.1.as_slice()).collect();
        let (factors, rest) = project(&known, &column);
        if rest > DEPENDENT {
            kept.push((new, column));
            continue;
        }
        for ((old, _), x) in kept.iter_mut().zip(factors) {
            for (to, from) in old.ends.iter_mut().zip(new.ends) {
                *to += from * x;
            }
        }
    }
    Ok(kept.into_iter().map(|k| k.0).collect())
}

fn at_end(e: &ExprError) -> SurfaceError {
    SurfaceError::new("at-0", e.to_string())
}

/// `n` by `m` points over the v of the blend and t in [0, 1], ends included, v fastest.
pub fn samples(v: [f64; 2], n: usize, m: usize) -> Vec<[f64; 2]> {
    let even = |i: usize, n: usize| if n > 1 { i as f64 / (n - 1) as f64 } else { 0.5 };
    let at = |i: usize| v[0] + (v[1] - v[0]) * even(i, n);
    (0..m).flat_map(|j| (0..n).map(move |i| [at(i), even(j, m)])).collect()
}

fn column(f: &Expr, points: &[[f64; 2]]) -> Result<Vec<f64>, ExprError> {
    points.iter().map(|p| f.eval(p)).collect()
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The sum of `basis` nearest to `x`, and what is left, as a part of x.
fn project(basis: &[&[f64]], x: &[f64]) -> (Vec<f64>, f64) {
    let a = Dense::from_fn(x.len(), basis.len(), |i, j| basis[j][i]);
    let s = lsq::solve(a, Dense::from_fn(x.len(), 1, |i, _| x[i]));
    let left: Vec<f64> = (0..x.len())
        .map(|i| x[i] - basis.iter().zip(s.x.col(0)).map(|(b, c)| b[i] * c).sum::<f64>())
        .collect();
    (s.x.col(0).to_vec(), norm(&left) / norm(x).max(f64::MIN_POSITIVE))
}

/// What the equation makes of F_j: the factors of G_j'''', G_j'' and G_j.
#[derive(Clone, Debug)]
pub struct Operator {
    /// F, gamma F_vv, and lambda F_vvvv + rho F_tt + eta F_t.
    rows: Program,
    beta: f64,
}

impl Operator {
    /// For one function.
    pub fn new(f: &Expr, h: &Handles) -> Result<Self, ExprError> {
        let vv = f.derivative(V)?.derivative(V)?;
        let v4 = vv.derivative(V)?.derivative(V)?;
        let t = f.derivative(T)?;
        let tt = t.derivative(T)?;
        let still = [(h.lambda, v4), (h.rho, tt), (h.eta, t)];
        let scaled = |x: f64, e: Expr| (x != 0.0).then(|| e.scaled(x));
        let sum = |parts: Vec<Expr>| {
            parts.into_iter().reduce(|a, b| a.plus(&b)).unwrap_or_else(|| f.scaled(0.0))
        };
        let second = sum(scaled(h.gamma, vv).into_iter().collect());
        let rest = sum(still.into_iter().filter_map(|(x, e)| scaled(x, e)).collect());
        Ok(Self { rows: Program::new(&[f.clone(), second, rest]), beta: h.beta })
    }

    /// The three factors at every point.
    pub fn columns(&self, points: &[[f64; 2]]) -> Result<[Vec<f64>; 3], ExprError> {
        let mut columns = [const { Vec::new() }; 3];
        let mut row = [0.0; 3];
        for p in points {
            self.rows.eval(p, &mut row)?;
            row[0] *= self.beta;
            for (c, x) in columns.iter_mut().zip(row) {
                c.push(x);
            }
        }
        Ok(columns)
    }
}

/// Groups of functions that the equation couples: alone those whose derivatives are multiples of
/// themselves (the paper's case), together those that meet in each other's derivatives, and together
/// all whose derivatives are no sums of the functions.
pub fn groups(
    list: &[Function],
    operators: &[Operator],
    v: [f64; 2],
) -> Result<Vec<Vec<usize>>, ExprError> {
    let points = samples(v, 61, 7);
    let mut columns = Vec::new();
    for f in list {
        columns.push(column(&f.f, &points)?);
    }
    let basis: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    let mut root: Vec<usize> = (0..list.len()).collect();
    let mut open = None;
    for (j, operator) in operators.iter().enumerate() {
        let [_, second, rest] = operator.columns(&points)?;
        for x in [second, rest].iter().filter(|x| norm(x) > 0.0) {
            let (factors, left) = project(&basis, x);
            for (i, c) in factors.iter().enumerate() {
                if c.abs() * norm(&columns[i]) > CLOSED * norm(x) {
                    join(&mut root, i, j);
                }
            }
            if left > CLOSED {
                join(&mut root, *open.get_or_insert(j), j);
            }
        }
    }
    let mut groups: Vec<Vec<usize>> = vec![Vec::new(); list.len()];
    for (j, &r) in root.iter().enumerate() {
        groups[r].push(j);
    }
    groups.retain(|g| !g.is_empty());
    Ok(groups)
}

fn join(root: &mut [usize], i: usize, j: usize) {
    let (from, to) = (root[i].max(root[j]), root[i].min(root[j]));
    root.iter_mut().filter(|r| **r == from).for_each(|r| *r = to);
}
