//! Stretchers: bars between the legs of a chair.

use super::legs::Track;
use super::mask::Mask;
use super::volume::Volume;
use glam::{DVec2, DVec3};

/// A bar between two legs, or between two other bars, in samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bar {
    pub side: Side,
    pub from: DVec3,
    pub to: DVec3,
    pub radius: f64,
}

/// Where a stretcher is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Side {
    /// Between the front legs.
    Front,
    /// Between the left legs.
    Left,
    /// Between the right legs.
    Right,
    /// Between the back legs.
    Back,
    /// From the left stretcher to the right one.
    Middle,
}

/// How far a bar may stray from the line between its ends, samples.
const STRAY: f64 = 1.5;
/// Share of a bar's length that must be there. Higher, thin turned bars are missed; lower, what
/// stands between the legs counts as a bar.
const COVER: f64 = 0.85;
/// Most height of a bar, a share of the base's: what is higher is a panel.
const HIGH: f64 = 0.16;

/// The bars between four legs, given as front left, front right, back left, back right, from the
/// lowest up on each side.
pub(super) fn find(v: &Volume, legs: [&Track; 4], floor: usize, under: usize) -> Vec<Bar> {
    let first = floor + 2;
    if under < first + 4 {
        return Vec::new();
    }
    // a bar that slopes by a level or two is still one
    let sections: Vec<Mask> =
        (first..under).map(|k| v.sections(k - 1..k + 2).dilated(STRAY)).collect();
    let most = (HIGH * (under - floor) as f64).max(3.0);
    let ends = |a: &Track, b: &Track| {
        let (a, b) = (a.clone(), b.clone());
        move |k: f64| [a.point(k), b.point(k)]
    };
    let [fl, fr, bl, br] = legs;
    let mut all = Vec::new();
    all.extend(bars(&sections, first, most, Side::Front, ends(fl, fr)));
    all.extend(bars(&sections, first, most, Side::Left, ends(fl, bl)));
    all.extend(bars(&sections, first, most, Side::Right, ends(fr, br)));
    all.extend(bars(&sections, first, most, Side::Back, ends(bl, br)));
    let middle = |k: f64| [0.5 * (fl.point(k) + bl.point(k)), 0.5 * (fr.point(k) + br.point(k))];
    let beside = all.iter().any(|b| b.side == Side::Left);
    if beside {
        all.extend(bars(&sections, first, most, Side::Middle, middle));
    }
    all
}

/// Bars whose ends are known at every level.
fn bars(
    sections: &[Mask],
    first: usize,
    most: f64,
    side: Side,
    ends: impl Fn(f64) -> [DVec2; 2],
) -> Vec<Bar> {
    let there: Vec<bool> = sections
        .iter()
        .enumerate()
        .map(|(i, m)| cover(m, ends((first + i) as f64)) >= COVER)
        .collect();
    let mut all = Vec::new();
    let mut start = None;
    for (i, on) in there.iter().enumerate() {
        match (on, start) {
            (true, None) => start = Some(i),
            (false, Some(s)) => {
                // each level looks one up and one down
                let high = (i - s) as f64 - 2.0;
                if high <= most && s > 0 {
                    let level = first as f64 + 0.5 * (s + i - 1) as f64;
                    let [a, b] = ends(level);
                    let radius = 0.5 * high.max(1.0);
                    all.push(Bar { side, from: a.extend(level), to: b.extend(level), radius });
                }
                start = None;
            }
            _ => {}
        }
    }
    all
}

/// Share of the middle half of a segment that is solid.
fn cover(section: &Mask, [a, b]: [DVec2; 2]) -> f64 {
    let n = a.distance(b).ceil().max(4.0) as usize;
    let on = (0..=n)
        .map(|i| a.lerp(b, 0.2 + 0.6 * i as f64 / n as f64).round())
        .filter(|p| p.min_element() >= 0.0 && section.get(p.x as usize, p.y as usize))
        .count();
    on as f64 / (n + 1) as f64
}
