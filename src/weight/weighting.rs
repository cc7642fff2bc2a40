use crate::num::Interval;

/// How feature distances become weights that sum to one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Weighting {
    /// C1 and positive: phi(d)^(power/2) with phi = (1 + depth/e)^2 inside, (1 + d/e)^-2 outside.
    Smooth {
        /// e, mm.
        epsilon: f64,
        /// 2 unless told otherwise; 4 is sharper.
        power: f64,
    },
    /// Paper 001, eq. 5, to the letter.
    Transfinite,
    /// Paper 001, eq. 4 (Lerios 1995): (d + e)^-2 of the distance outside.
    InverseSquare {
        /// e, mm.
        epsilon: f64,
    },
}

impl Weighting {
    /// Weights of the features at distances `d`; `out` is as long as `d` and sums to one.
    pub fn weigh(&self, d: &[f64], out: &mut [f64]) {
        let _ = (d, out);
        todo!()
    }

    /// Enclosures of the weights when each distance lies in its interval.
    pub fn enclose(&self, d: &[Interval], out: &mut [Interval]) {
        let _ = (d, out);
        todo!()
    }
}
