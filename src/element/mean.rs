use super::{Element, Shape};
use crate::warp::Deform;
use glam::{DMat4, DQuat, DVec3, DVec4};

/// The weighted mean of corresponding elements (METHODS H): centre linear, half sizes in the
/// logarithm, rotation by the Karcher mean, twist and bend linear, taper in the logarithm; unlike
/// shapes mix. Weights need not sum to one; negative ones count as zero.
///
/// A plain mean: relabel symmetric elements with [`super::align`] first, once. Only one element
/// with a weight is returned as it is. Nothing at all gives a unit block.
pub fn average(elements: &[(&Element, f64)]) -> Element {
    let sum: f64 = elements.iter().map(|e| e.1.max(0.0)).sum();
    let even = 1.0 / elements.len().max(1) as f64;
    let parts: Vec<(&Element, f64)> = elements
        .iter()
        .map(|&(e, w)| (e, if sum > 0.0 { w.max(0.0) / sum } else { even }))
        .filter(|&(_, w)| w > 0.0)
        .collect();
    match parts.as_slice() {
        [] => unit(),
        [(only, _)] => (*only).clone(),
        several => mean(several),
    }
}

fn unit() -> Element {
    Element {
        shape: Shape::Block,
        centre: DVec3::ZERO,
        rotation: DQuat::IDENTITY,
        half: DVec3::ONE,
        deform: Deform::NONE,
    }
}

fn mean(parts: &[(&Element, f64)]) -> Element {
    let linear = |f: &dyn Fn(&Element) -> f64| parts.iter().map(|(e, w)| w * f(e)).sum::<f64>();
    let logs: DVec3 = parts.iter().map(|(e, w)| *w * e.half.map(f64::ln)).sum();
    let turns: Vec<(DQuat, f64)> = parts.iter().map(|(e, w)| (e.rotation, *w)).collect();
    // sameness is kept to the last bit, so that like elements map onto each other exactly
    let (first, _) = parts[0];
    let same = |f: &dyn Fn(&Element) -> bool| parts.iter().all(|(e, _)| f(e));
    Element {
        shape: mix(parts),
        centre: parts.iter().map(|(e, w)| *w * e.centre).sum(),
        rotation: if same(&|e| e.rotation == first.rotation) {
            first.rotation
        } else {
            mean_rotation(&turns)
        },
        half: if same(&|e| e.half == first.half) { first.half } else { logs.map(f64::exp) },
        deform: if same(&|e| e.deform == first.deform) {
            first.deform
        } else {
            Deform {
                twist: linear(&|e| e.deform.twist),
                taper: linear(&|e| e.deform.taper.ln()).exp(),
                bend: linear(&|e| e.deform.bend),
            }
        },
    }
}

/// One shape if all are alike, else their mix with like parts merged.
fn mix(parts: &[(&Element, f64)]) -> Shape {
    let mut merged: Vec<(Shape, f64)> = Vec::new();
    let mut add = |shape: &Shape, w: f64| match merged.iter_mut().find(|m| m.0 == *shape) {
        Some(m) => m.1 += w,
        None => merged.push((shape.clone(), w)),
    };
    for (e, w) in parts {
        match &e.shape {
            Shape::Mix(inner) => inner.iter().for_each(|(s, v)| add(s, v * w)),
            plain => add(plain, *w),
        }
    }
    match merged.as_slice() {
        [(one, _)] => one.clone(),
        _ => Shape::Mix(merged),
    }
}

/// Whether the elements' rotations are too far apart for a mean that is the only one: some lies
/// about a right angle or more from the mean of all (METHODS H). To be asked after
/// [`super::align`].
pub fn ambiguous(elements: &[&Element]) -> bool {
    // At a right angle the mean is no longer unique; a little less and a degree's change of pose
    // still throws it far.
    const MOST: f64 = 85.0 / 180.0 * std::f64::consts::PI;
    let even = 1.0 / elements.len().max(1) as f64;
    let turns: Vec<(DQuat, f64)> = elements.iter().map(|e| (e.rotation, even)).collect();
    let mean = mean_rotation(&turns);
    turns.iter().any(|(q, _)| log(mean.conjugate() * *q).length() > MOST)
}

/// Karcher mean: the m with sum w log(m⁻¹ q) = 0, by fixed-point steps from the chordal mean.
/// For two rotations it is the spherical interpolation between them.
pub(super) fn mean_rotation(turns: &[(DQuat, f64)]) -> DQuat {
    let mut m = chordal(turns);
    for _ in 0..100 {
        let back = m.conjugate();
        let step: DVec3 = turns.iter().map(|&(q, w)| w * log(back * q)).sum();
        m = (m * DQuat::from_scaled_axis(step)).normalize();
        if step.length_squared() < 1e-30 {
            break;
        }
    }
    m
}

/// Top eigenvector of sum w q qᵀ (Markley et al. 2007), blind to the quaternions' signs.
fn chordal(turns: &[(DQuat, f64)]) -> DQuat {
    let mut m = turns.iter().fold(DMat4::ZERO, |m, (q, w)| {
        let v = DVec4::from(*q);
        m + DMat4::from_cols(v * v.x, v * v.y, v * v.z, v * v.w) * *w
    });
    // squaring 40 times separates eigenvalues that differ by one part in 10^11
    for _ in 0..40 {
        m = m * m;
        let trace = m.x_axis.x + m.y_axis.y + m.z_axis.z + m.w_axis.w;
        if trace <= 0.0 || trace.is_nan() {
            return DQuat::IDENTITY;
        }
        m *= 1.0 / trace;
    }
    let columns = [m.x_axis, m.y_axis, m.z_axis, m.w_axis];
    let longest = columns
        .into_iter()
        .fold(DVec4::ZERO, |a, b| if b.length_squared() > a.length_squared() { b } else { a });
    DQuat::from_vec4(longest).normalize()
}

