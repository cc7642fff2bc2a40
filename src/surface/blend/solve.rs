//! The corrections: least squares over the collocation points.

use super::functions::{self, Function, Operator};
use super::profile::{Basis, cubics};
use super::surface::{Profile, Separated};
use super::{BlendSpec, Handles};
use crate::num::ExprError;
use crate::num::lsq::{self, Dense};
use crate::surface::SurfaceError;
use glam::DVec3;

/// Times in [0, 1] at which functions solved together are sampled; enough to tell apart powers of t
/// up to 6 and half waves.
const TIMES: usize = 7;
/// Most corrections a function may have. Bubbles of higher degree gain nothing in double precision.
const TERMS: usize = 40;
/// Most collocation points a direction.
const POINTS: usize = 400;
/// Most multiplications of one least-squares problem, some seconds.
const WORK: f64 = 4e9;
/// Condition number, as a multiple of that of S_uuuu alone at the same points, from which an equation
/// counts as singular. The multiple is about 1 for the paper's handles, 160 for powers of t up to 4,
/// and 90,000 for ten bubbles at a resonance.
const SINGULAR: f64 = 2e4;
/// Corrections this many times larger than the boundary data mean a resonance: an oscillation of
/// their own that the equation hardly damps. The paper's wildest handles (eta = -120) reach 200; handles
/// within a thousandth of a resonance reach 10,000, and a blend like that is no use to anyone.
const WILD: f64 = 1e4;

/// Numbers that no blend can be made of.
pub fn check(spec: &BlendSpec) -> Result<(), SurfaceError> {
    let Handles { beta, gamma, lambda, rho, eta } = spec.handles;
    let mut named =
        [beta, gamma, lambda, rho, eta].into_iter().zip(["beta", "gamma", "lambda", "rho", "eta"]);
    if let Some((x, name)) = named.find(|(x, _)| !x.is_finite()) {
        return Err(SurfaceError::new(name, format!("got {x}, expected a finite number")));
    }
    let [v0, v1] = spec.v;
    if !(v0.is_finite() && v1.is_finite() && v0 < v1) {
        return Err(SurfaceError::new("v", format!("got [{v0}, {v1}], expected a rising range")));
    }
    if spec.terms > TERMS {
        let why = format!("got {}, at most {TERMS} corrections", spec.terms);
        return Err(SurfaceError::new("terms", why));
    }
    if let Some(n) = spec.collocation.iter().find(|n| !(2..=POINTS).contains(n)) {
        return Err(SurfaceError::new("collocation", format!("got {n}, expected 2 to {POINTS}")));
    }
    let least = spec.basis.least_points(spec.terms);
    if spec.collocation[0] < least {
        let name = match spec.basis {
            Basis::Bubble => "bubble",
            Basis::Sine => "sine",
        };
        let (terms, got) = (spec.terms, spec.collocation[0]);
        let why = format!("{terms} {name} terms need at least {least} points over u, got {got}");
        return Err(SurfaceError::new("collocation", why));
    }
    Ok(())
}

/// Functions, cubics and corrections of a checked spec.
pub fn solve(spec: &BlendSpec) -> Result<Separated, SurfaceError> {
    let list = functions::functions(&spec.at, spec.v, &spec.handles)?;
    let mut weights: Vec<Vec<DVec3>> = list
        .iter()
        .map(|f| f.ends.into_iter().chain((0..spec.terms).map(|_| DVec3::ZERO)).collect())
        .collect();
    if spec.terms > 0 {
        let operators = operators(&list, &spec.handles)?;
        let groups = functions::groups(&list, &operators, spec.v).map_err(|e| needs(&e))?;
        for group in groups {
            let x = corrections(spec, &list, &operators, &group)?;
            for (i, &j) in group.iter().enumerate() {
                for k in 0..spec.terms {
                    let row = i * spec.terms + k;
                    weights[j][4 + k] = DVec3::new(x.at(row, 0), x.at(row, 1), x.at(row, 2));
                }
            }
        }
    }
    let profile = Profile::Series { basis: spec.basis, terms: spec.terms };
    Ok(Separated { functions: list, weights, profile })
}

/// The operators of all functions.
pub fn operators(list: &[Function], handles: &Handles) -> Result<Vec<Operator>, SurfaceError> {
    list.iter().map(|f| Operator::new(&f.f, handles).map_err(|e| needs(&e))).collect()
}

fn needs(e: &ExprError) -> SurfaceError {
    SurfaceError::new("at-0, at-1", format!("the equation needs derivatives by v and t: {e}"))
}

