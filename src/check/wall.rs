//! The thinnest wall.
//!
//! At a point of the surface the wall's thickness is the diameter of the ball that lies inside and
//! touches the surface there and on the opposite side (after Hildebrand and Rüegsegger 1997). The
//! opposite side is where the inward normal leaves the solid; if that is `d` away and the two sides
//! lean towards each other by the angle `a`, the ball between their planes has the diameter
//! `2 d tan(a/2) / tan(a) = d (1 - tan²(a/2))`.
//!
//! *Opposite* means that the sides lean by less than 60°: the faces of a box edge bound a ball of
//! any size, but no wall. A triangle counts with the middle one of its corners' values, and the
//! thinnest wall is one that [`PATCH`] average triangles' area is not above: the tip of a spike and
//! a rough spot are no walls.

use super::distance::Shell;
use crate::job::{self, Cancelled, Job};
use crate::mesh::TriMesh;
use glam::DVec3;
use rayon::prelude::*;

/// Sides are opposite when the cosine of the angle by which they lean is above this: 60°.
const OPPOSITE: f64 = 0.5;
/// Longest edge of a measured triangle, as a share of the box's diagonal: larger ones are divided.
const FINEST: f64 = 1.0 / 64.0;
/// Most points of a divided mesh.
const MOST: usize = 2_000_000;
/// A wall has as much area as so many average triangles. Fewer would take the tip of a feature that
/// ends between two samples for a wall; more would miss a neck as wide and long as two cells.
const PATCH: f64 = 16.0;
/// Corners whose triangles are all within this cosine of their normal (35°) lie on a smooth surface;
/// others stand at an edge.
const SMOOTH: f64 = 0.82;
/// The first rays go from every so many triangles: they find a wall that the thinnest is not above.
const FIRST: usize = 16;
/// Seen from the other side a wall counts as the same one up to this much thicker: what a normal
/// that leans by 20° hides of a rod.
const SAME: f64 = 1.1;
/// A wall is no thinner than this share of the way along the normal: where the sides lean by 60°,
/// 1 - tan²(30°) = 2/3.
const LEAST_SHARE: f64 = 0.66;

/// The thickness of the thinnest wall, mm; `None` for a mesh in which no ray inwards comes out on
/// an opposite side. Meaningful for closed meshes. A ray a point: about as long as the check.
///
/// Exact up to rounding for plane-parallel plates, and up to the mesh's own sagitta for rods, tubes
/// and balls; where the normals of both sides are off by 10°, as on rough spots, a rod comes out 2% too thin. Flat
/// faces are measured every 64th of the box's diagonal: a spot that is thin over less than that
/// may be missed on large triangles. On a mesh sampled with a step `h` a
/// sharp edge is bevelled, and the wall between two bevels is up to 2.5 `h` thinner than that
/// between the faces; walls below `2 h` are as rough as the samples.
///
/// # Errors
/// Cancelled.
pub fn thinnest_wall(shell: &Shell, job: &dyn Job) -> Result<Option<f64>, Cancelled> {
    let points = Points::of(shell.mesh());
    let least = 1e-9 * shell.bvh().bounds().size().max_element();
    // what some of the surface is not above, all of it is not above
    let some: Vec<u32> = (0..points.triangles.len() as u32).step_by(FIRST).collect();
    let endless = [least, f64::INFINITY];
    let first: Vec<[f64; 2]> =
        some.par_iter().map(|&t| points.patch(t, |v| points.wall(shell, v, endless))).collect();
    let patch = PATCH * points.area() / points.triangles.len().max(1) as f64;
    let limit = thinnest(first, patch).unwrap_or(f64::INFINITY) / LEAST_SHARE;
    job::check(job)?;
    let walls: Vec<f64> = (0..points.at.len() as u32)
        .into_par_iter()
        .with_min_len(512)
        .map(|v| {
            if v.is_multiple_of(512) {
                job::check(job)?;
            }
            Ok(points.wall(shell, v, [least, limit]))
        })
        .collect::<Result<_, Cancelled>>()?;
    let all = (0..points.triangles.len() as u32).map(|t| points.patch(t, |v| walls[v as usize]));
    Ok(thinnest(all.collect(), patch))
}

/// The least thickness that triangles of `patch` mm² are not above, from the thickness and area of
/// each; `None` when all have less.
fn thinnest(mut walls: Vec<[f64; 2]>, patch: f64) -> Option<f64> {
    walls.retain(|[wall, _]| wall.is_finite());
    walls.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
    let mut area = 0.0;
    for [wall, own] in &walls {
        area += own;
        // rounding must not ask for one triangle more
        if area >= patch * (1.0 - 1e-9) {
            return Some(*wall);
        }
    }
    None
}

/// The middle one of three.
fn middle([a, b, c]: [f64; 3]) -> f64 {
    a.max(b).min(a.min(b).max(c))
}

/// A point of the surface and the unit normal there.
#[derive(Clone, Copy)]
struct Point {
    at: DVec3,
    normal: DVec3,
}

/// Points of a surface, and triangles over them.
struct Points {
    at: Vec<Point>,
    triangles: Vec<[u32; 3]>,
    /// Unit normal of each face of the mesh: its own, or on small faces its corners' mean.
    normals: Vec<DVec3>,
}

