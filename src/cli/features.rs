//! `features suggest`: the parts of chairs found, and a recipe with elements round them.

mod picture;
mod write;

pub(super) use write::beside;

use super::failure::Failure;
use super::inputs::Reading;
use super::watch::Watch;
use clap::{Args, Subcommand};
use fieldgraft::job::Job;
use fieldgraft::parts::{Guess, Suggestion};
use fieldgraft::recipe::GridEntry;
use fieldgraft::run;
use fieldgraft::scene::suggest;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// What to do about features.
#[derive(Subcommand)]
pub enum Features {
    /// Find the parts of meshes and write a recipe with an element round each
    Suggest(Box<Suggest>),
}

impl Features {
    /// Does it.
    pub fn run(self, watch: &Watch) -> Result<(), Failure> {
        match self {
            Self::Suggest(s) => s.run(watch),
        }
    }
}

/// Which meshes, and where the recipe goes.
#[derive(Args)]
pub struct Suggest {
    /// The meshes (OBJ, STL, PLY, GLB, glTF), or solids (`.toml`)
    #[arg(required = true, value_name = "MESH")]
    inputs: Vec<PathBuf>,
    /// Where the recipe goes; without it only what was found is told
    #[arg(short, long, value_name = "RECIPE")]
    output: Option<PathBuf>,
    /// Also a picture of each mesh with its elements: PNG
    #[arg(long, value_name = "PNG")]
    picture: Option<PathBuf>,
    #[command(flatten)]
    reading: Reading,
    /// Print what was found as JSON
    #[arg(long)]
    json: bool,
    /// Overwrite what is there
    #[arg(long)]
    force: bool,
}

impl Suggest {
    /// Finds, tells and writes.
    pub fn run(self, watch: &Watch) -> Result<(), Failure> {
        for path in [&self.output, &self.picture].into_iter().flatten() {
            if !self.force && path.symlink_metadata().is_ok() {
                let why = "exists already; overwrite it with --force";
                return Err(Failure::usage(format!("{}: {why}", path.display())));
            }
        }
        let shapes = names(&self.inputs).into_iter().zip(self.reading.shapes(&self.inputs)?);
        let grid = GridEntry { resolution: Some(write::RESOLUTION), ..GridEntry::default() };
        let looked = suggest::look(shapes.collect(), Path::new(""), &grid, watch)?;
        looked.notes.iter().for_each(|n| watch.say(n));
        if let Some(path) = &self.picture {
            watch.stage("picture");
            picture::save(path, &looked.shells, &looked.suggestion, self.force)?;
        }
        if let Some(path) = &self.output {
            let text = write::recipe(path, &looked.shapes, &looked.suggestion)?;
            run::place_text(path, &text, self.force)?;
        }
        self.tell(&looked.suggestion, watch)
    }

    fn tell(&self, suggestion: &Suggestion, watch: &Watch) -> Result<(), Failure> {
        if self.json {
            let all = json!({
                "shapes": suggestion.shapes.iter().map(shape).collect::<Vec<_>>(),
                "features": suggest::features(suggestion),
            });
            return watch.put(&format!("{all:#}"));
        }
        for guess in &suggestion.shapes {
            watch.put(&format!("{}: {}", guess.name, words(guess)))?;
            for w in &guess.warnings {
                watch.say(&format!("{}: {w}", guess.name));
            }
        }
        Ok(())
    }
}

/// What was found of a shape, in words.
pub fn words(guess: &Guess) -> String {
    let found = match &guess.chair {
        Some(chair) => chair.words(),
        None => "no chair; slabs from bottom to top".to_owned(),
    };
    let turn = guess.pose.turn.to_degrees();
    let turned =
        if turn.abs() > 0.005 { format!("; turned by {turn:.0} degrees") } else { String::new() };
    format!("{found} (confidence {:.2}){turned}", guess.confidence)
}

fn shape(guess: &Guess) -> Value {
    json!({
        "name": guess.name,
        "chair": guess.chair.is_some(),
        "seat_mm": guess.chair.as_ref().map(|c| c.seat.top),
        "found": words(guess),
        "confidence": guess.confidence,
        "turn_deg": guess.pose.turn.to_degrees(),
        "move": guess.pose.shift.to_array(),
        "scale": guess.pose.scale,
        "warnings": guess.warnings,
    })
}

/// The files' own names, made different where they are the same.
fn names(files: &[PathBuf]) -> Vec<String> {
    let mut names: Vec<String> = Vec::with_capacity(files.len());
    for file in files {
        let stem = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let stem = if stem.is_empty() { "shape".to_owned() } else { stem };
        let same = |name: &str| names.iter().any(|n| n == name);
        let mut name = stem.clone();
        let mut n = 2;
        while same(&name) {
            name = format!("{stem}-{n}");
            n += 1;
        }
        names.push(name);
    }
    names
}
