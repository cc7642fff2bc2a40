//! A checked plan, and its field at a time.

use super::Morph;
use super::hybrid::{Hybrid, Placed};
use super::inner::{Local, Mix};
use super::measure;
use super::plan::{Course, Foot, Form, Frames, Inner, MorphError, Plan};
use crate::element::{Element, average};
use crate::field::Shared;
use crate::job::{Cancelled, Job};
use crate::num::Aabb;
use glam::DVec3;
use std::sync::Arc;

pub(super) struct Metamorphosis {
    pub plan: Plan,
}

/// A foot of a shape, where the hybrid should have it.
pub(super) struct Step {
    pub foot: Foot,
    /// Which shape's.
    pub shape: usize,
    /// Which feature carries it there.
    pub feature: usize,
}

const UNMEASURED: Local = Local { reach: 0.0, depth: 0.0, apart: 1.0, level: 0.0 };

impl Metamorphosis {
    pub fn new(plan: Plan) -> Result<Self, MorphError> {
        let k = plan.shapes.len();
        if k < 2 {
            return Err(MorphError::Shapes(k));
        }
        if plan.space_time.form == Form::HalfCylinders && k != 2 {
            return Err(MorphError::PairOnly(k));
        }
        check_space_time(&plan)?;
        check_course(&plan.course, k, "default")?;
        for f in &plan.features {
            if f.elements.len() != k {
                let (feature, got) = (f.name.clone(), f.elements.len());
                return Err(MorphError::Unpaired { feature, got, shapes: k });
            }
            check_course(&f.morph, k, &f.name)?;
            check_course(&f.deform, k, &f.name)?;
            positive(f.offset.is_finite(), "offset", "a finite number of mm", f.offset)?;
            if f.inner.is_some_and(|i| !(i.by_feature() && plan.inner.by_feature())) {
                return Err(MorphError::Inner(f.name.clone()));
            }
        }
        if let Frames::Of(j) = plan.frames {
            positive(j < k, "frames", "the index of a shape", j as f64)?;
        }
        Ok(Self { plan })
    }

    fn place(&self, t: f64) -> Vec<Placed> {
        self.plan
            .features
            .iter()
            .map(|f| {
                let weights = match self.plan.frames {
                    Frames::Average => f.deform.at(t),
                    Frames::Of(j) => (0..f.elements.len()).map(|i| f64::from(i == j)).collect(),
                };
                let rows: Vec<(&Element, f64)> = f.elements.iter().zip(weights).collect();
                let element = average(&rows);
                let maps = f.elements.iter().map(|e| element.between(e)).collect();
                Placed {
                    gauge: element.gauge(0.0),
                    element,
                    maps,
                    lam: f.morph.at(t),
                    offset: f.offset_at(t),
                    local: UNMEASURED,
                    thin: Vec::new(),
                }
            })
            .collect()
    }
}

impl Metamorphosis {
    /// The feet of all shapes where the features carry them to at `t`; none without features.
    pub fn steps(&self, t: f64) -> Vec<Step> {
        let placed = self.place(t);
        let mut all = Vec::new();
        for (shape, foot) in self.feet() {
            let near =
                |i: &usize| self.plan.features[*i].elements[shape].gauge(0.0).distance(foot.at);
            let nearest = (0..placed.len()).min_by(|a, b| near(a).total_cmp(&near(b)));
            let Some(feature) = nearest else { continue };
            let (own, result) =
                (&self.plan.features[feature].elements[shape], &placed[feature].element);
            let at = own.between(result).pull(foot.at);
            // an upright foot of the one is the upright foot of the other
            let side = |d: DVec3| own.between(result).pull(foot.at + foot.reach * d).distance(at);
            let reach = side(DVec3::X).max(side(DVec3::Y));
            all.push(Step { foot: Foot { at, reach }, shape, feature });
        }
        all
    }

    fn feet(&self) -> impl Iterator<Item = (usize, Foot)> + '_ {
        let shapes = self.plan.feet.iter().take(self.plan.shapes.len()).enumerate();
        shapes.flat_map(|(j, feet)| feet.iter().map(move |f| (j, *f)))
    }
}

