//! `morph`: the quick road from meshes to hybrids. It makes a recipe and runs it.

use super::failure::Failure;
use super::inputs::{self, Fineness, Reading};
use super::steps::{self, Task};
use super::watch::Watch;
use super::{Making, convert, features};
use clap::{Args, ValueEnum};
use fieldgraft::mesh::check_output;
use fieldgraft::recipe::{
    GridEntry, MesherEntry, MethodEntry, MorphEntry, OutputEntry, PlaceLike, PlainOr, Recipe,
    ShapeEntry, Source, StyleEntry, Times, VERSION, word,
};
use fieldgraft::run::{self, Report, RunError};
use fieldgraft::scene::{Search, suggest};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What to morph.
#[derive(Args)]
pub struct Morph {
    /// Two meshes or more (OBJ, STL, PLY, GLB, glTF), or solids and surfaces (`.toml`)
    #[arg(required = true, num_args = 2.., value_name = "MESH")]
    inputs: Vec<PathBuf>,
    /// Where the hybrid goes: STL, OBJ, PLY or GLB; `{t}` stands for the time
    #[arg(short, long, value_name = "OUT")]
    output: String,
    /// Times in [0, 1]: numbers, or ranges such as 0:1:0.125; repeatable; by default 0.5
    #[arg(short, value_name = "T", value_parser = times, action = clap::ArgAction::Append)]
    t: Vec<Times>,
    /// Weights of the meshes instead of a time, such as 2,1,1
    #[arg(long, value_delimiter = ',', value_name = "W", conflicts_with = "t")]
    weights: Vec<f64>,
    /// How: auto (the default: parts are found and paired), linear, space-time, level-set or transport
    #[arg(long, value_name = "METHOD", value_parser = method)]
    method: Option<MethodEntry>,
    /// What hybrids of auto look like: average (the default), swap, grow or erode
    #[arg(long, value_name = "STYLE", value_parser = style)]
    style: Option<StyleEntry>,
    /// How the meshes are laid over each other: box (all stand where the first does), pose (each as
    /// chairs do) or none
    #[arg(long, value_enum, default_value_t = Align::Box)]
    align: Align,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    fineness: Fineness,
    /// Also a picture: PNG, with `{t}` where there are several times; auto makes one beside OUT
    #[arg(long, value_name = "PNG")]
    picture: Option<String>,
    /// Drop loose pieces below this share of the volume
    #[arg(long, value_name = "SHARE")]
    crumbs: Option<f64>,
    /// How triangles are made: print, sharp (keeps edges and corners) or preview
    #[arg(long, value_name = "MESHER", value_parser = inputs::mesher)]
    mesher: Option<MesherEntry>,
    /// Also write the recipe that this command stands for; auto writes it beside OUT
    #[arg(long, value_name = "TOML")]
    recipe: Option<PathBuf>,
    #[command(flatten)]
    making: Making,
}

/// How meshes are laid over each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Align {
    /// Their boxes' centres and floors agree with the first one's
    Box,
    /// Each stands on the floor and faces the front, as far as that can be found
    Pose,
    /// They stay where they are
    None,
}

fn times(text: &str) -> Result<Times, String> {
    text.parse()
}

fn style(text: &str) -> Result<StyleEntry, String> {
    word(text)
}

fn method(text: &str) -> Result<MethodEntry, String> {
    match word(text)? {
        MethodEntry::FeatureVolume
        | MethodEntry::Graft
        | MethodEntry::Group
        | MethodEntry::Warp => {
            Err("this method needs features; write a recipe for `fieldgraft run`".to_owned())
        }
        plain => Ok(plain),
    }
}

impl Morph {
    /// Makes the hybrids.
    pub fn run(self, watch: &Watch) -> Result<(), Failure> {
        let recipe = self.recipe(watch)?;
        if self.auto() {
            return self.run_auto(recipe, watch);
        }
        let text = text(&recipe)?;
        if let Some(path) = self.recipe.as_ref().filter(|_| !self.making.dry_run) {
            run::place_text(path, &text, self.making.force)?;
        }
        if !self.making.dry_run {
            check_output(Path::new(&self.output.replace("{t}", "0")), true)?;
        }
        let task = Task {
            source: Source::unplaced(text, Path::new("")),
            beside: Path::new(""),
            names: convert::names(&self.output, self.picture.clone()),
            file: None,
            recipe,
            written: None,
        };
        steps::make(task, &self.making, watch)
    }

