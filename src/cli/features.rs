//! `features suggest`: the parts of chairs found, and a recipe with elements round them.

mod picture;
mod write;

pub(super) use write::beside;

use super::failure::Failure;
use super::inputs::Reading;
use super::watch::Watch;
use clap::{Args, Subcommand};
use fieldgraft::field::Shared;
use fieldgraft::job::{self, Job};
use fieldgraft::mesh::TriMesh;
use fieldgraft::num::Aabb;
use fieldgraft::parts::{self, Guess, Suggestion};
use fieldgraft::recipe::{GridEntry, ShapeEntry};
use fieldgraft::run;
use fieldgraft::scene::{Single, suggest};
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

/// A mesh that was read.
struct Input {
    name: String,
    entry: ShapeEntry,
    bounds: Aabb,
    field: Shared,
    shells: TriMesh,
}

impl Suggest {
    /// Finds, tells and writes.
    pub fn run(self, watch: &Watch) -> Result<(), Failure> {
        let mut inputs = Vec::with_capacity(self.inputs.len());
        let names = names(&self.inputs);
        for (name, entry) in names.into_iter().zip(self.reading.shapes(&self.inputs)?) {
            job::check(watch)?;
            inputs.push(read(name, entry, watch)?);
        }
        watch.stage("parts");
        let start = std::time::Instant::now();
        let fields: Vec<_> = inputs.iter().map(|i| (i.name.as_str(), &*i.field)).collect();
        let suggestion = parts::suggest(&fields, watch)?;
        watch.detail(&format!("parts found in {:.2} s", start.elapsed().as_secs_f64()));
        for (input, guess) in inputs.iter_mut().zip(&suggestion.shapes) {
            suggest::place(&mut input.entry, &guess.pose, &input.bounds);
        }
        if let Some(path) = &self.picture {
            watch.stage("picture");
            picture::save(path, &inputs, &suggestion, self.force)?;
        }
        if let Some(path) = &self.output {
            let text = write::recipe(path, &inputs, &suggestion)?;
            run::place_text(path, &text, self.force)?;
        }
        self.tell(&suggestion, watch)
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
fn words(guess: &Guess) -> String {
    let found = match &guess.chair {
        Some(chair) => chair.words(),
        None => "no chair; slabs from bottom to top".to_owned(),
    };
    let turn = guess.pose.turn.to_degrees();
    let turned = if turn.abs() > 0.005 { format!("; turned by {turn:.0} degrees") } else { String::new() };
    format!("{found} (confidence {:.2}){turned}", guess.confidence)
}

fn shape(guess: &Guess) -> Value {
    json!({
        "name": guess.name,
        "chair": guess.chair.is_some(),
        "found": words(guess),
        "confidence": guess.confidence,
        "turn_deg": guess.pose.turn.to_degrees(),
        "move": guess.pose.shift.to_array(),
        "scale": guess.pose.scale,
        "warnings": guess.warnings,
    })
}

fn read(name: String, entry: ShapeEntry, watch: &Watch) -> Result<Input, Failure> {
    watch.stage(&format!("read {name}"));
    let single = Single::open(&name, entry.clone(), &GridEntry::default(), Path::new(""))?;
    watch.say(single.note());
    let (bounds, shells) = (single.bounds(), single.shells());
    let (field, notes) = single.field(watch)?;
    notes.iter().for_each(|n| watch.detail(n));
    Ok(Input { name, entry, bounds, field, shells })
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
