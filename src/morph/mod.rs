//! Metamorphosis (paper 001): at a time t in [0, 1], a field.
//!
//! Every method is one [`Plan`]: shapes, perhaps features, a morphing function and what is
//! blended. `linear` and `space-time` have no features; `feature-volume` (Lerios 1995) blends
//! fields by inverse-square weights; `graft` (two shapes) and `group` (any number) blend maps by
//! default. [`build`] checks the plan; [`Morph::at`] fixes the time and measures what is automatic.

mod convex;
mod hybrid;
mod inner;
mod measure;
mod metamorphosis;
mod moving;
mod plan;
mod space_time;
mod tune;

pub use moving::Moment;
pub use tune::{Choice, Outlook, Style, Tuning, tune};
pub use plan::{Blend, Course, Feature, Form, Frames, Inner, MorphError, Part, Plan, SpaceTime};

use crate::field::Shared;
use crate::job::{Cancelled, Job};
use crate::num::Aabb;

/// A shape that depends on t: t = 0 is the source, t = 1 the target.
pub trait Morph: Send + Sync {
    /// The field at time `t`.
    fn at(&self, t: f64, job: &dyn Job) -> Result<Shared, Cancelled>;
    /// A box that holds the result at every time.
    fn domain(&self) -> Aabb;
}

#[cfg(test)]
mod tests;

/// Checks a plan and makes it a morph.
///
/// # Errors
/// A [`MorphError`] that names the feature or parameter at fault.
pub fn build(plan: Plan) -> Result<Box<dyn Morph>, MorphError> {
    Ok(Box::new(metamorphosis::Metamorphosis::new(plan)?))
}