    fn auto(&self) -> bool {
        self.method.unwrap_or_default() == MethodEntry::Auto
    }

    /// Makes the hybrids with what is found and chosen; the recipe of it goes beside them.
    fn run_auto(&self, recipe: Recipe, watch: &Watch) -> Result<(), Failure> {
        let beside = |extension: &str| {
            Path::new(&self.output).with_extension(extension).display().to_string()
        };
        let picture = self.picture.clone().unwrap_or_else(|| beside("png"));
        let mut names = convert::names(&self.output, Some(picture));
        let bare = names.report.replace(".run.json", ".toml");
        let path = self.recipe.clone().unwrap_or_else(|| PathBuf::from(bare));
        if !self.making.dry_run {
            check_output(Path::new(&self.output.replace("{t}", "0")), true)?;
            if path.symlink_metadata().is_ok() && !self.making.force {
                return Err(RunError::Exists(path).into());
            }
        }
        names.unnamed.clone_from(&recipe.name);
        let file_name = |name: &str| Path::new(name).file_name().map(|n| n.display().to_string());
        let (mesh, picture) =
            (file_name(&names.mesh), names.picture.as_deref().and_then(file_name));
        let written = |chosen: &Recipe| {
            let mut chosen = chosen.clone();
            (chosen.output.mesh, chosen.output.picture) = (mesh.clone(), picture.clone());
            for entry in chosen.shapes.values_mut() {
                let solid = match &mut entry.solid {
                    Some(PlainOr::Plain(file)) => Some(file),
                    _ => None,
                };
                for file in entry.mesh.iter_mut().chain(solid).chain(&mut entry.surface) {
                    *file = features::beside(&path, file);
                }
            }
            Ok(format!("{ABOUT}{}", text(&chosen)?))
        };
        let task = Task {
            source: Source::unplaced(text(&recipe)?, Path::new("")),
            beside: Path::new(""),
            names,
            file: None,
            recipe,
            written: Some(&written),
        };
        let Some(made) = steps::made(task, &self.making, watch)? else { return Ok(()) };
        run::place_text(&path, &made.text, self.making.force)?;
        self.tell(&made.report, &path, watch);
        steps::finish(&made.report, &self.making, watch)
    }

    /// What was found, what was kept, what to try next.
    fn tell(&self, report: &Report, recipe: &Path, watch: &Watch) {
        let told = |n: &&String| n.contains("(confidence ") || n.contains(" mm thick: ");
        let found: Vec<&str> = report.notes.iter().filter(told).map(String::as_str).collect();
        if report.searches.is_empty() {
            watch.say("found: no parts to pair; the whole shapes were blended by space-time");
        } else {
            watch.say(&format!("found: {}", found.join("; ")));
        }
        let kept = report.frames.iter().filter_map(|f| {
            let pieces = f.pieces?;
            let pieces = if pieces == 1 { "1 piece".into() } else { format!("{pieces} pieces") };
            let t = run::time_word(f.t);
            let feet = f.feet.map_or_else(String::new, |n| format!(", {}", n.story()));
            Some(format!(
                "t {t}: {:.0}% of the mean volume, {pieces}{feet}",
                f.volume_kept? * 100.0
            ))
        });
        let did = report.searches.first().map_or_else(String::new, did);
        watch.say(&format!("kept: {}{did}", kept.collect::<Vec<_>>().join("; ")));
        let recipe = recipe.display();
        watch.say(&match report.searches.first().map(|s| s.style) {
            None => format!("next: place elements in {recipe}, then `fieldgraft run {recipe}`"),
            Some(StyleEntry::Swap) => {
                format!("next: --style average; or edit {recipe}, then `fieldgraft run {recipe}`")
            }
            Some(_) => format!(
                "next: --style swap takes whole parts of each; or edit {recipe}, then \
                 `fieldgraft run {recipe}`"
            ),
        });
    }

