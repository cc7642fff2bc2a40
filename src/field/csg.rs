//! Fields made of fields: joined, cut, filleted, offset, hollowed, moved, mirrored.

use super::{Field, Shared};
use crate::num::{Aabb, Interval};
use glam::{DAffine3, DVec3};

/// How a second solid b joins a first one a. Every form is 1-Lipschitz when both are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Join {
    /// a or b: min(a, b).
    Add,
    /// a without b: max(a, -b).
    Cut,
    /// a and b: max(a, b).
    Meet,
    /// a or b with a fillet of this width in mm: the polynomial smooth minimum
    /// min(a, b) - h² k / 4 with h = max(0, 1 - |a - b| / k).
    Blend(f64),
}

impl Join {
    /// The joined value.
    pub fn value(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Add => a.min(b),
            Self::Cut => a.max(-b),
            Self::Meet => a.max(b),
            Self::Blend(k) if k > 0.0 && (a - b).abs() < k => {
                let h = 1.0 - (a - b).abs() / k;
                a.min(b) - h * h * k * 0.25
            }
            Self::Blend(_) => a.min(b),
        }
    }

    /// Values over ranges; all forms are monotone, so the ends decide.
    pub fn range(self, a: Interval, b: Interval) -> Interval {
        let b = if self == Self::Cut { Interval::new(b.hi, b.lo) } else { b };
        Interval::new(self.value(a.lo, b.lo), self.value(a.hi, b.hi))
    }
}

/// Two fields joined.
pub struct Joined {
    /// The first.
    pub a: Shared,
    /// The second.
    pub b: Shared,
    /// How.
    pub join: Join,
}

impl Field for Joined {
    fn value(&self, p: DVec3) -> f64 {
        self.join.value(self.a.value(p), self.b.value(p))
    }

    fn bound(&self, b: &Aabb) -> Interval {
        let (x, y) = (self.a.bound(b), self.b.bound(b));
        self.join.range(x, y).widen(1e-12 * b.radius())
    }

    fn support(&self) -> Aabb {
        let (a, b) = (self.a.support(), self.b.support());
        match self.join {
            Join::Add => a.hull(b),
            Join::Cut => a,
            Join::Meet => a.meet(b),
            // a fillet lies where both distances are below k; distances do not fall below those
            // to the supports
            Join::Blend(k) => a.hull(b).hull(a.grow(k).meet(b.grow(k))),
        }
    }

    fn values(&self, at: &[DVec3], out: &mut [f64]) {
        let mut second = vec![0.0; at.len()];
        self.a.values(at, out);
        self.b.values(at, &mut second);
        for (f, b) in out.iter_mut().zip(second) {
            *f = self.join.value(*f, b);
        }
    }
}

/// Grown by a distance: f - d.
///
/// Outside its support the inner field must not fall below the distance to it, which holds for
/// every signed distance field here.
pub struct Offset {
    /// What is grown.
    pub field: Shared,
    /// d, mm; negative shrinks.
    pub distance: f64,
}

impl Field for Offset {
    fn value(&self, p: DVec3) -> f64 {
        self.field.value(p) - self.distance
    }

    fn bound(&self, b: &Aabb) -> Interval {
        self.field.bound(b).shift(-self.distance)
    }

    fn support(&self) -> Aabb {
        self.field.support().grow(self.distance.max(0.0))
    }
}

/// The surface given a thickness, half of it to either side: |f| - thickness / 2.
/// The remark at [`Offset`] holds.
pub struct Shell {
    /// The solid whose surface it is.
    pub field: Shared,
    /// mm.
    pub thickness: f64,
}

impl Field for Shell {
    fn value(&self, p: DVec3) -> f64 {
        self.field.value(p).abs() - 0.5 * self.thickness
    }

    fn bound(&self, b: &Aabb) -> Interval {
        self.field.bound(b).abs().shift(-0.5 * self.thickness)
    }

