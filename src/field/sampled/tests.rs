use super::*;
use crate::job::Quiet;
use rayon::prelude::*;
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

/// Two balls with a gap, so that leaves of all levels meet; as heavy as told.
#[derive(Clone, Copy)]
struct Balls(usize);

impl Balls {
    const EACH: [Ball; 2] =
        [Ball(DVec3::new(-30.0, 1.0, 2.0), 22.0), Ball(DVec3::new(35.0, 4.0, -3.0), 9.5)];
}

impl Field for Balls {
    fn value(&self, p: DVec3) -> f64 {
        Self::EACH.iter().map(|b| b.value(p)).fold(f64::INFINITY, f64::min)
    }
    fn bound(&self, b: &Aabb) -> Interval {
        Self::EACH[0].bound(b).min(Self::EACH[1].bound(b))
    }
    fn support(&self) -> Aabb {
        Self::EACH[0].support().hull(Self::EACH[1].support())
    }
    fn bytes(&self) -> usize {
        self.0
    }
}

#[test]
fn on_demand_the_samples_are_the_same_to_the_bit() {
    let all = Sampled::new(Arc::new(Balls(0)), 0.7, &Quiet).unwrap();
    let some = Sampled::on_demand(Arc::new(Balls(0)), 0.7, &Quiet).unwrap();
    assert_eq!(all.bytes().1, 0);
    let (made, left) = some.bytes();
    assert!(left > made, "{made} bytes of {} are made", made + left);
    assert_eq!(all.volume(), some.volume());
    let at: Vec<DVec3> = points(30_000, 70.0).collect();
    let same = |p: &DVec3| all.value(*p).to_bits() == some.value(*p).to_bits();
    // in any order, by any thread
    assert!(at.par_iter().rev().all(same));
    assert!(some.bytes().1 < left);
}

#[test]
fn bounds_on_demand_hold_and_do_not_depend_on_what_was_asked() {
    let s = Sampled::on_demand(Arc::new(Balls(0)), 1.1, &Quiet).unwrap();
    let mut half = points(500, 12.0);
    let boxes: Vec<Aabb> =
        points(500, 75.0).map(|c| Aabb::around(c, half.next().unwrap().abs())).collect();
    let left = s.bytes().1;
    let before: Vec<Interval> = boxes.iter().map(|b| s.bound(b)).collect();
    assert_eq!(s.bytes().1, left, "bounds made leaves");
    let unit: Vec<DVec3> = points(40, 1.0).collect();
    for (b, f) in boxes.iter().zip(&before) {
        for u in &unit {
            let p = b.centre() + *u * b.size() * 0.5;
            assert!(f.contains(s.value(p)), "{b:?}: {} not in {f:?}", s.value(p));
        }
    }
    assert!(s.bytes().1 < left, "values made no leaves");
    assert!(boxes.iter().zip(before).all(|(b, f)| s.bound(b) == f));
}

#[test]
fn a_heavy_field_is_sampled_at_once() {
    let s = Sampled::on_demand(Arc::new(Balls(usize::MAX)), 2.0, &Quiet).unwrap();
    assert!(s.bytes().1 == 0 && s.field.is_none());
}

#[test]
fn volume_of_a_ball() {
    let s = Sampled::new(Arc::new(Ball(DVec3::ZERO, 30.0)), 1.0, &Quiet).unwrap();
    let want = 4.0 / 3.0 * std::f64::consts::PI * 27_000.0;
    assert!((s.volume() / want - 1.0).abs() < 0.003, "{} against {want}", s.volume());
}