/// The corrections of a group, function by function, a column a component.
fn corrections(
    spec: &BlendSpec,
    list: &[Function],
    operators: &[Operator],
    group: &[usize],
) -> Result<Dense, SurfaceError> {
    let factors = factors(spec, operators, group).map_err(|e| needs(&e))?;
    let (count, unknowns) = (spec.collocation[0], group.len() * spec.terms);
    let rows = count * factors.len();
    if rows as f64 * (unknowns * unknowns) as f64 > WORK {
        let n = group.len();
        let why =
            format!("{unknowns} unknowns of {n} coupled functions at {rows} points are too many");
        return Err(SurfaceError::new("terms", why));
    }
    let (mut a, mut b) = (Dense::new(rows, unknowns), Dense::new(rows, 3));
    for l in 0..count {
        let u = l as f64 / (count - 1) as f64;
        for (r, factor) in factors.iter().enumerate() {
            let row = l * factors.len() + r;
            let residual = |i: usize, z: &[f64; 5]| {
                let [fourth, second, none] = factor[i];
                fourth * z[4] + second * z[2] + none * z[0]
            };
            for (i, &j) in group.iter().enumerate() {
                spec.basis.jets(u, spec.terms, |k, z| {
                    a.col_mut(i * spec.terms + k)[row] = residual(i, &z);
                });
                for (z, end) in cubics(u).iter().zip(list[j].ends) {
                    for c in 0..3 {
                        b.col_mut(c)[row] -= end[c] * residual(i, z);
                    }
                }
            }
        }
    }
    let s = lsq::solve(a, b);
    // without the fourth derivative the equation says too little; the least correction is then right
    let growth = growth(&s.x, group.iter().flat_map(|&j| list[j].ends));
    let loose = spec.handles.beta != 0.0 && s.condition > SINGULAR * plain(spec);
    if loose || growth > WILD {
        return Err(singular(spec, &list[group[0]], group.len(), [s.condition, growth]));
    }
    Ok(s.x)
}

/// The largest correction as a multiple of the largest boundary datum; infinite where one is no number.
fn growth(corrections: &Dense, ends: impl Iterator<Item = DVec3>) -> f64 {
    let data = ends.fold(0.0, |m: f64, e| m.max(e.abs().max_element()));
    let all = (0..3).flat_map(|c| corrections.col(c));
    let most =
        all.fold(0.0, |m: f64, x| if x.is_finite() { m.max(x.abs()) } else { f64::INFINITY });
    if most == 0.0 { 0.0 } else { most / data }
}

/// The condition number of S_uuuu alone.
fn plain(spec: &BlendSpec) -> f64 {
    let count = spec.collocation[0];
    let mut a = Dense::new(count, spec.terms);
    for l in 0..count {
        let u = l as f64 / (count - 1) as f64;
        spec.basis.jets(u, spec.terms, |k, z| a.col_mut(k)[l] = z[4]);
    }
    lsq::solve(a, Dense::new(count, 0)).condition
}

fn singular(
    spec: &BlendSpec,
    f: &Function,
    coupled: usize,
    [condition, growth]: [f64; 2],
) -> SurfaceError {
    let Handles { beta, gamma, lambda, rho, eta } = spec.handles;
    let others = if coupled > 1 { format!(" and {} more", coupled - 1) } else { String::new() };
    let why = format!(
        "the equation for `{}`{others} is nearly singular (condition number about {condition:.0e}, \
         corrections {growth:.0e} times the boundary data) with beta = {beta}, gamma = {gamma}, \
         lambda = {lambda}, rho = {rho}, eta = {eta}: these handles are at a resonance, or there are \
         too few collocation points to tell the functions apart",
        f.f
    );
    SurfaceError::new("beta", why)
}

/// For every independent combination of sample points the factors of G'''', G'' and G of every
/// function of the group.
///
/// The residual is linear in these factors, so their triangle says all that least squares needs to
/// know about v and t.
fn factors(
    spec: &BlendSpec,
    operators: &[Operator],
    group: &[usize],
) -> Result<Vec<Vec<[f64; 3]>>, ExprError> {
    let points = functions::samples(spec.v, spec.collocation[1], TIMES);
    let mut columns = Vec::new();
    for &j in group {
        columns.extend(operators[j].columns(&points)?);
    }
    let r = lsq::compress(Dense::from_fn(points.len(), columns.len(), |i, c| columns[c][i]));
    let row = |i: usize| -> Vec<[f64; 3]> {
        (0..group.len()).map(|j| [0, 1, 2].map(|c| r.at(i, 3 * j + c))).collect()
    };
    let rows: Vec<_> = (0..r.rows()).map(row).collect();
    let size = |row: &[[f64; 3]]| row.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
    let most = rows.iter().fold(0.0, |m: f64, row| m.max(size(row)));
    Ok(rows.into_iter().filter(|row| size(row) > 1e-15 * most).collect())
}
