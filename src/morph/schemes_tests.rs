//! Known answers of the methods that do not blend.

use super::*;
use crate::field::Field;
use crate::job::Quiet;
use crate::num::Interval;
use crate::weight::Ease;
use glam::DVec3;
use std::f64::consts::PI;
use std::sync::atomic::{AtomicU32, Ordering};

/// Balls, united.
struct Balls(Vec<(DVec3, f64)>);

impl Field for Balls {
    fn value(&self, p: DVec3) -> f64 {
        self.0.iter().map(|(c, r)| p.distance(*c) - r).fold(f64::INFINITY, f64::min)
    }
    fn bound(&self, b: &Aabb) -> Interval {
        Interval::ball(self.value(b.centre()), b.radius())
    }
    fn support(&self) -> Aabb {
        self.0.iter().fold(Aabb::EMPTY, |b, (c, r)| b.hull(Aabb::around(*c, DVec3::splat(*r))))
    }
}

fn balls(name: &str, all: &[([f64; 3], f64)]) -> Part {
    let all = all.iter().map(|&(c, r)| (DVec3::from_array(c), r)).collect();
    Part { name: name.to_owned(), field: Arc::new(Balls(all)) }
}

fn morph(shapes: Vec<Part>, scheme: Scheme) -> Result<Box<dyn Morph>, MorphError> {
    build(Plan { scheme, ..Plan::whole(shapes, Inner::Linear) })
}

/// How far the surface is from `from` along a direction, by bisection; inside at `from`.
fn reach(f: &Shared, from: DVec3, way: DVec3, most: f64) -> f64 {
    let (mut low, mut high) = (0.0, most);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if f.value(from + way * middle) < 0.0 { low = middle } else { high = middle }
    }
    low
}

fn ways() -> Vec<DVec3> {
    let all = [[1, 0, 0], [0, -1, 0], [0, 0, 1], [1, 1, 0], [-1, 0, 1], [1, -1, 1], [-2, 1, 3]];
    all.iter().map(|w| DVec3::from_array(w.map(f64::from)).normalize()).collect()
}

#[test]
fn a_level_set_between_concentric_balls_changes_equal_volumes_in_equal_times() {
    for (a, b) in [(10.0f64, 20.0f64), (20.0, 10.0)] {
        let shapes = vec![balls("a", &[([0.0; 3], a)]), balls("b", &[([0.0; 3], b)])];
        let step = 0.8;
        let m = morph(shapes, Scheme::LevelSet { step }).unwrap();
        for t in [0.0, 0.2, 0.5, 0.9, 1.0] {
            let f = m.at(t, &Quiet).unwrap();
            let want = (a.powi(3) + t * (b.powi(3) - a.powi(3))).cbrt();
            for way in ways() {
                let got = reach(&f, DVec3::ZERO, way, 30.0);
                assert!((got - want).abs() < step, "{a} to {b} at {t}: {got}, expected {want}");
            }
        }
        assert!(m.notes().is_empty());
    }
}

#[test]
fn a_level_set_keeps_what_both_have_and_adds_nothing_else() {
    let s = balls("s", &[([0.0; 3], 10.0)]);
    let t = balls("t", &[([8.0, 3.0, 0.0], 9.0)]);
    let (a, b) = (s.field.clone(), t.field.clone());
    let m = morph(vec![s, t], Scheme::LevelSet { step: 0.7 }).unwrap();
    let mut before: Vec<bool> = Vec::new();
    for time in [0.1, 0.3, 0.5, 0.7, 0.95] {
        let f = m.at(time, &Quiet).unwrap();
        let mut now = Vec::new();
        for i in 0..20 {
            for j in 0..20 {
                let p = DVec3::new(f64::from(i) * 1.6 - 12.0, f64::from(j) * 1.4 - 12.0, 0.9);
                let (va, vb, v) = (a.value(p), b.value(p), f.value(p));
                // a sample apart from either surface
                if va.abs().min(vb.abs()) > 1.3 && (va < 0.0) == (vb < 0.0) {
                    assert_eq!(v < 0.0, va < 0.0, "{p} at {time}");
                }
                now.push((v < 0.0) == (vb < 0.0));
            }
        }
        // what has become as the target stays so
        let lost = before.iter().zip(&now).filter(|(b, n)| **b && !**n).count();
        assert_eq!(lost, 0, "at {time}");
        before = now;
    }
}

