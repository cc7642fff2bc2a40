//! A hybrid at one time on coarse samples, ready to be tried in many ways.

use super::Outlook;
use super::options::Kin;
use crate::job::{self, Cancelled, Job};
use crate::morph::Morph;
use crate::morph::hybrid::{Hybrid, Looked, Placed};
use crate::morph::inner::{Local, Mix};
use crate::morph::measure::{self, Measured, Site};
use crate::morph::metamorphosis::{Metamorphosis, Step, leads};
use crate::morph::plan::{Inner, Plan};
use crate::num::Aabb;
use glam::{DVec3, UVec3};
use rayon::prelude::*;

/// The samples of one time.
pub(super) struct Stage {
    t: f64,
    hybrid: Hybrid,
    step: f64,
    low: DVec3,
    size: UVec3,
    /// Where the shapes are near: index of the sample in the lattice.
    at: Vec<u32>,
    /// Values of the k shapes there, a row a point.
    g: Vec<f64>,
    /// Sharp weights of the n features there, a row a point.
    sharp: Vec<f64>,
    /// Values of the shapes in the cube of each feature.
    rows: Vec<Vec<f64>>,
    /// Volume of all shapes in each feature, mm³.
    hefts: Vec<f64>,
    /// What is measured, by feature and option of its kind.
    measured: Vec<Vec<(Vec<f64>, Measured)>>,
    /// The weights of the whole.
    course: Vec<f64>,
    /// The mean volume by these, mm³.
    mean: f64,
    /// Where the shapes' feet go.
    feet: Vec<Step>,
    /// Side of the result's cells, mm.
    cell: f64,
}

/// Values beyond which nothing reaches, mm: the largest level, and what shares thicken.
const NEAR: f64 = 26.0;
/// Samples this far outside, in cells, still connect: a member thinner than a cell falls between
/// samples on its way.
const SLACK: f64 = 0.05;
/// A foot ends within this share of the height from the lowest point, and as near to where it should.
const FOOT: f64 = 0.03;

impl Stage {
    /// Looks the shapes up, with this many cells along the longest side.
    pub fn new(
        morph: &Metamorphosis,
        t: f64,
        cells: f64,
        job: &dyn Job,
    ) -> Result<Self, Cancelled> {
        let hybrid = morph.unmeasured(t);
        let domain = morph.domain();
        let step = domain.size().max_element() / cells;
        let size = (domain.size() / step).ceil().as_uvec3().max(UVec3::ONE);
        let (k, n) = (hybrid.shapes.len(), hybrid.features.len());
        let slices: Vec<_> = (0..size.z)
            .into_par_iter()
            .map(|z| {
                job::check(job)?;
                let points: Vec<DVec3> = slice(&domain, step, size, z).collect();
                let mut l = Looked::default();
                hybrid.look_up(&points, &mut l);
                let (mut at, mut g, mut sharp) = (Vec::new(), Vec::new(), Vec::new());
                for r in 0..points.len() {
                    let row = &l.g[r * k..(r + 1) * k];
                    if row.iter().any(|&v| v < NEAR) {
                        at.push(z * size.x * size.y + r as u32);
                        g.extend_from_slice(row);
                        sharp.extend_from_slice(&l.sharp[r * n..(r + 1) * n]);
                    }
                }
                Ok((at, g, sharp))
            })
            .collect::<Result<_, Cancelled>>()?;
        let rows = measure::rows(&hybrid, |_, _| true, job)?;
        let heft = |(f, g): (&Placed, &Vec<f64>)| {
            let inside = g.iter().filter(|v| **v < 0.0).count();
            inside as f64 * measure::step(f).element_product()
        };
        let hefts = hybrid.features.iter().zip(&rows).map(heft).collect();
        let (mut at, mut g, mut sharp) = (Vec::new(), Vec::new(), Vec::new());
        for (a, b, c) in slices {
            at.extend(a);
            g.extend(b);
            sharp.extend(c);
        }
        let (low, measured) = (domain.min, Vec::new());
        let (feet, cell) = (morph.steps(t), morph.plan.cell);
        let (course, mean) = (Vec::new(), 0.0);
        Ok(Self {
            t,
            hybrid,
            step,
            low,
            size,
            at,
            g,
            sharp,
            rows,
            hefts,
            measured,
            course,
            mean,
            feet,
            cell,
        })
    }

    /// The samples of a feature.
    fn site<'a>(&self, f: &Placed, g: &'a [f64], sizes: &'a [f64]) -> Site<'a> {
        Site { g, sizes, step: Some(measure::step(f)), cell: self.cell }
    }

    /// How far apart the shapes are in these features: 0 overlap, 1 do not.
    pub fn apart(&self, features: &[usize]) -> f64 {
        let one = |&i: &usize| {
            let (f, g) = (self.hybrid.features.get(i)?, self.rows.get(i)?);
            Some(
                measure::measured(&self.site(f, g, &measure::sizes(f)), &f.lam, Inner::Auto)
                    .local
                    .apart,
            )
        };
        let all: Vec<f64> = features.iter().filter_map(one).collect();
        all.iter().sum::<f64>() / all.len().max(1) as f64
    }

