//! The tree over boxes, also where many of them are one.
//!
//! The builder joins what fits best; among thousands of boxes that fit equally well it finds one pair a
//! round, and takes as many rounds as there are boxes. Boxes that are nearly the same are therefore
//! bundled before and parted after, half by half: no other order would be better.
//!
//! The builder works on one thread. Many boxes are therefore parted first, from the root down, and the
//! builder joins those of each part; where they are parted depends on the boxes alone.

use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::{Bvh2, builder::build_bvh2, node::Bvh2Node};
use rayon::prelude::*;

/// Boxes nearly the same of which there may be so many without being a crowd. Fewer would bundle what
/// real meshes have: both triangles of a flat side, fans at a pole.
const CROWD: usize = 32;
/// Corners are nearly the same in steps of this part of the box's size: far above what rounding parts
/// copies by, far below what a tree could part.
const STEP: f32 = 1.0 / 4096.0;
/// Most primitives of a leaf of a bundle; as the builder has them.
const LEAF: u32 = 8;

/// Boxes that are not parted further.
const PART: usize = 1 << 14;
/// Stretches of an axis between which they may be.
const BINS: usize = 16;

/// The tree over some boxes.
pub fn hierarchy(boxes: &[Aabb], params: BvhBuildParams) -> Bvh2 {
    let bundles = if crowded(boxes) { bundles(boxes) } else { vec![] };
    // a bundle for each box is none
    if bundles.len() == boxes.len() || bundles.is_empty() {
        return grown(boxes, params);
    }
    let hull = |bundle: &Vec<u32>| {
        let all = bundle.iter().map(|&i| boxes[i as usize]);
        all.fold(Aabb::empty(), |hull, b| hull.union(&b))
    };
    let hulls: Vec<Aabb> = bundles.iter().map(hull).collect();
    let mut tree = grown(&hulls, params);
    unpack(&mut tree, &bundles, boxes);
    tree
}

/// The tree over boxes without crowds.
fn grown(boxes: &[Aabb], params: BvhBuildParams) -> Bvh2 {
    let parts = if boxes.len() > PART { parted(boxes) } else { None };
    let Some([a, b]) = parts else {
        return build_bvh2(boxes, params, &mut Default::default());
    };
    let grow = |part: &[u32]| {
        let own: Vec<Aabb> = part.iter().map(|&i| boxes[i as usize]).collect();
        let mut tree = grown(&own, params);
        tree.primitive_indices.iter_mut().for_each(|i| *i = part[*i as usize]);
        tree
    };
    let (a, b) = rayon::join(|| grow(&a), || grow(&b));
    joined(a, b)
}

/// Boxes whose middles lie in some stretch of an axis.
#[derive(Clone, Copy)]
struct Bin {
    hull: Aabb,
    count: usize,
}

impl Bin {
    fn with(self, other: &Self) -> Self {
        let count = self.count + other.count;
        Self { hull: if count == 0 { self.hull } else { self.hull.union(&other.hull) }, count }
    }

    /// What a box costs that is met as often as its area is large, for each thing in it.
    fn cost(&self) -> f32 {
        if self.count == 0 { 0.0 } else { self.hull.half_area() * self.count as f32 }
    }
}

/// Boxes in two parts by their middles, each of them a quarter at least, of least area for what is in
/// them; none where the middles tell nothing apart.
fn parted(boxes: &[Aabb]) -> Option<[Vec<u32>; 2]> {
    let middles =
        boxes.iter().fold(Aabb::empty(), |all, b| all.union(&Aabb::from_point(b.center())));
    let scale = Vec3A::splat(BINS as f32) / middles.diagonal();
    let places = |b: &Aabb| {
        let place = (b.center() - middles.min) * scale;
        place.to_array().map(|x| (x as usize).min(BINS - 1))
    };
    let none = Bin { hull: Aabb::empty(), count: 0 };
    let mut bins = [[none; BINS]; 3];
    for b in boxes {
        for (bins, place) in bins.iter_mut().zip(places(b)) {
            bins[place] = bins[place].with(&Bin { hull: *b, count: 1 });
        }
    }
    let mut best: Option<(f32, usize, usize)> = None;
    for (axis, bins) in bins.iter().enumerate() {
        for cut in 1..BINS {
            let [low, high] = [&bins[..cut], &bins[cut..]]
                .map(|some| some.iter().fold(none, |all, b| all.with(b)));
            let fair = low.count.min(high.count) * 4 >= boxes.len();
            let cost = low.cost() + high.cost();
            if fair && best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, cut));
            }
        }
    }
    let (_, axis, cut) = best?;
    let (low, high) =
        (0..boxes.len() as u32).partition(|&i| places(&boxes[i as usize])[axis] < cut);
    Some([low, high])
}

