//! `run`: makes what a recipe says; or one shape, from its solid or surface file.

use super::Making;
use super::failure::Failure;
use super::inputs::source;
use super::steps::{self, Task};
use super::watch::Watch;
use clap::{Args, ValueEnum};
use fieldgraft::recipe::{
    GridEntry, PlainOr, Recipe, RecipeError, ShapeEntry, SkinEntry, Source, Times, VERSION, kind,
    read_text, word,
};
use fieldgraft::run::Names;
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

/// What to run.
#[derive(Args)]
pub struct Run {
    /// The recipe, TOML or JSON; or a solid or surface file, to make that shape alone
    #[arg(value_name = "RECIPE")]
    recipe: PathBuf,
    /// Folder for the results; by default the current one
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// How finely: as the recipe says, or its preview
    #[arg(long, value_enum, default_value_t = Profile::Final)]
    profile: Profile,
    /// Times instead of the recipe's: numbers, or ranges such as 0:1:0.125; repeatable
    #[arg(short, value_name = "T", value_parser = times, action = clap::ArgAction::Append)]
    t: Vec<Times>,
    /// Only these hybrids, by name; repeatable
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// Change a key, such as --set grid.resolution=128 or --set 'morph.inner="erode"'; repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Thickness of a surface file that encloses nothing, and of a curve
    #[arg(long, value_name = "MM", value_parser = thickness)]
    thickness: Option<f64>,
    /// How a surface file becomes solid: auto, solid (open rims get lids) or shell
    #[arg(long, value_name = "SKIN", value_parser = skin)]
    skin: Option<SkinEntry>,
    #[command(flatten)]
    making: Making,
}

/// How finely to run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Profile {
    /// Coarse and quick
    Preview,
    /// As the recipe says
    Final,
}

fn times(text: &str) -> Result<Times, String> {
    text.parse()
}

fn thickness(text: &str) -> Result<f64, String> {
    let mm = text.parse().ok().filter(|mm: &f64| *mm > 0.0 && mm.is_finite());
    mm.ok_or_else(|| format!("got `{text}`; expected millimetres, more than 0"))
}

fn skin(text: &str) -> Result<SkinEntry, String> {
    word(text)
}

impl Run {
    /// Makes everything.
    pub fn run(self, watch: &Watch) -> Result<(), Failure> {
        let name = self.recipe.display().to_string();
        self.make(watch).map_err(|e| e.about(&name))
    }

    fn make(self, watch: &Watch) -> Result<(), Failure> {
        let text = read_text(&self.recipe)
            .map_err(|why| Failure::input(format!("{}: {why}", self.recipe.display())))?;
        let (mut recipe, source) = match kind(&text, &self.recipe) {
            Some(_) => self.shape()?,
            None if self.thickness.is_some() || self.skin.is_some() => {
                let key = if self.thickness.is_some() { "thickness" } else { "skin" };
                let why = "is for a surface file alone; in a recipe each shape has its";
                return Err(Failure::usage(format!("--{key}: {why} `{key}`")));
            }
            None => parse(&text, &self.recipe, &self.set)?,
        };
        self.adjust(&mut recipe)?;
        let names = self.names(&recipe, &source)?;
        let beside = self.recipe.parent().unwrap_or(Path::new(""));
        let file = Some(self.recipe.display().to_string());
        steps::make(
            Task { recipe, source, beside, names, file, written: None },
            &self.making,
            watch,
        )
    }

