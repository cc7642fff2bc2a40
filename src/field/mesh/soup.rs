//! From any triangle mesh to faces over welded points, each face once.

use super::MeshFieldError;
use crate::mesh::TriMesh;
use glam::DVec3;
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

/// One side of a face, with its ends in rising order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Side {
    pub a: u32,
    pub b: u32,
    pub face: u32,
    /// Whether the face runs from `a` to `b`.
    pub forward: bool,
}

/// All sides of all faces, sorted so that the sides of one edge are neighbours.
pub(super) fn sides(faces: &[[u32; 3]]) -> Vec<Side> {
    let mut out = Vec::with_capacity(faces.len() * 3);
    for (face, f) in faces.iter().enumerate() {
        for i in 0..3 {
            let (p, q) = (f[i], f[(i + 1) % 3]);
            out.push(Side { a: p.min(q), b: p.max(q), face: face as u32, forward: p < q });
        }
    }
    out.sort_unstable();
    out
}

/// Runs of sides that share an edge.
pub(super) fn edges(sides: &[Side]) -> impl Iterator<Item = &[Side]> {
    sides.chunk_by(|x, y| (x.a, x.b) == (y.a, y.b))
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
        let mut known: HashMap<[u64; 3], u32> = HashMap::new();
        let mut out = Vec::with_capacity(mesh.faces.len());
        for (index, face) in mesh.faces.iter().enumerate() {
            let mut welded = [0; 3];
            for (w, &v) in welded.iter_mut().zip(face) {
                let points = mesh.points.len();
                let Some(&p) = mesh.points.get(v as usize) else {
                    return Err(MeshFieldError::Corner { face: index, corner: v, points });
                };
                // squares and products of three lengths must stay finite
                if !p.abs().cmplt(DVec3::splat(1e60)).all() {
                    return Err(MeshFieldError::Coordinate { face: index, corner: v });
                }
                // adding zero turns -0 into 0
                let key = (p + DVec3::ZERO).to_array().map(f64::to_bits);
                *w = *known.entry(key).or_insert_with(|| {
                    self.points.push(p);
                    self.points.len() as u32 - 1
                });
            }
            let [a, b, c] = welded;
            if a == b || b == c || c == a { self.degenerate += 1 } else { out.push(welded) }
        }
        Ok(out)
    }

    /// Keeps the first of every set of faces with the same corners; what lay there in both
    /// directions is returned instead.
    fn single(&mut self, welded: &[[u32; 3]]) -> Vec<[u32; 3]> {
        let turn = |f: &[u32; 3]| {
            let first = (0..3).min_by_key(|&i| f[i]).unwrap_or(0);
            let (p, q) = (f[(first + 1) % 3], f[(first + 2) % 3]);
            ([f[first], p.min(q), p.max(q)], p < q)
        };
        let mut seen: HashMap<[u32; 3], [bool; 2]> = HashMap::new();
        for f in welded {
            let (key, forward) = turn(f);
            seen.entry(key).or_default()[usize::from(forward)] = true;
        }
        let mut double = vec![];
        for f in welded {
            // the first to come takes the entry
            match seen.remove(&turn(f).0) {
                Some([true, true]) => double.push(*f),
                Some(_) => self.faces.push(*f),
                None => self.duplicates += 1,
            }
        }
        double
    }

    /// Double faces are sheets, unless a patch of them closes a gap of the other faces, or itself:
    /// then it is wall, and only doubled for show.
    fn close_with(&mut self, double: Vec<[u32; 3]>) {
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
