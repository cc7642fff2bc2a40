//! What a mesh file holds, oddities included: counted, never refused.

use super::{
    TriMesh,
    edges::{Edges, face},
    weld::{Welding, welded},
};
use std::fmt;

/// Counts of what was found in a file. Edges, shells and duplicates are those after welding.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Found {
    /// Polygons with three corners.
    pub triangles: usize,
    /// Polygons with four.
    pub quads: usize,
    /// Polygons with more.
    pub larger: usize,
    /// Quads and larger ones with a corner that points inwards or lies on a straight side.
    pub concave: usize,
    /// Polygons that cross themselves or have no area, cut as well as can be.
    pub tangled: usize,
    /// Points in the file.
    pub points: usize,
    /// Points that no face uses; dropped.
    pub unreferenced: usize,
    /// Points merged into another at the same position.
    pub welded: usize,
    /// Faces without area. Those that lost a corner in welding are dropped, the others kept.
    pub degenerate: usize,
    /// Faces over the same three points as an earlier one; kept.
    pub duplicate: usize,
    /// The same, turned the other way; kept.
    pub flipped: usize,
    /// Edges with one face.
    pub open_edges: usize,
    /// Edges with more than two faces.
    pub crowded_edges: usize,
    /// Edges whose two faces run the same way, so that one of them is turned over.
    pub turned_edges: usize,
    /// Sets of faces that hang together by edges.
    pub shells: usize,
    /// Shells with an open edge.
    pub open_shells: usize,
    /// Triangles of the mesh as it was read.
    pub faces: usize,
}

/// Polygons by kind, as the reader met them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Polygons {
    pub triangles: usize,
    pub quads: usize,
    pub larger: usize,
    pub concave: usize,
    pub tangled: usize,
    /// Polygons with too few different corners for a triangle.
    pub nothing: usize,
}

impl Found {
    /// What there is in a mesh, taken as a file of triangles.
    pub fn of(mesh: &TriMesh) -> Self {
        let (clean, counts) = welded(mesh);
        let kinds = Polygons { triangles: mesh.faces.len(), ..Polygons::default() };
        Self::after(&clean, mesh.points.len(), kinds, counts)
    }

    /// The same for a mesh welded already.
    pub(super) fn after(mesh: &TriMesh, points: usize, kinds: Polygons, weld: Welding) -> Self {
        let mut found = Self {
            triangles: kinds.triangles,
            quads: kinds.quads,
            larger: kinds.larger,
            concave: kinds.concave,
            tangled: kinds.tangled,
            points,
            unreferenced: weld.unreferenced,
            welded: weld.merged,
            degenerate: kinds.nothing + weld.collapsed,
            faces: mesh.faces.len(),
            ..Self::default()
        };
        found.degenerate += (0..mesh.faces.len()).filter(|&i| is_flat(mesh, i)).count();
        found.count_edges(mesh);
        found
    }

    fn count_edges(&mut self, mesh: &TriMesh) {
        let edges = Edges::of(mesh);
        let (shell, count) = edges.shells();
        let mut open = vec![false; count];
        edges.each(|lo, hi, faces| {
            match *faces {
                [only] => {
                    self.open_edges += 1;
                    open[shell[face(only)] as usize] = true;
                }
                [a, b] => {
                    let same = edges.runs(face(a), lo, hi) == edges.runs(face(b), lo, hi);
                    self.turned_edges += usize::from(same);
                }
                _ => self.crowded_edges += 1,
            }
            if faces.len() > 1 {
                self.count_twins(mesh, &edges, lo, hi, faces);
            }
        });
        self.shells = count;
        self.open_shells = open.iter().filter(|&&o| o).count();
    }

    /// Faces that share all three points meet at each edge; they are counted at the edge of their
    /// two lowest points.
    fn count_twins(&mut self, mesh: &TriMesh, edges: &Edges, lo: u32, hi: u32, faces: &[u64]) {
        let third = |i: usize| mesh.faces[i].into_iter().find(|&v| v > hi);
        let mut here: Vec<(u32, usize)> =
            faces.iter().filter_map(|&e| third(face(e)).map(|v| (v, face(e)))).collect();
        here.sort_unstable();
        for same in here.chunk_by(|a, b| a.0 == b.0) {
            let forward = edges.runs(same[0].1, lo, hi);
            let alike = same.iter().filter(|s| edges.runs(s.1, lo, hi) == forward).count();
            self.duplicate += alike - 1;
            self.flipped += same.len() - alike;
        }
    }

