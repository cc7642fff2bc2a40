//! Rational B-splines with masses, and their morphs (Ju and Goldman 2003).
//!
//! - The *weight* of a control point is its *mass*; a *pole* is the control point times its mass,
//!   with the mass as fourth coordinate. Sums of poles are sums of mass-points (the paper's
//!   Grassmann space).
//! - A *net* is the table of the control points: a row runs along u, and there is one row a step
//!   along v. A curve is a net of one row.
//! - *Compatible* nets have the same degrees and knots, so that their controls correspond.
//! - The *normalised distance* D of a point of a morph is 0 on the first target and 1 on the second.
//!
//! ```
//! use fieldgraft::surface::Surface;
//! use fieldgraft::surface::nurbs::{RationalCurve, revolve};
//! // A quarter circle in the plane of x and z, turned about z: the upper half of a unit ball.
//! let s = 0.5f64.sqrt();
//! let arc = [[1.0, 0.0, 0.0, 1.0], [1.0, 0.0, 1.0, s], [0.0, 0.0, 1.0, 1.0]];
//! let dome = revolve(&RationalCurve::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], &arc)?)?;
//! assert!((dome.point(0, [0.3, 0.7].into()).length() - 1.0).abs() < 1e-15);
//! # Ok::<(), fieldgraft::surface::SurfaceError>(())
//! ```

mod blended;
mod compatible;
mod curve;
mod extrude;
mod impact;
mod knots;
mod masses;
mod morph;
mod net;
mod patch;
mod poles;
mod shapes;
#[cfg(test)]
mod tests;
mod tube;

pub use compatible::{compatible_curves, compatible_surfaces};
pub use curve::{Curve, CurveJet, RationalCurve, polyline};
pub use extrude::extrude;
pub use impact::{Falloff, Impact};
pub use knots::{Knots, MAX_DEGREE, SAME_KNOT};
pub use masses::{Averaging, Design, MorphOptions, Rows};
pub use morph::{CurveMorph, NurbsMorph};
pub use patch::RationalSurface;
pub use shapes::{circle, revolve};
pub use tube::{Tube, TubeMotion, tube};

use super::SurfaceError;

/// Shorthand for a failure at a key.
fn wrong<T>(at: impl Into<String>, why: impl Into<String>) -> Result<T, SurfaceError> {
    Err(SurfaceError::new(at, why))
}
