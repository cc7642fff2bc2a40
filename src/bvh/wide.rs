//! The tree as points walk it: nodes of eight boxes, leaves of up to eight triangles, both in
//! lanes, so that a step of the walk is one pass of vector arithmetic.
//!
//! The arithmetic is that of [`Tri::distance2`], operation by operation, and never fused: whatever
//! the width of the machine's vectors, a distance comes out with the same bits.

use super::Node;
use super::limits::{Limit, Limits};
use super::triangle::{LANES, Lanes, Points, Tri, Way};
use crate::num::Aabb;
use fearless_simd::{Simd, f64x8, prelude::*};
use glam::DVec3;
use rayon::prelude::*;

/// Set in a child's number where it is a pack and not a node.
const PACK: u32 = 1 << 31;

/// Eight boxes. Lanes without a child are empty boxes, infinitely far from everything.
#[derive(Clone, Debug)]
struct Eight {
    lo: [[f64; LANES]; 3],
    hi: [[f64; LANES]; 3],
    child: [u32; LANES],
}

/// Up to eight triangles; the last one fills the lanes left over.
#[derive(Clone, Debug)]
pub(super) struct Pack {
    pub(super) lanes: Lanes,
    /// Slot of the first.
    pub(super) first: u32,
    count: u32,
}

/// The tree of eights over the triangles of a [`super::Bvh`].
#[derive(Clone, Debug, Default)]
pub(super) struct Wide {
    nodes: Vec<Eight>,
    packs: Vec<Pack>,
    root: Option<u32>,
}

/// Several points, and what can be nearest to one of them.
pub(super) struct Known<S: Simd> {
    /// Their middle, in every lane.
    pub(super) middle: Points<S>,
    /// Their box.
    pub(super) bounds: Aabb,
    /// Squared distance from the box beyond which nothing counts.
    pub(super) edge2: f64,
    /// What else counts.
    pub(super) limits: Limits<S>,
}

impl<S: Simd> Known<S> {
    #[inline(always)]
    pub(super) fn new(s: S, middle: Points<S>, bounds: Aabb, limit: &Limit) -> Self {
        Self { middle, bounds, edge2: limit.edge2, limits: Limits::one(s, limit) }
    }

    /// Less can be nearest than was thought.
    #[inline(always)]
    pub(super) fn narrow(&mut self, s: S, limit: &Limit) {
        (self.edge2, self.limits) = (limit.edge2, Limits::one(s, limit));
    }
}

/// Who walks the tree for the nearest triangles of several points.
pub(super) trait Seek<S: Simd> {
    /// What is known of the points.
    fn known(&self) -> &Known<S>;
    /// Takes the triangles of a pack whose bits are set, by the ways from them; `false` ends the walk.
    fn take(&mut self, pack: &Pack, way: &Way<S>, bits: u64) -> bool;
}

/// What a walk still has to look at: squared distance of the box, and its child.
pub(super) type Open = Vec<(f64, u32)>;

impl Eight {
    const NONE: Self = Self {
        lo: [[f64::INFINITY; LANES]; 3],
        hi: [[f64::NEG_INFINITY; LANES]; 3],
        child: [PACK; LANES],
    };

    fn set(&mut self, lane: usize, b: &Aabb, child: u32) {
        for a in 0..3 {
            self.lo[a][lane] = b.min[a];
            self.hi[a][lane] = b.max[a];
        }
        self.child[lane] = child;
    }

    /// Squared distances of the boxes from a box.
    #[inline(always)]
    fn gaps2<S: Simd>(&self, s: S, lo: DVec3, hi: DVec3) -> f64x8<S> {
        let zero = f64x8::splat(s, 0.0);
        let axis = |a: usize| {
            let below = f64x8::from_slice(s, &self.lo[a]) - f64x8::splat(s, hi[a]);
            let above = f64x8::splat(s, lo[a]) - f64x8::from_slice(s, &self.hi[a]);
            below.max(above).max(zero)
        };
        let (x, y, z) = (axis(0), axis(1), axis(2));
        x * x + y * y + z * z
    }

    /// The ways from the boxes to a point.
    #[inline(always)]
    fn ways<S: Simd>(&self, p: &Points<S>) -> Way<S> {
        let s = p.x.token();
        let zero = f64x8::splat(s, 0.0);
        let axis = |p: f64x8<S>, a: usize| {
            let above = (p - f64x8::from_slice(s, &self.hi[a])).max(zero);
            let below = (p - f64x8::from_slice(s, &self.lo[a])).min(zero);
            above + below
        };
        let (x, y, z) = (axis(p.x, 0), axis(p.y, 1), axis(p.z, 2));
        Way { length2: x * x + y * y + z * z, along: [x, y, z] }
    }
}

