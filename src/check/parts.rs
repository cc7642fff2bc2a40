//! The pieces of a mesh: which of its components are solids, which are cavities, and which are
//! crumbs to sweep off.

use super::topology::{Topology, topology};
use super::weld::{Welded, weld};
use crate::mesh::TriMesh;
use crate::num::Aabb;
use glam::DVec3;
use serde::Serialize;
use std::f64::consts::PI;

/// A component: faces joined through edges, after joining equal points.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Number of faces.
    pub faces: usize,
    /// Signed volume in mm³: positive for a solid, negative for a cavity; meaningless if open.
    pub volume_mm3: f64,
    /// The box round it.
    pub bounds: Aabb,
}

/// How many components stand for matter and how many for holes inside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Pieces {
    /// Components of positive volume.
    pub solids: usize,
    /// Components of negative volume.
    pub cavities: usize,
}

/// What [`drop_crumbs`] took away.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Crumbs {
    /// Number of solids dropped.
    pub count: usize,
    /// Their volume in mm³, less the cavities in them.
    pub volume_mm3: f64,
    /// That volume over the volume of the whole mesh.
    pub share: f64,
}

/// How a mesh hangs together.
pub(super) struct Anatomy {
    pub topology: Topology,
    pub parts: Vec<Part>,
}

impl Anatomy {
    pub fn of(welded: &Welded) -> Self {
        Self::with(welded, topology(welded))
    }

    /// Of a mesh whose topology is known.
    pub fn with(welded: &Welded, topology: Topology) -> Self {
        let parts = parts_of(welded, &topology.labels, topology.components);
        Self { topology, parts }
    }
}

/// The component of each face, numbered by first face, and the components.
pub fn parts(mesh: &TriMesh) -> (Vec<u32>, Vec<Part>) {
    let found = Anatomy::of(&weld(mesh));
    (found.topology.labels, found.parts)
}

/// Counts solids and cavities; meaningful for closed meshes.
pub fn solid_pieces(mesh: &TriMesh) -> Pieces {
    count(&parts(mesh).1)
}

/// The mesh without its small solids: those whose volume, less their cavities, is under that
/// share of the whole. Their cavities go with them; the largest solid always stays, and so does
/// a cavity that lies in no solid. Meaningful for closed meshes.
pub fn drop_crumbs(mesh: &TriMesh, smallest_share: f64) -> (TriMesh, Crumbs) {
    let welded = weld(mesh);
    let found = Anatomy::of(&welded);
    match crumbs(&welded, &found, smallest_share) {
        Some((crumbs, stays)) => (left(mesh, &found.topology.labels, &stays), crumbs),
        None => (mesh.clone(), Crumbs::default()),
    }
}

/// The crumbs of a mesh, if it has any, and for each of its parts whether that stays.
pub(super) fn crumbs(
    welded: &Welded,
    found: &Anatomy,
    smallest: f64,
) -> Option<(Crumbs, Vec<bool>)> {
    let Anatomy { topology, parts } = found;
    if parts.len() < 2 {
        return None;
    }
    let home = homes(welded, &topology.labels, parts);
    let mut volumes = vec![0.0; parts.len()];
    for (part, home) in parts.iter().zip(&home) {
        if let Some(home) = home {
            volumes[*home] += part.volume_mm3;
        }
    }
    let whole: f64 = volumes.iter().sum();
    let largest = (0..parts.len()).max_by(|&i, &j| volumes[i].total_cmp(&volumes[j]));
    let crumb: Vec<bool> = (0..parts.len())
        .map(|i| home[i] == Some(i) && Some(i) != largest && volumes[i] < smallest * whole)
        .collect();
    let mut crumbs = Crumbs::default();
    for i in (0..parts.len()).filter(|&i| crumb[i]) {
        crumbs.count += 1;
        crumbs.volume_mm3 += volumes[i];
    }
    if crumbs.count == 0 {
        return None;
    }
    crumbs.share = crumbs.volume_mm3 / whole;
    let stays = home.iter().map(|home| !home.is_some_and(|home| crumb[home])).collect();
    Some((crumbs, stays))
}