    /// The recipe of the one shape that a file describes, under the file's name.
    fn shape(&self) -> Result<(Recipe, Source), Failure> {
        let stem = self.recipe.file_stem().unwrap_or_default().to_string_lossy();
        // dots would part the key for --set
        let name = stem.replace('.', "-");
        let (thickness, skin) = (self.thickness, self.skin.unwrap_or_default());
        let mut shape = ShapeEntry { thickness, skin, ..ShapeEntry::default() };
        source(&self.recipe, &mut shape);
        // paths are relative to the recipe, which is taken to lie beside the file
        let file = PathBuf::from(self.recipe.file_name().unwrap_or_default());
        match shape.solid {
            Some(_) => shape.solid = Some(PlainOr::Plain(file)),
            None => shape.surface = Some(file),
        }
        let recipe = Recipe {
            version: VERSION,
            name: name.clone(),
            shapes: BTreeMap::from([(name, shape)]),
            ..Recipe::default()
        };
        let fail = |e: toml::ser::Error| Failure::new(Failure::FAILED, format!("recipe: {e}"));
        let text = toml::to_string(&recipe).map_err(fail)?;
        // this text is nobody's: errors have its keys, but no lines and no file
        let (recipe, source) = parse(&text, Path::new(""), &self.set)?;
        Ok((recipe, Source::unplaced(source.text().to_owned(), Path::new(""))))
    }

    /// What the command line overrides.
    fn adjust(&self, recipe: &mut Recipe) -> Result<(), Failure> {
        if self.profile == Profile::Preview {
            let resolution = recipe.grid.preview.unwrap_or(GridEntry::PREVIEW);
            recipe.grid.resolution = Some(resolution);
            recipe.grid.voxel = None;
        }
        if !self.t.is_empty() {
            let t = Times(self.t.iter().flat_map(|t| t.0.iter().copied()).collect());
            recipe.morph.t = Some(t.clone());
            recipe.hybrids.iter_mut().for_each(|h| h.t = Some(t.clone()));
        }
        for name in &self.only {
            if !recipe.hybrids.iter().any(|h| h.name == *name) {
                let known = recipe.hybrids.iter().map(|h| h.name.as_str());
                let hint = fieldgraft::recipe::did_you_mean(name, known);
                return Err(Failure::usage(format!("--only: no hybrid is called `{name}`{hint}")));
            }
        }
        if !self.only.is_empty() {
            recipe.hybrids.retain(|h| self.only.contains(&h.name));
        }
        Ok(())
    }

    /// Where the results go.
    fn names(&self, recipe: &Recipe, source: &Source) -> Result<Names, Failure> {
        let hybrids = !recipe.hybrids.is_empty();
        let several =
            recipe.variants().iter().any(|(_, v)| v.t.as_ref().is_some_and(|t| t.0.len() > 1));
        let alone = recipe.shapes.len() == 1;
        let default = match (hybrids || alone && !recipe.name.is_empty(), several) {
            (true, true) => "{name}-{t}.stl",
            (true, false) => "{name}.stl",
            (false, true) => "hybrid-{t}.stl",
            (false, false) => "hybrid.stl",
        };
        let mesh = recipe.output.mesh.clone().unwrap_or_else(|| default.to_owned());
        let picture = recipe.output.picture.clone();
        let animations = recipe.output.animations().to_vec();
        let moving = animations.iter().map(|name| ("animation", Some(name)));
        for (key, name) in
            [("mesh", Some(&mesh)), ("picture", picture.as_ref())].into_iter().chain(moving)
        {
            if name.is_some_and(|n| !stays_inside(n) || n.contains('\0')) {
                let why = "leaves the output folder; give a plain relative name";
                let problem = fieldgraft::recipe::Problem::new(format!("output.{key}"), why);
                return Err(source.locate(problem).into());
            }
        }
        let unnamed = if recipe.name.is_empty() { "hybrid" } else { &recipe.name };
        Ok(Names {
            folder: self.output.clone().unwrap_or_default(),
            mesh,
            picture,
            animations,
            report: "run.json".to_owned(),
            unnamed: unnamed.to_owned(),
        })
    }
}

/// Whether a recipe's file name stays in the folder it is put into.
fn stays_inside(name: &str) -> bool {
    Path::new(name).components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir))
}

