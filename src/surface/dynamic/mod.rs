//! Dynamic surfaces: a fourth-order equation of motion on a grid of nodes (You and Zhang 2007).
//!
//! Each component x of the surface obeys
//!
//! ```text
//! b xᵤᵤᵤᵤ + c xᵤᵤᵥᵥ + d xᵥᵥᵥᵥ + rho xₜₜ + eta xₜ = f(u, v, t)      on [0, 1]²      (eq. 1)
//! ```
//!
//! with its position and its derivative across the edge given on all four edges (eq. 2). Space is
//! cut into central differences with ghost nodes (eq. 3), time into implicit steps of one size,
//! so that the matrix is factored once.
//!
//! Both schemes are stable for every step as long as the operator is positive definite on the grid.
//! It always is when b, d > 0 and c > -2 √(b d); other parameters are tried on the grid and
//! refused when the operator has negative eigenvalues, for then the surface would run away.
//!
//! ```
//! use fieldgraft::surface::{Motion, dynamic::{Dynamic, Options}};
//! use glam::dvec2;
//! // A square plate, clamped, under the force 800 from t = 0 on: the paper's Figure 2a.
//! let plate = Dynamic::new(Options { grid: [21, 21], dt: 1e-3, steps: 100, ..Options::default() })?;
//! let middle = plate.at(0.3)?.point(0, dvec2(0.5, 0.5));
//! assert!((middle.z - 1.97).abs() < 0.05);
//! # Ok::<(), fieldgraft::surface::SurfaceError>(())
//! ```

mod boundary;
mod check;
mod grid;
mod motion;
mod solver;
mod step;
#[cfg(test)]
mod tests;

pub use boundary::{Boundary, Curves, Edges, TangentsOf, VARIABLES};
pub use grid::EDGE_NAMES;
pub use motion::Dynamic;
pub use step::State;

use crate::num::Expr;

/// Shape control parameters of one component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control {
    /// Of the fourth derivative by u.
    pub b: f64,
    /// Of the mixed derivative.
    pub c: f64,
    /// Of the fourth derivative by v.
    pub d: f64,
}

/// How time is stepped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scheme {
    /// The trapezoidal rule (Newmark's mean acceleration): second order in dt, adds no damping.
    #[default]
    Trapezoidal,
    /// The paper's eq. 6: first order; adds a damping of about dt times the stiffness of each
    /// mode, so that with a coarse step quick motions die out.
    Implicit,
}

/// The state at t = 0.
#[derive(Clone, Debug, Default)]
pub enum Start {
    /// The rest patch (with flat curves the flat square), at rest.
    #[default]
    Rest,
    /// In balance with the force and the boundary at t = 0, at rest.
    Steady,
    /// Positions, mm, and velocities of x, y, z in u and v; the edges stay on their curves.
    Given {
        /// Positions at t = 0.
        position: [Expr; 3],
        /// Velocities at t = 0.
        velocity: [Expr; 3],
    },
}

/// What makes a dynamic surface; the default is the paper's basic example (its Figure 2a).
#[derive(Clone, Debug)]
pub struct Options {
    /// Nodes along u and v.
    pub grid: [usize; 2],
    /// Time step.
    pub dt: f64,
    /// Number of steps; the motion's t = 1 is the time `steps * dt`.
    pub steps: usize,
    /// How time is stepped.
    pub scheme: Scheme,
    /// Density.
    pub rho: f64,
    /// Damping coefficient.
    pub eta: f64,
    /// Shape control parameters of x, y and z.
    pub control: [Control; 3],
    /// Force on x, y and z, in u, v and t.
    pub force: [Expr; 3],
    /// Curves and tangents at the edges.
    pub boundary: Boundary,
    /// The state at t = 0.
    pub start: Start,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            grid: [41, 41],
            dt: 5e-4,
            steps: 400,
            scheme: Scheme::default(),
            rho: 0.1,
            eta: 1.0,
            control: [Control { b: 1.0, c: 2.0, d: 1.0 }; 3],
            force: [0.0, 0.0, 800.0].map(|f| Expr::number(f, &VARIABLES)),
            boundary: Boundary::flat(),
            start: Start::default(),
        }
    }
}
