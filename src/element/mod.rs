//! Feature elements: a shape in a frame, perhaps twisted, tapered or bent along its axis.
//!
//! An element maps its own normal coordinates (the shape's unit form: |x|,|y|,|z| <= 1) to space:
//! `to_world(q) = centre + rotation * deform(half * q)`. Two elements correspond point by point
//! through those coordinates, whatever their shapes (paper 001, section 3).
//!
//! ```
//! use fieldgraft::element::Element;
//! use glam::DVec3;
//! let leg = Element::rod(DVec3::ZERO, DVec3::new(0.0, 0.0, 400.0), 20.0)?;
//! assert_eq!(leg.distance(DVec3::new(50.0, 0.0, 100.0)), 30.0);
//! # Ok::<(), fieldgraft::element::ElementError>(())
//! ```

mod align;
mod between;
mod ellipsoid;
mod gauge;
mod mean;
mod shape;
mod tessellate;

pub use align::align;
pub use between::Between;
pub use gauge::Gauge;
pub use mean::{ambiguous, average};
pub use shape::{Form, Shape};
pub use tessellate::{middle_sheet, tessellate};

use crate::num::{Aabb, Interval};
use crate::warp::{Barr, Deform, WarpError};
use glam::{DMat3, DQuat, DVec3};
use shape::Bent;

