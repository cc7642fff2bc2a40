//! Primitives: the shapes of features and of the parts of solids.
//!
//! Lengths are millimetres, Z up; `rotate_deg` are Euler degrees applied about x, then y, then z.

use super::source::Problem;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A box with its faces along the axes before it is turned.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxShape {
    /// Centre, mm.
    pub center: [f64; 3],
    /// Side lengths, mm.
    pub size: [f64; 3],
    /// Degrees about x, then y, then z.
    #[serde(default, skip_serializing_if = "is_default")]
    pub rotate_deg: [f64; 3],
    /// Radius of the rounded edges, mm; the size stays.
    #[serde(default, skip_serializing_if = "is_default")]
    pub round: f64,
}

/// A flat-ended rod.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CylinderShape {
    /// Centre of the lower end, mm.
    pub from: [f64; 3],
    /// Centre of the upper end, mm.
    pub to: [f64; 3],
    /// Radius, mm.
    pub radius: f64,
    /// Radius of the rounded rims, mm; the size stays.
    #[serde(default, skip_serializing_if = "is_default")]
    pub round: f64,
}

/// A rod with half balls added at both ends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CapsuleShape {
    /// Centre of the ball at the lower end, mm.
    pub from: [f64; 3],
    /// Centre of the ball at the upper end, mm.
    pub to: [f64; 3],
    /// Radius, mm.
    pub radius: f64,
}

/// A ball scaled along its axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EllipsoidShape {
    /// Centre, mm.
    pub center: [f64; 3],
    /// Diameters along the three axes, mm.
    pub size: [f64; 3],
    /// Degrees about x, then y, then z.
    #[serde(default, skip_serializing_if = "is_default")]
    pub rotate_deg: [f64; 3],
}

/// A convex polygon pushed along z.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PrismShape {
    /// Corners in x and y, relative to the centre, mm; convex, in either order.
    pub polygon: Vec<[f64; 2]>,
    /// Where the polygon's origin lies, at half the height, mm.
    pub center: [f64; 3],
    /// Height along z, mm.
    pub height: f64,
    /// Degrees about x, then y, then z.
    #[serde(default, skip_serializing_if = "is_default")]
    pub rotate_deg: [f64; 3],
    /// Radius of the rounded edges, mm; the size stays.
    #[serde(default, skip_serializing_if = "is_default")]
    pub round: f64,
}

