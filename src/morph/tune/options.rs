//! Features of one kind, what they may do, and the combinations tried.

use super::Style;
use super::stage::Stage;
use crate::morph::plan::{Course, Inner, Plan};
use crate::weight::Ease;

/// Features that do the same: the legs, both arms.
pub(super) struct Kin {
    /// By index in the plan.
    pub features: Vec<usize>,
    /// What they may do, the preferred first.
    pub options: Vec<Choice>,
}

/// What features of one kind may do.
pub(super) struct Choice {
    /// Their function; none when the whole morph's is theirs.
    pub inner: Option<Inner>,
    /// Their weights, where they are not those of the plan.
    pub course: Option<Course>,
    /// What it costs by itself.
    pub cost: f64,
}

/// From this distance on (0: the shapes overlap by half or more, 1: by a fifth or less) the mean is
/// no choice: it leaves crossings and islands.
const TOO_FAR: f64 = 0.35;
/// What each step from the preferred option costs.
const STEP: f64 = 0.02;
/// What it costs to merge parts that do not overlap: both are there, beside each other.
const BESIDE: f64 = 0.3;
/// What it costs to change a part in one half of the time.
const HALF: f64 = 0.1;
/// Most orders of windows that are tried.
const MOST: usize = 20;
/// Most shapes that a part is taken from alone.
const HEAVIEST: usize = 4;
/// Of these the first, each with each, are merged too.
const PAIRED: usize = 2;

/// Words that tell features of one kind apart.
const SIDES: [&str; 6] = ["left", "right", "front", "back", "rear", "middle"];

/// What is left of a feature's name without its side; the whole name where nothing is.
fn kind(name: &str) -> String {
    let side = |w: &&str| !SIDES.contains(w) && w.parse::<u32>().is_err();
    let words = name.split([' ', '-', '_']).filter(side).collect::<Vec<_>>().join(" ");
    if words.is_empty() { name.to_owned() } else { words }
}

/// The kinds of features, in the order of the plan, and what each may do.
pub(super) fn kins(plan: &Plan, style: Style, stages: &[Stage]) -> Vec<Kin> {
    let mut names: Vec<String> = Vec::new();
    let mut kins: Vec<Kin> = Vec::new();
    for (i, f) in plan.features.iter().enumerate() {
        let name = kind(&f.name);
        match names.iter().position(|n| *n == name) {
            Some(n) => kins[n].features.push(i),
            None => {
                names.push(name);
                kins.push(Kin { features: vec![i], options: Vec::new() });
            }
        }
    }
    let middle = stages.get(stages.len() / 2);
    if let (Some(stage), Style::Average | Style::Swap, 2) = (middle, style, plan.shapes.len()) {
        kins = joined(kins, stage);
    }
    let count = kins.len();
    for (n, kin) in kins.iter_mut().enumerate() {
        kin.options = options(plan, kin, style, stages, n, count);
        if let (Some(stage), Style::Average) = (middle, style) {
            keep_half_way(kin, stage);
        }
    }
    kins
}

/// Parts that one shape of two has alone go with the part of it that they hold on to most: arms with the
/// back they end in.
fn joined(kins: Vec<Kin>, stage: &Stage) -> Vec<Kin> {
    let alone = |k: &Kin| stage.owner(&k.features);
    let to: Vec<Option<usize>> = (0..kins.len())
        .map(|n| {
            let shape = alone(&kins[n])?;
            let hold = |m: &usize| stage.seam(shape, &kins[n].features, &kins[*m].features);
            let whole = (0..kins.len()).filter(|&m| alone(&kins[m]).is_none());
            whole.max_by(|a, b| hold(a).total_cmp(&hold(b)))
        })
        .collect();
    let mut all: Vec<Option<Kin>> = kins.into_iter().map(Some).collect();
    for (n, to) in to.iter().enumerate() {
        if let Some(m) = *to
            && let Some(part) = all[n].take()
            && let Some(Some(whole)) = all.get_mut(m)
        {
            whole.features.extend(part.features);
        }
    }
    all.into_iter().flatten().collect()
}

