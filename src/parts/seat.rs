//! The seat: the largest compact level area with room above it, at a height where one sits.

use super::mask::{Mask, Region, median};
use super::volume::Volume;

/// A seat, in samples.
#[derive(Clone, Debug)]
pub(super) struct Seat {
    /// The plan of its upward side.
    pub mask: Mask,
    /// Cells of the plan.
    pub area: f64,
    /// Level of its upward side: the middle one of all cells.
    pub top: f64,
    /// Thickness of the board.
    pub thickness: f64,
    /// The highest level below the seat and all that closes it from beneath (aprons, upholstery).
    pub under: usize,
    /// Score of the best level elsewhere over this one's.
    pub second: f64,
    /// Level of that one.
    pub second_top: f64,
}

/// Room above a seat, a share of the height.
const ROOM: f64 = 0.13;
/// Levels looked at together, a share of the height.
const BAND: f64 = 0.075;
/// Gaps of slats and weave that are closed, samples.
const GAPS: f64 = 2.5;

/// For each plan cell, whether level k is solid with room above.
fn upward(v: &Volume, top: usize, room: usize) -> Vec<Mask> {
    let [nx, ny, _] = v.size;
    let mut free = vec![room; nx * ny];
    let mut all = vec![Mask::empty(nx, ny); top + 1];
    for k in (0..=top).rev() {
        let section = v.section(k);
        for (n, free) in free.iter_mut().enumerate() {
            let (x, y) = (n % nx, n / nx);
            if section.get(x, y) {
                if *free >= room {
                    all[k].set(x, y);
                }
                *free = 0;
            } else {
                *free += 1;
            }
        }
    }
    all
}

/// How likely a seat is at a share of the height; `from_top` is the share above it.
fn prior(z: f64) -> f64 {
    const AT: [(f64, f64); 6] =
        [(0.10, 0.15), (0.22, 0.6), (0.30, 1.0), (0.62, 1.0), (0.78, 0.45), (0.92, 0.1)];
    if 1.0 - z < 0.08 {
        return 1.0; // nothing above: a stool
    }
    let i = AT.iter().position(|(x, _)| *x >= z).unwrap_or(AT.len());
    match i {
        0 => AT[0].1,
        n if n == AT.len() => AT[n - 1].1,
        n => {
            let ((x0, y0), (x1, y1)) = (AT[n - 1], AT[n]);
            y0 + (y1 - y0) * (z - x0) / (x1 - x0)
        }
    }
}

struct Candidate {
    score: f64,
    top: f64,
    region: Region,
}

/// Finds the seat of a volume whose matter lies between levels `floor` and `top`.
pub(super) fn find(v: &Volume, floor: usize, top: usize) -> Option<Seat> {
    let tall = (top - floor + 1) as f64;
    let room = (ROOM * tall).round().max(2.0) as usize;
    let band = (BAND * tall).round().max(2.0) as usize;
    let up = upward(v, top, room);
    let mut all: Vec<Candidate> = Vec::new();
    for k in floor..=top {
        let levels = &up[k..(k + band).min(top + 1)];
        let mut mask = Mask::empty(v.size[0], v.size[1]);
        levels.iter().for_each(|m| mask.or(m));
        let regions = mask.closed(GAPS).regions();
        for region in regions.into_iter().take(3).filter(|r| r.area() >= 9.0) {
            let heights = heights(&region, levels, k);
            if heights.is_empty() {
                continue;
            }
            let at = median(&heights);
            let core = (region.core(0.3 * region.area().sqrt()) / 0.8).min(1.0);
            let likely = prior((at - floor as f64 + 0.5) / tall);
            all.push(Candidate { score: region.area() * core * core * likely, top: at, region });
        }
    }
    let best = all.iter().fold(None::<&Candidate>, |b, c| match b {
        Some(b) if b.score >= c.score => Some(b),
        _ => Some(c),
    })?;
    let second = all
        .iter()
        .filter(|c| (c.top - best.top).abs() > 0.12 * tall)
        .max_by(|a, b| a.score.total_cmp(&b.score));
    let mask = best.region.mask(v.size[0], v.size[1]);
    let area = best.region.area();
    let runs: Vec<f64> = best
        .region
        .cells
        .iter()
        .filter_map(|&[x, y]| run(v, x, y, best.top.round() as usize, band))
        .collect();
    Some(Seat {
        area,
        top: best.top,
        thickness: median(&runs).max(1.0),
        under: underside(v, &mask, best.top.floor() as usize, floor),
        second: second.map_or(0.0, |s| s.score / best.score.max(1e-9)),
        second_top: second.map_or(0.0, |s| s.top),
        mask,
    })
}

fn heights(region: &Region, levels: &[Mask], first: usize) -> Vec<f64> {
    let mut all = Vec::new();
    for &[x, y] in &region.cells {
        // the highest of a column counts
        if let Some(n) = levels.iter().rposition(|m| m.get(x, y)) {
            all.push((first + n) as f64);
        }
    }
    all
}

/// Solid samples in a column downwards from about a level.
fn run(v: &Volume, x: usize, y: usize, level: usize, band: usize) -> Option<f64> {
    let start = (level.saturating_sub(band)..=level + band).rev().find(|&k| v.get([x, y, k]))?;
    let down = (0..=start).rev().take_while(|&k| v.get([x, y, k])).count();
    Some(down as f64)
}

/// The highest level whose filled section no longer covers the seat.
fn underside(v: &Volume, seat: &Mask, top: usize, floor: usize) -> usize {
    let need = 0.35 * seat.count() as f64;
    let (mut under, mut missed) = (top, 0);
    for k in (floor..top).rev() {
        let section = v.section(k).filled().and(seat);
        if (section.count() as f64) < need {
            missed += 1;
            if missed == 2 {
                return under.saturating_sub(1).max(floor);
            }
        } else {
            missed = 0;
            under = k;
        }
    }
    floor
}
