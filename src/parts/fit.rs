//! Elements round the parts of one chair.

use super::chair::{Arm, Back, Base, Chair, Column, Leg, Seat, Stretcher};
use crate::element::{Element, ElementError};
use glam::{DQuat, DVec2, DVec3};

/// Room left round boxes, mm: a surface that lies on an element's face is neither in nor out.
const ROOM: f64 = 3.0;
/// Radius of a leg's element over that of the leg. Tighter, bent legs leave it; looser, the element
/// reaches into its neighbours.
const LOOSE: f64 = 1.15;
/// How far a leg's element reaches into the board, mm: a gap between the two would tear.
const OVERLAP: f64 = 4.0;

/// The board of the seat alone.
pub(super) fn seat(s: &Seat) -> Result<Element, ElementError> {
    let low = s.low.extend(s.top - s.thickness);
    let high = s.high.extend(s.top);
    block(low - ROOM, high + ROOM)
}

/// The back, leaning as it does, from the seat up.
pub(super) fn back(s: &Seat, b: &Back) -> Result<Element, ElementError> {
    let half_x = b.half[0].max(b.half[1]) + ROOM;
    let turn = DQuat::from_rotation_x(-b.slope.atan());
    let foot = s.top.min(b.top - 1.0);
    let on = |z: f64| DVec3::new(0.0, b.at + b.slope * z, z);
    let (low, high) = (on(foot), on(b.top));
    // across the plane, not along y
    let upright = 1.0 / (1.0 + b.slope * b.slope).sqrt();
    let (front, rear) = (b.front * upright + ROOM, b.rear * upright + ROOM);
    let half = DVec3::new(half_x, 0.5 * (front + rear), 0.5 * (high - low).length() + ROOM);
    let centre = 0.5 * (low + high) + turn * DVec3::new(0.0, 0.5 * (rear - front), 0.0);
    Element::block(centre, half, turn)
}

/// A leg from the floor to the board.
pub(super) fn leg(l: &Leg) -> Result<Element, ElementError> {
    let head = l.head + (l.head - l.foot).normalize_or_zero() * OVERLAP;
    Element::rod(l.foot, head, l.reach.min(2.0 * l.radius) * LOOSE + ROOM)
}

/// A bar between legs.
pub(super) fn stretcher(s: &Stretcher) -> Result<Element, ElementError> {
    Element::rod(s.from, s.to, s.radius * LOOSE + ROOM)
}

/// An arm with what carries it above the seat.
pub(super) fn arm(a: &Arm) -> Result<Element, ElementError> {
    block(a.low - ROOM, a.high + ROOM)
}

pub(super) fn block(low: DVec3, high: DVec3) -> Result<Element, ElementError> {
    let half = (0.5 * (high - low)).max(DVec3::splat(0.5));
    Element::block(0.5 * (low + high), half, DQuat::IDENTITY)
}

/// All of a column above what it stands on.
pub(super) fn column(chair: &Chair, c: &Column) -> Result<Element, ElementError> {
    let board = chair.seat.top - chair.seat.thickness;
    let low = c.hub.min(0.8 * board);
    let high = board.max(low + 1.0);
    Element::rod(c.axis.extend(low), c.axis.extend(high), c.radius * LOOSE + ROOM)
}

/// All that a column stands on.
pub(super) fn disc(c: &Column) -> Result<Element, ElementError> {
    let reach = DVec2::splat(c.reach);
    block((c.axis - reach).extend(0.0) - ROOM, (c.axis + reach).extend(c.hub.max(5.0)) + ROOM)
}

/// All that is below the board.
pub(super) fn base(c: &Chair) -> Result<Element, ElementError> {
    let board = (c.seat.top - c.seat.thickness).max(1.0);
    let mut low = DVec2::INFINITY;
    let mut high = DVec2::NEG_INFINITY;
    let mut add = |p: DVec2, radius: f64| {
        low = low.min(p - radius);
        high = high.max(p + radius);
    };
    match &c.base {
        Base::Column(col) => add(col.axis, col.reach),
        Base::Solid => [c.seat.low, c.seat.high].into_iter().for_each(|p| add(p, 0.0)),
        base => {
            let ends = struts(base).iter().flat_map(|l| [(l.foot, l.radius), (l.head, l.radius)]);
            ends.for_each(|(p, r)| add(p.truncate(), r));
        }
    }
    if low.x > high.x {
        (low, high) = (c.seat.low, c.seat.high);
    }
    block(low.extend(0.0) - ROOM, high.extend(board + OVERLAP))
}

/// The struts of a base.
pub(super) fn struts(base: &Base) -> &[Leg] {
    match base {
        Base::Legs(l) | Base::Crossed(l) | Base::Sled(l) | Base::Cantilever(l) => l,
        Base::Column(_) | Base::Solid => &[],
    }
}

/// An element moved from the seat of one chair to that of another: where a part would be on a
/// chair that has none.
pub(super) fn transplanted(e: &Element, from: &Chair, to: &Chair) -> Result<Element, ElementError> {
    let (a, b) = (&from.seat, &to.seat);
    let middle = |s: &Seat| (0.5 * (s.low + s.high)).extend(s.top);
    let ratio = ((b.high - b.low) / (a.high - a.low).max(DVec2::ONE)).extend(1.0);
    let centre = middle(b) + (e.centre - middle(a)) * ratio;
    Element::new(e.shape.clone(), centre, e.rotation, e.half * ratio, e.deform)
}
