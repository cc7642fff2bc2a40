//! The sampling lattice, sparse bricks of samples on it, and distances from samples.

mod bricks;
mod lattice;
mod redistance;

pub use bricks::{BRICK, Brick, Bricks};
pub use lattice::{Lattice, ulp};
pub use redistance::redistance;
