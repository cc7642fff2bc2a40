//! Intervals and boxes: the two enclosures that every bound is made of.

mod aabb;
mod interval;

pub use aabb::Aabb;
pub use interval::Interval;
