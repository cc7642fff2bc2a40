//! What carries the seat: legs, a column, rails or a solid body.

use super::legs::{self, Track};
use super::mask::{Mask, Region, quantile};
use super::seat::Seat;
use super::volume::Volume;
use glam::DVec2;

/// Kinds of bases, in samples.
#[derive(Clone, Debug)]
pub(super) enum Kind {
    /// Struts that are tracked from the floor up.
    Legs(Vec<Track>),
    /// A column that ends in a disc.
    Disc,
    /// A column that ends in spokes.
    Star(Vec<DVec2>),
    /// Runners on the floor.
    Sled(Vec<Track>),
    /// Carried from one side only.
    Cantilever(Vec<Track>),
    /// Nothing to tell apart.
    Solid,
}

/// The base of a seat, in samples.
#[derive(Clone, Debug)]
pub(super) struct Base {
    pub kind: Kind,
    /// What touches the floor.
    pub feet: Vec<Region>,
    /// Centre of the column.
    pub centre: DVec2,
    /// Level from which the column stands alone.
    pub hub: f64,
    /// Radius of the column.
    pub radius: f64,
    /// Radius of what stands on the floor, round the centre.
    pub reach: f64,
    /// Share of levels that agree with the kind.
    pub agree: f64,
    /// The number of pieces in most levels, and the share of levels it has.
    pub modal: (usize, f64),
}

/// Sections of the base, a level each.
pub(super) struct Level {
    pub k: usize,
    pub regions: Vec<Region>,
    pub section: Mask,
}

pub(super) fn find(v: &Volume, seat: &Seat, floor: usize, top: usize) -> Base {
    let tall = (top - floor + 1) as f64;
    let side = seat.area.sqrt();
    let high = (seat.under.saturating_sub(floor)) as f64;
    let contact = v.sections(floor..floor + (0.02 * tall).round().max(1.0) as usize);
    let feet = contact.closed(1.2).regions();
    let seat_centre = region_centre(&seat.mask);
    let levels = levels(v, floor, high);
    let mut base = Base {
        kind: Kind::Solid,
        centre: seat_centre,
        hub: floor as f64,
        radius: 0.2 * side,
        reach: 0.5 * side,
        agree: 0.6,
        modal: modal(&levels),
        feet,
    };
    if high < 0.06 * tall || levels.is_empty() {
        return base;
    }
    let feet_centre = mean(base.feet.iter().flat_map(|f| f.points()));
    let column = column(&levels, side, seat_centre, feet_centre, floor, high);
    let (m, share) = base.modal;
    if column.share >= 0.5 || (m == 1 && share >= 0.6 && column.share >= 0.2) {
        (base.centre, base.hub, base.radius) = (column.centre, column.hub, column.radius);
        base.agree = column.share.max(0.5);
        let spokes = spokes(v, floor, high, base.centre, &mut base.reach);
        base.kind = spokes.map_or(Kind::Disc, Kind::Star);
        return base;
    }
    let in_contact: f64 = base.feet.iter().map(Region::area).sum();
    let long = |f: &&Region| {
        let s = f.spread();
        s.x > 0.45 * side && s.x > 3.0 * s.y
    };
    let runners: f64 = base.feet.iter().filter(long).map(Region::area).sum();
    let (count, tracks) = legs::find(&levels, base.feet.len(), floor, high);
    if runners >= 0.6 * in_contact {
        base.kind = Kind::Sled(tracks);
        return base;
    }
    let big = |f: &&Region| {
        let e = f.extent();
        f.area() < 0.5 * e.x * e.y && e.max_element() > 0.45 * side
    };
    if base.feet.len() == 1 && base.feet.iter().any(|f| big(&f)) {
        base.kind = Kind::Cantilever(tracks);
        return base;
    }
    let filled: Vec<f64> =
        levels.iter().map(|l| l.section.filled().count() as f64 / seat.area).collect();
    let most = filled.iter().filter(|f| **f > 0.5).count() * 2 > filled.len();
    if quantile(&filled, 0.5) > 0.5 && (base.feet.len() == 1 || most) {
        return base;
    }
    let has = levels.iter().filter(|l| l.regions.len() == count).count() as f64;
    base.agree = has / levels.len() as f64;
    base.kind = Kind::Legs(tracks);
    base
}

