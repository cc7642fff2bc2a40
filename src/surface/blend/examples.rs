//! The blends of paper 002.

use super::{Basis, BlendSpec, Handles, Side};
use crate::surface::SurfaceError;
use std::f64::consts::TAU;

fn spec(handles: Handles, terms: usize, at: [Side; 2]) -> BlendSpec {
    BlendSpec { handles, terms, basis: Basis::Bubble, collocation: [21, 21], v: [0.0, TAU], at }
}

/// Two elliptic cylinders that change with exp(t): the case with a closed form (eq. 19, with the
/// constants of section 4, unit 1).
///
/// # Errors
/// None that [`Side::new`] does not have.
pub fn cylinders() -> Result<BlendSpec, SurfaceError> {
    let handles = Handles { beta: 1.0, gamma: 12.1, lambda: 1.0, rho: 1.0, eta: 1.0 };
    let top = Side::new(["1.6*exp(t)*sin(v)", "exp(-t)*cos(v)", "2"], ["0", "0", "-3"])?;
    let bottom = Side::new(["0.8*exp(-t)*sin(v)", "0.6*exp(t)*cos(v)", "0"], ["0", "0", "-3"])?;
    Ok(BlendSpec { collocation: [11, 11], ..spec(handles, 7, [top, bottom]) })
}

/// Two surfaces that change linearly (eqs 29 and 30): the upper from an open strip to a closed ring,
/// the lower from a plane to a tube. The paper gives no constants; these make it about 130 mm tall.
///
/// # Errors
/// None that [`Side::cut`] does not have.
pub fn frustum() -> Result<BlendSpec, SurfaceError> {
    // a1 = 0.5, a2 = -pi/2, a3 = 3, a4 = 0.25, a5 = 1; b1..b8 = -20, 6, 30, -20, 30, 60, 45, 45;
    // h0, h1, h3, h4, h5 = 90, 110, 0, 10, 40
    let top = Side::cut(
        [
            "(1 - t)*(-20*sinh(0.5*v - pi/2) + 6*sin(3*v)) + 30*t*cos(-v)",
            "(1 - t)*(-20*cosh(0.25*v) + 6*cos(3*v)) + 30*t*sin(-v)",
            "(1 - t)*(90 + 30*(2 - u)) + 110*t",
        ],
        0.0,
        1.0,
    )?;
    let bottom = Side::cut(
        [
            "(1 - t)*60*u*sin(v) + 45*t*cos(-v)",
            "(1 - t)*60*u*cos(v) + 45*t*sin(-v)",
            "t*(10 - 40*(u - 0.8))",
        ],
        1.3,
        0.8,
    )?;
    // damping would hold the strip open between its closed ends, where it still moves at t = 1
    let handles = Handles { beta: 1.0, gamma: 2.0, lambda: 1.0, rho: 1.0, eta: 0.0 };
    Ok(spec(handles, 10, [top, bottom]))
}

/// Two surfaces that change with sin(pi t / 2) (eqs 31 and 32, with sin v in the y tangents): the
/// upper from a wrinkled tube to a cone, the lower from an elliptic cone to an inclined plane. The
/// paper gives no constants; these make it about 150 mm tall.
///
/// # Errors
/// None that [`Side::cut`] does not have.
pub fn cone() -> Result<BlendSpec, SurfaceError> {
    // r, r0, r1, k = 100, 50, 4, 8; h0, h1, h31, h32, h33 = 120, 80, 180, -60, 15
    let top = Side::cut(
        [
            "(1 - sin(pi*t/2))*(50*cos(v) + 4*cos(8*v)) + 100*u^2*sin(pi*t/2)*cos(v)",
            "(1 - sin(pi*t/2))*(50*sin(v) + 4*sin(8*v)) + 100*u^2*sin(pi*t/2)*sin(v)",
            "(1 - sin(pi*t/2))*(120 - 80*(u - 0.6)) + sin(pi*t/2)*(180 - 60*u + 15*cos(v))",
        ],
        0.2,
        0.6,
    )?;
    // a, b, alpha = 45, 30, 0.3; r3, h3, h4, h41, h42 = 75, 20, 60, -10, 75
    let bottom = Side::cut(
        [
            "(1 - sin(pi*t/2))*(2.3 - u)*45*cos(v) + 75*u*sin(pi*t/2)*cos(0.3)*cos(v)",
            "(1 - sin(pi*t/2))*(2.3 - u)*30*sin(v) + 75*u*sin(pi*t/2)*sin(v)",
            "(1 - sin(pi*t/2))*(20 - 60*(u - 0.3)) + sin(pi*t/2)*(-10 + 75*u*sin(0.3)*cos(v))",
        ],
        1.2,
        0.8,
    )?;
    let handles = Handles { beta: 1.0, gamma: 2.0, lambda: 0.01, rho: 1.0, eta: 0.1 };
    Ok(spec(handles, 12, [top, bottom]))
}
