//! Enclosures of a hybrid over boxes.

use super::convex::{combine, combine_all, combine_known};
use super::hybrid::{Hybrid, offset, offsets};
use super::inner::{Local, LocalRange};
use crate::field::Shared;
use crate::num::lanes::{Boxes, Interval8, LANES, Vec8};
use crate::num::{Aabb, Interval};
use fearless_simd::{Level, Simd, dispatch, f64x8, prelude::*};
use glam::{DAffine3, DMat3, DVec3};

impl Hybrid {
    pub(super) fn bounds_by_maps(&self, boxes: &[Aabb], out: &mut [Interval]) {
        dispatch!(Level::new(), s => {
            for (boxes, out) in boxes.chunks(LANES).zip(out.chunks_mut(LANES)) {
                self.octet(s, boxes, out);
            }
        });
    }

    /// Up to eight boxes.
    #[inline(always)]
    fn octet<S: Simd>(&self, s: S, boxes: &[Aabb], out: &mut [Interval]) {
        let all = Boxes::of(s, boxes);
        let n = self.features.len();
        let mut order = Vec::new();
        let none = vec![Interval8::point(s, 0.0); n];
        let (mut d, mut w, mut sharp) = (none.clone(), none.clone(), none);
        for (d, f) in d.iter_mut().zip(&self.features) {
            *d = f.gauge.ranges(s, &all);
        }
        self.weighting.enclose_all(s, &d, &mut w);
        self.sharp.enclose_all(s, &d, &mut sharp);
        let read = self.read();
        let mut known = Vec::with_capacity(n);
        let (mut g, mut lam) = (Vec::new(), Vec::new());
        for &j in &read {
            known.clear();
            known.extend(self.thin(j));
            let thin = combine_known(s, &sharp, &known, &mut order).lanes();
            known.clear();
            known.extend(self.shares_of(j));
            let share = combine_known(s, &sharp, &known, &mut order).lanes();
            let share = share.map(|l| l.clamp(0.0, 1.0));
            let images = self.images(s, j, boxes, &all, &w, &mut order);
            let mut values = [Interval::ALL; LANES];
            self.shapes[j].bounds(&images[..boxes.len()], &mut values[..boxes.len()]);
            g.push(std::array::from_fn::<_, LANES, _>(|i| values[i] + thin[i]));
            lam.push(share);
        }
        let mut local = [[Interval::ALL; LANES]; 4];
        let kinds: [fn(&Local) -> f64; 4] = [|l| l.reach, |l| l.depth, |l| l.apart, |l| l.level];
        for (local, kind) in local.iter_mut().zip(kinds) {
            known.clear();
            known.extend(self.locals().map(kind));
            *local = combine_known(s, &sharp, &known, &mut order).lanes();
        }
        let offset = self.offset_ranges(s, &d, &w);
        let (mut row, mut shares) =
            (vec![Interval::ALL; read.len()], vec![Interval::ALL; read.len()]);
        for (i, out) in out.iter_mut().enumerate() {
            for c in 0..read.len() {
                (row[c], shares[c]) = (g[c][i], lam[c][i]);
            }
            let [reach, depth, apart, level] = local.map(|l| l[i]);
            let local = LocalRange { reach, depth, apart, level };
            *out = self.mix.bound(&row, &shares, &local, &mut order) - offset[i];
        }
    }

