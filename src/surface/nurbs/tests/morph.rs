use super::*;
use crate::surface::Motion;
use crate::surface::nurbs::{
    Averaging, CurveMorph, Design, Falloff, Impact, MorphOptions, NurbsMorph,
};
use std::sync::Arc;

fn pair(dice: &mut Dice) -> [RationalSurface; 2] {
    let [u, v] = [9, 8].map(|n| super::knots(dice, 3, n, [0.0, 1.0]));
    [0, 1].map(|_| {
        let net: Vec<Vec<_>> = (0..8).map(|_| (0..9).map(|_| point(dice)).collect()).collect();
        RationalSurface::new([3, 3], u.clone(), v.clone(), &net).unwrap()
    })
}

fn own(surface: &RationalSurface) -> Rows {
    surface.net().iter().map(|row| row.iter().map(|p| p[3]).collect()).collect()
}

fn at(morph: &NurbsMorph, t: f64) -> Arc<dyn Surface> {
    morph.at(t).unwrap()
}

/// The places of a grid of parameters.
fn grid(n: usize) -> Vec<DVec2> {
    let line = || spread([0.0, 1.0], n);
    line().flat_map(|u| line().map(move |v| DVec2::new(u, v))).collect()
}

#[test]
fn own_weights_give_the_b_spline_of_blended_poles() {
    let mut dice = Dice(21);
    let two = pair(&mut dice);
    let spline = NurbsMorph::new(&two, &MorphOptions::default()).unwrap();
    // The same masses as numbers: evaluated point by point.
    let masses = two.iter().map(own).collect();
    let options = MorphOptions { masses, ..Default::default() };
    let pointwise = NurbsMorph::new(&two, &options).unwrap();
    for t in [0.0, 0.2, 0.5, 0.9, 1.0] {
        let (a, b) = (at(&spline, t), at(&pointwise, t));
        // By hand: poles (1 - t) w P + t v Q over weights (1 - t) w + t v.
        let mix = |p: &[f64; 4], q: &[f64; 4]| {
            let w = (1.0 - t) * p[3] + t * q[3];
            let c = |k: usize| ((1.0 - t) * p[3] * p[k] + t * q[3] * q[k]) / w;
            [c(0), c(1), c(2), w]
        };
        let net: Vec<Vec<_>> = two[0]
            .net()
            .iter()
            .zip(two[1].net())
            .map(|(p, q)| p.iter().zip(&q).map(|(p, q)| mix(p, q)).collect())
            .collect();
        let [u, v] = two[0].knots().clone().map(|k| k.values().to_vec());
        let c = RationalSurface::new([3, 3], u, v, &net).unwrap();
        assert!(apart(&*a, &c, 40) < 1e-13 && apart(&*b, &c, 40) < 1e-13);
        for uv in grid(9) {
            let (x, y) = (b.jet(0, uv), c.jet(0, uv));
            assert!(x.su.distance(y.su).max(x.sv.distance(y.sv)) < 1e-11 * (1.0 + y.su.length()));
        }
    }
}

#[test]
fn linear_averaging_goes_straight() {
    let mut dice = Dice(22);
    let two = pair(&mut dice);
    let options = MorphOptions { averaging: Averaging::Linear, ..Default::default() };
    let morph = NurbsMorph::new(&two, &options).unwrap();
    for uv in grid(12) {
        let [p, q] = two.each_ref().map(|s| s.point(0, uv));
        assert!(at(&morph, 0.3).point(0, uv).distance(p * 0.7 + q * 0.3) < 1e-15);
    }
}

#[test]
fn equal_masses_are_linear_and_heavier_ones_attract() {
    let mut dice = Dice(23);
    let two = pair(&mut dice);
    let morph = |m: f64| {
        let flat = |m: f64| vec![vec![m; 9]; 8];
        let options = MorphOptions { masses: vec![flat(m), flat(1.0)], ..Default::default() };
        NurbsMorph::new(&two, &options).unwrap()
    };
    let uv = DVec2::new(0.4, 0.6);
    for t in [0.1, 0.5, 0.8] {
        let d = |m: f64| morph(m).distances(t, uv).unwrap()[1];
        assert!((d(1.0) - t).abs() < 1e-15);
        assert!((d(3.0) - t / ((1.0 - t) * 3.0 + t)).abs() < 1e-15);
        assert!(d(3.0) < t && d(0.5) > t);
    }
}

