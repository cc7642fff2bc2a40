//! `compare`: several methods on one pair, and the report.

use super::failure::Failure;
use super::inputs::Fineness;
use super::watch::Watch;
use super::{Making, run, steps};
use clap::Args;
use fieldgraft::picture::Style;
use fieldgraft::recipe::{MorphEntry, Recipe, RecipeError, Times, did_you_mean, read_text};
use fieldgraft::run::compare::{self, Chosen, Compare as How, Comparison, Row};
use fieldgraft::run::{Machine, Playing, Prediction, ShapeReport, predict, time_word};
use fieldgraft::scene::{Draft, SceneError, applies, sha256};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What to compare.
#[derive(Args)]
pub struct Compare {
    /// The recipe, TOML or JSON; its shapes, features and times are taken
    #[arg(value_name = "RECIPE", required_unless_present = "methods")]
    recipe: Option<PathBuf>,
    /// Folder for report.html, metrics.csv, metrics.json, sheet.png and meshes/
    #[arg(short, long, value_name = "DIR", default_value = "compare")]
    output: PathBuf,
    /// Methods, in the order of the rows; all that apply by default; `help` lists them
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    methods: Vec<String>,
    /// Times instead of the recipe's: numbers, or ranges such as 0:1:0.125; repeatable
    #[arg(short, value_name = "T", value_parser = times, action = clap::ArgAction::Append)]
    t: Vec<Times>,
    #[command(flatten)]
    fineness: Fineness,
    /// Take the shapes and weights of this hybrid instead of [morph]'s
    #[arg(long, value_name = "NAME")]
    hybrid: Option<String>,
    /// Drop loose pieces below this share of the volume, of every method alike; by default as
    /// the recipe's output.crumbs says, else none
    #[arg(long, value_name = "SHARE", value_parser = share)]
    crumbs: Option<f64>,
    /// Also play each method, in animations/: webp or gif (pictures), glb (meshes); as
    /// output.fps and output.ping_pong of the recipe say
    #[arg(long, value_name = "KINDS", value_delimiter = ',', value_parser = ["webp", "gif", "glb"])]
    animation: Vec<String>,
    /// Write no meshes
    #[arg(long)]
    no_meshes: bool,
    /// Change a key, such as --set grid.resolution=128 or --set 'morph.offset=3'; repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    #[command(flatten)]
    making: Making,
}

/// Size of a picture: what a row of nine shows side by side.
const PICTURE: [u32; 2] = [240, 300];
/// Times of a pair where the recipe names none.
const TIMES: [f64; 9] = [0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0];
/// Bytes a triangle in the measures: trees over both parents and two frames.
const MEASURE_BYTES: u64 = 1600;

fn times(text: &str) -> Result<Times, String> {
    text.parse()
}

fn share(text: &str) -> Result<f64, String> {
    let share = text.parse().ok().filter(|s| (0.0..1.0).contains(s));
    share.ok_or_else(|| format!("got `{text}`; expected a share of the volume, 0 to below 1"))
}

