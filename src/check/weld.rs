//! Points joined where their coordinates are the same bits.

use crate::mesh::{TriMesh, twins};
use glam::DVec3;
use rayon::prelude::*;
use std::borrow::Cow;

/// A mesh whose points are distinct and all used: often the very mesh it was made from.
pub(super) struct Welded<'a> {
    pub points: Cow<'a, [DVec3]>,
    /// As many as the mesh has, in its order.
    pub faces: Cow<'a, [[u32; 3]]>,
    /// Faces that named a point the mesh does not have; they stand as `[0, 0, 0]`.
    pub astray: usize,
}

impl<'a> Welded<'a> {
    /// A mesh whose points are distinct and all used.
    pub fn whole(mesh: &'a TriMesh) -> Self {
        let TriMesh { points, faces } = mesh;
        Self { points: Cow::from(points), faces: Cow::from(faces), astray: 0 }
    }

    /// Whether it is the very mesh it was made from.
    pub fn is_whole(&self) -> bool {
        matches!((&self.points, &self.faces), (Cow::Borrowed(_), Cow::Borrowed(_)))
    }
}

/// Joins points with the same coordinates (-0 counts as 0) and leaves out unused ones; the
/// points that stay keep their order.
pub(super) fn weld(mesh: &TriMesh) -> Welded<'_> {
    let total = mesh.points.len();
    let missing = |f: &[u32; 3]| f.iter().any(|&v| v as usize >= total);
    let mut used = vec![false; total];
    let mut astray = 0;
    for f in &mesh.faces {
        if missing(f) {
            astray += 1;
        } else {
            f.iter().for_each(|&v| used[v as usize] = true);
        }
    }
    let first = twins(&mesh.points, &used);
    let alone = |(v, &first): (usize, &u32)| used[v] && first as usize == v;
    if astray == 0 && first.par_iter().enumerate().all(alone) {
        return Welded::whole(mesh);
    }
    let mut points = Vec::new();
    let mut name = vec![0_u32; total];
    for v in 0..total {
        let f = first[v] as usize;
        if f == v && used[v] {
            name[v] = points.len() as u32;
            points.push(mesh.points[v]);
        } else if f != v {
            name[v] = name[f];
        }
    }
    if points.is_empty() && !mesh.faces.is_empty() {
        points.push(DVec3::ZERO);
    }
    let rename = |f: &[u32; 3]| {
        if missing(f) { [0; 3] } else { f.map(|v| name[v as usize]) }
    };
    let faces: Vec<_> = mesh.faces.par_iter().map(rename).collect();
    Welded { points: points.into(), faces: faces.into(), astray }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joins_equal_points_and_drops_unused_ones() {
        let p = |x: f64| DVec3::new(x, 1.0, 2.0);
        let mesh = TriMesh {
            points: vec![p(9.0), p(0.0), p(1.0), p(2.0), p(-0.0), p(3.0)],
            faces: vec![[1, 2, 3], [4, 3, 5], [0, 1, 77]],
        };
        let w = weld(&mesh);
        assert_eq!(w.points[..], [0.0, 1.0, 2.0, 3.0].map(p));
        assert_eq!(w.faces[..], [[0, 1, 2], [0, 2, 3], [0, 0, 0]]);
        assert_eq!(w.astray, 1);
        let clean = TriMesh { points: w.points.to_vec(), faces: w.faces[..2].to_vec() };
        let w = weld(&clean);
        assert_eq!((&w.points[..], &w.faces[..]), (&clean.points[..], &clean.faces[..]));
    }
}