impl Wide {
    /// Memory that it takes, bytes.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.packs[..])
    }

    /// From the binary tree and its triangles in slots.
    pub(super) fn new(nodes: &[Node], tris: &[Tri]) -> Self {
        let mut wide = Self::default();
        if !nodes.is_empty() {
            let nodes = halved(nodes);
            let spans = spans(&nodes);
            let mut packs = vec![];
            wide.root = Some(wide.build(&nodes, &spans, &mut packs));
            let pack = |&[first, count]: &[u32; 2]| {
                let lanes = Lanes::of(&tris[first as usize..(first + count) as usize]);
                Pack { lanes, first, count }
            };
            wide.packs = packs.par_iter().map(pack).collect();
        }
        wide
    }

    /// Lays out the nodes; `packs` gets first slot and number of triangles of each pack.
    fn build(&mut self, nodes: &[Node], spans: &[[u32; 2]], packs: &mut Vec<[u32; 2]>) -> u32 {
        let small = |i: usize| spans[i][1] as usize <= LANES;
        let mut pack = |span| {
            packs.push(span);
            PACK | (packs.len() as u32 - 1)
        };
        if small(0) {
            return pack(spans[0]);
        }
        self.nodes.push(Eight::NONE);
        let mut open = vec![(0usize, 0usize)];
        while let Some((place, top)) = open.pop() {
            let mut children = vec![top];
            // the largest child is opened until there are eight
            while children.len() < LANES {
                let area = |i: usize| half_area(&nodes[i].bounds);
                let large = (0..children.len()).filter(|&c| !small(children[c]));
                let Some(c) =
                    large.max_by(|&c, &d| area(children[c]).total_cmp(&area(children[d])))
                else {
                    break;
                };
                let first = nodes[children[c]].first as usize;
                children[c] = first;
                children.insert(c + 1, first + 1);
            }
            for (lane, &c) in children.iter().enumerate() {
                let child = if small(c) {
                    pack(spans[c])
                } else {
                    open.push((self.nodes.len(), c));
                    self.nodes.push(Eight::NONE);
                    self.nodes.len() as u32 - 1
                };
                self.nodes[place].set(lane, &nodes[c].bounds, child);
            }
        }
        0
    }

    /// Least squared distance up to that of `known`, and its slot (`u32::MAX` for none). The result
    /// is the minimum over all triangles exactly: pruning leaves room for round-off.
    #[inline(always)]
    pub(super) fn closest<S: Simd>(
        &self,
        s: S,
        p: DVec3,
        known: (f64, u32),
        slack: f64,
        open: &mut Open,
    ) -> (f64, u32) {
        if !p.is_finite() {
            return known;
        }
        // an empty lane is infinitely far, and is not looked at even so
        let limit = |d2: f64| (d2.sqrt() + slack).powi(2).min(f64::MAX);
        let (mut best, mut slot) = known;
        let mut edge = limit(best);
        let lanes = Points::one(s, p);
        open.clear();
        open.extend(self.root.map(|root| (0.0, root)));
        while let Some((d2, child)) = open.pop() {
            if d2 > edge {
                continue;
            }
            if child & PACK == 0 {
                let node = &self.nodes[child as usize];
                open_near(open, node.gaps2(s, p, p), edge, &node.child);
                continue;
            }
            let pack = &self.packs[(child & !PACK) as usize];
            let d2 = pack.lanes.distances2(s, &lanes);
            let least = f64x8::splat(s, best);
            let mut bits =
                if slot == u32::MAX { d2.simd_le(least) } else { d2.simd_lt(least) }.to_bitmask();
            let d2: [f64; LANES] = d2.into();
            while bits != 0 {
                let lane = bits.trailing_zeros();
                bits &= bits - 1;
                let d2 = d2[lane as usize];
                if d2 < best || slot == u32::MAX {
                    (best, slot) = (d2, pack.first + lane.min(pack.count - 1));
                    edge = limit(best);
                }
            }
        }
        (best, slot)
    }

    /// Shows the seeker every triangle that can be nearest to one of its points, those near the middle
    /// first; whether it saw them all.
    #[inline(always)]
    pub(super) fn seek<S: Simd>(&self, s: S, seeker: &mut impl Seek<S>, open: &mut Open) -> bool {
        open.clear();
        open.extend(self.root.map(|root| (0.0, root)));
        while let Some((gap2, child)) = open.pop() {
            if gap2 > seeker.known().edge2 {
                continue;
            }
            if child & PACK == 0 {
                let node = &self.nodes[child as usize];
                let Aabb { min, max } = seeker.known().bounds;
                let gap2 = node.gaps2(s, min, max);
                let near = gap2.simd_le(f64x8::splat(s, seeker.known().edge2)).to_bitmask();
                let way = node.ways(&seeker.known().middle);
                let bits = near & seeker.known().limits.can_win(&way);
                open_some(open, way.length2, gap2, bits, &node.child);
                continue;
            }
            let pack = &self.packs[(child & !PACK) as usize];
            let way = pack.lanes.ways(s, &seeker.known().middle);
            let bits = seeker.known().limits.can_win(&way) & ((1 << pack.count) - 1);
            if bits != 0 && !seeker.take(pack, &way, bits) {
                return false;
            }
        }
        true
    }

    /// Slots of the packs within `reach` of a box.
    #[inline(always)]
    pub(super) fn gather<S: Simd>(
        &self,
        s: S,
        b: &Aabb,
        reach: f64,
        open: &mut Open,
        out: &mut Vec<u32>,
    ) {
        out.clear();
        open.clear();
        open.extend(self.root.map(|root| (0.0, root)));
        let reach2 = (reach * reach).min(f64::MAX);
        while let Some((_, child)) = open.pop() {
            if child & PACK == 0 {
                let node = &self.nodes[child as usize];
                let mut bits =
                    node.gaps2(s, b.min, b.max).simd_le(f64x8::splat(s, reach2)).to_bitmask();
                while bits != 0 {
                    let lane = bits.trailing_zeros() as usize;
                    bits &= bits - 1;
                    open.push((0.0, node.child[lane]));
                }
                continue;
            }
            let pack = &self.packs[(child & !PACK) as usize];
            out.extend(pack.first..pack.first + pack.count);
        }
    }
}

