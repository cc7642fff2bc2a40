//! Primitives of recipes, and the solids built of them.
//!
//! The same primitives stand in features (`on.<shape>`) and in the parts of a solid. Lengths are
//! millimetres, Z up; `rotate_deg` are Euler degrees applied about x, then y, then z.

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

/// What a part does to the solid built so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Op {
    /// Joins it.
    #[default]
    Add,
    /// Is taken away from it.
    Cut,
    /// Joins it with a fillet of `blend` mm.
    Blend,
}

/// A plane of symmetry through the origin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Mirror {
    /// x to -x.
    X,
    /// y to -y.
    Y,
    /// All four images, under x to -x and y to -y.
    Xy,
}

/// One part of a solid: exactly one primitive, and what is done with it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// What messages call it.
    #[serde(default, skip_serializing_if = "is_default")]
    pub name: String,
    /// A box.
    #[serde(rename = "box", default, skip_serializing_if = "Option::is_none")]
    pub box_shape: Option<BoxShape>,
    /// A flat-ended rod.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cylinder: Option<CylinderShape>,
    /// A ball-ended rod.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub capsule: Option<CapsuleShape>,
    /// A scaled ball.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ellipsoid: Option<EllipsoidShape>,
    /// A convex prism.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub prism: Option<PrismShape>,
    /// Turn of the high end against the low end, about the part's own axis, degrees.
    #[serde(default, skip_serializing_if = "is_default")]
    pub twist_deg: f64,
    /// Size at the high end (`to`) over size at the low end (`from`).
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub taper: f64,
    /// Bend of the part's own axis, degrees.
    #[serde(default, skip_serializing_if = "is_default")]
    pub bend_deg: f64,
    /// Also its mirror image: `x`, `y` or `xy`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mirror: Option<Mirror>,
    /// `add` (the default), `cut` or `blend`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub op: Op,
    /// Width of the fillet for `op = "blend"`, mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blend: Option<f64>,
}

/// A solid built of parts, in the order given.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Solid {
    /// `solid`; required in a file of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kind: Option<SolidKind>,
    /// What the solid is called.
    #[serde(default, skip_serializing_if = "is_default")]
    pub name: String,
    /// The parts.
    pub parts: Vec<Part>,
}

/// The only kind of file a solid stands in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum SolidKind {
    /// Primitives.
    Solid,
}

impl Solid {
    /// What is wrong beyond the grammar; `at` is the key of the solid, empty for a file's top.
    ///
    /// # Errors
    /// The first part that has no meaning, by its key.
    pub fn validate(&self, at: &str) -> Result<(), Problem> {
        let key = if at.is_empty() { "parts".to_owned() } else { format!("{at}.parts") };
        if self.parts.is_empty() {
            return Err(Problem::new(key, "a solid needs at least one part"));
        }
        if self.parts[0].op == Op::Cut {
            return Err(Problem::new(format!("{key}[0].op"), "the first part has nothing to cut"));
        }
        self.parts.iter().enumerate().try_for_each(|(i, p)| p.validate(&format!("{key}[{i}]")))
    }
}

impl Part {
    /// The one primitive; `at` is the key of this part.
    ///
    /// # Errors
    /// None or several primitives.
    pub fn primitive(&self, at: &str) -> Result<Primitive<'_>, Problem> {
        let all = [
            self.box_shape.as_ref().map(Primitive::Box),
            self.cylinder.as_ref().map(Primitive::Cylinder),
            self.capsule.as_ref().map(Primitive::Capsule),
            self.ellipsoid.as_ref().map(Primitive::Ellipsoid),
            self.prism.as_ref().map(Primitive::Prism),
        ];
        only(all, at)?.ok_or_else(|| Problem::new(at, NO_SHAPE))
    }

    fn validate(&self, at: &str) -> Result<(), Problem> {
        let primitive = self.primitive(at)?;
        primitive.validate(&format!("{at}.{}", primitive.key()))?;
        deform(self.twist_deg, self.taper, self.bend_deg, at)?;
        match (self.op, self.blend) {
            (Op::Blend, None) => {
                Err(Problem::new(at, "op = \"blend\" needs `blend`, the fillet's width in mm"))
            }
            (Op::Blend, Some(w)) => positive(w, &format!("{at}.blend")),
            (_, Some(_)) => Err(Problem::new(
                format!("{at}.blend"),
                "only op = \"blend\" has a fillet; add op = \"blend\" or remove it",
            )),
            (_, None) => Ok(()),
        }
    }
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

#[cfg(test)]
mod tests {
    use super::super::parse_solid;
    use std::path::Path;

    fn error(text: &str) -> String {
        parse_solid(text, Path::new("s.toml")).unwrap_err().to_string()
    }

    const SEAT: &str = "kind = \"solid\"\n[[parts]]\nname = \"seat\"\n";

    #[test]
    fn reads_every_primitive() {
        let text = format!(
            "{SEAT}box = {{ center = [0, 0, 440], size = [420, 400, 36], round = 8 }}
[[parts]]
cylinder = {{ from = [-170, -160, 0], to = [-160, -150, 430], radius = 18 }}
taper = 0.7
mirror = \"xy\"
op = \"blend\"
blend = 10
[[parts]]
capsule = {{ from = [0, 0, 0], to = [0, 0, 1], radius = 2 }}
[[parts]]
ellipsoid = {{ center = [0, 0, 0], size = [1, 2, 3] }}
op = \"cut\"
[[parts]]
prism = {{ polygon = [[0, 0], [0, 10], [10, 0]], center = [0, 0, 0], height = 5 }}
"
        );
        let solid = parse_solid(&text, Path::new("s.toml")).unwrap();
        assert_eq!(solid.parts.len(), 5);
        assert_eq!(solid.parts[1].taper, 0.7);
    }

    #[test]
    fn names_file_line_key_and_meaning() {
        let e = error(&format!("{SEAT}box = {{ centre = [0, 0, 440], size = [4, 4, 3] }}"));
        assert!(e.contains("s.toml:4") && e.contains("parts[0].box"), "{e}");
        assert!(e.contains("did you mean `center`?"), "{e}");
    }

    #[test]
    fn refuses_what_is_no_shape() {
        for (body, why) in [
            ("", "no shape"),
            ("box = { center = [0,0,0], size = [0,1,1] }", "more than 0"),
            ("box = { center = [0,0,nan], size = [1,1,1] }", "parts[0].box.center"),
            ("box = { center = [0,0,0], size = [1,1,1], round = 2 }", "0 to 0.5"),
            ("capsule = { from = [0,0,0], to = [0,0,0], radius = 2 }", "same point"),
            ("prism = { polygon = [[0,0],[1,0]], center = [0,0,0], height = 5 }", "2 corners"),
            (
                "prism = { polygon = [[0,0],[4,0],[1,1],[0,4]], center = [0,0,0], height = 5 }",
                "not convex",
            ),
            ("box = { center = [0,0,0], size = [1,1,1] }\nop = \"blend\"", "fillet"),
            ("box = { center = [0,0,0], size = [1,1,1] }\nop = \"cut\"", "nothing to cut"),
        ] {
            let e = error(&format!("{SEAT}{body}"));
            assert!(e.contains(why), "{body}: {e}");
        }
    }
}
