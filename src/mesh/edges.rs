//! Which faces meet at which edges, by sorting; and the shells that hang together by edges.

use super::TriMesh;

/// Every undirected edge with its faces. Indices of the mesh must be in range.
pub(super) struct Edges<'a> {
    mesh: &'a TriMesh,
    starts: Vec<usize>,
    /// By lower end point: the higher one (upper half) and the face (lower half), sorted.
    spans: Vec<u64>,
}

impl<'a> Edges<'a> {
    pub fn of(mesh: &'a TriMesh) -> Self {
        let sides = || {
            mesh.faces.iter().enumerate().flat_map(|(i, f)| {
                (0..3).map(move |k| (f[k].min(f[(k + 1) % 3]), f[k].max(f[(k + 1) % 3]), i))
            })
        };
        let mut starts = vec![0usize; mesh.points.len() + 1];
        sides().for_each(|(lo, _, _)| starts[lo as usize + 1] += 1);
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut spans = vec![0; mesh.faces.len() * 3];
        for (lo, hi, face) in sides() {
            let at = &mut next[lo as usize];
            spans[*at] = u64::from(hi) << 32 | face as u64;
            *at += 1;
        }
        for w in starts.windows(2) {
            spans[w[0]..w[1]].sort_unstable();
        }
        Self { mesh, starts, spans }
    }

    /// Calls back with each edge: lower end, higher end, its faces as [`face`] reads them. A face
    /// that uses an edge twice is there twice.
    pub fn each(&self, mut look: impl FnMut(u32, u32, &[u64])) {
        for (lo, w) in self.starts.windows(2).enumerate() {
            for faces in self.spans[w[0]..w[1]].chunk_by(|a, b| a >> 32 == b >> 32) {
                look(lo as u32, (faces[0] >> 32) as u32, faces);
            }
        }
    }

    /// Whether a face runs from `from` to `to`, not back.
    pub fn runs(&self, face: usize, from: u32, to: u32) -> bool {
        let f = self.mesh.faces[face];
        (0..3).any(|k| f[k] == from && f[(k + 1) % 3] == to)
    }

    /// The shell of each face and how many there are, numbered by their first face.
    pub fn shells(&self) -> (Vec<u32>, usize) {
        let mut parent: Vec<u32> = (0..self.mesh.faces.len() as u32).collect();
        self.each(|_, _, faces| {
            for &other in &faces[1..] {
                let (a, b) = (root(&mut parent, face(faces[0])), root(&mut parent, face(other)));
                // The lower number wins, so a root is the first face of its shell.
                parent[a.max(b)] = a.min(b) as u32;
            }
        });
        let mut count = 0;
        let mut shell = vec![0; parent.len()];
        for i in 0..parent.len() {
            let r = root(&mut parent, i);
            if r == i {
                shell[i] = count;
                count += 1;
            } else {
                shell[i] = shell[r];
            }
        }
        (shell, count as usize)
    }
}

/// The face of an entry that [`Edges::each`] hands out.
pub(super) fn face(entry: u64) -> usize {
    (entry & 0xFFFF_FFFF) as usize
}

fn root(parent: &mut [u32], mut i: usize) -> usize {
    while parent[i] as usize != i {
        parent[i] = parent[parent[i] as usize];
        i = parent[i] as usize;
    }
    i
}

/// The shell of each face, numbered by first face, and how many shells there are. Faces of one
/// shell hang together by edges; weld first, else seams divide.
pub fn shells(mesh: &TriMesh) -> (Vec<u32>, usize) {
    Edges::of(mesh).shells()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn a_shared_corner_does_not_join() {
        let mesh = TriMesh {
            points: vec![DVec3::ZERO; 7],
            faces: vec![[0, 1, 2], [4, 5, 6], [2, 3, 4], [3, 2, 1]],
        };
        assert_eq!(shells(&mesh), (vec![0, 1, 0, 0], 2));
        assert_eq!(shells(&TriMesh::default()), (vec![], 0));
    }

    #[test]
    fn every_edge_once_with_all_its_faces() {
        let mesh =
            TriMesh { points: vec![DVec3::ZERO; 5], faces: vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]] };
        let edges = Edges::of(&mesh);
        let mut seen = vec![];
        edges.each(|lo, hi, faces| seen.push((lo, hi, faces.len())));
        assert_eq!(
            seen,
            [(0, 1, 3), (0, 2, 1), (0, 3, 1), (0, 4, 1), (1, 2, 1), (1, 3, 1), (1, 4, 1)]
        );
        assert!(edges.runs(0, 0, 1) && !edges.runs(1, 0, 1));
    }
}
