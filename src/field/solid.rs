//! Solids: an element as a field, and many of them joined in order.

use super::Field;
use super::csg::Join;
use crate::element::{Element, Gauge};
use crate::num::{Aabb, Interval};
use glam::DVec3;

/// Levels of the tree that tells which parts matter where: 32 leaves along an edge.
const DEPTH: u32 = 5;

/// Room round the solid that the tree covers too, as a share of its size.
const ROOM: f64 = 0.5;

/// Covers the round-off of two distances that are compared, mm.
const SLACK: f64 = 1e-6;

/// One element as a field; its edges perhaps rounded.
pub struct Solid {
    gauge: Gauge,
}

impl Solid {
    /// The element with its edges rounded by `round` mm, its size unchanged.
    pub fn new(element: &Element, round: f64) -> Self {
        Self { gauge: element.gauge(round) }
    }
}

impl Field for Solid {
    fn value(&self, p: DVec3) -> f64 {
        self.gauge.distance(p)
    }

    fn bound(&self, b: &Aabb) -> Interval {
        self.gauge.bound(b)
    }

    fn support(&self) -> Aabb {
        self.gauge.bounds()
    }
}

/// One part of an [`Assembly`].
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Its body.
    pub element: Element,
    /// Radius of its edges, mm; the size stays.
    pub round: f64,
    /// What it does to the parts before it.
    pub join: Join,
}

/// Why parts make no solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SolidError {
    /// None at all.
    #[error("a solid needs at least one part")]
    Empty,
    /// Nothing to cut from or meet with.
    #[error("the first part joins nothing; expected one that adds")]
    First,
}

/// Parts joined in the order they are listed, starting from nothing.
///
/// A tree over space keeps, for every cell, the parts that can matter there; what it leaves out
/// changes no bit of the value.
pub struct Assembly {
    gauges: Vec<Gauge>,
    joins: Vec<Join>,
    nodes: Vec<Node>,
    root: Aabb,
    support: Aabb,
}

/// The parts that matter in a cell, and its first child of eight if it is split.
struct Node {
    parts: Vec<u32>,
    children: Option<usize>,
}

impl Assembly {
    /// Ready to be evaluated.
    ///
    /// # Errors
    /// No parts, or a first part that cuts or meets.
    pub fn new(parts: &[Part]) -> Result<Self, SolidError> {
        let first = parts.first().ok_or(SolidError::Empty)?;
        if matches!(first.join, Join::Cut | Join::Meet) {
            return Err(SolidError::First);
        }
        let gauges: Vec<Gauge> = parts.iter().map(|p| p.element.gauge(p.round)).collect();
        let joins: Vec<Join> = parts.iter().map(|p| p.join).collect();
        let support = support(&gauges, &joins);
        let mut all = Self {
            gauges,
            joins,
            nodes: Vec::new(),
            root: support.grow(ROOM * support.size().max_element()),
            support,
        };
        all.nodes.push(Node { parts: (0..parts.len() as u32).collect(), children: None });
        // parts that meet nowhere leave nothing to look up
        if !all.root.is_empty() {
            all.split(0, all.root, 0);
        }
        Ok(all)
    }

    fn split(&mut self, node: usize, cell: Aabb, depth: u32) {
        if depth == DEPTH || self.nodes[node].parts.len() < 2 {
            return;
        }
        let first = self.nodes.len();
        for i in 0..8 {
            let parts = self.relevant(&self.nodes[node].parts, &octant(&cell, i));
            self.nodes.push(Node { parts, children: None });
        }
        self.nodes[node].children = Some(first);
        for i in 0..8 {
            self.split(first + i, octant(&cell, i), depth + 1);
        }
    }

