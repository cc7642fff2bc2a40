//! Triangles for any surface, as fine as a chord tolerance asks.
//!
//! Every patch becomes a grid of equal steps. Its steps are made smaller until no edge and no triangle
//! is farther than the tolerance from the surface above it, looked at in a few places each. Borders
//! that run along each other, of one patch or of two, get the same steps, and their points become one
//! where they coincide; so neighbours, poles, folds and the glued ends of a Klein bottle close.

mod counts;
mod grid;
mod orient;

use super::{Surface, SurfaceError};
use crate::mesh::TriMesh;
use glam::DVec3;
use grid::Grid;
use std::collections::HashMap;

/// Border points closer than this, as a part of the size of the surface, are one.
pub const SNAP: f64 = 1e-7;

/// Most points that a tessellation may have.
pub const MOST_POINTS: usize = 1 << 23;

/// A surface as triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct Tessellation {
    /// The triangles. Where the surface is two-sided neighbours agree in their direction, and closed
    /// pieces face outward; elsewhere they face as su x sv does.
    pub mesh: TriMesh,
    /// Whether every edge has two faces: no borders are left.
    pub closed: bool,
    /// Whether every piece has two sides. A Klein bottle has not: it is closed, and bounds nothing.
    pub two_sided: bool,
}

/// The surface as triangles, none farther than `tolerance` (mm) from it where it was looked at.
///
/// # Errors
/// A tolerance that is not over 0; points that are not finite; more than [`MOST_POINTS`] points.
pub fn tessellate(surface: &dyn Surface, tolerance: f64) -> Result<Tessellation, SurfaceError> {
    if !(tolerance.is_finite() && tolerance > 0.0) {
        let why = format!("{tolerance}; a finite number over 0, in mm");
        return Err(SurfaceError::new("tolerance", why));
    }
    let size = counts::size(surface)?;
    let classes = counts::Classes::of(surface, SNAP * size);
    let grids = refine(surface, &classes, tolerance)?;
    Ok(orient::finish(join(&grids, SNAP * size)))
}

/// The surface as the triangles of a net: `size` points over u and v of every patch, ends included.
/// Border points that coincide become one, as in [`tessellate`].
///
/// # Errors
/// Fewer than two points a side; points that are not finite; more than [`MOST_POINTS`] points.
pub fn net(surface: &dyn Surface, size: [usize; 2]) -> Result<Tessellation, SurfaceError> {
    let grids = grids(surface, size)?;
    Ok(orient::finish(join(&grids, SNAP * counts::size(surface)?)))
}

/// The net of [`net`] with every point of every patch its own: as many at every time of a motion,
/// whatever comes together or parts. Faces face as su x sv does.
///
/// # Errors
/// As for [`net`].
pub fn loose_net(surface: &dyn Surface, size: [usize; 2]) -> Result<TriMesh, SurfaceError> {
    let mut mesh = TriMesh::default();
    for grid in grids(surface, size)? {
        let start = mesh.points.len() as u32;
        let ids: Vec<u32> = (start..start + grid.points.len() as u32).collect();
        mesh.faces.extend(grid.faces(&ids));
        mesh.points.extend(grid.points);
    }
    Ok(mesh)
}

/// A grid a patch, of that many points over u and v.
fn grids(surface: &dyn Surface, size: [usize; 2]) -> Result<Vec<Grid>, SurfaceError> {
    let [nu, nv] = size;
    if nu.min(nv) < 2 {
        return Err(SurfaceError::new("samples", format!("{nu} x {nv}; at least 2 each way")));
    }
    let points = nu.saturating_mul(nv).saturating_mul(surface.patches());
    if points > MOST_POINTS {
        let why = format!("{points} points; at most {MOST_POINTS}");
        return Err(SurfaceError::new("samples", why));
    }
    let grid = |p| Grid::sample(surface, p, [nu - 1, nv - 1]);
    (0..surface.patches()).map(grid).collect()
}

/// Grids with steps small enough.
fn refine(
    surface: &dyn Surface,
    classes: &counts::Classes,
    tolerance: f64,
) -> Result<Vec<Grid>, SurfaceError> {
    let mut counts = classes.first();
    loop {
        let sample = |p| Grid::sample(surface, p, classes.of_patch(&counts, p));
        let grids: Vec<Grid> = (0..surface.patches()).map(sample).collect::<Result<_, _>>()?;
        let errors: Vec<[f64; 2]> = grids.iter().map(|g| g.errors(surface)).collect();
        let Some((next, wanted)) = classes.grow(&counts, &errors, tolerance) else {
            return Ok(grids);
        };
        if classes.points(&next) > MOST_POINTS || classes.points(&wanted) > 4 * MOST_POINTS {
            let why = format!("{tolerance} would take more than {MOST_POINTS} points");
            return Err(SurfaceError::new("tolerance", why));
        }
        counts = next;
    }
}

/// One mesh of all grids, with border points that coincide made one.
fn join(grids: &[Grid], near: f64) -> TriMesh {
    let mut mesh = TriMesh::default();
    let mut welder = Welder { near, cells: HashMap::new() };
    for grid in grids {
        let ids: Vec<u32> = grid
            .points
            .iter()
            .enumerate()
            .map(|(i, &p)| {
                let new = mesh.points.len() as u32;
                let id = if grid.on_border(i) { welder.find(p, new, &mesh.points) } else { new };
                if id == new {
                    mesh.points.push(p);
                }
                id
            })
            .collect();
        mesh.faces.extend(grid.faces(&ids).filter(|[a, b, c]| a != b && b != c && c != a));
    }
    mesh
}

/// Points by the cell they are in.
struct Welder {
    near: f64,
    cells: HashMap<[i64; 3], Vec<u32>>,
}

impl Welder {
    /// The first point within reach of `p`, or `new`, which is then known.
    fn find(&mut self, p: DVec3, new: u32, points: &[DVec3]) -> u32 {
        let width = 2.0 * self.near;
        let cell = |q: DVec3| (q / width).floor().to_array().map(|x| x as i64);
        let [lo, hi] = [cell(p - self.near), cell(p + self.near)];
        let mut best = new;
        for x in lo[0]..=hi[0] {
            for y in lo[1]..=hi[1] {
                for z in lo[2]..=hi[2] {
                    for &i in self.cells.get(&[x, y, z]).into_iter().flatten() {
                        if points[i as usize].distance(p) <= self.near {
                            best = best.min(i);
                        }
                    }
                }
            }
        }
        if best == new {
            self.cells.entry(cell(p)).or_default().push(new);
        }
        best
    }
}

#[cfg(test)]
mod tests;
