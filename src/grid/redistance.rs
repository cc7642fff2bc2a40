//! A signed distance from samples of any field: the closest surface point of every sample.
//!
//! The surface is where the samples change sign, straight between the two samples of an edge. A
//! sample with such an edge knows the foot of the plane through its crossings; all others take over
//! the closest foot that their neighbours know, in four sweeps a plane (Danielsson 1980; Tsai 2002,
//! with the surface's own points instead of samples).

use super::Lattice;
use crate::job::{Cancelled, Job, check};
use glam::Vec3;

/// No foot known yet: far enough to lose against every real one, near enough to stay finite.
const FAR: Vec3 = Vec3::splat(1e15);

/// Signed distance (mm) of every sample of `lattice` to the surface of `samples`, x fastest; the
/// sign is that of the samples (below zero inside). Samples all of one sign have no surface: their
/// distance is infinite.
///
/// Beside a plane surface it is exact, near a curved one right to a tenth of a step; farther off it
/// is up to a seventh of a step too large, since the feet lie up to half a step apart.
///
/// # Errors
/// Cancelled.
pub fn redistance(
    lattice: &Lattice,
    samples: &[f32],
    job: &dyn Job,
) -> Result<Vec<f32>, Cancelled> {
    let size = lattice.size.map(|n| n as usize);
    let mut feet = Feet { size, at: vec![FAR; samples.len()] };
    for k in 0..size[2] {
        check(job)?;
        feet.start(samples, k);
    }
    let own = feet.at.clone();
    for k in 0..size[2] {
        check(job)?;
        feet.beside(&own, k);
    }
    drop(own);
    for k in 1..size[2] {
        check(job)?;
        feet.take_plane(k, k - 1);
        feet.within(k);
    }
    for k in (0..size[2].saturating_sub(1)).rev() {
        check(job)?;
        feet.take_plane(k, k + 1);
        feet.within(k);
    }
    // the last plane was swept before anything came from above: nothing does
    feet.within(0);
    let step = lattice.step as f32;
    let distance = |(i, (&s, foot)): (usize, (&f32, &Vec3))| {
        let d =
            if foot.x < FAR.x { (*foot - feet.place(i)).length() * step } else { f32::INFINITY };
        if s < 0.0 { -d } else { d }
    };
    Ok(samples.iter().zip(&feet.at).enumerate().map(distance).collect())
}

/// The closest known surface point of every sample, in steps from sample (0, 0, 0).
struct Feet {
    size: [usize; 3],
    at: Vec<Vec3>,
}

impl Feet {
    fn place(&self, i: usize) -> Vec3 {
        let [x, y, _] = self.size;
        Vec3::new((i % x) as f32, (i / x % y) as f32, (i / (x * y)) as f32)
    }

    /// The feet of the samples of plane `k` that have an edge with a crossing.
    fn start(&mut self, samples: &[f32], k: usize) {
        let [x, y, z] = self.size;
        for n in k * x * y..(k + 1) * x * y {
            let (i, j) = (n % x, n / x % y);
            let f = samples[n];
            // where the axis crosses the surface, in steps; the nearer of two
            let crossing = |at: usize, of: usize, stride: usize| {
                let up = (at + 1 < of).then(|| crossing(f, samples[n + stride])).flatten();
                let down = (at > 0).then(|| crossing(f, samples[n - stride])).flatten();
                match (up, down) {
                    (Some(u), Some(d)) if d < u => Some(-d),
                    (None, d) => d.map(|d| -d),
                    (u, _) => u,
                }
            };
            let at = [crossing(i, x, 1), crossing(j, y, x), crossing(k, z, x * y)];
            if at.iter().any(Option::is_some) {
                let slope = |at: usize, of: usize, stride: usize| {
                    let up = if at + 1 < of { samples[n + stride] } else { f };
                    let down = if at > 0 { samples[n - stride] } else { f };
                    up - down
                };
                let slope = [slope(i, x, 1), slope(j, y, x), slope(k, z, x * y)];
                self.at[n] = Vec3::new(i as f32, j as f32, k as f32) + foot(at, slope);
            }
        }
    }

