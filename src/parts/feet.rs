//! Where a shape touches the floor.

use super::find::FINE;
use super::volume::{Stand, Volume};
use crate::field::Field;
use crate::grid::Lattice;
use crate::job::{Cancelled, Job};
use crate::num::Aabb;
use glam::{DVec2, DVec3};

/// A place where a shape touches the floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// Its middle, on the floor.
    pub at: DVec3,
    /// Radius in the plan that holds all of it, mm.
    pub reach: f64,
}

/// What lies within this share of the height from the lowest point touches the floor.
const CONTACT: f64 = 0.02;
/// Gaps between what is one foot, samples.
const GAPS: f64 = 1.2;

/// Where a shape touches the floor, each place once; none for a shape that is empty or without bounds.
///
/// # Errors
/// Cancelled.
pub fn feet(field: &dyn Field, job: &dyn Job) -> Result<Vec<Foot>, Cancelled> {
    let space = field.support();
    let step = space.size().max_element() / FINE;
    if space.is_empty() || !space.is_finite() || step <= 0.0 {
        return Ok(Vec::new());
    }
    let contact = (CONTACT * space.size().z / step).round().max(1.0);
    let slab = Aabb::new(space.min, space.max.with_z(space.min.z + (contact + 1.0) * step));
    let v =
        Volume::sample(field, Stand::KEPT, Lattice::covering(&slab.grow(2.0 * step), step), job)?;
    let Some((floor, _)) = v.levels() else { return Ok(Vec::new()) };
    let touching = v.sections(floor..floor + contact as usize).closed(GAPS);
    let foot = |r: &super::mask::Region| {
        let centre = r.centre();
        let far = r.points().map(|p: DVec2| p.distance(centre)).fold(0.0, f64::max);
        Foot { at: v.plan(centre).extend(space.min.z), reach: (far + 0.5) * step }
    };
    Ok(touching.regions().iter().map(foot).collect())
}
