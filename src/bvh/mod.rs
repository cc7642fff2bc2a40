//! Triangles in a tree of boxes: nearest point, many nearest points at once, winding number,
//! and which triangles touch. Distances are taken in vectors of eight, with the same bits whatever
//! the machine's vectors are.
//!
//! The tree's shape comes from `obvhs`, built in `f32` on a recentred unit box; the boxes are then
//! made again in `f64` round the exact corners, so no query has to allow for `f32`.

mod axis;
mod batch;
mod contact;
mod hierarchy;
mod limits;
mod nearest;
mod pairs;
mod ray;
mod rim;
#[cfg(test)]
mod tests;
mod triangle;
mod wide;
mod winding;

pub use batch::Hit;
pub use contact::{Flat, Outline, apart, gap};
pub use hierarchy::hierarchy;
pub use nearest::Nearest;
pub use ray::Exit;
pub use rim::Rim;
pub use winding::Winding;

use crate::num::Aabb;
use glam::DVec3;
use obvhs::BvhBuildParams;
use rayon::prelude::*;
use triangle::Tri;
use wide::Wide;

/// One box of the tree: two children at `first` and `first + 1`, or `count` triangles from `first`.
#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Aabb,
    first: u32,
    count: u32,
}

/// A set of triangles, ready for queries. May be empty.
#[derive(Clone, Debug)]
pub struct Bvh {
    /// Children come after their parents; the root is first.
    nodes: Vec<Node>,
    /// Triangles in leaf order: a triangle's place here is its slot.
    tris: Vec<Tri>,
    wide: Wide,
    corners: Vec<[DVec3; 3]>,
    /// Which of the triangles given to [`Bvh::new`] sits in each slot.
    faces: Vec<u32>,
    /// Largest coordinate, for round-off allowances.
    magnitude: f64,
}

impl Bvh {
    /// The tree over some triangles, all coordinates finite.
    pub fn new(triangles: &[[DVec3; 3]]) -> Self {
        let mut bvh = Self::bare(triangles);
        (bvh.tris, bvh.wide) = bvh.lanes();
        bvh
    }

    /// What distances need.
    fn lanes(&self) -> (Vec<Tri>, Wide) {
        let tris: Vec<Tri> = self.corners.par_iter().map(|&t| Tri::new(t)).collect();
        let wide = Wide::new(&self.nodes, &tris);
        (tris, wide)
    }

    /// The tree without what distances need.
    fn bare(triangles: &[[DVec3; 3]]) -> Self {
        let bounds = Aabb::of(triangles.iter().flatten().copied());
        let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
        let magnitude = if triangles.is_empty() { 0.0 } else { largest };
        let mut bvh = Self {
            nodes: vec![],
            tris: vec![],
            wide: Wide::default(),
            corners: vec![],
            faces: vec![],
            magnitude,
        };
        bvh.lay_out(&shape(triangles, &bounds), triangles);
        bvh.fit();
        bvh
    }

    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.corners.len()
    }

    /// Memory that it takes, bytes.
    pub fn bytes(&self) -> usize {
        let wide = self.wide.bytes() + size_of_val(&self.tris[..]);
        let corners = size_of_val(&self.corners[..]) + size_of_val(&self.faces[..]);
        wide + size_of_val(&self.nodes[..]) + corners
    }

    /// The triangles that the tree was built from, neighbours in space mostly next to each other.
    pub fn order(&self) -> &[u32] {
        &self.faces
    }

    /// Whether there is nothing to query.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// The box round all triangles.
    pub fn bounds(&self) -> Aabb {
        self.nodes.first().map_or(Aabb::EMPTY, |n| n.bounds)
    }

    /// Copies the shape of `from` parents first, and the triangles in the order of the leaves.
    fn lay_out(&mut self, from: &obvhs::bvh2::Bvh2, triangles: &[[DVec3; 3]]) {
        if triangles.is_empty() {
            return;
        }
        let blank = Node { bounds: Aabb::EMPTY, first: 0, count: 0 };
        self.faces.reserve(triangles.len());
        self.nodes.reserve(from.nodes.len());
        self.nodes.push(blank);
        let mut open = vec![(0u32, 0usize)];
        while let Some((source, place)) = open.pop() {
            let node = from.nodes[source as usize];
            if node.is_leaf() {
                let first = self.faces.len() as u32;
                let slots =
                    node.first_index as usize..(node.first_index + node.prim_count) as usize;
                self.faces.extend(&from.primitive_indices[slots]);
                self.nodes[place] = Node { first, count: node.prim_count, ..blank };
            } else {
                let first = self.nodes.len();
                self.nodes.extend([blank, blank]);
                self.nodes[place].first = first as u32;
                open.push((node.first_index + 1, first + 1));
                open.push((node.first_index, first));
            }
        }
        self.corners = self.faces.par_iter().map(|&face| triangles[face as usize]).collect();
    }

    /// Boxes from the leaves up.
    fn fit(&mut self) {
        let corners = &self.corners;
        self.nodes.par_iter_mut().filter(|node| node.count > 0).for_each(|node| {
            let (first, count) = (node.first as usize, node.count as usize);
            node.bounds = Aabb::of(corners[first..first + count].iter().flatten().copied());
        });
        for i in (0..self.nodes.len()).rev() {
            let Node { first, count, .. } = self.nodes[i];
            if count == 0 {
                let first = first as usize;
                self.nodes[i].bounds = self.nodes[first].bounds.hull(self.nodes[first + 1].bounds);
            }
        }
    }

    /// What a computed distance at `p` may be off by.
    fn slack(&self, p: DVec3) -> f64 {
        1e-13 * (self.magnitude + p.abs().max_element())
    }
}

/// The tree's shape, from `f32` triangles in a unit box.
fn shape(triangles: &[[DVec3; 3]], bounds: &Aabb) -> obvhs::bvh2::Bvh2 {
    if triangles.is_empty() {
        return obvhs::bvh2::Bvh2::default();
    }
    let scale = 1.0 / bounds.size().max_element().max(f64::MIN_POSITIVE);
    let unit = |p: DVec3| ((p - bounds.centre()) * scale).as_vec3a();
    let own = |t: &[DVec3; 3]| obvhs::aabb::Aabb::from_points(&t.map(unit));
    let boxes: Vec<_> = triangles.par_iter().map(own).collect();
    hierarchy(&boxes, BvhBuildParams::medium_build())
}
