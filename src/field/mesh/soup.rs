//! From any triangle mesh to faces over welded points, each face once.

use super::MeshFieldError;
use crate::mesh::{TriMesh, twins};
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

/// One side of a face, among those from the same lower end: its higher end, its face, and whether the
/// face runs from the lower end to the higher one, in one number. Sides compare in that order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Side(u64);

impl Side {
    fn high(self) -> u32 {
        (self.0 >> 32) as u32
    }

    pub(super) fn face(self) -> u32 {
        self.0 as u32 >> 1
    }

    /// Whether the face runs from the lower end to the higher one.
    pub(super) fn forward(self) -> bool {
        self.0 & 1 == 1
    }
}

/// All sides of all faces, those of one edge together.
pub(super) struct Sides {
    /// Where the sides from each point to higher ones start, and the end of all.
    starts: Vec<usize>,
    sides: Vec<Side>,
}

impl Sides {
    pub(super) fn of(faces: &[[u32; 3]]) -> Self {
        let side = |(i, &f): (usize, &[u32; 3])| {
            [0, 1, 2].map(|k| {
                let (p, q) = (f[k], f[(k + 1) % 3]);
                let own = (i as u64) << 1 | u64::from(p < q);
                (p.min(q), Side(u64::from(p.max(q)) << 32 | own))
            })
        };
        let (starts, mut sides) = sorted(faces.iter().enumerate().flat_map(side), faces);
        starts.windows(2).for_each(|w| sides[w[0]..w[1]].sort_unstable());
        Self { starts, sides }
    }

    /// The ends of each edge in rising order, with its sides, in order.
    pub(super) fn edges(&self) -> impl Iterator<Item = ([u32; 2], &[Side])> {
        self.starts.windows(2).enumerate().flat_map(|(low, w)| {
            let same = self.sides[w[0]..w[1]].chunk_by(|x, y| x.high() == y.high());
            same.map(move |sides| ([low as u32, sides[0].high()], sides))
        })
    }
}

/// Things by the points of the faces that they are at: where those at each point start, and the end of
/// all; the things, those at one point in their order.
fn sorted<T: Copy + Default>(
    things: impl Iterator<Item = (u32, T)> + Clone,
    faces: &[[u32; 3]],
) -> (Vec<usize>, Vec<T>) {
    let points = faces.iter().flatten().max().map_or(0, |&v| v as usize + 1);
    // room for the end of each point's things is two places on, so that it is its start in the end
    let mut starts = vec![0; points + 2];
    things.clone().for_each(|(v, _)| starts[v as usize + 2] += 1);
    for v in 2..starts.len() {
        starts[v] += starts[v - 1];
    }
    let mut out = vec![T::default(); starts[points + 1]];
    for (v, thing) in things {
        let place = &mut starts[v as usize + 1];
        out[*place] = thing;
        *place += 1;
    }
    starts.pop();
    (starts, out)
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
        // by the lowest corner: the other two, the face, and which way round it runs
        let key = |(i, f): (usize, &[u32; 3])| {
            let [a, b, c] = *f;
            let turned = if a < b && a < c {
                [a, b, c]
            } else if b < c {
                [b, c, a]
            } else {
                [c, a, b]
            };
            let [low, p, q] = turned;
            (low, (u64::from(p.min(q)) << 32 | u64::from(p.max(q)), i as u32, p < q))
        };
        let (starts, mut keys) = sorted(welded.iter().enumerate().map(key), welded);
        // what becomes of a face: the first of its corners stays, single or double
        let mut kept = vec![None; welded.len()];
        for w in starts.windows(2) {
            let keys = &mut keys[w[0]..w[1]];
            keys.sort_unstable();
            for same in keys.chunk_by(|x, y| x.0 == y.0) {
                let both = same.iter().any(|k| k.2) && same.iter().any(|k| !k.2);
                kept[same[0].1 as usize] = Some(both);
                self.duplicates += same.len() - 1;
            }
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
        let sides = Sides::of(&all);
        let mut patches = Sets::new(all.len());
        for (_, edge) in sides.edges() {
            let mut doubled = edge.iter().map(|s| s.face()).filter(|&f| f >= ours);
            if let (Some(x), Some(y), None) = (doubled.next(), doubled.next(), doubled.next()) {
                patches.join(x, y);
            }
        }
        // per patch: border edges that would close a gap, less those that would not
        let mut votes: HashMap<u32, i64> = HashMap::new();
        for (_, edge) in sides.edges() {
            let mut own: HashMap<u32, usize> = HashMap::new();
            let rest = edge.iter().filter(|s| s.face() < ours).count();
            for s in edge.iter().filter(|s| s.face() >= ours) {
                *own.entry(patches.find(s.face())).or_default() += 1;
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

#[cfg(test)]
mod tests {
    use super::Sides;
    use std::collections::BTreeMap;

    #[test]
    fn edges_come_in_order_with_all_their_sides() {
        // a strip whose faces turn both ways, and a fan at one point
        let strip =
            (0..50u32).map(|i| if i % 3 == 0 { [i + 2, i + 1, i] } else { [i, i + 1, i + 2] });
        let fan = (0..20u32).map(|i| [60, 5 + (7 * i) % 40, 6 + (7 * i) % 40]);
        let faces: Vec<_> = strip.chain(fan).collect();
        let mut want: BTreeMap<[u32; 2], Vec<(u32, bool)>> = BTreeMap::new();
        for (i, f) in faces.iter().enumerate() {
            for k in 0..3 {
                let (p, q) = (f[k], f[(k + 1) % 3]);
                want.entry([p.min(q), p.max(q)]).or_default().push((i as u32, p < q));
            }
        }
        let sides = Sides::of(&faces);
        let found = sides.edges().map(|(ends, sides)| {
            (ends, sides.iter().map(|s| (s.face(), s.forward())).collect::<Vec<_>>())
        });
        assert_eq!(found.collect::<Vec<_>>(), want.into_iter().collect::<Vec<_>>());
        assert_eq!(Sides::of(&[]).edges().count(), 0);
    }
}