/// A tree of two.
fn joined(a: Bvh2, b: Bvh2) -> Bvh2 {
    let mut tree = Bvh2 { max_depth: a.max_depth.max(b.max_depth) + 1, ..Bvh2::default() };
    let (roots, nodes_a) = ([a.nodes[0], b.nodes[0]], a.nodes.len() as u32);
    let prims_a = a.primitive_indices.len() as u32;
    // the root; those of the two; what is under the first, then what is under the second
    let moved = |node: &Bvh2Node, nodes: u32, prims: u32| {
        let by = if node.is_leaf() { prims } else { nodes };
        Bvh2Node::new(node.aabb, node.prim_count, node.first_index + by)
    };
    let (of_a, of_b) = ((2, 0), (nodes_a + 1, prims_a));
    tree.nodes.reserve(a.nodes.len() + b.nodes.len() + 1);
    tree.nodes.push(Bvh2Node::new(roots[0].aabb.union(&roots[1].aabb), 0, 1));
    tree.nodes.push(moved(&roots[0], of_a.0, of_a.1));
    tree.nodes.push(moved(&roots[1], of_b.0, of_b.1));
    tree.nodes.extend(a.nodes[1..].iter().map(|n| moved(n, of_a.0, of_a.1)));
    tree.nodes.extend(b.nodes[1..].iter().map(|n| moved(n, of_b.0, of_b.1)));
    tree.primitive_indices = a.primitive_indices;
    tree.primitive_indices.extend(b.primitive_indices);
    tree
}

