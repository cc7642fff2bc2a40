//! What stands above the seat: a back and arm rests.

use super::mask::{line, median, quantile};
use super::seat::Seat;
use super::volume::Volume;
use glam::{DVec2, DVec3};

/// A back, in samples: the plane `y = at + slope z`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Back {
    pub at: f64,
    pub slope: f64,
    /// Level of its lowest and highest matter.
    pub from: f64,
    pub to: f64,
    /// Reach to either side of the mirror plane, low and high up.
    pub half: [f64; 2],
    /// Reach in front of the plane and behind it.
    pub front: f64,
    pub rear: f64,
}

/// An arm rest, in samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arm {
    pub low: DVec3,
    pub high: DVec3,
    /// Share of the seat's depth along which there is matter.
    pub cover: f64,
}

/// Where the matter above the seat lies from the seat's centre, in the plan, weighted by the square
/// of the height; none without such matter.
pub(super) fn direction(v: &Volume, seat: &Seat, floor: usize, top: usize) -> Option<DVec2> {
    let centre = super::base::region_centre(&seat.mask);
    let foot = seat.top + 0.04 * (top - floor + 1) as f64;
    let (mut sum, mut weight) = (DVec2::ZERO, 0.0);
    for [x, y, z] in v.solids().filter(|p| p[2] as f64 > foot) {
        let w = (z as f64 - seat.top).powi(2);
        sum += w * (DVec2::new(x as f64, y as f64) - centre);
        weight += w;
    }
    (weight > 0.0).then(|| sum / weight)
}

/// Matter above the seat that has a mirror partner, as (x from the mirror plane, y, level).
fn paired(v: &Volume, middle: f64, above: f64) -> Vec<DVec3> {
    let partner = |p: &[usize; 3]| {
        let x = (2.0 * middle - p[0] as f64).round() as isize;
        (-2..=2).any(|dy: isize| {
            (-2..=2).any(|dx: isize| {
                let (x, y) = (x + dx, p[1].wrapping_add_signed(dy));
                x >= 0 && v.get([x as usize, y, p[2]])
            })
        })
    };
    v.solids()
        .filter(|p| p[2] as f64 > above && partner(p))
        .map(|p| DVec3::new(p[0] as f64 - middle, p[1] as f64, p[2] as f64))
        .collect()
}

/// The extent of the seat in x and y, in samples.
pub(super) fn seat_box(seat: &Seat) -> (DVec2, DVec2) {
    let xs: Vec<f64> = seat.mask.cells().map(|c| c[0] as f64).collect();
    let ys: Vec<f64> = seat.mask.cells().map(|c| c[1] as f64).collect();
    let at = |q: f64| DVec2::new(quantile(&xs, q), quantile(&ys, q));
    (at(0.005), at(0.995))
}

/// The back, looked for at +y, and the arm rests at -x and +x; `middle` is the mirror plane.
pub(super) fn find(
    v: &Volume,
    seat: &Seat,
    middle: f64,
    floor: usize,
    top: usize,
) -> (Option<Back>, [Option<Arm>; 2]) {
    let tall = (top - floor + 1) as f64;
    let (low, high) = seat_box(seat);
    let (width, depth) = (high.x - low.x + 1.0, high.y - low.y + 1.0);
    let foot = seat.top + 0.04 * tall;
    let matter = paired(v, middle, foot);
    let centre = super::base::region_centre(&seat.mask);
    let back = back(&matter, centre.y, width, tall, foot);
    let arms = [-1.0, 1.0].map(|side| {
        let region: Vec<DVec3> = v
            .solids()
            .map(|p| DVec3::new((p[0] as f64 - middle) * side, p[1] as f64, p[2] as f64))
            .filter(|p| {
                let z = (p.z - seat.top) / width;
                let y = (p.y - low.y) / depth;
                // what belongs to the back plane is no arm
                let behind = back
                    .is_some_and(|b| p.y > b.at + b.slope * p.z - b.front.min(0.05 * width) - 1.0);
                p.x > 0.30 * width
                    && (0.14..=0.85).contains(&z)
                    && p.z > foot
                    && (-0.1..=1.0).contains(&y)
                    && !behind
            })
            .collect();
        arm(&region, side, seat.top, low.y, depth)
    });
    (back, arms)
}

