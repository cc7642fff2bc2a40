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
        Self { origin, step, size: cells.to_array().map(|n| n.max(1.0) as u32 + 1) }
    }

    /// Position of a sample, mm.
    pub fn point(&self, i: u32, j: u32, k: u32) -> DVec3 {
        self.origin + self.step * DVec3::new(f64::from(i), f64::from(j), f64::from(k))
    }

    /// The box from the first to the last sample.
    pub fn bounds(&self) -> Aabb {
        let [x, y, z] = self.size;
        Aabb::new(self.origin, self.point(x - 1, y - 1, z - 1))
    }

    /// Number of samples in all.
    pub fn samples(&self) -> u64 {
        self.size.iter().map(|&n| u64::from(n)).product()
    }
}