#[test]
fn scaling_masses_moves_time() {
    let mut dice = Dice(24);
    let two = pair(&mut dice);
    let s = 2.5;
    let plain = NurbsMorph::new(&two, &MorphOptions::default()).unwrap();
    let options = MorphOptions { scale: vec![s, 1.0], ..Default::default() };
    let scaled = NurbsMorph::new(&two, &options).unwrap();
    for t in [0.0, 0.25, 0.6, 1.0] {
        let moved = t / ((1.0 - t) * s + t);
        assert!(apart(&*at(&scaled, t), &*at(&plain, moved), 25) < 1e-13);
    }
}

#[test]
fn masses_leave_the_targets_alone() {
    let mut dice = Dice(25);
    let two = pair(&mut dice);
    let masses = vec![rows(&mut dice, [9, 8]), rows(&mut dice, [9, 8])];
    let morph = NurbsMorph::new(&two, &MorphOptions { masses, ..Default::default() }).unwrap();
    assert_eq!(apart(&*at(&morph, 0.0), &two[0], 30), 0.0);
    assert_eq!(apart(&*at(&morph, 1.0), &two[1], 30), 0.0);
    // And near the ends it is near them, so nothing jumps.
    assert!(apart(&*at(&morph, 1e-9), &two[0], 30) < 1e-8);
    assert!(slope_error(&*at(&morph, 0.4), 0, 12) < 2e-6);
}

#[test]
fn designed_distances_come_back() {
    let mut dice = Dice(26);
    let two = pair(&mut dice);
    for (t, scale) in [(0.5, vec![]), (0.2, vec![1.0, 4.0]), (0.93, vec![0.1, 7.0])] {
        let design = Design {
            t,
            distance: vec![rows(&mut dice, [9, 8])],
            weights: Some(rows(&mut dice, [9, 8])),
        };
        let options = MorphOptions { scale, designs: vec![design.clone()], ..Default::default() };
        let morph = NurbsMorph::new(&two, &options).unwrap();
        let (shares, _) = morph.controls(t).unwrap();
        let pairs = shares[1].concat().into_iter().zip(design.distance[0].concat());
        assert!(pairs.clone().all(|(r, want)| (r - want).abs() < 1e-15));
        // D is the rational B-spline of the scalars R with the weights W: put them in for x.
        let weights = design.weights.unwrap();
        let net: Vec<Vec<_>> = design.distance[0]
            .iter()
            .zip(&weights)
            .map(|(r, w)| r.iter().zip(w).map(|(&r, &w)| [r, 0.0, 0.0, w]).collect())
            .collect();
        let [u, v] = two[0].knots().clone().map(|k| k.values().to_vec());
        let scalars = RationalSurface::new([3, 3], u, v, &net).unwrap();
        for uv in grid(15) {
            let d = morph.distances(t, uv).unwrap();
            assert!((d[1] - scalars.point(0, uv).x).abs() < 1e-14);
            let [p, q] = two.each_ref().map(|s| s.point(0, uv));
            assert!(at(&morph, t).point(0, uv).distance(p * d[0] + q * d[1]) < 1e-14);
        }
    }
}

#[test]
fn rising_designs_rise_all_the_way() {
    let mut dice = Dice(27);
    let two = pair(&mut dice);
    let early = rows(&mut dice, [9, 8]);
    // Later, each control is further on, some by very little.
    let later: Rows =
        early.iter().map(|r| r.iter().map(|x| x + (1.0 - x) * 0.01).collect()).collect();
    let designs = [(0.3, early.clone()), (0.7, later)]
        .map(|(t, rows)| Design { t, distance: vec![rows], weights: None })
        .to_vec();
    let morph = NurbsMorph::new(&two, &MorphOptions { designs, ..Default::default() }).unwrap();
    let all = |t: f64| morph.controls(t).unwrap().0[1].concat();
    let mut before = all(0.0);
    assert!(before.iter().all(|r| *r == 0.0));
    for i in 1..=100 {
        let now = all(f64::from(i) / 100.0);
        assert!(now.iter().zip(&before).all(|(a, b)| a > b), "at step {i}");
        before = now;
    }
    assert!(before.iter().all(|r| *r == 1.0));
    assert!(all(0.3).iter().zip(early.concat()).all(|(a, b)| (a - b).abs() < 1e-14));
}