fn back(matter: &[DVec3], seat_y: f64, width: f64, tall: f64, foot: f64) -> Option<Back> {
    let behind: Vec<DVec3> =
        matter.iter().copied().filter(|p| p.y > seat_y && p.x.abs() < 0.35 * width).collect();
    let to = behind.iter().map(|p| p.z).fold(0.0, f64::max);
    if behind.len() <= 20 || to - foot <= 0.06 * tall {
        return None;
    }
    let mut rows = std::collections::BTreeMap::<i64, Vec<f64>>::new();
    for p in &behind {
        rows.entry(p.z as i64).or_default().push(p.y);
    }
    let points: Vec<(f64, f64)> = rows.iter().map(|(z, ys)| (*z as f64, median(ys))).collect();
    let (at, slope) = line(&points);
    let off = |p: &DVec3| p.y - at - slope * p.z;
    // posts stand wider than that, often before the plane; arm rests seldom reach as high
    let high = foot + 0.6 * (to - foot);
    let offs: Vec<f64> = behind.iter().map(off).collect();
    let above: Vec<f64> = matter.iter().filter(|p| p.z > high).map(off).collect();
    let posts: Vec<f64> = above.into_iter().filter(|d| d.abs() < 0.12 * width).collect();
    let front = (-quantile(&offs, 0.01)).max(-quantile(&posts, 0.01));
    let rear = quantile(&offs, 0.99).max(quantile(&posts, 0.99));
    let all: Vec<&DVec3> =
        matter.iter().filter(|p| off(p) > -front - 1.5 && off(p) < rear + 1.5).collect();
    let from = all.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
    let half = |low: f64, high: f64| {
        let xs: Vec<f64> = all
            .iter()
            .filter(|p| (low..=high).contains(&((p.z - from) / (to - from).max(1.0))))
            .map(|p| p.x.abs())
            .collect();
        quantile(&xs, 0.99)
    };
    let half = [half(0.0, 0.5), half(0.5, 1.0)];
    Some(Back { at, slope, from, to, half, front: front.max(0.5), rear: rear.max(0.5) })
}

/// An arm's least cover of the seat's depth. Lower, armless chairs with wide backs get arms; at
/// 0.22 the low lounge chairs lose theirs.
const COVER: f64 = 0.10;

fn arm(region: &[DVec3], side: f64, seat_top: f64, front: f64, depth: f64) -> Option<Arm> {
    let mut bins = std::collections::BTreeMap::<i64, f64>::new();
    for p in region {
        let share = (p.y - front) / depth;
        if (0.05..=0.60).contains(&share) {
            let top = bins.entry(p.y as i64).or_insert(p.z);
            *top = top.max(p.z);
        }
    }
    let cover = bins.len() as f64 / (0.55 * depth).max(1.0);
    if cover < COVER {
        return None;
    }
    let tops: Vec<f64> = bins.values().copied().collect();
    let top = median(&tops);
    let xs: Vec<f64> = region.iter().filter(|p| p.z <= top + 2.0).map(|p| p.x).collect();
    let ys: Vec<f64> = region.iter().filter(|p| p.z <= top + 2.0).map(|p| p.y).collect();
    let (x0, x1) = (quantile(&xs, 0.02), quantile(&xs, 0.98));
    let (a, b) = if side < 0.0 { (-x1, -x0) } else { (x0, x1) };
    Some(Arm {
        low: DVec3::new(a, quantile(&ys, 0.01), seat_top),
        high: DVec3::new(b, quantile(&ys, 0.99), top),
        cover: cover.min(1.0),
    })
}
