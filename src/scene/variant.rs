//! One hybrid of a recipe: its plan, and the times at which it is made.

use super::live::LiveShape;
use super::moving::Moving;
use super::rows::Rows;
use super::{pair, plan};
use crate::element::Element;
use crate::field::Shared;
use crate::job::{Job, Quiet};
use crate::morph::{self, Course, Foot, Frames, Moment, Morph, MorphError, Plan, build};
use crate::num::Aabb;
use crate::recipe::{MethodEntry, MorphEntry, Problem, Recipe};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// A hybrid to make.
pub struct Variant {
    /// Its name; empty for a recipe's only one.
    pub name: String,
    /// The method, `auto` decided; of one shape alone, `auto`.
    pub method: MethodEntry,
    /// The times, in the order to make them.
    pub times: Vec<f64>,
    /// Loose pieces below this share of the volume are dropped.
    pub crumbs: f64,
    /// Shapes of the morph, in the order of the plan.
    shapes: Vec<Member>,
    way: Way,
    /// How much of each shape there is, where that is not the mean over the features.
    whole: Option<Course>,
    /// What its results need, mm.
    domain: Aabb,
    /// What was found on the way.
    pub(super) notes: Vec<String>,
}

/// What variants are made from.
pub(super) struct Parts<'a> {
    pub recipe: &'a Recipe,
    /// The folder paths are relative to.
    pub beside: &'a Path,
    pub shapes: &'a [LiveShape],
    /// The meshes of elements, by their key.
    pub meshes: &'a BTreeMap<String, Element>,
    /// Side of a cell, mm.
    pub step: f64,
}

/// A shape of a morph.
struct Member {
    volume: f64,
    moving: Option<Arc<Moving>>,
}

/// How the field of a time is made.
enum Way {
    /// By the methods of `morph`; `dominant` when the frames are those of the shape that weighs most.
    /// `made` of it once: methods keep what they work out for one time for the next.
    Plan { plan: Box<Plan>, dominant: bool, made: Arc<dyn Morph> },
    /// One shape that keeps still.
    Still(Shared),
    /// One shape that moves.
    Moving(Arc<Moving>),
    /// A surface that moves from one shape to the other.
    Pair(Arc<Moving>),
}

impl Variant {
    pub(super) fn new(entry: &MorphEntry, at: &str, parts: &Parts<'_>) -> Result<Self, Problem> {
        let Parts { recipe, shapes, .. } = parts;
        let names = plan::shape_names(entry, recipe, at)?;
        let method = plan::method(entry, &names, recipe, at)?;
        let live: Vec<&LiveShape> =
            names.iter().filter_map(|n| shapes.iter().find(|s| s.name == *n)).collect();
        let mut notes = vec![];
        let words: Vec<&str> = names.iter().map(String::as_str).collect();
        let whole = Rows { entry, names: &words }.chosen();
        let way = match (live.as_slice(), method.surface()) {
            ([shape], _) => alone(shape),
            ([a, b], Some(method)) => {
                let (moving, found) = pair::moving([*a, *b], method, parts, at)?;
                notes = found;
                Way::Pair(Arc::new(moving))
            }
            _ => {
                let plan = plan::plan(entry, method, &live, parts.meshes, recipe, at)?;
                let made = build(plan.clone()).map_err(|e| Problem::new(at, e.to_string()))?;
                let dominant = entry.frames.as_deref() == Some("dominant");
                Way::Plan { plan: Box::new(plan), dominant, made: made.into() }
            }
        };
        let loose = matches!(method, MethodEntry::Graft | MethodEntry::Group);
        let moves = way.moves() || live.iter().any(|s| s.moves());
        let times = times(entry, moves, at)?;
        let member = |s: &&LiveShape| Member { volume: s.volume, moving: s.moving.clone() };
        Ok(Self {
            name: entry.name.clone(),
            method,
            crumbs: recipe.output.crumbs.unwrap_or(if loose { 0.02 } else { 0.0 }),
            domain: domain(&way, &live, &times),
            times,
            shapes: live.iter().map(member).collect(),
            way,
            whole,
            notes,
        })
    }

