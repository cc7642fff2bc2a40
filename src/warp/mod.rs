//! Space maps: twist, taper and bend along z (Barr 1984), forward and inverse, with honest bounds
//! on their stretch and on the image of a ball.

mod barr;
mod deform;

pub(crate) use barr::Near;
pub use barr::{Ball, Barr};
pub use deform::{Deform, WarpError};
