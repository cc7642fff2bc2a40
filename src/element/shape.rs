use super::{ElementError, ellipsoid};
use crate::num::Aabb;
use crate::num::lanes::Vec8;
use crate::warp::{Barr, Near};
use fearless_simd::{Simd, f64x8, prelude::*};
use glam::{DVec2, DVec3};
use std::fmt::Debug;
use std::sync::Arc;

/// A closed form of the user's own, in normal coordinates.
pub trait Form: Send + Sync + Debug {
    /// Signed distance in normal coordinates, negative inside; 1-Lipschitz, the exact zero set.
    fn distance(&self, q: DVec3) -> f64;
    /// A box round the form, within -1..1 in every axis.
    fn bounds(&self) -> Aabb;
}

/// The unit form of an element, in normal coordinates; the axis is z.
#[derive(Clone, Debug)]
pub enum Shape {
    /// |x|, |y|, |z| <= 1.
    Block,
    /// x² + y² <= 1, |z| <= 1.
    Cylinder,
    /// Ball-ended rod; the ends are round in space, not in normal coordinates. Its half length
    /// counts to the tips.
    Capsule,
    /// x² + y² + z² <= 1.
    Ellipsoid,
    /// A convex polygon in the x-y plane, counter-clockwise, in the unit square; |z| <= 1.
    /// [`Shape::prism`] checks it.
    Prism(Arc<[DVec2]>),
    /// A closed mesh, or anything else with a distance. Exact when the half sizes are equal; else
    /// scaled down by the smallest.
    Mesh(Arc<dyn Form>),
    /// Unlike shapes averaged: the weighted mean of the parts' distances. Weights sum to one.
    Mix(Vec<(Shape, f64)>),
}

impl PartialEq for Shape {
    fn eq(&self, o: &Self) -> bool {
        match (self, o) {
            (Self::Block, Self::Block)
            | (Self::Cylinder, Self::Cylinder)
            | (Self::Capsule, Self::Capsule)
            | (Self::Ellipsoid, Self::Ellipsoid) => true,
            (Self::Prism(a), Self::Prism(b)) => a == b,
            (Self::Mesh(a), Self::Mesh(b)) => Arc::ptr_eq(a, b),
            (Self::Mix(a), Self::Mix(b)) => a == b,
            _ => false,
        }
    }
}

/// A form seen in a mirror: x is turned round.
#[derive(Debug)]
struct Mirrored(Arc<dyn Form>);

impl Form for Mirrored {
    fn distance(&self, q: DVec3) -> f64 {
        self.0.distance(DVec3::new(-q.x, q.y, q.z))
    }
    fn bounds(&self) -> Aabb {
        let b = self.0.bounds();
        Aabb::new(DVec3::new(-b.max.x, b.min.y, b.min.z), DVec3::new(-b.min.x, b.max.y, b.max.z))
    }
}

/// A deformation made ready for distances.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bent {
    pub barr: Barr,
    pub near: Near,
    pub bounds: Aabb,
}

impl Bent {
    pub fn new(barr: Barr, half: DVec3) -> Self {
        Self { barr, near: barr.near(half), bounds: barr.bounds(half) }
    }
}

impl Shape {
    /// A prism over a convex polygon in the unit square, counter-clockwise.
    pub fn prism(polygon: &[DVec2]) -> Result<Self, ElementError> {
        let n = polygon.len();
        if n < 3 {
            return Err(ElementError::Polygon("has fewer than 3 corners"));
        }
        if !polygon.iter().all(|p| p.abs().max_element() <= 1.0 + 1e-9) {
            return Err(ElementError::Polygon("leaves the unit square"));
        }
        let mut turn = 0.0;
        for (i, &a) in polygon.iter().enumerate() {
            let (b, c) = (polygon[(i + 1) % n], polygon[(i + 2) % n]);
            if (b - a).perp_dot(c - b) <= 0.0 {
                return Err(ElementError::Polygon("is not convex and counter-clockwise"));
            }
            turn += (b - a).angle_to(c - b);
        }
        // a star turns left at every corner too, but more than once round
        if turn > 1.5 * std::f64::consts::TAU {
            return Err(ElementError::Polygon("winds round more than once"));
        }
        Ok(Self::Prism(polygon.into()))
    }

    /// The shape with x turned round.
    pub(super) fn mirrored(&self) -> Self {
        match self {
            Self::Prism(p) => Self::Prism(p.iter().rev().map(|p| DVec2::new(-p.x, p.y)).collect()),
            Self::Mesh(form) => Self::Mesh(Arc::new(Mirrored(form.clone()))),
            Self::Mix(parts) => Self::Mix(parts.iter().map(|(s, w)| (s.mirrored(), *w)).collect()),
            plain => plain.clone(),
        }
    }

