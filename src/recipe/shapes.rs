//! Entries of `[shapes]`.

use super::primitive::{finite, is_default, positive};
use super::value::PlainOr;
use super::{Problem, Solid};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Where a shape comes from and how it stands: exactly one of `mesh` and `solid`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShapeEntry {
    /// A mesh file: OBJ, STL, PLY, GLB or glTF; relative to the recipe.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<PathBuf>,
    /// A solid built of primitives: a file, or its parts here.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub solid: Option<PlainOr<PathBuf, Solid>>,
    /// The file's upward axis, `y` or `z`; by default y for OBJ and glTF, else z.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub up: Option<UpAxis>,
    /// The file's unit of length; by default m for glTF, else mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<LengthUnit>,
    /// Scale to this height, mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<f64>,
    /// Thickness given to sheets that have none, mm; or `{ mm = 6, which = "all" }`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thicken: Option<PlainOr<f64, ThickenEntry>>,
    /// How inside and outside are told apart.
    #[serde(default, skip_serializing_if = "is_default")]
    pub sign: SignEntry,
    /// `keep`, `floor` (centred over the origin, lowest point at z = 0) or `{ like = "other" }`
    /// (its box's centre and floor where those of another shape are).
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
        match (&self.mesh, &self.solid) {
            (None, None) => return Err(Problem::new(at, "no source: give `mesh` or `solid`")),
            (Some(_), Some(_)) => {
                return Err(Problem::new(at, "both `mesh` and `solid`; give one of them"));
            }
            (None, Some(solid)) => self.validate_solid(solid, at)?,
            (Some(_), None) => {}
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
