use super::*;
use crate::surface::Motion;
use crate::surface::nurbs::{CurveMorph, MorphOptions, circle, extrude, polyline, tube};
use std::collections::HashMap;
use std::f64::consts::PI;
use std::sync::Arc;

fn polygon(points: &[[f64; 2]]) -> RationalCurve {
    let n = points.len();
    let ring: Vec<_> = (0..=n).map(|i| points[i % n]).map(|[x, y]| [x, y, 0.0, 1.0]).collect();
    let inner = (0..=n).map(|i| i as f64);
    let knots: Vec<f64> = [0.0].into_iter().chain(inner).chain([n as f64]).collect();
    RationalCurve::new(1, knots, &ring).unwrap()
}

const L: [[f64; 2]; 6] = [[0., 0.], [4., 0.], [4., 1.], [1., 1.], [1., 3.], [0., 3.]];

#[test]
fn an_l_becomes_a_prism_either_way_round() {
    for turned in [false, true] {
        let mut points = L;
        if turned {
            points.reverse();
        }
        let mesh = extrude(&polygon(&points), 2.0, 0.1).unwrap();
        assert_eq!((mesh.points.len(), mesh.faces.len()), (12, 20));
        assert!((mesh.volume() - 12.0).abs() < 1e-13);
        assert!((mesh.area() - (2.0 * 6.0 + 14.0 * 2.0)).abs() < 1e-13);
        assert_eq!((mesh.bounds().min.z, mesh.bounds().max.z), (0.0, 2.0));
        // Each directed edge once, and its reverse once.
        let mut edges = HashMap::new();
        for f in &mesh.faces {
            (0..3).for_each(|k| *edges.entry((f[k], f[(k + 1) % 3])).or_insert(0) += 1);
        }
        assert!(edges.iter().all(|(&(a, b), &n)| n == 1 && edges.get(&(b, a)) == Some(&1)));
    }
}

#[test]
fn chords_keep_the_tolerance() {
    let ring = circle(50.0).unwrap();
    for tolerance in [1.0, 0.01, 1e-4] {
        let points = polyline(&ring, tolerance).unwrap();
        let n = points.len();
        let deepest = (0..n)
            .map(|i| 50.0 - ((points[i] + points[(i + 1) % n]) / 2.0).length())
            .fold(0.0, f64::max);
        assert!(deepest <= tolerance, "{deepest}");
        // A circle needs pi / acos(1 - tolerance / r) of them; twice that is no waste.
        assert!((n as f64) < 3.0 * PI / (1.0 - tolerance / 50.0).acos() + 8.0, "{n}");
        let mesh = extrude(&ring, 3.0, tolerance).unwrap();
        let lost = 3.0 * PI * 2500.0 - mesh.volume();
        assert!(lost > 0.0 && lost < 3.0 * 2.0 * PI * 50.0 * tolerance);
    }
}

#[test]
fn what_is_no_outline_is_refused() {
    let says = |curve: &RationalCurve, what: &str| {
        let why = extrude(curve, 1.0, 0.1).unwrap_err().to_string();
        assert!(why.starts_with(what), "{why}");
    };
    says(&polygon(&[[0., 0.], [3., 3.], [3., 0.], [0., 2.]]), "curve: the curve meets itself near");
    says(&polygon(&[[0., 0.], [3., 0.], [1., 0.], [1., 1.]]), "curve: the curve meets itself near");
    says(&polygon(&[[0., 0.], [3., 0.]]), "curve: the curve encloses no area");
    let open = RationalCurve::new(1, vec![0., 0., 1., 1.], &[[0., 0., 0., 1.], [3., 4., 0., 1.]]);
    says(&open.unwrap(), "curve: the curve is open: its ends are 5 mm apart");
    let mut bent = polygon(&L).points();
    bent[2][2] = 1.0;
    let bent = RationalCurve::new(1, polygon(&L).knots().values().to_vec(), &bent).unwrap();
    says(&bent, "curve: the curve is not planar: it leaves its plane by");
    let ring = circle(1.0).unwrap();
    assert!(extrude(&ring, 0.0, 0.1).is_err() && extrude(&ring, 1.0, f64::NAN).is_err());
    assert!(extrude(&ring, 1.0, 1e-14).is_err());
}

/// Volume and area of a patch: midpoint rules of n and 2n cells each way, extrapolated. The breaks
/// of the patch have to fall between cells.
fn measure(surface: &dyn Surface, patch: usize) -> [f64; 2] {
    let [rough, fine] = [120, 240].map(|n| midpoints(surface, patch, n));
    [0, 1].map(|k| (4.0 * fine[k] - rough[k]) / 3.0)
}