pub(super) fn count(parts: &[Part]) -> Pieces {
    Pieces {
        solids: parts.iter().filter(|p| p.volume_mm3 > 0.0).count(),
        cavities: parts.iter().filter(|p| p.volume_mm3 < 0.0).count(),
    }
}

fn parts_of(mesh: &Welded, labels: &[u32], components: usize) -> Vec<Part> {
    let origin = Aabb::of(mesh.points.iter().copied()).centre();
    let none = Part { faces: 0, volume_mm3: 0.0, bounds: Aabb::EMPTY };
    let mut parts = vec![none; components];
    for (face, &label) in mesh.faces.iter().zip(labels) {
        let corners = face.map(|v| mesh.points[v as usize]);
        let [a, b, c] = corners.map(|p| p - origin);
        let part = &mut parts[label as usize];
        part.faces += 1;
        part.volume_mm3 += a.dot(b.cross(c)) / 6.0;
        part.bounds = corners.into_iter().fold(part.bounds, Aabb::with);
    }
    parts
}

/// The solid that each part belongs to: itself for a solid, the innermost one round a cavity.
fn homes(mesh: &Welded, labels: &[u32], parts: &[Part]) -> Vec<Option<usize>> {
    if parts.iter().all(|part| part.volume_mm3 > 0.0) {
        return (0..parts.len()).map(Some).collect();
    }
    let mut solids: Vec<usize> = (0..parts.len()).filter(|&i| parts[i].volume_mm3 > 0.0).collect();
    solids.sort_by(|&i, &j| parts[i].volume_mm3.total_cmp(&parts[j].volume_mm3));
    let mut faces = vec![Vec::new(); parts.len()];
    for (i, &label) in labels.iter().enumerate() {
        faces[label as usize].push(i);
    }
    let home = |(i, part): (usize, &Part)| {
        if part.volume_mm3 > 0.0 {
            return Some(i);
        }
        let inside = mesh.points[mesh.faces[*faces[i].first()?][0] as usize];
        let holds = |&&s: &&usize| {
            let (outer, inner) = (&parts[s].bounds, &part.bounds);
            outer.contains(inner.min)
                && outer.contains(inner.max)
                && winding(mesh, &faces[s], inside) > 0.5
        };
        solids.iter().find(holds).copied()
    };
    parts.iter().enumerate().map(home).collect()
}

/// Winding number of some faces round a point (Van Oosterom and Strackee 1983, eq. 8).
fn winding(mesh: &Welded, faces: &[usize], p: DVec3) -> f64 {
    let angle = |&i: &usize| {
        let [a, b, c] = mesh.faces[i].map(|v| mesh.points[v as usize] - p);
        let (x, y, z) = (a.length(), b.length(), c.length());
        let below = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
        2.0 * a.dot(b.cross(c)).atan2(below)
    };
    faces.iter().map(angle).sum::<f64>() / (4.0 * PI)
}

/// The faces of the parts that stay, with the points they use, in their order. Faces that name points
/// which are not there do not stay.
pub(super) fn left(mesh: &TriMesh, labels: &[u32], stays: &[bool]) -> TriMesh {
    let total = mesh.points.len();
    let valid = |f: &[u32; 3]| f.iter().all(|&v| (v as usize) < total);
    let faces = mesh.faces.iter().zip(labels);
    let kept: Vec<[u32; 3]> =
        faces.filter(|(f, label)| stays[**label as usize] && valid(f)).map(|(f, _)| *f).collect();
    let mut name = vec![u32::MAX; total];
    kept.iter().flatten().for_each(|&v| name[v as usize] = 0);
    let mut points = Vec::new();
    for (v, name) in name.iter_mut().enumerate().filter(|(_, name)| **name == 0) {
        *name = points.len() as u32;
        points.push(mesh.points[v]);
    }
    TriMesh { points, faces: kept.into_iter().map(|f| f.map(|v| name[v as usize])).collect() }
}
