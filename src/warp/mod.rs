//! Space maps: affine, twist, taper, bend, forward and inverse, with a bound on their stretch.

/// Twist, taper and bend along z over a length of `2 * half_length` centred on z = 0
/// (Barr 1984; METHODS H).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deform {
    /// Total twist from the low to the high end, radians.
    pub twist: f64,
    /// Size at the high end over size at the low end; 1 is none.
    pub taper: f64,
    /// Total bend from the low to the high end, radians; the axis curves in the y-z plane.
    pub bend: f64,
}
