//! Distances between surfaces: Hausdorff and mean.
//!
//! One way, from a surface to another, the distance of every vertex is exact; between vertices
//! the largest is searched for by halving triangles, those that may hold it first. The distance to
//! *one* triangle is convex, so over a triangle it is largest at a corner: the smallest such bound
//! over the triangles nearest to the three corners tells which halves can be left out (the idea
//! of Tang, Lee and Kim 2009). So the largest distance is known to lie in a narrow bracket.

use crate::bvh::{Bvh, gap};
use crate::job::{self, Cancelled, Job};
use crate::mesh::TriMesh;
use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// A mesh ready to be measured against others.
pub struct Shell {
    mesh: TriMesh,
    bvh: Bvh,
    /// A third of the area of the triangles round each point, mm².
    share: Vec<f64>,
}

/// How far one surface is from another; one way, so not symmetric.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct OneWay {
    /// Largest distance found, mm; it is reached.
    pub max: f64,
    /// The true largest distance is at most this much more, mm.
    pub over: f64,
    /// Mean over the area by the values at the vertices (trapezoidal rule), mm: at most the
    /// longest edge off, on smooth surfaces of second order in it.
    pub mean: f64,
}

/// How far two surfaces are from each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Apart {
    /// Hausdorff distance, mm: the larger of both ways.
    pub hausdorff: f64,
    /// The true Hausdorff distance is at most this much more, mm.
    pub over: f64,
    /// Mean of the two ways' means, mm.
    pub mean: f64,
}

/// The bracket of the largest distance is closed to this share of it, or as far as
/// [`HALVINGS`] go.
const BRACKET: f64 = 1e-3;
/// Halvings in one direction: a fraction of the work of the vertices.
const HALVINGS: usize = 4096;

/// The distances of all points of a mesh to another, mm.
pub type PointDistances = Vec<f64>;

impl Shell {
    /// Makes a mesh ready. Points that no triangle uses do not count.
    pub fn new(mesh: TriMesh) -> Self {
        let corners: Vec<[DVec3; 3]> = (0..mesh.faces.len()).map(|i| mesh.corners(i)).collect();
        let mut share = vec![0.0; mesh.points.len()];
        for (i, f) in mesh.faces.iter().enumerate() {
            let third = mesh.area_vector(i).length() / 3.0;
            f.iter().for_each(|&v| share[v as usize] += third);
        }
        Self { bvh: Bvh::new(&corners), mesh, share }
    }

    /// The mesh.
    pub fn mesh(&self) -> &TriMesh {
        &self.mesh
    }

    /// Its triangles, ready for queries.
    pub fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// How far this surface is from another, and the distance of each of its points.
    ///
    /// # Errors
    /// Cancelled.
    pub fn to(&self, other: &Shell, job: &dyn Job) -> Result<(OneWay, PointDistances), Cancelled> {
        let found: Vec<Vec<Foot>> = self
            .mesh
            .points
            .par_chunks(4096)
            .map(|at| {
                job::check(job)?;
                let hits = other.bvh.nearest_all(at);
                let foot = |h| Foot { distance: f64::sqrt(h), face: u32::MAX };
                let mut feet: Vec<Foot> = hits.iter().map(|h| foot(h.distance2)).collect();
                for (foot, hit) in feet.iter_mut().zip(&hits) {
                    foot.face = other.bvh.face_of(hit).unwrap_or(u32::MAX);
                }
                Ok(feet)
            })
            .collect::<Result<_, Cancelled>>()?;
        let feet: Vec<Foot> = found.into_iter().flatten().collect();
        if other.bvh.is_empty() || self.mesh.faces.is_empty() {
            let way = OneWay { max: f64::INFINITY, over: 0.0, mean: f64::INFINITY };
            return Ok((way, vec![f64::INFINITY; feet.len()]));
        }
        let (sum, area) = self
            .share
            .iter()
            .zip(&feet)
            .fold((0.0, 0.0), |(sum, area), (w, f)| (sum + w * f.distance, area + w));
        let (max, over) = self.largest(other, &feet);
        let way = OneWay { max, over, mean: if area > 0.0 { sum / area } else { max } };
        Ok((way, feet.iter().map(|f| f.distance).collect()))
    }

