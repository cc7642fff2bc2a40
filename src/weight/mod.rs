//! Weighting functions of feature distances, eases u(t).
//!
//! Distances here are the house's: negative inside a feature, mm. Paper 001 writes its depths
//! positive inside; the sign is turned here and nowhere else.

mod ease;
mod weighting;

pub use ease::{Ease, EaseError};
pub use weighting::Weighting;
