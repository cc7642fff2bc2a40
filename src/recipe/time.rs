//! Times: the function u(t) of a feature, and the list of t to make.

use crate::weight::Ease;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Visitor};
use serde::{Serialize, Serializer};
use std::borrow::Cow;
use std::fmt;
use std::str::FromStr;

/// A function of time: a number, `"t"`, `"t^n"`, `"t^(1/n)"` or a table `[[0, 0], [1, 1]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeFn(pub Ease);

impl FromStr for TimeFn {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let bad = || format!("got `{text}`; expected a number, t, t^n, t^(1/n) or a table");
        let dense: String = text.chars().filter(|c| !c.is_whitespace()).collect();
        let number = |s: &str| s.parse::<f64>().ok().filter(|x| x.is_finite());
        if dense == "t" {
            return Ok(Self(Ease::Power(1.0)));
        }
        let Some(power) = dense.strip_prefix("t^") else {
            let x = number(&dense).filter(|x| (0.0..=1.0).contains(x)).ok_or_else(bad)?;
            return Ok(Self(Ease::Number(x)));
        };
        let inner = power.strip_prefix('(').and_then(|p| p.strip_suffix(')')).unwrap_or(power);
        let power = match inner.split_once('/') {
            Some((a, b)) if inner != power => number(a).zip(number(b)).map(|(a, b)| a / b),
            Some(_) => None,
            None => number(inner),
        };
        let power = power.filter(|p| *p > 0.0 && *p <= 1e3).ok_or_else(bad)?;
        Ok(Self(Ease::Power(power)))
    }
}

impl TimeFn {
    fn table(rows: Vec<[f64; 2]>) -> Result<Self, String> {
        let inside = rows.iter().flatten().all(|x| (0.0..=1.0).contains(x));
        let rising = rows.windows(2).all(|w| w[0][0] < w[1][0]);
        if rows.len() < 2 || !inside || !rising {
            return Err("a table needs two or more [t, u] in [0, 1], t increasing".to_owned());
        }
        Ok(Self(Ease::Table(rows)))
    }
}

impl<'de> Deserialize<'de> for TimeFn {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(TimeFnVisitor)
    }
}

struct TimeFnVisitor;

impl<'de> Visitor<'de> for TimeFnVisitor {
    type Value = TimeFn;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number in [0, 1], \"t\", \"t^n\", \"t^(1/n)\" or a table of [t, u]")
    }
    fn visit_str<E: Error>(self, x: &str) -> Result<TimeFn, E> {
        x.parse().map_err(E::custom)
    }
    fn visit_i64<E: Error>(self, x: i64) -> Result<TimeFn, E> {
        self.visit_f64(x as f64)
    }
    fn visit_u64<E: Error>(self, x: u64) -> Result<TimeFn, E> {
        self.visit_f64(x as f64)
    }
    fn visit_f64<E: Error>(self, x: f64) -> Result<TimeFn, E> {
        if (0.0..=1.0).contains(&x) {
            Ok(TimeFn(Ease::Number(x)))
        } else {
            Err(E::custom(format!("got {x}; a time lies in [0, 1]")))
        }
    }
    fn visit_seq<S: SeqAccess<'de>>(self, mut x: S) -> Result<TimeFn, S::Error> {
        let mut rows = Vec::new();
        while let Some(row) = x.next_element()? {
            rows.push(row);
        }
        TimeFn::table(rows).map_err(S::Error::custom)
    }
}

impl Serialize for TimeFn {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        match &self.0 {
            Ease::Number(x) => s.serialize_f64(*x),
            Ease::Power(n) if *n == 1.0 => s.serialize_str("t"),
            Ease::Power(n) => s.serialize_str(&format!("t^{n}")),
            Ease::Table(rows) => rows.serialize(s),
        }
    }
}

impl JsonSchema for TimeFn {
    fn schema_name() -> Cow<'static, str> {
        "TimeFunction".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        schemars::json_schema!({
            "description": "A function of t: a number, \"t\", \"t^n\", \"t^(1/n)\" or a table of [t, u].",
            "anyOf": [
                { "type": "number", "minimum": 0, "maximum": 1 },
                { "type": "string", "pattern": "^t(\\^.+)?$" },
                { "type": "array", "minItems": 2, "items": {
                    "type": "array", "minItems": 2, "maxItems": 2, "items": { "type": "number" } } }
            ]
        })
    }
}

/// Morph times in the order to make them: a number, a list, or a range `"0:1:0.25"`.
#[derive(Clone, Debug, PartialEq)]
pub struct Times(pub Vec<f64>);

/// Most times in one list; a typo in a range's step must not fill the disk.
const MOST: usize = 10_001;

impl FromStr for Times {
    type Err = String;

    /// Numbers and ranges `from:to:step`, apart by commas.
    fn from_str(text: &str) -> Result<Self, String> {
        Self::checked(numbers(text)?)
    }
}

