//! What is refused before any step is taken.

use super::boundary::VARIABLES;
use super::grid::Grid;
use super::solver::Solver;
use super::{Control, Curves, Options, Start};
use crate::num::Expr;
use crate::surface::SurfaceError;

/// Most numbers in the factors of a matrix: half a gigabyte, 408 nodes a side when square.
const MOST: usize = 1 << 26;

/// Refuses options that mean nothing or would not fit into memory.
pub fn options(o: &Options) -> Result<(), SurfaceError> {
    let [nu, nv] = o.grid;
    if nu.min(nv) < Grid::LEAST {
        let why = format!("{nu} x {nv} nodes, at least {} along each side", Grid::LEAST);
        return Err(SurfaceError::new("grid", why));
    }
    if Solver::entries(o.grid).is_none_or(|n| n > MOST) {
        let why = format!("{nu} x {nv} nodes need a factor of more than {MOST} numbers");
        return Err(SurfaceError::new("grid", why));
    }
    if !(o.dt > 0.0 && o.dt.is_finite()) {
        return Err(SurfaceError::new("dt", format!("{} is no time step, above 0", o.dt)));
    }
    if o.steps == 0 {
        return Err(SurfaceError::new("steps", "0 steps, at least 1"));
    }
    for (at, x) in [("rho", o.rho), ("eta", o.eta)] {
        if !(x >= 0.0 && x.is_finite()) {
            let why = format!("{x} makes every step grow, at least 0");
            return Err(SurfaceError::new(at, why));
        }
    }
    if o.rho == 0.0 && o.eta == 0.0 {
        return Err(SurfaceError::new("rho", "0, as is eta: nothing then depends on time"));
    }
    for (k, c) in o.control.iter().enumerate() {
        for (name, x) in [("b", c.b), ("c", c.c), ("d", c.d)] {
            if !x.is_finite() {
                let why = format!("{x}, a finite number wanted");
                return Err(SurfaceError::new(format!("{}.{name}", control_key(o, k)), why));
            }
        }
    }
    expressions(o)
}

/// The key of a component's control parameters: one triple for all has no index.
fn control_key(o: &Options, component: usize) -> String {
    if o.control == [o.control[0]; 3] {
        "control".to_owned()
    } else {
        format!("control[{component}]")
    }
}

/// Refuses expressions over other variables than u, v and t.
fn expressions(o: &Options) -> Result<(), SurfaceError> {
    let known = |at: &str, list: &[Expr; 3]| {
        let wrong = list.iter().position(|e| !e.variables().iter().eq(VARIABLES.iter()));
        wrong.map_or(Ok(()), |k| {
            let got = list[k].variables().join(", ");
            let why = format!("an expression in {got}, expected {}", VARIABLES.join(", "));
            Err(SurfaceError::new(format!("{at}[{k}]"), why))
        })
    };
    known("force", &o.force)?;
    let curves = match &o.boundary.curves {
        Curves::Flat => None,
        Curves::Given(edges) => Some(("curves", edges)),
    };
    for (key, edges) in curves.into_iter().chain([("tangents", &o.boundary.tangents)]) {
        for (name, edge) in super::EDGE_NAMES.iter().zip(edges.iter()) {
            known(&format!("boundary.{key}.{name}"), edge)?;
        }
    }
    if let Start::Given { position, velocity } = &o.start {
        known("start.position", position)?;
        known("start.velocity", velocity)?;
    }
    Ok(())
}

/// Refuses control parameters whose operator is not positive definite on the grid.
///
/// With b, d > 0 and c > -2 √(b d) it is on every grid: the operator is at least b T² ⊗ 1 +
/// c T ⊗ T + d 1 ⊗ T², with T > 0 the second difference. Otherwise the pivots of its LDLᵀ count.
pub fn definite(o: &Options, grid: &Grid) -> Result<(), SurfaceError> {
    for (k, control) in o.control.iter().enumerate() {
        let Control { b, c, d } = *control;
        let elliptic = b > 0.0 && d > 0.0 && c > -2.0 * (b * d).sqrt();
        if elliptic || o.control[..k].contains(control) {
            continue;
        }
        let found = match Solver::new(grid, control, 0.0).map(|s| s.negative()) {
            Ok(0) => continue,
            Ok(n) => format!("{n} negative eigenvalues"),
            Err(_) => "an eigenvalue of zero".to_owned(),
        };
        let (name, value) = if d <= 0.0 && d <= b {
            ("d", d)
        } else if b <= 0.0 {
            ("b", b)
        } else {
            ("c", c)
        };
        let [nu, nv] = grid.size;
        let why = format!(
            "{value} is ill-posed on this grid: the operator on {nu} x {nv} nodes has {found}, so \
             the surface would run away; b, d > 0 and c > -2 sqrt(b d) are sound on every grid"
        );
        return Err(SurfaceError::new(format!("{}.{name}", control_key(o, k)), why));
    }
    Ok(())
}
