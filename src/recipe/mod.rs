//! The recipe: a text that says which shapes to morph, how, and what to write.
//!
//! TOML for people, JSON with the same keys for programs. Unknown keys are errors that name the
//! nearest known key. Lengths are millimetres, angles degrees, t in [0, 1]. Everything here is
//! plain data as typed; the `scene` makes objects of it.

mod json;
mod near;
mod solid;
mod source;

pub use near::{did_you_mean, nearest};
pub use solid::{
    BoxShape, CapsuleShape, CylinderShape, EllipsoidShape, Mirror, Op, Part, Primitive, PrismShape,
    Solid, SolidKind,
};
pub use source::{Problem, RecipeError, Source};

use std::path::Path;

/// Reads a solid file (`kind = "solid"`); `file` names it in errors and tells TOML from JSON.
///
/// # Errors
/// Bad grammar, unknown keys, parts that are no shape: with file, line and key.
pub fn parse_solid(text: &str, file: &Path) -> Result<Solid, RecipeError> {
    let (solid, source): (Solid, _) = Source::read(text, file)?;
    if solid.kind.is_none() {
        let why = "missing key `kind`; a solid file begins with kind = \"solid\"";
        return Err(source.locate(Problem::new("", why)));
    }
    solid.validate("").map_err(|p| source.locate(p))?;
    Ok(solid)
}