#[test]
fn a_level_set_says_what_it_cannot_reach() {
    let s = balls("s", &[([0.0; 3], 10.0)]);
    let t = balls("t", &[([3.0, 0.0, 0.0], 10.0), ([40.0, 0.0, 0.0], 10.0)]);
    let m = morph(vec![s, t], Scheme::LevelSet { step: 1.0 }).unwrap();
    let f = m.at(1.0, &Quiet).unwrap();
    assert!(f.value(DVec3::new(3.0, 0.0, 0.0)) < 0.0 && f.value(DVec3::new(40.0, 0.0, 0.0)) > 0.0);
    let reached = reach(&f, DVec3::new(3.0, 0.0, 0.0), DVec3::Y, 20.0);
    assert!((reached - 10.0).abs() < 1.0, "{reached}");
    assert!(m.notes()[0].contains("50.0% of `t` does not touch"), "{:?}", m.notes());
    let far = vec![balls("s", &[([0.0; 3], 10.0)]), balls("t", &[([30.0, 0.0, 0.0], 10.0)])];
    let e = morph(far, Scheme::LevelSet { step: 1.0 }).err().unwrap().to_string();
    assert!(
        e.starts_with("the shapes do not overlap: no point lies inside both `s` and `t`"),
        "{e}"
    );
    let three = (0..3).map(|_| balls("b", &[([0.0; 3], 10.0)])).collect();
    let e = morph(three, Scheme::LevelSet { step: 1.0 }).err().unwrap().to_string();
    assert!(e.contains("takes two shapes, got 3"), "{e}");
}

#[test]
fn transport_moves_a_ball_along_and_keeps_its_volume() {
    let (to, r) = (DVec3::new(24.0, 6.0, -5.0), 8.0);
    let shapes = vec![balls("a", &[([0.0; 3], r)]), balls("b", &[(to.to_array(), r)])];
    let m = morph(shapes, Scheme::Transport { samples: 32 }).unwrap();
    for t in [0.25, 0.5] {
        let f = m.at(t, &Quiet).unwrap();
        let (mut count, mut sum) = (0.0, DVec3::ZERO);
        let n = 48;
        for i in 0..n * n * n {
            let q = DVec3::new(f64::from(i % n), f64::from(i / n % n), f64::from(i / (n * n)));
            let p = DVec3::new(-12.0, -12.0, -18.0) + q;
            if f.value(p) < 0.0 {
                (count, sum) = (count + 1.0, sum + p);
            }
        }
        let volume = 4.0 / 3.0 * PI * r.powi(3);
        assert!((count / volume - 1.0f64).abs() < 0.05, "at {t}: volume {}", count / volume);
        assert!((sum / count).distance(to * t) < 0.25, "at {t}: centre {}", sum / count);
        let radii = ways().into_iter().map(|w| reach(&f, to * t, w, 20.0));
        for radius in radii {
            assert!((radius - r).abs() < 1.3, "at {t}: {radius}");
        }
    }
    assert!(m.notes()[0].contains("lattice of"));
}

/// The last Gaussian reaches 30 samples; these are far farther apart, and the widest first one is
/// needed too.
#[test]
fn transport_reaches_shapes_that_are_far_apart() {
    for (far, samples) in [(90.0, 96), (400.0, 200)] {
        let (to, r) = (DVec3::new(far, 0.0, 3.0), 8.0);
        let shapes = vec![balls("a", &[([0.0; 3], r)]), balls("b", &[(to.to_array(), r)])];
        let m = morph(shapes, Scheme::Transport { samples }).unwrap();
        for t in [0.5, 0.8] {
            let f = m.at(t, &Quiet).unwrap();
            let (mut count, mut sum) = (0.0, DVec3::ZERO);
            let n = DVec3::new(far + 40.0, 41.0, 41.0).as_ivec3();
            for i in 0..n.x * n.y * n.z {
                let q = glam::IVec3::new(i % n.x, i / n.x % n.y, i / (n.x * n.y));
                let p = q.as_dvec3() - DVec3::new(20.0, 20.0, 18.0);
                if f.value(p) < 0.0 {
                    (count, sum) = (count + 1.0, sum + p);
                }
            }
            let volume = 4.0 / 3.0 * PI * r.powi(3);
            assert!((count / volume - 1.0f64).abs() < 0.2, "{far}, {t}: {}", count / volume);
            // a sample is some 2 mm
            assert!((sum / count).distance(to * t) < 1.0, "{far}, {t}: centre {}", sum / count);
        }
        let notes = m.notes();
        assert!(notes.len() == 2 && notes[1].contains("so far apart"), "{notes:?}");
    }
}

