//! `auto`: features suggested where a recipe has none, and what they do chosen by a search.

use super::live::Exact;
use super::{SceneError, plan, suggest};
use crate::job::Job;
use crate::morph::{self, Choice, Course, Inner, Outlook, Plan, Style, Tuning};
use crate::parts::{Guess, Note, Paired};
use crate::recipe::{
    FeatureMorph, InnerEntry, MethodEntry, MorphEntry, Recipe, Source, StyleEntry, TimeFn, Weights,
};
use crate::weight::Ease;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Loose pieces below this share of the volume are dropped: a leg of a chair has more.
pub(super) const CRUMBS: f64 = 0.005;

/// What a search chose for a hybrid.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Search {
    /// The hybrid's name, empty for a recipe's only one.
    pub hybrid: String,
    /// What it was to look like.
    pub style: StyleEntry,
    /// How many combinations were tried.
    pub tried: usize,
    /// What each feature does.
    pub features: BTreeMap<String, FeatureMorph>,
    /// Rows of weights that were chosen.
    pub weights: Weights,
    /// What was seen at coarse cells: time, share of the largest piece, volume over the mean volume,
    /// feet that do not reach the floor.
    pub seen: Vec<Seen>,
}

/// A hybrid at coarse cells.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Seen {
    /// The time.
    pub t: f64,
    /// Share of the largest piece in the volume.
    pub largest: f64,
    /// Volume over the mean volume.
    pub volume: f64,
    /// Feet that do not reach the floor.
    pub lame: usize,
}

impl From<&Outlook> for Seen {
    fn from(o: &Outlook) -> Self {
        Self { t: o.t, largest: o.largest, volume: o.volume, lame: o.lame }
    }
}

/// A recipe with the features it needs.
pub(super) struct Featured {
    pub recipe: Recipe,
    /// What was found, in words.
    pub found: Vec<String>,
    /// Fields of shapes, made on the way: before these were turned and shifted.
    pub ready: BTreeMap<String, Exact>,
}

/// Gives a recipe whose `auto` has no features those that are suggested, and its shapes their poses. A
/// recipe that needs none is left as it is.
///
/// # Errors
/// A shape that cannot be read; cancelled.
pub(super) fn with_features(
    mut recipe: Recipe,
    source: &Source,
    beside: &Path,
    job: &dyn Job,
) -> Result<Featured, SceneError> {
    let plain = |recipe, found| Featured { recipe, found, ready: BTreeMap::new() };
    let wanted = wanting(&recipe).map_err(|p| source.locate(p))?;
    let surface = |n: &String| recipe.shapes[n].surface.is_some();
    if !recipe.features.is_empty() || wanted.is_empty() {
        return Ok(plain(recipe, Vec::new()));
    }
    if wanted.iter().any(surface) {
        let why = "auto: no parts are sought on surfaces; space-time instead";
        whole(&mut recipe);
        return Ok(plain(recipe, vec![why.to_owned()]));
    }
    let entries = wanted.iter().map(|n| (n.clone(), recipe.shapes[n].clone())).collect();
    let looked =
        suggest::look(entries, beside, &recipe.grid, job).map_err(|e| relocate(e, source))?;
    let mut suggestion = looked.suggestion;
    // what most of many have not belongs, with those that have it, to the part it is nearest to
    let rare = |f: &Paired| match &f.note {
        Note::Absent(without) => wanted.len() > 2 && 2 * without.len() > wanted.len(),
        _ => false,
    };
    suggestion.features.retain(|f| !rare(f));
    let mut found: Vec<String> = suggestion.shapes.iter().map(words).collect();
    if suggestion.shapes.iter().any(|g| g.chair.is_none()) {
        found.push("auto: no parts of a chair to pair; space-time instead".to_owned());
        whole(&mut recipe);
        return Ok(plain(recipe, found));
    }
    let names = looked.shapes.iter().map(|(name, _)| name.clone());
    let ready = names.zip(looked.made).filter_map(|(name, made)| Some((name, made?))).collect();
    recipe.shapes.extend(looked.shapes);
    recipe.features = suggest::features(&suggestion);
    Ok(Featured { recipe, found, ready })
}

/// What `auto` is where no parts are found.
fn whole(recipe: &mut Recipe) {
    let auto = |e: &MorphEntry| e.method == Some(MethodEntry::Auto);
    let Recipe { morph, hybrids, .. } = recipe;
    if auto(morph) || morph.method.is_none() {
        morph.method = Some(MethodEntry::SpaceTime);
    }
    for h in hybrids.iter_mut().filter(|h| auto(h)) {
        h.method = Some(MethodEntry::SpaceTime);
    }
}

/// An error of a shape alone, with its line in the recipe.
fn relocate(e: SceneError, source: &Source) -> SceneError {
    match e {
        SceneError::Bad(b) => source.locate(crate::recipe::Problem::new(b.at, b.why)).into(),
        other => other,
    }
}

