use super::shapes::{Ball, Csg, Lipschitz, ball, gyroid, torus};
use super::{Sampling, evaluate, on_border, sample, sample_dense, undecided};
use crate::field::Field;
use crate::grid::{Brick, Lattice};
use crate::job::{Cancelled, Job, Quiet};
use crate::num::{Aabb, Interval};
use glam::DVec3;

fn cube(half: f64, step: f64) -> Lattice {
    Lattice::covering(&Aabb::around(DVec3::splat(0.013), DVec3::splat(half)), step)
}

/// Same sign of every sample, and the same value wherever a value is held.
fn assert_same(sparse: &Sampling, dense: &Sampling) {
    let lattice = dense.bricks.lattice;
    for k in 0..i64::from(lattice.size[2]) {
        for j in 0..i64::from(lattice.size[1]) {
            for i in 0..i64::from(lattice.size[0]) {
                let at = [i, j, k];
                let want = dense.bricks.sample(at, f32::NAN, f32::NAN);
                let got = sparse.bricks.sample(at, f32::NEG_INFINITY, f32::INFINITY);
                assert_eq!(got < 0.0, want < 0.0, "sign at {at:?}");
                assert!(got.is_infinite() || got == want, "value at {at:?}: {got}, {want}");
            }
        }
    }
}

fn compare(f: &dyn Field, lattice: Lattice) -> (Sampling, Sampling) {
    let sparse = sample(f, lattice, &Quiet).unwrap();
    let dense = sample_dense(f, lattice, &Quiet).unwrap();
    assert_same(&sparse, &dense);
    assert_eq!(sparse.stats.border_clipped, dense.stats.border_clipped);
    assert_eq!(dense.stats.active_bricks, dense.stats.bricks);
    (sparse, dense)
}

#[test]
fn sparse_equals_dense() {
    let lattice = cube(20.0, 0.6);
    let shapes: [Box<dyn Field>; 4] = [
        Box::new(ball(1.0, -2.0, 0.5, 14.3)),
        Box::new(torus(13.0, 4.0)),
        Box::new(gyroid(11.0, 19.0)),
        Box::new(ball(0.0, 0.0, 0.0, 0.3)),
    ];
    for f in shapes {
        let (sparse, dense) = compare(&*f, lattice);
        assert!(!sparse.stats.border_clipped);
        assert!(sparse.stats.evaluated < dense.stats.evaluated);
    }
    for seed in 1..12 {
        compare(&Csg::random(seed, 9, 18.0), lattice);
    }
}

/// A surface close to a face between bricks: its crossings need samples of skipped bricks.
#[test]
fn bricks_beside_a_crossing_hold_samples() {
    let lattice = Lattice { origin: DVec3::splat(-8.0), step: 0.5, size: [33; 3] };
    // between samples 7 and 8 of a brick along each axis
    for at in [3.51, 3.7, 3.99, 4.0] {
        let value = move |p: DVec3| (p.abs() - at).max_element();
        let f = Lipschitz {
            value,
            constant: 1.0,
            support: Aabb::around(DVec3::ZERO, DVec3::splat(at)),
        };
        let (sparse, _) = compare(&f, lattice);
        for (n, b) in sparse.bricks.bricks.iter().enumerate() {
            let lo = sparse.bricks.place(n).map(|b| i64::from(8 * b));
            let sign = |at: [i64; 3]| sparse.bricks.sample(at, -1.0, 1.0) < 0.0;
            for c in 0..512 {
                let cell = [lo[0] + c % 8, lo[1] + c / 8 % 8, lo[2] + c / 64];
                let corner = |n: i64| [0, 1, 2].map(|a| cell[a] + (n >> a & 1));
                if cell.iter().any(|&i| i >= 32) || (1..8).all(|n| sign(corner(n)) == sign(cell)) {
                    continue;
                }
                assert!(matches!(b, Brick::Band(_)));
                for n in 0..8 {
                    assert!(sparse.bricks.sample(corner(n), f32::NAN, f32::NAN).is_finite());
                }
            }
        }
    }
}