/// Puts the children that are near enough on the pile, the nearest on top.
#[inline(always)]
fn open_near<S: Simd>(open: &mut Open, d2: f64x8<S>, edge: f64, child: &[u32; LANES]) {
    open_some(open, d2, d2, d2.simd_le(f64x8::splat(d2.token(), edge)).to_bitmask(), child);
}

/// Puts some of the children on the pile, that with the least `order` on top.
#[inline(always)]
fn open_some<S: Simd>(
    open: &mut Open,
    order: f64x8<S>,
    d2: f64x8<S>,
    mut bits: u64,
    child: &[u32; LANES],
) {
    let (order, d2): ([f64; LANES], [f64; LANES]) = (order.into(), d2.into());
    let from = open.len();
    let mut keys = [0.0; LANES];
    while bits != 0 {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits - 1;
        let mut at = open.len();
        open.push((0.0, 0));
        while at > from && keys[at - 1 - from] < order[lane] {
            open[at] = open[at - 1];
            keys[at - from] = keys[at - 1 - from];
            at -= 1;
        }
        open[at] = (d2[lane], child[lane]);
        keys[at - from] = order[lane];
    }
}

/// The nodes, with no leaf of more triangles than there are lanes.
fn halved(nodes: &[Node]) -> Vec<Node> {
    let mut nodes = nodes.to_vec();
    let mut i = 0;
    while i < nodes.len() {
        let node = nodes[i];
        if node.count as usize > LANES {
            let half = node.count / 2;
            let first = nodes.len() as u32;
            nodes.push(Node { count: half, ..node });
            nodes.push(Node { first: node.first + half, count: node.count - half, ..node });
            nodes[i] = Node { first, count: 0, ..node };
        }
        i += 1;
    }
    nodes
}

/// First slot and number of triangles under each node.
fn spans(nodes: &[Node]) -> Vec<[u32; 2]> {
    let mut spans = vec![[0; 2]; nodes.len()];
    for (i, node) in nodes.iter().enumerate().rev() {
        let first = node.first as usize;
        spans[i] = if node.count > 0 {
            [node.first, node.count]
        } else {
            let [a, b] = [spans[first], spans[first + 1]];
            [a[0].min(b[0]), a[1] + b[1]]
        };
    }
    spans
}

fn half_area(b: &Aabb) -> f64 {
    let s = b.size();
    s.x * s.y + s.y * s.z + s.z * s.x
}
