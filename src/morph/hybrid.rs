//! The field of a hybrid at one time: positions through the features, values of the shapes there,
//! and the morphing function of those.

use super::convex::combine;
use super::inner::{Local, LocalRange, Mix};
use super::plan::Blend;
use crate::element::{Between, Element, Gauge};
use crate::field::{Field, Shared};
use crate::num::{Aabb, Interval};
use crate::weight::Weighting;
use glam::DVec3;

/// A feature at one time.
pub(super) struct Placed {
    /// The element of the result, E' (paper 001, Algorithm 1).
    pub element: Element,
    /// Its distance.
    pub gauge: Gauge,
    /// From it onto the element of each shape: M_j M'^-1.
    pub maps: Vec<Between>,
    /// Weights of the shapes in this feature; sum to one.
    pub lam: Vec<f64>,
    /// Offset d of eq. 6, mm.
    pub offset: f64,
    /// Automatic parameters.
    pub local: Local,
    /// By how much each shape is thinned here, mm.
    pub thin: Vec<f64>,
}

/// A hybrid at one time. Without features the shapes are looked up where they stand.
pub(super) struct Hybrid {
    pub shapes: Vec<Shared>,
    pub features: Vec<Placed>,
    /// Weights and parameters without features.
    pub lam: Vec<f64>,
    pub local: Local,
    pub thin: Vec<f64>,
    pub blend: Blend,
    pub mix: Mix,
    pub weighting: Weighting,
    pub sharp: Weighting,
}

/// Values at many points of what the morphing function takes, a row a point.
#[derive(Default)]
pub(super) struct Looked {
    /// Values of the k shapes at each point.
    pub g: Vec<f64>,
    /// Weights of the k shapes at each point.
    pub lam: Vec<f64>,
    /// Feature weights at each point, n a row: those of positions, and the sharp ones.
    w: Vec<f64>,
    pub sharp: Vec<f64>,
    /// Distances to the features, n a row.
    d: Vec<f64>,
}

impl Hybrid {
    fn counts(&self) -> (usize, usize) {
        (self.shapes.len(), self.features.len())
    }

    /// Distances and weights of the features at every point.
    fn weigh(&self, at: &[DVec3], sharp: bool, out: &mut Looked) {
        let n = self.features.len();
        out.d.resize(at.len() * n, 0.0);
        out.w.resize(at.len() * n, 0.0);
        out.sharp.resize(at.len() * n, 0.0);
        for (r, &p) in at.iter().enumerate() {
            let row = r * n..(r + 1) * n;
            for (d, f) in out.d[row.clone()].iter_mut().zip(&self.features) {
                *d = f.gauge.distance(p);
            }
            self.weighting.weigh(&out.d[row.clone()], &mut out.w[row.clone()]);
            if sharp {
                self.sharp.weigh(&out.d[row.clone()], &mut out.sharp[row]);
            }
        }
    }

    /// Whether the morphing function reads shapes that weigh nothing.
    fn reads_all(&self) -> bool {
        matches!(self.mix, Mix::SpaceTime(_))
    }

    /// Values and weights of the shapes under the blended maps: y_j = Σ w_i T_ij(x), g_j = f_j(y_j).
    pub fn look_up(&self, at: &[DVec3], out: &mut Looked) {
        self.weigh(at, true, out);
        out.lam = self.shares(at.len(), &out.sharp);
        self.values_of(at, out, |_, _| true);
    }

    /// Values alone of the shapes that are wanted; those of the others are zero.
    pub fn look_up_some(&self, at: &[DVec3], wanted: impl Fn(usize) -> bool) -> Vec<f64> {
        let mut out = Looked::default();
        self.weigh(at, false, &mut out);
        self.values_of(at, &mut out, |j, _| wanted(j));
        out.g
    }

    /// Weights of the k shapes at some points from the sharp weights of the features there.
    fn shares(&self, points: usize, sharp: &[f64]) -> Vec<f64> {
        let (k, n) = self.counts();
        if n == 0 {
            return self.lam.repeat(points);
        }
        let mut lam = Vec::with_capacity(points * k);
        for w in sharp.chunks_exact(n) {
            let share = |j| w.iter().zip(&self.features).map(|(w, f)| w * f.lam[j]).sum::<f64>();
            lam.extend((0..k).map(share));
        }
        lam
    }

    /// Values of the shapes that are wanted (by shape and row) under the blended maps.
    fn values_of(&self, at: &[DVec3], out: &mut Looked, wanted: impl Fn(usize, usize) -> bool) {
        let (k, n) = self.counts();
        let Looked { g, w, .. } = out;
        g.clear();
        g.resize(at.len() * k, 0.0);
        for (j, shape) in self.shapes.iter().enumerate() {
            let rows: Vec<usize> = (0..at.len()).filter(|&r| wanted(j, r)).collect();
            let place = |r: usize| match n {
                0 => at[r],
                _ => self.blended(j, at[r], &w[r * n..(r + 1) * n]),
            };
            values_at(shape, &rows, place, |r, v| g[r * k + j] = v);
        }
    }

