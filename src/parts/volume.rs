//! The solid part of space on a small regular grid, in an upright frame of its own.

use super::mask::Mask;
use crate::field::Field;
use crate::field::sample::sample;
use crate::grid::Lattice;
use crate::job::{Cancelled, Job};
use crate::num::{Aabb, Interval};
use glam::{DQuat, DVec2, DVec3};

/// A turn about z, then a shift in the plan: from where a shape stands to where it is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stand {
    /// Radians.
    pub turn: f64,
    /// mm.
    pub shift: DVec3,
}

impl Stand {
    pub const KEPT: Self = Self { turn: 0.0, shift: DVec3::ZERO };

    pub fn point(&self, p: DVec3) -> DVec3 {
        DQuat::from_rotation_z(self.turn) * p + self.shift
    }

    fn back(&self, p: DVec3) -> DVec3 {
        DQuat::from_rotation_z(-self.turn) * (p - self.shift)
    }
}

/// A field that has been stood elsewhere and grown a little, so that thin parts are not missed.
struct Stood<'a> {
    field: &'a dyn Field,
    stand: Stand,
    grow: f64,
}

impl Field for Stood<'_> {
    fn value(&self, p: DVec3) -> f64 {
        self.field.value(self.stand.back(p)) - self.grow
    }

    fn values(&self, at: &[DVec3], out: &mut [f64]) {
        let back: Vec<DVec3> = at.iter().map(|&p| self.stand.back(p)).collect();
        self.field.values(&back, out);
        out.iter_mut().for_each(|v| *v -= self.grow);
    }

    fn bound(&self, b: &Aabb) -> Interval {
        let image = Aabb::of(b.corners().map(|p| self.stand.back(p)));
        self.field.bound(&image.grow(1e-9 * (1.0 + b.radius()))).shift(-self.grow)
    }

    fn support(&self) -> Aabb {
        let own = self.field.support();
        if !own.is_finite() {
            return Aabb::ALL;
        }
        let image = Aabb::of(own.corners().map(|p| self.stand.point(p)));
        image.grow(self.grow + 1e-9 * (1.0 + image.radius()))
    }
}

/// Which samples of a lattice lie in the shape or nearer to it than half a step.
pub(super) struct Volume {
    /// Samples along x, y, z.
    pub size: [usize; 3],
    /// Where the samples lie, mm.
    pub lattice: Lattice,
    solid: Vec<bool>,
}

impl Volume {
    /// Samples the field as it stands in `stand`.
    pub fn sample(
        field: &dyn Field,
        stand: Stand,
        lattice: Lattice,
        job: &dyn Job,
    ) -> Result<Self, Cancelled> {
        let stood = Stood { field, stand, grow: 0.5 * lattice.step };
        let bricks = sample(&stood, lattice, job)?.bricks;
        let size = lattice.size.map(|n| n as usize);
        let mut solid = vec![false; size.iter().product()];
        let mut row = vec![1.0_f32; size[0]];
        for (n, out) in solid.chunks_exact_mut(size[0].max(1)).enumerate() {
            let (j, k) = ((n % size[1]) as i64, (n / size[1]) as i64);
            bricks.row([0, j, k], -1.0, 1.0, &mut row);
            for (s, f) in out.iter_mut().zip(&row) {
                *s = *f < 0.0;
            }
        }
        Ok(Self { size, lattice, solid })
    }

    #[cfg(test)]
    pub fn of(lattice: Lattice, solid: impl Fn(DVec3) -> bool) -> Self {
        let size = lattice.size.map(|n| n as usize);
        let mut v = Self { size, lattice, solid: vec![false; size.iter().product()] };
        for n in 0..v.solid.len() {
            v.solid[n] = solid(v.point(v.place(n)));
        }
        v
    }

    fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.size[1] + j) * self.size[0] + i
    }

    fn place(&self, n: usize) -> [usize; 3] {
        let [x, y, _] = self.size;
        [n % x, n / x % y, n / (x * y)]
    }

    /// Whether a sample is solid; outside the lattice none is.
    pub fn get(&self, at: [usize; 3]) -> bool {
        at.iter().zip(&self.size).all(|(a, n)| a < n) && self.solid[self.index(at)]
    }

    /// The place of a sample, mm.
    pub fn point(&self, [i, j, k]: [usize; 3]) -> DVec3 {
        self.lattice.point(i as u32, j as u32, k as u32)
    }

    /// Height of a level in mm; levels need not be whole.
    pub fn height(&self, level: f64) -> f64 {
        self.lattice.origin.z + level * self.lattice.step
    }

    /// The place in mm of a point in samples.
    pub fn plan(&self, p: DVec2) -> DVec2 {
        self.lattice.origin.truncate() + p * self.lattice.step
    }

    /// The solid samples.
    pub fn solids(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        self.solid.iter().enumerate().filter(|(_, s)| **s).map(|(n, _)| self.place(n))
    }

    /// The solid samples that have an empty neighbour.
    pub fn skin(&self) -> Vec<[usize; 3]> {
        let open = |at: &[usize; 3]| {
            (0..3).any(|axis| {
                let (mut low, mut high) = (*at, *at);
                low[axis] = low[axis].wrapping_sub(1);
                high[axis] += 1;
                !self.get(low) || !self.get(high)
            })
        };
        self.solids().filter(open).collect()
    }

    /// The lowest and highest levels with a solid sample.
    pub fn levels(&self) -> Option<(usize, usize)> {
        let mut ks = self.solids().map(|p| p[2]);
        let first = ks.next()?;
        Some((first, ks.last().unwrap_or(first)))
    }

    /// The section at a level.
    pub fn section(&self, k: usize) -> Mask {
        let [nx, ny, nz] = self.size;
        if k >= nz {
            return Mask::empty(nx, ny);
        }
        let n = nx * ny;
        Mask::new(nx, self.solid[k * n..(k + 1) * n].to_vec())
    }

    /// The union of the sections of some levels.
    pub fn sections(&self, levels: std::ops::Range<usize>) -> Mask {
        let mut all = Mask::empty(self.size[0], self.size[1]);
        for k in levels {
            all.or(&self.section(k));
        }
        all
    }
}
