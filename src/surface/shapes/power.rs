//! Signed powers of sine and cosine, for the super-quadrics.

/// Where a derivative would be infinite (an exponent below 1 at a zero) the base counts as this.
const TINY: f64 = 1e-12;

/// sgn(x) |x|^n.
pub(super) fn signed(x: f64, n: f64) -> f64 {
    x.signum() * x.abs().powf(n)
}

/// |x|^(n-1) n, the derivative of the signed power by x.
fn slope(x: f64, n: f64) -> f64 {
    n * if n < 1.0 { x.abs().max(TINY) } else { x.abs() }.powf(n - 1.0)
}

/// The signed powers n of cosine and sine, and their derivatives by the angle.
pub(super) struct Waves {
    pub cos: f64,
    pub sin: f64,
    pub cos_slope: f64,
    pub sin_slope: f64,
}

impl Waves {
    pub fn new(angle: f64, n: f64) -> Self {
        let (s, c) = exact(angle);
        Self {
            cos: signed(c, n),
            sin: signed(s, n),
            cos_slope: -s * slope(c, n),
            sin_slope: c * slope(s, n),
        }
    }
}

/// Sine and cosine with what rounding leaves of their zeros removed: a power below 1 would make a
/// visible crack of 1e-16.
fn exact(angle: f64) -> (f64, f64) {
    let clean = |x: f64| if x.abs() < 1e-15 { 0.0 } else { x };
    let (s, c) = angle.sin_cos();
    (clean(s), clean(c))
}
