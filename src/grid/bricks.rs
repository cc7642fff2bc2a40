use super::Lattice;

/// Samples along a side of a brick.
pub const BRICK: u32 = 8;

/// A block of 8³ samples, or the one sign that all of them have.
#[derive(Clone, Debug, PartialEq)]
pub enum Brick<T> {
    /// Every sample is inside (f < 0).
    Inside,
    /// Every sample is outside (f >= 0).
    Outside,
    /// The samples, x fastest: sample (i, j, k) of the brick at `i + 8 j + 64 k`.
    Band(Box<[T; 512]>),
}

/// Samples over a lattice, in bricks of 8³; brick (a, b, c) holds samples 8a.., 8b.., 8c.. .
#[derive(Clone, Debug, PartialEq)]
pub struct Bricks<T> {
    /// Where the samples lie.
    pub lattice: Lattice,
    /// Bricks along x, y, z.
    pub size: [u32; 3],
    /// All bricks, x fastest.
    pub bricks: Vec<Brick<T>>,
}
