//! Weighting functions of feature distances, eases u(t).
//!
//! Distances here are the house's: negative inside a feature, mm.

mod ease;
mod weighting;

pub use ease::Ease;
pub use weighting::Weighting;
