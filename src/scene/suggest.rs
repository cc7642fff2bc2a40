//! Suggested parts as entries of a recipe.

use crate::element::{Element, Shape};
use crate::num::Aabb;
use crate::parts::{Pose, Suggestion};
use crate::recipe::{
    BoxShape, CylinderShape, ElementEntry, FeatureEntry, Place, PlainOr, ShapeEntry,
};
use glam::{DVec3, EulerRot};
use std::collections::BTreeMap;

/// The suggested features as entries; lengths to a tenth of a millimetre.
pub fn features(suggestion: &Suggestion) -> Vec<FeatureEntry> {
    let names = || suggestion.shapes.iter().map(|s| s.name.clone());
    let entry = |f: &crate::parts::Paired| {
        let on: Option<BTreeMap<_, _>> =
            names().zip(&f.elements).map(|(name, e)| Some((name, element(e)?))).collect();
        Some(FeatureEntry { name: f.name.clone(), on: on?, ..FeatureEntry::default() })
    };
    suggestion.features.iter().filter_map(entry).collect()
}

/// Makes a shape stand in its pose: by its height, its turn and a shift. `bounds` is the box round
/// the shape as the entry had it, which must leave it where its file does.
pub fn place(entry: &mut ShapeEntry, pose: &Pose, bounds: &Aabb) {
    if pose.scale != 1.0 {
        entry.height = Some(round(bounds.size().z * pose.scale, 0.01));
    }
    entry.turn_deg = round(pose.turn.to_degrees(), 0.01);
    entry.place = PlainOr::Plain(Place::Keep);
    entry.shift = pose.shift.to_array().map(|x| round(x, 0.01));
}

/// An element as an entry; none for forms that are never suggested.
fn element(e: &Element) -> Option<ElementEntry> {
    let mut entry = ElementEntry::default();
    match e.shape {
        Shape::Block => {
            let (x, y, z) = e.rotation.to_euler(EulerRot::XYZEx);
            entry.box_shape = Some(BoxShape {
                center: lengths(e.centre),
                size: lengths(2.0 * e.half),
                rotate_deg: [x, y, z].map(|a| round(a.to_degrees(), 0.1)),
                round: 0.0,
            });
        }
        Shape::Cylinder => {
            let axis = e.rotation * (DVec3::Z * e.half.z);
            entry.cylinder = Some(CylinderShape {
                from: lengths(e.centre - axis),
                to: lengths(e.centre + axis),
                radius: round(e.half.x.max(e.half.y), 0.1),
                round: 0.0,
            });
        }
        _ => return None,
    }
    if e.deform.taper != 1.0 {
        entry.taper = Some(round(e.deform.taper, 0.001));
    }
    Some(entry)
}

fn lengths(v: DVec3) -> [f64; 3] {
    v.to_array().map(|x| round(x, 0.1))
}

/// To a multiple of a power of ten, never minus nought.
fn round(x: f64, unit: f64) -> f64 {
    let per = (1.0 / unit).round();
    (x * per).round() / per + 0.0
}