/// Whether there may be a crowd: so it seems where very many keys of others fall together with those of
/// one, too.
fn crowded(boxes: &[Aabb]) -> bool {
    let cells = boxes.len().max(1).next_power_of_two() * 2;
    let cell = |b: &Aabb| {
        let mix =
            |h: u64, x: i64| (h ^ x as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(29);
        key(b).into_iter().fold(0, mix) as usize & (cells - 1)
    };
    let all: Vec<usize> = boxes.par_iter().map(cell).collect();
    let mut counts = vec![0u8; cells];
    all.into_iter().any(|cell| {
        counts[cell] += 1;
        usize::from(counts[cell]) > CROWD
    })
}

/// Crowds of boxes that are nearly the same, in the order of the first of each; all others by themselves.
fn bundles(boxes: &[Aabb]) -> Vec<Vec<u32>> {
    let mut keys: Vec<([i64; 7], u32)> =
        boxes.par_iter().map(key).zip(0..boxes.len() as u32).collect();
    keys.par_sort_unstable();
    let mut bundles = Vec::with_capacity(boxes.len());
    for alike in keys.chunk_by(|a, b| a.0 == b.0) {
        if alike.len() > CROWD {
            bundles.push(alike.iter().map(|k| k.1).collect());
        } else {
            bundles.extend(alike.iter().map(|k| vec![k.1]));
        }
    }
    bundles.sort_unstable();
    bundles
}

/// The size of a box as a power of two, and its corners in steps of a part of that.
fn key(b: &Aabb) -> [i64; 7] {
    let power = b.diagonal().max_element().max(f32::MIN_POSITIVE).log2().ceil();
    let step = f64::from(power).exp2() * f64::from(STEP);
    let steps = |p: Vec3A| p.to_array().map(|x| (f64::from(x) / step).round() as i64);
    let ([a, b, c], [d, e, f]) = (steps(b.min), steps(b.max));
    [power as i64, a, b, c, d, e, f]
}

/// Puts the primitives in the place of their bundles.
fn unpack(tree: &mut Bvh2, bundles: &[Vec<u32>], boxes: &[Aabb]) {
    let packed = std::mem::take(&mut tree.primitive_indices);
    let mut most = 0;
    for at in 0..tree.nodes.len() {
        let node = tree.nodes[at];
        if !node.is_leaf() {
            continue;
        }
        let first = tree.primitive_indices.len() as u32;
        for slot in node.first_index..node.first_index + node.prim_count {
            tree.primitive_indices.extend(&bundles[packed[slot as usize] as usize]);
        }
        let count = tree.primitive_indices.len() as u32 - first;
        most = most.max(count);
        (tree.nodes[at].first_index, tree.nodes[at].prim_count) = (first, count);
        halve(tree, at, boxes);
    }
    // a half for every doubling of the largest leaf
    tree.max_depth += most.max(1).ilog2() as usize + 1;
}

/// Parts a leaf until each has few enough primitives.
fn halve(tree: &mut Bvh2, leaf: usize, boxes: &[Aabb]) {
    let mut open = vec![leaf];
    while let Some(at) = open.pop() {
        let Bvh2Node { prim_count: count, first_index: first, .. } = tree.nodes[at];
        if count <= LEAF {
            continue;
        }
        let pair = tree.nodes.len();
        for (first, count) in [(first, count / 2), (first + count / 2, count - count / 2)] {
            let own = &tree.primitive_indices[first as usize..(first + count) as usize];
            let hull = own.iter().fold(Aabb::empty(), |h, &i| h.union(&boxes[i as usize]));
            tree.nodes.push(Bvh2Node::new(hull, count, first));
        }
        (tree.nodes[at].first_index, tree.nodes[at].prim_count) = (pair as u32, 0);
        open.extend([pair, pair + 1]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::Bvh;
    use glam::{DVec3, dvec3};

    /// Copies of a triangle a hair apart, among others that are far away.
    fn crowd(copies: usize) -> Vec<[DVec3; 3]> {
        let shape = [DVec3::ZERO, dvec3(10.0, 0.0, 1.0), dvec3(0.0, 10.0, 2.0)];
        let hair = |i: usize| DVec3::splat(i as f64 * 1e-12);
        let copies = (0..copies).map(|i| shape.map(|p| p + hair(i)));
        let others = (0..50).map(|i| shape.map(|p| p * 0.3 + dvec3(0.0, 7.0 * f64::from(i), 40.0)));
        copies.chain(others).collect()
    }

    #[test]
    fn every_primitive_is_in_one_leaf_and_within_its_boxes() {
        let spread = |n: usize| -> Vec<[DVec3; 3]> {
            let at = |i: usize| dvec3((i % 97) as f64, (i % 89) as f64, (i % 83) as f64) * 11.0;
            (0..n).map(|i| [at(i), at(i) + DVec3::X, at(i) + DVec3::Y]).collect()
        };
        let many = [spread(PART), spread(PART + 1), spread(5 * PART)];
        let few = [crowd(0), crowd(CROWD), crowd(CROWD + 1), crowd(3000)];
        for triangles in few.into_iter().chain(many) {
            let boxes: Vec<Aabb> =
                triangles.iter().map(|t| Aabb::from_points(&t.map(|p| p.as_vec3a()))).collect();
            let tree = hierarchy(&boxes, BvhBuildParams::fast_build());
            let mut found = vec![0; boxes.len()];
            let mut open = vec![(0u32, tree.nodes[0].aabb, 0)];
            while let Some((at, within, depth)) = open.pop() {
                let node = tree.nodes[at as usize];
                assert!(depth <= tree.max_depth && within.union(&node.aabb) == within);
                if !node.is_leaf() {
                    open.extend([0, 1].map(|k| (node.first_index + k, node.aabb, depth + 1)));
                    continue;
                }
                let first = node.first_index as usize;
                for &i in &tree.primitive_indices[first..first + node.prim_count as usize] {
                    found[i as usize] += 1;
                    assert!(node.aabb.union(&boxes[i as usize]) == node.aabb);
                }
            }
            assert!(found.iter().all(|&n| n == 1), "{} of {}", found.len(), boxes.len());
        }
    }

    /// What a crowd answers is what one of it would.
    #[test]
    fn forty_thousand_copies_are_as_far_away_as_one() {
        let (one, many) = (Bvh::new(&crowd(1)), Bvh::new(&crowd(40_000)));
        for p in [dvec3(3.0, 3.0, 9.0), dvec3(-5.0, 2.0, 0.0), dvec3(1.0, 200.0, 45.0)] {
            assert!((one.distance(p) - many.distance(p)).abs() < 1e-6);
        }
    }
}
