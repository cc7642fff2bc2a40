//! Named shapes: analytic surfaces of one patch, and how to cut them into PDE patches; and the
//! dolphin, which is made of PDE patches from the start.

mod dolphin;
mod klein;
mod power;
mod shell;
mod super_ellipsoid;
mod super_toroid;
#[cfg(test)]
mod tests;

pub use dolphin::dolphin;
pub use klein::KleinBottle;
pub use shell::SeaShell;
pub use super_ellipsoid::SuperEllipsoid;
pub use super_toroid::SuperToroid;

use super::{
    Surface, SurfaceError,
    pde::{Boundary, Curve, NODES},
};
use glam::DVec2;

/// Most patches that [`cut`] makes.
pub const MOST_DIVISIONS: usize = 50;

/// Cuts the first patch of a surface, closed in v, into `divisions` PDE patches of equal steps in u,
/// with curves of `points` points at the default nodes.
///
/// Patches join where they are cut, but their tangents do not. A kink of the surface is met when it
/// lies at a joint: the Klein bottle has one at half its length, so an even number is better.
///
/// # Errors
/// A surface that does not close in v; no divisions or more than [`MOST_DIVISIONS`].
pub fn cut(
    surface: &dyn Surface,
    divisions: usize,
    points: usize,
) -> Result<Vec<Boundary>, SurfaceError> {
    let domain = surface.domain(0);
    if !domain.wraps[1] {
        return Err(SurfaceError::new("shape", "does not close in v; PDE patches do"));
    }
    if !(1..=MOST_DIVISIONS).contains(&divisions) {
        let why = format!("{divisions}; from 1 to {MOST_DIVISIONS}");
        return Err(SurfaceError::new("divisions", why));
    }
    let [u0, u1] = domain.u;
    let [v0, v1] = domain.v;
    let curve = |u: f64| {
        let v = |j: usize| v0 + (v1 - v0) * j as f64 / points as f64;
        Curve::Points((0..points).map(|j| surface.point(0, DVec2::new(u, v(j)))).collect())
    };
    // Joints are computed the same way from both sides, so that they agree to the last bit.
    let at = |patch: usize, k: usize| match k {
        3 => (patch + 1) as f64,
        _ => patch as f64 + NODES[k],
    };
    let boundary = |patch: usize| {
        let u = |k| u0 + (u1 - u0) * (at(patch, k) / divisions as f64);
        Boundary::new([0, 1, 2, 3].map(|k| curve(u(k))))
    };
    Ok((0..divisions).map(boundary).collect())
}

/// An error unless every number is finite and over zero.
fn positive(numbers: &[(&str, f64)]) -> Result<(), SurfaceError> {
    for (name, x) in numbers {
        if !(x.is_finite() && *x > 0.0) {
            return Err(SurfaceError::new(*name, format!("{x}; a finite number over 0")));
        }
    }
    Ok(())
}
