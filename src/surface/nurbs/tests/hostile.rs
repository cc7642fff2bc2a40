//! Bad input is refused at its place, and no input panics.

use super::*;
use crate::surface::nurbs::{
    Averaging, CurveMorph, Design, MorphOptions, NurbsMorph, compatible_surfaces,
};
use crate::surface::{Motion, SurfaceError};

const ENDS: [f64; 4] = [0.0, 0.0, 1.0, 1.0];

fn flat() -> RationalSurface {
    let at = |x: f64, y: f64| [x, y, 0.0, 1.0];
    let net = [vec![at(0., 0.), at(1., 0.)], vec![at(0., 1.), at(1., 1.)]];
    RationalSurface::new([1, 1], ENDS.to_vec(), ENDS.to_vec(), &net).unwrap()
}

fn says<T>(result: Result<T, SurfaceError>, what: &str) {
    assert_eq!(result.err().map(|e| e.to_string()).as_deref(), Some(what));
}

#[test]
fn wrong_knots_are_named() {
    let line = |degree, knots: &[f64], n: usize| {
        RationalCurve::new(degree, knots.to_vec(), &vec![[0.0, 0.0, 0.0, 1.0]; n])
    };
    let seven = [0., 0., 0., 0.5, 1., 1., 1.];
    says(line(3, &seven, 5), "knots_u: knot vector has 7 knots; degree 3 with 5 points needs 9");
    says(line(2, &seven, 2), "net: degree 2 needs 3 points or more; got 2");
    says(line(0, &seven, 5), "degree: degree is 0; expected 1 to 24");
    says(line(25, &seven, 5), "degree: degree is 25; expected 1 to 24");
    says(
        line(usize::MAX, &seven, 5),
        &format!("degree: degree is {}; expected 1 to 24", usize::MAX),
    );
    let with = |i: usize, t: f64| {
        let mut knots = seven;
        knots[i] = t;
        line(2, &knots, 4)
    };
    says(with(3, f64::NAN), "knots_u[3]: knot is NaN");
    says(with(3, -1.0), "knots_u[3]: knot -1 after 0; knots never fall");
    says(
        line(2, &[0., 0., 0., 0.5, 0.5, 0.5, 1., 1., 1.], 6),
        "knots_u: knot 0.5 is repeated 3 times; degree 2 allows 2",
    );
    says(
        line(2, &[1.0; 7], 4),
        "knots_u: knots run from 1 to 1; expected a length of 1e-12 to 1e12",
    );
    says(
        line(2, &[0., 0., 0., 0.5, 0.5 + 1e-12, 1., 1., 1.], 5),
        "knots_u: knots 0.5 and 0.500000000001 differ by less than 1e-9 of the domain; make them equal",
    );
}

#[test]
fn wrong_nets_are_named() {
    let make =
        |rows: &[Vec<[f64; 4]>]| RationalSurface::new([1, 1], ENDS.to_vec(), ENDS.to_vec(), rows);
    let ok = [0.0, 0.0, 0.0, 1.0];
    says(make(&[vec![ok, ok], vec![ok]]), "net[1]: row has 1 control points; the first has 2");
    says(
        make(&[vec![ok, ok], vec![ok, [0., 0., 0., -2.]]]),
        "net[1][1]: weight is -2; weights are masses, expected a positive number",
    );
    says(
        make(&[vec![ok, [0., f64::INFINITY, 0., 1.]], vec![ok, ok]]),
        "net[0][1]: coordinate is inf",
    );
    says(make(&[]), "net: the net has no control points");
    says(flat().refined(&[1.0], &[]), "knots_u[0]: knot 1 is not inside the domain, 0 to 1");
    says(flat().elevated([1, 0]), "degree: degree 0 asked for; expected 1 to 24");
}

#[test]
fn wrong_morphs_are_named() {
    let two = [flat(), flat()];
    let make = |options: MorphOptions| NurbsMorph::new(&two, &options);
    let plain = MorphOptions::default;
    let ones = || vec![vec![1.0; 2]; 2];
    says(NurbsMorph::new(&two[..1], &plain()), "targets: 1 targets; expected two or more");
    let line = |n: usize| {
        let knots = [vec![0.0; n], vec![1.0; n]].concat();
        RationalCurve::new(n - 1, knots, &vec![[0., 0., 0., 1.]; n]).unwrap()
    };
    let masses = vec![vec![vec![1.0; 2]], vec![vec![1.0; 3]]];
    says(
        CurveMorph::new(&[line(2), line(3)], &MorphOptions { masses, ..plain() }),
        "masses[0][0]: row has 2 numbers; the common net has 3 columns",
    );
    let mut bad = ones();
    bad[1][0] = 0.0;
    says(
        make(MorphOptions { masses: vec![ones(), bad.clone()], ..plain() }),
        "masses[1][1][0]: mass is 0; expected a positive number",
    );
    says(
        make(MorphOptions { masses: vec![ones()], ..plain() }),
        "masses: 1 nets of masses; 2 targets need 2",
    );
    says(
        make(MorphOptions { scale: vec![1.0, -1.0], ..plain() }),
        "scale[1]: scale is -1; expected a positive number",
    );
    says(
        make(MorphOptions { weights: vec![vec![0.0, 0.0]], ..plain() }),
        "weights[0]: all weights are zero",
    );
    says(
        make(MorphOptions {
            averaging: Averaging::Linear,
            masses: vec![ones(), ones()],
            ..plain()
        }),
        "masses: linear averaging has no masses; use weighted averaging",
    );
    let design =
        |t: f64, r: f64| Design { t, distance: vec![vec![vec![0.5, r]; 2]], weights: None };
    let designed = |d: Design| make(MorphOptions { designs: vec![design(0.5, 0.5), d], ..plain() });
    says(designed(design(1.0, 0.5)), "design[1].t: t is 1; expected above 0 and below 1");
    says(
        designed(design(0.4, 1.0)),
        "design[1].distance[0][1]: distance is 1; expected above 0 and below 1",
    );
    says(
        designed(Design { weights: Some(bad), ..design(0.4, 0.5) }),
        "design[1].weights[1][0]: mass is 0; expected a positive number",
    );
    says(make(plain()).unwrap().at(1.5).map(|_| ()), "t: t is 1.5; expected 0 to 1");
    let three = [flat(), flat(), flat()];
    says(NurbsMorph::new(&three, &plain()), "weights: missing; 3 targets need them");
}

