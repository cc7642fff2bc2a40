//! Recipe primitives -> elements.

use crate::element::{Element, ElementError, Shape};
use crate::recipe::{Part, Primitive, Problem};
use crate::warp::Deform;
use glam::{DQuat, DVec2, DVec3, EulerRot};

/// Degrees about x, then y, then z, as a rotation.
pub(super) fn rotation(deg: [f64; 3]) -> DQuat {
    let [x, y, z] = deg.map(f64::to_radians);
    // extrinsic x, y, z: the point is turned about the fixed axes in that order
    DQuat::from_euler(EulerRot::XYZEx, x, y, z)
}

/// The element of a primitive, deformed along its axis; `at` is the primitive's key.
pub(super) fn element(p: Primitive<'_>, deform: Deform, at: &str) -> Result<Element, Problem> {
    build(p).and_then(|e| e.deformed(deform)).map_err(|e| Problem::new(at, e.to_string()))
}

fn build(p: Primitive<'_>) -> Result<Element, ElementError> {
    let v = DVec3::from_array;
    match p {
        Primitive::Box(b) => Element::block(v(b.center), v(b.size) * 0.5, rotation(b.rotate_deg)),
        Primitive::Cylinder(c) => Element::rod(v(c.from), v(c.to), c.radius),
        Primitive::Capsule(c) => Element::capsule(v(c.from), v(c.to), c.radius),
        Primitive::Ellipsoid(e) => {
            let half = v(e.size) * 0.5;
            Element::new(Shape::Ellipsoid, v(e.center), rotation(e.rotate_deg), half, Deform::NONE)
        }
        Primitive::Prism(p) => {
            let turn = rotation(p.rotate_deg);
            let mut corners: Vec<DVec2> = p.polygon.iter().copied().map(DVec2::from).collect();
            if area(&corners) < 0.0 {
                corners.reverse();
            }
            // the element's box is centred on the polygon's own, its polygon fills the unit square
            let low = corners.iter().fold(DVec2::INFINITY, |m, c| m.min(*c));
            let high = corners.iter().fold(DVec2::NEG_INFINITY, |m, c| m.max(*c));
            let (middle, half) = ((low + high) * 0.5, (high - low) * 0.5);
            for c in &mut corners {
                *c = ((*c - middle) / half).clamp(DVec2::NEG_ONE, DVec2::ONE);
            }
            let centre = v(p.center) + turn * middle.extend(0.0);
            let half = half.extend(p.height * 0.5);
            Element::new(Shape::prism(&corners)?, centre, turn, half, Deform::NONE)
        }
    }
}

/// Twice the signed area; positive counter-clockwise.
fn area(p: &[DVec2]) -> f64 {
    let next = p.iter().cycle().skip(1);
    p.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum()
}

/// The deformation of a part, radians.
pub(super) fn deform(twist_deg: f64, taper: f64, bend_deg: f64) -> Deform {
    Deform { twist: twist_deg.to_radians(), taper, bend: bend_deg.to_radians() }
}

/// The element of a solid's part and its rounding, mm; `at` is the part's key.
pub(super) fn part(p: &Part, at: &str) -> Result<(Element, f64), Problem> {
    let primitive = p.primitive(at)?;
    let deform = deform(p.twist_deg, p.taper, p.bend_deg);
    let element = element(primitive, deform, &format!("{at}.{}", primitive.key()))?;
    Ok((element, primitive.round()))
}
