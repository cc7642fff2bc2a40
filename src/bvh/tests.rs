use super::{Bvh, Winding};
use glam::{DVec3, dvec3};
use proptest::prelude::*;
use std::f64::consts::TAU;

/// A ball of radius 1 with bumps of height `bump`, `n` bands by `2 n` sectors.
fn ball(n: u32, bump: f64) -> Vec<[DVec3; 3]> {
    let at = |i: u32, j: u32| {
        let (s, c) = (f64::from(i % (2 * n)) / f64::from(2 * n) * TAU).sin_cos();
        let (z, r) = if j == 0 || j == n {
            (if j == 0 { -1.0 } else { 1.0 }, 0.0)
        } else {
            let (a, b) = ((f64::from(j) / f64::from(n) - 0.5) * TAU / 2.0).sin_cos();
            (a, b)
        };
        let p = dvec3(c * r, s * r, z);
        p * (1.0 + bump * (9.0 * p.x).sin() * (7.0 * p.y).cos() * (8.0 * p.z).sin())
    };
    let mut out = vec![];
    for i in 0..2 * n {
        for j in 0..n {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            if j > 0 {
                out.push([a, b, c]);
            }
            if j + 1 < n {
                out.push([a, c, d]);
            }
        }
    }
    out
}

fn brute(tris: &[[DVec3; 3]], p: DVec3) -> f64 {
    let far = |t: &[DVec3; 3]| super::triangle::Tri::new(*t).distance2(p.x, p.y, p.z);
    tris.iter().map(far).fold(f64::INFINITY, f64::min).sqrt()
}

/// Points of an 8³ cube in Morton order.
fn cube(origin: DVec3, step: f64) -> Vec<DVec3> {
    let bit = |i: u32, axis: u32| (0..3).map(|b| (i >> (3 * b + axis) & 1) << b).sum::<u32>();
    (0..512u32)
        .map(|i| origin + step * DVec3::from([0, 1, 2].map(|a| f64::from(bit(i, a)))))
        .collect()
}

fn points(n: usize, half: f64) -> impl Strategy<Value = Vec<DVec3>> {
    let x = move || -half..half;
    prop::collection::vec((x(), x(), x()).prop_map(|(x, y, z)| dvec3(x, y, z)), n)
}

#[test]
fn nothing_is_infinitely_far() {
    let none = Bvh::new(&[]);
    assert!(none.nearest(DVec3::ZERO).is_none());
    assert_eq!(none.distance(DVec3::ZERO), f64::INFINITY);
    assert_eq!(none.nearest_all(&[DVec3::ZERO])[0].distance2, f64::INFINITY);
    assert_eq!(Winding::new(&[]).number(DVec3::ZERO, 0.5), 0.0);
}

#[test]
fn one_triangle_is_a_leaf_at_the_root() {
    let one = Bvh::new(&[[DVec3::ZERO, DVec3::X, DVec3::Y]]);
    assert!((one.distance(dvec3(0.2, 0.2, 3.0)) - 3.0).abs() < 1e-14);
}

#[test]
fn coinciding_triangles_are_all_kept() {
    let tris = vec![[DVec3::ZERO, DVec3::X, DVec3::Y]; 1000];
    let bvh = Bvh::new(&tris);
    assert_eq!(bvh.len(), 1000);
    assert_eq!(bvh.overlapping(&bvh.bounds(), 0.0).len(), 1000);
    assert!((bvh.distance(dvec3(0.2, 0.2, -2.0)) - 2.0).abs() < 1e-14);
}

#[test]
fn points_that_are_not_finite_have_no_nearest() {
    let bvh = Bvh::new(&ball(6, 0.0));
    let bad = [DVec3::NAN, DVec3::INFINITY, dvec3(f64::NAN, 0.0, 0.0)];
    assert!(bad.iter().all(|&p| bvh.nearest(p).is_none_or(|n| n.distance.is_infinite())));
    // and do not spoil those that come after them
    let mixed = [vec![DVec3::X; 9], bad.to_vec(), vec![DVec3::Y * 3.0; 60]].concat();
    for (p, hit) in mixed.iter().zip(bvh.nearest_all(&mixed)).filter(|(p, _)| p.is_finite()) {
        assert_eq!(hit.distance2.sqrt(), bvh.distance(*p));
    }
}

#[test]
fn a_lattice_of_points_agrees_with_single_queries() {
    let tris = ball(40, 0.1);
    let bvh = Bvh::new(&tris);
    for (origin, step) in
        [(DVec3::splat(0.5), 0.02), (dvec3(0.9, -0.1, 0.0), 0.01), (DVec3::splat(-0.4), 0.1)]
    {
        let at = cube(origin, step);
        for (p, hit) in at.iter().zip(bvh.nearest_all(&at)) {
            assert_eq!(hit.distance2.sqrt(), bvh.distance(*p));
            assert_eq!(hit.distance2.sqrt(), brute(&tris, *p));
            let near = bvh.nearest_of(*p, &hit).unwrap();
            assert!((near.point.distance(*p) - near.distance).abs() < 1e-12);
        }
    }
}

#[test]
fn the_winding_number_is_right_far_near_and_inside() {
    let winding = Winding::new(&ball(30, 0.15));
    let (mut rough, mut coarse): (f64, f64) = (0.0, 0.0);
    for p in cube(DVec3::splat(-1.4), 0.4) {
        let exact = winding.exact(p);
        rough = rough.max((winding.roughly(&[p])[0] - exact).abs());
        coarse = coarse.max((winding.number(p, 9.0) - exact).abs());
    }
    assert!(rough < 0.004, "off by {rough}");
    assert!(coarse > rough && coarse < 0.05, "off by {coarse}");
}