/// Why an element is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ElementError {
    /// A size that is zero, negative or not finite.
    #[error("size is {size} mm along {axis} of the element; expected more than 0")]
    Size {
        /// `x`, `y` or `z`.
        axis: char,
        /// The full size, mm.
        size: f64,
    },
    /// A coordinate or angle that is not a number.
    #[error("the element's place or rotation is not finite")]
    Place,
    /// Two ends in one place.
    #[error("the two ends of the element are {0} mm apart; expected more than 0")]
    Ends(f64),
    /// Not a convex counter-clockwise outline in the unit square.
    #[error("the prism's polygon {0}")]
    Polygon(&'static str),
    /// A deformation that this body cannot take.
    #[error(transparent)]
    Warp(#[from] WarpError),
}

/// A shape in space.
#[derive(Clone, Debug, PartialEq)]
pub struct Element {
    /// Unit form.
    pub shape: Shape,
    /// Centre, mm.
    pub centre: DVec3,
    /// From element axes to world axes.
    pub rotation: DQuat,
    /// Half the size along each element axis, mm, more than 0.
    pub half: DVec3,
    /// Twist, taper and bend along the element's z.
    pub deform: Deform,
}

impl Element {
    /// Checked, with the rotation made a unit quaternion.
    pub fn new(
        shape: Shape,
        centre: DVec3,
        rotation: DQuat,
        half: DVec3,
        deform: Deform,
    ) -> Result<Self, ElementError> {
        if let Some(i) = (0..3).find(|&i| !(half[i] > 0.0 && half[i].is_finite())) {
            return Err(ElementError::Size { axis: ['x', 'y', 'z'][i], size: 2.0 * half[i] });
        }
        let length = rotation.length();
        if !(centre.is_finite() && length.is_finite() && length > 0.0) {
            return Err(ElementError::Place);
        }
        let deform = Deform::new(deform.twist, deform.taper, deform.bend)?;
        Barr::check(&deform, half)?;
        Ok(Self { shape, centre, rotation: rotation / length, half, deform })
    }

    /// A box with these half sizes.
    pub fn block(centre: DVec3, half: DVec3, rotation: DQuat) -> Result<Self, ElementError> {
        Self::new(Shape::Block, centre, rotation, half, Deform::NONE)
    }

    /// A round cylinder from end to end; z runs from `from` to `to`, turned from the world's z by
    /// the smallest rotation.
    pub fn rod(from: DVec3, to: DVec3, radius: f64) -> Result<Self, ElementError> {
        Self::along(Shape::Cylinder, from, to, radius, 0.0)
    }

    /// A ball-ended rod; `from` and `to` are the centres of the balls.
    pub fn capsule(from: DVec3, to: DVec3, radius: f64) -> Result<Self, ElementError> {
        Self::along(Shape::Capsule, from, to, radius, radius)
    }

    fn along(
        shape: Shape,
        from: DVec3,
        to: DVec3,
        radius: f64,
        beyond: f64,
    ) -> Result<Self, ElementError> {
        let axis = to - from;
        let length = axis.length();
        if !length.is_finite() {
            return Err(ElementError::Place);
        }
        if length == 0.0 {
            return Err(ElementError::Ends(length));
        }
        let rotation = DQuat::from_rotation_arc(DVec3::Z, axis / length);
        let half = DVec3::new(radius, radius, length * 0.5 + beyond);
        Self::new(shape, (from + to) * 0.5, rotation, half, Deform::NONE)
    }

    /// With another deformation.
    pub fn deformed(self, deform: Deform) -> Result<Self, ElementError> {
        Self::new(self.shape, self.centre, self.rotation, self.half, deform)
    }

    /// The mirror image in the plane where world axis `axis` (0, 1, 2: x, y, z) is zero, mapped so
    /// that mirrored points have the same normal coordinates but for the sign of x.
    pub fn mirrored(&self, axis: usize) -> Self {
        let mut flip = DVec3::ONE;
        if let Some(f) = flip.as_mut().get_mut(axis) {
            *f = -1.0;
        }
        // mirror * R * mirror_x is a rotation again; the shape takes the other mirror_x
        let mirror = DMat3::from_diagonal(flip);
        let own = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
        let turned = mirror * DMat3::from_quat(self.rotation) * own;
        Self {
            shape: self.shape.mirrored(),
            centre: self.centre * flip,
            rotation: DQuat::from_mat3(&turned).normalize(),
            half: self.half,
            deform: Deform { twist: -self.deform.twist, ..self.deform },
        }
    }

    /// Normal coordinates of a point in space.
    pub fn to_local(&self, p: DVec3) -> DVec3 {
        let v = self.rotation.conjugate() * (p - self.centre);
        self.barr().map_or(v, |b| b.pull(v)) / self.half
    }

    /// The point in space of normal coordinates.
    pub fn to_world(&self, q: DVec3) -> DVec3 {
        let v = q * self.half;
        self.centre + self.rotation * self.barr().map_or(v, |b| b.push(v))
    }

    /// Signed distance (mm, negative inside): 1-Lipschitz, with the exact zero set, and never more
    /// than the true distance in size. Exact for undeformed blocks, prisms, ellipsoids, cylinders
    /// and round capsules.
    pub fn distance(&self, p: DVec3) -> f64 {
        self.distance_rounded(p, 0.0)
    }

    /// The distance to the element with its edges rounded by `round` mm, its size unchanged.
    pub fn distance_rounded(&self, p: DVec3, round: f64) -> f64 {
        let v = self.rotation.conjugate() * (p - self.centre);
        self.shape.deformed_distance(self.half, self.bent().as_ref(), round, v)
    }

    /// An enclosure of the distance over a box.
    pub fn distance_bound(&self, b: &Aabb) -> Interval {
        let d = self.distance(b.centre());
        Interval::ball(d, b.radius()).widen(1e-12 * (d.abs() + b.radius()))
    }

    /// A box round the element.
    pub fn bounds(&self) -> Aabb {
        let b = self.local_bounds();
        let m = DMat3::from_quat(self.rotation);
        if self.deform.is_none() && matches!(self.shape, Shape::Ellipsoid) {
            let scaled = (m * DMat3::from_diagonal(self.half)).transpose();
            let reach = scaled.to_cols_array_2d().map(|c| DVec3::from_array(c).length());
            return Aabb::around(self.centre, DVec3::from_array(reach));
        }
        let half = m.abs() * (b.size() * 0.5);
        Aabb::around(self.centre + m * b.centre(), half)
    }

    /// A box round the element in its own axes, mm from its centre.
    fn local_bounds(&self) -> Aabb {
        self.barr().map_or(Aabb::around(DVec3::ZERO, self.half), |b| b.bounds(self.half))
    }

    fn barr(&self) -> Option<Barr> {
        (!self.deform.is_none()).then(|| Barr::new(&self.deform, self.half))
    }

    fn bent(&self) -> Option<Bent> {
        self.barr().map(|b| Bent::new(b, self.half))
    }

    /// Ready for many distance queries, its edges rounded by `round` mm.
    pub fn gauge(&self, round: f64) -> Gauge {
        Gauge::new(self, round)
    }

    /// The map that takes this element onto another.
    pub fn between(&self, to: &Element) -> Between {
        Between::new(self.clone(), to.clone())
    }
}

#[cfg(test)]
mod tests;
