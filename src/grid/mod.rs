//! The sampling lattice and sparse bricks of samples on it.

mod bricks;
mod lattice;

pub use bricks::{BRICK, Brick, Bricks};
pub use lattice::{Lattice, ulp};