#[test]
fn moments_of_the_third_order_fall_with_the_fourth_power() {
    // seen from afar the whole set is one dipole; an open half ball has all moments
    let half: Vec<_> =
        ball(24, 0.1).into_iter().filter(|t| t.iter().all(|p| p.z + 0.3 * p.x > 0.0)).collect();
    let winding = Winding::new(&half);
    let centre = winding.bounds().centre();
    let error = |r: f64| {
        [dvec3(1.0, 2.0, 3.0), dvec3(-2.0, 1.0, 0.5), dvec3(0.1, -1.0, -1.0)]
            .map(|dir| {
                let q = centre + dir.normalize() * r;
                (winding.roughly(&[q])[0] - winding.exact(q)).abs()
            })
            .into_iter()
            .fold(0.0, f64::max)
    };
    // the first term left out falls with r^-5
    let order = (error(8.0) / error(16.0)).log2();
    assert!(order > 4.5, "order {order}");
}

/// Triangles of all shapes about the origin: round ones, slivers, segments, points, and copies.
fn soup(at: &[DVec3], shift: DVec3) -> Vec<[DVec3; 3]> {
    let shape = |(n, p): (usize, &DVec3)| {
        let [a, b, c] = [0, 1, 2].map(|k| at[(3 * n + k) % at.len()]);
        let size = [0.3, 0.02, 1.5][n % 3];
        let (u, v) = (a * size, b * size);
        let corners = match n % 7 {
            0 => [*p, *p + u, *p + u + v * 1e-9],
            1 => [*p, *p + u, *p + u],
            2 => [*p; 3],
            3 => [a, b, c],
            _ => [*p, *p + u, *p + v],
        };
        corners.map(|p| shift + p)
    };
    let mut tris: Vec<_> = at.iter().enumerate().map(shape).collect();
    tris.extend_from_within(..at.len() / 4);
    tris
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn points_that_walk_together_find_what_each_finds(
        at in points(300, 1.0),
        corner in points(6, 1.5),
        fine in 0.0..5.0f64,
        far in 0usize..3,
    ) {
        let shift = dvec3(1.0, -2.0, 0.5) * [0.0, 1e3, 1e7][far];
        let tris = soup(&at, shift);
        let bvh = Bvh::new(&tris);
        for (n, p) in corner.iter().enumerate() {
            // steps from a fifth of the whole to nearly nothing, runs of 64, of eight and what is left
            let step = 0.3 * 10f64.powf(-fine) * (1.0 + n as f64);
            let at = &cube(shift + *p, step)[..if n % 2 == 0 { 512 } else { 61 }];
            for (p, hit) in at.iter().zip(bvh.nearest_all(at)) {
                prop_assert_eq!(hit.distance2.sqrt(), brute(&tris, *p));
                prop_assert_eq!(bvh.nearest_of(*p, &hit).map(|n| n.distance), Some(hit.distance2.sqrt()));
            }
        }
    }

    #[test]
    fn nearest_is_the_minimum_over_all(at in points(40, 2.0), bump in 0.0..0.3) {
        let tris = ball(12, bump);
        let bvh = Bvh::new(&tris);
        let all = bvh.nearest_all(&at);
        for (&p, hit) in at.iter().zip(all) {
            let near = bvh.nearest(p).unwrap();
            prop_assert_eq!(near.distance, brute(&tris, p));
            prop_assert_eq!(near.distance, hit.distance2.sqrt());
            prop_assert!((near.point.distance(p) - near.distance).abs() < 1e-12);
            prop_assert!(bvh.nearest_within(p, near.distance * 1.01 + 1e-9).is_some());
            prop_assert!(bvh.nearest_within(p, near.distance * 0.99).is_none());
        }
    }

    #[test]
    fn winding_near_the_level_is_as_good_as_exact(at in points(60, 1.5), cut in -0.5..0.9) {
        let open: Vec<_> = ball(16, 0.1).into_iter().filter(|t| t[0].z < cut).collect();
        let winding = Winding::new(&open);
        for at in at.chunks(Winding::LANES) {
            let all = winding.numbers(at, [0.5; Winding::LANES]);
            let alone = |&p: &DVec3| winding.number(p, 0.5);
            prop_assert_eq!(&all[..at.len()], &at.iter().map(alone).collect::<Vec<_>>()[..]);
            prop_assert!(all[at.len()..].iter().all(|&w| w == 0.0));
            let coarse = winding.coarsely_of(at, u8::MAX);
            let some = winding.both_of(at, 0b0101, [0.5; Winding::LANES]);
            let whole = [coarse, all];
            let mut lanes = (0..2).flat_map(|k| (0..at.len()).map(move |i| (k, i)));
            let same = |(k, i): (usize, usize)| {
                some[k][i] == if i == 0 || i == 2 { whole[k][i] } else { 0.0 }
            };
            prop_assert!(lanes.all(same));
            let rough = winding.roughly(at);
            prop_assert!(at.iter().zip(rough).all(|(&p, w)| w == winding.roughly(&[p])[0]));
            prop_assert!(at.iter().zip(rough).all(|(&p, w)| (w - winding.exact(p)).abs() < 0.02));
        }
        for p in at {
            let (fast, exact) = (winding.number(p, 0.5), winding.exact(p));
            prop_assert!((fast - exact).abs() < 0.1);
            prop_assert!((exact - 0.5).abs() > 0.01 || (fast - exact).abs() < 1e-3);
            prop_assert!((fast >= 0.5) == (exact >= 0.5), "{fast} {exact}");
        }
    }
}
