//! How many steps each patch gets: those that share a border share the steps along it.

use crate::num::Aabb;
use crate::surface::{Surface, SurfaceError};
use glam::{DVec2, DVec3};

/// Steps at first. A multiple of four, as every count: then the glue of a Klein bottle, v against
/// pi - v, and a fold, v against -v, take points to points.
const FIRST: usize = 16;

/// Points looked at on a border to see what it runs along.
const LOOKS: usize = 16;

/// Steps may grow by this in one go, and by no less than [`LEAST`].
const MOST: f64 = 3.0;
const LEAST: f64 = 1.2;

/// Which axes of which patches have the same count: index 2 patch + axis to class.
pub(super) struct Classes {
    class: Vec<usize>,
}

/// Diagonal of the box round a few points of every patch.
pub(super) fn size(surface: &dyn Surface) -> Result<f64, SurfaceError> {
    let mut bounds = Aabb::EMPTY;
    for patch in 0..surface.patches() {
        let points = (0..=LOOKS).flat_map(|i| (0..=LOOKS).map(move |j| [i, j]));
        for [i, j] in points {
            let p = at(surface, patch, [i, j].map(|k| k as f64 / LOOKS as f64));
            if !p.is_finite() {
                let why = "has points that are not finite";
                return Err(SurfaceError::new(format!("patches[{patch}]"), why));
            }
            bounds = bounds.with(p);
        }
    }
    Ok(bounds.size().length())
}

/// The point at parts of the domain.
fn at(surface: &dyn Surface, patch: usize, [x, y]: [f64; 2]) -> DVec3 {
    let domain = surface.domain(patch);
    let along = |[from, to]: [f64; 2], w: f64| from * (1.0 - w) + to * w;
    surface.point(patch, DVec2::new(along(domain.u, x), along(domain.v, y)))
}

/// A side of a patch that does not wrap: points along it, and the axis they run along.
struct Border {
    axis: usize,
    points: Vec<DVec3>,
    bounds: Aabb,
}

fn borders(surface: &dyn Surface) -> Vec<Border> {
    let mut out = vec![];
    for patch in 0..surface.patches() {
        let wraps = surface.domain(patch).wraps;
        for (across, end) in [(0, 0.0), (0, 1.0), (1, 0.0), (1, 1.0)] {
            if wraps[across] {
                continue;
            }
            let point = |i: usize| {
                let w = i as f64 / LOOKS as f64;
                at(surface, patch, if across == 0 { [end, w] } else { [w, end] })
            };
            let points: Vec<DVec3> = (0..=LOOKS).map(point).collect();
            let bounds = Aabb::of(points.iter().copied());
            out.push(Border { axis: 2 * patch + 1 - across, points, bounds });
        }
    }
    out
}

impl Border {
    /// Whether every point of this is a point of the other, in any order: the other way round, or
    /// starting elsewhere. A point is no border.
    fn along(&self, other: &Self, near: f64) -> bool {
        let size = |b: &Self| b.bounds.size().length();
        let apart = (self.bounds.min - other.bounds.min).abs().max_element();
        size(self) > near
            && size(other) > near
            && apart <= near
            && self.points.iter().all(|p| other.points.iter().any(|q| p.distance(*q) <= near))
    }
}

impl Classes {
    /// Looks at all borders; those that run along each other are of a class.
    pub fn of(surface: &dyn Surface, near: f64) -> Self {
        let mut class: Vec<usize> = (0..2 * surface.patches()).collect();
        let borders = borders(surface);
        for (i, a) in borders.iter().enumerate() {
            for b in &borders[i + 1..] {
                let (x, y) = (class[a.axis], class[b.axis]);
                if x != y && a.along(b, near) {
                    class.iter_mut().filter(|c| **c == x.max(y)).for_each(|c| *c = x.min(y));
                }
            }
        }
        Self { class }
    }

    /// Counts to start from, by class.
    pub fn first(&self) -> Vec<usize> {
        vec![FIRST; self.class.len()]
    }

    /// Steps of a patch in u and v.
    pub fn of_patch(&self, counts: &[usize], patch: usize) -> [usize; 2] {
        [counts[self.class[2 * patch]], counts[self.class[2 * patch + 1]]]
    }

    /// Points of all grids together.
    pub fn points(&self, counts: &[usize]) -> usize {
        (0..self.class.len() / 2).fold(0, |sum: usize, patch| {
            let [u, v] = self.of_patch(counts, patch).map(|n| n.saturating_add(1));
            sum.saturating_add(u.saturating_mul(v))
        })
    }

    /// Larger counts where a patch is not fine enough, and what would be enough if the error falls
    /// with the square of the count, as on a smooth surface: the first go there in steps, for what is
    /// not smooth looks worse from afar. Nothing when all are fine.
    pub fn grow(
        &self,
        counts: &[usize],
        errors: &[[f64; 2]],
        tolerance: f64,
    ) -> Option<(Vec<usize>, Vec<usize>)> {
        let mut worst = vec![0.0f64; counts.len()];
        for (i, &class) in self.class.iter().enumerate() {
            worst[class] = worst[class].max(errors[i / 2][i % 2]);
        }
        let grown = |most: f64| {
            let grow = |(&count, &worst): (&usize, &f64)| {
                let by = (worst / tolerance).sqrt().clamp(LEAST, most);
                if worst > tolerance {
                    (count as f64 * by / 4.0).ceil() as usize * 4
                } else {
                    count
                }
            };
            counts.iter().zip(&worst).map(grow).collect()
        };
        worst.iter().any(|w| *w > tolerance).then(|| (grown(MOST), grown(f64::INFINITY)))
    }
}
