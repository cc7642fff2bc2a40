//! Invariants of elements and of the maps between them.

use super::*;
use crate::num::lanes::{Boxes, Lane};
use fearless_simd::{Level, dispatch};
use glam::DVec2;
use proptest::prelude::*;
use std::sync::Arc;

#[derive(Debug)]
struct BallForm;

impl Form for BallForm {
    fn distance(&self, q: DVec3) -> f64 {
        q.length() - 0.9
    }
    fn bounds(&self) -> Aabb {
        Aabb::around(DVec3::ZERO, DVec3::splat(0.9))
    }
}

fn shape() -> impl Strategy<Value = Shape> {
    let kite =
        [DVec2::new(0.0, -1.0), DVec2::new(1.0, 0.2), DVec2::new(0.0, 0.9), DVec2::new(-0.7, 0.0)];
    prop_oneof![
        Just(Shape::Block),
        Just(Shape::Cylinder),
        Just(Shape::Capsule),
        Just(Shape::Ellipsoid),
        Just(Shape::prism(&kite).unwrap()),
        Just(Shape::Mesh(Arc::new(BallForm))),
        Just(Shape::Mix(vec![(Shape::Block, 0.25), (Shape::Cylinder, 0.75)])),
    ]
}

fn deform() -> impl Strategy<Value = Deform> {
    let twist = prop_oneof![Just(0.0), -2.0..2.0f64];
    let taper = prop_oneof![Just(1.0), 0.4..2.5f64];
    let bend = prop_oneof![Just(0.0), -2.5..2.5f64];
    (twist, taper, bend).prop_map(|(twist, taper, bend)| Deform { twist, taper, bend })
}

fn vector(reach: f64) -> impl Strategy<Value = DVec3> {
    [-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64].prop_map(move |v| DVec3::from_array(v) * reach)
}

