//! Invariants of solids and of fields made of fields.

use super::*;
use crate::element::Shape;
use crate::field::Shared;
use crate::field::csg::{Joined, Mirror, Moved, Offset, Shell};
use crate::warp::Deform;
use glam::{DAffine3, DQuat, DVec2};
use proptest::prelude::*;
use std::sync::Arc;

fn vector(reach: f64) -> impl Strategy<Value = DVec3> {
    [-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64].prop_map(move |v| DVec3::from_array(v) * reach)
}

fn part() -> impl Strategy<Value = Part> {
    let square = [DVec2::NEG_ONE, DVec2::new(1.0, -0.5), DVec2::new(0.0, 1.0)];
    let shape = prop_oneof![
        Just(Shape::Block),
        Just(Shape::Cylinder),
        Just(Shape::Capsule),
        Just(Shape::Ellipsoid),
        Just(Shape::prism(&square).unwrap()),
    ];
    let deform = prop_oneof![
        Just(Deform::NONE),
        (-1.0..1.0f64, 0.5..2.0f64, -1.5..1.5f64).prop_map(|(twist, taper, bend)| Deform {
            twist,
            taper,
            bend
        })
    ];
    let join = prop_oneof![
        2 => Just(Join::Add),
        1 => Just(Join::Cut),
        1 => (1.0..60.0f64).prop_map(Join::Blend),
    ];
    let half = [10.0..50.0f64, 10.0..50.0f64, 60.0..200.0f64];
    (shape, vector(200.0), vector(3.0), half, deform, 0.0..12.0f64, join).prop_map(
        |(shape, centre, turn, half, deform, round, join)| Part {
            element: Element {
                shape,
                centre,
                rotation: DQuat::from_scaled_axis(turn),
                half: DVec3::from_array(half),
                deform,
            },
            round,
            join,
        },
    )
}

fn parts() -> impl Strategy<Value = Vec<Part>> {
    prop::collection::vec(part(), 1..9).prop_map(|mut parts| {
        parts[0].join = Join::Add;
        parts
    })
}

/// Every field is what it promises at a point of a box.
fn honest(f: &dyn Field, cell: &Aabb, u: DVec3) -> Result<(), TestCaseError> {
    let p = cell.clamp(cell.centre() + u * cell.size() * 0.5);
    let value = f.value(p);
    let bound = f.bound(cell);
    prop_assert!(bound.widen(1e-9).contains(value), "{:?} {}", bound, value);
    if !f.support().grow(1e-9).contains(p) {
        prop_assert!(value > 0.0, "{} at {}", value, p);
    }
    let mut out = [0.0; 2];
    f.values(&[p, cell.min], &mut out);
    prop_assert_eq!(out, [value, f.value(cell.min)]);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn bounds_hold(a in parts(), b in parts(), c in vector(400.0), h in vector(90.0), u in vector(1.0), k in 1.0..50.0f64) {
        let cell = Aabb::around(c, h.abs());
        let turn = DQuat::from_scaled_axis(u * 3.0);
        let solid: Shared = Arc::new(Solid::new(&a[0].element, a[0].round));
        honest(&*solid, &cell, u)?;
        let (a, b): (Shared, Shared) =
            (Arc::new(Assembly::new(&a).unwrap()), Arc::new(Assembly::new(&b).unwrap()));
        honest(&*a, &cell, u)?;
        for join in [Join::Add, Join::Cut, Join::Meet] {
            honest(&Joined { a: a.clone(), b: b.clone(), join }, &cell, u)?;
        }
        honest(&Joined { a: solid.clone(), b: solid.clone(), join: Join::Blend(k) }, &cell, u)?;
        honest(&Offset { field: solid.clone(), distance: k - 20.0 }, &cell, u)?;
        honest(&Shell { field: solid, thickness: k }, &cell, u)?;
        honest(&Mirror { field: a.clone(), axis: 1 }, &cell, u)?;
        let by = DAffine3::from_scale_rotation_translation(DVec3::splat(0.4), turn, c);
        honest(&Moved::new(a, by).unwrap(), &cell, u)?;
    }

    #[test]
    fn pruning_changes_no_bit(parts in parts(), p in vector(600.0)) {
        let all = Assembly::new(&parts).unwrap();
        let plain = parts.iter().fold(f64::INFINITY, |f, part| {
            part.join.value(f, part.element.gauge(part.round).distance(p))
        });
        prop_assert_eq!(all.value(p), plain);
    }

    #[test]
    fn assemblies_are_1_lipschitz(parts in parts(), p in vector(500.0), s in vector(30.0)) {
        let f = Assembly::new(&parts).unwrap();
        prop_assert!((f.value(p) - f.value(p + s)).abs() <= s.length() * (1.0 + 1e-9) + 1e-9);
    }
}

fn ball(x: f64) -> Shared {
    let e = Element::new(
        Shape::Ellipsoid,
        DVec3::X * x,
        DQuat::IDENTITY,
        DVec3::splat(10.0),
        Deform::NONE,
    );
    Arc::new(Solid::new(&e.unwrap(), 0.0))
}

#[test]
fn values_known_by_hand() {
    let near =
        |f: &dyn Field, p: DVec3, d: f64| assert!((f.value(p) - d).abs() < 1e-9, "{}", f.value(p));
    let join = |join| Joined { a: ball(0.0), b: ball(12.0), join };
    near(&join(Join::Add), DVec3::X * 6.0, -4.0);
    near(&join(Join::Cut), DVec3::X * 6.0, 4.0);
    near(&join(Join::Meet), DVec3::X * -4.0, 6.0);
    // both distances are -4: the blend sinks by a quarter of its width
    near(&join(Join::Blend(8.0)), DVec3::X * 6.0, -6.0);
    near(&Shell { field: ball(0.0), thickness: 4.0 }, DVec3::Y * 9.0, -1.0);
    near(&Offset { field: ball(0.0), distance: 3.0 }, DVec3::Y * 14.0, 1.0);
    near(&Mirror { field: ball(30.0), axis: 0 }, DVec3::X * -45.0, 5.0);
    let block = Element::block(DVec3::ZERO, DVec3::splat(10.0), DQuat::IDENTITY).unwrap();
    // an edge rounded by 4: the corner's centre of curvature lies at 6
    let d = 50f64.sqrt() - 4.0;
    near(&Solid::new(&block, 4.0), DVec3::new(11.0, 11.0, 0.0), d);
    near(&Solid::new(&block, 4.0), DVec3::new(12.0, 0.0, 0.0), 2.0);
}

#[test]
fn senseless_solids_are_refused() {
    assert!(matches!(Assembly::new(&[]), Err(SolidError::Empty)));
    let element = Element::block(DVec3::ZERO, DVec3::ONE, DQuat::IDENTITY).unwrap();
    let cut = Part { element, round: 0.0, join: Join::Cut };
    assert!(matches!(Assembly::new(&[cut]), Err(SolidError::First)));
    let uneven = DAffine3::from_scale(DVec3::new(1.0, 1.0, 2.0));
    assert!(Moved::new(ball(0.0), uneven).is_err());
    let slanted = DAffine3::from_cols(DVec3::X, DVec3::new(0.6, 0.8, 0.0), DVec3::Z, DVec3::ZERO);
    assert!(Moved::new(ball(0.0), slanted).is_err());
}
