//! The field of a hybrid at one time: positions through the features, values of the shapes there,
//! and the morphing function of those.

use super::inner::{Local, Local8, Mix};
use super::plan::Blend;
use crate::element::{Between, Element, Gauge};
use crate::field::{Field, Shared};
use crate::num::lanes::{LANES, Lane, Vec8};
use crate::num::{Aabb, Interval};
use crate::weight::Weighting;
use fearless_simd::{Level, Simd, dispatch, f64x8, prelude::*};
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
    /// Sharp weights of the n features at each point.
    pub sharp: Vec<f64>,
}

/// Some numbers at many points, by octets of points: the `n` of octet b start at `b * n`.
struct Octets {
    n: usize,
    all: Vec<Lane>,
}

impl Octets {
    fn new(n: usize, points: usize) -> Self {
        Self { n, all: Vec::with_capacity(n * points.div_ceil(LANES)) }
    }

    fn zeros(n: usize, points: usize) -> Self {
        Self { n, all: vec![[0.0; LANES]; n * points.div_ceil(LANES)] }
    }

    #[inline(always)]
    fn put<S: Simd>(&mut self, numbers: &[f64x8<S>]) {
        for &x in numbers {
            self.all.push(x.into());
        }
    }

    #[inline(always)]
    fn get<S: Simd>(&self, s: S, b: usize, i: usize) -> f64x8<S> {
        f64x8::simd_from(s, self.all[b * self.n + i])
    }

    /// Number `i` at a point.
    fn at(&self, point: usize, i: usize) -> f64 {
        self.all[point / LANES * self.n + i][point % LANES]
    }

    fn set(&mut self, point: usize, i: usize, x: f64) {
        self.all[point / LANES * self.n + i][point % LANES] = x;
    }

    /// The numbers of a point after those of another.
    fn rows(&self, points: usize) -> Vec<f64> {
        (0..points).flat_map(|r| (0..self.n).map(move |i| self.at(r, i))).collect()
    }
}

/// The n features at many points.
struct Weights {
    /// Distances.
    d: Octets,
    /// Weights of positions, and the sharp ones.
    w: Octets,
    sharp: Octets,
}

impl Hybrid {
    /// Distances and weights of the features at every point.
    #[inline(always)]
    fn weigh<S: Simd>(&self, s: S, at: &[DVec3], sharp: bool) -> Weights {
        let n = self.features.len();
        let octets = || Octets::new(n, at.len());
        let mut out = Weights { d: octets(), w: octets(), sharp: octets() };
        if n == 0 {
            return out;
        }
        let zero = f64x8::splat(s, 0.0);
        let (mut d, mut w) = (vec![zero; n], vec![zero; n]);
        for at in at.chunks(LANES) {
            let p = Vec8::of(s, at);
            for (d, f) in d.iter_mut().zip(&self.features) {
                *d = f.gauge.distances(s, p);
            }
            out.d.put(&d);
            self.weighting.weigh_all(s, &d, &mut w);
            out.w.put(&w);
            if sharp {
                self.sharp.weigh_all(s, &d, &mut w);
                out.sharp.put(&w);
            }
        }
        out
    }

    /// Whether the morphing function reads shapes that weigh nothing.
    pub(super) fn reads_all(&self) -> bool {
        matches!(self.mix, Mix::SpaceTime(_))
    }

    /// The shapes that the morphing function reads somewhere.
    pub(super) fn read(&self) -> Vec<usize> {
        let weighs = |j: usize| match &self.features[..] {
            [] => self.lam[j] != 0.0,
            all => all.iter().any(|f| f.lam[j] != 0.0),
        };
        (0..self.shapes.len()).filter(|&j| self.reads_all() || weighs(j)).collect()
    }

    /// Values and weights of the shapes under the blended maps: y_j = Σ w_i T_ij(x), g_j = f_j(y_j).
    pub fn look_up(&self, at: &[DVec3], out: &mut Looked) {
        let all: Vec<usize> = (0..self.shapes.len()).collect();
        dispatch!(Level::new(), s => {
            let weights = self.weigh(s, at, true);
            out.lam = self.shares(s, at.len(), &weights.sharp, &all).rows(at.len());
            out.g = self.values_of(s, at, &weights.w, &all, |_, _| true).rows(at.len());
            out.sharp = weights.sharp.rows(at.len());
        });
    }

