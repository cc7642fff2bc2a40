//! A recipe brought to life: files read, shapes placed and made fields, features made elements,
//! every name and weight resolved. What is missing or wrong is told by its key.
//!
//! Two steps: a [`Draft`] has read the shapes and knows how large the work will be; a [`Scene`]
//! has the fields and plans.

mod auto;
mod body;
mod draft;
mod elements;
mod live;
mod mesh_element;
mod moving;
mod pair;
mod pairs;
mod place;
mod plan;
mod rows;
mod scheme;
mod single;
mod skinned;
pub mod suggest;
pub mod surface;
mod variant;

#[cfg(test)]
mod tests;

pub use auto::{Search, Seen};
pub use draft::{Draft, Held, Tessellated, some};
pub use live::LiveShape;
pub use single::Single;
pub use variant::Variant;

use crate::grid::Lattice;
use crate::job::Cancelled;
use crate::recipe::{MorphEntry, Problem, Recipe, RecipeError};
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Why a recipe cannot be brought to life.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SceneError {
    /// Something in the recipe, or in a file it names.
    #[error(transparent)]
    Bad(#[from] RecipeError),
    /// The work was stopped.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// A file that was read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Input {
    /// As it was opened.
    pub file: String,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
}

/// Everything a run needs.
pub struct Scene {
    /// The recipe's name.
    pub name: String,
    /// The shapes, in the order of their names.
    pub shapes: Vec<LiveShape>,
    /// The hybrids to make.
    pub variants: Vec<Variant>,
    /// Where results are sampled; the same for all of them.
    pub lattice: Lattice,
    /// What was assumed and found, for the user.
    pub notes: Vec<String>,
    /// The files read.
    pub inputs: Vec<Input>,
    /// What was chosen for the hybrids whose method was `auto`.
    pub searches: Vec<Search>,
    /// The recipe with `auto` carried out: features suggested, parameters chosen.
    pub recipe: Recipe,
}

/// Names of the shapes that an entry morphs, in order, when its method can be had of this recipe;
/// `at` is the entry's key.
///
/// # Errors
/// Too few shapes, or a method that needs what the recipe lacks.
pub fn applies(entry: &MorphEntry, recipe: &Recipe, at: &str) -> Result<Vec<String>, Problem> {
    let names = plan::shape_names(entry, recipe, at)?;
    plan::method(entry, &names, recipe, at)?;
    Ok(names)
}

/// SHA-256 of bytes, hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut hex, byte| {
        // writing to a string cannot fail
        let _ = write!(hex, "{byte:02x}");
        hex
    })
}

fn digest(path: &Path) -> io::Result<Input> {
    let (mut hash, mut chunk) = (Sha256::new(), vec![0; 1 << 16]);
    let mut file = File::open(path)?;
    loop {
        match file.read(&mut chunk)? {
            0 => break,
            n => hash.update(&chunk[..n]),
        }
    }
    Ok(Input { file: path.display().to_string(), sha256: hex(&hash.finalize()) })
}
