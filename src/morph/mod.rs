//! Metamorphosis: at a time t in [0, 1], a field.

use crate::field::Shared;
use crate::job::{Cancelled, Job};

/// A shape that depends on t: t = 0 is the source, t = 1 the target.
pub trait Morph: Send + Sync {
    /// The field at time `t`.
    fn at(&self, t: f64, job: &dyn Job) -> Result<Shared, Cancelled>;
}