/// A shape larger than the lattice is closed at the border, from skipped bricks too.
#[test]
fn the_border_is_outside() {
    for size in [[32; 3], [33; 3], [34, 41, 40], [9, 2, 17]] {
        let lattice = Lattice { origin: DVec3::splat(-5.0), step: 0.4, size };
        for radius in [40.0, 8.0, 4.0] {
            let (sparse, dense) = compare(&ball(0.3, -1.0, 0.2, radius), lattice);
            assert_eq!(sparse.stats.border_clipped, radius > 4.0);
            for n in 0..dense.bricks.bricks.len() {
                let lo = dense.bricks.place(n).map(|b| b * 8);
                if on_border(&lattice, lo) {
                    let v = dense.bricks.sample(lo.map(i64::from), -1.0, -1.0);
                    assert!(v > 0.0);
                }
            }
        }
    }
}

struct Opaque(Ball);
impl Field for Opaque {
    fn value(&self, p: DVec3) -> f64 {
        self.0.value(p)
    }
    fn bound(&self, _: &Aabb) -> Interval {
        Interval::ALL
    }
    fn support(&self) -> Aabb {
        self.0.support()
    }
}

/// A field that knows no bound is evaluated within its support.
#[test]
fn no_bound_means_everything() {
    let inner = Opaque(ball(0.0, 0.0, 0.0, 5.0));
    let (sparse, dense) = compare(&inner, cube(12.0, 0.5));
    assert!(sparse.stats.active_bricks >= 27);
    assert!(sparse.stats.active_bricks < dense.stats.active_bricks);
}

#[test]
fn odd_values_become_finite_samples() {
    let f = Lipschitz {
        value: |p: DVec3| match p.x {
            x if x < 0.0 => f64::NAN,
            x if x < 2.0 => f64::NEG_INFINITY,
            _ => f64::INFINITY,
        },
        constant: f64::INFINITY,
        support: Aabb::ALL,
    };
    let lattice = cube(4.0, 1.0);
    let (samples, _) = evaluate(&f, &lattice, [0; 3], &[None; 8], None);
    assert!(samples.iter().all(|v| v.is_finite()));
    assert!(samples.iter().any(|&v| v < 0.0) && samples.iter().any(|&v| v > 0.0));
}

#[test]
fn an_empty_lattice_has_no_samples() {
    for size in [[0, 0, 0], [0, 4, 4], [1, 1, 1]] {
        let lattice = Lattice { origin: DVec3::ZERO, step: 1.0, size };
        compare(&ball(0.0, 0.0, 0.0, 3.0), lattice);
    }
}

/// Samples of a ball too small for the lattice show nothing; the subdivision finds it.
#[test]
fn undecided_finds_a_ball_between_samples() {
    let lattice = Lattice { origin: DVec3::splat(-8.0), step: 1.0, size: [17; 3] };
    let big = ball(0.1, 0.2, 0.3, 4.0);
    let small = ball(6.45, 6.5, 6.55, 0.2);
    let both = Csg(vec![big, small]);
    let s = sample(&both, lattice, &Quiet).unwrap();
    let shown = sample(&big, lattice, &Quiet).unwrap();
    for k in 0..17 {
        for j in 0..17 {
            let row =
                |s: &Sampling| [0; 17].map(|_: i32| s.bricks.sample([6, j, k], -1.0, 1.0) < 0.0);
            assert_eq!(row(&s), row(&shown));
        }
    }
    let counted = undecided(&both, &s, 0, &Quiet).unwrap();
    assert!(counted.undecided > 0 && counted.left == counted.undecided);
    assert!(
        super::undecided_at_most(&s) >= counted.undecided
            && super::undecided_at_most(&s) <= s.stats.evaluated
    );
    let u = undecided(&both, &s, 6, &Quiet).unwrap();
    assert_eq!((u.undecided, u.missed), (counted.undecided, 1));
    assert_eq!(u.undecided, u.decided + u.missed + u.left);
    assert!(small.value(u.example.unwrap()) < 0.0);
    let u = undecided(&big, &shown, 6, &Quiet).unwrap();
    assert_eq!((u.missed, u.left), (0, 0));
}

struct Stop;
impl Job for Stop {
    fn cancelled(&self) -> bool {
        true
    }
}

#[test]
fn a_cancelled_job_stops() {
    let (f, lattice) = (ball(0.0, 0.0, 0.0, 5.0), cube(8.0, 0.5));
    assert_eq!(sample(&f, lattice, &Stop), Err(Cancelled));
    let s = sample(&f, lattice, &Quiet).unwrap();
    assert_eq!(undecided(&f, &s, 1, &Stop), Err(Cancelled));
}
