//! Meshes from samples: [`extract`] turns bricks into triangles, [`normals`] asks the field how
//! the surface stands.
//!
//! [`Mesher::Cone`] is for print. Whatever the samples are, its mesh is closed, oriented, edge-
//! and vertex-manifold, has no degenerate triangle and does not intersect itself, and all of that
//! holds for the f32 numbers of a mesh file, since its positions are f32 numbers already.
//!
//! ```
//! use fieldgraft::{field::{Field, sample::sample}, grid::Lattice, iso, job::Quiet};
//! use fieldgraft::num::{Aabb, Interval};
//! use glam::DVec3;
//!
//! struct Ball;
//! impl Field for Ball {
//!     fn value(&self, p: DVec3) -> f64 { p.length() - 10.0 }
//!     fn bound(&self, b: &Aabb) -> Interval { Interval::ball(self.value(b.centre()), b.radius()) }
//!     fn support(&self) -> Aabb { Aabb::around(DVec3::ZERO, DVec3::splat(10.0)) }
//! }
//! let on = Lattice::covering(&Ball.support(), 0.5);
//! let mesh = iso::extract(&sample(&Ball, on, &Quiet)?.bricks, iso::Mesher::Cone, &Quiet)?;
//! assert!((mesh.volume() / 4188.79 - 1.0).abs() < 0.005);
//! # Ok::<(), fieldgraft::job::Cancelled>(())
//! ```

mod block;
mod cell;
mod cone;
mod index;
mod loops;
mod nets;
mod normals;
mod qef;
mod sharp;

#[cfg(test)]
mod tests;

pub use normals::normals;

use crate::field::Field;
use crate::grid::Bricks;
use crate::job::{Cancelled, Job};
use crate::mesh::TriMesh;

/// How triangles are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mesher {
    /// Cone marching cubes: for print. Manifold and free of self-intersections, always.
    #[default]
    Cone,
    /// Naive surface nets: for quick previews. Half the triangles; where two sheets of the surface
    /// meet in a cell the mesh is not manifold.
    SurfaceNets,
}

/// The surface between inside and outside samples, closed: outermost samples count as outside.
///
/// Points and faces come in the order of the bricks and samples, whatever the number of threads.
/// The guarantee of [`Mesher::Cone`] needs a lattice that [`fits_f32`].
///
/// [`fits_f32`]: crate::grid::Lattice::fits_f32
pub fn extract(bricks: &Bricks<f32>, mesher: Mesher, job: &dyn Job) -> Result<TriMesh, Cancelled> {
    job.stage("mesh");
    match mesher {
        Mesher::Cone => cone::extract(bricks, job),
        Mesher::SurfaceNets => nets::extract(bricks, job),
    }
}

/// As [`extract`] with [`Mesher::Cone`], and with its guarantee, but edges and corners of the
/// shape stay sharp: the field is asked for exact crossings and the normals there.
///
/// Costs ten values of the field for every point on an edge of the lattice, two to three times
/// what sampling takes. `f` is the field that was sampled; another one spoils the shape, not
/// the guarantee.
pub fn extract_sharp(
    bricks: &Bricks<f32>,
    f: &dyn Field,
    job: &dyn Job,
) -> Result<TriMesh, Cancelled> {
    job.stage("mesh");
    sharp::extract(bricks, f, job)
}
