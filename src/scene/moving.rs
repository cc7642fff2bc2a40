//! A shape that moves: a field for every t.

use super::live::sampled;
use super::skinned::{Skinned, SkinnedError};
use crate::field::Shared;
use crate::job::{Cancelled, Job};
use crate::morph::MorphError;
use crate::num::Aabb;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// A shape that has another field at each t.
pub(super) struct Moving {
    name: String,
    shape: Skinned,
    /// Side of a cell, mm.
    step: f64,
    /// The last time asked for: several hybrids, or a morph and its volume, ask for one.
    last: Mutex<Option<Arc<Moment>>>,
}

/// The shape at one time.
pub(super) struct Moment {
    t: f64,
    step: f64,
    /// Its field.
    pub exact: Shared,
    sampled: OnceLock<(Shared, f64)>,
}

impl Moving {
    pub fn new(name: &str, shape: Skinned, step: f64) -> Self {
        Self { name: name.to_owned(), shape, step, last: Mutex::new(None) }
    }

    /// The shape's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The box at the given times, mm.
    pub fn bounds_at(&self, times: &[f64]) -> Aabb {
        self.shape.bounds_at(times)
    }

    /// The shape at `t`.
    ///
    /// # Errors
    /// What the motion says, by the name of the shape; cancelled.
    pub fn at(&self, t: f64, job: &dyn Job) -> Result<Arc<Moment>, MorphError> {
        let kept = self.last.lock().unwrap_or_else(PoisonError::into_inner).clone();
        if let Some(moment) = kept.filter(|m| m.t == t) {
            return Ok(moment);
        }
        // two at once would take twice the memory
        self.forget();
        job.stage(&format!("shape {}", self.name));
        let (exact, _) = self.shape.field(t, self.step, job).map_err(|e| match e {
            SkinnedError::Cancelled(c) => MorphError::Cancelled(c),
            e => MorphError::Shape { shape: self.name.clone(), t, why: e.to_string() },
        })?;
        let moment = Arc::new(Moment { t, step: self.step, exact, sampled: OnceLock::new() });
        *self.last.lock().unwrap_or_else(PoisonError::into_inner) = Some(moment.clone());
        Ok(moment)
    }
}

impl Moving {
    /// Lets go of what is kept of the last time.
    pub fn forget(&self) {
        *self.last.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }
}

impl Moment {
    /// The sampled form of the field, and the volume inside, mm³.
    pub fn sampled(&self, job: &dyn Job) -> Result<(Shared, f64), Cancelled> {
        if let Some(made) = self.sampled.get() {
            return Ok(made.clone());
        }
        let made = sampled(self.exact.clone(), true, self.step, job)?;
        Ok(self.sampled.get_or_init(|| made).clone())
    }
}
