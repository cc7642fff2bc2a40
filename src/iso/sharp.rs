//! Cone marching cubes that keep edges and corners.
//!
//! The field gives what samples cannot: the exact crossings and the normals there. Where the
//! normals of a cell spread, its apex goes to where their planes meet; where they spread along one
//! segment on a face, the edge runs through that face, and the two triangles at the segment turn
//! to join the two apexes instead (Kobbelt et al. 2001).
//!
//! The guarantee of the cone mesher stays. An apex is moved only in a cell of one patch, where it
//! may be anywhere. A turned pair passes through the common face along a path from one end of the
//! segment to a point of the open face to the other end; where that face holds no other segment,
//! the loops of both cells stay simple, and the triangles are cones over them as before.

use super::block::first;
use super::cell::Cell;
use super::index::{Apexes, Beside, Surface, crossed};
use super::loops::{Edge, PATCHES};
use super::normals::gradients;
use super::qef;
use crate::field::Field;
use crate::grid::Bricks;
use crate::job::{Cancelled, Job, check};
use crate::mesh::TriMesh;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Cosine of the angle between normals from which they show an edge: 30 degrees. A smaller angle
/// makes ridges of legs a few voxels thick; a larger one rounds the edges of a hexagon.
const SHARP: f64 = 0.866;

/// Half the length of the differences that give normals, in steps of the lattice: short beside a
/// cell, so that few straddle an edge, and long beside the round-off of fields held in f32.
const REACH: f64 = 0.02;

/// How far from the surface an apex may come to lie, in steps, before the plane it misses is found:
/// an edge whose cell holds a corner of which it sees two planes runs on beyond the corner.
const STRAY: f64 = 0.02;

/// The whole surface.
pub(super) fn extract(
    bricks: &Bricks<f32>,
    f: &dyn Field,
    job: &dyn Job,
) -> Result<TriMesh, Cancelled> {
    let surface = Surface::new(bricks, Apexes::All, job)?;
    let mut mesh = surface.blank();
    let mut normals = vec![Vec3::ZERO; mesh.points.len()];
    let finished = AtomicUsize::new(0);
    let parts = surface.points_of(&mut mesh.points).into_iter();
    let parts: Vec<_> = parts.zip(surface.points_of(&mut normals)).collect();
    parts.into_par_iter().enumerate().try_for_each(|(n, (points, normals))| {
        check(job)?;
        find_crossings(&surface, n, f, points, normals);
        job.done(finished.fetch_add(1, Ordering::Relaxed) as f64 / surface.indices.len() as f64);
        Ok(())
    })?;

    let known = Known { f, surface: &surface, points: &mesh.points, normals: &normals };
    let apexes = (0..surface.indices.len()).into_par_iter().map(|n| {
        check(job)?;
        Ok(known.apexes(n))
    });
    let apexes = apexes.collect::<Result<Vec<_>, Cancelled>>()?;
    let faces: Vec<_> = surface.faces_of(&mut mesh.faces);
    faces.into_par_iter().enumerate().try_for_each(|(n, faces)| {
        check(job)?;
        known.faces(n, faces);
        Ok(())
    })?;
    for (points, apexes) in surface.points_of(&mut mesh.points).into_iter().zip(apexes) {
        for (n, p) in apexes {
            points[n] = p;
        }
    }
    Ok(mesh)
}

/// An edge of the lattice that the surface crosses, narrowed down from its ends.
struct Crossing {
    slot: usize,
    from: DVec3,
    along: DVec3,
    /// Shares of the edge with different signs, and the values there.
    share: [f64; 2],
    value: [f64; 2],
    /// The end that moved last.
    moved: Option<usize>,
    margin: f64,
    /// Where the border closes the shape the field has no surface; the normal is the edge's.
    normal: Option<DVec3>,
}

impl Crossing {
    fn guess(&self) -> f64 {
        let [a, b] = self.value;
        let share = self.share[0] + (self.share[1] - self.share[0]) * (a / (a - b));
        if share.is_finite() { share } else { 0.5 }
    }

    fn position(&self, share: f64) -> DVec3 {
        self.from + self.along * share
    }

    /// Takes the value at the guess for an end. An end that stays twice counts half (the Illinois
    /// rule), lest it stay for ever.
    fn narrow(&mut self, value: f64) {
        let (share, end) = (self.guess(), usize::from((value < 0.0) != (self.value[0] < 0.0)));
        self.share[end] = share;
        self.value[end] = value;
        if self.moved == Some(end) {
            self.value[1 - end] *= 0.5;
        }
        self.moved = Some(end);
    }
}

