//! What casts the shadows.

use super::alike::{firsts, splitmix};
use super::scene::Scene;
use glam::Vec3;
use rayon::prelude::*;
use std::borrow::Cow;
use std::ops::Range;

/// Texels along the longer side of a depth map for each pixel of the picture, and the bounds.
/// More, and the maps take longer than the picture; fewer, and rods cast no shadow.
const TEXELS: f32 = 0.4;
const FEWEST: f32 = 96.0;
const MOST: f32 = 384.0;
/// Side of the cells within which a coarser copy has one point, in texels: errors stay under
/// [`LIFT`].
const COARSE: f32 = 1.4;
/// Cells along each side of a cube's sides, by which faces that look one way are told.
const CELLS: usize = 8;
/// How much a group must look away from a light to be left out (cosine): round-off of places on a map
/// must not turn a face that is not too thin.
const AWAY: f32 = 0.05;
/// Faces thinner than this, in texels, may be turned by round-off.
const FINEST: f32 = 0.01;

/// Texels along the longer side of a depth map for a picture of that many pixels along its own.
pub(super) fn texels(pixels: f32) -> f32 {
    (pixels * TEXELS).clamp(FEWEST, MOST).round()
}

/// What casts the shadows: the mesh, with the points of a cell made one when it is fine.
pub(super) struct Caster<'a> {
    pub points: Cow<'a, [Vec3]>,
    /// Group by group.
    pub faces: Cow<'a, [[u32; 3]]>,
    pub groups: Vec<Group>,
    pub corners: [Vec3; 8],
    /// Whether every ray from outside meets a face from its front first: the mesh is closed, and its
    /// faces are turned outwards.
    pub closed: bool,
    /// Texels along the longer side of its depth maps.
    pub texels: f32,
}

impl<'a> Caster<'a> {
    /// For a picture with that many pixels along its longer side.
    pub fn of(scene: &'a Scene, pixels: f32) -> Self {
        let corners = scene.corners();
        let texels = texels(pixels);
        // With fewer faces than a map has texels a coarser copy saves nothing.
        if (scene.faces.len() as f32) < texels * texels {
            let (points, faces) = (Cow::from(&scene.points), Cow::from(&scene.faces));
            return Self::new(points, faces, corners, texels);
        }
        let scale = texels / COARSE / (scene.max - scene.min).max_element();
        let cell = |v: u32| {
            // Unused points may lie anywhere; the casts saturate.
            let [x, y, z] = ((scene.points[v as usize] - scene.min) * scale).to_array();
            [x as u32, y as u32, z as u32]
        };
        let first = firsts(scene.points.len(), cell);
        let mut name = vec![0; scene.points.len()];
        let mut points = Vec::new();
        for (v, &first) in first.iter().enumerate() {
            if first as usize == v {
                name[v] = points.len() as u32;
                points.push(scene.points[v]);
            } else {
                name[v] = name[first as usize];
            }
        }
        let rename = |f: &[u32; 3]| f.map(|v| name[v as usize]);
        let whole = |f: &[u32; 3]| f[0] != f[1] && f[1] != f[2] && f[2] != f[0];
        let faces: Vec<[u32; 3]> = scene.faces.par_iter().map(rename).filter(whole).collect();
        Self::new(Cow::from(points), Cow::from(faces), corners, texels)
    }

    fn new(
        points: Cow<'a, [Vec3]>,
        faces: Cow<'a, [[u32; 3]]>,
        corners: [Vec3; 8],
        texels: f32,
    ) -> Self {
        let closed = closed(&points, &faces);
        if !closed {
            let groups = vec![Group::any(0..faces.len())];
            return Self { points, faces, groups, corners, closed, texels };
        }
        let finest = FINEST * (corners[7] - corners[0]).max_element() / texels;
        let (groups, faces) = grouped(&points, &faces, finest);
        Self { points, faces: Cow::from(faces), groups, corners, closed, texels }
    }
}

/// Whether the sides of faces cancel, as those of closed surfaces do, and they enclose a volume. Sides
/// are summed by a hash, so this is wrong for one mesh in 2^64.
fn closed(points: &[Vec3], faces: &[[u32; 3]]) -> bool {
    let side = |a: u32, b: u32| {
        let both = u64::from(a.min(b)) << 32 | u64::from(a.max(b));
        let hash = splitmix(both);
        if a < b { hash } else { hash.wrapping_neg() }
    };
    let sides = faces
        .par_iter()
        .map(|&[a, b, c]| side(a, b).wrapping_add(side(b, c)).wrapping_add(side(c, a)));
    // in one order, so that round-off is the same on any number of threads
    let volume = faces.iter().map(|f| {
        let [a, b, c] = f.map(|v| points[v as usize].as_dvec3());
        a.dot(b.cross(c))
    });
    sides.reduce(|| 0, u64::wrapping_add) == 0 && volume.sum::<f64>() > 0.0
}

/// Faces that look much the same way.
pub(super) struct Group {
    pub faces: Range<usize>,
    /// A normal, and how far others are from it at most.
    normal: Vec3,
    spread: f32,
}

impl Group {
    /// Of faces that look any way.
    pub fn any(faces: Range<usize>) -> Self {
        Self { faces, normal: Vec3::Z, spread: f32::INFINITY }
    }

