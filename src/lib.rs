//! Fieldgraft grafts shapes inside signed distance fields. (Crate documentation to come.)

// floor 0
pub mod job;
pub mod num;
// floor 1
pub mod grid;
pub mod mesh;
pub mod warp;
pub mod weight;
// floor 2
pub mod bvh;
// floor 3
pub mod element;
// floor 4
pub mod field;
// floor 5
pub mod check;
pub mod iso;
pub mod morph;
pub mod picture;
pub mod recipe;
// floor 6
pub mod scene;
// floor 7
pub mod run;
