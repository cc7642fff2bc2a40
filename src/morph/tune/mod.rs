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
use std::collections::BTreeMap;

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
    /// How much more of its parts than its weight a shape gives at most, in [0, 1].
    pub lean: f64,
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
const CELLS: f64 = 92.0;
/// Times at which a pair is tried: close enough that no part comes loose between them unseen.
const TIMES: [f64; 7] = [0.1, 0.25, 0.4, 0.5, 0.6, 0.75, 0.9];
/// Share of the largest piece from which on the rest is crumbs.
const WHOLE: f64 = 0.995;
/// Natural logarithm of the volume ratio that costs nothing.
const FREE_RATIO: f64 = 0.1;
/// What it costs to be in pieces.
const BROKEN: f64 = 5.0;
/// What a natural logarithm beyond that costs, and more beyond this.
const VOLUME: f64 = 4.0;
const FAR_RATIO: f64 = 0.22;
const FAR: f64 = 12.0;
/// The volume on coarse samples where the mesh has the mean volume: samples make thin parts thicker.
const USUAL: f64 = 1.06;
/// How far a hybrid may lean to one shape at no cost.
const FREE_LEAN: f64 = 0.2;
/// Most steps of the search.
const STEPS: usize = 12;

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
    let judge = |c: &[usize]| {
        job::check(job)?;
        let outlook: Vec<_> = stages.par_iter().map(|s| s.judge(&kins, c)).collect();
        Ok((cost(&outlook) + options::bias(&kins, c), outlook))
    };
    let (best, outlook, tried) = if options::windows(style, &kins) {
        best_of(&options::orders(&kins), &judge)?
    } else {
        descent(&kins, &judge)?
    };
    Ok(Tuning { choices: chosen(plan, &kins, &best), outlook, tried })
}

/// What a combination costs, and what it looks like.
type Judged = Result<(f64, Vec<Outlook>), Cancelled>;
/// A combination, what it looks like, and how many were tried.
type Found = Result<(Vec<usize>, Vec<Outlook>, usize), Cancelled>;

/// The best of some combinations; the first of equals.
fn best_of(all: &[Vec<usize>], judge: &(impl Fn(&[usize]) -> Judged + Sync)) -> Found {
    let judged = all.par_iter().map(|c| judge(c)).collect::<Result<Vec<_>, _>>()?;
    let best = judged.iter().zip(all).min_by(|a, b| a.0.0.total_cmp(&b.0.0));
    let (outlook, best) = best.map_or_else(Default::default, |((_, o), c)| (o.clone(), c.clone()));
    Ok((best, outlook, all.len()))
}

/// From what is preferred, and from parts taken in turns, the best change of one kind after the other as
/// long as it is better.
fn descent(kins: &[Kin], judge: &(impl Fn(&[usize]) -> Judged + Sync)) -> Found {
    let mut known = BTreeMap::new();
    let mut found: Option<(Vec<usize>, f64)> = None;
    for mut best in options::starts(kins) {
        let mut cost = least(&mut known, vec![best.clone()], judge)?.map_or(f64::MAX, |(_, c)| c);
        for _ in 0..STEPS {
            match least(&mut known, options::neighbours(kins, &best), judge)? {
                Some((candidate, less)) if less < cost => (cost, best) = (less, candidate),
                _ => break,
            }
        }
        if found.as_ref().is_none_or(|(_, least)| cost < *least) {
            found = Some((best, cost));
        }
    }
    let best = found.map_or_else(Vec::new, |(best, _)| best);
    let tried = known.len();
    let outlook = known.remove(&best).map_or_else(Vec::new, |(_, outlook)| outlook);
    Ok((best, outlook, tried))
}

/// The best of some combinations, the first of equals; those not known yet are judged.
fn least(
    known: &mut BTreeMap<Vec<usize>, (f64, Vec<Outlook>)>,
    all: Vec<Vec<usize>>,
    judge: &(impl Fn(&[usize]) -> Judged + Sync),
) -> Result<Option<(Vec<usize>, f64)>, Cancelled> {
    let new: Vec<&Vec<usize>> = all.iter().filter(|c| !known.contains_key(*c)).collect();
    let judged = new.par_iter().map(|c| Ok(((*c).clone(), judge(c)?)));
    let judged = judged.collect::<Result<Vec<_>, Cancelled>>()?;
    known.extend(judged);
    let cost = |c: Vec<usize>| known.get(&c).map(|(cost, _)| (c, *cost));
    Ok(all.into_iter().filter_map(cost).min_by(|a, b| a.1.total_cmp(&b.1)))
}

/// How far a hybrid is from one standing piece of the mean volume that does not jump, the mean over the
/// times.
fn cost(outlook: &[Outlook]) -> f64 {
    let one = |o: &Outlook| {
        let loose = 1.0 - o.largest;
        let broken = if o.largest < WHOLE { BROKEN } else { 0.0 };
        let volume = if o.volume > 0.0 { (o.volume / USUAL).ln().abs() } else { 10.0 };
        let volume = VOLUME * (volume - FREE_RATIO).max(0.0) + FAR * (volume - FAR_RATIO).max(0.0);
        let lean = 2.0 * (o.lean - FREE_LEAN).max(0.0);
        broken + 10.0 * loose + o.lame as f64 + volume + lean
    };
    let jump = |o: &[Outlook]| {
        let by = (o[1].volume.max(1e-3) / o[0].volume.max(1e-3)).ln().abs();
        2.0 * (by - FREE_RATIO).max(0.0)
    };
    let jumps: f64 = outlook.windows(2).map(jump).sum();
    (outlook.iter().map(one).sum::<f64>() + jumps) / outlook.len().max(1) as f64
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