    /// One or two lines for a person; what is zero is left out.
    pub fn summary(&self) -> String {
        let polygons = self.triangles + self.quads + self.larger;
        let kinds = [
            part(self.triangles, "triangle"),
            part(self.quads, "quad"),
            part(self.larger, "larger"),
            part(self.concave, "concave"),
            part(self.tangled, "tangled"),
        ];
        let corners = [self.triangles, self.quads, self.larger].iter().filter(|&&n| n > 0).count();
        let mut text = listed([
            if polygons == self.triangles {
                None
            } else if corners == 1 && self.larger + self.concave + self.tangled == 0 {
                part(self.quads, "quad")
            } else {
                part(polygons, "polygon").map(|p| format!("{p} ({})", listed(kinds)))
            },
            part(self.faces, "triangle"),
            part(self.points, "point"),
        ]);
        let open = part(self.open_shells, "open");
        if let Some(shells) = part(self.shells, "shell") {
            let open = open.map(|o| format!(" ({o})")).unwrap_or_default();
            text += &format!(", {shells}{open}");
        }
        let odd = listed([
            part(self.unreferenced, "unused point"),
            part(self.welded, "coinciding point"),
            part(self.degenerate, "degenerate face"),
            part(self.duplicate, "duplicate face"),
            part(self.flipped, "flipped duplicate face"),
            part(self.open_edges, "open edge"),
            part(self.crowded_edges, "edge with more than two faces"),
            part(self.turned_edges, "edge between faces that disagree in direction"),
        ]);
        if !odd.is_empty() {
            text += "\n";
            text += &odd;
        }
        text
    }
}

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.summary())
    }
}

/// A triangle on a line: twice its area is under 1e-12 of its longest side squared, some thousand
/// times the rounding of the cross product.
fn is_flat(mesh: &TriMesh, i: usize) -> bool {
    let [a, b, c] = mesh.corners(i);
    let longest =
        (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
    (b - a).cross(c - a).length() <= 1e-12 * longest
}

/// `1 edge with faces`, `2 edges with faces`; none for zero. Adjectives stay as they are.
fn part(count: usize, name: &str) -> Option<String> {
    let plural = match name.split_once(' ') {
        _ if count == 1 || ["larger", "concave", "tangled", "open"].contains(&name) => name.into(),
        Some(("edge", rest)) => format!("edges {rest}"),
        _ => format!("{name}s"),
    };
    (count > 0).then(|| format!("{count} {plural}"))
}

fn listed(parts: impl IntoIterator<Item = Option<String>>) -> String {
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn corners(n: u32) -> Vec<DVec3> {
        (0..n)
            .map(|i| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)))
            .collect()
    }

    /// A tetrahedron over the points 0, 1, 2, 4 of a cube.
    fn tetrahedron() -> TriMesh {
        TriMesh { points: corners(5), faces: vec![[0, 2, 1], [0, 1, 4], [1, 2, 4], [2, 0, 4]] }
    }

    #[test]
    fn a_clean_mesh_has_nothing_odd() {
        let mut mesh = tetrahedron();
        assert_eq!(Found::of(&mesh).unreferenced, 1);
        mesh = crate::mesh::weld(&mesh);
        let found = Found::of(&mesh);
        let clean = Found { triangles: 4, faces: 4, points: 4, shells: 1, ..Found::default() };
        assert_eq!(found, clean);
        assert_eq!(found.summary(), "4 triangles, 4 points, 1 shell");
    }

    #[test]
    fn every_oddity_is_counted() {
        let mut mesh = tetrahedron();
        mesh.append(&TriMesh {
            points: corners(8),
            faces: vec![
                [4, 5, 6],
                [5, 6, 7], // turned against the first
                [5, 4, 6], // the first, flipped
                [6, 4, 5], // the first again
                [7, 7, 5], // degenerate
            ],
        });
        mesh.points.push(DVec3::new(0.5, 0.0, 0.0));
        mesh.faces.push([0, 13, 1]); // on a line
        let found = Found::of(&mesh);
        assert_eq!((found.degenerate, found.duplicate, found.flipped), (2, 1, 1));
        // 4 sides of the two added triangles... of the quad only [5,7] and [6,7] are open, and
        // the flat triangle's two.
        assert_eq!(found.open_edges, 4);
        // [4,5], [4,6], [5,6] of the three twins, and [0,1] with the flat one.
        assert_eq!(found.crowded_edges, 4);
        assert_eq!((found.shells, found.open_shells), (2, 2));
        assert_eq!(found.unreferenced, 5);
        assert_eq!(found.welded, 1, "point 4 of both");
        mesh.faces.truncate(6);
        assert_eq!(Found::of(&mesh).turned_edges, 1);
    }

    #[test]
    fn the_summary_counts_in_words() {
        let found = Found {
            quads: 1,
            larger: 2,
            concave: 1,
            points: 9,
            faces: 8,
            shells: 2,
            open_shells: 1,
            crowded_edges: 2,
            flipped: 1,
            ..Found::default()
        };
        assert_eq!(
            found.to_string(),
            "3 polygons (1 quad, 2 larger, 1 concave), 8 triangles, 9 points, 2 shells (1 open)\n\
             1 flipped duplicate face, 2 edges with more than two faces"
        );
    }
}
