//! One hybrid of a recipe: its plan, and the times at which it is made.

use super::live::LiveShape;
use super::plan;
use crate::element::Element;
use crate::morph::{Course, Frames, Morph, MorphError, Plan, build};
use crate::recipe::{MethodEntry, MorphEntry, Problem, Recipe};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A hybrid to make.
pub struct Variant {
    /// Its name; empty for a recipe's only one.
    pub name: String,
    /// The method, `auto` decided.
    pub method: MethodEntry,
    /// The times, in the order to make them.
    pub times: Vec<f64>,
    /// Loose pieces below this share of the volume are dropped.
    pub crumbs: f64,
    /// Volumes of its shapes, mm³, in the order of the plan.
    volumes: Vec<f64>,
    plan: Plan,
    /// Made of the plan, once: methods keep what they work out for one time for the next.
    morph: Arc<dyn Morph>,
    /// Whether the frames are those of the shape that weighs most.
    dominant: bool,
}

impl Variant {
    pub(super) fn new(
        entry: &MorphEntry,
        at: &str,
        shapes: &[LiveShape],
        meshes: &BTreeMap<String, Element>,
        recipe: &Recipe,
    ) -> Result<Self, Problem> {
        let names = plan::shape_names(entry, at)?;
        let method = plan::method(entry, names.len(), recipe, at)?;
        let live: Vec<&LiveShape> =
            names.iter().filter_map(|n| shapes.iter().find(|s| s.name == *n)).collect();
        let plan = plan::plan(entry, method, &live, meshes, recipe, at)?;
        let morph = build(plan.clone()).map_err(|e| Problem::new(at, e.to_string()))?.into();
        let loose = matches!(method, MethodEntry::Graft | MethodEntry::Group);
        Ok(Self {
            name: entry.name.clone(),
            method,
            times: times(entry, &plan, at)?,
            crumbs: recipe.output.crumbs.unwrap_or(if loose { 0.02 } else { 0.0 }),
            volumes: live.iter().map(|s| s.volume).collect(),
            dominant: entry.frames.as_deref() == Some("dominant"),
            plan,
            morph,
        })
    }

    /// The morph at `t`; the time matters where the dominant shape gives the frames.
    ///
    /// # Errors
    /// A plan that cannot be carried out; checked before, so not in a scene.
    pub fn morph(&self, t: f64) -> Result<Box<dyn Morph>, MorphError> {
        if !self.dominant {
            return Ok(Box::new(self.morph.clone()));
        }
        let mut plan = self.plan.clone();
        plan.frames = Frames::Of(heaviest(&plan, t));
        build(plan)
    }

    /// The weighted mean of the shapes' volumes at `t`, mm³; with features, the mean over them.
    pub fn mean_volume(&self, t: f64) -> f64 {
        let mean =
            |c: &Course| -> f64 { c.at(t).iter().zip(&self.volumes).map(|(w, v)| w * v).sum() };
        if self.plan.features.is_empty() {
            return mean(&self.plan.course);
        }
        let sum: f64 = self.plan.features.iter().map(|f| mean(&f.morph)).sum();
        sum / self.plan.features.len() as f64
    }
}

/// The shape with the largest weight over all features; the first of equals.
fn heaviest(plan: &Plan, t: f64) -> usize {
    let mut sum = vec![0.0; plan.shapes.len()];
    let mut add = |c: &Course| sum.iter_mut().zip(c.at(t)).for_each(|(s, w)| *s += w);
    plan.features.iter().for_each(|f| add(&f.deform));
    if plan.features.is_empty() {
        add(&plan.course);
    }
    let mut best = 0;
    for (j, s) in sum.iter().enumerate() {
        if *s > sum[best] + 1e-12 {
            best = j;
        }
    }
    best
}

/// The times asked for; one is enough where nothing depends on t.
fn times(entry: &MorphEntry, plan: &Plan, at: &str) -> Result<Vec<f64>, Problem> {
    let moves = |c: &Course| matches!(c, Course::Pair(_));
    let moving = if plan.features.is_empty() {
        moves(&plan.course)
    } else {
        plan.features.iter().any(|f| moves(&f.morph) || moves(&f.deform))
    };
    match &entry.t {
        None => Ok(vec![0.5]),
        Some(t) if !moving && t.0.len() > 1 => {
            let why = "nothing depends on t, the weights are fixed; remove it or the weights";
            Err(Problem::new(format!("{at}.t"), why))
        }
        Some(t) => Ok(t.0.clone()),
    }
}