impl Compare {
    /// Makes everything.
    pub fn run(self, watch: &Watch) -> Result<(), Failure> {
        if self.methods.iter().any(|m| m == "help") {
            return watch.put(&compare::help());
        }
        let Some(file) = &self.recipe else {
            return Err(Failure::usage("which recipe? give its file"));
        };
        let start = Instant::now();
        let text =
            read_text(file).map_err(|why| Failure::input(format!("{}: {why}", file.display())))?;
        let (mut recipe, source) = run::parse(&text, file, &self.set)?;
        let recipe_sha256 = sha256(source.text().as_bytes());
        if self.fineness.resolution.is_some() || self.fineness.voxel.is_some() {
            (recipe.grid.resolution, recipe.grid.voxel) =
                (self.fineness.resolution, self.fineness.voxel);
        }
        let base = self.base(&recipe)?;
        let locate = |p| Failure::from(source.locate(p));
        let parents = applies(&MorphEntry { method: None, ..base.clone() }, &recipe, "morph")
            .map_err(locate)?;
        let chosen = compare::choose(&self.methods, &recipe, &base).map_err(Failure::usage)?;
        let (fit, mut refused) = sorted(&chosen, &recipe);
        let how = self.how(&recipe, parents);
        let names: Vec<String> = fit.iter().map(|c| c.name.clone()).collect();
        let when = base.t.as_ref().map_or(vec![0.5], |t| t.0.clone());
        if !self.making.dry_run {
            how.check(&names, &when)?;
        }
        none_left(&fit, &refused)?;
        (recipe.morph, recipe.hybrids) = (MorphEntry::default(), fit.iter().map(entry).collect());
        let name = recipe.name.clone();
        let draft = Draft::open(recipe, source, file.parent().unwrap_or(Path::new("")), watch)?;
        let prediction = measured(predict(&draft, Some(PICTURE)));
        if self.making.dry_run {
            steps::tell_prediction(&prediction, &self.making, watch)?;
        }
        steps::refuse(&prediction, steps::limit(&self.making))?;
        if self.making.dry_run {
            return Ok(());
        }
        let (scene, unplanned) = draft.build_each(watch)?;
        scene.notes.iter().for_each(|n| watch.say(n));
        for (name, why) in unplanned {
            refused.push((name, plain(why)?));
        }
        let mut says: Vec<[String; 2]> =
            chosen.iter().map(|c| [c.name.clone(), c.says.clone()]).collect();
        if self.methods.is_empty() {
            // surfaces of one kind are no surfaces of the other: those rows would tell nothing
            let of_surfaces = |n: &str| n.starts_with("pde-") || n.starts_with("nurbs-");
            refused.retain(|(n, _)| !of_surfaces(n));
            says.retain(|[n, _]| !of_surfaces(n) || scene.variants.iter().any(|v| v.name == *n));
        }
        refused.iter().for_each(|(name, why)| watch.say(&format!("{name}: does not apply: {why}")));
        let seconds = start.elapsed().as_secs_f64();
        let about = Comparison {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            name,
            recipe: Some(file.display().to_string()),
            recipe_sha256,
            arguments: steps::arguments(),
            machine: Machine::here(),
            inputs: scene.inputs.clone(),
            shapes: scene.shapes.iter().map(ShapeReport::of).collect(),
            says,
            notes: scene.notes.clone(),
            searches: scene.searches.clone(),
            times: when,
            seconds_shapes: seconds,
            seconds_total: seconds,
            ..Comparison::default()
        };
        let mut told = |row: &Row| tell(row, watch);
        let done = compare::compare(&scene, &refused, &how, about, watch, &mut told)?;
        self.finish(&done, watch)
    }

    /// The `[morph]` that every method changes, with the times to make.
    fn base(&self, recipe: &Recipe) -> Result<MorphEntry, Failure> {
        let mut base = match &self.hybrid {
            None => recipe.morph.clone(),
            Some(name) => {
                let mut all = recipe.variants().into_iter().map(|(_, v)| v);
                all.find(|v| v.name == *name).ok_or_else(|| {
                    let hint = did_you_mean(name, recipe.hybrids.iter().map(|h| h.name.as_str()));
                    Failure::usage(format!("--hybrid: no hybrid is called `{name}`{hint}"))
                })?
            }
        };
        // a recipe of hybrids only is compared in its first
        if base.between.is_none() && base.among.is_none() && self.hybrid.is_none() {
            base = recipe.variants().into_iter().next().map_or(base, |(_, v)| v);
        }
        base.name.clear();
        if !self.t.is_empty() {
            base.t = Some(Times(self.t.iter().flat_map(|t| t.0.iter().copied()).collect()));
        } else if base.t.is_none() && base.between.is_some() && base.weights.is_empty() {
            base.t = Some(Times(TIMES.to_vec()));
        }
        Ok(base)
    }

    fn how(&self, recipe: &Recipe, parents: Vec<String>) -> How {
        How {
            folder: self.output.clone(),
            force: self.making.force,
            verify: self.making.verify || self.making.strict,
            meshes: !self.no_meshes,
            mesher: recipe.output.mesher,
            crumbs: self.crumbs.or(recipe.output.crumbs).unwrap_or(0.0),
            parents,
            style: Style { size: PICTURE, ..Style::default() },
            animations: self.animation.clone(),
            playing: Playing::of(&recipe.output),
        }
    }

