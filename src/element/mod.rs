//! Feature elements: a shape in a frame, perhaps twisted, tapered or bent along its axis.
//!
//! An element maps its own normal coordinates (the shape's unit form: |x|,|y|,|z| <= 1) to space:
//! `to_world(q) = centre + rotation * deform(half * q)`. Two elements correspond point by point
//! through those coordinates, whatever their shapes (paper 001, section 3).

use crate::num::{Aabb, Interval};
use crate::warp::Deform;
use glam::{DQuat, DVec3};

/// The unit form of an element, in normal coordinates; the axis is z.
#[derive(Clone, Debug)]
pub enum Shape {
    /// |x|, |y|, |z| <= 1.
    Block,
    /// x² + y² <= 1, |z| <= 1.
    Cylinder,
    /// Ball-ended rod; the ends are round in space, not in normal coordinates.
    Capsule,
    /// x² + y² + z² <= 1.
    Ellipsoid,
    // prism, mesh, mix of shapes: to come
}

/// A shape in space.
#[derive(Clone, Debug)]
pub struct Element {
    /// Unit form.
    pub shape: Shape,
    /// Centre, mm.
    pub centre: DVec3,
    /// From element axes to world axes.
    pub rotation: DQuat,
    /// Half the size along each element axis, mm.
    pub half: DVec3,
    /// Twist, taper and bend along the element's z.
    pub deform: Deform,
}

impl Element {
    /// Normal coordinates of a point in space.
    pub fn to_local(&self, p: DVec3) -> DVec3 {
        let _ = p;
        todo!()
    }
    /// The point in space of normal coordinates.
    pub fn to_world(&self, q: DVec3) -> DVec3 {
        let _ = q;
        todo!()
    }
    /// Signed distance (mm, negative inside); 1-Lipschitz, with the exact zero set.
    pub fn distance(&self, p: DVec3) -> f64 {
        let _ = p;
        todo!()
    }
    /// An enclosure of the distance over a box.
    pub fn distance_bound(&self, b: &Aabb) -> Interval {
        Interval::ball(self.distance(b.centre()), b.radius())
    }
    /// A box round the element.
    pub fn bounds(&self) -> Aabb {
        todo!()
    }
}

/// The weighted mean of corresponding elements (METHODS H): centre linear, half sizes in the
/// logarithm, rotation by the Karcher mean after resolving the shape's symmetries, twist and bend
/// linear, taper in the logarithm. Weights need not sum to one.
pub fn average(elements: &[(&Element, f64)]) -> Element {
    let _ = elements;
    todo!()
}

/// The map from one element onto another through their normal coordinates:
/// `pull(p) = to.to_world(from.to_local(p))`.
pub struct Between {
    /// Where points come from.
    pub from: Element,
    /// Where they go.
    pub to: Element,
}
