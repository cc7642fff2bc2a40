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

/// The slice of a column that stands for a leg in a direction.
pub(super) fn slice(c: &Column, to: DVec2, low: f64, high: f64) -> Result<Element, ElementError> {
    let at = c.axis + 0.5 * c.radius * to;
    Element::rod(at.extend(low), at.extend(high.max(low + 1.0)), 0.5 * c.radius + ROOM)
}

/// All of a column.
pub(super) fn shaft(c: &Column, low: f64, high: f64) -> Result<Element, ElementError> {
    Element::rod(c.axis.extend(low), c.axis.extend(high.max(low + 1.0)), c.radius * LOOSE + ROOM)
}

/// All that a column stands on.
pub(super) fn disc(c: &Column) -> Result<Element, ElementError> {
    let reach = DVec2::splat(c.reach);
    block((c.axis - reach).extend(0.0) - ROOM, (c.axis + reach).extend(c.hub.max(5.0)) + ROOM)
}

/// The spoke that stands for a foot in a direction, or a bar of the disc.
pub(super) fn spoke(c: &Column, to: DVec2) -> Result<Element, ElementError> {
    let near = |s: &&DVec2| (**s - c.axis).normalize_or_zero().dot(to);
    let tip = c.spokes.iter().max_by(|a, b| near(a).total_cmp(&near(b)));
    let tip = tip.copied().unwrap_or(c.axis + c.reach * to);
    let high = c.hub.max(10.0);
    let radius = 0.5 * high + ROOM;
    Element::rod(tip.extend(0.5 * high), c.axis.extend(0.5 * high), radius)
}

/// The corner of a solid base in a direction.
pub(super) fn corner(s: &Seat, to: DVec2) -> Result<Element, ElementError> {
    let centre = 0.5 * (s.low + s.high);
    let far = centre + 0.5 * (s.high - s.low) * to.signum();
    let (low, high) = (centre.min(far), centre.max(far));
    block(low.extend(0.0), high.extend((s.top - s.thickness).max(1.0)))
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
