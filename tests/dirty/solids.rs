//! Clean closed meshes, about 20 mm large. Their volume is that of their faces.

use fieldgraft::mesh::TriMesh;
use glam::{DVec3, dvec3};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

/// A closed box.
pub fn block(min: DVec3, max: DVec3) -> TriMesh {
    let at = |i: u32| {
        let pick = |axis: usize| if i >> axis & 1 == 0 { min[axis] } else { max[axis] };
        dvec3(pick(0), pick(1), pick(2))
    };
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriMesh { points: (0..8).map(at).collect(), faces }
}

/// A ball made by splitting an octahedron `n` times, with bumps of that height (relative).
pub fn ball(radius: f64, bump: f64, n: u32) -> TriMesh {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let points: Vec<DVec3> = (0..6).map(|i| axes[i / 2] * [1.0, -1.0][i % 2]).collect();
    let mut mesh = TriMesh { points, faces: vec![] };
    for i in 0..8u32 {
        let corner = |k: u32| 2 * k + (i >> k & 1);
        let f = [corner(0), corner(1), corner(2)];
        mesh.faces.push(if i.count_ones() % 2 == 0 { f } else { [f[0], f[2], f[1]] });
    }
    for _ in 0..n {
        mesh = split(&mesh);
        mesh.points.iter_mut().for_each(|p| *p = p.normalize());
    }
    let lift = |p: DVec3| 1.0 + bump * (5.0 * p.x).sin() * (4.0 * p.y).cos();
    mesh.points.iter_mut().for_each(|p| *p *= lift(*p) * radius);
    mesh
}

/// Every face in four.
pub fn split(mesh: &TriMesh) -> TriMesh {
    let mut points = mesh.points.clone();
    let mut middles: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
            points.push((mesh.points[a as usize] + mesh.points[b as usize]) * 0.5);
            points.len() as u32 - 1
        })
    };
    let mut faces = vec![];
    for &[a, b, c] in &mesh.faces {
        let (x, y, z) = (middle(a, b), middle(b, c), middle(c, a));
        faces.extend([[a, x, z], [x, b, y], [z, y, c], [x, y, z]]);
    }
    TriMesh { points, faces }
}

/// A ring.
pub fn torus(big: f64, small: f64, n: u32) -> TriMesh {
    let mut mesh = TriMesh::default();
    for i in 0..n {
        for j in 0..n {
            let (s, c) = (f64::from(i) / f64::from(n) * TAU).sin_cos();
            let (z, r) = (f64::from(j) / f64::from(n) * TAU).sin_cos();
            mesh.points.push(dvec3(c * (big + small * r), s * (big + small * r), small * z));
            let id = |i: u32, j: u32| i % n * n + j % n;
            let [a, b, c, d] = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
            mesh.faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

/// The skin of a set of cubes that touch over faces only.
pub fn cubes(cells: &BTreeSet<[i32; 3]>, size: f64) -> TriMesh {
    let mut mesh = TriMesh::default();
    let mut known: BTreeMap<[i32; 3], u32> = BTreeMap::new();
    for &cell in cells {
        for axis in 0..3 {
            for side in [0, 1] {
                let mut beside = cell;
                beside[axis] += 2 * side - 1;
                if cells.contains(&beside) {
                    continue;
                }
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                let ring = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[i, j]| {
                    let mut at = cell;
                    at[axis] += side;
                    at[u] += i;
                    at[v] += j;
                    *known.entry(at).or_insert_with(|| {
                        mesh.points.push(DVec3::from(at.map(f64::from)) * size);
                        mesh.points.len() as u32 - 1
                    })
                });
                let [a, b, c, d] = ring;
                let out = [[a, b, c], [a, c, d]];
                mesh.faces.extend(if side == 1 { out } else { out.map(|[a, b, c]| [a, c, b]) });
            }
        }
    }
    mesh
}

/// A chair of cubes: a seat, four legs, a back.
pub fn chair() -> TriMesh {
    let mut cells = BTreeSet::new();
    for x in 0..7 {
        for y in 0..7 {
            cells.insert([x, y, 6]);
            cells.insert([x, y, 7]);
            if !(2..=4).contains(&x) && !(2..=4).contains(&y) {
                cells.extend((0..6).map(|z| [x, y, z]));
            }
            if y > 4 {
                cells.extend((8..15).map(|z| [x, y, z]));
            }
        }
    }
    cubes(&cells, 1.4)
}

/// The solids that are made dirty.
pub fn all() -> Vec<(&'static str, TriMesh)> {
    let block = block(dvec3(-10.0, -8.0, -6.0), dvec3(10.0, 8.0, 6.0));
    let mut egg = ball(10.0, 0.0, 3);
    egg.points.iter_mut().for_each(|p| *p *= dvec3(1.0, 0.6, 0.45));
    vec![
        ("ball", ball(10.0, 0.0, 3)),
        ("ring", torus(8.0, 3.5, 24)),
        ("block", split(&split(&split(&block)))),
        ("chair", chair()),
        ("bumps", ball(9.0, 0.2, 3)),
        ("egg", egg),
    ]
}

/// The volume of a union of boxes, exact.
pub fn union(boxes: &[(DVec3, DVec3)]) -> f64 {
    let cuts: Vec<Vec<f64>> = (0..3)
        .map(|axis| {
            let mut at: Vec<f64> = boxes.iter().flat_map(|b| [b.0[axis], b.1[axis]]).collect();
            at.sort_by(f64::total_cmp);
            at
        })
        .collect();
    let mut sum = 0.0;
    for x in cuts[0].windows(2) {
        for y in cuts[1].windows(2) {
            for z in cuts[2].windows(2) {
                let (lo, hi) = (dvec3(x[0], y[0], z[0]), dvec3(x[1], y[1], z[1]));
                let middle = (lo + hi) * 0.5;
                let inside =
                    |b: &&(DVec3, DVec3)| middle.cmpgt(b.0).all() && middle.cmplt(b.1).all();
                let cell = (hi - lo).element_product();
                sum += boxes.iter().find(inside).map_or(0.0, |_| cell);
            }
        }
    }
    sum
}
