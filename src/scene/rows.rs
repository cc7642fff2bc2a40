//! Rows of weights -> the courses of features and wholes.

use super::plan::function;
use crate::element::Element;
use crate::morph::{Course, Feature};
use crate::recipe::{FeatureEntry, FeatureMorph, MorphEntry, Weights};
use crate::weight::Ease;

/// The rows of weights of an entry.
pub(super) struct Rows<'a> {
    pub entry: &'a MorphEntry,
    pub names: &'a [&'a str],
}

impl Rows<'_> {
    /// The row under `name`; shapes that it does not name have no share.
    fn row(&self, rows: &Weights, name: &str) -> Option<Vec<f64>> {
        let row = rows.get(name)?;
        let all: Vec<f64> =
            self.names.iter().map(|&n| row.get(n).copied().unwrap_or(0.0)).collect();
        // a row over other shapes only, as a hybrid of fewer shapes has, says nothing here
        (all.iter().sum::<f64>() > 0.0).then_some(all)
    }

    /// What everything without a row of its own follows.
    fn rest(&self) -> Course {
        match self.row(&self.entry.weights, "default") {
            Some(row) => Course::Fixed(row),
            None if self.names.len() == 2 => Course::Pair(Ease::Power(1.0)),
            None => Course::Fixed(vec![1.0; self.names.len()]),
        }
    }

    pub fn feature(&self, f: &FeatureEntry, elements: Vec<Element>) -> Feature {
        let change = self.change(f);
        let own = change.t.map(|t| t.0);
        let morph = match self.row(&self.entry.weights, &f.name) {
            Some(row) => Course::Fixed(row),
            None => paired(self.rest(), own),
        };
        let offset = change.offset.or(self.entry.offset).unwrap_or(0.0);
        let inner = change.inner.map(function);
        Feature { name: f.name.clone(), elements, deform: morph.clone(), morph, offset, inner }
    }

    /// How a feature changes: as this entry says, else as the feature does.
    fn change(&self, f: &FeatureEntry) -> FeatureMorph {
        let own = f.morph.clone().unwrap_or_default();
        self.entry.parts.get(&f.name).map_or(own.clone(), |part| part.over(&own))
    }

    /// Weights of the frames: own row, `default` row, own time function, else those all features
    /// share, so that the parts of a hybrid stay in proportion.
    pub fn deform(&self, f: &FeatureEntry, shared: Option<&Vec<f64>>) -> Course {
        let rows = &self.entry.deform_weights;
        let own = self.change(f).deform.map(|t| t.0);
        if let Some(row) = self.row(rows, &f.name).or_else(|| self.row(rows, "default")) {
            return Course::Fixed(row);
        }
        match shared {
            Some(mean) => Course::Fixed(mean.clone()),
            None if self.names.len() == 2 => Course::Pair(own.unwrap_or(Ease::Power(1.0))),
            None => Course::Fixed(vec![1.0; self.names.len()]),
        }
    }

    /// Weights of the whole: the rest's, or the mean of the features' where nothing is said.
    pub fn whole(&self, features: &[Feature]) -> Course {
        match mean_rows(features, self.names.len()) {
            Some(mean) if self.row(&self.entry.weights, "default").is_none() => Course::Fixed(mean),
            _ => self.rest(),
        }
    }

    /// Weights of the whole where `auto` chose those of the features. It does so part by part, such that
    /// the whole keeps its shares: the frames have a row for all, or the parts times of their own beside
    /// the features'. In a recipe made by hand a row `default` is only that of features without one.
    pub fn chosen(&self) -> Option<Course> {
        if let Some(row) = self.row(&self.entry.deform_weights, "default") {
            return Some(Course::Fixed(row));
        }
        let timed = self.entry.parts.values().any(|p| p.t.is_some());
        (timed && self.names.len() == 2).then(|| self.rest())
    }
}

/// A pair's course with the feature's own time function.
fn paired(course: Course, own: Option<Ease>) -> Course {
    match (course, own) {
        (Course::Pair(_), Some(ease)) => Course::Pair(ease),
        (course, _) => course,
    }
}

/// The mean of the features' normalised rows, when all of them are fixed.
pub(super) fn mean_rows(features: &[Feature], shapes: usize) -> Option<Vec<f64>> {
    let fixed = |f: &Feature| matches!(f.morph, Course::Fixed(_));
    if features.is_empty() || !features.iter().all(fixed) {
        return None;
    }
    let mut mean = vec![0.0; shapes];
    for f in features {
        for (m, w) in mean.iter_mut().zip(f.morph.at(0.0)) {
            *m += w / features.len() as f64;
        }
    }
    Some(mean)
}