    /// Prints what was found and judges it.
    fn finish(&self, done: &Comparison, watch: &Watch) -> Result<(), Failure> {
        if self.making.json {
            watch.put(&done.to_json())?;
        }
        let report = self.output.join("report.html");
        watch.say(&format!("{}: {:.1} s", report.display(), done.seconds_total));
        if done.rows.iter().all(|r| r.error.is_some()) {
            let why = done.rows.iter().find_map(|r| r.error.clone()).unwrap_or_default();
            return Err(Failure::new(Failure::FAILED, format!("no method has a mesh: {why}")));
        }
        let bad = |r: &&Row| {
            let sound = r.closed == Some(true) && r.manifold == Some(true);
            r.error.is_none() && !(sound && r.self_intersections.unwrap_or(0) == 0)
        };
        let failed = done.animations.iter().find_map(|a| a.error.clone());
        if let Some(why) = failed {
            return Err(Failure::new(Failure::FAILED, why));
        }
        match done.rows.iter().find(bad).filter(|_| self.making.strict) {
            Some(r) => {
                let why = format!("{} at t {}: not printable (--strict)", r.method, time_word(r.t));
                Err(Failure::new(Failure::UNPRINTABLE, why))
            }
            None => Ok(()),
        }
    }
}

/// Methods that the recipe has what they need for, and the others with the reason.
fn sorted(chosen: &[Chosen], recipe: &Recipe) -> (Vec<Chosen>, Vec<(String, String)>) {
    let (mut fit, mut refused) = (Vec::new(), Vec::new());
    for c in chosen {
        match applies(&c.entry, recipe, "morph") {
            Ok(_) => fit.push(c.clone()),
            Err(p) => refused.push((c.name.clone(), p.to_string())),
        }
    }
    (fit, refused)
}

/// Fails when no method is left to compare.
fn none_left(fit: &[Chosen], refused: &[(String, String)]) -> Result<(), Failure> {
    match (fit, refused) {
        ([], [(name, why), ..]) => {
            Err(Failure::input(format!("no method applies to this recipe: {name}: {why}")))
        }
        ([], []) => Err(Failure::input("no method applies to this recipe")),
        _ => Ok(()),
    }
}

/// A method as a hybrid of the recipe.
fn entry(c: &Chosen) -> MorphEntry {
    MorphEntry { name: c.name.clone(), ..c.entry.clone() }
}

/// With the memory that measuring needs.
fn measured(p: Prediction) -> Prediction {
    Prediction { memory_bytes: p.memory_bytes + p.triangles * MEASURE_BYTES, ..p }
}

/// Why a method cannot be planned, with the recipe's own key.
fn plain(why: SceneError) -> Result<String, Failure> {
    match why {
        SceneError::Cancelled(stop) => Err(stop.into()),
        SceneError::Bad(RecipeError { at, why, .. }) => {
            let rest = at.strip_prefix("hybrids[").and_then(|r| r.split_once(']'));
            Ok(match rest {
                Some((_, rest)) => format!("morph{rest}: {why}"),
                None => format!("{at}: {why}"),
            })
        }
    }
}

/// A line on a frame.
fn tell(r: &Row, watch: &Watch) {
    let t = time_word(r.t);
    let what = match (&r.error, r.pieces) {
        (Some(why), _) => why.clone(),
        (None, pieces) => {
            let number =
                |v: Option<f64>, n: usize| v.map_or("?".to_owned(), |v| format!("{v:.n$}"));
            format!(
                "{} pieces, genus {}, volume kept {}, wall {} mm, step {} mm, {} s",
                pieces.unwrap_or(0),
                r.genus.unwrap_or(0),
                number(r.volume_kept, 2),
                number(r.min_wall_mm, 1),
                number(r.step_mm, 1),
                number(r.seconds, 2)
            )
        }
    };
    watch.say(&format!("{} t {t}: {what}", r.method));
}