/// Leaves out what would take a part away half way that only one shape of two has.
fn keep_half_way(kin: &mut Kin, stage: &Stage) {
    let owners: Vec<usize> = kin.features.iter().filter_map(|&i| stage.owner(&[i])).collect();
    let there = |o: &Choice| match &o.course {
        Some(Course::Pair(ease)) => {
            let u = ease.at(0.5);
            owners.iter().all(|&j| [1.0 - u, u][j] >= 0.5)
        }
        _ => true,
    };
    if kin.options.iter().any(there) {
        kin.options.retain(there);
    }
}

fn options(
    plan: &Plan,
    kin: &Kin,
    style: Style,
    stages: &[Stage],
    n: usize,
    count: usize,
) -> Vec<Choice> {
    let features = || kin.features.iter().filter_map(|&i| plan.features.get(i));
    let plain = |inner: Inner, cost: f64| Choice { inner: Some(inner), course: None, cost };
    // what the user has said stays
    if features().any(|f| f.inner.is_some()) {
        let inner = features().find_map(|f| f.inner);
        return vec![Choice { inner, course: None, cost: 0.0 }];
    }
    let middle = stages.get(stages.len() / 2);
    let apart = middle.map_or(1.0, |s| s.apart(&kin.features));
    let owners = middle.map_or_else(Vec::new, |s| s.owners(&kin.features));
    let steps = |options: Vec<Choice>| {
        let step = |(n, o): (usize, Choice)| Choice { cost: o.cost + n as f64 * STEP, ..o };
        options.into_iter().enumerate().map(step).collect()
    };
    let course = features().next().map(|f| &f.morph);
    match (style, course) {
        (Style::Erode, _) => vec![Choice { inner: None, course: None, cost: 0.0 }],
        (Style::Grow, _) => vec![plain(Inner::Grow, 0.0)],
        (Style::Average, Some(Course::Fixed(row))) if heirs(row) > 2 => {
            // the mean of many leaves crossings and islands where they lie apart
            let mean = (apart < TOO_FAR).then(|| plain(Inner::Mean, 0.0));
            let rows = few(row, &owners, n).into_iter().map(|c| merged(Some(c), 0.0));
            steps(rows.chain(mean).collect())
        }
        // the mean loses thin legs and backs of another make, which coarse samples do not tell; merged
        // parts keep them (chair2 x thonet: 2 pieces without arms against one with them)
        (Style::Average, Some(Course::Pair(ease))) if linear(ease) => vec![
            merged(None, BESIDE * apart),
            merged(Some(half(0.0)), HALF),
            merged(Some(half(0.5)), HALF),
            plain(Inner::Union, BESIDE * apart + STEP),
        ],
        (Style::Average, _) => vec![merged(None, 0.0), plain(Inner::Union, STEP)],
        (Style::Swap, Some(Course::Fixed(row))) => {
            let alone = few(row, &owners, n).into_iter().filter(alone);
            steps(alone.map(|c| merged(Some(c), 0.0)).collect())
        }
        (Style::Swap, Some(Course::Pair(ease))) if linear(ease) => {
            (0..count).map(|place| merged(Some(window(place, count)), 0.0)).collect()
        }
        (Style::Swap, _) => vec![merged(None, 0.0)],
    }
}

fn merged(course: Option<Course>, cost: f64) -> Choice {
    Choice { inner: Some(Inner::Merge), course, cost }
}

/// Whether the weights are the time itself: nothing was said of them.
fn linear(ease: &Ease) -> bool {
    matches!(ease, Ease::Power(p) if *p == 1.0)
}

/// Shapes with a share.
fn heirs(row: &[f64]) -> usize {
    row.iter().filter(|w| **w > 0.0).count()
}

fn alone(course: &Course) -> bool {
    matches!(course, Course::Fixed(row) if heirs(row) == 1)
}