    /// The largest distance found and what the true one may be more.
    fn largest(&self, other: &Shell, feet: &[Foot]) -> (f64, f64) {
        let corner = |v: u32| (self.mesh.points[v as usize], feet[v as usize]);
        let used = self.mesh.faces.iter().flatten();
        let mut max = used.map(|&v| feet[v as usize].distance).fold(0.0, f64::max);
        let within = |max: f64| max * (1.0 + BRACKET) + other.slack();
        let edge = within(max);
        let mut open: BinaryHeap<Piece> = self
            .mesh
            .faces
            .par_iter()
            .map(|f| Piece { bound: f64::INFINITY, corners: f.map(corner) }.bounded(other, edge))
            .filter(|piece| piece.bound > edge)
            .collect::<Vec<_>>()
            .into();
        for _ in 0..HALVINGS {
            match open.peek() {
                Some(worst) if worst.bound > within(max) => {}
                _ => break,
            }
            let Some(piece) = open.pop() else { break };
            let (halves, middle) = piece.halves(other);
            max = max.max(middle);
            let edge = within(max);
            open.extend(
                halves.map(|h| h.bounded(other, edge)).into_iter().filter(|h| h.bound > edge),
            );
        }
        let over = open.peek().map_or(0.0, |worst| worst.bound - max);
        // what was left out is within the bracket
        (max, over.max(within(max) - max))
    }

    /// What distances to this mesh may be off by, mm.
    fn slack(&self) -> f64 {
        let b = self.bvh.bounds();
        1e-12 * b.min.abs().max(b.max.abs()).max_element()
    }
}

/// How far two surfaces are from each other.
///
/// # Errors
/// Cancelled.
pub fn apart(a: &Shell, b: &Shell, job: &dyn Job) -> Result<Apart, Cancelled> {
    Ok(Apart::of(&a.to(b, job)?.0, &b.to(a, job)?.0))
}

impl Apart {
    /// From the two ways.
    pub fn of(there: &OneWay, back: &OneWay) -> Self {
        let hausdorff = there.max.max(back.max);
        let most = (there.max + there.over).max(back.max + back.over);
        Self { hausdorff, over: most - hausdorff, mean: 0.5 * (there.mean + back.mean) }
    }
}

/// Distance of a point and the nearest triangle.
#[derive(Clone, Copy)]
struct Foot {
    distance: f64,
    face: u32,
}

/// A triangle that may hold the largest distance, the one with the largest bound first.
struct Piece {
    bound: f64,
    corners: [(DVec3, Foot); 3],
}

impl Piece {
    /// With its bound: the least of several, the dear ones only where the cheap ones are not under
    /// `edge`.
    fn bounded(mut self, other: &Shell, edge: f64) -> Self {
        let [a, b, c] = self.corners.map(|(p, _)| p);
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        let most = self.corners.iter().map(|(_, f)| f.distance).fold(0.0, f64::max);
        // no point of a triangle is farther than this from all corners (Jung 1901)
        self.bound = most + longest / f64::sqrt(3.0);
        if self.bound > edge {
            let reach = |face: u32| {
                let triangle = other.mesh.corners(face as usize);
                [a, b, c].map(|p| gap(triangle, p)).into_iter().fold(0.0, f64::max)
            };
            let faces = self.corners.iter().map(|(_, f)| f.face);
            self.bound = faces.map(reach).fold(self.bound, f64::min);
            // at a shared corner the nearest triangle may be a neighbour of the one that matters
            if self.bound > edge
                && let Some(near) = other.bvh.nearest((a + b + c) / 3.0)
            {
                self.bound = self.bound.min(reach(near.face));
            }
        }
        self
    }

    /// Two halves, across the longest side, and the distance of its middle.
    fn halves(&self, other: &Shell) -> ([Self; 2], f64) {
        let length = |i: usize| self.corners[i].0.distance_squared(self.corners[(i + 1) % 3].0);
        let side = (0..3).fold(0, |best, i| if length(i) > length(best) { i } else { best });
        let [a, b, c] = [0, 1, 2].map(|i| self.corners[(side + i) % 3]);
        let p = a.0.midpoint(b.0);
        let foot = other.bvh.nearest(p).map(|n| Foot { distance: n.distance, face: n.face });
        let foot = foot.unwrap_or(a.1);
        let half = |corners| Self { bound: self.bound, corners };
        ([half([a, (p, foot), c]), half([(p, foot), b, c])], foot.distance)
    }
}

impl Ord for Piece {
    fn cmp(&self, other: &Self) -> Ordering {
        // equal bounds in the order of place, so that any number of threads gives the same
        let key = |p: &Self| p.corners.map(|(p, _)| p.to_array());
        let place = || {
            let (mine, theirs) = (key(self), key(other));
            let pairs = mine.as_flattened().iter().zip(theirs.as_flattened());
            pairs.fold(Ordering::Equal, |o, (a, b)| o.then(a.total_cmp(b)))
        };
        self.bound.total_cmp(&other.bound).then_with(place)
    }
}

impl PartialOrd for Piece {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Piece {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Piece {}