/// Numbers and ranges `from:to:step`, apart by commas; whether they can be times is not asked.
///
/// # Errors
/// What is neither a number nor a range, in words.
pub fn numbers(text: &str) -> Result<Vec<f64>, String> {
    let mut all = Vec::new();
    for part in text.split(',') {
        let fields: Vec<&str> = part.split(':').map(str::trim).collect();
        let numbers: Option<Vec<f64>> = fields.iter().map(|s| s.parse().ok()).collect();
        match numbers.as_deref() {
            Some(&[t]) => all.push(t),
            Some(&[from, to, step]) => range(from, to, step, &mut all)?,
            _ => return Err(format!("got `{part}`; expected a number or from:to:step")),
        }
    }
    Ok(all)
}

fn range(from: f64, to: f64, step: f64, out: &mut Vec<f64>) -> Result<(), String> {
    let steps = (to - from) / step;
    if !steps.is_finite() || steps < 0.0 || steps > MOST as f64 {
        return Err(format!("{from}:{to}:{step} is no range; write from:to:step as 0:1:0.25"));
    }
    // a billionth keeps 0.1 * 3 readable in file names and forgives the last step's round-off
    for i in 0..=(steps + 1e-9).floor() as usize {
        out.push(((from + step * i as f64) * 1e9).round() / 1e9);
    }
    Ok(())
}

impl Times {
    fn checked(all: Vec<f64>) -> Result<Self, String> {
        match all.iter().find(|t| !(0.0..=1.0).contains(*t)) {
            Some(t) => Err(format!("got {t}; t lies in [0, 1]")),
            None if all.is_empty() => Err("no times; give one or more in [0, 1]".to_owned()),
            None if all.len() > MOST => Err(format!("{} times; at most {MOST}", all.len())),
            None => Ok(Self(all)),
        }
    }
}

impl<'de> Deserialize<'de> for Times {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(TimesVisitor)
    }
}

struct TimesVisitor;

impl<'de> Visitor<'de> for TimesVisitor {
    type Value = Times;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a time in [0, 1], a list of them or a range such as \"0:1:0.25\"")
    }
    fn visit_str<E: Error>(self, x: &str) -> Result<Times, E> {
        x.parse().map_err(E::custom)
    }
    fn visit_i64<E: Error>(self, x: i64) -> Result<Times, E> {
        self.visit_f64(x as f64)
    }
    fn visit_u64<E: Error>(self, x: u64) -> Result<Times, E> {
        self.visit_f64(x as f64)
    }
    fn visit_f64<E: Error>(self, x: f64) -> Result<Times, E> {
        Times::checked(vec![x]).map_err(E::custom)
    }
    fn visit_seq<S: SeqAccess<'de>>(self, mut x: S) -> Result<Times, S::Error> {
        let mut all = Vec::new();
        while let Some(t) = x.next_element()? {
            all.push(t);
        }
        Times::checked(all).map_err(S::Error::custom)
    }
}

impl Serialize for Times {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        self.0.serialize(s)
    }
}

impl JsonSchema for Times {
    fn schema_name() -> Cow<'static, str> {
        "Times".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        schemars::json_schema!({
            "description": "Morph times: a number, a list, or a range \"from:to:step\".",
            "anyOf": [
                { "type": "number", "minimum": 0, "maximum": 1 },
                { "type": "string" },
                { "type": "array", "minItems": 1,
                  "items": { "type": "number", "minimum": 0, "maximum": 1 } }
            ]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{Ease, TimeFn, Times};

    #[test]
    fn functions_of_time() {
        let f = |s: &str| s.parse::<TimeFn>().map(|f| f.0);
        assert_eq!(f("t"), Ok(Ease::Power(1.0)));
        assert_eq!(f("t^2"), Ok(Ease::Power(2.0)));
        assert_eq!(f("t ^ (1/4)"), Ok(Ease::Power(0.25)));
        assert_eq!(f("0.3"), Ok(Ease::Number(0.3)));
        for bad in ["", "u", "t^", "t^-1", "t^0", "t^1/2", "t^(1/0)", "2", "nan", "t^inf"] {
            assert!(f(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn lists_of_times() {
        let f = |s: &str| s.parse::<Times>().map(|t| t.0);
        assert_eq!(f("0:1:0.25"), Ok(vec![0.0, 0.25, 0.5, 0.75, 1.0]));
        assert_eq!(f("0:0.3:0.1"), Ok(vec![0.0, 0.1, 0.2, 0.3]));
        assert_eq!(f("0.5, 1"), Ok(vec![0.5, 1.0]));
        assert_eq!(f("0:1:0.3").map(|t| t.len()), Ok(4));
        for bad in ["", "1.5", "0:1", "0:1:0", "1:0:0.1", "0:1:1e-9", "a", "nan"] {
            assert!(f(bad).is_err(), "{bad}");
        }
    }
}