    /// Feet of samples of plane `k` without a crossing of their own, on the planes of their
    /// neighbours: those feet would lie up to half a step aside.
    fn beside(&mut self, own: &[Vec3], k: usize) {
        let [x, y, z] = self.size;
        for n in k * x * y..(k + 1) * x * y {
            if own[n].x < FAR.x {
                continue;
            }
            let (i, j) = (n % x, n / x % y);
            let place = self.place(n);
            for c in around(k, z) {
                for b in around(j, y) {
                    for a in around(i, x) {
                        let m = a + x * (b + y * c);
                        if own[m].x < FAR.x {
                            let foot = on_plane(place, own[m], self.place(m));
                            if (foot - place).length_squared()
                                < (self.at[n] - place).length_squared()
                            {
                                self.at[n] = foot;
                            }
                        }
                    }
                }
            }
        }
    }

    /// Sample `n` takes over a neighbour's foot if that is closer.
    fn take(&mut self, n: usize, place: Vec3, from: usize) {
        let theirs = self.at[from];
        if (theirs - place).length_squared() < (self.at[n] - place).length_squared() {
            self.at[n] = theirs;
        }
    }

    /// Plane `k` learns from the plane beside it.
    fn take_plane(&mut self, k: usize, from: usize) {
        let [x, y, _] = self.size;
        for j in 0..y {
            for i in 0..x {
                let (n, place) = (i + x * (j + y * k), Vec3::new(i as f32, j as f32, k as f32));
                for b in around(j, y) {
                    for a in around(i, x) {
                        self.take(n, place, a + x * (b + y * from));
                    }
                }
            }
        }
    }

    /// Plane `k` spreads what it knows: its rows upward and downward, each forward and back.
    fn within(&mut self, k: usize) {
        let y = self.size[1];
        for j in 0..y {
            self.row(j, k, j.checked_sub(1));
        }
        for j in (0..y).rev() {
            self.row(j, k, Some(j + 1).filter(|&b| b < y));
        }
    }

    fn row(&mut self, j: usize, k: usize, from: Option<usize>) {
        let [x, y, _] = self.size;
        let at = |i: usize, j: usize| i + x * (j + y * k);
        let place = |i: usize| Vec3::new(i as f32, j as f32, k as f32);
        if let Some(b) = from {
            for i in 0..x {
                for a in around(i, x) {
                    self.take(at(i, j), place(i), at(a, b));
                }
            }
        }
        for i in 1..x {
            self.take(at(i, j), place(i), at(i - 1, j));
        }
        for i in (0..x.saturating_sub(1)).rev() {
            self.take(at(i, j), place(i), at(i + 1, j));
        }
    }
}

/// The foot of `place` on the plane through `foot` square to the way there from `of`, if that lies
/// close enough to be part of the surface; else `foot` itself.
fn on_plane(place: Vec3, foot: Vec3, of: Vec3) -> Vec3 {
    // feet of neighbours on one plane lie within this of each other
    const ASIDE: f32 = 0.75;
    let Some(normal) = (foot - of).try_normalize() else { return foot };
    let mine = place - (place - foot).dot(normal) * normal;
    if mine.distance_squared(foot) < ASIDE * ASIDE { mine } else { foot }
}

/// An index and its neighbours among `of`.
fn around(i: usize, of: usize) -> std::ops::Range<usize> {
    i.saturating_sub(1)..(i + 2).min(of)
}

/// Share of the edge at which values of two signs cross zero.
fn crossing(f: f32, g: f32) -> Option<f32> {
    if (f < 0.0) == (g < 0.0) {
        return None;
    }
    let share = f / (f - g);
    Some(if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.5 })
}