    /// Signed distance at `v` (mm, element axes) to the shape of half sizes `half`, its edges
    /// rounded by `round`, deformed.
    pub(super) fn deformed_distance(
        &self,
        half: DVec3,
        bent: Option<&Bent>,
        round: f64,
        v: DVec3,
    ) -> f64 {
        let Some(Bent { barr, near, bounds }) = bent else {
            return self.rounded_distance(half, round, v);
        };
        let u = barr.pull(v);
        let d = self.rounded_distance(half, round, u);
        let outside = Aabb::around(DVec3::ZERO, half).distance(u);
        let d = if outside > 0.0 { d.max(outside) } else { d };
        let d = d.min(near.cap) / near.stretch;
        // far away the box round the body knows more than the cut-off distance
        let far = bounds.distance(v);
        if far > 0.0 { d.max(far) } else { d }
    }

    fn rounded_distance(&self, half: DVec3, round: f64, v: DVec3) -> f64 {
        // those two have no edges to round
        if round <= 0.0 || matches!(self, Self::Ellipsoid | Self::Capsule) {
            return self.distance(half, v);
        }
        // a body thinner than its rounding keeps a trace of a core
        let round = round.min(half.min_element() * (1.0 - 1e-9));
        if let Self::Prism(corners) = self {
            // the outline stays, slanted sides too; only the rims round it are softened
            let d = polygon(corners, half.truncate(), v.truncate());
            return joined(&[d + round, v.z.abs() - half.z + round]) - round;
        }
        self.distance(half - round, v) - round
    }

    /// Signed distance at `v` to the shape of half sizes `half`, mm.
    fn distance(&self, half: DVec3, v: DVec3) -> f64 {
        match self {
            Self::Block => joined(&(v.abs() - half).to_array()),
            Self::Cylinder => joined(&[section(half, v), v.z.abs() - half.z]),
            Self::Capsule => capsule(half, v),
            Self::Ellipsoid => ellipsoid::distance(half.to_array(), v.to_array()),
            Self::Prism(corners) => {
                let d = polygon(corners, half.truncate(), v.truncate());
                joined(&[d, v.z.abs() - half.z])
            }
            Self::Mesh(form) => {
                let b = form.bounds();
                let far = Aabb::new(b.min * half, b.max * half).distance(v);
                let d = form.distance(v / half) * half.min_element();
                if far > 0.0 { d.max(far) } else { d }
            }
            Self::Mix(parts) => parts.iter().map(|(s, w)| w * s.distance(half, v)).sum(),
        }
    }
}

impl Shape {
    /// The plain distance of eight points, for the shapes that have a short form.
    #[inline(always)]
    pub(super) fn plain_distances<S: Simd>(
        &self,
        s: S,
        half: DVec3,
        v: Vec8<S>,
    ) -> Option<f64x8<S>> {
        let zero = f64x8::splat(s, 0.0);
        match self {
            Self::Block => {
                let d = v.abs().less(Vec8::splat(s, half));
                let inside = d.greatest();
                let (x, y, z) = (d.x.max(zero), d.y.max(zero), d.z.max(zero));
                let outside = (x * x + y * y + z * z).sqrt();
                Some(inside.simd_le(zero).select(inside, outside))
            }
            Self::Cylinder if half.x == half.y => {
                let side = (v.x * v.x + v.y * v.y).sqrt() - half.x;
                let end = v.z.abs() - half.z;
                let inside = side.max(end);
                let (x, z) = (side.max(zero), end.max(zero));
                Some(inside.simd_le(zero).select(inside, (x * x + z * z).sqrt()))
            }
            _ => None,
        }
    }
}

/// Distance to where all of several constraints on perpendicular directions hold.
fn joined(d: &[f64]) -> f64 {
    let inside = d.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if inside <= 0.0 {
        return inside;
    }
    d.iter().map(|d| d.max(0.0) * d.max(0.0)).sum::<f64>().sqrt()
}

/// Distance to the (perhaps elliptical) section of a cylinder.
fn section(half: DVec3, v: DVec3) -> f64 {
    if half.x == half.y {
        v.truncate().length() - half.x
    } else {
        ellipsoid::distance([half.x, half.y], [v.x, v.y])
    }
}

/// Where the three half sizes differ, space is squeezed until the section is round; that never
/// lengthens, so the distance stays a lower bound, raised to that of the box far away.
fn capsule(half: DVec3, v: DVec3) -> f64 {
    let radius = half.min_element();
    let u = DVec2::new(v.x * (radius / half.x), v.y * (radius / half.y));
    let along = (v.z.abs() - (half.z - radius)).max(0.0);
    let d = u.extend(along).length() - radius;
    if half.x == half.y && radius < half.z {
        return d;
    }
    let far = Aabb::around(DVec3::ZERO, half).distance(v);
    if far > 0.0 { d.max(far) } else { d }
}

/// Distance to a convex polygon whose corners are scaled by `half`.
fn polygon(corners: &[DVec2], half: DVec2, p: DVec2) -> f64 {
    let Some(&last) = corners.last() else {
        return p.length();
    };
    let mut a = last * half;
    let (mut squared, mut inside) = (f64::INFINITY, f64::NEG_INFINITY);
    for &c in corners {
        let b = c * half;
        let (edge, to) = (b - a, p - a);
        let t = (to.dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
        squared = squared.min((to - edge * t).length_squared());
        inside = inside.max(to.perp_dot(edge));
        a = b;
    }
    if inside <= 0.0 { -squared.sqrt() } else { squared.sqrt() }
}