#[test]
fn a_common_net_has_a_limit() {
    let long = |degree: [usize; 2], n: [usize; 2]| {
        let knots = |p: usize, n: usize| -> Vec<f64> {
            let inner = (1..n - p).map(|i| i as f64 / (n - p) as f64);
            vec![0.0; p + 1].into_iter().chain(inner).chain(vec![1.0; p + 1]).collect()
        };
        let net = vec![vec![[0.0, 0.0, 0.0, 1.0]; n[0]]; n[1]];
        RationalSurface::new(degree, knots(degree[0], n[0]), knots(degree[1], n[1]), &net).unwrap()
    };
    let all = [long([1, 1], [100_000, 2]), long([1, 1], [2, 100_000])];
    says(
        compatible_surfaces(&all),
        "targets: the 2 common nets would have 100000 x 100000 control points; the most is 4194304 in all",
    );
}

/// Numbers that break things.
fn odd(dice: &mut Dice) -> f64 {
    let all = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        0.5,
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::MAX,
        f64::MIN_POSITIVE,
        5e-324,
        1e-300,
        1e300,
        1e50,
        1e-50,
        1e12,
        -1e12,
        1.0 + 1e-15,
    ];
    let i = dice.below(all.len() + 6);
    all.get(i).copied().unwrap_or_else(|| dice.roll())
}

#[test]
fn twenty_thousand_broken_inputs_do_not_panic() {
    let mut dice = Dice(99);
    let (mut made, mut frames) = (0, 0);
    for _ in 0..20_000 {
        let degree = [1 + dice.below(4), 1 + dice.below(3)];
        let n = degree.map(|p| p + 1 + dice.below(4));
        let mut knots = [0, 1].map(|k| super::knots(&mut dice, degree[k], n[k], [0.0, 1.0]));
        let mut net: Vec<Vec<[f64; 4]>> =
            (0..n[1]).map(|_| (0..n[0]).map(|_| point(&mut dice)).collect()).collect();
        for _ in 0..dice.below(3) {
            let axis = dice.below(2);
            match dice.below(7) {
                0 => knots[axis].truncate(dice.below(9)),
                1 => knots[axis].push(odd(&mut dice)),
                2 | 3 => {
                    let at = dice.below(knots[axis].len());
                    if let Some(t) = knots[axis].get_mut(at) {
                        *t = odd(&mut dice);
                    }
                    knots[axis].sort_by(f64::total_cmp);
                }
                4 => net.truncate(dice.below(4)),
                5 => {
                    let at = dice.below(net.len());
                    if let Some(row) = net.get_mut(at) {
                        row.truncate(dice.below(6));
                    }
                }
                _ => {
                    let at = dice.below(net.len());
                    if let Some(p) = net.get_mut(at).and_then(|r| r.first_mut()) {
                        p[dice.below(4)] = odd(&mut dice);
                    }
                }
            }
        }
        let degree = if dice.below(20) == 0 { [dice.below(40), dice.below(3)] } else { degree };
        let [u, v] = knots;
        let Ok(patch) = RationalSurface::new(degree, u, v, &net) else { continue };
        made += 1;
        for uv in [DVec2::ZERO, DVec2::ONE, DVec2::splat(f64::NAN), DVec2::splat(dice.roll())] {
            assert!(patch.jet(0, uv).s.is_finite());
        }
        let masses: Vec<Rows> = (0..dice.below(3)).map(|_| rows(&mut dice, n)).collect();
        let mut designs = vec![];
        for _ in 0..dice.below(3) {
            let mut distance = rows(&mut dice, n);
            distance[0][0] = if dice.below(3) == 0 { odd(&mut dice) } else { 0.3 };
            designs.push(Design { t: odd(&mut dice), distance: vec![distance], weights: None });
        }
        let options = MorphOptions { masses, designs, ..Default::default() };
        let other = patch.elevated(patch.knots().each_ref().map(|k| k.degree() + 1));
        for second in [Ok(patch.clone()), other].into_iter().flatten() {
            let Ok(morph) = NurbsMorph::new(&[patch.clone(), second], &options) else { continue };
            for t in [0.0, 0.5, 1.0, odd(&mut dice)] {
                let Ok(frame) = morph.at(t) else { continue };
                assert!(frame.point(0, DVec2::splat(dice.roll())).is_finite());
                frames += 1;
            }
        }
    }
    assert!(made > 4000 && frames > 4000, "only {made} surfaces and {frames} frames");
}