    /// The recipe this command line stands for.
    fn recipe(&self, watch: &Watch) -> Result<Recipe, Failure> {
        let times: Vec<f64> = self.t.iter().flat_map(|t| t.0.iter().copied()).collect();
        let template = |name: &str| name.contains("{t}");
        let several = times.len() > 1;
        if several && !(template(&self.output) && self.picture.as_deref().is_none_or(template)) {
            let why = format!("{} times need {{t}} in each output's name", times.len());
            return Err(Failure::usage(why));
        }
        if !times.is_empty() && self.inputs.len() > 2 {
            return Err(Failure::usage("-t is for two meshes; more need --weights"));
        }
        let names = names(self.inputs.len());
        let mut shapes: BTreeMap<String, ShapeEntry> =
            names.iter().cloned().zip(self.reading.shapes(&self.inputs)?).collect();
        if self.align == Align::Pose {
            let grid = self.grid();
            let looked =
                suggest::look(shapes.clone().into_iter().collect(), Path::new(""), &grid, watch)?;
            for guess in &looked.suggestion.shapes {
                watch.say(&format!("{}: {}", guess.name, features::words(guess)));
            }
            for (name, mut entry) in looked.shapes {
                if !self.auto() {
                    entry.thicken = shapes.get(&name).and_then(|e| e.thicken.clone());
                }
                shapes.insert(name, entry);
            }
        }
        if self.align == Align::Box {
            for name in &names[1..] {
                if let Some(shape) = shapes.get_mut(name) {
                    shape.place = PlainOr::Table(PlaceLike { like: names[0].clone() });
                }
            }
        }
        if self.style.is_some() && !self.auto() {
            return Err(Failure::usage("--style is for the method auto"));
        }
        let mut morph = MorphEntry {
            method: Some(self.method.unwrap_or_default()),
            style: self.style,
            weights: self.rows(&names)?,
            ..MorphEntry::default()
        };
        match <[String; 2]>::try_from(names) {
            Ok(pair) => morph.between = Some(pair),
            Err(all) => morph.among = Some(all),
        }
        if morph.weights.is_empty() && self.inputs.len() == 2 {
            morph.t = Some(Times(if times.is_empty() { vec![0.5] } else { times }));
        }
        let recipe = Recipe {
            version: VERSION,
            grid: self.grid(),
            shapes,
            morph,
            output: OutputEntry {
                crumbs: self.crumbs,
                mesher: self.mesher.unwrap_or_default(),
                ..OutputEntry::default()
            },
            ..Recipe::default()
        };
        recipe.validate().map_err(|p| Failure::usage(p.to_string()))?;
        Ok(recipe)
    }

    fn grid(&self) -> GridEntry {
        GridEntry {
            resolution: self.fineness.resolution,
            voxel: self.fineness.voxel,
            ..GridEntry::default()
        }
    }

    fn rows(&self, names: &[String]) -> Result<fieldgraft::recipe::Weights, Failure> {
        if self.weights.is_empty() {
            return Ok(BTreeMap::new());
        }
        if self.weights.len() != names.len() {
            let (got, of) = (self.weights.len(), names.len());
            return Err(Failure::usage(format!("--weights: {got} weights for {of} meshes")));
        }
        let row = names.iter().cloned().zip(self.weights.iter().copied()).collect();
        Ok(BTreeMap::from([("default".to_owned(), row)]))
    }
}

/// What stands above a recipe that was chosen.
const ABOUT: &str = "\
# Chosen by `fieldgraft morph`: features found by machine, parameters by a search. Edit and run it.
# Millimetres, z up; fronts look to -y, left is -x.
";

fn text(recipe: &Recipe) -> Result<String, Failure> {
    toml::to_string(recipe).map_err(|e| Failure::new(Failure::FAILED, format!("recipe: {e}")))
}

/// What the features do, in words: the functions, and the features of each.
fn did(search: &Search) -> String {
    let mut by: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for (name, part) in &search.features {
        let word = part.inner.map(|i| format!("{i:?}").to_lowercase()).unwrap_or_default();
        let taken = search.weights.get(name).map(|row| row.keys().cloned().collect::<Vec<_>>());
        let what = taken.map_or(word.clone(), |of| format!("{word} of {}", of.join(" and ")));
        by.entry(what).or_default().push(name);
    }
    by.iter().map(|(what, names)| format!("; {what}: {}", names.join(", "))).collect()
}

/// `a`, `b`, ... `z`, then `s27` and on.
fn names(count: usize) -> Vec<String> {
    let letter = |i: usize| u8::try_from(i).ok().filter(|i| *i < 26).map(|i| (b'a' + i) as char);
    (0..count).map(|i| letter(i).map_or_else(|| format!("s{}", i + 1), String::from)).collect()
}