    /// The morph at `t`: the time matters where a shape moves, or the dominant one gives the frames.
    ///
    /// # Errors
    /// A shape that has no field at this time; cancelled. A plan that cannot be carried out was found
    /// out before.
    pub fn morph(&self, t: f64, job: &dyn Job) -> Result<Box<dyn Morph>, MorphError> {
        let (plan, dominant, made) = match &self.way {
            Way::Still(field) => return Ok(Box::new(Moment(field.clone()))),
            Way::Moving(shape) | Way::Pair(shape) => {
                return Ok(Box::new(Moment(shape.at(t, job)?.exact.clone())));
            }
            Way::Plan { plan, dominant, made } => (plan, *dominant, made),
        };
        if !dominant && self.shapes.iter().all(|s| s.moving.is_none()) {
            return Ok(Box::new(made.clone()));
        }
        let mut plan = Plan::clone(plan);
        for (part, shape) in plan.shapes.iter_mut().zip(&self.shapes) {
            if let Some(moving) = &shape.moving {
                part.field = moving.at(t, job)?.sampled(job)?.0;
            }
        }
        if dominant {
            plan.frames = Frames::Of(heaviest(&plan, t));
        }
        build(plan)
    }

    /// Lets go of what a shape that moves keeps of its last time; the next is made anew.
    pub fn forget(&self) {
        if let Way::Moving(shape) | Way::Pair(shape) = &self.way {
            shape.forget();
        }
    }

    /// Where its shapes' feet should stand at `t`; none where that is not known.
    pub fn feet(&self, t: f64) -> Vec<Foot> {
        match &self.way {
            Way::Plan { plan, dominant: false, .. } => morph::feet(plan, t).unwrap_or_default(),
            _ => Vec::new(),
        }
    }

    /// A box that holds its results at all its times, mm.
    pub fn domain(&self) -> Aabb {
        self.domain
    }

    /// The weighted mean of the shapes' volumes at `t`, mm³: with features the mean over them, by the
    /// weights of the whole where `auto` chose the features'. Not a number where a shape has no field,
    /// and for a shape alone, which has nothing to be compared with.
    pub fn mean_volume(&self, t: f64) -> f64 {
        let volumes: Vec<f64> = self.shapes.iter().map(|s| s.volume_at(t)).collect();
        let plan = match (&self.way, volumes.as_slice()) {
            (Way::Plan { plan, .. }, _) => plan,
            (Way::Pair(_), [a, b]) => return (1.0 - t) * a + t * b,
            _ => return f64::NAN,
        };
        let mean = |c: &Course| -> f64 { c.at(t).iter().zip(&volumes).map(|(w, v)| w * v).sum() };
        match &self.whole {
            Some(whole) => return mean(whole),
            None if plan.features.is_empty() => return mean(&plan.course),
            None => {}
        }
        let sum: f64 = plan.features.iter().map(|f| mean(&f.morph)).sum();
        sum / plan.features.len() as f64
    }
}

impl Member {
    fn volume_at(&self, t: f64) -> f64 {
        let Some(moving) = &self.moving else { return self.volume };
        // the morph at this time has just been made, so this only looks it up
        let found = moving.at(t, &Quiet).and_then(|m| Ok(m.sampled(&Quiet)?));
        found.map_or(f64::NAN, |(_, volume)| volume)
    }
}

impl Way {
    /// Whether the weights depend on time, or the only shape does.
    fn moves(&self) -> bool {
        let pair = |c: &Course| matches!(c, Course::Pair(_));
        match self {
            Self::Still(_) => false,
            Self::Moving(_) | Self::Pair(_) => true,
            Self::Plan { plan, .. } if plan.features.is_empty() => pair(&plan.course),
            Self::Plan { plan, .. } => {
                plan.features.iter().any(|f| pair(&f.morph) || pair(&f.deform))
            }
        }
    }
}

fn alone(shape: &LiveShape) -> Way {
    match (&shape.moving, &shape.exact) {
        (Some(moving), _) => Way::Moving(moving.clone()),
        (None, Some(exact)) => Way::Still(exact.clone()),
        (None, None) => Way::Still(shape.field.clone()),
    }
}

/// The boxes of the fields, and those of what moves, grown by what the features add.
fn domain(way: &Way, live: &[&LiveShape], times: &[f64]) -> Aabb {
    let add = match way {
        Way::Pair(surface) => return surface.bounds_at(times),
        Way::Plan { plan, .. } => plan.features.iter().fold(0.0, |o: f64, f| o.max(f.offset)),
        _ => 0.0,
    };
    let boxes = live.iter().map(|s| s.field.support().hull(s.bounds).grow(add));
    boxes.fold(Aabb::EMPTY, Aabb::hull)
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
fn times(entry: &MorphEntry, moves: bool, at: &str) -> Result<Vec<f64>, Problem> {
    match &entry.t {
        Some(t) if !moves && t.0.len() > 1 => {
            let why =
                "nothing depends on t: no shape moves and the weights are fixed; give one time";
            Err(Problem::new(format!("{at}.t"), why))
        }
        _ => Ok(asked(entry)),
    }
}

/// The times an entry asks for.
pub(super) fn asked(entry: &MorphEntry) -> Vec<f64> {
    entry.t.as_ref().map_or(vec![0.5], |t| t.0.clone())
}
