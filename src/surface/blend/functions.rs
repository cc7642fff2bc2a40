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

/// Condition number above which functions are no longer told apart well enough to say that a
/// derivative is a sum of them: powers of t up to 6 reach 2,000, powers of v^2 times exp(-v^2), which
/// only seem to close, far more.
const DISTINCT: f64 = 1e4;
/// Most functions added so that derivatives are sums of functions again.
const ADDED: usize = 24;

/// The functions of both ends, none a sum of the others, and those that their derivatives need.
pub fn functions(
    sides: &[Side; 2],
    v: [f64; 2],
    handles: &Handles,
) -> Result<Vec<Function>, SurfaceError> {
    let rows = sides.iter().flat_map(|s| [&s.position, &s.tangent]);
    let all: Vec<Expr> = rows.flatten().cloned().collect();
    let Sums { functions, terms } = sums(&all);
    if functions.len() > MOST {
        let n = functions.len();
        return Err(SurfaceError::new(
            "at-0, at-1",
            format!("{n} different functions, at most {MOST}"),
        ));
    }
    let mut list: Vec<Function> =
        functions.into_iter().map(|f| Function { f, ends: [DVec3::ZERO; 4] }).collect();
    for (i, row) in terms.iter().enumerate() {
        for &(j, x) in row {
            list[j].ends[i / 3][i % 3] += x;
        }
    }
    let list = independent(list, v)?;
    Ok(closed(&list, v, handles).unwrap_or(list))
}

/// The functions with those added, zero at both ends, that make all derivatives sums of functions:
/// `cos(t)*cos(v)` beside `sin(t)*cos(v)` where eta asks for it. The equation can then be solved, not
/// only its residual kept small. Nothing where a few functions do not suffice, as for `tan(v)`.
fn closed(list: &[Function], v: [f64; 2], handles: &Handles) -> Option<Vec<Function>> {
    let points = probes(v);
    let mut all = list.to_vec();
    loop {
        let basis = columns(&all, &points).ok()?;
        let mut parts = Vec::new();
        for f in &all {
            parts.extend(Operator::parts(&f.f, handles).ok()?);
        }
        let values: Result<Vec<_>, _> = parts.iter().map(|f| column(f, &points)).collect();
        let (left, condition) = project(&basis, &values.ok()?);
        if condition > DISTINCT {
            return None;
        }
        let open = parts.into_iter().zip(left).filter(|(_, (_, left))| *left > CLOSED);
        let missing: Vec<Expr> = open.map(|(part, _)| part).collect();
        if missing.is_empty() {
            return Some(all);
        }
        let new = sums(&missing).functions.into_iter();
        all.extend(new.map(|f| Function { f, ends: [DVec3::ZERO; 4] }));
        if all.len() > MOST + ADDED {
            return None;
        }
        all = independent(all, v).ok()?;
        if all.len() > list.len() + ADDED {
            return None;
        }
    }
}

/// Folds what is a sum of other functions into them, such as `sin(-v)` into `sin(v)`.
fn independent(list: Vec<Function>, v: [f64; 2]) -> Result<Vec<Function>, SurfaceError> {
    let points = probes(v);
    let (mut kept, mut basis): (Vec<Function>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
    for new in list {
        let column = column(&new.f, &points).map_err(|e| at_end(&e))?;
        if norm(&column) == 0.0 {
            continue;
        }
        let (factors, rest) = project(&basis, std::slice::from_ref(&column)).0.swap_remove(0);
        if rest > DEPENDENT {
            kept.push(new);
            basis.push(column);
            continue;
        }
        for (old, x) in kept.iter_mut().zip(factors) {
            for (to, from) in old.ends.iter_mut().zip(new.ends) {
                *to += from * x;
            }
        }
    }
    Ok(kept)
}

fn at_end(e: &ExprError) -> SurfaceError {
    SurfaceError::new("at-0, at-1", e.to_string())
}

/// `n` by `m` points over the v of the blend and t in [0, 1], ends included, v fastest.
pub fn samples(v: [f64; 2], n: usize, m: usize) -> Vec<[f64; 2]> {
    let even = |i: usize, n: usize| if n > 1 { i as f64 / (n - 1) as f64 } else { 0.5 };
    let at = |i: usize| v[0] + (v[1] - v[0]) * even(i, n);
    (0..m).flat_map(|j| (0..n).map(move |i| [at(i), even(j, m)])).collect()
}

/// Points at which functions are told apart.
pub fn probes(v: [f64; 2]) -> Vec<[f64; 2]> {
    samples(v, 37, 6)
}

fn columns(list: &[Function], points: &[[f64; 2]]) -> Result<Vec<Vec<f64>>, ExprError> {
    list.iter().map(|f| column(&f.f, points)).collect()
}

fn column(f: &Expr, points: &[[f64; 2]]) -> Result<Vec<f64>, ExprError> {
    points.iter().map(|p| f.eval(p)).collect()
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// For every x the sum of `basis` nearest to it, and what is left, as a part of x (0 of nothing); and
/// the condition number of the basis.
fn project(basis: &[Vec<f64>], xs: &[Vec<f64>]) -> (Vec<(Vec<f64>, f64)>, f64) {
    let rows = xs.first().map_or(0, Vec::len);
    let a = Dense::from_fn(rows, basis.len(), |i, j| basis[j][i]);
    let s = lsq::solve(a, Dense::from_fn(rows, xs.len(), |i, c| xs[c][i]));
    let mut all = Vec::new();
    for (c, x) in xs.iter().enumerate() {
        let mut left = x.clone();
        for (b, factor) in basis.iter().zip(s.x.col(c)) {
            left.iter_mut().zip(b).for_each(|(x, b)| *x -= b * factor);
        }
        all.push((s.x.col(c).to_vec(), norm(&left) / norm(x).max(f64::MIN_POSITIVE)));
    }
    (all, s.condition)
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
    pub fn new(f: &Expr, handles: &Handles) -> Result<Self, ExprError> {
        let [second, v4, tt, t] = Self::parts(f, handles)?;
        let rest = v4.plus(&tt).plus(&t);
        Ok(Self { rows: Program::new(&[f.clone(), second, rest]), beta: handles.beta })
    }

    /// gamma F_vv, lambda F_vvvv, rho F_tt, eta F_t; what has the factor zero is zero, even where the
    /// derivative does not exist.
    fn parts(f: &Expr, h: &Handles) -> Result<[Expr; 4], ExprError> {
        let part = |factor: f64, variable: usize, order: usize| {
            if factor == 0.0 {
                return Ok(f.scaled(0.0));
            }
            (0..order).try_fold(f.clone(), |f, _| f.derivative(variable)).map(|f| f.scaled(factor))
        };
        Ok([part(h.gamma, V, 2)?, part(h.lambda, V, 4)?, part(h.rho, T, 2)?, part(h.eta, T, 1)?])
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
    let points = probes(v);
    let basis = columns(list, &points)?;
    let mut parts = Vec::new();
    for operator in operators {
        let [_, second, rest] = operator.columns(&points)?;
        parts.extend([second, rest]);
    }
    let mut root: Vec<usize> = (0..list.len()).collect();
    let mut open = None;
    for (p, (factors, left)) in project(&basis, &parts).0.into_iter().enumerate() {
        let (j, size) = (p / 2, norm(&parts[p]));
        for (i, c) in factors.iter().enumerate() {
            if c.abs() * norm(&basis[i]) > CLOSED * size {
                join(&mut root, i, j);
            }
        }
        if left > CLOSED {
            join(&mut root, *open.get_or_insert(j), j);
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