fn element() -> impl Strategy<Value = Element> {
    let half = [15.0..40.0f64, 15.0..40.0f64, 90.0..200.0f64];
    (shape(), vector(300.0), vector(3.0), half, deform()).prop_map(
        |(shape, centre, turn, half, deform)| Element {
            shape,
            centre,
            rotation: DQuat::from_scaled_axis(turn),
            half: DVec3::from_array(half),
            deform,
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn world_and_local_are_inverse(e in element(), q in vector(1.0)) {
        prop_assert!((e.to_local(e.to_world(q)) - q).length() < 1e-12 * 10.0);
    }

    #[test]
    fn distance_is_1_lipschitz(e in element(), a in vector(400.0), b in vector(400.0), t in 0.0..1.0f64) {
        let (p, far) = (e.centre + a, e.centre + b);
        // near pairs try the steep places, far pairs the jumps
        for q in [far, p.lerp(far, t * 1e-3)] {
            let change = (e.distance(p) - e.distance(q)).abs();
            prop_assert!(change <= p.distance(q) * (1.0 + 1e-9) + 1e-9, "{} {}", change, p.distance(q));
        }
    }

    #[test]
    fn the_sign_is_that_of_the_unit_form(e in element(), q in vector(1.4)) {
        let plain = Element { centre: DVec3::ZERO, rotation: DQuat::IDENTITY, deform: Deform::NONE, ..e.clone() };
        let straight = plain.distance(q * e.half);
        prop_assume!(straight.abs() > 1e-6);
        // past the ends of a strong bend points can lie in the other end's space
        if straight < 0.0 || e.deform.bend == 0.0 {
            prop_assert_eq!(e.distance(e.to_world(q)) < 0.0, straight < 0.0);
        }
    }

    #[test]
    fn the_box_holds_the_body(e in element(), p in vector(400.0)) {
        let p = e.centre + p;
        if e.distance(p) < 0.0 {
            prop_assert!(e.bounds().grow(1e-9).contains(p));
        }
        prop_assert!(e.distance(p) >= e.bounds().distance(p) - 1e-9 || e.bounds().contains(p));
    }

    #[test]
    fn bounds_hold(e in element(), c in vector(400.0), h in vector(60.0), u in vector(1.0)) {
        let b = Aabb::around(e.centre + c, h.abs());
        prop_assert!(e.distance_bound(&b).contains(e.distance(b.centre() + u * h)));
        prop_assert!(e.distance_bound(&b).contains(e.distance(b.centre())));
    }

    /// What a point or box gives alone and among eight.
    #[test]
    fn eight_at_once_are_eight_alone(e in element(), o in element(), round in 0usize..2,
                                     c in prop::collection::vec((vector(400.0), vector(60.0)), 1..9)) {
        let (gauge, map) = (e.gauge(round as f64 * 3.0), e.between(&o));
        let boxes: Vec<Aabb> = c.iter().map(|&(c, h)| Aabb::around(c, h.abs())).collect();
        let (d, y, range) = dispatch!(Level::new(), s => {
            let all = Boxes::of(s, &boxes);
            let d: Lane = gauge.distances(s, all.centre).into();
            (d, map.pulled(s, all.centre).lanes(), gauge.ranges(s, &all).lanes())
        });
        for (i, b) in boxes.iter().enumerate() {
            prop_assert_eq!(d[i].to_bits(), gauge.distance(b.centre()).to_bits());
            prop_assert_eq!(y[i], map.pull(b.centre()));
            let alone = gauge.bound(b);
            prop_assert!((range[i].lo - alone.lo).abs() < 1e-9 && (range[i].hi - alone.hi).abs() < 1e-9);
        }
    }

    #[test]
    fn rounding_keeps_the_size_and_the_lipschitz_bound(e in element(), a in vector(300.0), s in vector(0.1)) {
        let p = e.centre + a;
        prop_assert!(e.distance_rounded(p, 8.0) >= e.distance(p) - 8.0 - 1e-9);
        prop_assert!(e.distance_rounded(p, 8.0) >= e.bounds().distance(p) - 1e-9 || e.bounds().contains(p));
        let change = (e.distance_rounded(p, 8.0) - e.distance_rounded(p + s, 8.0)).abs();
        prop_assert!(change <= s.length() + 1e-9);
    }

    #[test]
    fn maps_agree_with_normal_coordinates(a in element(), b in element(), q in vector(1.0)) {
        let p = a.to_world(q);
        prop_assert!(a.between(&b).pull(p).distance(b.to_world(q)) < 1e-9);
        prop_assert_eq!(a.between(&a).pull(p), p);
    }

    #[test]
    fn images_and_stretches_hold(a in element(), b in element(), c in vector(300.0), h in vector(50.0),
                                 us in prop::collection::vec(vector(1.0), 20)) {
        let map = a.between(&b);
        let cell = Aabb::around(a.centre + c, h.abs());
        let image = map.image(&cell);
        let stretch = map.stretch(&cell);
        let other = a.between(&Element { deform: Deform::NONE, ..a.mirrored(0) });
        let difference = map.difference(&other, &cell);
        for u in us {
            let p = cell.centre() + u * h;
            prop_assert!(image.contains(map.pull(p)));
            prop_assert!(difference.contains(map.pull(p) - other.pull(p)));
            let q = cell.clamp(p + u * 1e-3);
            let moved = map.pull(p).distance(map.pull(q));
            prop_assert!(moved <= stretch * p.distance(q) + 1e-8);
        }
    }

    #[test]
    fn a_mirror_image_mirrors(e in element(), p in vector(400.0), axis in 0usize..3) {
        let mut m = p;
        m[axis] = -m[axis];
        prop_assert!((e.distance(p) - e.mirrored(axis).distance(m)).abs() < 1e-9);
    }
}

#[test]
fn distances_known_by_hand() {
    let turn = DQuat::from_rotation_z(0.7);
    let block = Element::block(DVec3::X, DVec3::new(3.0, 2.0, 1.0), turn).unwrap();
    let at = |q: DVec3| block.distance(DVec3::X + turn * q);
    assert!((at(DVec3::new(6.0, 6.0, 1.0)) - 5.0).abs() < 1e-12);
    assert!((at(DVec3::new(1.0, 0.0, 0.25)) + 0.75).abs() < 1e-12);
    let rod = Element::rod(DVec3::ZERO, DVec3::new(0.0, 0.0, -10.0), 2.0).unwrap();
    assert!((rod.distance(DVec3::new(5.0, 0.0, 4.0)) - 5.0).abs() < 1e-12);
    let capsule = Element::capsule(DVec3::ZERO, DVec3::new(0.0, 10.0, 0.0), 2.0).unwrap();
    assert!((capsule.distance(DVec3::new(0.0, 13.0, 4.0)) - 3.0).abs() < 1e-12);
    let square = [DVec2::NEG_ONE, DVec2::new(1.0, -1.0), DVec2::ONE, DVec2::new(-1.0, 1.0)];
    let prism = Element { shape: Shape::prism(&square).unwrap(), ..block.clone() };
    for p in [DVec3::new(4.0, 1.0, 2.0), DVec3::new(1.2, 0.1, 0.3), DVec3::new(9.0, 9.0, 0.0)] {
        assert!((prism.distance(p) - block.distance(p)).abs() < 1e-12);
    }
}

#[test]
fn a_rounded_prism_keeps_its_slanted_sides() {
    let kite = [DVec2::NEG_Y, DVec2::X, DVec2::Y, DVec2::NEG_X];
    let prism = Element {
        shape: Shape::prism(&kite).unwrap(),
        ..Element::block(DVec3::ZERO, DVec3::splat(20.0), DQuat::IDENTITY).unwrap()
    };
    let side = DVec3::new(10.0, 10.0, 3.0);
    assert!(prism.distance_rounded(side, 6.0).abs() < 1e-12);
    // the rim's centre of curvature lies 6 inside the side and 6 below the top
    let out = DVec3::new(1.0, 1.0, 0.0).normalize();
    let rim = side - 6.0 * out + DVec3::Z * 11.0 + (out + DVec3::Z) * 10.0;
    assert!((prism.distance_rounded(rim, 6.0) - (200f64.sqrt() - 6.0)).abs() < 1e-12);
}

#[test]
fn bad_elements_are_refused() {
    let size = Element::block(DVec3::ZERO, DVec3::new(1.0, 0.0, 1.0), DQuat::IDENTITY);
    assert!(matches!(size, Err(ElementError::Size { axis: 'y', .. })));
    assert!(matches!(Element::rod(DVec3::X, DVec3::X, 1.0), Err(ElementError::Ends(_))));
    assert!(matches!(Element::rod(DVec3::NAN, DVec3::X, 1.0), Err(ElementError::Place)));
    let thick = Element::block(DVec3::ZERO, DVec3::splat(50.0), DQuat::IDENTITY).unwrap();
    let bend = Deform { bend: 3.0, ..Deform::NONE };
    assert!(matches!(thick.deformed(bend), Err(ElementError::Warp(_))));
    let clockwise = [DVec2::ZERO, DVec2::Y, DVec2::X];
    assert!(matches!(Shape::prism(&clockwise), Err(ElementError::Polygon(_))));
    let star: Vec<DVec2> =
        (0..5).map(|i| DVec2::from_angle(f64::from(i) * 0.8 * std::f64::consts::PI)).collect();
    assert!(matches!(Shape::prism(&star), Err(ElementError::Polygon(_))));
}

#[test]
fn middle_sheet_is_half_way_through_a_board() {
    let board =
        Element::block(DVec3::new(1.0, 2.0, 3.0), DVec3::new(20.0, 2.0, 30.0), DQuat::IDENTITY)
            .unwrap();
    let flat = middle_sheet(&board, 16).unwrap();
    assert_eq!((flat.points.len(), flat.faces.len()), (4, 2));
    assert!((flat.area() - 40.0 * 60.0).abs() < 1e-9);
    assert!(flat.points.iter().all(|p| (p.y - 2.0).abs() < 1e-12));
    // a bent board gives a bent sheet: an arc as long as the board
    let bent = board.deformed(Deform::new(0.0, 1.0, 1.0).unwrap()).unwrap();
    let sheet = middle_sheet(&bent, 256).unwrap();
    assert!(sheet.faces.len() > 20 && (sheet.area() / 2400.0 - 1.0).abs() < 1e-3);
    let rod = Element::rod(DVec3::ZERO, DVec3::Z, 1.0).unwrap();
    assert!(middle_sheet(&rod, 16).is_none());
}
