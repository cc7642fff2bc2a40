//! Entries of `[shapes]`.

use super::primitive::{finite, is_default, positive};
use super::value::PlainOr;
use super::{Problem, Solid};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Where a shape comes from and how it stands: exactly one of `mesh`, `solid` and `surface`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShapeEntry {
    /// A mesh file: OBJ, STL, PLY, GLB or glTF; relative to the recipe.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<PathBuf>,
    /// A solid built of primitives: a file, or its parts here.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub solid: Option<PlainOr<PathBuf, Solid>>,
    /// A surface file (`kind = "pde"`, `"nurbs"` and so on), TOML or JSON; relative to the recipe.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface: Option<PathBuf>,
    /// Thickness of a surface that encloses nothing, mm: half of it on either side. Of a curve: the
    /// diameter of its tube, or the height of its extrusion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thickness: Option<f64>,
    /// How a surface becomes a solid: `auto`, `solid` or `shell`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub skin: SkinEntry,
    /// How a curve becomes a solid: `auto`, `extrude` or `tube`.
    #[serde(default, skip_serializing_if = "is_default")]
    pub curve: CurveEntry,
    /// How far the triangles of a surface may be from it, mm; by default a tenth of a cell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// Holds a surface that moves at this time, 0 to 1; without it the surface follows t.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<f64>,
    /// The file's upward axis, `y` or `z`; by default y for OBJ and glTF, else z.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub up: Option<UpAxis>,
    /// The file's unit of length; by default m for glTF, else mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<LengthUnit>,
    /// Scale to this height, mm, the thickness included; of a surface that moves, to this height of the
    /// box that holds it at all times.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<f64>,
    /// Thickness given to sheets that have none, mm; or `{ mm = 6, which = "all" }`, or `"thin"` for
    /// whatever is thinner.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thicken: Option<PlainOr<f64, ThickenEntry>>,
    /// How inside and outside are told apart.
    #[serde(default, skip_serializing_if = "is_default")]
    pub sign: SignEntry,
    /// `keep`, `floor` (centred over the origin, lowest point at z = 0) or `{ like = "other" }`
    /// (its box's centre and floor where those of another shape are). A surface that moves is placed
    /// once, by the box that holds it at t = 0, 1/8, ... 1, whatever times are asked for.
    #[serde(default = "keep", skip_serializing_if = "is_keep")]
    pub place: PlainOr<Place, PlaceLike>,
    /// Turn about z, degrees, before placing.
    #[serde(default, skip_serializing_if = "is_default")]
    pub turn_deg: f64,
    /// Shift after placing, mm.
    #[serde(rename = "move", default, skip_serializing_if = "is_default")]
    pub shift: [f64; 3],
}

/// The axis that points up in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum UpAxis {
    /// y
    Y,
    /// z
    Z,
}

/// How long a file's unit is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum LengthUnit {
    /// Metres.
    M,
    /// Centimetres.
    Cm,
    /// Millimetres.
    Mm,
    /// Inches.
    In,
}

/// Thickness for sheets, and which shells get it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ThickenEntry {
    /// Thickness, mm.
    pub mm: f64,
    /// Which shells.
    #[serde(default)]
    pub which: ThickenWhich,
}

/// Which shells of a mesh are given a thickness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ThickenWhich {
    /// Every shell with an open rim.
    #[default]
    Open,
    /// Every shell.
    All,
    /// No shell as such, but whatever is thinner: faces that enclose nothing, and thin walls and members
    /// of solids.
    Thin,
}

/// How inside and outside are told apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum SignEntry {
    /// By the winding number of each shell.
    #[default]
    Winding,
    /// Not at all: every face is a sheet; needs `thicken`.
    Unsigned,
}

/// How a surface becomes a solid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum SkinEntry {
    /// Pieces that are closed and two-sided are solid, the others shells of the thickness.
    #[default]
    Auto,
    /// What the surface encloses; open rims get lids.
    Solid,
    /// A shell of the thickness, even where the surface is closed.
    Shell,
}

/// How a curve becomes a solid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum CurveEntry {
    /// Closed and planar: extruded; else a tube.
    #[default]
    Auto,
    /// What a closed planar curve encloses, as high as the thickness.
    Extrude,
    /// A tube with the thickness as its diameter.
    Tube,
}

/// Another shape to stand like.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaceLike {
    /// Its name; it must not itself stand like another.
    pub like: String,
}

fn keep() -> PlainOr<Place, PlaceLike> {
    PlainOr::Plain(Place::Keep)
}

fn is_keep(place: &PlainOr<Place, PlaceLike>) -> bool {
    *place == keep()
}

/// Where a shape is put.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Place {
    /// Where its file has it.
    #[default]
    Keep,
    /// Centred over the origin, lowest point at z = 0.
    Floor,
}

