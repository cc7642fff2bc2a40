//! Fields with honest bounds, for the tests of sampling and meshing.

use crate::field::Field;
use crate::num::{Aabb, Interval};
use glam::{DVec2, DVec3};

/// A distance to a ball.
#[derive(Clone, Copy)]
pub struct Ball {
    pub centre: DVec3,
    pub radius: f64,
}

pub fn ball(x: f64, y: f64, z: f64, radius: f64) -> Ball {
    Ball { centre: DVec3::new(x, y, z), radius }
}

/// Any formula with a known Lipschitz constant, within a box.
pub struct Lipschitz<F> {
    pub value: F,
    pub constant: f64,
    pub support: Aabb,
}

impl<F: Fn(DVec3) -> f64 + Send + Sync> Field for Lipschitz<F> {
    fn value(&self, p: DVec3) -> f64 {
        (self.value)(p)
    }
    fn bound(&self, b: &Aabb) -> Interval {
        Interval::ball(self.value(b.centre()), self.constant * b.radius())
    }
    fn support(&self) -> Aabb {
        self.support
    }
}

impl Field for Ball {
    fn value(&self, p: DVec3) -> f64 {
        (p - self.centre).length() - self.radius
    }
    fn bound(&self, b: &Aabb) -> Interval {
        Interval::ball(self.value(b.centre()), b.radius())
    }
    fn support(&self) -> Aabb {
        Aabb::around(self.centre, DVec3::splat(self.radius))
    }
}

/// Balls added and taken away in turn.
pub struct Csg(pub Vec<Ball>);

impl Csg {
    pub fn random(seed: u64, count: usize, within: f64) -> Self {
        let mut r = Random(seed);
        let mut coordinate = move || r.next() * within;
        Self(
            (0..count)
                .map(|_| ball(coordinate(), coordinate(), coordinate(), coordinate().abs() * 0.5))
                .collect(),
        )
    }
}

impl Field for Csg {
    fn value(&self, p: DVec3) -> f64 {
        let mut f = f64::INFINITY;
        for (n, b) in self.0.iter().enumerate() {
            let v = b.value(p);
            f = if n % 3 < 2 { f.min(v) } else { f.max(-v) };
        }
        f
    }
    fn bound(&self, b: &Aabb) -> Interval {
        let mut f = Interval::point(f64::INFINITY);
        for (n, ball) in self.0.iter().enumerate() {
            let v = ball.bound(b);
            f = if n % 3 < 2 { f.min(v) } else { f.max(-v) };
        }
        f
    }
    fn support(&self) -> Aabb {
        self.0.iter().fold(Aabb::EMPTY, |b, ball| b.hull(ball.support()))
    }
}

/// A ring round the z axis.
pub fn torus(ring: f64, tube: f64) -> impl Field {
    let half = DVec3::new(ring + tube, ring + tube, tube);
    let value = move |p: DVec3| DVec2::new(p.truncate().length() - ring, p.z).length() - tube;
    Lipschitz { value, constant: 1.0, support: Aabb::around(DVec3::ZERO, half) }
}

/// A gyroid of the given wave length, cut out by a ball. Each component of the gyroid's gradient
/// is within [-1, 1] of a unit argument.
pub fn gyroid(wave: f64, radius: f64) -> impl Field {
    let k = std::f64::consts::TAU / wave;
    let value = move |p: DVec3| {
        let (s, c) = ((p * k).map(f64::sin), (p * k).map(f64::cos));
        let g = s.x * c.y + s.y * c.z + s.z * c.x;
        (g / (k * 3.0f64.sqrt())).max(p.length() - radius)
    };
    Lipschitz { value, constant: 1.0, support: Aabb::around(DVec3::ZERO, DVec3::splat(radius)) }
}

/// xorshift64*: numbers in [-1, 1).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11;
        bits as f64 / (1u64 << 52) as f64 - 1.0
    }
}
