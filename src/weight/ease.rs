use std::str::FromStr;

/// A function of time u(t) from [0, 1] to [0, 1] (paper 001, section 3.1).
#[derive(Clone, Debug, PartialEq)]
pub enum Ease {
    /// The same value at every time.
    Number(f64),
    /// t^n; n = 1 is plain time, 1/n its opposite number.
    Power(f64),
    /// Piecewise linear through (t, u) pairs, t increasing.
    Table(Vec<[f64; 2]>),
}

/// Why a function of time is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EaseError {
    /// Not one of the known forms.
    #[error("`{0}` is no function of time; expected a number, `t`, `t^2` or `t^(1/2)`")]
    Form(String),
    /// A constant outside [0, 1].
    #[error("`{0}` is out of range; expected a number from 0 to 1")]
    Range(String),
    /// A power that is zero, negative or not finite.
    #[error("the power in `{0}` is not positive")]
    Power(String),
    /// Fewer than two pairs.
    #[error("a table needs at least two [t, u] pairs, got {0}")]
    Short(usize),
    /// Does not run from t = 0 to t = 1.
    #[error("a table runs from t = 0 to t = 1; this one from {0} to {1}")]
    Ends(f64, f64),
    /// t does not increase.
    #[error("t does not increase at pair {at} of the table: {before} then {after}")]
    Order {
        /// Position of the later pair, counted from 0.
        at: usize,
        /// t before.
        before: f64,
        /// t after.
        after: f64,
    },
    /// u outside [0, 1].
    #[error("u is {u} at pair {at} of the table; expected 0 to 1")]
    Value {
        /// Position of the pair, counted from 0.
        at: usize,
        /// What stands there.
        u: f64,
    },
}

impl Default for Ease {
    fn default() -> Self {
        Self::Power(1.0)
    }
}

impl Ease {
    /// Piecewise linear through (t, u) pairs that run from t = 0 to t = 1.
    pub fn table(pairs: Vec<[f64; 2]>) -> Result<Self, EaseError> {
        let (Some(first), Some(last), true) = (pairs.first(), pairs.last(), pairs.len() > 1) else {
            return Err(EaseError::Short(pairs.len()));
        };
        if first[0] != 0.0 || last[0] != 1.0 {
            return Err(EaseError::Ends(first[0], last[0]));
        }
        for (at, w) in pairs.windows(2).enumerate() {
            let increases = w[0][0] < w[1][0];
            if !increases {
                return Err(EaseError::Order { at: at + 1, before: w[0][0], after: w[1][0] });
            }
        }
        match pairs.iter().position(|p| !(0.0..=1.0).contains(&p[1])) {
            Some(at) => Err(EaseError::Value { at, u: pairs[at][1] }),
            None => Ok(Self::Table(pairs)),
        }
    }

    /// u(t), clamped to [0, 1].
    pub fn at(&self, t: f64) -> f64 {
        let t = t.clamp(0.0, 1.0);
        let u = match self {
            Self::Number(u) => *u,
            // plain time needs no rounding of powf
            Self::Power(n) => {
                if *n == 1.0 {
                    t
                } else {
                    t.powf(*n)
                }
            }
            Self::Table(pairs) => interpolate(pairs, t),
        };
        u.clamp(0.0, 1.0)
    }
}

fn interpolate(pairs: &[[f64; 2]], t: f64) -> f64 {
    let after = pairs.partition_point(|p| p[0] <= t);
    match (after.checked_sub(1).and_then(|i| pairs.get(i)), pairs.get(after)) {
        (Some([t0, u0]), Some([t1, u1])) => u0 + (u1 - u0) * ((t - t0) / (t1 - t0)),
        (Some([_, u]), None) | (None, Some([_, u])) => *u,
        (None, None) => t,
    }
}

impl FromStr for Ease {
    type Err = EaseError;

    /// Reads `t`, `t^2`, `t^0.5`, `t^(1/3)` or a number from 0 to 1.
    fn from_str(text: &str) -> Result<Self, EaseError> {
        let form = || EaseError::Form(text.to_owned());
        let bare: String = text.chars().filter(|c| !c.is_whitespace()).collect();
        if bare == "t" {
            return Ok(Self::Power(1.0));
        }
        if let Some(power) = bare.strip_prefix("t^") {
            let n = exponent(power).ok_or_else(form)?;
            let sound = n.is_finite() && n > 0.0;
            return if sound { Ok(Self::Power(n)) } else { Err(EaseError::Power(text.to_owned())) };
        }
        let u: f64 = bare.parse().map_err(|_| form())?;
        let sound = (0.0..=1.0).contains(&u);
        if sound { Ok(Self::Number(u)) } else { Err(EaseError::Range(text.to_owned())) }
    }
}

/// `2`, `0.5`, `(2)`, `(1/3)`.
fn exponent(text: &str) -> Option<f64> {
    let inner = match text.strip_prefix('(') {
        Some(rest) => rest.strip_suffix(')')?,
        None => text,
    };
    match inner.split_once('/') {
        Some((a, b)) => Some(a.parse::<f64>().ok()? / b.parse::<f64>().ok()?),
        None => inner.parse().ok(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forms_are_read() {
        for (text, half) in [
            ("t", 0.5),
            (" t ^ 2", 0.25),
            ("t^(1/2)", 0.5f64.sqrt()),
            ("0.4", 0.4),
            ("t^0.5", 0.5f64.sqrt()),
        ] {
            let ease: Ease = text.parse().unwrap();
            assert!((ease.at(0.5) - half).abs() < 1e-15, "{text}");
        }
    }

    #[test]
    fn nonsense_is_refused() {
        for text in ["", "x", "t^", "t^(1/2", "tt", "t*2", "nan"] {
            assert!(text.parse::<Ease>().is_err(), "{text}");
        }
        assert!(matches!("t^0".parse::<Ease>(), Err(EaseError::Power(_))));
        assert!(matches!("t^(1/0)".parse::<Ease>(), Err(EaseError::Power(_))));
        assert!(matches!("1.5".parse::<Ease>(), Err(EaseError::Range(_))));
        assert!(matches!(Ease::table(vec![[0.0, 0.0]]), Err(EaseError::Short(1))));
        assert!(matches!(Ease::table(vec![[0.1, 0.0], [1.0, 1.0]]), Err(EaseError::Ends(..))));
        let back = vec![[0.0, 0.0], [0.5, 0.5], [0.5, 0.7], [1.0, 1.0]];
        assert!(matches!(Ease::table(back), Err(EaseError::Order { at: 2, .. })));
        assert!(matches!(
            Ease::table(vec![[0.0, 0.0], [1.0, 2.0]]),
            Err(EaseError::Value { at: 1, .. })
        ));
    }

    #[test]
    fn powers_keep_the_ends_and_tables_their_pairs() {
        for n in [0.2, 1.0, 3.0, 7.5] {
            let ease = Ease::Power(n);
            assert_eq!(
                [ease.at(0.0), ease.at(1.0), ease.at(-1.0), ease.at(2.0)],
                [0.0, 1.0, 0.0, 1.0]
            );
        }
        let table = Ease::table(vec![[0.0, 0.0], [0.4, 0.9], [1.0, 1.0]]).unwrap();
        assert_eq!([table.at(0.0), table.at(0.4), table.at(1.0)], [0.0, 0.9, 1.0]);
        assert!((table.at(0.2) - 0.45).abs() < 1e-15);
    }
}
