//! The surface's patches in a cell, for each of the 256 ways its corners can be inside.
//!
//! Corner n of a cell stands at (n & 1, n >> 1 & 1, n >> 2 & 1). An edge is named by its axis and
//! its lower corner. On every face of a cell the surface cuts off each run of inside corners by
//! one segment, so inside corners that only share a diagonal are separated: inside is 6-connected,
//! outside 18-connected. Two cells see the same segments on their common face. The segments of a
//! cell join into loops; each loop bounds one patch.

use std::sync::LazyLock;

/// An edge of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Edge {
    /// Its direction: 0, 1, 2 for x, y, z.
    pub axis: u8,
    /// The corner it starts from.
    pub corner: u8,
}

impl Edge {
    /// The corner it ends at.
    pub(super) fn end(self) -> u8 {
        self.corner | 1 << self.axis
    }
}

/// The loops of a cell, counter-clockwise seen from outside.
#[derive(Clone, Debug, Default)]
pub(super) struct Patches {
    edges: Vec<Edge>,
    /// One past the last edge of every loop.
    ends: Vec<usize>,
}

impl Patches {
    /// The loops, each of three or more edges.
    pub(super) fn loops(&self) -> impl Iterator<Item = &[Edge]> {
        let starts = std::iter::once(&0).chain(&self.ends);
        starts.zip(&self.ends).map(|(&from, &to)| &self.edges[from..to])
    }

    /// Number of loops.
    pub(super) fn count(&self) -> usize {
        self.ends.len()
    }

    fn new(config: u8) -> Self {
        let next = chain(config);
        let mut seen = [false; 12];
        let mut patches = Self::default();
        for start in 0..12 {
            let from = patches.edges.len();
            let mut at = start;
            while let Some(to) = next[at]
                && !seen[at]
            {
                seen[at] = true;
                patches.edges.push(EDGES[at]);
                at = to;
            }
            if patches.edges.len() > from {
                patches.ends.push(patches.edges.len());
            }
        }
        patches
    }
}

/// All edges of a cell.
const EDGES: [Edge; 12] = {
    let mut edges = [Edge { axis: 0, corner: 0 }; 12];
    let mut n = 0;
    while n < 12 {
        let axis = (n / 4) as u8;
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        edges[n] = Edge { axis, corner: ((n & 1) << u | (n >> 1 & 1) << v) as u8 };
        n += 1;
    }
    edges
};

/// The corners of each face, counter-clockwise seen from outside the cell.
fn faces() -> [[u8; 4]; 6] {
    std::array::from_fn(|n| {
        let (axis, high) = (n / 2, n % 2);
        let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
        let base = (high << axis) as u8;
        if high == 1 {
            [base, base | u, base | u | v, base | v]
        } else {
            [base, base | v, base | u | v, base | u]
        }
    })
}

/// The index in [`EDGES`] of the edge between two corners.
fn edge_between(a: u8, b: u8) -> Option<usize> {
    EDGES.iter().position(|e| (e.corner, e.end()) == (a.min(b), a.max(b)))
}

/// For every edge that the surface crosses, the next one of its loop.
///
/// Going round a face, each run of inside corners is entered over one edge and left over another;
/// the segment leads from the first to the second. The next face goes over a common edge the other
/// way, so every crossed edge is entered once and left once.
fn chain(config: u8) -> [Option<usize>; 12] {
    let inside = |corner: u8| config >> corner & 1 == 1;
    let mut next = [None; 12];
    for face in faces() {
        let corner = |n: usize| face[n % 4];
        for n in 0..4 {
            if inside(corner(n)) || !inside(corner(n + 1)) {
                continue;
            }
            let run = (2..5).find(|&m| !inside(corner(n + m))).unwrap_or(4);
            let enter = edge_between(corner(n), corner(n + 1));
            let leave = edge_between(corner(n + run - 1), corner(n + run));
            if let Some(enter) = enter {
                next[enter] = leave;
            }
        }
    }
    next
}

/// The patches by configuration: bit n is set where corner n is inside.
pub(super) static PATCHES: LazyLock<[Patches; 256]> =
    LazyLock::new(|| std::array::from_fn(|config| Patches::new(config as u8)));

#[cfg(test)]
mod tests {
    use super::{EDGES, Edge, PATCHES, faces};
    use std::collections::BTreeSet;

    fn crossed(config: usize, e: Edge) -> bool {
        (config >> e.corner & 1) != (config >> e.end() & 1)
    }

    /// The directed segments of a cell on one of its faces, as pairs of edges.
    fn segments(config: usize, face: [u8; 4]) -> BTreeSet<[[u8; 2]; 2]> {
        let on = |e: Edge| face.contains(&e.corner) && face.contains(&e.end());
        let name = |e: Edge| [e.corner, e.end()];
        let mut found = BTreeSet::new();
        for l in PATCHES[config].loops() {
            for (n, &a) in l.iter().enumerate() {
                let b = l[(n + 1) % l.len()];
                if on(a) && on(b) {
                    found.insert([name(a), name(b)]);
                }
            }
        }
        found
    }

    #[test]
    fn every_crossed_edge_is_in_one_loop_once() {
        for config in 0..256 {
            let p = &PATCHES[config];
            let mut all: Vec<_> = p.loops().flatten().map(|e| (e.axis, e.corner)).collect();
            all.sort_unstable();
            let mut want: Vec<_> = EDGES.iter().filter(|&&e| crossed(config, e)).collect();
            want.sort_unstable_by_key(|e| (e.axis, e.corner));
            assert_eq!(all, want.iter().map(|e| (e.axis, e.corner)).collect::<Vec<_>>());
            assert!(p.loops().all(|l| (3..=12).contains(&l.len())) && p.count() <= 4);
        }
        assert_eq!(PATCHES[0b0110_1001].count(), 4);
    }

    /// Over all pairs of neighbours: what one cell sees on the common face the other sees reversed.
    #[test]
    fn neighbours_agree_on_their_common_face() {
        for axis in 0..3 {
            let [low, high] = [faces()[2 * axis], faces()[2 * axis + 1]];
            for a in 0..256 {
                for b in 0..256 {
                    let same = high.iter().all(|&c| (a >> c & 1) == (b >> (c ^ 1 << axis) & 1));
                    if same {
                        let mine = segments(a, high);
                        let theirs: BTreeSet<_> = segments(b, low)
                            .into_iter()
                            .map(|[p, q]| [q, p].map(|e| e.map(|c| c | 1 << axis)))
                            .collect();
                        assert_eq!(mine, theirs, "axis {axis}, {a:08b}, {b:08b}");
                    }
                }
            }
        }
    }

    #[test]
    fn inside_corners_on_a_diagonal_are_separate() {
        assert_eq!(PATCHES[0b0000_1001].count(), 2);
        assert_eq!(PATCHES[0b1000_0001].count(), 2);
        // the outside corners 0 and 3 of a face are joined
        assert_eq!(PATCHES[0b1111_0110].count(), 1);
    }
}