    /// Whether all its faces look away from a light.
    pub fn looks_away(&self, toward: Vec3) -> bool {
        self.normal.dot(toward) + self.spread < -AWAY
    }
}

/// Faces sorted by the way they look; those thinner than `finest` make one group.
fn grouped(points: &[Vec3], faces: &[[u32; 3]], finest: f32) -> (Vec<Group>, Vec<[u32; 3]>) {
    let normals: Vec<Vec3> = faces.par_iter().map(|f| normal(points, f, finest)).collect();
    let mut groups = Vec::new();
    let mut sorted = Vec::with_capacity(faces.len());
    let mut members = vec![Vec::new(); ANY + 1];
    normals.iter().enumerate().for_each(|(i, &n)| members[cell(n)].push(i));
    for (cell, members) in members.into_iter().enumerate().filter(|(_, m)| !m.is_empty()) {
        let range = sorted.len()..sorted.len() + members.len();
        sorted.extend(members.iter().map(|&i| faces[i]));
        if cell == ANY {
            groups.push(Group::any(range));
            continue;
        }
        let normal = normals[members[0]];
        let spread = members.iter().map(|&i| normals[i].distance(normal)).fold(0.0, f32::max);
        groups.push(Group { faces: range, normal, spread });
    }
    (groups, sorted)
}

/// The cell of faces that look any way.
const ANY: usize = 6 * CELLS * CELLS;

/// Unit normal of a face, zero if it is thinner than `finest`.
fn normal(points: &[Vec3], f: &[u32; 3], finest: f32) -> Vec3 {
    let [a, b, c] = f.map(|v| points[v as usize]);
    let vector = (b - a).cross(c - a);
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    if vector.length() > longest * finest { vector.normalize_or_zero() } else { Vec3::ZERO }
}

/// Where a normal meets a cube.
fn cell(normal: Vec3) -> usize {
    if normal == Vec3::ZERO {
        return ANY;
    }
    let axis = normal.abs().max_position();
    let along = normal[axis];
    let place = |v: f32| (((v / along.abs() + 1.0) * 0.5 * CELLS as f32) as usize).min(CELLS - 1);
    let side = 2 * axis + usize::from(along < 0.0);
    (side * CELLS + place(normal[(axis + 1) % 3])) * CELLS + place(normal[(axis + 2) % 3])
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::mesh::TriMesh;

    /// An L of unequal bricks: not convex, so that faces lie behind faces.
    pub fn hook() -> TriMesh {
        let profile = [[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
        let at = |z: f64| profile.map(|[x, y]| glam::dvec3(x, y, z));
        let points = [at(0.0), at(2.0)].concat();
        let mut faces = vec![];
        for [a, b, c] in [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]] {
            faces.extend([[a, c, b], [a + 6, b + 6, c + 6]]);
        }
        for a in 0..6 {
            let b = (a + 1) % 6;
            faces.extend([[a, b, b + 6], [a, b + 6, a + 6]]);
        }
        TriMesh { points, faces }
    }

    #[test]
    fn groups_hold_all_faces_and_look_away_only_where_all_do() {
        let ball =
            |i: u32| (glam::Vec3::new((i / 30) as f32 - 15.0, (i % 30) as f32 - 15.0, 0.0), i);
        let mut points: Vec<Vec3> = hook().points.iter().map(|p| p.as_vec3()).collect();
        let mut faces = hook().faces;
        // Small faces that look everywhere.
        for (at, i) in (0..900).map(ball) {
            let turn = glam::Quat::from_scaled_axis(at * 0.2);
            let first = points.len() as u32;
            points.extend([Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| turn * p + i as f32));
            faces.push([first, first + 1, first + 2]);
        }
        // And a needle, whose normal means little.
        let first = points.len() as u32;
        points.extend([Vec3::ZERO, Vec3::X, Vec3::new(2.0, 1e-5, 0.0)]);
        faces.push([first, first + 1, first + 2]);
        let (groups, mut sorted) = grouped(&points, &faces, 1e-3);
        let mut away = 0;
        for toward in [Vec3::Z, Vec3::NEG_Z, Vec3::new(0.6, -0.8, 0.0), Vec3::new(0.36, 0.48, 0.8)]
        {
            for group in groups.iter().filter(|g| g.looks_away(toward)) {
                away += group.faces.len();
                for f in &sorted[group.faces.clone()] {
                    assert!(normal(&points, f, 1e-3).dot(toward) < 0.0, "{toward}");
                }
            }
        }
        assert!(away > sorted.len(), "a third of the faces, at least: {away}");
        sorted.sort_unstable();
        faces.sort_unstable();
        assert_eq!(sorted, faces);
    }

    #[test]
    fn open_and_inverted_meshes_are_not_closed() {
        let is_closed = |mesh: &TriMesh| {
            let points: Vec<Vec3> = mesh.points.iter().map(|p| p.as_vec3()).collect();
            closed(&points, &mesh.faces)
        };
        let mut mesh = hook();
        assert!(is_closed(&mesh));
        let inverted = TriMesh {
            faces: mesh.faces.iter().map(|&[a, b, c]| [a, c, b]).collect(),
            ..mesh.clone()
        };
        assert!(!is_closed(&inverted));
        mesh.faces.pop();
        assert!(!is_closed(&mesh));
    }
}
