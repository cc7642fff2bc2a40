use super::*;
use glam::{DVec3, dvec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

fn all() -> Vec<(&'static str, Box<dyn Surface>)> {
    vec![
        ("shell", Box::new(SeaShell::default())),
        ("bottle", Box::new(KleinBottle::default())),
        ("ellipsoid", Box::new(SuperEllipsoid::default())),
        ("toroid", Box::new(SuperToroid::default())),
    ]
}

#[test]
fn derivatives_match_differences() {
    let h = 1e-6;
    for (name, shape) in all() {
        // away from the kinks and from where the powers have infinite slopes
        for (u, v) in [(0.3, 0.4), (0.9, 2.5), (2.8, 4.0), (4.0, 5.9), (6.0, 1.0)] {
            let [u0, u1] = shape.domain(0).u;
            let uv = DVec2::new(u0 + (u1 - u0) * u / TAU, v);
            let jet = shape.jet(0, uv);
            let slope = |d: DVec2| (shape.point(0, uv + d) - shape.point(0, uv - d)) / (2.0 * h);
            assert!((jet.su - slope(DVec2::X * h)).length() < 1e-7, "{name} at {uv}");
            assert!((jet.sv - slope(DVec2::Y * h)).length() < 1e-7, "{name} at {uv}");
        }
    }
}

#[test]
fn derivatives_are_finite_everywhere() {
    for (name, shape) in all() {
        let [u0, u1] = shape.domain(0).u;
        for i in 0..=8 {
            for j in 0..=8 {
                let uv = DVec2::new(u0 + (u1 - u0) * f64::from(i) / 8.0, TAU * f64::from(j) / 8.0);
                let jet = shape.jet(0, uv);
                assert!(jet.s.is_finite() && jet.su.is_finite() && jet.sv.is_finite(), "{name}");
            }
        }
    }
}

#[test]
fn points_lie_on_their_implicit_surfaces() {
    let (ball, ring) = (SuperEllipsoid::default(), SuperToroid::default());
    let power = |x: f64, n: f64| x.abs().powf(2.0 / n);
    for (u, v) in [(0.4, 0.7), (1.2, 3.0), (2.9, 5.0)] {
        let p = ball.point(0, DVec2::new(u, v)) / dvec3(ball.alpha, ball.beta, ball.gamma);
        let level = (power(p.x, ball.n2) + power(p.y, ball.n2)).powf(ball.n2 / ball.n1);
        assert!((level + power(p.z, ball.n1) - 1.0).abs() < 1e-12);
        let p = ring.point(0, DVec2::new(u, v));
        let far = (power(p.x, ring.n1) + power(p.y, ring.n1)).powf(ring.n1 / 2.0);
        let level =
            power((far - ring.gamma) / ring.alpha, ring.n2) + power(p.z / ring.alpha, ring.n2);
        assert!((level - 1.0).abs() < 1e-12);
    }
}

#[test]
fn shell_and_bottle_are_where_they_should_be() {
    let shell = SeaShell::default();
    let at = |u, v| shell.point(0, DVec2::new(u, v));
    assert!((at(0.0, 0.0) - dvec3(0.5, 0.0, 0.0)).length() < 1e-15);
    assert!((at(TAU, 1.0) - dvec3(0.1, 0.0, 1.0)).length() < 1e-15, "a pole at the top");
    assert!((at(FRAC_PI_2, PI) - dvec3(-0.1, 0.0, 0.25)).length() < 1e-15);
    let bottle = KleinBottle::default();
    for v in [0.0, 0.8, 3.0] {
        let [a, b] = [(0.0, v), (TAU, PI - v)].map(|(u, v)| bottle.point(0, DVec2::new(u, v)));
        assert!((a - b).length() < 1e-13, "glued with v against pi - v");
        let [a, b] = [PI - 1e-9, PI].map(|u| bottle.point(0, DVec2::new(u, v)));
        assert!((a - b).length() < 1e-7, "no crack at the kink");
    }
    assert!((bottle.point(0, DVec2::new(FRAC_PI_2, 0.0)) - DVec3::Y * 20.0).length() < 1e-14);
}

#[test]
fn cuts_join_exactly() {
    let patches = cut(&KleinBottle::default(), 7, 32).unwrap();
    for pair in patches.windows(2) {
        assert_eq!(pair[0].curves[3], pair[1].curves[0]);
    }
}

#[test]
fn bad_numbers_are_named() {
    let bad = SeaShell { delta: -1.0, ..SeaShell::default() };
    assert_eq!(bad.check().unwrap_err().at, "delta");
    let bad = KleinBottle { beta: f64::NAN, ..KleinBottle::default() };
    assert_eq!(bad.check().unwrap_err().at, "beta");
    assert_eq!(SuperEllipsoid { n1: 0.0, ..Default::default() }.check().unwrap_err().at, "n1");
    let bad = SuperToroid { scale: dvec3(1.0, 0.0, 1.0), ..SuperToroid::default() };
    assert_eq!(bad.check().unwrap_err().at, "ry");
    for divisions in [0, 51] {
        let error = cut(&KleinBottle::default(), divisions, 32).unwrap_err();
        assert_eq!(error.at, "divisions");
    }
}