impl Points {
    /// The vertices with smooth normals; on large triangles points of their own.
    fn of(mesh: &TriMesh) -> Self {
        let longest = mesh.bounds().size().length() * FINEST;
        let normals = smooth(mesh);
        let round = round(mesh, &normals);
        let at = mesh.points.iter().zip(&normals).map(|(&at, &normal)| Point { at, normal });
        let mut all = Self { at: at.collect(), triangles: Vec::new(), normals: Vec::new() };
        for (i, f) in mesh.faces.iter().enumerate() {
            let [a, b, c] = mesh.corners(i);
            let edge = a.distance(b).max(b.distance(c)).max(c.distance(a));
            let parts = (edge / longest).ceil();
            let small = parts <= 1.0;
            let own = if small {
                f.iter().map(|&v| normals[v as usize]).sum()
            } else {
                mesh.area_vector(i)
            };
            all.normals.push(own.normalize_or_zero());
            if small {
                all.triangles.push(*f);
            } else if all.at.len() < MOST {
                let corners = f.map(|v| normals[v as usize]);
                let round = f.iter().all(|&v| round[v as usize]);
                all.divide([a, b, c], round.then_some(corners), parts.min(1000.0) as u32);
            }
        }
        all
    }

    /// Points in rows over a triangle, moved a little inwards from its sides; with the normals between
    /// its corners', or else its own.
    fn divide(&mut self, [a, b, c]: [DVec3; 3], corners: Option<[DVec3; 3]>, parts: u32) {
        let Some(normal) = (b - a).cross(c - a).try_normalize() else {
            return;
        };
        let [na, nb, nc] = corners.unwrap_or([normal; 3]);
        let first = self.at.len() as u32;
        let row = |i: u32| first + i * (2 * parts + 3 - i) / 2;
        let middle = (a + b + c) / 3.0;
        for i in 0..=parts {
            for j in 0..=parts - i {
                let [u, v] = [i, j].map(|n| f64::from(n) / f64::from(parts));
                let at = a + (c - a) * u + (b - a) * v;
                let normal = (na + (nc - na) * u + (nb - na) * v).normalize_or(normal);
                self.at.push(Point { at: at.lerp(middle, 1e-3), normal });
            }
        }
        for i in 0..parts {
            for j in 0..parts - i {
                let [p, q] = [row(i) + j, row(i + 1) + j];
                self.triangles.push([p, p + 1, q]);
                if j + 1 < parts - i {
                    self.triangles.push([p + 1, q + 1, q]);
                }
            }
        }
    }

    /// Thickness at a point; infinite where there is no opposite side within the range.
    fn wall(&self, shell: &Shell, v: u32, range: [f64; 2]) -> f64 {
        let p = self.at[v as usize];
        let Some((there, opposite)) = self.across(shell, p, range) else {
            return f64::INFINITY;
        };
        // a normal that leans, as on a bevelled edge, sees a round wall too thin: the opposite side
        // has its own view
        match self.across(shell, opposite, range) {
            Some((back, _)) if back < there * SAME => there.max(back),
            _ => there,
        }
    }

    /// Thickness as one point sees it, infinite where the other side leans too much, and where that is.
    fn across(&self, shell: &Shell, p: Point, range: [f64; 2]) -> Option<(f64, Point)> {
        let exit = shell.bvh().first_exit(p.at, -p.normal, range)?;
        let smooth = self.normals[exit.face as usize];
        // a smooth normal leans near an edge, a small triangle's own on a rough spot
        let cos = [smooth, exit.normal].map(|n| -n.dot(p.normal));
        let cos = cos[0].max(cos[1]);
        // tan² of half the angle
        let lean = ((1.0 - cos) / (1.0 + cos)).max(0.0);
        let wall = if cos > OPPOSITE { exit.distance * (1.0 - lean) } else { f64::INFINITY };
        Some((wall, Point { at: p.at - p.normal * exit.distance, normal: smooth }))
    }

    /// The middle one of a triangle's corners' values, and its area.
    fn patch(&self, t: u32, of: impl Fn(u32) -> f64) -> [f64; 2] {
        let t = self.triangles[t as usize];
        let [a, b, c] = t.map(|v| self.at[v as usize].at);
        [middle(t.map(of)), 0.5 * (b - a).cross(c - a).length()]
    }

    /// Area of all triangles, mm².
    fn area(&self) -> f64 {
        (0..self.triangles.len() as u32).map(|t| self.patch(t, |_| 0.0)[1]).sum()
    }
}

/// Unit normals at the points, averaged over the triangles round a point and those round its
/// neighbours: steps of one cell leave no trace.
fn smooth(mesh: &TriMesh) -> Vec<DVec3> {
    let gather = |of: &dyn Fn(usize, &[u32; 3]) -> DVec3| {
        let mut sum = vec![DVec3::ZERO; mesh.points.len()];
        for (i, f) in mesh.faces.iter().enumerate() {
            let n = of(i, f);
            f.iter().for_each(|&v| sum[v as usize] += n);
        }
        sum
    };
    let plain = gather(&|i, _| mesh.area_vector(i));
    let wide = gather(&|_, f| f.iter().map(|&v| plain[v as usize]).sum());
    wide.iter().map(|n| n.normalize_or_zero()).collect()
}

/// Whether all triangles round a point lie about as its normal says.
fn round(mesh: &TriMesh, normals: &[DVec3]) -> Vec<bool> {
    let mut round = vec![true; mesh.points.len()];
    for (i, f) in mesh.faces.iter().enumerate() {
        let own = mesh.area_vector(i).normalize_or_zero();
        for &v in f {
            round[v as usize] &= own.dot(normals[v as usize]) > SMOOTH;
        }
    }
    round
}
