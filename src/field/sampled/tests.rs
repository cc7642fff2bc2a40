use super::*;
use crate::job::Quiet;
use std::sync::Arc;

#[derive(Clone, Copy)]
struct Ball(DVec3, f64);

impl Field for Ball {
    fn value(&self, p: DVec3) -> f64 {
        (p - self.0).length() - self.1
    }
    fn bound(&self, b: &Aabb) -> Interval {
        Interval::ball(self.value(b.centre()), b.radius())
    }
    fn support(&self) -> Aabb {
        Aabb::around(self.0, DVec3::splat(self.1))
    }
}

fn points(n: u64, reach: f64) -> impl Iterator<Item = DVec3> {
    let mut x = 0x9e37_79b9_7f4a_7c15_u64;
    let mut next = move || {
        x ^= x << 13;
        x ^= x >> 7;
        x ^= x << 17;
        (x >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
    };
    (0..n).map(move |_| DVec3::new(next(), next(), next()) * reach)
}

#[test]
fn error_is_within_the_stated_bound_and_falls_with_the_step() {
    let ball = Ball(DVec3::new(3.0, -2.0, 1.0), 40.0);
    let mut last = f64::INFINITY;
    for step in [4.0, 2.0, 1.0] {
        let s = Sampled::new(Arc::new(ball), step, &Quiet).unwrap();
        let mut near = 0.0f64;
        for p in points(20_000, 60.0) {
            let (got, want) = (s.value(p), ball.value(p));
            let leaf = step.max(want.abs() / 4.0 + step);
            assert!((got - want).abs() <= 3f64.sqrt() / 2.0 * leaf, "{p}: {got} {want}");
            if want.abs() < step {
                near = near.max((got - want).abs());
            }
        }
        // trilinear error step²/8 a principal curvature, three axes
        assert!(near <= 3.0 * step * step / (8.0 * 35.0), "{step}: {near}");
        assert!(near < last);
        last = near;
    }
}

#[test]
fn continuous_across_levels() {
    let ball = Ball(DVec3::ZERO, 80.0);
    let s = Sampled::new(Arc::new(ball), 0.5, &Quiet).unwrap();
    assert!(s.leaves.iter().any(|l| l.level > 1), "the test needs several levels");
    for p in points(20_000, 90.0) {
        // the steepest a trilinear form of a distance can be is √3, and twice 1e-6 of way
        let e = DVec3::new(1e-6, -1e-6, 1e-6);
        assert!((s.value(p + e) - s.value(p - e)).abs() < 1e-5, "jump at {p}");
    }
    // across every plane on which leaves may end
    for p in points(5_000, 90.0) {
        let mut q = (p - s.grid.origin) * s.inverse;
        q.x = (q.x / 8.0).round() * 8.0;
        let q = q * s.step() + s.grid.origin;
        let e = DVec3::X * 1e-7;
        assert!((s.value(q + e) - s.value(q - e)).abs() < 1e-5, "jump at {q}");
    }
}

#[test]
fn bound_holds() {
    let ball = Ball(DVec3::new(1.0, 2.0, 3.0), 25.0);
    let s = Sampled::new(Arc::new(ball), 1.5, &Quiet).unwrap();
    let mut at = points(60_000, 1.0);
    for c in points(600, 70.0) {
        let half = at.next().unwrap().abs() * 30.0 * at.next().unwrap().x.abs();
        let b = Aabb::around(c, half);
        let f = s.bound(&b);
        for _ in 0..60 {
            let p = c + at.next().unwrap() * half;
            assert!(f.contains(s.value(p)), "{b:?}: {} not in {f:?}", s.value(p));
        }
    }
}

#[test]
fn volume_of_a_ball() {
    let s = Sampled::new(Arc::new(Ball(DVec3::ZERO, 30.0)), 1.0, &Quiet).unwrap();
    let want = 4.0 / 3.0 * std::f64::consts::PI * 27_000.0;
    assert!((s.volume() / want - 1.0).abs() < 0.003, "{} against {want}", s.volume());
}