impl ThickenEntry {
    /// The thickness and the shells it is for, from either way of writing it.
    pub fn of(entry: &PlainOr<f64, ThickenEntry>) -> Self {
        match entry {
            PlainOr::Plain(mm) => Self { mm: *mm, which: ThickenWhich::Open },
            PlainOr::Table(t) => *t,
        }
    }
}

impl Default for ShapeEntry {
    fn default() -> Self {
        Self {
            mesh: None,
            solid: None,
            surface: None,
            thickness: None,
            skin: SkinEntry::Auto,
            curve: CurveEntry::Auto,
            tolerance: None,
            at: None,
            up: None,
            unit: None,
            height: None,
            thicken: None,
            sign: SignEntry::Winding,
            place: keep(),
            turn_deg: 0.0,
            shift: [0.0; 3],
        }
    }
}

impl ShapeEntry {
    /// What is wrong beyond the grammar; `at` is the key of this shape.
    pub(super) fn validate(&self, at: &str) -> Result<(), Problem> {
        match (&self.mesh, &self.solid, &self.surface) {
            (None, None, None) => {
                return Err(Problem::new(at, "no source: give `mesh`, `solid` or `surface`"));
            }
            (Some(_), None, None) => self.no_surface(at, "mesh")?,
            (None, Some(solid), None) => {
                self.no_surface(at, "solid")?;
                self.validate_solid(solid, at)?;
            }
            (None, None, Some(_)) => self.validate_surface(at)?,
            (mesh, solid, _) => {
                let [a, b] = match (mesh, solid) {
                    (Some(_), Some(_)) => ["mesh", "solid"],
                    (Some(_), None) => ["mesh", "surface"],
                    _ => ["solid", "surface"],
                };
                return Err(Problem::new(at, format!("both `{a}` and `{b}`; give one of them")));
            }
        }
        if let Some(h) = self.height {
            positive(h, &format!("{at}.height"))?;
        }
        if let Some(t) = &self.thicken {
            positive(ThickenEntry::of(t).mm, &format!("{at}.thicken"))?;
        } else if self.sign == SignEntry::Unsigned {
            let why = "unsigned sheets have no inside; add `thicken`, in mm";
            return Err(Problem::new(format!("{at}.sign"), why));
        }
        finite(&[self.turn_deg], &format!("{at}.turn_deg"))?;
        finite(&self.shift, &format!("{at}.move"))
    }

    /// Refuses the keys that only surfaces have.
    fn no_surface(&self, at: &str, is: &str) -> Result<(), Problem> {
        let strange = [
            ("thickness", self.thickness.is_some()),
            ("skin", self.skin != SkinEntry::Auto),
            ("curve", self.curve != CurveEntry::Auto),
            ("tolerance", self.tolerance.is_some()),
            ("at", self.at.is_some()),
        ];
        let Some((key, _)) = strange.iter().find(|(_, given)| *given) else {
            return Ok(());
        };
        let hint = if *key == "thickness" && is == "mesh" { "; meshes have `thicken`" } else { "" };
        let why = format!("`{key}` is for surfaces, and this is a {is}{hint}");
        Err(Problem::new(format!("{at}.{key}"), why))
    }

    fn validate_surface(&self, at: &str) -> Result<(), Problem> {
        let strange = [
            ("thicken", self.thicken.is_some(), "thickness"),
            ("sign", self.sign != SignEntry::Winding, "skin"),
        ];
        if let Some((key, _, own)) = strange.iter().find(|(_, given, _)| *given) {
            let why = format!("is for meshes; a surface has `{own}`");
            return Err(Problem::new(format!("{at}.{key}"), why));
        }
        let lengths = [("thickness", self.thickness), ("tolerance", self.tolerance)];
        for (key, mm) in lengths {
            mm.map_or(Ok(()), |mm| positive(mm, &format!("{at}.{key}")))?;
        }
        if self.skin == SkinEntry::Shell && self.thickness.is_none() {
            let why = "a shell has a thickness; add `thickness`, in mm";
            return Err(Problem::new(format!("{at}.skin"), why));
        }
        match self.at {
            Some(t) if !(0.0..=1.0).contains(&t) => {
                Err(Problem::new(format!("{at}.at"), format!("got {t}; expected 0 to 1")))
            }
            _ => Ok(()),
        }
    }

    fn validate_solid(&self, solid: &PlainOr<PathBuf, Solid>, at: &str) -> Result<(), Problem> {
        let strange = [
            ("up", self.up.is_some()),
            ("unit", self.unit.is_some()),
            ("thicken", self.thicken.is_some()),
            ("sign", self.sign != SignEntry::Winding),
        ];
        if let Some((key, _)) = strange.iter().find(|(_, given)| *given) {
            let why = "is for meshes; a solid is in millimetres, z up and has an inside";
            return Err(Problem::new(format!("{at}.{key}"), why));
        }
        match solid {
            PlainOr::Plain(_) => Ok(()),
            PlainOr::Table(s) => s.validate(&format!("{at}.solid")),
        }
    }
}
