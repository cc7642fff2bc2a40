use super::{Element, Shape};
use glam::{DMat3, DQuat, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Relabels the axes of `others` so that their rotations lie as near as can be to the reference's,
/// without moving any of them in space.
///
/// What may be relabelled: an undeformed block or ellipsoid by the 24 rotations of the cube (its
/// half sizes move along); a deformed one, and an elliptical cylinder or capsule, only by turns that
/// keep its axis, and half of those when it is bent; a round one by any spin and end for end.
/// Prisms, meshes and mixes keep their labels.
///
/// To be called once, when features are paired: [`super::average`] and [`Element::between`] then
/// agree about which point is which.
pub fn align(reference: &Element, others: &mut [Element]) {
    for e in others {
        *e = nearest(reference.rotation, e);
    }
}

fn nearest(to: DQuat, e: &Element) -> Element {
    let likeness = |e: &Element| e.rotation.dot(to).abs();
    let mut best = e.clone();
    for g in labellings(e, to) {
        let candidate = relabelled(e, g);
        // a tie keeps the labels that were there first
        if likeness(&candidate) > likeness(&best) + 1e-12 {
            best = candidate;
        }
    }
    best
}

/// Rotations that take the element's shape, in its own axes, to itself.
fn labellings(e: &Element, to: DQuat) -> Vec<DQuat> {
    let quarter = |k: u32| DQuat::from_rotation_z(f64::from(k) * FRAC_PI_2);
    let over = DQuat::from_rotation_x(PI);
    let round = (e.half.x - e.half.y).abs() <= 1e-9 * e.half.x;
    let bent = e.deform.bend != 0.0;
    match e.shape {
        Shape::Prism(_) | Shape::Mesh(_) | Shape::Mix(_) => Vec::new(),
        Shape::Block | Shape::Ellipsoid if e.deform.is_none() => {
            let up = [
                DQuat::IDENTITY,
                over,
                DQuat::from_rotation_x(FRAC_PI_2),
                DQuat::from_rotation_x(-FRAC_PI_2),
                DQuat::from_rotation_y(FRAC_PI_2),
                DQuat::from_rotation_y(-FRAC_PI_2),
            ];
            up.iter().flat_map(|&u| (0..4).map(move |k| u * quarter(k))).collect()
        }
        Shape::Cylinder | Shape::Capsule if round && !bent => {
            let ends = [DQuat::IDENTITY, over];
            ends.iter()
                .map(|&end| end * spin(end.conjugate() * e.rotation.conjugate() * to))
                .collect()
        }
        _ => {
            let turns = if bent { [0, 2].as_slice() } else { &[0, 1, 2, 3] };
            let ends = [DQuat::IDENTITY, over];
            ends.iter().flat_map(|&end| turns.iter().map(move |&k| end * quarter(k))).collect()
        }
    }
}

/// The rotation about z nearest to `a` (the twist of its swing-twist decomposition).
fn spin(a: DQuat) -> DQuat {
    let length = a.z.hypot(a.w);
    if length == 0.0 {
        return DQuat::IDENTITY;
    }
    DQuat::from_xyzw(0.0, 0.0, a.z / length, a.w / length)
}

/// The same set with its axes turned by `g`, which must be one of its symmetries.
fn relabelled(e: &Element, g: DQuat) -> Element {
    let m = DMat3::from_quat(g);
    // a quarter turn's matrix is 0 and ±1 but for round-off; a spin leaves x = y alone
    let square = m.to_cols_array().iter().all(|x| (x.abs() - x.abs().round()).abs() < 1e-9);
    let half = if square {
        let whole = |axis: DVec3| axis.abs().round().dot(e.half);
        DVec3::new(whole(m.x_axis), whole(m.y_axis), whole(m.z_axis))
    } else {
        e.half
    };
    let mut deform = e.deform;
    // end for end a taper inverts; a bend in the y-z plane follows y; a twist has no ends
    if m.z_axis.z < 0.0 && deform.taper != 1.0 {
        deform.taper = 1.0 / deform.taper;
    }
    if m.y_axis.y < 0.0 {
        deform.bend = -deform.bend;
    }
    Element { rotation: (e.rotation * g).normalize(), half, deform, ..e.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::mean::log;
    use crate::warp::Deform;
    use proptest::prelude::*;

    fn element() -> impl Strategy<Value = Element> {
        let shapes = prop_oneof![
            Just(Shape::Block),
            Just(Shape::Cylinder),
            Just(Shape::Capsule),
            Just(Shape::Ellipsoid)
        ];
        let bend = prop_oneof![Just(0.0), -1.5..1.5f64];
        let deform = prop_oneof![
            Just(Deform::NONE),
            (-2.0..2.0f64, 0.5..2.0f64, bend).prop_map(|(twist, taper, bend)| Deform {
                twist,
                taper,
                bend
            })
        ];
        let turn = [-3.0..3.0f64, -3.0..3.0f64, -3.0..3.0f64];
        (shapes, turn, deform, any::<bool>()).prop_map(|(shape, r, deform, round)| Element {
            shape,
            centre: DVec3::new(5.0, -9.0, 300.0),
            rotation: DQuat::from_scaled_axis(DVec3::from_array(r)),
            half: DVec3::new(20.0, if round { 20.0 } else { 31.0 }, 120.0),
            deform,
        })
    }

    proptest! {
        #[test]
        fn alignment_moves_nothing_and_never_departs(a in element(), b in element(),
                p in [-200.0..200.0f64, -200.0..200.0f64, -200.0..200.0f64]) {
            let mut others = [b.clone()];
            align(&a, &mut others);
            let p = b.centre + DVec3::from_array(p);
            let (before, after) = (b.distance(p), others[0].distance(p));
            prop_assert!(before.abs() < 1e-9 || (before < 0.0) == (after < 0.0));
            // far from a deformed body the distance is that of a box in its own axes
            if b.deform.is_none() || before < 0.0 {
                prop_assert!((before - after).abs() < 1e-9);
            }
            let apart = |e: &Element| log(a.rotation.conjugate() * e.rotation).length();
            prop_assert!(apart(&others[0]) <= apart(&b) + 1e-6);
            let again = others[0].clone();
            align(&a, &mut others);
            prop_assert!(log(again.rotation.conjugate() * others[0].rotation).length() < 1e-6);
        }

        #[test]
        fn a_block_is_never_far(r in [-3.0..3.0f64, -3.0..3.0f64, -3.0..3.0f64]) {
            let a = Element { shape: Shape::Block, centre: DVec3::ZERO, rotation: DQuat::IDENTITY,
                half: DVec3::new(1.0, 2.0, 3.0), deform: Deform::NONE };
            let mut others = [Element { rotation: DQuat::from_scaled_axis(DVec3::from_array(r)), ..a.clone() }];
            align(&a, &mut others);
            // the largest misorientation of two cubes (Mackenzie 1958)
            prop_assert!(log(others[0].rotation).length().to_degrees() < 62.81);
        }
    }
}
