//! Solids built of primitives.

use super::primitive::{
    BoxShape, CapsuleShape, CylinderShape, EllipsoidShape, NO_SHAPE, Primitive, PrismShape, deform,
    is_default, is_one, one, only, positive,
};
use super::source::Problem;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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
    /// Whether the part is written as a bare open sheet, its middle surface, when the solid is written
    /// as raw shells (`convert --shells`); boxes and prisms only. Says nothing of the solid itself.
    #[serde(default, skip_serializing_if = "is_default")]
    pub sheet: bool,
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
