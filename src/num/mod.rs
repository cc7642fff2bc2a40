//! Intervals and boxes, the two enclosures that every bound is made of; band matrices.

mod aabb;
mod band;
mod interval;

pub use aabb::Aabb;
pub use band::{Band, Ldl, Singular};
pub use interval::Interval;
