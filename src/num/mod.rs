//! Numbers: intervals and boxes, the two enclosures that every bound is made of; arithmetic
//! expressions as files hold them; band matrices; and near-miss names.

mod aabb;
mod band;
pub mod expr;
mod interval;
pub(crate) mod lanes;
pub mod lsq;
#[cfg(test)]
pub(crate) mod mutate;
pub mod near;

pub use aabb::Aabb;
pub use band::{Band, Ldl, Singular};
pub use expr::{Expr, ExprError};
pub use interval::Interval;
