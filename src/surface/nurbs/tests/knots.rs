use super::*;
use crate::surface::nurbs::{SAME_KNOT, compatible_curves, compatible_surfaces};

#[test]
fn insertion_leaves_curve_and_surface_alone() {
    let mut dice = Dice(11);
    for degree in 1..=6 {
        let line = curve(&mut dice, degree, degree + 7, [2.0, 5.0]);
        let mut more: Vec<f64> = (0..9).map(|_| 2.0 + 3.0 * dice.roll()).collect();
        more.push(more[0] + 6e-7);
        let fine = line.refined(&more).unwrap();
        assert_eq!(fine.points().len(), line.points().len() + 10);
        let error = curves_apart(&line, &fine, 300);
        assert!(error < 1e-13, "degree {degree}: {error}");
    }
    let patch = surface(&mut dice, [3, 2], [12, 9]);
    let fine = patch.refined(&[0.1, 0.5, 0.5, 0.77], &[-0.5, 0.0, 1.9]).unwrap();
    assert_eq!((fine.net().len(), fine.net()[0].len()), (12, 16));
    assert!(apart(&patch, &fine, 60) < 1e-13);
}

#[test]
fn elevation_leaves_the_shape_alone_and_adds_the_least_knots() {
    let mut dice = Dice(12);
    for degree in 1..=6 {
        let line = curve(&mut dice, degree, degree + 8, [0.0, 4.0]);
        for higher in degree..degree + 4 {
            let raised = line.elevated(higher).unwrap();
            let least = line.knots().distinct().len() * (higher - degree);
            assert_eq!(raised.knots().values().len(), line.knots().values().len() + least);
            let error = curves_apart(&line, &raised, 300);
            assert!(error < 1e-13, "degree {degree} to {higher}: {error}");
        }
    }
}

#[test]
fn a_bicubic_net_of_12_by_9_becomes_21_by_15() {
    let mut dice = Dice(13);
    // Simple inner knots: 8 and 5 of them, so 9 and 6 pieces, each of which asks for one more.
    let even = |n: usize| -> Vec<f64> {
        let ends = |t: f64| std::iter::repeat_n(t, 3);
        ends(0.0).chain((0..=n - 3).map(|i| i as f64)).chain(ends((n - 3) as f64)).collect()
    };
    let net: Vec<Vec<_>> = (0..9).map(|_| (0..12).map(|_| point(&mut dice)).collect()).collect();
    let patch = RationalSurface::new([3, 3], even(12), even(9), &net).unwrap();
    let raised = patch.elevated([4, 4]).unwrap();
    assert_eq!((raised.net()[0].len(), raised.net().len()), (21, 15));
    assert!(apart(&patch, &raised, 80) < 1e-13);
}

#[test]
fn elevation_of_a_line_stays_a_line() {
    let line = RationalCurve::new(1, vec![0., 0., 1., 1.], &[[0., 0., 0., 1.], [6., 0., 0., 1.]]);
    let cubic = line.unwrap().elevated(3).unwrap();
    let x: Vec<f64> = cubic.points().iter().map(|p| p[0]).collect();
    assert!(x.iter().zip([0., 2., 4., 6.]).all(|(a, b)| (a - b).abs() < 1e-15), "{x:?}");
}

#[test]
fn knots_very_close_together_do_no_harm() {
    let mut dice = Dice(14);
    let values = vec![0., 0., 0., 0., 0.5, 0.5 + 5e-7, 0.5 + 1e-6, 1., 1., 1., 1.];
    let points: Vec<_> = (0..7).map(|_| point(&mut dice)).collect();
    let line = RationalCurve::new(3, values, &points).unwrap();
    let raised = line.elevated(5).unwrap();
    let fine = line.refined(&[0.5, 0.5 + 2e-7, 0.25]).unwrap();
    assert!(curves_apart(&line, &raised, 500) < 1e-13);
    assert!(curves_apart(&line, &fine, 500) < 1e-13);
}

#[test]
fn uniform_knots_are_clamped_to_the_same_curve() {
    // A closed uniform quadratic: the last two points are the first two; its domain is [2, 6].
    let at = |x: f64, y: f64| [x, y, 0.0, 1.0];
    let points = [at(1., 1.), at(-1., 1.), at(-1., -1.), at(1., -1.), at(1., 1.), at(-1., 1.)];
    let line = RationalCurve::new(2, (0..9).map(f64::from).collect(), &points).unwrap();
    assert_eq!(line.domain(), [2.0, 6.0]);
    assert!(line.closed());
    // A uniform quadratic meets the middle of each side of its polygon at the knots.
    let corners = [[0., 1.], [-1., 0.], [0., -1.], [1., 0.], [0., 1.]];
    for (u, [x, y]) in (2..=6).map(f64::from).zip(corners) {
        assert!(line.point(u).distance(DVec3::new(x, y, 0.0)) < 1e-15);
    }
    assert_eq!(line.knots().values()[..3], [2.0; 3]);
}

#[test]
fn targets_meet_on_the_union_of_their_knots() {
    let mut dice = Dice(15);
    let points = |dice: &mut Dice, n| (0..n).map(|_| point(dice)).collect::<Vec<_>>();
    let a =
        RationalCurve::new(2, vec![0., 0., 0., 0.25, 0.5, 0.5, 1., 1., 1.], &points(&mut dice, 6));
    // Ten times as long, one knot the same but for rounding, at degree 3.
    let close = 12.5 + 0.3 * SAME_KNOT;
    let b = RationalCurve::new(
        3,
        vec![10., 10., 10., 10., close, 17., 20., 20., 20., 20.],
        &points(&mut dice, 6),
    );
    let (a, b) = (a.unwrap(), b.unwrap());
    let met = compatible_curves(&[a.clone(), b.clone()]).unwrap();
    assert_eq!(met[0].knots(), met[1].knots());
    let distinct = met[0].knots().distinct();
    let expect = [(0.0, 4), (0.25, 2), (0.5, 3), (0.7, 1), (1.0, 4)];
    assert_eq!(distinct.len(), 5, "{distinct:?}");
    for (got, want) in distinct.iter().zip(expect) {
        assert!((got.0 - want.0).abs() < 1e-15 && got.1 == want.1, "{distinct:?}");
    }
    assert!(curves_apart(&a, &met[0], 200) < 1e-13);
    // The moved knot moves the curve by about as much, no more.
    assert!(curves_apart(&b, &met[1], 200) < 1e-8);
}

#[test]
fn three_surfaces_meet() {
    let mut dice = Dice(16);
    let all = [
        surface(&mut dice, [1, 3], [4, 7]),
        surface(&mut dice, [3, 2], [9, 5]),
        surface(&mut dice, [2, 1], [6, 3]),
    ];
    let met = compatible_surfaces(&all).unwrap();
    for (a, b) in all.iter().zip(&met) {
        assert_eq!(b.knots(), met[0].knots());
        assert!(apart(a, b, 50) < 1e-13);
    }
    assert_eq!(met[0].knots().each_ref().map(|k| k.degree()), [3, 3]);
}
