use glam::DVec3;
use std::{fmt, str::FromStr};

/// Which axis of a file points up. Inside, Z does: a Y-up file is read as (x, -z, y).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Up {
    /// Y up, as in glTF and most OBJ files.
    Y,
    /// Z up, as in STL and here.
    Z,
}

/// How long one unit of a file is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Unit {
    /// Metres.
    M,
    /// Centimetres.
    Cm,
    /// Millimetres.
    Mm,
    /// Inches.
    In,
}

/// What the user says about a file; `None` leaves it to the format (glTF: Y up, metres; OBJ: Y up,
/// millimetres; all others: Z up, millimetres).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Assume {
    /// The axis that points up.
    pub up: Option<Up>,
    /// The length of one unit.
    pub unit: Option<Unit>,
}

/// A word that names no axis or unit.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown {what} `{got}`; expected {expected}")]
pub struct UnknownWord {
    what: &'static str,
    got: String,
    expected: &'static str,
}

impl Unit {
    /// Its length in mm.
    pub fn mm(self) -> f64 {
        match self {
            Unit::M => 1000.0,
            Unit::Cm => 10.0,
            Unit::Mm => 1.0,
            Unit::In => 25.4,
        }
    }
}

impl Up {
    /// A point of a file with this axis up, in our axes (Z up).
    pub(super) fn to_z(self, p: DVec3) -> DVec3 {
        match self {
            Up::Y => DVec3::new(p.x, -p.z, p.y),
            Up::Z => p,
        }
    }
}

impl fmt::Display for Up {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.pad(match self {
            Up::Y => "y",
            Up::Z => "z",
        })
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.pad(match self {
            Unit::M => "m",
            Unit::Cm => "cm",
            Unit::Mm => "mm",
            Unit::In => "in",
        })
    }
}

impl FromStr for Up {
    type Err = UnknownWord;

    fn from_str(s: &str) -> Result<Self, UnknownWord> {
        match s.to_ascii_lowercase().as_str() {
            "y" => Ok(Up::Y),
            "z" => Ok(Up::Z),
            _ => Err(UnknownWord { what: "up axis", got: s.into(), expected: "y or z" }),
        }
    }
}

impl FromStr for Unit {
    type Err = UnknownWord;

    fn from_str(s: &str) -> Result<Self, UnknownWord> {
        match s.to_ascii_lowercase().as_str() {
            "m" => Ok(Unit::M),
            "cm" => Ok(Unit::Cm),
            "mm" => Ok(Unit::Mm),
            "in" => Ok(Unit::In),
            _ => Err(UnknownWord { what: "unit", got: s.into(), expected: "m, cm, mm or in" }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_come_back() {
        for up in [Up::Y, Up::Z] {
            assert_eq!(up.to_string().parse(), Ok(up));
        }
        for unit in [Unit::M, Unit::Cm, Unit::Mm, Unit::In] {
            assert_eq!(unit.to_string().parse(), Ok(unit));
        }
        assert_eq!(
            "ft".parse::<Unit>().unwrap_err().to_string(),
            "unknown unit `ft`; expected m, cm, mm or in"
        );
        assert!("x".parse::<Up>().is_err());
    }

    #[test]
    fn y_up_stands_up() {
        assert_eq!(Up::Y.to_z(DVec3::new(1.0, 2.0, 3.0)), DVec3::new(1.0, -3.0, 2.0));
    }
}
