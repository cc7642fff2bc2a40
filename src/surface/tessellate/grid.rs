//! The grid of one patch.

use crate::surface::{Domain, Surface, SurfaceError};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Where an edge is looked at, in parts of it: the middle, and a place off it for what happens to
/// cross the chord there.
const LOOKS: [f64; 2] = [0.5, 0.21];

/// Points at equal steps over a patch; u slowest. An axis that wraps does not repeat its first row.
pub(super) struct Grid {
    patch: usize,
    domain: Domain,
    /// Steps in u and v.
    steps: [usize; 2],
    /// Rows and columns of points.
    size: [usize; 2],
    pub points: Vec<DVec3>,
}

impl Grid {
    pub fn sample(
        surface: &dyn Surface,
        patch: usize,
        steps: [usize; 2],
    ) -> Result<Self, SurfaceError> {
        let domain = surface.domain(patch);
        let size = [0, 1].map(|k| steps[k] + usize::from(!domain.wraps[k]));
        let mut grid = Self { patch, domain, steps, size, points: vec![] };
        let all = (0..size[0] * size[1]).into_par_iter();
        grid.points = all
            .map(|i| {
                let at = DVec2::new((i / size[1]) as f64, (i % size[1]) as f64);
                surface.point(patch, grid.uv(at))
            })
            .collect();
        match grid.points.iter().position(|p| !p.is_finite()) {
            None => Ok(grid),
            Some(i) => {
                let uv = grid.uv(DVec2::new((i / size[1]) as f64, (i % size[1]) as f64));
                let why = format!("not finite at u = {}, v = {}", uv.x, uv.y);
                Err(SurfaceError::new(format!("patches[{patch}]"), why))
            }
        }
    }

    /// The parameters at a place counted in steps. Its last row is exactly the end of the domain.
    fn uv(&self, at: DVec2) -> DVec2 {
        let along = |[from, to]: [f64; 2], x: f64, steps: usize| {
            let w = x / steps as f64;
            from * (1.0 - w) + to * w
        };
        DVec2::new(
            along(self.domain.u, at.x, self.steps[0]),
            along(self.domain.v, at.y, self.steps[1]),
        )
    }

    /// The point of row i and column j, one past the last where the axis wraps.
    fn id(&self, i: usize, j: usize) -> usize {
        (i % self.size[0]) * self.size[1] + j % self.size[1]
    }

    /// Whether point `i` lies on the border of the patch.
    pub fn on_border(&self, i: usize) -> bool {
        let place = [i / self.size[1], i % self.size[1]];
        (0..2).any(|k| !self.domain.wraps[k] && (place[k] == 0 || place[k] + 1 == self.size[k]))
    }

    /// Two triangles a cell, facing as su x sv, between the points that `ids` names. The shorter
    /// diagonal divides a cell; but at the tip of a fold both cells take the one through the tip, or
    /// they would have the other one in common.
    pub fn faces<'a>(&'a self, ids: &'a [u32]) -> impl Iterator<Item = [u32; 3]> + 'a {
        let cells = (0..self.steps[0]).flat_map(|i| (0..self.steps[1]).map(move |j| [i, j]));
        cells.flat_map(move |[i, j]| {
            let corners = self.cell(i, j);
            let tip = |k: usize| self.is_tip(ids, corners[k]);
            let straight =
                if tip(0) || tip(2) { true } else { !(tip(1) || tip(3)) && self.straight(corners) };
            let [a, b, c, d] = corners.map(|k| ids[k]);
            if straight { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
        })
    }

    /// Whether point `i` is where a border folds back onto itself.
    fn is_tip(&self, ids: &[u32], i: usize) -> bool {
        let place = [i / self.size[1], i % self.size[1]];
        (0..2).any(|across| {
            let along = 1 - across;
            let size = self.size[along];
            let border = !self.domain.wraps[across]
                && (place[across] == 0 || place[across] + 1 == self.size[across]);
            let inner = self.domain.wraps[along] || (1..size - 1).contains(&place[along]);
            let beside = |step: usize| {
                let mut at = place;
                at[along] = (at[along] + step) % size;
                ids[self.id(at[0], at[1])]
            };
            border && inner && beside(1) == beside(size - 1) && ids[i] != beside(1)
        })
    }

    /// Corners of a cell, counter-clockwise in (u, v).
    fn cell(&self, i: usize, j: usize) -> [usize; 4] {
        [self.id(i, j), self.id(i + 1, j), self.id(i + 1, j + 1), self.id(i, j + 1)]
    }

    /// Whether the diagonal from the first corner is taken.
    fn straight(&self, [a, b, c, d]: [usize; 4]) -> bool {
        let length = |i: usize, j: usize| self.points[i].distance_squared(self.points[j]);
        length(a, c) <= length(b, d)
    }

    /// Largest distance of the surface from the edges along u and along v. What the diagonals have
    /// beyond both counts for the axis that bends more, or for both.
    pub fn errors(&self, surface: &dyn Surface) -> [f64; 2] {
        let rows: Vec<[f64; 3]> =
            (0..self.size[0]).into_par_iter().map(|i| self.row_errors(surface, i)).collect();
        let [u, v, diagonal] = rows.iter().fold([0.0f64; 3], |most, row| {
            [most[0].max(row[0]), most[1].max(row[1]), most[2].max(row[2])]
        });
        [u, v].map(|e| if 2.0 * e >= u.max(v) { e.max(diagonal) } else { e })
    }

    /// Along u, along v, on the diagonals, from row `i` to the next.
    fn row_errors(&self, surface: &dyn Surface, i: usize) -> [f64; 3] {
        let mut most = [0.0f64; 3];
        let mut look = |kind: usize, from: [usize; 2], to: [usize; 2]| {
            let [a, b] = [from, to].map(|[i, j]| self.points[self.id(i, j)]);
            let [x, y] = [from, to].map(|[i, j]| DVec2::new(i as f64, j as f64));
            for w in LOOKS {
                let p = surface.point(self.patch, self.uv(x.lerp(y, w)));
                most[kind] = most[kind].max(distance(p, a, b));
            }
        };
        for j in 0..self.size[1] {
            let [down, right] = [i < self.steps[0], j < self.steps[1]];
            if down {
                look(0, [i, j], [i + 1, j]);
            }
            if right {
                look(1, [i, j], [i, j + 1]);
            }
            if down && right && self.straight(self.cell(i, j)) {
                look(2, [i, j], [i + 1, j + 1]);
            } else if down && right {
                look(2, [i + 1, j], [i, j + 1]);
            }
        }
        most
    }
}

/// Distance of `p` from the segment a b.
fn distance(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let (along, length) = (b - a, (b - a).length_squared());
    let w = if length > 0.0 { ((p - a).dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
    p.distance(a + along * w)
}
