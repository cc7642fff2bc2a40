use super::*;
use crate::surface::nurbs::knots::Knots;
use crate::surface::nurbs::{circle, revolve};

#[test]
fn basis_functions_sum_to_one_and_their_derivatives_to_zero() {
    let mut dice = Dice(1);
    for degree in 1..=7 {
        let n = degree + 6;
        let values = super::knots(&mut dice, degree, n, [-2.0, 3.0]);
        let knots = Knots::new(degree, values, n, "knots").unwrap();
        for u in spread([-2.0, 3.0], 97) {
            let basis = knots.basis::<3>(knots.span(u), u);
            let [value, slope, bend] = basis.rows.map(|r| r.iter().sum::<f64>());
            let size = |k: usize| basis.rows[k].iter().fold(1.0, |m: f64, f| m.max(f.abs()));
            assert!((value - 1.0).abs() < 1e-14, "degree {degree}, u {u}: {value}");
            assert!(slope.abs() < 1e-14 * size(1), "degree {degree}, u {u}: {slope}");
            assert!(bend.abs() < 1e-14 * size(2), "degree {degree}, u {u}: {bend}");
            assert!(basis.rows[0].iter().all(|f| *f >= 0.0));
        }
    }
}

#[test]
fn a_bezier_cubic_is_bernsteins() {
    let points = [[0., 0., 0., 1.], [1., 2., 0., 1.], [3., 2., 1., 1.], [4., 0., 0., 1.]];
    let ends = vec![0., 0., 0., 0., 1., 1., 1., 1.];
    let curve = RationalCurve::new(3, ends, &points).unwrap();
    // At 1/2: (p0 + 3 p1 + 3 p2 + p3) / 8, 3/4 (p3 + p2 - p1 - p0), 3 (p3 - p2 - p1 + p0).
    let jet = curve.at(0.5);
    assert_eq!(jet.c, DVec3::new(2.0, 1.5, 0.375));
    assert_eq!(jet.d1, DVec3::new(4.5, 0.0, 0.75));
    assert_eq!(jet.d2, DVec3::new(0.0, -12.0, -3.0));
}

#[test]
fn circle_and_sphere_are_exact() {
    let ring = circle(30.0).unwrap();
    assert!(ring.closed());
    for u in spread([0.0, 1.0], 400) {
        let jet = ring.at(u);
        assert!((jet.c.length() / 30.0 - 1.0).abs() < 1e-14, "{}", jet.c.length());
        assert!(jet.c.dot(jet.d1).abs() < 1e-11 && jet.c.z == 0.0);
    }
    // Half a circle from the north pole to the south, round the axis.
    let s = 0.5f64.sqrt();
    let half =
        [[0., 0., 1., 1.], [1., 0., 1., s], [1., 0., 0., 1.], [1., 0., -1., s], [0., 0., -1., 1.]];
    let arc = RationalCurve::new(2, vec![0., 0., 0., 1., 1., 2., 2., 2.], &half).unwrap();
    let ball = revolve(&arc).unwrap();
    assert_eq!(ball.domain(0).wraps, [false, true]);
    for u in spread([0.0, 2.0], 40) {
        for v in spread([0.0, 1.0], 40) {
            let jet = ball.jet(0, [u, v].into());
            assert!((jet.s.length() - 1.0).abs() < 1e-14);
            // Down the profile and counter-clockwise: the normal looks out.
            assert!(jet.su.cross(jet.sv).dot(jet.s) >= -1e-13);
        }
    }
}

#[test]
fn derivatives_are_those_of_the_points() {
    let mut dice = Dice(7);
    for degree in [[1, 1], [2, 3], [3, 2], [5, 4]] {
        let patch = surface(&mut dice, degree, [9, 8]);
        let error = slope_error(&patch, 0, 11);
        assert!(error < 2e-6, "{degree:?}: {error}");
    }
    let line = curve(&mut dice, 4, 11, [0.0, 1.0]);
    let h = 1e-5;
    for u in spread([0.01, 0.99], 60) {
        // The second derivative of a quartic jumps at a double knot: stay on one piece.
        if line.breaks().iter().any(|b| (b - u).abs() < 2.0 * h) {
            continue;
        }
        let [a, b, c] = [u - h, u, u + h].map(|u| line.at(u));
        assert!(((c.c - a.c) / (2.0 * h)).distance(b.d1) < 1e-6 * (1.0 + b.d1.length()));
        assert!(((c.d1 - a.d1) / (2.0 * h)).distance(b.d2) < 1e-5 * (1.0 + b.d2.length()));
    }
}
