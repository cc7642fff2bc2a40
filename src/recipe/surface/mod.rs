//! Surface files: `kind = "pde"` and so on. Lengths are mm, angles radians, as in the papers.

mod blend;
mod dynamic;
mod nurbs;
mod pde;
#[cfg(test)]
mod tests;
mod value;

pub use blend::{Basis, Blend, Side};
pub use dynamic::{
    Boundary, Control, Curves, Dynamic, Edges, Scheme, Start, StartTable, StartWord, TangentsOf,
};
pub use nurbs::{Averaging, Design, Falloff, Impact, Nurbs, NurbsMorph};
pub use pde::{Curve, Epsilon, Patch, Pde, PdeMethod, PdeMorph, Shape, Terms};
pub use value::{Formula, Nest};

use super::{Problem, RecipeError, Source};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// What a surface file is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// A surface of PDE patches (paper 000).
    Pde,
    /// A morph of two of them.
    PdeMorph,
    /// A C1 blend of moving surfaces (paper 002).
    Blend,
    /// A rational B-spline curve or surface (paper 003).
    Nurbs,
    /// A morph of two or more of them.
    NurbsMorph,
    /// A surface moved by forces (paper 004).
    Dynamic,
}

impl Kind {
    /// Its word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Pde => "pde",
            Self::PdeMorph => "pde-morph",
            Self::Blend => "blend",
            Self::Nurbs => "nurbs",
            Self::NurbsMorph => "nurbs-morph",
            Self::Dynamic => "dynamic",
        }
    }
}

/// How two surface files become a morph, where no morph file says it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SurfaceMethod {
    /// Blend the curves of two PDE surfaces, and solve again.
    PdeBoundary,
    /// Fade the modes of one PDE surface out and those of the other in.
    PdeModes,
    /// Blend the curves with fewer modes in the middle.
    PdeCombined,
    /// Blend the solved PDE surfaces, spines and radial parts.
    PdeSpine,
    /// Average the points of two rational B-splines.
    NurbsLinear,
    /// Average the points by their masses.
    NurbsWeighted,
}

impl SurfaceMethod {
    /// Its word.
    pub fn word(self) -> &'static str {
        match self {
            Self::PdeBoundary => "pde-boundary",
            Self::PdeModes => "pde-modes",
            Self::PdeCombined => "pde-combined",
            Self::PdeSpine => "pde-spine",
            Self::NurbsLinear => "nurbs-linear",
            Self::NurbsWeighted => "nurbs-weighted",
        }
    }

    /// The kind of the two files.
    pub fn of(self) -> Kind {
        match self {
            Self::NurbsLinear | Self::NurbsWeighted => Kind::Nurbs,
            _ => Kind::Pde,
        }
    }
}

/// A surface file, as written.
#[derive(Clone, Debug, PartialEq, JsonSchema)]
#[schemars(untagged)]
pub enum SurfaceEntry {
    /// `kind = "pde"`
    Pde(Pde),
    /// `kind = "pde-morph"`
    PdeMorph(PdeMorph),
    /// `kind = "blend"`
    Blend(Box<Blend>),
    /// `kind = "nurbs"`
    Nurbs(Nurbs),
    /// `kind = "nurbs-morph"`
    NurbsMorph(NurbsMorph),
    /// `kind = "dynamic"`
    Dynamic(Box<Dynamic>),
}

impl SurfaceEntry {
    /// What it is of.
    pub fn kind(&self) -> Kind {
        match self {
            Self::Pde(_) => Kind::Pde,
            Self::PdeMorph(_) => Kind::PdeMorph,
            Self::Blend(_) => Kind::Blend,
            Self::Nurbs(_) => Kind::Nurbs,
            Self::NurbsMorph(_) => Kind::NurbsMorph,
            Self::Dynamic(_) => Kind::Dynamic,
        }
    }
}

/// The key that says which of the others there may be.
#[derive(Deserialize)]
struct Head {
    kind: Option<Kind>,
}

/// Reads a surface file; `file` names it in errors and tells TOML from JSON.
///
/// # Errors
/// Bad grammar, unknown keys, wrong types: with file, line and key. What the numbers mean is seen
/// when the surface is made.
pub fn parse_surface(text: &str, file: &Path) -> Result<(SurfaceEntry, Source), RecipeError> {
    let (head, source): (Head, _) = Source::read(text, file)?;
    let Some(kind) = head.kind else {
        let why = "missing key `kind`; a surface file begins with kind = \"pde\", \"pde-morph\", \
                   \"blend\", \"nurbs\", \"nurbs-morph\" or \"dynamic\"";
        return Err(source.locate(Problem::new("", why)));
    };
    drop(source);
    Ok(match kind {
        Kind::Pde => Source::read(text, file).map(|(e, s)| (SurfaceEntry::Pde(e), s))?,
        Kind::PdeMorph => Source::read(text, file).map(|(e, s)| (SurfaceEntry::PdeMorph(e), s))?,
        Kind::Blend => {
            Source::read(text, file).map(|(e, s)| (SurfaceEntry::Blend(Box::new(e)), s))?
        }
        Kind::Nurbs => Source::read(text, file).map(|(e, s)| (SurfaceEntry::Nurbs(e), s))?,
        Kind::NurbsMorph => {
            Source::read(text, file).map(|(e, s)| (SurfaceEntry::NurbsMorph(e), s))?
        }
        Kind::Dynamic => {
            Source::read(text, file).map(|(e, s)| (SurfaceEntry::Dynamic(Box::new(e)), s))?
        }
    })
}

/// JSON Schema of surface files.
pub fn surface_schema() -> serde_json::Value {
    schemars::schema_for!(SurfaceEntry).to_value()
}
