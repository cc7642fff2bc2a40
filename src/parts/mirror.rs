//! The vertical plane that a shape is most nearly its own mirror image in.

use super::volume::Volume;
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// A vertical plane through `centre + offset * normal`, in samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    /// Direction of its normal, radians from x.
    pub yaw: f64,
    /// Distance from the centre along the normal, samples.
    pub offset: f64,
    /// How well the shape mirrors, in [0, 1].
    pub score: f64,
}

/// Everything that scoring a plane takes.
pub(super) struct Mirror {
    points: Vec<DVec3>,
    size: [usize; 3],
    /// Distance of every sample to the nearest solid one, samples.
    distance: Vec<f32>,
    /// Middle of the points in the plan.
    pub centre: DVec2,
    /// How far a plane is looked for from the centre, samples.
    reach: f64,
}

/// Most points looked at.
const POINTS: usize = 3000;
/// A point this many samples from the solid counts nothing.
const FAR: f64 = 3.0;

impl Mirror {
    /// Of what lies up to a level.
    pub fn new(volume: &Volume, up_to: usize) -> Option<Self> {
        let skin: Vec<_> = volume.skin().into_iter().filter(|p| p[2] <= up_to).collect();
        let stride = skin.len().div_ceil(POINTS).max(1);
        let points: Vec<DVec3> = skin
            .iter()
            .step_by(stride)
            .map(|p| DVec3::new(p[0] as f64, p[1] as f64, p[2] as f64))
            .collect();
        if points.is_empty() {
            return None;
        }
        let plan = |p: &DVec3| p.truncate();
        let centre = points.iter().map(plan).sum::<DVec2>() / points.len() as f64;
        let low = points.iter().map(plan).fold(DVec2::INFINITY, DVec2::min);
        let high = points.iter().map(plan).fold(DVec2::NEG_INFINITY, DVec2::max);
        let reach = 0.12 * (high - low).max_element();
        Some(Self { points, size: volume.size, distance: distances(volume), centre, reach })
    }

    pub fn score(&self, yaw: f64, offset: f64) -> f64 {
        let normal = DVec2::from_angle(yaw);
        let [nx, ny, _] = self.size;
        let top = DVec2::new(nx as f64 - 1.0, ny as f64 - 1.0);
        let near = |p: &DVec3| {
            let q = p.truncate();
            let image = q - 2.0 * ((q - self.centre).dot(normal) - offset) * normal;
            let cell = image.clamp(DVec2::ZERO, top);
            let (x, y) = (cell.x.round() as usize, cell.y.round() as usize);
            let d = f64::from(self.distance[(p.z as usize * ny + y) * nx + x]);
            (1.0 - (d + image.distance(cell) - 0.5) / FAR).clamp(0.0, 1.0)
        };
        self.points.iter().map(near).sum::<f64>() / self.points.len() as f64
    }

    fn plane(&self, yaw: f64, offset: f64) -> Plane {
        Plane { yaw, offset, score: self.score(yaw, offset) }
    }

    /// Climbs from a plane by ever smaller steps.
    pub fn refined(&self, mut best: Plane) -> Plane {
        let (mut turn, mut move_) = (2.0_f64.to_radians(), 1.0);
        for _ in 0..4 {
            loop {
                let steps = [(turn, 0.0), (-turn, 0.0), (0.0, move_), (0.0, -move_)];
                let near = steps.map(|(a, b)| self.plane(best.yaw + a, best.offset + b));
                let better = near.into_iter().fold(best, better);
                if better == best {
                    break;
                }
                best = better;
            }
            (turn, move_) = (turn / 2.0, move_ / 2.0);
        }
        best
    }

    /// The best plane whose normal lies within `spread` of `yaw`.
    pub fn near(&self, yaw: f64, spread: f64) -> Plane {
        let step = 6.0_f64.to_radians();
        let turns = (spread / step).floor() as i32;
        let moves = (self.reach / 2.0).floor() as i32;
        let mut all: Vec<Plane> = (-turns..=turns)
            .flat_map(|a| (-moves..=moves).map(move |b| (a, b)))
            .map(|(a, b)| self.plane(yaw + f64::from(a) * step, 2.0 * f64::from(b)))
            .collect();
        all.sort_by(|a, b| b.score.total_cmp(&a.score));
        all.truncate(4);
        let none = Plane { yaw, offset: 0.0, score: -1.0 };
        all.into_iter().map(|p| self.refined(p)).fold(none, better)
    }

    /// The best plane of all, and the best one about at right angles to it.
    pub fn best(&self) -> [Plane; 2] {
        let first = self.near(0.0, FRAC_PI_2);
        [first, self.near(first.yaw + FRAC_PI_2, PI / 12.0)]
    }
}

fn better(a: Plane, b: Plane) -> Plane {
    if b.score > a.score + 1e-12 { b } else { a }
}

/// Distance of every sample to the nearest solid one, in samples (Felzenszwalb and Huttenlocher
/// 2012: the lower envelope of parabolas, axis by axis).
fn distances(volume: &Volume) -> Vec<f32> {
    let [nx, ny, nz] = volume.size;
    let far = (nx * nx + ny * ny + nz * nz) as f64;
    let mut square = vec![far; nx * ny * nz];
    for [i, j, k] in volume.solids() {
        square[(k * ny + j) * nx + i] = 0.0;
    }
    for (n, step, starts) in [
        (nx, 1, lines(nx * ny * nz, nx, 1)),
        (ny, nx, lines(nx * ny * nz, ny, nx)),
        (nz, nx * ny, lines(nx * ny * nz, nz, nx * ny)),
    ] {
        let mut row = vec![0.0; n];
        for start in starts {
            for (x, r) in row.iter_mut().enumerate() {
                *r = square[start + x * step];
            }
            for (x, d) in envelope(&row).into_iter().enumerate() {
                square[start + x * step] = d;
            }
        }
    }
    square.into_iter().map(|d| d.sqrt() as f32).collect()
}

/// Where the lines of `n` samples `step` apart begin.
fn lines(all: usize, n: usize, step: usize) -> Vec<usize> {
    (0..all).filter(|i| (i / step).is_multiple_of(n.max(1))).collect()
}

/// min over q of (x - q)² + row[q], for every x.
fn envelope(row: &[f64]) -> Vec<f64> {
    let mut at: Vec<usize> = Vec::new();
    let mut from: Vec<f64> = Vec::new();
    let meet = |p: usize, q: usize| {
        let (a, b) = (p as f64, q as f64);
        (row[q] + b * b - row[p] - a * a) / (2.0 * (b - a))
    };
    for q in 0..row.len() {
        let mut s = f64::NEG_INFINITY;
        while let (Some(&p), Some(&f)) = (at.last(), from.last()) {
            s = meet(p, q);
            if s > f {
                break;
            }
            at.pop();
            from.pop();
            s = f64::NEG_INFINITY;
        }
        at.push(q);
        from.push(s);
    }
    let mut n = 0;
    (0..row.len())
        .map(|x| {
            while n + 1 < at.len() && from[n + 1] < x as f64 {
                n += 1;
            }
            let d = x as f64 - at[n] as f64;
            d * d + row[at[n]]
        })
        .collect()
}
