//! Choosing what each feature of a hybrid does, tried on coarse samples (GRAFT.md, pitfalls).
//!
//! The shapes are looked up once a time in the hybrid's frames; what features of one kind may do is
//! then tried by arithmetic on these values: is the hybrid one piece, does it stand, is its volume
//! that of its parents. The same plan always gives the same choice.

mod options;
mod stage;

#[cfg(test)]
mod tests;

use super::metamorphosis::Metamorphosis;
use super::plan::{Course, Inner, MorphError, Plan};
use crate::job::{self, Cancelled, Job};
use options::Kin;
use rayon::prelude::*;
use stage::Stage;

/// What hybrids are to look like.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Style {
    /// An in-between everywhere.
    #[default]
    Average,
    /// Whole parts of one shape or the other; of a pair they change places one after another.
    Swap,
    /// The lesser shapes grow out of the dominant one.
    Grow,
    /// The lesser shapes shrink towards the dominant one.
    Erode,
}

/// What was chosen for a feature.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The feature's name.
    pub feature: String,
    /// Its morphing function; none when it is the whole morph's.
    pub inner: Option<Inner>,
    /// Its shape weights.
    pub morph: Course,
}

/// What a hybrid looked like on the coarse samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outlook {
    /// The time.
    pub t: f64,
    /// Share of the largest piece in the volume.
    pub largest: f64,
    /// Volume over the weighted mean of the shapes' volumes.
    pub volume: f64,
    /// Feet that should stand on the floor and do not.
    pub lame: usize,
}

/// A choice for every feature, and what is to be expected of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Tuning {
    /// One a feature, in their order.
    pub choices: Vec<Choice>,
    /// One a time tried.
    pub outlook: Vec<Outlook>,
    /// How many combinations were tried.
    pub tried: usize,
}

/// Cells along the longest side of the coarse samples.
const CELLS: f64 = 80.0;
/// Times at which a pair is tried.
const TIMES: [f64; 3] = [0.25, 0.5, 0.75];
/// Share of the largest piece from which on the rest is crumbs.
const WHOLE: f64 = 0.995;
/// Volumes over the mean volume that need no other choice.
const FINE_VOLUME: std::ops::Range<f64> = 0.8..1.3;
/// Natural logarithm of the volume ratio that costs nothing.
const FREE_RATIO: f64 = 0.1;

/// Chooses what the features of a plan do; `volumes` are those of its shapes, mm³. A plan without
/// features has nothing to choose.
///
/// # Errors
/// A plan that cannot be carried out; cancelled.
pub fn tune(
    plan: &Plan,
    style: Style,
    volumes: &[f64],
    job: &dyn Job,
) -> Result<Tuning, MorphError> {
    job.stage("search");
    let moving = plan.features.iter().any(|f| matches!(f.morph, Course::Pair(_)));
    let morph = Metamorphosis::new(plan.clone())?;
    let times: &[f64] = if moving { &TIMES } else { &TIMES[..1] };
    let looked = times.iter().map(|&t| Stage::new(&morph, t, CELLS, job));
    let mut stages = looked.collect::<Result<Vec<_>, _>>()?;
    let kins = options::kins(plan, style, &stages);
    for stage in &mut stages {
        stage.measure(&kins, plan, volumes, job)?;
    }
    let mut candidates = options::candidates(&kins);
    let judge = |c: &Vec<usize>| {
        job::check(job)?;
        let outlook: Vec<_> = stages.par_iter().map(|s| s.judge(&kins, c)).collect();
        Ok((cost(&outlook) + options::bias(&kins, c), outlook))
    };
    let first = candidates.first().map(judge).transpose()?;
    if first.as_ref().is_some_and(|(_, outlook)| outlook.iter().all(Outlook::fine)) {
        // the preferred combination has nothing wrong with it
        candidates.truncate(1);
    }
    let others = candidates.par_iter().skip(1).map(judge).collect::<Result<Vec<_>, Cancelled>>()?;
    let judged: Vec<_> = first.into_iter().chain(others).collect();
    let best = judged.iter().enumerate().min_by(|a, b| a.1.0.total_cmp(&b.1.0));
    let (best, outlook) = best.map_or((0, Vec::new()), |(i, (_, o))| (i, o.clone()));
    let choices = candidates.get(best).map_or_else(Vec::new, |c| chosen(plan, &kins, c));
    Ok(Tuning { choices, outlook, tried: candidates.len() })
}

impl Outlook {
    /// Whether it is one standing piece of about the mean volume.
    fn fine(&self) -> bool {
        self.largest >= WHOLE && self.lame == 0 && FINE_VOLUME.contains(&self.volume)
    }
}

/// How far a hybrid is from one standing piece of the mean volume.
fn cost(outlook: &[Outlook]) -> f64 {
    let one = |o: &Outlook| {
        let loose = 1.0 - o.largest;
        let broken = if o.largest < WHOLE { 3.0 } else { 0.0 };
        let volume = if o.volume > 0.0 { o.volume.ln().abs() } else { 10.0 };
        broken + 10.0 * loose + o.lame as f64 + 4.0 * (volume - FREE_RATIO).max(0.0)
    };
    outlook.iter().map(one).sum()
}

fn chosen(plan: &Plan, kins: &[Kin], candidate: &[usize]) -> Vec<Choice> {
    let of = |i: usize| {
        let (n, kin) = kins.iter().enumerate().find(|(_, k)| k.features.contains(&i))?;
        kin.options.get(*candidate.get(n)?)
    };
    let choice = |(i, f): (usize, &super::plan::Feature)| match of(i) {
        Some(o) => Choice {
            feature: f.name.clone(),
            inner: o.inner,
            morph: o.course.clone().unwrap_or_else(|| f.morph.clone()),
        },
        None => Choice { feature: f.name.clone(), inner: f.inner, morph: f.morph.clone() },
    };
    plan.features.iter().enumerate().map(choice).collect()
}