/// Whether a shape weighs most of all, so that its feet have to stand.
pub(super) fn leads(lam: &[f64], shape: usize) -> bool {
    let most = lam.iter().copied().fold(0.0, f64::max);
    lam.get(shape).is_some_and(|l| *l > 0.0 && *l >= most - 1e-9)
}

impl Metamorphosis {
    /// The hybrid at `t` before anything is measured.
    pub fn unmeasured(&self, t: f64) -> Hybrid {
        let plan = &self.plan;
        Hybrid {
            shapes: plan.shapes.iter().map(|s| s.field.clone()).collect(),
            features: self.place(t),
            lam: plan.course.at(t),
            local: UNMEASURED,
            thin: Vec::new(),
            blend: plan.blend,
            mix: match plan.inner {
                _ if plan.features.iter().any(|f| f.inner.is_some()) => Mix::Auto,
                Inner::Linear | Inner::SpaceTime => Mix::Linear,
                Inner::Grow => Mix::Grow,
                Inner::Erode => Mix::Erode,
                Inner::Auto | Inner::Mean | Inner::Merge | Inner::Union => Mix::Auto,
            },
            weighting: plan.weighting,
            sharp: plan.sharp,
        }
    }

    /// The morphing function of each feature, or of the whole where there are none.
    fn inners(&self) -> Vec<Inner> {
        let plan = &self.plan;
        match plan.features.as_slice() {
            [] => vec![plan.inner],
            all => all.iter().map(|f| f.inner.unwrap_or(plan.inner)).collect(),
        }
    }
}

impl Morph for Metamorphosis {
    fn at(&self, t: f64, job: &dyn Job) -> Result<Shared, Cancelled> {
        let plan = &self.plan;
        let mut h = self.unmeasured(t);
        let domain = self.domain();
        if plan.inner == Inner::SpaceTime {
            h.mix = Mix::SpaceTime(measure::bounded(&h, &plan.space_time, &domain, job)?);
        } else if !matches!(h.mix, Mix::Linear) {
            let all = measure::locals(&h, &self.inners(), &domain, plan.cell, job)?;
            if h.features.is_empty() {
                for m in &all {
                    (h.local, h.thin) = (m.local, m.thin.clone());
                }
            }
            for (f, m) in h.features.iter_mut().zip(all) {
                (f.local, f.thin) = (m.local, m.thin);
            }
        }
        Ok(Arc::new(h))
    }

    fn domain(&self) -> Aabb {
        let shapes = self.plan.shapes.iter().fold(Aabb::EMPTY, |b, s| b.hull(s.field.support()));
        let offset = self.plan.features.iter().fold(0.0, |o: f64, f| o.max(f.offset));
        shapes.grow(offset)
    }
}

fn check_course(course: &Course, k: usize, at: &str) -> Result<(), MorphError> {
    let bad = match course {
        Course::Pair(_) => k != 2,
        Course::Fixed(w) => {
            w.len() != k
                || w.iter().any(|&x| !x.is_finite() || x < 0.0)
                || w.iter().sum::<f64>() <= 0.0
        }
    };
    if bad { Err(MorphError::Weights { at: at.to_owned(), shapes: k }) } else { Ok(()) }
}

fn check_space_time(plan: &Plan) -> Result<(), MorphError> {
    let s = &plan.space_time;
    let k = plan.shapes.len();
    positive(s.a3.is_finite() && s.a3 > 0.0, "a3", "positive", s.a3)?;
    if let Some(a0) = s.a0 {
        positive(a0.is_finite() && a0 >= 0.0, "a0", "zero or more", a0)?;
    }
    for (j, &a) in s.a.iter().flatten().enumerate() {
        positive(a.is_finite() && a > 0.0, &format!("a[{j}]"), "positive", a)?;
    }
    if let Some(a) = &s.a {
        positive(a.len() == k, "a", "one number a shape", a.len() as f64)?;
    }
    Ok(())
}

fn positive(ok: bool, what: &str, expected: &'static str, got: f64) -> Result<(), MorphError> {
    if ok { Ok(()) } else { Err(MorphError::Range { what: what.to_owned(), expected, got }) }
}
