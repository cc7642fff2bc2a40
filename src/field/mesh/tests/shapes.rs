//! Meshes by property.

use crate::mesh::TriMesh;
use glam::{DVec3, dvec3};
use std::f64::consts::TAU;

/// A closed box.
pub fn block(min: DVec3, max: DVec3) -> TriMesh {
    let at = |i: u32| {
        let pick = |axis: usize| {
            if i >> axis & 1 == 0 { min[axis] } else { max[axis] }
        };
        dvec3(pick(0), pick(1), pick(2))
    };
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriMesh { points: (0..8).map(at).collect(), faces }
}

/// Signed distance to a box.
pub fn block_distance(min: DVec3, max: DVec3, p: DVec3) -> f64 {
    let q = (p - (min + max) * 0.5).abs() - (max - min) * 0.5;
    q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
}

/// A closed surface over a grid that wraps both ways.
pub fn torus(big: f64, small: f64, n: u32) -> TriMesh {
    let at = |i: u32, j: u32| {
        let (s, c) = (f64::from(i) / f64::from(n) * TAU).sin_cos();
        let (z, r) = (f64::from(j) / f64::from(n) * TAU).sin_cos();
        dvec3(c * (big + small * r), s * (big + small * r), small * z)
    };
    let mut mesh = TriMesh::default();
    for i in 0..n {
        for j in 0..n {
            mesh.points.push(at(i, j));
            let id = |i: u32, j: u32| i % n * n + j % n;
            let [a, b, c, d] = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
            mesh.faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

/// A ball with bumps of that height (relative), made by splitting an octahedron `n` times.
pub fn ball(radius: f64, bump: f64, n: u32) -> TriMesh {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let mut flat: Vec<[DVec3; 3]> = (0..8)
        .map(|i| {
            let sign = |k: usize| if i >> k & 1 == 0 { 1.0 } else { -1.0 };
            let t = [0, 1, 2].map(|k| axes[k] * sign(k));
            if sign(0) * sign(1) * sign(2) > 0.0 { t } else { [t[0], t[2], t[1]] }
        })
        .collect();
    for _ in 0..n {
        let middle = |a: DVec3, b: DVec3| (a + b).normalize();
        flat = flat
            .into_iter()
            .flat_map(|[a, b, c]| {
                let (x, y, z) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, x, z], [x, b, y], [z, y, c], [x, y, z]]
            })
            .collect();
    }
    let mut mesh = TriMesh::default();
    for t in flat {
        let k = mesh.points.len() as u32;
        mesh.faces.push([k, k + 1, k + 2]);
        let lift = |p: DVec3| 1.0 + bump * (9.0 * p.x).sin() * (7.0 * p.y).cos();
        mesh.points.extend(t.map(|p| p * lift(p) * radius));
    }
    mesh
}

/// A square in the plane z = const.
pub fn sheet(half: f64, z: f64) -> TriMesh {
    let at = |x: f64, y: f64| dvec3(x * half, y * half, z);
    let points = vec![at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
    TriMesh { points, faces: vec![[0, 1, 2], [0, 2, 3]] }
}

/// Several meshes in one.
pub fn together(parts: &[TriMesh]) -> TriMesh {
    let mut all = TriMesh::default();
    parts.iter().for_each(|p| all.append(p));
    all
}

pub fn flipped(mut mesh: TriMesh) -> TriMesh {
    mesh.flip();
    mesh
}

/// A box without its top.
pub fn open_block(min: DVec3, max: DVec3) -> TriMesh {
    let mut mesh = block(min, max);
    mesh.faces.drain(2..4);
    mesh
}

/// All at once: boxes that cross and lie flush, one inside out, one in another, a sheet through
/// them, a double sheet, an open box, turned and doubled faces.
pub fn dirty() -> TriMesh {
    let v = DVec3::splat;
    let mut mesh = together(&[
        block(dvec3(-30.0, -20.0, 0.0), dvec3(30.0, 20.0, 8.0)),
        flipped(block(dvec3(-28.0, -18.0, -40.0), dvec3(-20.0, -10.0, 0.0))),
        block(dvec3(18.0, 8.0, -40.0), dvec3(26.0, 16.0, 5.0)),
        block(v(2.0), v(6.0)),
        sheet(25.0, 3.0),
        sheet(10.0, 30.0),
        flipped(sheet(10.0, 30.0)),
        open_block(dvec3(-5.0, -5.0, 4.0), dvec3(5.0, 5.0, 24.0)),
        block(dvec3(-30.0, 12.0, 4.0), dvec3(30.0, 24.0, 50.0)),
    ]);
    mesh.faces[3].swap(0, 1);
    let again = mesh.faces[50];
    mesh.faces.extend([again, [0, 0, 1]]);
    mesh
}
