//! Normals of a mesh whose points may lie on seams.

use crate::mesh::TriMesh;
use glam::DVec3;
use std::collections::HashMap;

/// Cosine of the angle up to which the normals of points at one place are made one.
const SMOOTH: f64 = 0.5;
/// Points closer than this part of the mesh's size are at one place.
const SNAP: f64 = 1e-7;

/// A normal for every point: of the faces round it, and round those at the same place, weighted by
/// their areas. Of no particular length, zero where there is none.
pub(super) fn normals(mesh: &TriMesh) -> Vec<DVec3> {
    let mut own = vec![DVec3::ZERO; mesh.points.len()];
    for (i, face) in mesh.faces.iter().enumerate() {
        let area = mesh.area_vector(i);
        face.iter().for_each(|&v| own[v as usize] += area);
    }
    let cell = (SNAP * mesh.bounds().size().length()).max(f64::MIN_POSITIVE);
    let key = |p: DVec3| (p / cell).round().to_array().map(|x| x as i64);
    let mut places: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    for (v, &p) in mesh.points.iter().enumerate() {
        places.entry(key(p)).or_default().push(v as u32);
    }
    let agree = |a: DVec3, b: DVec3| a.dot(b) >= SMOOTH * a.length() * b.length();
    let mut out = own.clone();
    for group in places.values().filter(|g| g.len() > 1) {
        let all: DVec3 = group.iter().map(|&v| own[v as usize]).sum();
        for &v in group {
            let n = own[v as usize];
            let near = group.iter().map(|&w| own[w as usize]).filter(|&m| agree(n, m));
            out[v as usize] = if n == DVec3::ZERO { all } else { near.sum() };
        }
    }
    out
}
