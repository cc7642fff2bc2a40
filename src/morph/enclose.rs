//! Enclosures of a hybrid over boxes.

use super::convex::combine;
use super::hybrid::{Hybrid, Placed, offset};
use super::inner::{Local, LocalRange};
use crate::field::Shared;
use crate::num::{Aabb, Interval};
use glam::DVec3;

impl Hybrid {
    pub(super) fn bound_by_maps(&self, b: &Aabb) -> Interval {
        let (k, n) = (self.shapes.len(), self.features.len());
        let mut order = Vec::new();
        if n == 0 {
            let thin = |j: usize| self.thin.get(j).copied().unwrap_or(0.0);
            let g: Vec<_> =
                self.shapes.iter().enumerate().map(|(j, f)| f.bound(b).shift(thin(j))).collect();
            let lam: Vec<_> = self.lam.iter().map(|&l| Interval::point(l)).collect();
            return self.mix.bound(&g, &lam, &self.local.into(), &mut order);
        }
        let d: Vec<_> = self.features.iter().map(|f| f.gauge.bound(b)).collect();
        let (mut w, mut sharp) = (vec![Interval::ALL; n], vec![Interval::ALL; n]);
        self.weighting.enclose(&d, &mut w);
        self.sharp.enclose(&d, &mut sharp);
        let convex = |x: &dyn Fn(&Placed) -> f64, order: &mut Vec<usize>| {
            let x: Vec<_> = self.features.iter().map(|f| Interval::point(x(f))).collect();
            combine(&sharp, &x, order)
        };
        let mut g = Vec::with_capacity(k);
        let mut lam = Vec::with_capacity(k);
        for j in 0..k {
            let thin = convex(&|f| f.thin.get(j).copied().unwrap_or(0.0), &mut order);
            let share = convex(&|f| f.lam[j], &mut order).clamp(0.0, 1.0);
            g.push(if share.hi > 0.0 || self.reads_all() {
                self.shapes[j].bound(&self.image(j, b, &w, &mut order)) + thin
            } else {
                Interval::ALL
            });
            lam.push(share);
        }
        let local = LocalRange {
            reach: convex(&|f| f.local.reach, &mut order),
            depth: convex(&|f| f.local.depth, &mut order),
            apart: convex(&|f| f.local.apart, &mut order),
            level: convex(&|f| f.local.level, &mut order),
        };
        let offsets: Vec<_> =
            self.features.iter().zip(&d).map(|(f, &d)| offset_range(f.offset, d)).collect();
        self.mix.bound(&g, &lam, &local, &mut order) - combine(&w, &offsets, &mut order)
    }

    /// A box that holds y_j(x) for every x in `b`: the image under the map of the feature that
    /// weighs most, plus what the others may pull away from it.
    fn image(&self, j: usize, b: &Aabb, w: &[Interval], order: &mut Vec<usize>) -> Aabb {
        let main = (0..w.len()).max_by(|&a, &c| w[a].hi.total_cmp(&w[c].hi)).unwrap_or(0);
        let own = self.features[main].maps[j].image(b);
        let none = Aabb::new(DVec3::ZERO, DVec3::ZERO);
        let away: Vec<Aabb> = (0..w.len())
            .map(|i| match &self.features[i] {
                f if i != main && w[i].hi > 0.0 => {
                    f.maps[j].difference(&self.features[main].maps[j], b)
                }
                _ => none,
            })
            .collect();
        let axis = |c: usize, order: &mut Vec<usize>| {
            let x: Vec<_> = away.iter().map(|a| Interval::new(a.min[c], a.max[c])).collect();
            combine(w, &x, order)
        };
        let shift = [axis(0, order), axis(1, order), axis(2, order)];
        Aabb::new(
            own.min + DVec3::new(shift[0].lo, shift[1].lo, shift[2].lo),
            own.max + DVec3::new(shift[0].hi, shift[1].hi, shift[2].hi),
        )
    }

    pub(super) fn bound_by_fields(&self, b: &Aabb) -> Interval {
        let mut order = Vec::new();
        let d: Vec<_> = self.features.iter().map(|f| f.gauge.bound(b)).collect();
        let mut w = vec![Interval::ALL; d.len()];
        self.weighting.enclose(&d, &mut w);
        let values: Vec<_> = self
            .features
            .iter()
            .enumerate()
            .map(|(i, f)| {
                if w[i].hi <= 0.0 {
                    return Interval::point(0.0);
                }
                let thin = |j: usize| f.thin.get(j).copied().unwrap_or(0.0);
                let bound = |(j, s): (usize, &Shared)| s.bound(&f.maps[j].image(b)).shift(thin(j));
                let g: Vec<_> = self.shapes.iter().enumerate().map(bound).collect();
                let lam: Vec<_> = f.lam.iter().map(|&l| Interval::point(l)).collect();
                let v = self.mix.bound(&g, &lam, &f.local.into(), &mut order);
                v - offset_range(f.offset, d[i])
            })
            .collect();
        combine(&w, &values, &mut order)
    }
}

fn offset_range(d: f64, distance: Interval) -> Interval {
    let (a, b) = (offset(d, distance.lo), offset(d, distance.hi));
    Interval::new(a.min(b), a.max(b))
}

impl From<Local> for LocalRange {
    fn from(l: Local) -> Self {
        Self {
            reach: Interval::point(l.reach),
            depth: Interval::point(l.depth),
            apart: Interval::point(l.apart),
            level: Interval::point(l.level),
        }
    }
}
