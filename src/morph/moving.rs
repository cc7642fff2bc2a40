//! One shape alone, at one moment.

use super::Morph;
use crate::field::Shared;
use crate::job::{Cancelled, Job};
use crate::num::Aabb;

/// What a morph of one shape, or of surfaces that move into each other, is once its time is fixed: one
/// field, whatever t.
pub struct Moment(pub Shared);

impl Morph for Moment {
    fn at(&self, _t: f64, _job: &dyn Job) -> Result<Shared, Cancelled> {
        Ok(self.0.clone())
    }

    fn domain(&self) -> Aabb {
        self.0.support()
    }
}
