//! The dolphin.
use crate::surface::pde::Boundary;
/// x
pub fn dolphin() -> Vec<Boundary> {
    vec![]
}
