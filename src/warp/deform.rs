use std::f64::consts::PI;

/// Most twist that is accepted: ten turns, far beyond any furniture and still well conditioned.
const TWIST_LIMIT: f64 = 20.0 * PI;
/// Largest taper ratio that is accepted, either way.
const TAPER_LIMIT: f64 = 100.0;

/// Twist, taper and bend along z over a length of `2 * half_length` centred on z = 0
/// (Barr 1984; METHODS H). Applied in this order: taper, then twist, then bend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deform {
    /// Total twist from the low to the high end, radians; the middle does not turn.
    pub twist: f64,
    /// Size at the high end over size at the low end; 1 is none. The sides stay straight and the
    /// middle keeps its size.
    pub taper: f64,
    /// Total bend from the low to the high end, radians; the axis curves in the y-z plane, towards
    /// +y at both ends when positive. The middle stays put.
    pub bend: f64,
}

/// Why a deformation is refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum WarpError {
    /// More than ten turns, or not a number.
    #[error("twist is {0} rad; expected between {min} and {max}", min = -TWIST_LIMIT, max = TWIST_LIMIT)]
    Twist(f64),
    /// Not a usable ratio.
    #[error("taper is {0}; expected a ratio between {min} and {max}", min = 1.0 / TAPER_LIMIT, max = TAPER_LIMIT)]
    Taper(f64),
    /// A full circle or more would run into itself.
    #[error("bend is {0} rad; expected less than a full turn (2 pi) either way")]
    Bend(f64),
    /// The axis of the bend would lie inside the body.
    #[error("bend is {bend} rad; a body this thick bends at most {most} rad over its length")]
    Thick {
        /// What was asked for, radians.
        bend: f64,
        /// The largest bend of this body, radians.
        most: f64,
    },
}

impl Default for Deform {
    fn default() -> Self {
        Self::NONE
    }
}

impl Deform {
    /// Leaves everything where it is.
    pub const NONE: Self = Self { twist: 0.0, taper: 1.0, bend: 0.0 };

    /// Checked: twist within ten turns, taper positive, bend less than a full turn.
    pub fn new(twist: f64, taper: f64, bend: f64) -> Result<Self, WarpError> {
        if !twist.is_finite() || twist.abs() > TWIST_LIMIT {
            return Err(WarpError::Twist(twist));
        }
        if !(1.0 / TAPER_LIMIT..=TAPER_LIMIT).contains(&taper) {
            return Err(WarpError::Taper(taper));
        }
        if !bend.is_finite() || bend.abs() >= 2.0 * PI {
            return Err(WarpError::Bend(bend));
        }
        Ok(Self { twist, taper, bend })
    }

    /// Whether it moves nothing.
    pub fn is_none(&self) -> bool {
        self.twist == 0.0 && self.taper == 1.0 && self.bend == 0.0
    }
}
