//! Exact circles and surfaces of revolution.

use super::curve::RationalCurve;
use super::knots::Knots;
use super::net::Net;
use super::patch::RationalSurface;
use super::{SurfaceError, wrong};
use glam::DVec4;
use std::f64::consts::FRAC_1_SQRT_2;

/// The nine poles of the unit circle: the corners and sides of a square, four arcs of 90 degrees.
const CIRCLE: [[f64; 3]; 9] = {
    const S: f64 = FRAC_1_SQRT_2;
    [
        [1.0, 0.0, 1.0],
        [S, S, S],
        [0.0, 1.0, 1.0],
        [-S, S, S],
        [-1.0, 0.0, 1.0],
        [-S, -S, S],
        [0.0, -1.0, 1.0],
        [S, -S, S],
        [1.0, 0.0, 1.0],
    ]
};

fn arcs() -> Knots {
    Knots::of(2, &[(0.0, 3), (0.25, 2), (0.5, 2), (0.75, 2), (1.0, 3)])
}

/// The circle of a radius (mm) round the z axis at z = 0, from +x counter-clockwise.
///
/// # Errors
/// A radius that is not positive.
pub fn circle(radius: f64) -> Result<RationalCurve, SurfaceError> {
    if !(radius > 0.0 && radius <= 1e12) {
        return wrong("radius", format!("radius is {radius}; expected a positive number of mm"));
    }
    let pole = |[x, y, w]: [f64; 3]| DVec4::new(x * radius, y * radius, 0.0, w);
    Ok(RationalCurve::of(Net { along: [arcs(), Knots::none()], poles: CIRCLE.map(pole).to_vec() }))
}

/// A profile in the plane of x and z turned about the z axis: u along the profile, v round the axis
/// from 0 to 1. The normal su x sv points outwards where the profile goes down.
///
/// # Errors
/// A profile that leaves the plane y = 0 or the half plane x >= 0.
pub fn revolve(profile: &RationalCurve) -> Result<RationalSurface, SurfaceError> {
    if let Some(i) = profile.net.poles.iter().position(|p| p.y != 0.0 || p.x < 0.0) {
        let why = "the profile has to lie in the plane y = 0 with x not negative";
        return wrong(format!("net[0][{i}]"), why);
    }
    let turn = |[c, s, w]: [f64; 3]| {
        let pole = move |p: &DVec4| DVec4::new(p.x * c, p.x * s, p.z * w, p.w * w);
        profile.net.poles.iter().map(pole)
    };
    let poles = CIRCLE.into_iter().flat_map(turn).collect();
    Ok(RationalSurface::of(Net { along: [profile.knots().clone(), arcs()], poles }))
}