/// The sections between the floor and the seat, pieces of a cell left out.
fn levels(v: &Volume, floor: usize, high: f64) -> Vec<Level> {
    let level = |part: f64| floor + (part * high).round() as usize;
    (level(0.06)..=level(0.96))
        .map(|k| {
            let section = v.section(k).closed(1.0);
            let mut regions = section.regions();
            regions.retain(|r| r.cells.len() >= 2);
            Level { k, regions, section }
        })
        .collect()
}

fn modal(levels: &[Level]) -> (usize, f64) {
    let mut counts = std::collections::BTreeMap::new();
    for l in levels {
        *counts.entry(l.regions.len()).or_insert(0_usize) += 1;
    }
    let best = counts.iter().rev().max_by_key(|(_, n)| **n);
    best.map_or((0, 0.0), |(&m, &n)| (m, n as f64 / levels.len() as f64))
}

struct Column {
    share: f64,
    centre: DVec2,
    hub: f64,
    radius: f64,
}

/// How far one compact piece near the middle carries everything.
fn column(
    levels: &[Level],
    side: f64,
    seat: DVec2,
    feet: DVec2,
    floor: usize,
    high: f64,
) -> Column {
    let central = |l: &Level| {
        let Some(largest) = l.regions.first() else { return false };
        let all: f64 = l.regions.iter().map(Region::area).sum();
        let c = largest.centre();
        let near = c.distance(seat).min(c.distance(feet)) < 0.35 * side;
        let slim = largest.extent().max_element() < 0.45 * side;
        near && slim && largest.area() >= 0.6 * all
    };
    let within = |l: &&Level| {
        let z = (l.k - floor) as f64 / high;
        (0.30..=0.92).contains(&z)
    };
    let middle = levels.iter().filter(within).count().max(1);
    let found = levels.iter().filter(within).filter(|l| central(l)).count();
    let alone: Vec<(&Level, &Region)> =
        levels.iter().filter(|l| central(l)).map(|l| (l, &l.regions[0])).collect();
    let radii: Vec<f64> =
        alone.iter().map(|(_, r)| (r.area() / std::f64::consts::PI).sqrt()).collect();
    Column {
        share: found as f64 / middle as f64,
        centre: mean(alone.iter().map(|(_, r)| r.centre())),
        hub: alone.first().map_or(floor as f64, |(l, _)| l.k as f64),
        radius: quantile(&radii, 0.6).max(1.0),
    }
}

/// The tips of the spokes of a star, or none; `reach` becomes the radius of what is on the floor.
fn spokes(
    v: &Volume,
    floor: usize,
    high: f64,
    centre: DVec2,
    reach: &mut f64,
) -> Option<Vec<DVec2>> {
    const BINS: usize = 72;
    let low = v.sections(floor..floor + (0.22 * high).round().max(1.0) as usize);
    let points: Vec<DVec2> =
        low.cells().map(|[x, y]| DVec2::new(x as f64, y as f64) - centre).collect();
    let radii: Vec<f64> = points.iter().map(|p| p.length()).collect();
    let r = quantile(&radii, 0.97);
    *reach = r;
    let mut bins = [false; BINS];
    for p in points.iter().filter(|p| p.length() > 0.62 * r) {
        let turn = p.y.atan2(p.x).rem_euclid(std::f64::consts::TAU) / std::f64::consts::TAU;
        bins[(turn * BINS as f64) as usize % BINS] = true;
    }
    let cover = bins.iter().filter(|b| **b).count() as f64 / BINS as f64;
    let start = bins.iter().position(|b| !b)?;
    let (mut lobes, mut run) = (Vec::new(), Vec::new());
    for n in 1..=BINS {
        let bin = (start + n) % BINS;
        if bins[bin] {
            run.push((start + n) as f64 + 0.5);
        } else if !run.is_empty() {
            let middle = run.iter().sum::<f64>() / run.len() as f64;
            lobes
                .push(centre + r * DVec2::from_angle(middle / BINS as f64 * std::f64::consts::TAU));
            run.clear();
        }
    }
    (lobes.len() >= 3 && cover <= 0.8).then_some(lobes)
}

pub(super) fn region_centre(mask: &Mask) -> DVec2 {
    mean(mask.cells().map(|[x, y]| DVec2::new(x as f64, y as f64)))
}

fn mean(points: impl Iterator<Item = DVec2>) -> DVec2 {
    let (sum, n) = points.fold((DVec2::ZERO, 0.0), |(s, n), p| (s + p, n + 1.0));
    if n > 0.0 { sum / n } else { sum }
}