/// Writes the crossings of one brick and the normals there.
fn find_crossings(
    surface: &Surface,
    n: usize,
    f: &dyn Field,
    points: &mut [DVec3],
    normals: &mut [Vec3],
) {
    let mut list = crossings(surface, n);
    let mut values = vec![0.0; list.len()];
    for _ in 0..4 {
        let at: Vec<DVec3> = list.iter().map(|c| c.position(c.guess())).collect();
        f.values(&at, &mut values);
        for (c, &v) in list.iter_mut().zip(&values) {
            c.narrow(v);
        }
    }
    let at: Vec<DVec3> = list.iter().map(|c| c.position(c.guess())).collect();
    let found = gradients(f, &at, REACH * surface.bricks.lattice.step);
    for (c, normal) in list.iter().zip(found) {
        let share = c.guess().clamp(c.margin, 1.0 - c.margin);
        points[c.slot] = c.position(share).as_vec3().as_dvec3();
        normals[c.slot] = c.normal.unwrap_or(normal).as_vec3();
    }
}

/// The crossed edges that a brick owns, as the samples show them.
fn crossings(surface: &Surface, n: usize) -> Vec<Crossing> {
    let lattice = &surface.bricks.lattice;
    let lo = first(surface.indices[n].brick);
    let (mut list, mut slot) = (Vec::new(), 0);
    surface.visit(n, |cell, config| {
        for axis in (0..3).filter(|&a| crossed(config) >> a & 1 == 1) {
            let edge = Edge { axis, corner: 0 };
            let [from, to] = [edge.corner, edge.end()].map(|c| cell.corner(c));
            let value = [edge.corner, edge.end()].map(|c| cell.values[usize::from(c)]);
            let on_border = (0..3).any(|a| {
                let i = lo[a] + cell.at[a] as i64;
                i == 0 || i + i64::from(a == usize::from(axis)) + 1 >= i64::from(lattice.size[a])
            });
            let outwards = (to - from).normalize_or_zero() * (value[1] - value[0]).signum();
            list.push(Crossing {
                slot,
                from,
                along: to - from,
                share: [0.0, 1.0],
                value,
                moved: None,
                margin: cell.margin()[usize::from(axis)],
                normal: on_border.then_some(outwards),
            });
            slot += 1;
        }
        slot += PATCHES[usize::from(config)].count();
    });
    list
}

/// Crossings and normals of the whole surface.
struct Known<'a> {
    f: &'a dyn Field,
    surface: &'a Surface<'a>,
    points: &'a [DVec3],
    normals: &'a [Vec3],
}

