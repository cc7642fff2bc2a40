//! From any triangle mesh to faces over welded points, each face once.

use super::MeshFieldError;
use crate::mesh::{TriMesh, twins};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashMap;

/// Faces over points that differ from each other.
#[derive(Debug, Default)]
pub(super) struct Soup {
    pub points: Vec<DVec3>,
    pub faces: Vec<[u32; 3]>,
    /// Faces that lay there in both directions and close no gap of the others: sheets.
    pub double: Vec<[u32; 3]>,
    /// Faces dropped because another has the same corners.
    pub duplicates: usize,
    /// Faces dropped because two corners coincide.
    pub degenerate: usize,
}

/// One side of a face. Sides compare by their ends, then by face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Side {
    /// The lower end and the higher one, in one number.
    edge: u64,
    pub face: u32,
    /// Whether the face runs from the lower end to the higher one.
    pub forward: bool,
}

impl Side {
    /// The side from `p` to `q`.
    fn new(p: u32, q: u32, face: u32) -> Self {
        Self { edge: u64::from(p.min(q)) << 32 | u64::from(p.max(q)), face, forward: p < q }
    }

    /// Its ends, in rising order.
    pub(super) fn ends(self) -> [u32; 2] {
        [(self.edge >> 32) as u32, self.edge as u32]
    }
}

/// All sides of all faces, sorted so that the sides of one edge are neighbours.
pub(super) fn sides(faces: &[[u32; 3]]) -> Vec<Side> {
    let mut out = Vec::with_capacity(faces.len() * 3);
    for (face, &[a, b, c]) in faces.iter().enumerate() {
        let face = face as u32;
        out.extend([Side::new(a, b, face), Side::new(b, c, face), Side::new(c, a, face)]);
    }
    out.par_sort_unstable();
    out
}

/// Runs of sides that share an edge.
pub(super) fn edges(sides: &[Side]) -> impl Iterator<Item = &[Side]> {
    sides.chunk_by(|x, y| x.edge == y.edge)
}

/// Disjoint sets of small numbers.
pub(super) struct Sets(Vec<u32>);

impl Sets {
    pub(super) fn new(n: usize) -> Self {
        Self((0..n as u32).collect())
    }

    pub(super) fn find(&mut self, mut x: u32) -> u32 {
        while self.0[x as usize] != x {
            let up = self.0[self.0[x as usize] as usize];
            self.0[x as usize] = up;
            x = up;
        }
        x
    }

    /// Joins two sets; the smaller root stays.
    pub(super) fn join(&mut self, x: u32, y: u32) {
        let (x, y) = (self.find(x), self.find(y));
        self.0[x.max(y) as usize] = x.min(y);
    }
}

impl Soup {
    /// # Errors
    /// No faces with three different corners; a corner that is missing or not finite.
    pub(super) fn new(mesh: &TriMesh) -> Result<Self, MeshFieldError> {
        if mesh.faces.is_empty() {
            return Err(MeshFieldError::Empty { faces: 0 });
        }
        let mut soup = Self::default();
        let welded = soup.weld(mesh)?;
        if welded.is_empty() {
            return Err(MeshFieldError::Empty { faces: mesh.faces.len() });
        }
        let double = soup.single(&welded);
        soup.close_with(double);
        Ok(soup)
    }

    /// Gives equal positions one index and drops faces that lose a corner by it.
    fn weld(&mut self, mesh: &TriMesh) -> Result<Vec<[u32; 3]>, MeshFieldError> {
        let points = mesh.points.len();
        let mut used = vec![false; points];
        for (face, &corners) in mesh.faces.iter().enumerate() {
            for corner in corners {
                let Some(p) = mesh.points.get(corner as usize) else {
                    return Err(MeshFieldError::Corner { face, corner, points });
                };
                // squares and products of three lengths must stay finite
                if !p.abs().cmplt(DVec3::splat(1e60)).all() {
                    return Err(MeshFieldError::Coordinate { face, corner });
                }
                used[corner as usize] = true;
            }
        }
        let twin = twins(&mesh.points, &used);
        let mut place = vec![u32::MAX; points];
        let mut out = Vec::with_capacity(mesh.faces.len());
        for face in &mesh.faces {
            let [a, b, c] = face.map(|v| {
                let first = twin[v as usize] as usize;
                if place[first] == u32::MAX {
                    place[first] = self.points.len() as u32;
                    self.points.push(mesh.points[v as usize]);
                }
                place[first]
            });
            if a == b || b == c || c == a { self.degenerate += 1 } else { out.push([a, b, c]) }
        }
        Ok(out)
    }

    /// Keeps the first of every set of faces with the same corners; what lay there in both
    /// directions is returned instead.
    fn single(&mut self, welded: &[[u32; 3]]) -> Vec<[u32; 3]> {
        let key = |(i, f): (usize, &[u32; 3])| {
            let mut corners = *f;
            corners.sort_unstable();
            let first = f.iter().position(|&v| v == corners[0]).unwrap_or(0);
            (corners, i as u32, f[(first + 1) % 3] == corners[1])
        };
        let mut keys: Vec<_> = welded.par_iter().enumerate().map(key).collect();
        keys.par_sort_unstable();
        // what becomes of a face: the first of its corners stays, single or double
        let mut kept = vec![None; welded.len()];
        for same in keys.chunk_by(|x, y| x.0 == y.0) {
            let both = same.iter().any(|k| k.2) && same.iter().any(|k| !k.2);
            kept[same[0].1 as usize] = Some(both);
            self.duplicates += same.len() - 1;
        }
        let mut double = vec![];
        for (f, kept) in welded.iter().zip(kept) {
            match kept {
                Some(true) => double.push(*f),
                Some(false) => self.faces.push(*f),
                None => {}
            }
        }
        double
    }

    /// Double faces are sheets, unless a patch of them closes a gap of the other faces, or itself:
    /// then it is wall, and only doubled for show.
    fn close_with(&mut self, double: Vec<[u32; 3]>) {
        if double.is_empty() {
            return;
        }
        let ours = self.faces.len() as u32;
        let all: Vec<_> = self.faces.iter().chain(&double).copied().collect();
        let sides = sides(&all);
        let mut patches = Sets::new(all.len());
        for edge in edges(&sides) {
            let mut doubled = edge.iter().filter(|s| s.face >= ours).map(|s| s.face);
            if let (Some(x), Some(y), None) = (doubled.next(), doubled.next(), doubled.next()) {
                patches.join(x, y);
            }
        }
        // per patch: border edges that would close a gap, less those that would not
        let mut votes: HashMap<u32, i64> = HashMap::new();
        for edge in edges(&sides) {
            let mut own: HashMap<u32, usize> = HashMap::new();
            let rest = edge.iter().filter(|s| s.face < ours).count();
            for s in edge.iter().filter(|s| s.face >= ours) {
                *own.entry(patches.find(s.face)).or_default() += 1;
            }
            for (patch, n) in own {
                let vote = if n % 2 == 0 {
                    0
                } else if rest % 2 == 1 {
                    1
                } else {
                    -1
                };
                *votes.entry(patch).or_default() += vote;
            }
        }
        for (i, f) in double.into_iter().enumerate() {
            let patch = patches.find(ours + i as u32);
            let wall = votes.get(&patch).is_some_and(|&v| v >= 0);
            if wall { self.faces.push(f) } else { self.double.push(f) }
        }
    }
}
