//! Metamorphosis (paper 001): at a time t in [0, 1], a field.
//!
//! Every method is one [`Plan`]: shapes, perhaps features, and a [`Scheme`]. Most blend by a morphing
//! function: `linear` and `space-time` have no features; `feature-volume` (Lerios 1995) blends
//! fields by inverse-square weights; `graft` (two shapes) and `group` (any number) blend maps by
//! default. `level-set`, `transport` and `warp` go other ways, for comparison. [`build`] checks the plan; [`Morph::at`] fixes the time and measures what is automatic.

mod convex;
mod enclose;
mod hybrid;
mod inner;
mod level_set;
mod measure;
mod metamorphosis;
mod moving;
mod plan;
mod space_time;
mod transport;
mod tune;
mod warp_field;
mod whole;

pub use moving::Moment;
pub use plan::{
    Anchor, Blend, Course, Feature, Foot, Form, Frames, Inner, MorphError, Part, Plan, Scheme,
    SpaceTime,
};
pub use tune::{Choice, Outlook, Style, Tuning, tune};

use crate::field::Shared;
use crate::job::{Cancelled, Job};
use crate::num::Aabb;
use std::sync::Arc;

/// A shape that depends on t: t = 0 is the source, t = 1 the target.
pub trait Morph: Send + Sync {
    /// The field at time `t`.
    fn at(&self, t: f64, job: &dyn Job) -> Result<Shared, Cancelled>;
    /// A box that holds the result at every time.
    fn domain(&self) -> Aabb;
    /// What the user should know of the fields made so far, such as what cannot appear.
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }
}

impl Morph for Arc<dyn Morph> {
    fn at(&self, t: f64, job: &dyn Job) -> Result<Shared, Cancelled> {
        (**self).at(t, job)
    }
    fn domain(&self) -> Aabb {
        (**self).domain()
    }
    fn notes(&self) -> Vec<String> {
        (**self).notes()
    }
}

/// Where a hybrid of this plan should touch the floor at `t`: the feet of the shapes that weigh most where
/// they are, carried there by the features. None without features, or with frames other than the mean.
///
/// # Errors
/// A plan that cannot be carried out.
pub fn feet(plan: &Plan, t: f64) -> Result<Vec<Foot>, MorphError> {
    let checked = metamorphosis::Metamorphosis::new(plan.clone())?;
    let lam: Vec<Vec<f64>> = plan.features.iter().map(|f| f.morph.at(t)).collect();
    let steps = checked.steps(t).into_iter();
    Ok(steps.filter(|s| metamorphosis::leads(&lam[s.feature], s.shape)).map(|s| s.foot).collect())
}

#[cfg(test)]
mod schemes_tests;
#[cfg(test)]
mod tests;

/// Checks a plan and makes it a morph.
///
/// # Errors
/// A [`MorphError`] that names the feature or parameter at fault.
pub fn build(plan: Plan) -> Result<Box<dyn Morph>, MorphError> {
    // every plan is checked alike, whatever its scheme uses of it
    let checked = metamorphosis::Metamorphosis::new(plan)?;
    Ok(match checked.plan.scheme.clone() {
        Scheme::Blend => Box::new(checked),
        Scheme::LevelSet { step } => {
            let Plan { shapes, course, .. } = checked.plan;
            Box::new(level_set::LevelSet::new(shapes, course, step)?)
        }
        Scheme::Transport { samples } => {
            let Plan { shapes, course, .. } = checked.plan;
            Box::new(transport::Transport::new(shapes, course, samples)?)
        }
        Scheme::Warp { anchors } => {
            let Plan { shapes, course, features, .. } = checked.plan;
            Box::new(warp_field::Warp::new(shapes, course, &features, anchors)?)
        }
    })
}
