//! Legs, tracked through the sections of the base.

use super::base::Level;
use super::mask::{line, median, quantile};
use glam::DVec2;
use std::f64::consts::PI;

/// A leg, in samples: `x(z) = at + slope z` in the plan.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Track {
    /// Where the fitted line meets level 0.
    pub at: DVec2,
    /// Plan samples a level.
    pub slope: DVec2,
    /// Radius that holds nearly all its sections round the line.
    pub reach: f64,
    /// Radius of a section of middle size.
    pub radius: f64,
    /// Levels it was seen in.
    pub seen: usize,
}

impl Track {
    /// Where it is at a level.
    pub fn point(&self, level: f64) -> DVec2 {
        self.at + self.slope * level
    }
}

/// One sighting of a leg.
#[derive(Clone, Copy, Debug)]
struct Spot {
    z: f64,
    at: DVec2,
    area: f64,
}

/// The number of legs that fits the sections and the feet best, and their tracks.
pub(super) fn find(levels: &[Level], feet: usize, floor: usize, high: f64) -> (usize, Vec<Track>) {
    let share = |n: usize| {
        levels.iter().filter(|l| l.regions.len() == n).count() as f64 / levels.len().max(1) as f64
    };
    let score = |n: usize| {
        let bonus = |yes: bool, by: f64| if yes { by } else { 0.0 };
        share(n) + bonus(n == feet, 0.35) + bonus(n == 4, 0.15)
    };
    let count = (2..=6).fold(2, |best, n| if score(n) > score(best) { n } else { best });
    (count, tracks(levels, count, floor, high))
}

/// Tracks from the middle of the longest run of levels with that many pieces.
fn tracks(levels: &[Level], count: usize, floor: usize, high: f64) -> Vec<Track> {
    let (mut best, mut length, mut run) = (None, 0, 0);
    for (i, l) in levels.iter().enumerate() {
        run = if l.regions.len() == count { run + 1 } else { 0 };
        if run > length {
            (best, length) = (Some(i + 1 - run), run);
        }
    }
    let Some(first) = best else { return Vec::new() };
    let middle = first + length / 2;
    let seeds = &levels[middle].regions;
    seeds
        .iter()
        .map(|seed| {
            let spot = Spot { z: levels[middle].k as f64, at: seed.centre(), area: seed.area() };
            let up = follow(levels, spot, middle + 1..levels.len(), high);
            let down = follow(levels, spot, (0..middle).rev(), high);
            let spots: Vec<Spot> = down.iter().rev().chain([&spot]).chain(&up).copied().collect();
            fit(&spots, floor)
        })
        .collect()
}

/// The sightings that go on from a seed, level by level.
fn follow(
    levels: &[Level],
    seed: Spot,
    order: impl Iterator<Item = usize>,
    high: f64,
) -> Vec<Spot> {
    let mut spots = vec![seed];
    let mut missed = 0.0;
    let radius = (seed.area / PI).sqrt();
    for i in order {
        let z = levels[i].k as f64;
        let guess = predict(&spots, z);
        let near = levels[i]
            .regions
            .iter()
            .filter(|r| (0.35..=1.6).contains(&(r.area() / seed.area)))
            .map(|r| Spot { z, at: r.centre(), area: r.area() })
            .min_by(|a, b| a.at.distance(guess).total_cmp(&b.at.distance(guess)))
            .filter(|s| s.at.distance(guess) <= radius + 2.0);
        match near {
            Some(s) => {
                spots.push(s);
                missed = 0.0;
            }
            None => {
                missed += 1.0;
                if missed > 0.35 * high + 4.0 {
                    break;
                }
            }
        }
    }
    spots.remove(0);
    spots
}

/// Where a line through the last sightings is at a level.
fn predict(spots: &[Spot], z: f64) -> DVec2 {
    let last = &spots[spots.len().saturating_sub(14)..];
    if last.len() < 3 {
        return last.last().map_or(DVec2::ZERO, |s| s.at);
    }
    let axis = |get: fn(&Spot) -> f64| {
        let points: Vec<_> = last.iter().map(|s| (s.z, get(s))).collect();
        let (a, b) = line(&points);
        a + b * z
    };
    DVec2::new(axis(|s| s.at.x), axis(|s| s.at.y))
}

fn fit(spots: &[Spot], floor: usize) -> Track {
    let axis = |get: fn(&Spot) -> f64| {
        let points: Vec<_> = spots.iter().map(|s| (s.z, get(s))).collect();
        line(&points)
    };
    let ((ax, bx), (ay, by)) = (axis(|s| s.at.x), axis(|s| s.at.y));
    let mut track = Track {
        at: DVec2::new(ax, ay),
        slope: DVec2::new(bx, by),
        reach: 0.0,
        radius: 0.0,
        seen: spots.len(),
    };
    // a short stub's slope is noise
    if spots.len() < 3 {
        track.slope = DVec2::ZERO;
        track.at = spots.first().map_or(DVec2::new(0.0, floor as f64), |s| s.at);
    }
    let radius = |s: &Spot| (s.area / PI).sqrt();
    let radii: Vec<f64> = spots.iter().map(radius).collect();
    let reach: Vec<f64> =
        spots.iter().map(|s| s.at.distance(track.point(s.z)) + radius(s)).collect();
    track.radius = median(&radii);
    track.reach = quantile(&reach, 0.9);
    track
}

/// Which of four places in the plan is front left, front right, back left, back right: the two
/// foremost first, then by side.
pub(super) fn quadrants(feet: &[DVec2]) -> Option<[usize; 4]> {
    let mut by_y: Vec<usize> = (0..feet.len()).collect();
    by_y.sort_by(|a, b| feet[*a].y.total_cmp(&feet[*b].y));
    let [a, b, c, d] = <[usize; 4]>::try_from(by_y).ok()?;
    let by_x = |a: usize, b: usize| if feet[a].x <= feet[b].x { [a, b] } else { [b, a] };
    let ([fl, fr], [bl, br]) = (by_x(a, b), by_x(c, d));
    Some([fl, fr, bl, br])
}
