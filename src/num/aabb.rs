use glam::DVec3;

/// An axis-aligned box, in millimetres; empty when `min > max` in any axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Lowest corner.
    pub min: DVec3,
    /// Highest corner.
    pub max: DVec3,
}

impl Aabb {
    /// The box that holds nothing; the start of every hull.
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };
    /// All of space.
    pub const ALL: Self = Self { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };

    /// From corner to corner.
    pub const fn new(min: DVec3, max: DVec3) -> Self {
        Self { min, max }
    }

    /// The smallest box round some points; [`Aabb::EMPTY`] for none.
    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::with)
    }

    /// Centre and half the side lengths.
    pub fn around(centre: DVec3, half: DVec3) -> Self {
        Self { min: centre - half, max: centre + half }
    }

    /// Grown to hold `p`.
    pub fn with(self, p: DVec3) -> Self {
        Self { min: self.min.min(p), max: self.max.max(p) }
    }

    /// The smallest box that holds both.
    pub fn hull(self, o: Self) -> Self {
        Self { min: self.min.min(o.min), max: self.max.max(o.max) }
    }

    /// The common part, perhaps empty.
    pub fn meet(self, o: Self) -> Self {
        Self { min: self.min.max(o.min), max: self.max.min(o.max) }
    }

    /// Whether no point lies in it.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// Whether all six sides are finite numbers.
    pub fn is_finite(&self) -> bool {
        self.min.is_finite() && self.max.is_finite()
    }

    /// Whether `p` lies in it, sides included.
    pub fn contains(&self, p: DVec3) -> bool {
        self.min.cmple(p).all() && p.cmple(self.max).all()
    }

    /// Middle point.
    pub fn centre(&self) -> DVec3 {
        (self.min + self.max) * 0.5
    }

    /// Side lengths.
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }

    /// Half the diagonal: the radius of the ball round the box.
    pub fn radius(&self) -> f64 {
        self.size().length() * 0.5
    }

    /// Larger by `by` mm on every side.
    pub fn grow(self, by: f64) -> Self {
        Self { min: self.min - by, max: self.max + by }
    }

    /// The point of the box nearest to `p`.
    pub fn clamp(&self, p: DVec3) -> DVec3 {
        p.clamp(self.min, self.max)
    }

    /// Distance from `p` to the box, 0 inside.
    pub fn distance(&self, p: DVec3) -> f64 {
        (p - self.clamp(p)).length()
    }

    /// The eight corners, x fastest.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            DVec3::new(
                if i & 1 == 0 { self.min.x } else { self.max.x },
                if i & 2 == 0 { self.min.y } else { self.max.y },
                if i & 4 == 0 { self.min.z } else { self.max.z },
            )
        })
    }
}
