//! What methods of whole shapes on a lattice of their own share.

use super::plan::MorphError;
use crate::field::dense::plane;
use crate::field::{Field, Shared};
use crate::grid::Lattice;
use crate::job::{Cancelled, Job, check};
use crate::num::Aabb;
use rayon::prelude::*;

/// Samples kept free on every side of the shapes.
const MARGIN: f64 = 2.0;
/// Boxes looked at in search of a common point, at most.
const SEARCH: usize = 200_000;

/// A lattice over the domain with cells of `step` mm, or larger ones so that it has about `most`
/// samples at most.
pub(super) fn lattice(domain: &Aabb, step: f64, most: f64) -> Lattice {
    let count = |step: f64| (domain.size() / step + 2.0 * MARGIN + 3.0).element_product();
    let mut step = step.max(domain.size().max_element() * 1e-4);
    while count(step) > most * 1.01 {
        step *= (count(step) / most).cbrt().max(1.005);
    }
    Lattice::covering(&domain.grow(MARGIN * step), step)
}

/// Samples of a lattice that [`lattice`] would make.
pub(super) fn count(domain: &Aabb, step: f64, most: f64) -> f64 {
    if domain.is_finite() { lattice(domain, step, most).samples() as f64 } else { most }
}

/// The box round all shapes.
pub(super) fn domain<'a>(shapes: impl IntoIterator<Item = &'a Shared>) -> Aabb {
    shapes.into_iter().fold(Aabb::EMPTY, |b, s| b.hull(s.support()))
}

/// The box round shapes that a lattice can hold.
pub(super) fn bounded<'a>(
    shapes: impl IntoIterator<Item = &'a Shared>,
) -> Result<Aabb, MorphError> {
    let all = domain(shapes);
    let fits = all.is_finite() && !all.is_empty() && all.size().max_element() > 0.0;
    if fits { Ok(all) } else { Err(MorphError::Unbounded) }
}

/// A field at every sample, x fastest.
pub(super) fn samples(
    f: &dyn Field,
    lattice: &Lattice,
    job: &dyn Job,
) -> Result<Vec<f32>, Cancelled> {
    let one = |k: u32| {
        check(job)?;
        let at: Vec<_> = plane(lattice, k).collect();
        let mut out = vec![0.0; at.len()];
        f.values(&at, &mut out);
        Ok(out.into_iter().map(|v| v as f32).collect())
    };
    let planes: Vec<Vec<f32>> =
        (0..lattice.size[2]).into_par_iter().map(one).collect::<Result<_, Cancelled>>()?;
    Ok(planes.concat())
}

/// Whether some point lies inside all of the shapes, as far as boxes of `least` mm show it.
pub(super) fn meet(shapes: &[&Shared], least: f64) -> bool {
    let mut open = vec![shapes.iter().fold(Aabb::ALL, |b, s| b.meet(s.support()))];
    for _ in 0..SEARCH {
        let Some(b) = open.pop() else { return false };
        if b.is_empty() || shapes.iter().any(|s| s.bound(&b).lo >= 0.0) {
            continue;
        }
        let c = b.centre();
        if shapes.iter().all(|s| s.value(c) < 0.0) {
            return true;
        }
        let size = b.size();
        if size.max_element() <= least || !size.is_finite() {
            continue;
        }
        let axis = (0..3).fold(0, |a, i| if size[i] > size[a] { i } else { a });
        let (mut low, mut high) = (b, b);
        low.max[axis] = c[axis];
        high.min[axis] = c[axis];
        // the half whose middle lies deeper comes first
        let worst =
            |b: &Aabb| shapes.iter().map(|s| s.value(b.centre())).fold(f64::NEG_INFINITY, f64::max);
        let halves = if worst(&low) < worst(&high) { [high, low] } else { [low, high] };
        open.extend(halves);
    }
    false
}