    /// Those of `parts` that can change the value somewhere in the cell.
    fn relevant(&self, parts: &[u32], cell: &Aabb) -> Vec<u32> {
        let mut kept = Vec::new();
        let mut so_far = Interval::point(f64::INFINITY);
        for &i in parts {
            let join = self.joins[i as usize];
            let d = self.gauges[i as usize].bound(cell).widen(SLACK);
            match join {
                Join::Add | Join::Blend(_) => {
                    let k = if let Join::Blend(k) = join { k } else { 0.0 };
                    if d.lo >= so_far.hi + k {
                        continue;
                    }
                    if d.hi + k <= so_far.lo {
                        kept.clear();
                    }
                }
                Join::Cut if -d.lo <= so_far.lo => continue,
                Join::Meet if d.hi <= so_far.lo => continue,
                Join::Cut | Join::Meet => {}
            }
            kept.push(i);
            so_far = join.range(so_far, d);
        }
        kept
    }

    /// The parts to be looked at for a point.
    fn parts_at(&self, p: DVec3) -> &[u32] {
        let (mut node, mut cell) = (&self.nodes[0], self.root);
        if !cell.contains(p) {
            return &node.parts;
        }
        while let Some(first) = node.children {
            let high = p.cmpge(cell.centre());
            let i = high.bitmask() as usize;
            cell = octant(&cell, i);
            node = &self.nodes[first + i];
        }
        &node.parts
    }

    fn fold(&self, parts: &[u32], p: DVec3) -> f64 {
        parts.iter().fold(f64::INFINITY, |f, &i| {
            let (gauge, join) = (&self.gauges[i as usize], self.joins[i as usize]);
            // no distance is less than that to its box, which is cheap
            let least = gauge.bounds().distance(p) - SLACK;
            let idle = match join {
                Join::Add => least >= f,
                Join::Blend(k) => least >= f + k,
                Join::Cut => -least <= f,
                Join::Meet => false,
            };
            if idle { f } else { join.value(f, gauge.distance(p)) }
        })
    }
}

/// One eighth of a box; bit 0, 1, 2 of `i` choose the upper half in x, y, z.
fn octant(b: &Aabb, i: usize) -> Aabb {
    let c = b.centre();
    let pick = |axis: usize| {
        if i >> axis & 1 == 0 { (b.min[axis], c[axis]) } else { (c[axis], b.max[axis]) }
    };
    let ((x0, x1), (y0, y1), (z0, z1)) = (pick(0), pick(1), pick(2));
    Aabb::new(DVec3::new(x0, y0, z0), DVec3::new(x1, y1, z1))
}

/// A box outside which the value is positive.
///
/// Kept along the way: `f >= distance(hull) - sag`. A blend of width k is below zero outside both
/// parts only where sqrt(a) + sqrt(b) < sqrt(k): one of the two below k / 4, the other below k.
fn support(gauges: &[Gauge], joins: &[Join]) -> Aabb {
    let (mut support, mut hull, mut sag) = (Aabb::EMPTY, Aabb::EMPTY, 0.0);
    for (gauge, join) in gauges.iter().zip(joins) {
        let own = gauge.bounds();
        match *join {
            Join::Cut => continue,
            Join::Meet => {
                support = support.meet(own);
                continue;
            }
            Join::Add => {}
            Join::Blend(k) => {
                if !hull.is_empty() {
                    let thin = hull.grow(0.25 * k + sag).meet(own.grow(k));
                    let wide = hull.grow(k + sag).meet(own.grow(0.25 * k));
                    for fillet in [thin, wide].into_iter().filter(|b| !b.is_empty()) {
                        support = support.hull(fillet);
                    }
                }
                sag += 0.25 * k;
            }
        }
        support = support.hull(own);
        hull = hull.hull(own);
    }
    support
}

impl Field for Assembly {
    fn value(&self, p: DVec3) -> f64 {
        self.fold(self.parts_at(p), p)
    }

    fn bound(&self, b: &Aabb) -> Interval {
        let f = self.value(b.centre());
        Interval::ball(f, b.radius()).widen(1e-12 * (f.abs() + b.radius()))
    }

    fn support(&self) -> Aabb {
        self.support
    }
}

#[cfg(test)]
#[path = "solid_tests.rs"]
mod tests;
