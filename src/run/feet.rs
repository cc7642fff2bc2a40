//! Whether the feet of a hybrid's shapes stand on the floor in its mesh.

use crate::mesh::{TriMesh, shells};
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
    /// Counts the feet of a mesh whose cells were `cell` mm wide.
    pub fn of(mesh: &TriMesh, wanted: &[Foot], cell: f64) -> Self {
        let main = largest(mesh);
        let bounds = Aabb::of(main.iter().copied());
        let slack = FLOOR * bounds.size().z;
        let low = bounds.min.z + slack.max(cell);
        let floor: Vec<DVec3> = main.into_iter().filter(|p| p.z <= low).collect();
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

/// The corners of the piece with the largest volume.
fn largest(mesh: &TriMesh) -> Vec<DVec3> {
    let (of_face, count) = shells(mesh);
    let corners = |f: &[u32; 3]| f.map(|v| mesh.points[v as usize]);
    let mut volumes = vec![0.0; count];
    for (f, &piece) in mesh.faces.iter().zip(&of_face) {
        let [a, b, c] = corners(f);
        volumes[piece as usize] += a.dot(b.cross(c));
    }
    let main = (0..count).max_by(|&a, &b| volumes[a].total_cmp(&volumes[b])).unwrap_or(0);
    let own = mesh.faces.iter().zip(&of_face).filter(|(_, p)| **p as usize == main);
    own.flat_map(|(f, _)| corners(f)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
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
        let feet = Feet::of(&mesh, &[foot(0.0), foot(25.0), foot(200.0), foot(90.0)], 4.0);
        assert_eq!(feet, Feet { wanted: 4, standing: 2 });
        assert_eq!(feet.story(), "2 of 4 feet on the floor");
        assert_eq!(Feet::of(&TriMesh::default(), &[foot(0.0)], 1.0).standing, 0);
    }
}
