//! Fieldgraft grafts shapes inside signed distance fields: meshes and solids become fields, fields
//! are morphed under the user's control on sparse grids, and one mesher writes closed, printable
//! meshes.
//!
//! # Words
//!
//! - A **field** ([`field::Field`]) has a value at every point and an honest bound over every box.
//!   **f < 0 inside, f > 0 outside, f = 0 on the surface.**
//! - A **signed distance** is a field whose value is the distance to the surface, in millimetres.
//! - A **feature element** ([`element::Element`]) is a shape in a frame, round a part of a shape;
//!   elements of one **feature** correspond point by point.
//! - A **morph** ([`morph::Morph`]) is a field for every time t in [0, 1]: the source at 0, the target
//!   at 1.
//! - A **lattice** ([`grid::Lattice`]) is a regular grid of sample points, a **voxel** its step, a
//!   **brick** a block of 8³ samples. Bricks that the surface cannot meet are never sampled.
//! - A **mesh** ([`mesh::TriMesh`]) is plain data: points and triangles, counter-clockwise seen from
//!   outside.
//!
//! # Units
//!
//! Millimetres, radians, Z up; the front of a chair looks to -Y. `f64` in the maths, `f32` in bricks
//! and files.
//!
//! # The road
//!
//! Sampling keeps every grid edge on which the sign changes, so the mesh is the one that the full grid
//! would give; the mesher closes it, manifold and free of self-intersections:
//!
//! ```
//! use fieldgraft::{element::Element, field::{sample::sample, solid::Solid}, grid::Lattice};
//! use fieldgraft::{field::Field, iso::{Mesher, extract}, job::Quiet};
//! let bar = Solid::new(&Element::rod([0.0, 0.0, 0.0].into(), [0.0, 0.0, 40.0].into(), 10.0)?, 0.0);
//! let samples = sample(&bar, Lattice::covering(&bar.support(), 0.5), &Quiet)?;
//! let mesh = extract(&samples.bricks, Mesher::Cone, &Quiet)?;
//! assert!((mesh.volume() / (std::f64::consts::PI * 100.0 * 40.0) - 1.0).abs() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! From files, the command does it all: `fieldgraft run recipe.toml`; from a program, see
//! [`scene`] and [`run`], and `examples/`.
//!
//! # Floors
//!
//! A module imports only from the floors below it; a test keeps it so.
//!
//! | floor | modules |
//! |---|---|
//! | 7 | [`run`] |
//! | 6 | [`scene`] |
//! | 5 | [`morph`], [`parts`], [`iso`], [`check`], [`picture`], [`recipe`] |
//! | 4 | [`field`] |
//! | 3 | [`element`] |
//! | 2 | [`bvh`], [`surface`] |
//! | 1 | [`mesh`], [`grid`], [`warp`], [`weight`] |
//! | 0 | [`num`], [`job`], [`memory`], [`place`] |

// floor 0
pub mod job;
pub mod memory;
pub mod num;
pub mod place;
// floor 1
pub mod grid;
pub mod mesh;
pub mod warp;
pub mod weight;
// floor 2
pub mod bvh;
pub mod surface;
// floor 3
pub mod element;
// floor 4
pub mod field;
// floor 5
pub mod check;
pub mod iso;
pub mod morph;
pub mod parts;
pub mod picture;
pub mod recipe;
// floor 6
pub mod scene;
// floor 7
pub mod run;
