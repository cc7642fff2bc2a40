//! Closed meshes as feature elements.

use super::elements::rotation;
use crate::element::{Element, Form, Shape};
use crate::field::Field;
use crate::field::mesh::{MeshField, MeshOptions};
use crate::job::Job;
use crate::mesh::{Assume, Unit, Up, read};
use crate::num::Aabb;
use crate::recipe::{ElementShape, FeatureEntry, MeshShape, Problem, join};
use crate::warp::Deform;
use glam::DVec3;
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;
use std::sync::Arc;

/// The mesh in normal coordinates: its box is the unit box.
struct MeshForm {
    field: MeshField,
    centre: DVec3,
    half: DVec3,
}

impl fmt::Debug for MeshForm {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("MeshForm").field("centre", &self.centre).finish_non_exhaustive()
    }
}

impl Form for MeshForm {
    fn distance(&self, q: DVec3) -> f64 {
        // the map stretches by at most the longest half side, so this stays 1-Lipschitz in q
        self.field.value(self.centre + q * self.half) / self.half.max_element()
    }
    fn bounds(&self) -> Aabb {
        Aabb::around(DVec3::ZERO, DVec3::ONE)
    }
}

/// The elements of all features that are meshes, by their keys.
pub(super) fn read_all(
    features: &[FeatureEntry],
    beside: &Path,
    job: &dyn Job,
) -> Result<BTreeMap<String, Element>, Problem> {
    let mut all = BTreeMap::new();
    for (i, f) in features.iter().enumerate() {
        for (shape, entry) in &f.on {
            let at = join(&format!("features[{i}].on"), shape);
            if let ElementShape::Mesh(m) = entry.shape(&at)? {
                let element = element(m, beside, job)
                    .map_err(|why| Problem::new(format!("{at}.mesh"), why))?;
                all.insert(at, element);
            }
        }
    }
    Ok(all)
}

fn element(m: &MeshShape, beside: &Path, job: &dyn Job) -> Result<Element, String> {
    let assume = Assume { up: Some(Up::Z), unit: Some(Unit::Mm) };
    let mesh = read(&beside.join(&m.file), assume).map_err(|e| e.to_string())?.mesh;
    let own = mesh.bounds();
    let (field, _) =
        MeshField::new(&mesh, &MeshOptions::default(), job).map_err(|e| e.to_string())?;
    let half = own.size() * 0.5;
    if half.min_element() <= 0.0 {
        return Err(format!("{}: a flat mesh is no element", m.file.display()));
    }
    let form = MeshForm { field, centre: own.centre(), half };
    let centre = m.center.map_or(own.centre(), DVec3::from_array);
    let size = m.size.map_or(half, |s| DVec3::from_array(s) * 0.5);
    let shape = Shape::Mesh(Arc::new(form));
    Element::new(shape, centre, rotation(m.rotate_deg), size, Deform::NONE)
        .map_err(|e| e.to_string())
}