/// One primitive, borrowed from the entry that holds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Primitive<'a> {
    /// `box`
    Box(&'a BoxShape),
    /// `cylinder`
    Cylinder(&'a CylinderShape),
    /// `capsule`
    Capsule(&'a CapsuleShape),
    /// `ellipsoid`
    Ellipsoid(&'a EllipsoidShape),
    /// `prism`
    Prism(&'a PrismShape),
}

/// What to say of an entry without a shape.
pub(super) const NO_SHAPE: &str =
    "no shape: give box, cylinder, capsule, ellipsoid, prism or, for features, mesh";

/// The only primitive given, if any.
pub(super) fn only<'a>(
    all: [Option<Primitive<'a>>; 5],
    at: &str,
) -> Result<Option<Primitive<'a>>, Problem> {
    let mut given = all.into_iter().flatten();
    match (given.next(), given.next()) {
        (Some(a), Some(b)) => {
            let why = format!("both `{}` and `{}`; give one shape", a.key(), b.key());
            Err(Problem::new(at, why))
        }
        (one, _) => Ok(one),
    }
}

impl Primitive<'_> {
    /// Radius of its rounded edges, mm.
    pub fn round(&self) -> f64 {
        match self {
            Primitive::Box(b) => b.round,
            Primitive::Cylinder(c) => c.round,
            Primitive::Prism(p) => p.round,
            Primitive::Capsule(_) | Primitive::Ellipsoid(_) => 0.0,
        }
    }

    /// The key it stands under.
    pub fn key(&self) -> &'static str {
        match self {
            Primitive::Box(_) => "box",
            Primitive::Cylinder(_) => "cylinder",
            Primitive::Capsule(_) => "capsule",
            Primitive::Ellipsoid(_) => "ellipsoid",
            Primitive::Prism(_) => "prism",
        }
    }

    /// Whether its numbers make a shape; `at` is its own key.
    ///
    /// # Errors
    /// The key of the first number that does not, and why.
    pub fn validate(&self, at: &str) -> Result<(), Problem> {
        match self {
            Primitive::Box(b) => {
                frame(&b.center, &b.rotate_deg, at)?;
                sizes(&b.size, at)?;
                let thin = b.size.iter().copied().fold(f64::INFINITY, f64::min);
                round(b.round, thin / 2.0, at)
            }
            Primitive::Cylinder(c) => {
                let length = rod(&c.from, &c.to, c.radius, at)?;
                round(c.round, c.radius.min(length / 2.0), at)
            }
            Primitive::Capsule(c) => rod(&c.from, &c.to, c.radius, at).map(drop),
            Primitive::Ellipsoid(e) => {
                frame(&e.center, &e.rotate_deg, at)?;
                sizes(&e.size, at)
            }
            Primitive::Prism(p) => {
                frame(&p.center, &p.rotate_deg, at)?;
                positive(p.height, &format!("{at}.height"))?;
                polygon(&p.polygon, &format!("{at}.polygon"))?;
                round(p.round, p.height / 2.0, at)
            }
        }
    }
}

/// Whether twist, taper and bend are usable.
pub(super) fn deform(twist: f64, taper: f64, bend: f64, at: &str) -> Result<(), Problem> {
    finite(&[twist], &format!("{at}.twist_deg"))?;
    finite(&[bend], &format!("{at}.bend_deg"))?;
    positive(taper, &format!("{at}.taper"))?;
    if bend.abs() >= 360.0 {
        let why = format!("got {bend}; a bend must stay below a full turn");
        return Err(Problem::new(format!("{at}.bend_deg"), why));
    }
    Ok(())
}

/// Whether all numbers are finite and of a size that arithmetic survives.
pub(super) fn finite(x: &[f64], at: &str) -> Result<(), Problem> {
    match x.iter().find(|v| !v.is_finite() || v.abs() > 1e9) {
        Some(v) => Err(Problem::new(at, format!("got {v}; expected a number of at most 1e9"))),
        None => Ok(()),
    }
}

/// Whether a length or ratio is above zero.
pub(super) fn positive(x: f64, at: &str) -> Result<(), Problem> {
    finite(&[x], at)?;
    if x > 0.0 { Ok(()) } else { Err(Problem::new(at, format!("got {x}; expected more than 0"))) }
}

fn frame(center: &[f64; 3], rotate: &[f64; 3], at: &str) -> Result<(), Problem> {
    finite(center, &format!("{at}.center"))?;
    finite(rotate, &format!("{at}.rotate_deg"))
}

fn sizes(size: &[f64; 3], at: &str) -> Result<(), Problem> {
    size.iter().try_for_each(|&s| positive(s, &format!("{at}.size")))
}

fn round(r: f64, most: f64, at: &str) -> Result<(), Problem> {
    finite(&[r], &format!("{at}.round"))?;
    if (0.0..=most).contains(&r) {
        Ok(())
    } else {
        let why = format!("got {r}; this shape can be rounded by 0 to {most}");
        Err(Problem::new(format!("{at}.round"), why))
    }
}

/// The length of a rod.
fn rod(from: &[f64; 3], to: &[f64; 3], radius: f64, at: &str) -> Result<f64, Problem> {
    finite(from, &format!("{at}.from"))?;
    finite(to, &format!("{at}.to"))?;
    positive(radius, &format!("{at}.radius"))?;
    let length = (0..3).map(|i| (to[i] - from[i]).powi(2)).sum::<f64>().sqrt();
    if length > 1e-6 {
        Ok(length)
    } else {
        Err(Problem::new(at, "`from` and `to` are the same point; a rod needs a length"))
    }
}

fn polygon(p: &[[f64; 2]], at: &str) -> Result<(), Problem> {
    if !(3..=64).contains(&p.len()) {
        return Err(Problem::new(at, format!("{} corners; expected 3 to 64", p.len())));
    }
    p.iter().try_for_each(|c| finite(c, at))?;
    let n = p.len();
    let turn = |i: usize| {
        let (a, b, c) = (p[i], p[(i + 1) % n], p[(i + 2) % n]);
        (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0])
    };
    let left = (0..n).filter(|&i| turn(i) > 0.0).count();
    let right = (0..n).filter(|&i| turn(i) < 0.0).count();
    // a star turns one way only too, but more than once round
    let round: f64 = (0..n)
        .map(|i| {
            let (a, b, c) = (p[i], p[(i + 1) % n], p[(i + 2) % n]);
            let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]);
            (u[0] * v[1] - u[1] * v[0]).atan2(u[0] * v[0] + u[1] * v[1])
        })
        .sum();
    if left + right < 3 || (left > 0 && right > 0) || round.abs() > 6.5 {
        return Err(Problem::new(at, "not convex; give its corners once round, none turned in"));
    }
    Ok(())
}

pub(super) fn is_default<T: Default + PartialEq>(x: &T) -> bool {
    *x == T::default()
}

pub(super) fn one() -> f64 {
    1.0
}

pub(super) fn is_one(x: &f64) -> bool {
    *x == 1.0
}