    /// The weights of shape `j` in the features, or its only one.
    fn shares_of(&self, j: usize) -> impl Iterator<Item = f64> + '_ {
        let whole = self.features.is_empty().then(|| self.lam[j]);
        self.features.iter().map(move |f| f.lam[j]).chain(whole)
    }

    /// The parameters of the features, or those of the whole.
    fn locals(&self) -> impl Iterator<Item = &Local> {
        let whole = self.features.is_empty().then_some(&self.local);
        self.features.iter().map(|f| &f.local).chain(whole)
    }

    #[inline(always)]
    fn offset_ranges<S: Simd>(
        &self,
        s: S,
        d: &[Interval8<S>],
        w: &[Interval8<S>],
    ) -> [Interval; LANES] {
        if self.features.iter().all(|f| f.offset == 0.0) {
            return [Interval::point(0.0); LANES];
        }
        let mut x = Vec::with_capacity(d.len());
        for (f, d) in self.features.iter().zip(d) {
            let (a, b) = (offsets(f.offset, d.lo), offsets(f.offset, d.hi));
            x.push(Interval8 { lo: a.min(b), hi: a.max(b) });
        }
        combine_all(s, w, &x).lanes()
    }

    /// [`Hybrid::image`] of eight boxes.
    #[inline(always)]
    fn images<S: Simd>(
        &self,
        s: S,
        j: usize,
        boxes: &[Aabb],
        all: &Boxes<S>,
        w: &[Interval8<S>],
        order: &mut Vec<usize>,
    ) -> [Aabb; LANES] {
        let mut images = [Aabb::EMPTY; LANES];
        if w.is_empty() {
            images[..boxes.len()].copy_from_slice(boxes);
            return images;
        }
        let mut maps = Vec::with_capacity(w.len());
        for f in &self.features {
            maps.extend(f.maps[j].affine());
        }
        if maps.len() == w.len() {
            return blended_images(s, &maps, all, w);
        }
        for (i, (image, b)) in images.iter_mut().zip(boxes).enumerate() {
            let w: Vec<_> = w.iter().map(|w| Interval::new(w.lo[i], w.hi[i])).collect();
            *image = self.image(j, b, &w, order);
        }
        images
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

/// Boxes round the images under weighted maps.
#[inline(always)]
fn blended_images<S: Simd>(
    s: S,
    maps: &[DAffine3],
    b: &Boxes<S>,
    w: &[Interval8<S>],
) -> [Aabb; LANES] {
    let zero = f64x8::splat(s, 0.0);
    let zeros = Vec8::splat(s, DVec3::ZERO);
    // the map that weighs most, lane by lane: its columns, and where it takes the centre
    let (mut most, mut main, mut own) = (-f64x8::splat(s, 1.0), [zeros; 3], zeros);
    let (mut at, mut size) = (Vec::with_capacity(maps.len()), zero);
    for (m, w) in maps.iter().zip(w) {
        let y = b.centre.mapped(m);
        size = size.max(y.abs().greatest() + m.translation.abs().max_element());
        let more = w.hi.simd_gt(most);
        most = more.select(w.hi, most);
        own = y.or(own, more);
        let axes = [m.matrix3.x_axis, m.matrix3.y_axis, m.matrix3.z_axis];
        for (main, axis) in main.iter_mut().zip(axes) {
            *main = Vec8::splat(s, axis).or(*main, more);
        }
        at.push(y);
    }
    let none = Interval8 { lo: zero, hi: zero };
    let mut away = [vec![none; maps.len()], vec![none; maps.len()], vec![none; maps.len()]];
    let [away_x, away_y, away_z] = &mut away;
    for (i, (m, y)) in maps.iter().zip(&at).enumerate() {
        let shift = y.less(own);
        let reach = reach(s, m, &main, &b.half);
        away_x[i] = Interval8 { lo: shift.x - reach.x, hi: shift.x + reach.x };
        away_y[i] = Interval8 { lo: shift.y - reach.y, hi: shift.y + reach.y };
        away_z[i] = Interval8 { lo: shift.z - reach.z, hi: shift.z + reach.z };
    }
    let half = reach(s, &DAffine3 { matrix3: DMat3::ZERO, ..DAffine3::IDENTITY }, &main, &b.half);
    // what cancels had the size of the points themselves
    let slack = (size + half.greatest() + f64x8::splat(s, 1.0)) * 1e-11;
    let x = combine_all(s, w, away_x);
    let y = combine_all(s, w, away_y);
    let z = combine_all(s, w, away_z);
    let min = Vec8 {
        x: own.x - half.x + x.lo - slack,
        y: own.y - half.y + y.lo - slack,
        z: own.z - half.z + z.lo - slack,
    };
    let max = Vec8 {
        x: own.x + half.x + x.hi + slack,
        y: own.y + half.y + y.hi + slack,
        z: own.z + half.z + z.hi + slack,
    };
    let (min, max) = (min.lanes(), max.lanes());
    std::array::from_fn(|i| Aabb::new(min[i], max[i]))
}

/// How far half a box reaches under a matrix less another, given by its columns.
#[inline(always)]
fn reach<S: Simd>(s: S, m: &DAffine3, less: &[Vec8<S>; 3], half: &Vec8<S>) -> Vec8<S> {
    let [a, b, c] = less;
    let x = Vec8::splat(s, m.matrix3.x_axis).less(*a).abs().times(half.x);
    let y = Vec8::splat(s, m.matrix3.y_axis).less(*b).abs().times(half.y);
    let z = Vec8::splat(s, m.matrix3.z_axis).less(*c).abs().times(half.z);
    x.plus(y).plus(z)
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