/// Reads the recipe, with keys changed where asked.
pub fn parse(text: &str, file: &Path, set: &[String]) -> Result<(Recipe, Source), RecipeFailure> {
    let read = Recipe::parse(text, file)?;
    if set.is_empty() {
        return Ok(read);
    }
    let mut tree =
        toml::Table::try_from(&read.0).map_err(|e| RecipeFailure::Usage(format!("--set: {e}")))?;
    for change in set {
        change_key(&mut tree, change)
            .map_err(|why| RecipeFailure::Usage(format!("--set: {why}")))?;
    }
    // the lines of this text are nobody's; its keys are what an error must name
    let text = tree.to_string();
    let toml = file.with_extension("toml");
    let (recipe, _) = Recipe::parse(&text, &toml).map_err(|mut e| {
        (e.file, e.line) = (file.to_owned(), None);
        e
    })?;
    Ok((recipe, Source::unplaced(text, file)))
}

/// Sets `key.path[0].name=value` in a tree; the value is TOML, or else a plain word.
fn change_key(tree: &mut toml::Table, change: &str) -> Result<(), String> {
    let (path, value) =
        change.split_once('=').ok_or_else(|| format!("got `{change}`; expected key=value"))?;
    let value = match format!("v = {value}").parse::<toml::Table>() {
        Ok(mut t) if t.len() == 1 => t.remove("v").unwrap_or(toml::Value::Boolean(false)),
        _ => toml::Value::String(value.to_owned()),
    };
    let steps: Vec<&str> = path.trim().split('.').collect();
    let (last, above) = steps.split_last().ok_or("an empty key")?;
    let mut at = tree;
    for step in above {
        let (name, index) = indexed(step)?;
        let here = at.entry(name).or_insert_with(|| toml::Value::Table(toml::Table::new()));
        let here = match index {
            None => here,
            Some(i) => here
                .as_array_mut()
                .and_then(|a| a.get_mut(i))
                .ok_or_else(|| format!("{path}: there is no `{step}`"))?,
        };
        at = here.as_table_mut().ok_or_else(|| format!("{path}: `{step}` is no table"))?;
    }
    at.insert((*last).to_owned(), value);
    // the two ways of saying the same thing: the one just given counts
    match path.trim() {
        "grid.resolution" => drop(at.remove("voxel")),
        "grid.voxel" => drop(at.remove("resolution")),
        _ => {}
    }
    Ok(())
}

/// `name[3]` as name and index.
fn indexed(step: &str) -> Result<(String, Option<usize>), String> {
    match step.split_once('[') {
        None => Ok((step.to_owned(), None)),
        Some((name, rest)) => {
            let index = rest.strip_suffix(']').and_then(|i| i.parse().ok());
            let index = index.ok_or_else(|| format!("`{step}`: expected name[0]"))?;
            Ok((name.to_owned(), Some(index)))
        }
    }
}

/// A bad recipe, or a bad `--set`.
pub enum RecipeFailure {
    /// The recipe.
    Recipe(RecipeError),
    /// The command line.
    Usage(String),
}

impl From<RecipeError> for RecipeFailure {
    fn from(e: RecipeError) -> Self {
        Self::Recipe(e)
    }
}

impl From<RecipeFailure> for Failure {
    fn from(e: RecipeFailure) -> Self {
        match e {
            RecipeFailure::Recipe(e) => e.into(),
            RecipeFailure::Usage(why) => Self::usage(why),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{change_key, stays_inside};

    #[test]
    fn keys_are_changed_in_place() {
        let mut tree: toml::Table =
            "[grid]\nresolution = 256\n[[features]]\nname = \"seat\"\n".parse().unwrap();
        change_key(&mut tree, "grid.resolution=64").unwrap();
        change_key(&mut tree, "morph.method=linear").unwrap();
        change_key(&mut tree, "features[0].morph.t=\"t^2\"").unwrap();
        assert_eq!(tree["grid"]["resolution"].as_integer(), Some(64));
        assert_eq!(tree["morph"]["method"].as_str(), Some("linear"));
        assert_eq!(tree["features"][0]["morph"]["t"].as_str(), Some("t^2"));
        for bad in ["grid", "features[1].name=x", "features[x].name=x", "grid.resolution.a=1"] {
            assert!(change_key(&mut tree, bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn results_stay_in_their_folder() {
        assert!(stays_inside("a/{name}.stl") && stays_inside("./a.stl"));
        assert!(!stays_inside("../a.stl") && !stays_inside("/tmp/a.stl"));
    }
}