    fn blended(&self, j: usize, p: DVec3, w: &[f64]) -> DVec3 {
        let mut y = DVec3::ZERO;
        for (w, f) in w.iter().zip(&self.features) {
            // exact zeros (eq. 5) would only cost time
            if *w > 0.0 {
                y += *w * f.maps[j].pull(p);
            }
        }
        y
    }

    /// The morphing parameters at a row of sharp weights.
    fn local(&self, w: &[f64]) -> Local {
        if self.features.is_empty() {
            return self.local;
        }
        let sum = |get: fn(&Local) -> f64| -> f64 {
            w.iter().zip(&self.features).map(|(w, f)| w * get(&f.local)).sum()
        };
        Local {
            reach: sum(|l| l.reach),
            depth: sum(|l| l.depth),
            apart: sum(|l| l.apart),
            level: sum(|l| l.level),
        }
    }

    /// Thins the shapes' values at a row of sharp weights.
    fn thin(&self, g: &mut [f64], w: &[f64]) {
        if self.features.is_empty() {
            g.iter_mut().zip(&self.thin).for_each(|(g, t)| *g += t);
        }
        for (w, f) in w.iter().zip(&self.features) {
            g.iter_mut().zip(&f.thin).for_each(|(g, t)| *g += w * t);
        }
    }

    fn values_by_maps(&self, at: &[DVec3], out: &mut [f64]) {
        let (k, n) = self.counts();
        let mut l = Looked::default();
        self.weigh(at, true, &mut l);
        let lam = self.shares(at.len(), &l.sharp);
        let all = self.reads_all();
        self.values_of(at, &mut l, |j, r| all || lam[r * k + j] != 0.0);
        for (r, f) in out.iter_mut().enumerate() {
            let row = r * k..(r + 1) * k;
            let feature = r * n..(r + 1) * n;
            let (w, d) = if n > 0 {
                (&l.sharp[feature.clone()], &l.d[feature.clone()])
            } else {
                (&[][..], &[][..])
            };
            self.thin(&mut l.g[row.clone()], w);
            *f = self.mix.value(&l.g[row.clone()], &lam[row], &self.local(w));
            for (i, p) in self.features.iter().enumerate() {
                *f -= l.w[r * n + i] * offset(p.offset, d[i]);
            }
        }
    }

    /// Eqs 1 and 8: Σ w_i (f_m(f_j(T_ij x)) - o_i), the offset's sign being the house's.
    fn values_by_fields(&self, at: &[DVec3], out: &mut [f64]) {
        let (k, n) = self.counts();
        let mut l = Looked::default();
        self.weigh(at, false, &mut l);
        out.fill(0.0);
        let all = self.reads_all();
        let mut g = vec![0.0; at.len() * k];
        for (i, feature) in self.features.iter().enumerate() {
            let rows: Vec<usize> = (0..at.len()).filter(|&r| l.w[r * n + i] > 0.0).collect();
            for (j, shape) in self.shapes.iter().enumerate() {
                if all || feature.lam[j] != 0.0 {
                    let thin = feature.thin.get(j).copied().unwrap_or(0.0);
                    let place = |r: usize| feature.maps[j].pull(at[r]);
                    values_at(shape, &rows, place, |r, v| g[r * k + j] = v + thin);
                }
            }
            for (r, f) in out.iter_mut().enumerate() {
                let w = l.w[r * n + i];
                if w > 0.0 {
                    let v = self.mix.value(&g[r * k..(r + 1) * k], &feature.lam, &feature.local);
                    *f += w * (v - offset(feature.offset, l.d[r * n + i]));
                }
            }
        }
    }

    fn bound_by_maps(&self, b: &Aabb) -> Interval {
        let (k, n) = self.counts();
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

    fn bound_by_fields(&self, b: &Aabb) -> Interval {
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

/// Values of a shape for some rows, each at its place.
fn values_at(
    shape: &Shared,
    rows: &[usize],
    place: impl Fn(usize) -> DVec3,
    mut put: impl FnMut(usize, f64),
) {
    let at: Vec<DVec3> = rows.iter().map(|&r| place(r)).collect();
    let mut values = vec![0.0; at.len()];
    shape.values(&at, &mut values);
    rows.iter().zip(values).for_each(|(&r, v)| put(r, v));
}

/// Offset o_i of eq. 6 as METHODS corrects it: d inside the feature, fading to nothing at the
/// distance |d| outside.
fn offset(d: f64, distance: f64) -> f64 {
    (d.abs() - distance).clamp(0.0, d.abs()).copysign(d)
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

impl Field for Hybrid {
    fn value(&self, p: DVec3) -> f64 {
        let mut f = [0.0];
        self.values(&[p], &mut f);
        f[0]
    }

    fn values(&self, at: &[DVec3], out: &mut [f64]) {
        match self.blend {
            Blend::Fields if !self.features.is_empty() => self.values_by_fields(at, out),
            _ => self.values_by_maps(at, out),
        }
    }

    fn bound(&self, b: &Aabb) -> Interval {
        let f = match self.blend {
            Blend::Fields if !self.features.is_empty() => self.bound_by_fields(b),
            _ => self.bound_by_maps(b),
        };
        f.widen(1e-9 * (1.0 + b.radius()))
    }

    /// The maps may bring matter from anywhere, so nothing smaller can be promised.
    fn support(&self) -> Aabb {
        Aabb::ALL
    }
}