/// The foot of the plane through the crossings on the axes. Where an axis has none within a step,
/// the slope of the samples says where the plane meets it.
fn foot(at: [Option<f32>; 3], slope: [f32; 3]) -> Vec3 {
    // a crossing in the sample itself is the foot, to a millionth
    let away = |s: f32| if s.abs() < 1e-6 { 1e-6f32.copysign(s) } else { s };
    let inverse = at.map(|s| s.map(|s| 1.0 / away(s)));
    let steepest = (0..3).filter(|&a| at[a].is_some() && slope[a] != 0.0);
    let main = steepest.max_by(|&a, &b| slope[a].abs().total_cmp(&slope[b].abs()));
    let guess = |a: usize| {
        let guess = main.and_then(|m| Some(inverse[m]? * slope[a] / slope[m])).unwrap_or(0.0);
        if guess.is_finite() { guess.clamp(-1.0, 1.0) } else { 0.0 }
    };
    // Σ x_a / s_a = 1 lies nearest at (1/s_a) / Σ (1/s_a)²
    let normal = Vec3::from_array(std::array::from_fn(|a| inverse[a].unwrap_or_else(|| guess(a))));
    normal / normal.length_squared()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Quiet;
    use glam::DVec3;

    fn grid(n: u32, f: impl Fn(DVec3) -> f64) -> (Lattice, Vec<f32>) {
        let step = 2.0 / f64::from(n - 1);
        let lattice = Lattice { origin: DVec3::splat(-1.0), step, size: [n, n + 3, n - 2] };
        let [x, y, z] = lattice.size;
        let mut samples = Vec::new();
        for k in 0..z {
            for j in 0..y {
                samples.extend((0..x).map(|i| f(lattice.point(i, j, k)) as f32));
            }
        }
        (lattice, samples)
    }

    /// Largest error against the true distance, in steps.
    fn worst(n: u32, distance: impl Fn(DVec3) -> f64, scaled: impl Fn(f64, DVec3) -> f64) -> f64 {
        let (lattice, samples) = grid(n, |p| scaled(distance(p), p));
        let (_, truth) = grid(n, distance);
        let got = redistance(&lattice, &samples, &Quiet).unwrap();
        let off = got.iter().zip(&truth).map(|(a, b)| f64::from((a - b).abs()));
        off.fold(0.0, f64::max) / lattice.step
    }

    #[test]
    fn a_plane_is_exact_whatever_the_scale_of_its_samples() {
        let normal = DVec3::new(0.3, -0.5, 0.8).normalize();
        // the foot of a border sample may lie outside, so far corners are off: look inside only
        let (lattice, samples) = grid(24, |p| 7.0 * (p.dot(normal) - 0.1));
        let got = redistance(&lattice, &samples, &Quiet).unwrap();
        let [x, y, z] = lattice.size;
        for k in 8..z - 8 {
            for j in 8..y - 8 {
                for i in 8..x - 8 {
                    let want = lattice.point(i, j, k).dot(normal) - 0.1;
                    let got = f64::from(got[(i + x * (j + y * k)) as usize]);
                    // near the plane exact, farther off by the spacing of the feet
                    let slack = if want.abs() < 0.5 * lattice.step { 1e-4 } else { 0.15 };
                    assert!((got - want).abs() < slack * lattice.step, "{got} {want}");
                }
            }
        }
    }

    #[test]
    fn a_ball_is_right_to_a_fraction_of_a_step() {
        let ball = |p: DVec3| (p - DVec3::new(0.1, 0.05, -0.1)).length() - 0.6;
        // a field with the same zero set but quite another slope
        let steep = |d: f64, p: DVec3| d * (2.0 + p.x);
        let coarse = worst(20, ball, steep);
        let fine = worst(40, ball, steep);
        assert!(coarse < 0.15 && fine < 0.12, "{coarse} {fine}");
    }

    #[test]
    fn the_signs_stay_and_no_surface_is_infinitely_far() {
        let (lattice, samples) = grid(12, |p| p.length() + 1.0);
        assert!(
            redistance(&lattice, &samples, &Quiet).unwrap().iter().all(|&d| d == f32::INFINITY)
        );
        let (lattice, samples) = grid(16, |p| (9.0 * p.x).sin() + (7.0 * p.y + p.z).cos());
        let got = redistance(&lattice, &samples, &Quiet).unwrap();
        assert!(got.iter().zip(&samples).all(|(d, s)| (*d < 0.0) == (*s < 0.0)));
        // 1-Lipschitz along the axes but for the width of a foot's cell
        let x = lattice.size[0] as usize;
        for row in got.chunks_exact(x) {
            assert!(row.windows(2).all(|w| f64::from((w[0] - w[1]).abs()) <= 1.5 * lattice.step));
        }
    }

    #[test]
    fn a_cancelled_job_stops() {
        struct Stop;
        impl Job for Stop {
            fn cancelled(&self) -> bool {
                true
            }
        }
        let (lattice, samples) = grid(8, |p| p.x);
        assert_eq!(redistance(&lattice, &samples, &Stop), Err(Cancelled));
    }
}