impl Known<'_> {
    /// The apexes of one brick, and their numbers among its points.
    fn apexes(&self, n: usize) -> Vec<(usize, DVec3)> {
        let beside = self.surface.beside(self.surface.indices[n].brick);
        let (mut found, mut slot) = (Vec::new(), 0);
        self.surface.visit(n, |cell, config| {
            slot += crossed(config).count_ones() as usize;
            let patches = &PATCHES[usize::from(config)];
            for edges in patches.loops() {
                found.push((slot, self.apex(cell, edges, &beside, patches.count() == 1)));
                slot += 1;
            }
        });
        found
    }

    fn apex(&self, cell: &Cell, edges: &[Edge], beside: &Beside, only: bool) -> DVec3 {
        let ids = edges.iter().map(|&e| beside.point(cell.at, e) as usize);
        let (mut points, mut normals): (Vec<DVec3>, Vec<DVec3>) =
            ids.map(|id| (self.points[id], self.normals[id].as_dvec3())).unzip();
        let mean = points.iter().sum::<DVec3>() / points.len() as f64;
        if !only {
            return cell.position(cell.share(mean));
        }
        let spread = |a: &DVec3| normals.iter().any(|b| a.dot(*b) < SHARP);
        if !normals.iter().any(spread) {
            return within(cell, mean + bulge(mean, &points, &normals), mean);
        }
        for _ in 0..2 {
            let to = meet(cell, mean, &points, &normals);
            let (value, normal) = self.plane(to);
            if value.abs() < STRAY * self.surface.bricks.lattice.step {
                break;
            }
            points.push(to - normal * value);
            normals.push(normal);
        }
        within(cell, meet(cell, mean, &points, &normals), mean)
    }

    /// The field's value and direction of growth at a point.
    fn plane(&self, p: DVec3) -> (f64, DVec3) {
        let reach = REACH * self.surface.bricks.lattice.step;
        let normal = gradients(self.f, &[p], reach).pop().unwrap_or_default();
        (self.f.value(p), normal)
    }

    /// Writes the faces of one brick.
    fn faces(&self, n: usize, faces: &mut [[u32; 3]]) {
        let beside = self.surface.beside(self.surface.indices[n].brick);
        let (mut faces, mut next) = (faces.iter_mut(), self.surface.starts[n]);
        self.surface.visit(n, |cell, config| {
            next += crossed(config).count_ones();
            let patches = &PATCHES[usize::from(config)];
            for edges in patches.loops() {
                for (a, b) in edges.iter().zip(edges.iter().cycle().skip(1)) {
                    let ids = [a, b].map(|&e| beside.point(cell.at, e));
                    let only = patches.count() == 1;
                    let across =
                        if only { self.across(n, cell, config, [*a, *b], ids) } else { None };
                    if let Some(slot) = faces.next() {
                        *slot = [next, ids[0], across.unwrap_or(ids[1])];
                    }
                }
                next += 1;
            }
        });
    }

    /// The apex of the next cell beyond the segment `ids`, if an edge of the shape runs through it.
    /// The next cell finds the same, since all that is asked is common to both.
    fn across(
        &self,
        n: usize,
        cell: &Cell,
        config: u8,
        segment: [Edge; 2],
        ids: [u32; 2],
    ) -> Option<u32> {
        let [a, b] = ids.map(|id| self.normals[id as usize].as_dvec3());
        if a.dot(b) > SHARP {
            return None;
        }
        let corners = segment.map(|e| [e.corner, e.end()]);
        let (axis, high) = [0, 1, 2].iter().find_map(|&axis| {
            let side = |c: u8| c >> axis & 1;
            let high = side(corners[0][0]);
            corners.iter().flatten().all(|&c| side(c) == high).then_some((axis, high))
        })?;
        if ambiguous(config, axis, high) {
            return None;
        }
        let mut next = first(self.surface.indices[n].brick);
        for (i, at) in next.iter_mut().zip(cell.at) {
            *i += at as i64;
        }
        next[axis as usize] += if high == 1 { 1 } else { -1 };
        self.surface.only_apex(next)
    }
}

/// Whether the inside corners of a face are two that share a diagonal only.
fn ambiguous(config: u8, axis: u8, high: u8) -> bool {
    let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
    let base = high << axis;
    let inside = [base, base | u, base | u | v, base | v].map(|c| config >> c & 1);
    inside[0] == inside[2] && inside[1] == inside[3] && inside[0] != inside[1]
}

/// Where planes meet in a cell: by turns the nearest point of their meeting and the nearest point of
/// the cell, since an edge may pass the cell's middle outside and cut a corner of the cell off.
fn meet(cell: &Cell, mean: DVec3, points: &[DVec3], normals: &[DVec3]) -> DVec3 {
    let mut at = mean;
    for _ in 0..8 {
        let to = at + qef::offset(at, points, normals);
        at = within(cell, to, mean);
        if at.abs_diff_eq(to, cell.margin().x * (cell.corner(7) - cell.corner(0)).x) {
            break;
        }
    }
    at
}

/// The point of a cell that is nearest to `p`, rounded.
fn within(cell: &Cell, p: DVec3, mean: DVec3) -> DVec3 {
    let p = if p.is_finite() { p } else { mean };
    cell.position(cell.share(p).clamp(cell.margin(), 1.0 - cell.margin()))
}

/// How far a smooth patch stands out over the mean of its crossings: half way to where their
/// tangent planes meet, which is exact to second order in the size of the cell.
fn bulge(mean: DVec3, points: &[DVec3], normals: &[DVec3]) -> DVec3 {
    let normal = normals.iter().sum::<DVec3>().normalize_or_zero();
    let (mut above, mut slope) = (0.0, 0.0);
    for (p, n) in points.iter().zip(normals) {
        above += n.dot(normal) * n.dot(*p - mean);
        slope += n.dot(normal) * n.dot(normal);
    }
    normal * (0.5 * above / slope)
}
