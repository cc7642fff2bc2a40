//! The shadow on the ground: how much of the studio's light reaches the floor round the feet.

use super::depth_map::Spot;
use super::light::Lights;
use super::scene::Scene;
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Cells along each side of the floor, for each pixel of the picture, and the bounds.
const CELLS: f32 = 0.32;
const FEWEST: usize = 64;
const MOST: usize = 256;
/// How far the floor reaches beyond the mesh, in lengths of its longest side.
const REACH: f32 = 0.9;
/// Width of the blur a shadow gets, for each unit of distance to what casts it: about half the
/// angle between neighbouring lights. Less, and each light's shadow shows its edge.
const BLUR: f32 = 0.30;

/// Light on a square of floor under the mesh; 1 is all of it.
pub(super) struct Ground {
    /// Height of the floor.
    pub z: f32,
    /// Cells along each side.
    side: usize,
    low: Vec2,
    /// Cells a unit.
    scale: f32,
    light: Vec<f32>,
}

impl Ground {
    /// For a picture with that many pixels along its longer side.
    pub fn new(scene: &Scene, lights: &Lights, pixels: usize) -> Self {
        let side = ((pixels as f32 * CELLS) as usize).clamp(FEWEST, MOST);
        let (min, max) = (scene.min, scene.max);
        let middle = (min + max).truncate() * 0.5;
        let half = (max - min).truncate().max_element() * 0.5 + (max - min).max_element() * REACH;
        let (low, scale) = (middle - half, side as f32 / (2.0 * half));
        let rows: Vec<Vec<[f32; 2]>> = (0..side)
            .into_par_iter()
            .map(|y| {
                let spot = |x| {
                    let cell = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                    Spot { at: (low + cell / scale).extend(min.z), normal: Vec3::Z }
                };
                lights.on_floor(&(0..side).map(spot).collect::<Vec<_>>())
            })
            .collect();
        let (raw, caster): (Vec<f32>, Vec<f32>) =
            rows.into_iter().flatten().map(|[light, caster]| (light, caster)).unzip();
        // The width of the blur is itself smoothed, or its jumps would show.
        let width = blurred(&caster, side, |_| side as f32 / 64.0);
        let mut light = raw;
        for _ in 0..2 {
            light = blurred(&light, side, |i| width[i] * BLUR * scale);
        }
        Self { z: min.z, side, low, scale, light }
    }

    /// The light at a place of the floor, fading to 1 at the edge of the square.
    pub fn light(&self, at: Vec2) -> f32 {
        let place = (at - self.low) * self.scale - 0.5;
        let from_middle = (place / (self.side as f32 * 0.5) - 1.0).length();
        let fade = ((1.0 - from_middle) / 0.6).clamp(0.0, 1.0);
        if fade == 0.0 {
            return 1.0;
        }
        let last = (self.side - 2) as f32;
        let corner = place.clamp(Vec2::ZERO, Vec2::splat(last)).to_array().map(|n| n as usize);
        let part = place - Vec2::from(corner.map(|n| n as f32));
        let part = part.clamp(Vec2::ZERO, Vec2::ONE);
        let first = corner[1] * self.side + corner[0];
        let mix = |i: usize| self.light[i] + (self.light[i + 1] - self.light[i]) * part.x;
        let light = mix(first) + (mix(first + self.side) - mix(first)) * part.y;
        1.0 - (1.0 - light) * fade * fade * (3.0 - 2.0 * fade)
    }
}

/// The mean over a square round each cell, of the given half width in cells.
fn blurred(values: &[f32], cells: usize, half: impl Fn(usize) -> f32 + Sync) -> Vec<f32> {
    // Sums over all cells before a row and a column; f64, or differences of them lose the point.
    let side = cells + 1;
    let mut sums = vec![0.0_f64; side * side];
    for y in 0..cells {
        for x in 0..cells {
            let i = y * side + x;
            sums[i + side + 1] =
                f64::from(values[y * cells + x]) + sums[i + side] + sums[i + 1] - sums[i];
        }
    }
    let mean = |i: usize| {
        // Between two whole widths the means are mixed, so that widths may vary smoothly.
        let half = half(i).clamp(0.0, cells as f32 / 4.0);
        let square = |half: usize| {
            let (x, y) = (i % cells, i / cells);
            let (left, top) = (x.saturating_sub(half), y.saturating_sub(half));
            let (right, bottom) = ((x + half + 1).min(cells), (y + half + 1).min(cells));
            let at = |x: usize, y: usize| sums[y * side + x];
            let sum = at(right, bottom) - at(left, bottom) - at(right, top) + at(left, top);
            sum as f32 / ((right - left) * (bottom - top)) as f32
        };
        let (narrow, wide) = (square(half as usize), square(half as usize + 1));
        narrow + (wide - narrow) * half.fract()
    };
    (0..values.len()).into_par_iter().map(mean).collect()
}
