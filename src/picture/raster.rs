//! Which face each sample of the picture sees: a z-buffer over bands of rows.

use super::camera::{Camera, Seen};
use super::scene::Scene;
use rayon::prelude::*;

/// Steps a sample is divided into. Corners are moved to whole steps, so that all arithmetic on
/// edges is exact and neighbouring faces leave no gap.
const STEPS: f32 = 256.0;
/// Faces that reach further than this (steps) from the picture's corner are left out: products
/// of two such lengths must fit an i64.
const FARTHEST: f32 = (1 << 28) as f32;
/// Samples along each side of a pixel.
pub(super) const SAMPLES: usize = 3;
/// The same as a number.
pub(super) const SIDE: f32 = SAMPLES as f32;
/// No face.
pub(super) const NONE: u32 = u32::MAX;

#[derive(Clone, Copy)]
struct Corner {
    x: i32,
    y: i32,
    near: f32,
}

/// How much further off a face counts when it is seen from behind, in half diagonals of the
/// frame: where a face lies twice, once each way round, the proper side is shown.
const BEHIND: f32 = 1e-4;

/// All faces on the sample grid, sorted into bands.
pub(super) struct Raster<'a> {
    scene: &'a Scene,
    corners: Vec<Option<Corner>>,
    bands: Vec<Vec<u32>>,
    /// [`BEHIND`] in terms of nearness.
    behind: f32,
    /// Samples a band is high.
    rows: usize,
}

/// What the samples of a band see.
pub(super) struct Band {
    pub width: usize,
    /// First row of samples.
    pub top: usize,
    /// The face each sample sees, or [`NONE`].
    pub face: Vec<u32>,
    pub near: Vec<f32>,
}

impl<'a> Raster<'a> {
    /// For a picture of that many rows of samples, in bands of `rows`.
    pub fn new(scene: &'a Scene, camera: &Camera, height: usize, rows: usize) -> Self {
        let corner = |seen: Seen| {
            let at = (seen.at * SIDE * STEPS).round();
            (at.abs().max_element() < FARTHEST).then_some(Corner {
                x: at.x as i32,
                y: at.y as i32,
                near: seen.near,
            })
        };
        let corners: Vec<Option<Corner>> =
            scene.points.par_iter().map(|&p| camera.see(p).and_then(corner)).collect();
        let mut raster =
            Self { scene, corners, bands: Vec::new(), behind: camera.nearness(BEHIND), rows };
        let mut bands = vec![Vec::new(); height.div_ceil(rows)];
        for i in 0..scene.faces.len() {
            let Some(c) = raster.corners(i) else { continue };
            let (low, high) = covered(c.map(|c| c.y), height);
            for band in &mut bands[low / rows..high.div_ceil(rows).max(low / rows)] {
                band.push(i as u32);
            }
        }
        raster.bands = bands;
        raster
    }

    fn corners(&self, face: usize) -> Option<[Corner; 3]> {
        let [a, b, c] = self.scene.faces[face].map(|v| self.corners[v as usize]);
        Some([a?, b?, c?])
    }

    /// Draws one band of a picture that many samples wide and high.
    pub fn band(&self, index: usize, width: usize, height: usize) -> Band {
        let top = index * self.rows;
        let rows = self.rows.min(height - top);
        let mut band = Band {
            width,
            top,
            face: vec![NONE; width * rows],
            near: vec![f32::NEG_INFINITY; width * rows],
        };
        for &i in &self.bands[index] {
            if let Some(c) = self.corners(i as usize) {
                band.draw(i, c, rows, self.behind);
            }
        }
        band
    }

    /// What tells the shares of the three corners of a face.
    pub fn plane(&self, face: u32) -> Plane {
        self.corners(face as usize).map_or_else(Plane::default, |c| Edges::of(c).plane())
    }
}