#[test]
fn k_targets_share_by_weight_and_design() {
    let mut dice = Dice(28);
    let [a, b] = pair(&mut dice);
    let c = surface(&mut dice, [2, 3], [6, 5]);
    let weights = vec![vec![1.0, 0.0, 0.0], vec![0.2, 0.5, 0.3]];
    let plain = MorphOptions { weights, ..Default::default() };
    let morph = NurbsMorph::new(&[a.clone(), b, c], &plain).unwrap();
    assert!(apart(&*at(&morph, 0.0), &a, 20) < 1e-13);
    let size = [morph.targets()[0].net()[0].len(), morph.targets()[0].net().len()];
    let thirds = |dice: &mut Dice| -> Rows {
        rows(dice, size).iter().map(|r| r.iter().map(|x| x / 2.0).collect()).collect()
    };
    let distance = vec![thirds(&mut dice), thirds(&mut dice)];
    let design = Design { t: 0.75, distance: distance.clone(), weights: None };
    let mut designed = morph.clone();
    designed.design(&design).unwrap();
    let (shares, weights) = designed.controls(0.75).unwrap();
    let (_, old) = morph.controls(0.75).unwrap();
    for k in 0..size[0] * size[1] {
        let r: Vec<f64> = shares.iter().map(|s| s.concat()[k]).collect();
        assert!((r.iter().sum::<f64>() - 1.0).abs() < 1e-15);
        assert!((r[1] - distance[0].concat()[k]).abs() < 1e-15);
        assert!((r[2] - distance[1].concat()[k]).abs() < 1e-15);
        assert!((weights.concat()[k] / old.concat()[k] - 1.0).abs() < 1e-14);
    }
    for uv in grid(8) {
        let d = designed.distances(0.75, uv).unwrap();
        assert!((d.iter().sum::<f64>() - 1.0).abs() < 1e-15 && d.iter().all(|d| *d > 0.0));
    }
    let error = morph.targets().len();
    assert_eq!(error, 3);
    let why = designed.clone().design(&Design { t: 1e-300, ..design }).unwrap_err();
    assert!(why.to_string().starts_with("design.distance["), "{why}");
}

#[test]
fn an_area_of_impact_falls_off_round_its_centre() {
    let mut dice = Dice(29);
    let morph = NurbsMorph::new(&pair(&mut dice), &MorphOptions::default()).unwrap();
    let flat = vec![vec![0.5; 9]; 8];
    let centres = morph.targets()[0].knots().each_ref().map(|k| k.centres());
    let impact = Impact {
        centre: [centres[0][4], centres[1][3]],
        radius: [0.3, 0.4],
        falloff: Falloff::Smooth,
    };
    let pulled = morph.pull(&flat, &impact, 0.9).unwrap();
    assert_eq!(pulled[3][4], 0.9);
    for (j, row) in pulled.iter().enumerate() {
        for (i, r) in row.iter().enumerate() {
            let d = ((centres[0][i] - impact.centre[0]) / 0.3)
                .hypot((centres[1][j] - impact.centre[1]) / 0.4);
            let f = if d < 1.0 { 1.0 - 3.0 * d * d + 2.0 * d * d * d } else { 0.0 };
            assert!((r - (0.5 + 0.4 * f)).abs() < 1e-14);
        }
    }
    assert!(pulled.concat().iter().filter(|r| **r == 0.5).count() > 30);
    let wrong = morph.pull(&flat, &Impact { radius: [0.3, 0.0], ..impact }, 0.9).unwrap_err();
    assert_eq!(wrong.to_string(), "radius[1]: radius is 0; expected a positive number");
}

#[test]
fn curves_morph_as_surfaces_do() {
    let mut dice = Dice(30);
    let two = [curve(&mut dice, 2, 7, [0.0, 1.0]), curve(&mut dice, 3, 6, [0.0, 1.0])];
    let spline = CurveMorph::new(&two, &MorphOptions::default()).unwrap();
    let n = spline.targets()[0].points().len();
    let masses = |k: usize| vec![spline.targets()[k].points().iter().map(|p| p[3]).collect()];
    let options = MorphOptions { masses: vec![masses(0), masses(1)], ..Default::default() };
    let pointwise = CurveMorph::new(&two, &options).unwrap();
    let (a, b) = (spline.at(0.4).unwrap(), pointwise.at(0.4).unwrap());
    assert!(curves_apart(&*a, &*b, 200) < 1e-13);
    for u in spread([0.0, 1.0], 50) {
        let (x, y) = (a.at(u), b.at(u));
        assert!(x.d1.distance(y.d1) < 1e-11 * (1.0 + x.d1.length()));
        assert!(x.d2.distance(y.d2) < 1e-10 * (1.0 + x.d2.length()), "{} {}", x.d2, y.d2);
    }
    let designs = vec![Design { t: 0.5, distance: vec![rows(&mut dice, [n, 1])], weights: None }];
    let morph = CurveMorph::new(&two, &MorphOptions { designs, ..Default::default() }).unwrap();
    for u in spread([0.0, 1.0], 20) {
        let d = morph.distances(0.5, u).unwrap();
        let [p, q] = two.each_ref().map(|c| c.point(u));
        assert!(morph.at(0.5).unwrap().point(u).distance(p * d[0] + q * d[1]) < 1e-13);
    }
}