    /// Values alone of the shapes that are wanted; those of the others are zero.
    pub fn look_up_some(&self, at: &[DVec3], wanted: impl Fn(usize) -> bool) -> Vec<f64> {
        let all: Vec<usize> = (0..self.shapes.len()).collect();
        dispatch!(Level::new(), s => {
            let weights = self.weigh(s, at, false);
            self.values_of(s, at, &weights.w, &all, |j, _| wanted(j)).rows(at.len())
        })
    }

    /// Weights of some shapes at some points from the sharp weights of the features there.
    #[inline(always)]
    fn shares<S: Simd>(&self, s: S, points: usize, sharp: &Octets, shapes: &[usize]) -> Octets {
        let mut lam = Octets::new(shapes.len(), points);
        for b in 0..points.div_ceil(LANES) {
            for &j in shapes {
                if self.features.is_empty() {
                    lam.all.push([self.lam[j]; LANES]);
                    continue;
                }
                let mut share = f64x8::splat(s, 0.0);
                for (i, f) in self.features.iter().enumerate() {
                    share += sharp.get(s, b, i) * f.lam[j];
                }
                lam.all.push(share.into());
            }
        }
        lam
    }

    /// Values of some shapes under the blended maps where they are wanted (by place in `shapes`, and
    /// point), zero elsewhere.
    #[inline(always)]
    fn values_of<S: Simd>(
        &self,
        s: S,
        at: &[DVec3],
        w: &Octets,
        shapes: &[usize],
        wanted: impl Fn(usize, usize) -> bool,
    ) -> Octets {
        let mut g = Octets::zeros(shapes.len(), at.len());
        let (mut rows, mut places) = (Vec::with_capacity(at.len()), Vec::with_capacity(at.len()));
        let mut values = Vec::new();
        for (c, &j) in shapes.iter().enumerate() {
            rows.clear();
            places.clear();
            for (b, at) in at.chunks(LANES).enumerate() {
                let first = rows.len();
                let all = b * LANES..b * LANES + at.len();
                rows.extend(all.filter(|&r| wanted(c, r)));
                if rows.len() > first {
                    let y = self.blended(s, j, Vec8::of(s, at), w, b).lanes();
                    places.extend(rows[first..].iter().map(|r| y[r % LANES]));
                }
            }
            values.clear();
            values.resize(places.len(), 0.0);
            self.shapes[j].values(&places, &mut values);
            rows.iter().zip(&values).for_each(|(&r, &v)| g.set(r, c, v));
        }
        g
    }

    #[inline(always)]
    fn blended<S: Simd>(&self, s: S, j: usize, p: Vec8<S>, w: &Octets, b: usize) -> Vec8<S> {
        if self.features.is_empty() {
            return p;
        }
        let mut y = Vec8::splat(s, DVec3::ZERO);
        for (i, f) in self.features.iter().enumerate() {
            let w = w.get(s, b, i);
            let some = w.simd_gt(f64x8::splat(s, 0.0));
            // exact zeros (eq. 5) would only cost time
            if some.any_true() {
                let more = y.plus(f.maps[j].pulled(s, p).times(w));
                y = more.or(y, some);
            }
        }
        y
    }

    /// The morphing parameters at an octet.
    #[inline(always)]
    fn local<S: Simd>(&self, s: S, sharp: &Octets, b: usize) -> Local8<S> {
        if self.features.is_empty() {
            return Local8::splat(s, &self.local);
        }
        let mut sum = Local8::splat(s, &Local::NONE);
        for (i, f) in self.features.iter().enumerate() {
            sum.add(sharp.get(s, b, i), &f.local);
        }
        sum
    }