/// Rows of one or two of the heaviest shapes that have the part, or that have it not, by which weigh
/// more together; among equals each kind begins with another.
fn few(row: &[f64], owners: &[bool], n: usize) -> Vec<Course> {
    let k = row.len();
    let owns = |j: usize| owners.get(j).copied().unwrap_or(true);
    let weight =
        |there: bool| -> f64 { (0..k).filter(|&j| owns(j) == there).map(|j| row[j]).sum() };
    let there = weight(true) >= weight(false);
    let mut order: Vec<usize> = (0..k).filter(|&j| row[j] > 0.0 && owns(j) == there).collect();
    let turn = |j: usize| (j + k - n % k) % k;
    order.sort_by(|&a, &b| row[b].total_cmp(&row[a]).then(turn(a).cmp(&turn(b))));
    order.truncate(HEAVIEST);
    let only = |of: &[usize]| {
        Course::Fixed((0..k).map(|j| if of.contains(&j) { row[j] } else { 0.0 }).collect())
    };
    let mut rows: Vec<Course> = order.iter().map(|&j| only(&[j])).collect();
    for (n, &a) in order.iter().enumerate().take(PAIRED) {
        rows.extend(order[n + 1..].iter().take(PAIRED - n).map(|&b| only(&[a, b])));
    }
    rows
}

/// The course of a part that changes within the half of the time that begins there.
fn half(from: f64) -> Course {
    let table = if from > 0.0 {
        vec![[0.0, 0.0], [from, 0.0], [1.0, 1.0]]
    } else {
        vec![[0.0, 0.0], [0.5, 1.0], [1.0, 1.0]]
    };
    Course::Pair(Ease::Table(table))
}

/// The course of a part that changes places in the n-th of `count` equal times.
fn window(n: usize, count: usize) -> Course {
    let unit = 1.0 / count as f64;
    let middle = (n as f64 + 0.5) * unit;
    // tidy numbers: they will stand in a recipe
    let at = |t: f64| (t * 1000.0).round() / 1000.0;
    let (from, to) = (at(middle - 0.4 * unit), at(middle + 0.4 * unit));
    Course::Pair(Ease::Table(vec![[0.0, 0.0], [from, 0.0], [to, 1.0], [1.0, 1.0]]))
}

/// The orders in which the kinds may change places, where each has a window of its own.
pub(super) fn orders(kins: &[Kin]) -> Vec<Vec<usize>> {
    let mut all: Vec<Vec<usize>> = vec![Vec::new()];
    for kin in kins {
        let longer = all.iter().flat_map(|c| {
            let free = |o: &usize| !c.contains(o);
            let next = |o: usize| c.iter().copied().chain([o]).collect::<Vec<_>>();
            (0..kin.options.len()).filter(free).map(next).collect::<Vec<_>>()
        });
        all = longer.collect();
        all.truncate(MOST);
    }
    all
}

/// Where the search begins: with what is preferred, and with the options after it in turns.
pub(super) fn starts(kins: &[Kin]) -> Vec<Vec<usize>> {
    let turns = |from: usize| -> Vec<usize> {
        let option = |(n, k): (usize, &Kin)| (1 + (n + from) % 2).min(k.options.len() - 1);
        kins.iter().enumerate().map(option).collect()
    };
    let mut all = vec![vec![0; kins.len()], turns(0), turns(1)];
    all.dedup();
    all
}

/// A combination and all that differ from it in one kind.
pub(super) fn neighbours(kins: &[Kin], from: &[usize]) -> Vec<Vec<usize>> {
    let with = |n: usize, o: usize| {
        let mut c = from.to_vec();
        c[n] = o;
        c
    };
    let others = kins.iter().enumerate().flat_map(|(n, kin)| {
        (0..kin.options.len()).filter(move |&o| o != from[n]).map(move |o| with(n, o))
    });
    others.collect()
}

/// Whether every kind has to have a window of time of its own.
pub(super) fn windows(style: Style, kins: &[Kin]) -> bool {
    let moves = |c: &Choice| matches!(c.course, Some(Course::Pair(_)));
    style == Style::Swap && kins.iter().all(|k| k.options.len() > 1 && k.options.iter().all(moves))
}

/// What the choice of options costs by itself.
pub(super) fn bias(kins: &[Kin], candidate: &[usize]) -> f64 {
    kins.iter().zip(candidate).filter_map(|(kin, &o)| Some(kin.options.get(o)?.cost)).sum()
}
