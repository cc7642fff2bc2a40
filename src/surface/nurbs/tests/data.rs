//! The vases, faces and letters of `data/surfaces` show what they say.

use super::*;
use crate::surface::Motion;
use crate::surface::nurbs::{Averaging, CurveMorph, Design, MorphOptions, NurbsMorph, extrude};
use serde::Deserialize;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Target {
    kind: String,
    degree: Vec<usize>,
    knots_u: Vec<f64>,
    knots_v: Option<Vec<f64>>,
    net: Vec<Vec<[f64; 4]>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Morph {
    kind: String,
    targets: Vec<String>,
    #[serde(default)]
    averaging: String,
    #[serde(default)]
    masses: Vec<Rows>,
    #[serde(default)]
    design: Vec<Wanted>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Wanted {
    t: f64,
    distance: Rows,
}

fn load<T: serde::de::DeserializeOwned>(name: &str) -> T {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/data/surfaces");
    let text = std::fs::read_to_string(format!("{folder}/{name}")).unwrap();
    toml::from_str(&text).unwrap()
}

fn read(name: &str) -> (Vec<Target>, MorphOptions) {
    let file: Morph = load(name);
    assert_eq!(file.kind, "nurbs-morph");
    let targets: Vec<Target> = file.targets.iter().map(|t| load(t)).collect();
    assert!(targets.iter().all(|t| t.kind == "nurbs"));
    let linear = file.averaging == "linear";
    let wanted = |d: Wanted| Design { t: d.t, distance: vec![d.distance], weights: None };
    let options = MorphOptions {
        averaging: if linear { Averaging::Linear } else { Averaging::Weighted },
        masses: file.masses,
        designs: file.design.into_iter().map(wanted).collect(),
        ..Default::default()
    };
    (targets, options)
}

fn surfaces(name: &str) -> NurbsMorph {
    let (targets, options) = read(name);
    let make = |t: Target| {
        RationalSurface::new([t.degree[0], t.degree[1]], t.knots_u, t.knots_v.unwrap(), &t.net)
    };
    let targets: Vec<_> = targets.into_iter().map(|t| make(t).unwrap()).collect();
    NurbsMorph::new(&targets, &options).unwrap()
}

fn curves(name: &str) -> CurveMorph {
    let (targets, options) = read(name);
    let make = |t: Target| RationalCurve::new(t.degree[0], t.knots_u, &t.net[0]).unwrap();
    CurveMorph::new(&targets.into_iter().map(make).collect::<Vec<_>>(), &options).unwrap()
}

#[test]
fn vases_are_solid_and_keep_their_walls_and_rings() {
    let radius = |s: &dyn Surface, u: f64| s.point(0, DVec2::new(u, 0.25)).truncate().length();
    let mut rings = vec![];
    for name in ["vases-linear.toml", "vases.toml"] {
        let morph = surfaces(name);
        for t in [0.0, 0.3, 0.5, 1.0] {
            let vase = morph.at(t).unwrap();
            assert_eq!(vase.domain(0).wraps, [false, true]);
            for v in spread([0.0, 1.0], 6) {
                // Both ends of the profile are points on the axis: nothing is open.
                let [floor, foot] = [0.0, 1.0].map(|u| vase.point(0, DVec2::new(u, v)));
                assert!(floor.distance(DVec3::Z * 8.0) < 1e-12 && foot.length() < 1e-12);
            }
            // The outer wall is the inner one, moved by 6 mm.
            for u in spread([0.15, 0.4], 40) {
                let wall = radius(&*vase, 1.0 - u) - radius(&*vase, u);
                assert!((wall - 6.0).abs() < 1e-3, "{name} at {t}, {u}: {wall}");
            }
        }
        // Up and down of the outer wall, halfway.
        let half = morph.at(0.5).unwrap();
        let outer: Vec<f64> = spread([0.6, 0.85], 200).map(|u| radius(&*half, u)).collect();
        rings.push(outer.windows(2).map(|w| (w[1] - w[0]).abs()).sum::<f64>());
    }
    assert!(rings[1] > 3.0 * rings[0], "{rings:?}");
}

#[test]
fn faces_grow_their_nose_or_their_cheeks_first() {
    let [nose, cheek] = [DVec2::new(0.5, 0.47), DVec2::new(0.25, 0.42)];
    for (name, first, last) in
        [("faces-nose.toml", nose, cheek), ("faces-cheeks.toml", cheek, nose)]
    {
        let morph = surfaces(name);
        let d = |at: DVec2| morph.distances(0.5, at).unwrap()[1];
        assert!(d(first) > 0.8 && d(last) < 0.5, "{name}: {} {}", d(first), d(last));
        assert!(slope_error(&*morph.at(0.5).unwrap(), 0, 9) < 2e-6);
    }
    let even = surfaces("faces-linear.toml");
    assert_eq!(even.distances(0.25, nose).unwrap(), [0.75, 0.25]);
}

#[test]
fn letters_stay_simple_outlines_all_the_way() {
    for name in ["letters-e-g.toml", "letters-e-g-foot.toml", "letters-e-g-linear.toml"] {
        let morph = curves(name);
        for t in spread([0.0, 1.0], 20) {
            let solid = extrude(&*morph.at(t).unwrap(), 10.0, 0.05).unwrap();
            assert!(solid.volume() > 4e4 && solid.volume() < 6e4, "{name} at {t}");
        }
    }
    // E: a stem of 22 by 100, two arms of 48 by 22 and one of 38 by 22.
    let e = extrude(&*curves("letters-e-g.toml").at(0.0).unwrap(), 10.0, 0.05).unwrap();
    assert!((e.volume() - 10.0 * (2200.0 + 2.0 * 48.0 * 22.0 + 38.0 * 22.0)).abs() < 1e-9);
}