    /// By how much shape `j` is thinned, a number a feature or one for the whole.
    pub(super) fn thin(&self, j: usize) -> impl Iterator<Item = f64> + '_ {
        let own = move |t: &[f64]| t.get(j).copied().unwrap_or(0.0);
        let whole = self.features.is_empty().then(|| own(&self.thin));
        self.features.iter().map(move |f| own(&f.thin)).chain(whole)
    }

    #[inline(always)]
    fn values_by_maps<S: Simd>(&self, s: S, at: &[DVec3], out: &mut [f64]) {
        let read = self.read();
        let Weights { d, w, sharp } = self.weigh(s, at, true);
        let lam = self.shares(s, at.len(), &sharp, &read);
        let all = self.reads_all();
        let g = self.values_of(s, at, &w, &read, |c, r| all || lam.at(r, c) != 0.0);
        let thins: Vec<bool> = read.iter().map(|&j| self.thin(j).any(|t| t != 0.0)).collect();
        let zero = f64x8::splat(s, 0.0);
        let (mut here, mut shares) = (vec![zero; read.len()], vec![zero; read.len()]);
        for (b, out) in out.chunks_mut(LANES).enumerate() {
            for (c, &j) in read.iter().enumerate() {
                (here[c], shares[c]) = (g.get(s, b, c), lam.get(s, b, c));
                if thins[c] {
                    here[c] = self.thinned(s, here[c], j, &sharp, b);
                }
            }
            let mut f = self.mix.values(s, &here, &shares, &self.local(s, &sharp, b));
            for (i, feature) in self.features.iter().enumerate() {
                if feature.offset != 0.0 {
                    f -= w.get(s, b, i) * offsets(feature.offset, d.get(s, b, i));
                }
            }
            let f: Lane = f.into();
            out.copy_from_slice(&f[..out.len()]);
        }
    }

    #[inline(always)]
    fn thinned<S: Simd>(&self, s: S, g: f64x8<S>, j: usize, sharp: &Octets, b: usize) -> f64x8<S> {
        let mut g = g;
        for (i, t) in self.thin(j).enumerate() {
            g += if self.features.is_empty() { f64x8::splat(s, t) } else { sharp.get(s, b, i) * t };
        }
        g
    }

    /// Eqs 1 and 8: Σ w_i (f_m(f_j(T_ij x)) - o_i), the offset's sign being the house's.
    fn values_by_fields(&self, at: &[DVec3], out: &mut [f64]) {
        let k = self.shapes.len();
        let Weights { d, w, .. } = dispatch!(Level::new(), s => self.weigh(s, at, false));
        out.fill(0.0);
        let all = self.reads_all();
        let mut g = vec![0.0; at.len() * k];
        for (i, feature) in self.features.iter().enumerate() {
            let rows: Vec<usize> = (0..at.len()).filter(|&r| w.at(r, i) > 0.0).collect();
            for (j, shape) in self.shapes.iter().enumerate() {
                if all || feature.lam[j] != 0.0 {
                    let thin = feature.thin.get(j).copied().unwrap_or(0.0);
                    let place = |r: usize| feature.maps[j].pull(at[r]);
                    values_at(shape, &rows, place, |r, v| g[r * k + j] = v + thin);
                }
            }
            for (r, f) in out.iter_mut().enumerate() {
                let w = w.at(r, i);
                if w > 0.0 {
                    let v = self.mix.value(&g[r * k..(r + 1) * k], &feature.lam, &feature.local);
                    *f += w * (v - offset(feature.offset, d.at(r, i)));
                }
            }
        }
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
pub(super) fn offset(d: f64, distance: f64) -> f64 {
    (d.abs() - distance).clamp(0.0, d.abs()).copysign(d)
}

/// [`offset`] at eight distances.
#[inline(always)]
pub(super) fn offsets<S: Simd>(d: f64, distance: f64x8<S>) -> f64x8<S> {
    let (s, most) = (distance.token(), f64x8::splat(distance.token(), d.abs()));
    let size = (most - distance).max(f64x8::splat(s, 0.0)).min(most);
    if d < 0.0 { -size } else { size }
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
            _ => dispatch!(Level::new(), s => self.values_by_maps(s, at, out)),
        }
    }

    fn bound(&self, b: &Aabb) -> Interval {
        let mut bound = [Interval::ALL];
        self.bounds(&[*b], &mut bound);
        bound[0]
    }

    fn bounds(&self, boxes: &[Aabb], out: &mut [Interval]) {
        match self.blend {
            Blend::Fields if !self.features.is_empty() => {
                for (bound, b) in out.iter_mut().zip(boxes) {
                    *bound = self.bound_by_fields(b);
                }
            }
            _ => self.bounds_by_maps(boxes, out),
        }
        for (bound, b) in out.iter_mut().zip(boxes) {
            *bound = bound.widen(1e-9 * (1.0 + b.radius()));
        }
    }

    /// The maps may bring matter from anywhere, so nothing smaller can be promised.
    fn support(&self) -> Aabb {
        Aabb::ALL
    }
}