    /// Which shapes have these features' part: those that reach through more than a third of an
    /// element along each of its axes. What juts in from beside does not.
    pub fn owners(&self, features: &[usize]) -> Vec<bool> {
        let k = self.hybrid.shapes.len();
        let rows = || features.iter().filter_map(|&i| self.rows.get(i));
        (0..k).map(|j| rows().any(|g| measure::reaches_through(g, k, j))).collect()
    }

    /// The only shape of two that has these features' part; none where both or neither have it.
    pub fn owner(&self, features: &[usize]) -> Option<usize> {
        match self.owners(features)[..] {
            [true, false] => Some(0),
            [false, true] => Some(1),
            _ => None,
        }
    }

    /// How much of a shape lies between these features and those, in samples.
    pub fn seam(&self, shape: usize, these: &[usize], those: &[usize]) -> f64 {
        let (k, n) = (self.hybrid.shapes.len(), self.hybrid.features.len());
        let sum = |w: &[f64], of: &[usize]| of.iter().map(|&i| w[i]).sum::<f64>();
        let rows = self.g.chunks_exact(k).zip(self.sharp.chunks_exact(n));
        let inside = rows.filter(|(g, _)| g[shape] < 0.0);
        inside.map(|(_, w)| sum(w, these) * sum(w, those)).sum()
    }

    /// Measures every option of every kind.
    pub fn measure(
        &mut self,
        kins: &[Kin],
        plan: &Plan,
        volumes: &[f64],
        job: &dyn Job,
    ) -> Result<(), Cancelled> {
        let kin_of = |i: usize| kins.iter().find(|k| k.features.contains(&i));
        let features = &self.hybrid.features;
        self.measured = (0..features.len())
            .into_par_iter()
            .map(|i| {
                job::check(job)?;
                let (f, rows) = (&features[i], &self.rows[i]);
                let sizes = measure::sizes(f);
                let site = self.site(f, rows, &sizes);
                let options = kin_of(i).map_or(&[][..], |k| k.options.as_slice());
                let each = options.iter().map(|o| {
                    let lam = o.course.as_ref().map_or_else(|| f.lam.clone(), |c| c.at(self.t));
                    let inner = o.inner.unwrap_or(plan.inner);
                    let m = measure::measured(&site, &lam, inner);
                    (lam, m)
                });
                Ok(each.collect())
            })
            .collect::<Result<_, Cancelled>>()?;
        self.course = plan.course.at(self.t);
        self.mean = self.course.iter().zip(volumes).map(|(l, v)| l * v).sum();
        Ok(())
    }

    /// What a combination of options looks like.
    pub fn judge(&self, kins: &[Kin], candidate: &[usize]) -> Outlook {
        let setting = self.setting(kins, candidate);
        let f = self.values(&setting);
        let slack = SLACK * self.step;
        let solid: Vec<bool> = f.iter().map(|&v| v < slack).collect();
        let label = self.label(&solid);
        let part = |v: f64| (0.5 - v / self.step).clamp(0.0, 1.0);
        let mut volumes = vec![0.0; label.iter().copied().max().unwrap_or(0) as usize + 1];
        for (&l, &v) in label.iter().zip(&f) {
            volumes[l as usize] += part(v);
        }
        let whole: f64 = volumes.iter().sum();
        // the share of samples outside is the skin of all pieces
        let pieces: f64 = volumes.iter().skip(1).sum();
        let largest = volumes.iter().skip(1).copied().fold(0.0, f64::max);
        let main = (1..volumes.len()).max_by(|&a, &b| volumes[a].total_cmp(&volumes[b]));
        Outlook {
            t: self.t,
            largest: if pieces > 0.0 { largest / pieces } else { 0.0 },
            volume: if self.mean > 0.0 { whole * self.step.powi(3) / self.mean } else { 1.0 },
            lame: self.lame(&setting, &label, main.unwrap_or(0) as u32),
            lean: self.lean(&setting),
        }
    }

    /// Where and what the field of a combination is.
    #[cfg(test)]
    pub fn field(&self, kins: &[Kin], candidate: &[usize]) -> Vec<(DVec3, f64)> {
        let values = self.values(&self.setting(kins, candidate));
        (0..values.len()).map(|r| (self.point(r), values[r])).collect()
    }

    /// Weights and parameters of each feature.
    fn setting(&self, kins: &[Kin], candidate: &[usize]) -> Vec<&(Vec<f64>, Measured)> {
        let n = self.hybrid.features.len();
        let mut option = vec![0; n];
        for (kin, &o) in kins.iter().zip(candidate) {
            kin.features.iter().for_each(|&i| option[i] = o);
        }
        (0..n).filter_map(|i| self.measured[i].get(option[i])).collect()
    }