#[test]
fn transport_needs_something_to_move() {
    struct Sheet;
    impl Field for Sheet {
        fn value(&self, p: DVec3) -> f64 {
            p.length() + 0.001
        }
        fn bound(&self, b: &Aabb) -> Interval {
            Interval::ball(self.value(b.centre()), b.radius())
        }
        fn support(&self) -> Aabb {
            Aabb::around(DVec3::ZERO, DVec3::splat(5.0))
        }
    }
    let sheet = Part { name: "sheet".to_owned(), field: Arc::new(Sheet) };
    let shapes = vec![balls("a", &[([0.0; 3], 8.0)]), sheet];
    let e = morph(shapes, Scheme::Transport { samples: 32 }).err().unwrap().to_string();
    assert!(e.starts_with("`sheet` has no volume to move"), "{e}");
}

#[test]
fn a_warp_of_a_moved_shape_moves_it() {
    let way = DVec3::new(30.0, -10.0, 5.0);
    let shapes = vec![
        balls("a", &[([0.0; 3], 10.0), ([12.0, 0.0, 0.0], 5.0)]),
        balls("b", &[(way.to_array(), 10.0), ((way + DVec3::X * 12.0).to_array(), 5.0)]),
    ];
    let a = shapes[0].field.clone();
    let at = [[0, 0, 0], [9, 1, 0], [2, 8, 1], [1, 2, 7], [5, 5, 5]];
    let anchors = at
        .iter()
        .map(|p| DVec3::from_array(p.map(f64::from)))
        .map(|p| Anchor { name: "p".to_owned(), at: vec![p, p + way] })
        .collect();
    let m = morph(shapes, Scheme::Warp { anchors }).unwrap();
    for t in [0.0, 0.3, 1.0] {
        let f = m.at(t, &Quiet).unwrap();
        for w in ways() {
            let p = w * 17.0;
            assert!((f.value(p + way * t) - a.value(p)).abs() < 1e-9, "{p} at {t}");
        }
    }
}

/// Asks to stop at the n-th question.
struct StopAt(AtomicU32);

impl Job for StopAt {
    fn cancelled(&self) -> bool {
        self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |n| n.checked_sub(1)).is_err()
    }
}

#[test]
fn methods_stop_when_told() {
    for scheme in [Scheme::LevelSet { step: 1.0 }, Scheme::Transport { samples: 16 }] {
        let shapes = vec![balls("a", &[([0.0; 3], 10.0)]), balls("b", &[([5.0, 0.0, 0.0], 9.0)])];
        let m = morph(shapes, scheme.clone()).unwrap();
        for n in [0, 5, 12] {
            let job = StopAt(AtomicU32::new(n));
            assert!(m.at(0.5, &job).is_err(), "{scheme:?} {n}");
        }
        assert!(m.at(0.5, &Quiet).is_ok());
    }
}

#[test]
fn a_course_eases_the_clock() {
    let shapes = || vec![balls("a", &[([0.0; 3], 10.0)]), balls("b", &[([0.0; 3], 20.0)])];
    let scheme = Scheme::LevelSet { step: 1.0 };
    let plain = morph(shapes(), scheme.clone()).unwrap().at(0.25, &Quiet).unwrap();
    let course = Course::Pair(Ease::Power(2.0));
    let eased = Plan { scheme, course, ..Plan::whole(shapes(), Inner::Linear) };
    let eased = build(eased).unwrap().at(0.5, &Quiet).unwrap();
    let p = DVec3::new(14.0, 3.0, 1.0);
    assert_eq!(plain.value(p), eased.value(p));
}
