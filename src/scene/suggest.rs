//! Shapes looked at before a recipe is written, and what was found as its entries.

use super::draft::step;
use super::live::Exact;
use super::{SceneError, Single};
use crate::element::{Element, Shape};
use crate::field::Shared;
use crate::job::{Job, check};
use crate::mesh::TriMesh;
use crate::num::Aabb;
use crate::parts::{self, Paired, Pose, Suggestion};
use crate::recipe::{
    BoxShape, CylinderShape, ElementEntry, FeatureEntry, GridEntry, Place, PlainOr, ShapeEntry,
};
use glam::{DVec3, EulerRot};
use std::collections::BTreeMap;
use std::path::Path;

/// Shapes looked at.
pub struct Looked {
    /// Names and entries; each entry now stands its shape in its pose.
    pub shapes: Vec<(String, ShapeEntry)>,
    /// What was found, in the order of the shapes.
    pub suggestion: Suggestion,
    /// The fields, where the files have them: not in their poses.
    pub fields: Vec<Shared>,
    /// The triangles, likewise.
    pub shells: Vec<TriMesh>,
    /// What was assumed and found on reading.
    pub notes: Vec<String>,
    /// The fields of meshes again with what was found on making them, where the pose only turns and shifts.
    pub(super) made: Vec<Option<Exact>>,
}

/// A member has to be this many cells thick, or it falls between samples where a hybrid makes it
/// thinner.
const CELLS: f64 = 2.0;
/// Nothing is made thicker than this share of the longest side: coarse cells fatten nothing.
const THICKEST: f64 = 0.02;

/// Reads shapes, finds their parts and stands each in its pose; `beside` is the folder paths are
/// relative to, `grid` what hybrids of them are sampled on. The entries' own `turn_deg`, `move` and
/// `place` are replaced. Meshes whose entries say nothing of it are thickened where they are too thin
/// for the grid; their entries say so then.
///
/// # Errors
/// What is wrong with an entry or a file; cancelled.
pub fn look(
    shapes: Vec<(String, ShapeEntry)>,
    beside: &Path,
    grid: &GridEntry,
    job: &dyn Job,
) -> Result<Looked, SceneError> {
    let (mut fields, mut shells, mut boxes) = (Vec::new(), Vec::new(), Vec::new());
    let (mut stood, mut notes, mut read) = (Vec::new(), Vec::new(), Vec::new());
    let mut all = Vec::new();
    for (name, entry) in shapes {
        check(job)?;
        job.stage(&format!("read {name}"));
        let kept = PlainOr::Plain(Place::Keep);
        let entry = ShapeEntry { turn_deg: 0.0, shift: [0.0; 3], place: kept, ..entry };
        let single = Single::open(&name, entry, &GridEntry::default(), beside)?;
        boxes.push(single.bounds());
        read.push((name, single));
    }
    let longest = boxes.iter().map(|b| b.size().max_element()).fold(0.0, f64::max);
    let thick = round((CELLS * step(grid, longest)).min(THICKEST * longest), 0.001);
    for (name, single) in read {
        check(job)?;
        job.stage(&format!("read {name}"));
        notes.extend(single.notes().iter().cloned());
        shells.push(single.shells()?);
        let plain = single.entry().clone();
        let single = single.no_thinner(thick);
        let thin = single.entry().clone();
        let made = single.exact(job)?;
        notes.extend_from_slice(&made.notes);
        fields.push(made.field.clone());
        stood.push((name, if made.thickened { thin } else { plain }));
        all.push(made);
    }
    job.stage("parts");
    let named: Vec<_> =
        stood.iter().zip(&fields).map(|((name, _), f)| (name.as_str(), &**f)).collect();
    let suggestion = parts::suggest(&named, job)?;
    for (((_, entry), guess), bounds) in stood.iter_mut().zip(&suggestion.shapes).zip(&boxes) {
        place(entry, &guess.pose, bounds);
    }
    // solids and surfaces are moved before their fields are made
    let poses = suggestion.shapes.iter().map(|g| g.pose.scale == 1.0);
    let still = stood.iter().zip(poses).map(|((_, e), same)| same && e.mesh.is_some());
    let made = all.into_iter().zip(still).map(|(made, still)| still.then_some(made)).collect();
    Ok(Looked { shapes: stood, suggestion, fields, shells, notes, made })
}

/// The suggested features as entries; lengths to a tenth of a millimetre.
pub fn features(suggestion: &Suggestion) -> Vec<FeatureEntry> {
    let names = || suggestion.shapes.iter().map(|s| s.name.clone());
    let entry = |f: &Paired| {
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
    if pose.scale != 1.0
        && let Some(PlainOr::Table(t)) = &mut entry.thicken
    {
        t.mm = round(t.mm * pose.scale, 0.001);
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