    /// How much more of the volume in the features than its weight a shape gives at most.
    fn lean(&self, set: &[&(Vec<f64>, Measured)]) -> f64 {
        let all = self.hefts.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        let rows = || self.hefts.iter().zip(set);
        let over =
            |(j, w): (usize, &f64)| rows().map(|(h, (l, _))| h * l[j]).sum::<f64>() / all - w;
        self.course.iter().enumerate().map(over).fold(0.0, f64::max)
    }

    /// Where a kept sample lies.
    fn point(&self, r: usize) -> DVec3 {
        let (at, [sx, sy, _]) = (self.at[r], self.size.to_array());
        let cell = UVec3::new(at % sx, at / sx % sy, at / (sx * sy));
        self.low + (cell.as_dvec3() + 0.5) * self.step
    }

    /// The field of a setting, as the hybrid mixes it.
    fn values(&self, set: &[&(Vec<f64>, Measured)]) -> Vec<f64> {
        let (k, n) = (self.hybrid.shapes.len(), self.hybrid.features.len());
        let whole = matches!(self.hybrid.mix, Mix::Erode).then_some(Mix::Erode);
        let mix = whole.unwrap_or(Mix::Auto);
        // a row a feature: its parameters, weights and thinning; blended in one go
        let width = 4 + 2 * k;
        let mut rows = Vec::with_capacity(n * width);
        for (lam, m) in set {
            let Local { reach, depth, apart, level } = m.local;
            rows.extend([reach, depth, apart, level]);
            rows.extend_from_slice(lam);
            rows.extend_from_slice(&m.thin);
        }
        let mut sum = vec![0.0; width];
        let value = |r: usize| {
            sum.fill(0.0);
            for (&w, row) in self.sharp[r * n..(r + 1) * n].iter().zip(rows.chunks_exact(width)) {
                sum.iter_mut().zip(row).for_each(|(s, x)| *s += w * x);
            }
            let (local, shapes) = sum.split_at_mut(4);
            let (lam, g) = shapes.split_at_mut(k);
            g.iter_mut().zip(&self.g[r * k..(r + 1) * k]).for_each(|(g, own)| *g += own);
            let [reach, depth, apart, level] = [local[0], local[1], local[2], local[3]];
            mix.value(g, lam, &Local { reach, depth, apart, level })
        };
        (0..self.at.len()).map(value).collect()
    }

    /// Pieces by faces: 0 is outside.
    fn label(&self, solid: &[bool]) -> Vec<u32> {
        let [sx, sy, sz] = self.size.to_array();
        let mut place = vec![u32::MAX; (sx * sy * sz) as usize];
        for (r, (&at, &s)) in self.at.iter().zip(solid).enumerate() {
            if s {
                place[at as usize] = r as u32;
            }
        }
        let mut label = vec![0; solid.len()];
        let (mut next, mut todo) = (0, Vec::new());
        for start in 0..solid.len() {
            if !solid[start] || label[start] != 0 {
                continue;
            }
            next += 1;
            label[start] = next;
            todo.push(start);
            while let Some(r) = todo.pop() {
                let at = self.at[r];
                let (x, y, z) = (at % sx, at / sx % sy, at / (sx * sy));
                let sides = [
                    (x > 0).then(|| at - 1),
                    (x + 1 < sx).then(|| at + 1),
                    (y > 0).then(|| at - sx),
                    (y + 1 < sy).then(|| at + sx),
                    (z > 0).then(|| at - sx * sy),
                    (z + 1 < sz).then(|| at + sx * sy),
                ];
                for side in sides.into_iter().flatten() {
                    let r = place[side as usize] as usize;
                    if r < label.len() && label[r] == 0 {
                        label[r] = next;
                        todo.push(r);
                    }
                }
            }
        }
        label
    }

    /// Feet that should stand on the floor although the main piece does not reach it there.
    fn lame(&self, set: &[&(Vec<f64>, Measured)], label: &[u32], main: u32) -> usize {
        let held = |r: &usize| label[*r] == main && main > 0;
        let held: Vec<DVec3> = (0..label.len()).filter(held).map(|r| self.point(r)).collect();
        let bounds = Aabb::of(held.iter().copied());
        let low = bounds.min.z + FOOT * bounds.size().z + self.step;
        let floor: Vec<DVec3> = held.into_iter().filter(|p| p.z < low).collect();
        let wanted = |s: &&Step| set.get(s.feature).is_some_and(|(lam, _)| leads(lam, s.shape));
        let stands = |s: &Step| {
            let reach = s.foot.reach + FOOT * bounds.size().z + self.step;
            floor.iter().any(|p| p.truncate().distance(s.foot.at.truncate()) <= reach)
        };
        self.feet.iter().filter(wanted).filter(|s| !stands(s)).count()
    }
}

/// Cell centres of a slice of the lattice over the domain.
fn slice(domain: &Aabb, step: f64, size: UVec3, z: u32) -> impl Iterator<Item = DVec3> {
    let low = domain.min;
    (0..size.x * size.y)
        .map(move |i| low + (UVec3::new(i % size.x, i / size.x, z).as_dvec3() + 0.5) * step)
}
