//! A shape looked at: how it stands, and what parts it has.

use super::above;
use super::base::{self, Kind};
use super::chair::{Arm, Back, Base, Chair, Column, Leg, Seat, Stretcher};
use super::legs::{self, Track};
use super::mirror::{Mirror, Plane};
use super::seat;
use super::stretchers;
use super::volume::{Stand, Volume};
use crate::field::Field;
use crate::grid::Lattice;
use crate::job::{Cancelled, Job};
use crate::num::Aabb;
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Samples along the longest side when the mirror plane is looked for.
const COARSE: f64 = 60.0;
/// Samples along the longest side when the parts are.
pub(super) const FINE: f64 = 90.0;
/// Turns nearer than this to a quarter turn are made one, radians.
const SNAP: f64 = 2.0 * PI / 180.0;
/// Least side of a seat, a share of the height. Lower, poles are seats; bar stools have 0.3.
const SLIM: f64 = 0.15;

/// A shape looked at.
pub(super) struct Look {
    /// How it has to be stood, at its own scale.
    pub stand: Stand,
    /// The box round it, stood so.
    pub bounds: Aabb,
    /// Its parts, if it has a seat.
    pub chair: Option<Chair>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Looks at a shape; none when it is empty or without bounds.
pub(super) fn look(field: &dyn Field, job: &dyn Job) -> Result<Option<Look>, Cancelled> {
    let Some((coarse, floor, top)) = coarse(field, job)? else { return Ok(None) };
    let (stand, score) = stand(&coarse, floor, top, &field.support());
    let matter = coarse.solids().map(|p| stand.point(coarse.point(p)));
    let bounds = Aabb::of(matter);
    let lattice = lattice(&bounds);
    let fine = Volume::sample(field, stand, lattice, job)?;
    let Some((floor, top)) = fine.levels() else { return Ok(None) };
    let bounds = Aabb::of(fine.solids().map(|p| fine.point(p)));
    let (chair, warnings) = parts(&fine, floor, top, score, &bounds);
    Ok(Some(Look { stand, bounds, chair, warnings }))
}

/// A first look at the shape where it is, with its lowest and highest levels.
fn coarse(field: &dyn Field, job: &dyn Job) -> Result<Option<(Volume, usize, usize)>, Cancelled> {
    let mut space = field.support();
    for _ in 0..3 {
        let longest = space.size().max_element();
        if space.is_empty() || !space.is_finite() || longest <= 0.0 {
            return Ok(None);
        }
        let v =
            Volume::sample(field, Stand::KEPT, Lattice::covering(&space, longest / COARSE), job)?;
        let matter = Aabb::of(v.solids().map(|p| v.point(p)));
        if matter.is_empty() {
            return Ok(None);
        }
        if matter.size().max_element() > 0.6 * longest {
            return Ok(v.levels().map(|(floor, top)| (v, floor, top)));
        }
        // what was promised was much too large
        space = matter.grow(v.lattice.step);
    }
    Ok(None)
}

/// A lattice with its middle samples on x = 0 and its first level of matter just above z = 0.
fn lattice(bounds: &Aabb) -> Lattice {
    const ROOM: f64 = 4.0;
    let half = bounds.max.x.max(-bounds.min.x);
    let size = DVec3::new(2.0 * half, bounds.size().y, bounds.size().z);
    let step = size.max_element() / FINE;
    let across = (half / step).ceil() + ROOM;
    let deep = (size.y / step).ceil() + 2.0 * ROOM;
    let high = (size.z / step).ceil() + 2.0 * ROOM;
    let origin = DVec3::new(-across, bounds.centre().y / step - 0.5 * deep, 0.5 - ROOM) * step;
    let size = [2.0 * across, deep, high].map(|n| n as u32 + 1);
    Lattice { origin, step, size }
}

/// How the shape has to be stood, and how well it mirrors.
fn stand(v: &Volume, floor: usize, top: usize, support: &Aabb) -> (Stand, f64) {
    let seat = seat::find(v, floor, top);
    let back = seat.as_ref().and_then(|s| {
        let d = above::direction(v, s, floor, top)?;
        (d.length() > 0.08 * s.area.sqrt()).then_some(d)
    });
    let Some(mirror) = Mirror::new(v, top) else { return (Stand::KEPT, 0.0) };
    let plane = choose(v, &mirror, seat.as_ref().map(|s| s.top), back);
    let yaw = plane.yaw.rem_euclid(PI);
    // the normal goes to x; of the two ways the one that puts the back behind, else the lesser turn
    let turns = [-yaw, PI - yaw];
    let behind = |turn: f64| back.map_or(turn.cos(), |b| b.rotate(DVec2::from_angle(turn)).y);
    let turn = if behind(turns[0]) >= behind(turns[1]) { turns[0] } else { turns[1] };
    let quarter = (turn / FRAC_PI_2).round() * FRAC_PI_2;
    let turn = if (turn - quarter).abs() < SNAP { quarter } else { turn };
    let turn = if turn <= -PI + 1e-9 { turn + 2.0 * PI } else { turn };
    let turned = Stand { turn, shift: DVec3::ZERO };
    let on = mirror.centre + plane.offset * DVec2::from_angle(plane.yaw);
    let x = turned.point(v.plan(on).extend(0.0)).x;
    let matter = Aabb::of(v.solids().map(|p| turned.point(v.point(p))));
    // a file's own box is exact, the samples are not
    let own = Aabb::of(support.corners().map(|p| turned.point(p)));
    let step = v.lattice.step;
    let exact = |found: f64, own: f64, within: f64| {
        if (found - own).abs() < within * step { own } else { found }
    };
    let x = if turn == quarter { exact(x, own.centre().x, 0.75) } else { x };
    let z = exact(matter.min.z, support.min.z, 1.0);
    let y = if turn == quarter {
        exact(matter.centre().y, own.centre().y, 1.0)
    } else {
        matter.centre().y
    };
    // never minus nought
    (Stand { turn: turn + 0.0, shift: DVec3::ZERO - DVec3::new(x, y, z) }, plane.score)
}

/// The mirror plane to stand by: the best one, unless it cuts the back in two.
fn choose(v: &Volume, mirror: &Mirror, seat: Option<f64>, back: Option<DVec2>) -> Plane {
    let [mut best, mut other] = mirror.best();
    let Some(back) = back.map(|b| b.normalize_or_zero()) else { return best };
    let across = |p: &Plane| DVec2::from_angle(p.yaw).dot(back).abs();
    // a tablet arm or a swivelled star: the matter up to the seat may know better
    if best.score < 0.90
        && let Some(seat) = seat
        && let Some(lower) = Mirror::new(v, seat.round() as usize)
    {
        let [a, b] = lower.best();
        let near = |p: Plane| {
            let on = lower.centre + p.offset * DVec2::from_angle(p.yaw);
            let offset = (on - mirror.centre).dot(DVec2::from_angle(p.yaw));
            Plane { offset, ..p }
        };
        if a.score > best.score {
            (best, other) = (near(a), near(b));
        }
        if best.score - other.score < 0.10
            && best.score - 0.25 * across(&best) < other.score - 0.25 * across(&other)
        {
            (best, other) = (other, best);
        }
    }
    if across(&best) > 0.79 && other.score > best.score - 0.10 { other } else { best }
}

/// The parts of a volume that stands as its pose says.
fn parts(
    v: &Volume,
    floor: usize,
    top: usize,
    mirror: f64,
    bounds: &Aabb,
) -> (Option<Chair>, Vec<String>) {
    let mut warnings = Vec::new();
    let Some(seat) = seat::find(v, floor, top) else {
        return (None, vec!["no seat was found".to_owned()]);
    };
    let tall = (top - floor + 1) as f64;
    if seat.area.sqrt() < SLIM * tall {
        return (None, vec!["too slim to sit on".to_owned()]);
    }
    let base = base::find(v, &seat, floor, top);
    let middle = -v.lattice.origin.x / v.lattice.step;
    let (back, arms) = above::find(v, &seat, middle, floor, top);
    if matches!(base.kind, Kind::Solid) && back.is_none() {
        return (None, vec!["a body without parts".to_owned()]);
    }
    let size = bounds.size();
    let flat = size.z / size.x.max(size.y);
    if flat < 0.75 {
        warnings.push(format!(
            "only {flat:.2} times as high as long: a lounger or a sofa? check the parts"
        ));
    }
    if base.modal.1 < 0.3 && matches!(base.kind, Kind::Legs(_)) {
        warnings.push("the base differs from level to level: check its parts".to_owned());
    }
    if mirror < 0.85 {
        warnings.push(format!("mirrors poorly ({mirror:.2}): check where its front is"));
    }
    if seat.second > 0.45 {
        warnings.push(format!(
            "the seat may also be {:.0} mm high",
            v.height(seat.second_top).max(0.0)
        ));
    }
    let plan = (size.x * size.y) / (v.lattice.step * v.lattice.step);
    let sure_seat = (seat.area / (0.45 * plan)).min(1.0)
        * (1.0 - 0.6 * ((seat.second - 0.4) / 0.6).clamp(0.0, 1.0));
    let sure_mirror = ((mirror - 0.6) / 0.3).clamp(0.0, 1.0);
    let (low, high) = above::seat_box(&seat);
    let (low, high) = (v.plan(low), v.plan(high));
    let half = 0.5 * (high.x - low.x).max(v.lattice.step);
    let thickness = (seat.thickness - 1.0).max(0.5) * v.lattice.step;
    let place = Seat {
        top: v.height(seat.top),
        thickness,
        under: v.height(seat.under as f64).max(0.0),
        low: DVec2::new(-half, low.y),
        high: DVec2::new(half, high.y),
    };
    let sure = [sure_mirror, sure_seat, base.agree.clamp(0.0, 1.0)];
    let chair = Chair {
        stretchers: bars(v, &base, seat.under, floor),
        base: stand_on(v, &base, &place),
        seat: place,
        back: back.map(|b| back_place(v, &b)),
        arms: arms.map(|a| a.map(|a| arm_place(v, &a))),
        sure,
    };
    (Some(chair), warnings)
}

fn back_place(v: &Volume, b: &above::Back) -> Back {
    let (step, origin) = (v.lattice.step, v.lattice.origin);
    let floor = -origin.z / step;
    Back {
        at: origin.y + step * (b.at + b.slope * floor),
        slope: b.slope,
        top: v.height(b.to),
        half: b.half.map(|h| h * step),
        front: b.front * step,
        rear: b.rear * step,
    }
}

fn arm_place(v: &Volume, a: &above::Arm) -> Arm {
    let (step, origin) = (v.lattice.step, v.lattice.origin);
    let place = |p: DVec3| DVec3::new(p.x * step, origin.y + p.y * step, v.height(p.z));
    Arm { low: place(a.low), high: place(a.high) }
}

fn bars(v: &Volume, base: &base::Base, under: usize, floor: usize) -> Vec<Stretcher> {
    let Kind::Legs(tracks) = &base.kind else { return Vec::new() };
    let low = floor as f64;
    let feet: Vec<DVec2> = tracks.iter().map(|t| t.point(low)).collect();
    let Some(order) = legs::quadrants(&feet) else { return Vec::new() };
    if crossed(tracks, low, under as f64) {
        return Vec::new();
    }
    let place = |p: DVec3| v.plan(p.truncate()).extend(v.height(p.z));
    stretchers::find(v, order.map(|i| &tracks[i]), floor, under)
        .into_iter()
        .map(|b| Stretcher {
            side: b.side,
            from: place(b.from),
            to: place(b.to),
            radius: b.radius * v.lattice.step,
        })
        .collect()
}

fn stand_on(v: &Volume, base: &base::Base, seat: &Seat) -> Base {
    let step = v.lattice.step;
    let floor = -v.lattice.origin.z / step;
    let board = seat.top - seat.thickness;
    let head = (board - v.lattice.origin.z) / step;
    let leg = |t: &Track| Leg {
        foot: v.plan(t.point(floor)).extend(0.0),
        head: v.plan(t.point(head)).extend(board),
        // samples half a step outside count as solid
        radius: (t.radius - 0.5).max(0.5) * step,
        reach: (t.reach - 0.5).max(0.5) * step,
    };
    let legs = |tracks: &[Track]| {
        let mut legs: Vec<Leg> = tracks.iter().map(leg).collect();
        let centre = 0.5 * (seat.low + seat.high);
        legs.sort_by(|a, b| turn_of(a, centre).total_cmp(&turn_of(b, centre)));
        legs
    };
    match &base.kind {
        Kind::Legs(t) if crossed(t, floor, head) => Base::Crossed(legs(t)),
        Kind::Legs(t) => Base::Legs(legs(t)),
        Kind::Sled(t) if crossed(t, floor, head) => Base::Crossed(legs(t)),
        Kind::Sled(t) => Base::Sled(legs(t)),
        Kind::Cantilever(t) => Base::Cantilever(legs(t)),
        Kind::Disc | Kind::Star(_) => Base::Column(Column {
            axis: v.plan(base.centre),
            radius: base.radius * step,
            hub: v.height(base.hub),
            reach: base.reach * step,
            spokes: match &base.kind {
                Kind::Star(tips) => tips.iter().map(|t| v.plan(*t)).collect(),
                _ => Vec::new(),
            },
        }),
        Kind::Solid => Base::Solid,
    }
}

/// How far a leg's foot stands round the seat's centre, clockwise seen from above, from straight ahead on:
/// the front left leg comes first.
fn turn_of(leg: &Leg, centre: DVec2) -> f64 {
    let d = leg.foot.truncate() - centre;
    (-d.y.atan2(d.x) - PI / 2.0).rem_euclid(2.0 * PI)
}

/// Whether four legs change places along an axis between floor and seat.
fn crossed(tracks: &[Track], low: f64, high: f64) -> bool {
    let along = |axis: usize| {
        let feet: Vec<f64> = tracks.iter().map(|t| t.point(low)[axis]).collect();
        let heads: Vec<f64> = tracks.iter().map(|t| t.point(high)[axis]).collect();
        correlation(&feet, &heads) < -0.5
    };
    tracks.len() == 4 && (along(0) || along(1))
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len().max(1) as f64;
    let (ma, mb) = (mean(a), mean(b));
    let dot = |x: &[f64], mx: f64, y: &[f64], my: f64| -> f64 {
        x.iter().zip(y).map(|(x, y)| (x - mx) * (y - my)).sum()
    };
    let spread = (dot(a, ma, a, ma) * dot(b, mb, b, mb)).sqrt();
    if spread > 0.0 { dot(a, ma, b, mb) / spread } else { 0.0 }
}
