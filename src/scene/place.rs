//! How shapes are scaled, turned and put somewhere.

use super::body::Body;
use crate::mesh::TriMesh;
use crate::num::Aabb;
use crate::recipe::{Place, PlaceLike, PlainOr, Problem, ShapeEntry};
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

    /// This, then `next`.
    pub fn then(&self, next: &Self) -> Self {
        Self {
            scale: next.scale * self.scale,
            turn: (next.turn * self.turn).normalize(),
            shift: next.point(self.shift),
        }
    }

    /// From this at t = 0 to `other` at t = 1, at constant speed; exactly either at its end.
    pub fn between(&self, other: &Self, t: f64) -> Self {
        if t <= 0.0 || self == other {
            return *self;
        }
        if t >= 1.0 {
            return *other;
        }
        Self {
            scale: self.scale.powf(1.0 - t) * other.scale.powf(t),
            turn: self.turn.slerp(other.turn, t),
            shift: self.shift.lerp(other.shift, t),
        }
    }
}

/// A placed body, and of a mesh that is turned and shifted by plain numbers also what it was before and
/// how it was moved.
pub(super) type PlacedBody = (Body, Option<(TriMesh, Similarity)>);

/// Scales, turns and places a body as its entry says; `like` is the box of the shape it stands
/// like, where it does; `at` is the shape's key.
pub(super) fn place(
    body: Body,
    entry: &ShapeEntry,
    like: Option<Aabb>,
    at: &str,
) -> Result<PlacedBody, Problem> {
    let turn = DQuat::from_rotation_z(entry.turn_deg.to_radians());
    let scale = match entry.height {
        None => 1.0,
        Some(h) => body.scale_to(h).ok_or_else(|| {
            let tall = body.bounds().size().z;
            let why = format!(
                "the shape is {tall} mm high, thickness included; it cannot be scaled to {h}"
            );
            Problem::new(format!("{at}.height"), why)
        })?,
    };
    let shift = DVec3::from_array(entry.shift);
    let kept = matches!(entry.place, PlainOr::Plain(Place::Keep));
    if kept && (turn != DQuat::IDENTITY || shift != DVec3::ZERO) {
        let body = body.moved(&Similarity { scale, ..Similarity::NONE });
        let by = Similarity { turn, shift, ..Similarity::NONE };
        let still = match &body {
            Body::Mesh(mesh) => Some((mesh.clone(), by)),
            _ => None,
        };
        return Ok((body.moved(&by), still));
    }
    let body = body.moved(&Similarity { scale, turn, ..Similarity::NONE });
    let now = body.bounds();
    let to = match (&entry.place, like) {
        (PlainOr::Plain(Place::Floor), _) => -floor_point(&now),
        (PlainOr::Table(PlaceLike { .. }), Some(box_)) => floor_point(&box_) - floor_point(&now),
        _ => DVec3::ZERO,
    };
    let shift = to + shift;
    if shift == DVec3::ZERO {
        return Ok((body, None));
    }
    Ok((body.moved(&Similarity { shift, ..Similarity::NONE }), None))
}

/// The middle of the box's lowest side.
fn floor_point(b: &Aabb) -> DVec3 {
    b.centre().with_z(b.min.z)
}