/// The shapes of all hybrids whose method is auto.
fn wanting(recipe: &Recipe) -> Result<BTreeSet<String>, crate::recipe::Problem> {
    let mut names = BTreeSet::new();
    for (at, entry) in recipe.variants() {
        if entry.method.unwrap_or_default() == MethodEntry::Auto {
            let of = plan::shape_names(&entry, recipe, &at)?;
            if of.len() > 1 {
                names.extend(of);
            }
        }
    }
    Ok(names)
}

fn words(guess: &Guess) -> String {
    let found = guess.chair.as_ref().map_or_else(|| "no chair".to_owned(), |c| c.words());
    format!("{}: {found} (confidence {:.2})", guess.name, guess.confidence)
}

/// The entry with what the search chose, and the search's account.
pub(super) fn searched(
    entry: &MorphEntry,
    plan: &Plan,
    volumes: &[f64],
    job: &dyn Job,
) -> Result<(MorphEntry, Search), morph::MorphError> {
    let wanted = entry.style.unwrap_or_default();
    let style = match wanted {
        StyleEntry::Average => Style::Average,
        StyleEntry::Swap => Style::Swap,
        StyleEntry::Grow => Style::Grow,
        StyleEntry::Erode => Style::Erode,
    };
    let whole = match style {
        Style::Average | Style::Swap => Inner::Merge,
        Style::Grow => Inner::Grow,
        Style::Erode => Inner::Erode,
    };
    let mut plan = plan.clone();
    plan.inner = whole;
    let tuning = morph::tune(&plan, style, volumes, job)?;
    let names: Vec<&str> = plan.shapes.iter().map(|s| s.name.as_str()).collect();
    let mut chosen = MorphEntry {
        method: Some(if names.len() == 2 { MethodEntry::Graft } else { MethodEntry::Group }),
        style: None,
        inner: Some(name_of(whole)),
        ..entry.clone()
    };
    let pairs = plan.features.iter().zip(&tuning.choices);
    for (feature, choice) in pairs {
        choose(&mut chosen, choice, &feature.morph, whole, &names);
    }
    if chosen.weights != entry.weights && !chosen.deform_weights.contains_key("default") {
        // the frames stay those of all shapes
        let row = row(&names, &plan.course.at(0.0));
        chosen.deform_weights.insert("default".to_owned(), row);
    }
    let search = account(&chosen, entry, wanted, &tuning);
    Ok((chosen, search))
}

fn account(chosen: &MorphEntry, asked: &MorphEntry, style: StyleEntry, tuning: &Tuning) -> Search {
    let new = |(name, _): &(&String, &BTreeMap<String, f64>)| !asked.weights.contains_key(*name);
    let weights = chosen.weights.iter().filter(new).map(|(n, r)| (n.clone(), r.clone()));
    let default = chosen.inner;
    let features = tuning.choices.iter().map(|c| {
        let mut part = chosen.parts.get(&c.feature).cloned().unwrap_or_default();
        part.inner = part.inner.or(default);
        (c.feature.clone(), part)
    });
    Search {
        hybrid: chosen.name.clone(),
        style,
        tried: tuning.tried,
        features: features.collect(),
        weights: weights.collect(),
        seen: tuning.outlook.iter().map(Seen::from).collect(),
    }
}

/// Writes a choice into an entry, where it differs from what would be without it.
fn choose(entry: &mut MorphEntry, choice: &Choice, was: &Course, whole: Inner, names: &[&str]) {
    let inner = choice.inner.filter(|i| *i != whole).map(name_of);
    let mut part = FeatureMorph { inner, ..FeatureMorph::default() };
    match &choice.morph {
        same if same == was => {}
        Course::Pair(ease) => part.t = Some(TimeFn(Ease::clone(ease))),
        Course::Fixed(weights) => {
            entry.weights.insert(choice.feature.clone(), row(names, weights));
        }
    }
    if part != FeatureMorph::default() {
        let old = entry.parts.get(&choice.feature).cloned().unwrap_or_default();
        entry.parts.insert(choice.feature.clone(), part.over(&old));
    }
}

/// A row of weights by name, without those that are nought.
fn row(names: &[&str], weights: &[f64]) -> BTreeMap<String, f64> {
    let some = names.iter().zip(weights).filter(|(_, w)| **w > 0.0);
    some.map(|(n, w)| ((*n).to_owned(), *w)).collect()
}

fn name_of(inner: Inner) -> InnerEntry {
    match inner {
        Inner::Linear => InnerEntry::Linear,
        Inner::SpaceTime => InnerEntry::SpaceTime,
        Inner::Grow => InnerEntry::Grow,
        Inner::Erode => InnerEntry::Erode,
        Inner::Auto => InnerEntry::Auto,
        Inner::Mean => InnerEntry::Mean,
        Inner::Merge => InnerEntry::Merge,
        Inner::Union => InnerEntry::Union,
    }
}
