//! How shapes are scaled, turned and put somewhere.

use super::body::Body;
use crate::num::Aabb;
use crate::recipe::{Place, PlaceLike, PlainOr, ShapeEntry};
use glam::{DQuat, DVec3};

/// A uniform scale, then a turn about z, then a shift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Similarity {
    pub scale: f64,
    pub turn: DQuat,
    pub shift: DVec3,
}

impl Similarity {
    pub const NONE: Self = Self { scale: 1.0, turn: DQuat::IDENTITY, shift: DVec3::ZERO };

    pub fn point(&self, p: DVec3) -> DVec3 {
        self.shift + self.turn * (p * self.scale)
    }
}

/// Scales, turns and places a body as its entry says; `like` is the box of the shape it stands
/// like, where it does.
pub(super) fn place(body: Body, entry: &ShapeEntry, like: Option<Aabb>) -> Body {
    let turn = DQuat::from_rotation_z(entry.turn_deg.to_radians());
    let tall = body.bounds().size().z;
    // a body without height cannot be scaled to one; it is refused as empty later
    let scale = entry.height.filter(|_| tall > 0.0).map_or(1.0, |h| h / tall);
    let body = body.moved(&Similarity { scale, turn, ..Similarity::NONE });
    let now = body.bounds();
    let shift = match (&entry.place, like) {
        (PlainOr::Plain(Place::Floor), _) => -floor_point(&now),
        (PlainOr::Table(PlaceLike { .. }), Some(box_)) => floor_point(&box_) - floor_point(&now),
        _ => DVec3::ZERO,
    };
    let shift = shift + DVec3::from_array(entry.shift);
    if shift == DVec3::ZERO { body } else { body.moved(&Similarity { shift, ..Similarity::NONE }) }
}

/// The middle of the box's lowest side.
fn floor_point(b: &Aabb) -> DVec3 {
    b.centre().with_z(b.min.z)
}
