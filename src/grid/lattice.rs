use crate::num::Aabb;
use glam::DVec3;

/// A regular grid of sample points: sample (i, j, k) lies at `origin + step * (i, j, k)`.
///
/// With origin (0, 0, 0) and step 2, sample (1, 0, 0) lies at (2, 0, 0) and the cell between
/// samples (0, 0, 0) and (1, 1, 1) spans 0..2 in every axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// Position of sample (0, 0, 0), mm.
    pub origin: DVec3,
    /// Distance between neighbouring samples, mm.
    pub step: f64,
    /// Number of samples along x, y, z.
    pub size: [u32; 3],
}

impl Lattice {
    /// The lattice of that step over a box: the box is centred in it, with at least one whole
    /// cell to spare on every side.
    pub fn covering(domain: &Aabb, step: f64) -> Self {
        let cells = (domain.size() / step).ceil() + 2.0;
        let origin = domain.centre() - cells * step * 0.5;
        Self { origin, step, size: cells.to_array().map(|n| (n.max(1.0) as u32).saturating_add(1)) }
    }

    /// Position of a sample, mm.
    pub fn point(&self, i: u32, j: u32, k: u32) -> DVec3 {
        self.origin + self.step * DVec3::new(f64::from(i), f64::from(j), f64::from(k))
    }

    /// The box from the first to the last sample.
    pub fn bounds(&self) -> Aabb {
        let [x, y, z] = self.size;
        let last = |n: u32| n.saturating_sub(1);
        Aabb::new(self.origin, self.point(last(x), last(y), last(z)))
    }

    /// Number of samples in all.
    pub fn samples(&self) -> u64 {
        self.size.iter().fold(1, |n, &side| u64::saturating_mul(n, u64::from(side)))
    }

    /// Whether f32 files can tell the points of a cell apart: the step is at least 256 ulps of the
    /// largest coordinate. Below that no mesh file of f32 positions can be trusted.
    pub fn fits_f32(&self) -> bool {
        let b = self.bounds();
        let largest = b.min.abs().max(b.max.abs()).max_element();
        largest < f64::from(f32::MAX) && self.step >= 256.0 * ulp(largest)
    }
}

/// Distance between neighbouring f32 numbers near `x`.
pub fn ulp(x: f64) -> f64 {
    let a = (x.abs() as f32).max(f32::MIN_POSITIVE);
    f64::from(a.next_up()) - f64::from(a)
}
