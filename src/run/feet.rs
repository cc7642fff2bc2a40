//! Whether the feet of a hybrid's shapes stand on the floor in its mesh.

use crate::check::Part;
use crate::mesh::TriMesh;
use crate::morph::Foot;
use crate::num::Aabb;
use glam::DVec3;
use serde::Serialize;

/// Feet that a hybrid should have, and those that its largest piece has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Feet {
    /// Those of the shapes that weigh most where they are.
    pub wanted: usize,
    /// Those of them that reach the floor.
    pub standing: usize,
}

/// What lies within this share of the height from the lowest point stands on the floor.
const FLOOR: f64 = 0.02;
/// A foot may be this many cells off, beside the share of the height.
const CELLS: f64 = 2.0;

impl Feet {
    /// Counts the feet of a mesh of these [`parts`](crate::check::parts), whose cells were `cell` mm
    /// wide.
    pub fn of(mesh: &TriMesh, parts: &(Vec<u32>, Vec<Part>), wanted: &[Foot], cell: f64) -> Self {
        let (labels, parts) = parts;
        let volume = |i: usize| parts.get(i).map_or(0.0, |p| p.volume_mm3);
        let main = (0..parts.len()).max_by(|&a, &b| volume(a).total_cmp(&volume(b))).unwrap_or(0);
        let bounds = parts.get(main).map_or(Aabb::EMPTY, |p| p.bounds);
        let slack = FLOOR * bounds.size().z;
        let low = bounds.min.z + slack.max(cell);
        let own = mesh.faces.iter().zip(labels).filter(|(_, part)| **part as usize == main);
        let corners = own.flat_map(|(f, _)| f.iter().filter_map(|&v| mesh.points.get(v as usize)));
        let floor: Vec<DVec3> = corners.copied().filter(|p| p.z <= low).collect();
        let stands = |f: &&Foot| {
            let reach = f.reach + slack + CELLS * cell;
            floor.iter().any(|p| p.truncate().distance(f.at.truncate()) <= reach)
        };
        Self { wanted: wanted.len(), standing: wanted.iter().filter(stands).count() }
    }

    /// In words: `4 of 4 feet on the floor`.
    pub fn story(&self) -> String {
        format!("{} of {} feet on the floor", self.standing, self.wanted)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::parts;
    use crate::element::{Element, tessellate};

    #[test]
    fn feet_that_hang_or_belong_to_a_lesser_piece_do_not_stand() {
        let rod = |x: f64, low: f64, top: f64, r| {
            let e = Element::rod(DVec3::new(x, 0.0, low), DVec3::new(x, 0.0, top), r).unwrap();
            tessellate(&e, 12).unwrap()
        };
        let mut mesh = rod(0.0, 0.0, 500.0, 30.0);
        mesh.append(&rod(200.0, 0.0, 400.0, 10.0));
        let foot = |x: f64| Foot { at: DVec3::new(x, 0.0, 0.0), reach: 12.0 };
        let feet =
            Feet::of(&mesh, &parts(&mesh), &[foot(0.0), foot(25.0), foot(200.0), foot(90.0)], 4.0);
        assert_eq!(feet, Feet { wanted: 4, standing: 2 });
        assert_eq!(feet.story(), "2 of 4 feet on the floor");
        let (none, parts) = (TriMesh::default(), Default::default());
        assert_eq!(Feet::of(&none, &parts, &[foot(0.0)], 1.0).standing, 0);
    }
}