impl Band {
    fn draw(&mut self, face: u32, c: [Corner; 3], rows: usize, behind: f32) {
        let (left, right) = covered(c.map(|c| c.x), self.width);
        let (low, high) = covered(c.map(|c| c.y), self.top + rows);
        let low = low.max(self.top);
        if left >= right || low >= high {
            return;
        }
        let edges = Edges::of(c);
        if edges.turn == 0 {
            return;
        }
        // Rows run down, so a face seen from outside turns the negative way.
        let back = if edges.turn > 0 { behind } else { 0.0 };
        let area = edges.turn.abs() as f32;
        let near = c.map(|c| (c.near - back) / area);
        for y in low..high {
            let (mut w, step) = edges.at(left, y);
            let row = (y - self.top) * self.width;
            for at in row + left..row + right {
                if (w[0] | w[1] | w[2]) >= 0 {
                    let n = w[0] as f32 * near[0] + w[1] as f32 * near[1] + w[2] as f32 * near[2];
                    if n > self.near[at] {
                        self.near[at] = n;
                        self.face[at] = face;
                    }
                }
                for k in 0..3 {
                    w[k] += step[k];
                }
            }
        }
    }
}

/// First sample whose centre is covered by some coordinates, and the first beyond, in 0..=end.
fn covered(steps: [i32; 3], end: usize) -> (usize, usize) {
    let (one, half) = (STEPS as i32, STEPS as i32 / 2);
    let low = steps[0].min(steps[1]).min(steps[2]);
    let high = steps[0].max(steps[1]).max(steps[2]);
    let first = (low + half - 1).div_euclid(one).clamp(0, end as i32);
    let beyond = ((high + half).div_euclid(one)).clamp(first, end as i32);
    (first as usize, beyond as usize)
}

/// The three edge functions of a triangle: at a point, the area (twice, in steps²) across from
/// each corner, positive inside.
struct Edges {
    corner: [[i64; 2]; 3],
    /// Twice the signed area.
    turn: i64,
}

impl Edges {
    fn of(c: [Corner; 3]) -> Self {
        let corner = c.map(|c| [i64::from(c.x), i64::from(c.y)]);
        Self { corner, turn: across(corner[0], corner[1], corner[2]) }
    }

    /// At the centre of a sample, and the step to the next one to the right.
    fn at(&self, x: usize, y: usize) -> ([i64; 3], [i64; 3]) {
        let [a, b, c] = self.corner;
        let one = STEPS as i64;
        let p = [x as i64 * one + one / 2, y as i64 * one + one / 2];
        let sign = self.turn.signum();
        let w = [across(b, c, p), across(c, a, p), across(a, b, p)].map(|w| w * sign);
        let step = [b[1] - c[1], c[1] - a[1], a[1] - b[1]].map(|dy| dy * one * sign);
        (w, step)
    }

    fn plane(&self) -> Plane {
        let [a, b, c] = self.corner;
        let (first, right) = self.at(0, 0);
        let down = STEPS as i64 * self.turn.signum();
        let down = [c[0] - b[0], a[0] - c[0], b[0] - a[0]].map(|dx| dx * down);
        Plane { edges: [first, right, down], sum: self.turn.abs().max(1) as f32 }
    }
}

/// How the corners of a face share its samples.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    /// Edge functions at the first sample, and their steps to the right and down.
    edges: [[i64; 3]; 3],
    /// Their sum.
    sum: f32,
}

impl Default for Plane {
    fn default() -> Self {
        Self { edges: [[1, 0, 0], [0; 3], [0; 3]], sum: 1.0 }
    }
}

impl Plane {
    /// Shares of the three corners at a sample.
    #[inline]
    pub fn shares(&self, x: usize, y: usize) -> [f32; 3] {
        let [first, right, down] = &self.edges;
        let (x, y) = (x as i64, y as i64);
        let share = |k: usize| (first[k] + right[k] * x + down[k] * y) as f32 / self.sum;
        [share(0), share(1), share(2)]
    }
}

/// Twice the signed area of a triangle.
fn across(a: [i64; 2], b: [i64; 2], c: [i64; 2]) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}
