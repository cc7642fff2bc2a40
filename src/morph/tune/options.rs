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
}

/// From this distance on (0: the shapes overlap by half or more, 1: by a fifth or less) the mean is
/// no choice: it leaves crossings and islands.
const TOO_FAR: f64 = 0.35;
/// What each step from the preferred option costs.
const STEP: f64 = 0.02;
/// Most combinations that are tried.
const MOST: usize = 20;

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
    let count = kins.len();
    for (n, kin) in kins.iter_mut().enumerate() {
        kin.options = options(plan, kin, style, stages, n, count);
    }
    kins
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
    let plain = |inner: Inner| Choice { inner: Some(inner), course: None };
    // what the user has said stays
    if features().any(|f| f.inner.is_some()) {
        return vec![Choice { inner: features().find_map(|f| f.inner), course: None }];
    }
    let middle = stages.get(stages.len() / 2);
    let apart = middle.map_or(1.0, |s| s.apart(&kin.features));
    let course = features().next().map(|f| &f.morph);
    match (style, course) {
        (Style::Erode, _) => vec![Choice { inner: None, course: None }],
        (Style::Grow, _) => vec![plain(Inner::Grow)],
        (Style::Average, Some(Course::Fixed(row))) if heirs(row) > 2 => {
            // the mean of many leaves crossings and islands where they lie apart
            let mean = (apart < TOO_FAR).then(|| plain(Inner::Mean));
            few(row, n).into_iter().map(|c| merged(Some(c))).chain(mean).collect()
        }
        // the mean loses thin legs and backs of another make, which coarse samples do not tell; merged
        // parts keep them (chair2 x thonet: 2 pieces without arms against one with them)
        (Style::Average, _) => vec![merged(None), plain(Inner::Union)],
        (Style::Swap, Some(Course::Fixed(row))) => {
            few(row, n).into_iter().filter(alone).map(|c| merged(Some(c))).collect()
        }
        (Style::Swap, Some(Course::Pair(Ease::Power(p)))) if *p == 1.0 => {
            (0..count).map(|place| merged(Some(window(place, count)))).collect()
        }
        (Style::Swap, _) => vec![merged(None)],
    }
}

fn merged(course: Option<Course>) -> Choice {
    Choice { inner: Some(Inner::Merge), course }
}

/// Shapes with a share.
fn heirs(row: &[f64]) -> usize {
    row.iter().filter(|w| **w > 0.0).count()
}

fn alone(course: &Course) -> bool {
    matches!(course, Course::Fixed(row) if heirs(row) == 1)
}

/// Rows of one or two of the heaviest shapes; among equals each kind begins with another.
fn few(row: &[f64], n: usize) -> Vec<Course> {
    let k = row.len();
    let mut order: Vec<usize> = (0..k).filter(|&j| row[j] > 0.0).collect();
    let turn = |j: usize| (j + k - n % k) % k;
    order.sort_by(|&a, &b| row[b].total_cmp(&row[a]).then(turn(a).cmp(&turn(b))));
    order.truncate(3);
    let only = |of: &[usize]| {
        Course::Fixed((0..k).map(|j| if of.contains(&j) { row[j] } else { 0.0 }).collect())
    };
    let mut rows: Vec<Course> = order.iter().map(|&j| only(&[j])).collect();
    if let [a, b, ..] = order[..] {
        rows.push(only(&[a, b]));
    }
    rows
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

/// The combinations to try: an option a kind.
pub(super) fn candidates(kins: &[Kin]) -> Vec<Vec<usize>> {
    let windows = kins.iter().all(Kin::has_windows);
    let mut all: Vec<Vec<usize>> = vec![Vec::new()];
    for kin in kins {
        let longer = all.iter().flat_map(|c| {
            // each kind has a window of its own
            let free = |o: &usize| !(windows && c.contains(o));
            let next = |o: usize| c.iter().copied().chain([o]).collect::<Vec<_>>();
            (0..kin.options.len()).filter(free).map(next).collect::<Vec<_>>()
        });
        all = longer.collect();
        // the first options are the preferred ones: few kinds keep them all
        all.sort_by_key(|c| c.iter().sum::<usize>());
        all.truncate(MOST);
    }
    all
}

impl Kin {
    /// Whether the options are windows of time.
    fn has_windows(&self) -> bool {
        let moves = |c: &Choice| matches!(c.course, Some(Course::Pair(_)));
        !self.options.is_empty() && self.options.iter().all(moves)
    }
}

/// What the choice of options costs by itself.
pub(super) fn bias(kins: &[Kin], candidate: &[usize]) -> f64 {
    let weigh = |(kin, &o): (&Kin, &usize)| if kin.has_windows() { 0.0 } else { o as f64 * STEP };
    kins.iter().zip(candidate).map(weigh).sum()
}