fn midpoints(surface: &dyn Surface, patch: usize, n: usize) -> [f64; 2] {
    let d = surface.domain(patch);
    let [hu, hv] = [(d.u[1] - d.u[0]) / n as f64, (d.v[1] - d.v[0]) / n as f64];
    let mut sums = [0.0; 2];
    for i in 0..n {
        for j in 0..n {
            let at = DVec2::new(d.u[0] + hu * (i as f64 + 0.5), d.v[0] + hv * (j as f64 + 0.5));
            let jet = surface.jet(patch, at);
            let across = jet.su.cross(jet.sv) * hu * hv;
            sums[0] += jet.s.dot(across) / 3.0;
            sums[1] += across.length();
        }
    }
    sums
}

#[test]
fn a_ring_of_tube_is_a_torus_by_pappus() {
    let torus = tube(Arc::new(circle(10.0).unwrap()), 2.0).unwrap();
    assert_eq!((torus.patches(), torus.domain(0).wraps), (1, [true, true]));
    let [volume, area] = measure(&torus, 0);
    // 2 pi R times the section: exact for any tube whose curve is planar.
    assert!((volume / (2.0 * PI * 10.0 * PI * 4.0) - 1.0).abs() < 1e-6, "{volume}");
    assert!((area / (4.0 * PI * PI * 20.0) - 1.0).abs() < 1e-6, "{area}");
    let d = torus.domain(0);
    for v in spread(d.v, 7) {
        let [a, b] = d.u.map(|u| torus.point(0, DVec2::new(u, v)));
        assert!(a.distance(b) < 1e-12);
    }
}

#[test]
fn a_bar_with_round_ends_and_a_knot_in_space() {
    let bar = RationalCurve::new(1, vec![0., 0., 1., 1.], &[[0., 0., 0., 1.], [30., 0., 40., 1.]]);
    let bar = tube(Arc::new(bar.unwrap()), 3.0).unwrap();
    let [volume, area] = measure(&bar, 0);
    assert!((volume / (PI * 9.0 * 50.0 + 4.0 / 3.0 * PI * 27.0) - 1.0).abs() < 1e-6, "{volume}");
    assert!((area / (2.0 * PI * 3.0 * 50.0 + 4.0 * PI * 9.0) - 1.0).abs() < 1e-6, "{area}");

    let mut dice = Dice(41);
    let mut points: Vec<_> = (0..9).map(|_| point(&mut dice)).collect();
    points.iter_mut().for_each(|p| (0..3).for_each(|k| p[k] *= 100.0));
    // Uniform quartic, its first four points again: closed and smooth.
    points.extend_from_within(..4);
    let knot = RationalCurve::new(4, (0..18).map(f64::from).collect(), &points).unwrap();
    let [a, b] = knot.domain();
    let ring = tube(Arc::new(knot.clone()), 0.5).unwrap();
    assert_eq!((ring.patches(), ring.domain(0).wraps), (1, [true, true]));
    assert!(slope_error(&ring, 0, 23) < 1e-5);
    for u in spread([a, b], 90) {
        for v in spread([0.0, 6.0], 5) {
            let jet = ring.jet(0, DVec2::new(u, v));
            let spoke = jet.s - knot.point(u);
            assert!((spoke.length() - 0.5).abs() < 1e-12 && spoke.dot(jet.sv).abs() < 1e-12);
            assert!(spoke.dot(knot.at(u).d1).abs() < 1e-9 * knot.at(u).d1.length());
        }
    }
    for v in spread([0.0, 6.0], 6) {
        let [p, q] = [a, b].map(|u| ring.point(0, DVec2::new(u, v)));
        assert!(p.distance(q) < 1e-10, "{}", p.distance(q));
    }
}

#[test]
fn corners_part_a_tube() {
    let corners = tube(Arc::new(polygon(&L)), 0.2).unwrap();
    assert_eq!(corners.patches(), 6);
    let [volume, _] = measure(&corners, 2);
    assert!((volume / (PI * 0.04 * 3.0 + 4.0 / 3.0 * PI * 0.008) - 1.0).abs() < 1e-6);
    let still = RationalCurve::new(1, vec![0., 0., 1., 1.], &[[1., 1., 1., 1.]; 2]).unwrap();
    let why = tube(Arc::new(still), 1.0).err().unwrap().to_string();
    assert_eq!(why, "curve: the curve stands still at u = 0");
    let two = [circle(10.0).unwrap(), circle(20.0).unwrap()];
    let motion = CurveMorph::new(&two, &MorphOptions::default()).unwrap().tubes(1.0);
    let [volume, _] = measure(&*motion.at(0.5).unwrap(), 0);
    assert!((volume / (2.0 * PI * 15.0 * PI) - 1.0).abs() < 1e-6);
}