    fn support(&self) -> Aabb {
        self.field.support().grow(0.5 * self.thickness.max(0.0))
    }
}

/// A map that is no similarity was given where distances must be kept.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the map stretches by {least} to {most}; expected one scale in all directions")]
pub struct Uneven {
    /// Shortest axis after the map.
    pub least: f64,
    /// Longest axis after the map.
    pub most: f64,
}

/// A field moved, turned, mirrored or scaled evenly; distances stay distances.
pub struct Moved {
    field: Shared,
    by: DAffine3,
    back: DAffine3,
    scale: f64,
}

impl Moved {
    /// `field` after the map `by`.
    ///
    /// # Errors
    /// [`Uneven`] if `by` is no similarity.
    pub fn new(field: Shared, by: DAffine3) -> Result<Self, Uneven> {
        let m = by.matrix3;
        let axes = [m.x_axis, m.y_axis, m.z_axis];
        let lengths = axes.map(DVec3::length);
        let (least, most) =
            lengths.iter().fold((f64::INFINITY, 0.0f64), |(l, m), &x| (l.min(x), m.max(x)));
        let slant =
            [(0, 1), (1, 2), (2, 0)].map(|(i, j): (usize, usize)| axes[i].dot(axes[j]).abs());
        let square = slant.iter().all(|s| *s <= 1e-9 * most * most);
        if !(by.is_finite() && least > 0.0 && most - least <= 1e-9 * most && square) {
            return Err(Uneven { least, most });
        }
        Ok(Self { field, by, back: by.inverse(), scale: most })
    }
}

/// A box round the image of a box.
fn image(map: &DAffine3, b: &Aabb) -> Aabb {
    let half = map.matrix3.abs() * (b.size() * 0.5);
    let centre = map.transform_point3(b.centre());
    let slack = 1e-12 * (centre.abs().max_element() + half.max_element());
    Aabb::around(centre, half).grow(slack)
}

impl Field for Moved {
    fn value(&self, p: DVec3) -> f64 {
        self.scale * self.field.value(self.back.transform_point3(p))
    }

    fn bound(&self, b: &Aabb) -> Interval {
        self.field.bound(&image(&self.back, b)).scale(self.scale)
    }

    fn bounds(&self, boxes: &[Aabb], out: &mut [Interval]) {
        let moved: Vec<Aabb> = boxes.iter().map(|b| image(&self.back, b)).collect();
        self.field.bounds(&moved, out);
        out.iter_mut().for_each(|f| *f = f.scale(self.scale));
    }

    fn support(&self) -> Aabb {
        image(&self.by, &self.field.support())
    }

    fn bytes(&self) -> usize {
        self.field.bytes()
    }

    fn values(&self, at: &[DVec3], out: &mut [f64]) {
        let moved: Vec<DVec3> = at.iter().map(|&p| self.back.transform_point3(p)).collect();
        self.field.values(&moved, out);
        out.iter_mut().for_each(|f| *f *= self.scale);
    }
}

/// A field together with its mirror image.
pub struct Mirror {
    /// One side; what crosses the plane is united with its image.
    pub field: Shared,
    /// World axis 0, 1, 2 (x, y, z) that is turned round; the plane goes through the origin.
    pub axis: usize,
}

impl Mirror {
    fn turn(&self, mut p: DVec3) -> DVec3 {
        if let Some(x) = p.as_mut().get_mut(self.axis) {
            *x = -*x;
        }
        p
    }

    fn turn_box(&self, b: &Aabb) -> Aabb {
        Aabb::of([self.turn(b.min), self.turn(b.max)])
    }
}

impl Field for Mirror {
    fn value(&self, p: DVec3) -> f64 {
        self.field.value(p).min(self.field.value(self.turn(p)))
    }

    fn bound(&self, b: &Aabb) -> Interval {
        self.field.bound(b).min(self.field.bound(&self.turn_box(b)))
    }

    fn support(&self) -> Aabb {
        let b = self.field.support();
        b.hull(self.turn_box(&b))
    }
}