/// Axis times angle of the shorter way round.
pub(super) fn log(q: DQuat) -> DVec3 {
    let q = if q.w < 0.0 { -q } else { q };
    let v = q.xyz();
    let s = v.length();
    if s < 1e-150 { 2.0 * v } else { v * (2.0 * s.atan2(q.w) / s) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::align;
    use proptest::prelude::*;

    fn turn() -> impl Strategy<Value = DQuat> {
        [-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64]
            .prop_filter("too short to have a direction", |q| {
                q.iter().map(|x| x * x).sum::<f64>() > 0.01
            })
            .prop_map(|q| DQuat::from_array(q).normalize())
    }

    fn element() -> impl Strategy<Value = Element> {
        let place = [-300.0..300.0f64, -300.0..300.0f64, 0.0..900.0f64];
        let half = [20.0..60.0f64, 20.0..60.0f64, 100.0..300.0f64];
        let deform = (-1.0..1.0f64, 0.5..2.0f64, -1.0..1.0f64);
        (place, turn(), half, deform).prop_map(|(c, q, h, (twist, taper, bend))| Element {
            shape: Shape::Block,
            centre: DVec3::from_array(c),
            // within 60 degrees of upright, as the features of like objects are
            rotation: DQuat::IDENTITY.slerp(q, 0.33),
            half: DVec3::from_array(h),
            deform: Deform { twist, taper, bend },
        })
    }

    fn angle(a: DQuat, b: DQuat) -> f64 {
        log(a.conjugate() * b).length()
    }

    proptest! {
        #[test]
        fn two_rotations_are_interpolated_spherically(a in turn(), b in turn(), t in 0.0..1.0f64) {
            prop_assume!(angle(a, b) < 3.0);
            // b expressed by the angle from a: exp(t log(a⁻¹ b))
            let slerp = a * DQuat::from_scaled_axis(t * log(a.conjugate() * b));
            prop_assert!(angle(mean_rotation(&[(a, 1.0 - t), (b, t)]), slerp) < 1e-12);
            prop_assert!(angle(mean_rotation(&[(a, 1.0 - t), (-b, t)]), slerp) < 1e-12);
        }

        #[test]
        fn order_does_not_matter(a in element(), b in element(), c in element()) {
            let m = average(&[(&a, 1.0), (&b, 2.0), (&c, 0.5)]);
            let n = average(&[(&c, 0.5), (&a, 1.0), (&b, 2.0)]);
            prop_assert!(m.centre.distance(n.centre) < 1e-10);
            prop_assert!(m.half.distance(n.half) < 1e-10);
            prop_assert!(angle(m.rotation, n.rotation) < 1e-12);
            prop_assert!((m.deform.taper - n.deform.taper).abs() < 1e-12);
        }

        #[test]
        fn one_weight_returns_the_element(a in element(), b in element()) {
            prop_assert_eq!(&average(&[(&a, 0.0), (&b, 3.0)]), &b);
            let twice = average(&[(&a, 0.3), (&a, 0.7)]);
            prop_assert_eq!(twice.rotation, a.rotation);
            prop_assert_eq!(twice.half, a.half);
        }

        #[test]
        fn the_karcher_mean_balances(a in element(), b in element(), c in element()) {
            let turns = [(a.rotation, 0.2), (b.rotation, 0.5), (c.rotation, 0.3)];
            let m = mean_rotation(&turns);
            let rest: DVec3 = turns.iter().map(|&(q, w)| w * log(m.conjugate() * q)).sum();
            prop_assert!(rest.length() < 1e-13);
        }
    }

    #[test]
    fn sizes_average_in_the_logarithm_and_shapes_mix() {
        let a = Element { half: DVec3::new(10.0, 10.0, 100.0), ..unit() };
        let b = Element { half: DVec3::new(40.0, 10.0, 100.0), shape: Shape::Cylinder, ..unit() };
        let m = average(&[(&a, 1.0), (&b, 1.0)]);
        assert!((m.half.x - 20.0).abs() < 1e-12);
        assert_eq!(m.shape, Shape::Mix(vec![(Shape::Block, 0.5), (Shape::Cylinder, 0.5)]));
        assert_eq!(average(&[(&m, 1.0), (&m, 2.0)]).shape, m.shape);
    }

    #[test]
    fn opposite_rotations_are_ambiguous() {
        let up = unit();
        let over = Element { rotation: DQuat::from_rotation_x(std::f64::consts::PI), ..unit() };
        let tilted = Element { rotation: DQuat::from_rotation_x(1.0), ..unit() };
        assert!(ambiguous(&[&up, &over]));
        assert!(!ambiguous(&[&up, &tilted]));
        // a block upside down is the same block
        let mut others = [over];
        align(&up, &mut others);
        assert!(!ambiguous(&[&up, &others[0]]));
    }
}
