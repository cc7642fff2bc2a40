//! Points that coincide bit for bit become one.

use super::TriMesh;
use glam::DVec3;
use rayon::prelude::*;

/// What welding changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Welding {
    /// Points that no face uses, dropped.
    pub unreferenced: usize,
    /// Used points that stood where an earlier one does, merged into it.
    pub merged: usize,
    /// Faces left with fewer than three different corners, dropped.
    pub collapsed: usize,
}

/// The mesh with bit-identical positions merged (-0 counts as 0), without the points that no face
/// uses and the faces that lose a corner. Points and faces keep their order.
pub fn weld(mesh: &TriMesh) -> TriMesh {
    welded(mesh).0
}

/// Rounds all positions to f32, as the files hold them; -0 becomes 0.
pub fn snap(mesh: &mut TriMesh) {
    for p in &mut mesh.points {
        *p = p.as_vec3().as_dvec3() + 0.0;
    }
}

pub(super) fn welded(mesh: &TriMesh) -> (TriMesh, Welding) {
    let mut used = vec![false; mesh.points.len()];
    for &v in mesh.faces.iter().flatten() {
        used[v as usize] = true;
    }
    let twin = twins(&mesh.points, &used);
    let mut counts = Welding::default();
    let mut new = vec![0; mesh.points.len()];
    let mut points = Vec::new();
    for (i, p) in mesh.points.iter().enumerate() {
        if !used[i] {
            counts.unreferenced += 1;
        } else if twin[i] as usize == i {
            new[i] = points.len() as u32;
            points.push(*p + 0.0);
        } else {
            new[i] = new[twin[i] as usize];
            counts.merged += 1;
        }
    }
    let mut faces = Vec::with_capacity(mesh.faces.len());
    faces.extend(mesh.faces.iter().map(|f| f.map(|v| new[v as usize])).filter(has_three));
    counts.collapsed = mesh.faces.len() - faces.len();
    (TriMesh { points, faces }, counts)
}

fn has_three(f: &[u32; 3]) -> bool {
    f[0] != f[1] && f[1] != f[2] && f[2] != f[0]
}

/// Whether no two points that faces use are one when rounded to f32.
pub(super) fn distinct_in_f32(mesh: &TriMesh) -> bool {
    let mut used = vec![false; mesh.points.len()];
    for &v in mesh.faces.iter().flatten() {
        used[v as usize] = true;
    }
    let single = |&i: &u32| bits(mesh.points[i as usize].as_vec3().as_dvec3());
    let all = (0..mesh.points.len() as u32).into_par_iter().filter(|&i| used[i as usize]);
    let mut keys: Vec<(u64, u32)> = all.map(|i| (hash(single(&i)), i)).collect();
    keys.par_sort_unstable();
    keys.par_chunk_by(|a, b| a.0 == b.0).filter(|run| run.len() > 1).all(|run| {
        let mut here: Vec<[u64; 3]> = run.iter().map(|(_, i)| single(i)).collect();
        here.sort_unstable();
        here.windows(2).all(|pair| pair[0] != pair[1])
    })
}

/// For each used point the first used point at the same position (itself, if there is no earlier).
pub(crate) fn twins(points: &[DVec3], used: &[bool]) -> Vec<u32> {
    let key = |i: u32| (hash(bits(points[i as usize])), i);
    let all = 0..points.len() as u32;
    let count = used.iter().filter(|&&u| u).count();
    let mut keys = Vec::with_capacity(count);
    if count == points.len() {
        keys.par_extend(all.clone().into_par_iter().map(key));
    } else {
        // in one list: many short ones, joined, would take twice the memory
        keys.extend(all.clone().filter(|&i| used[i as usize]).map(key));
    }
    keys.par_sort_unstable();
    let mut twin: Vec<u32> = all.collect();
    for run in keys.chunk_by_mut(|a, b| a.0 == b.0).filter(|run| run.len() > 1) {
        let here = |k: &(u64, u32)| bits(points[k.1 as usize]);
        let first = here(&run[0]);
        if run.iter().any(|k| here(k) != first) {
            run.sort_unstable_by_key(|k| (here(k), k.1)); // two positions, one hash
        }
        for same in run.chunk_by(|a, b| here(a) == here(b)) {
            same.iter().for_each(|k| twin[k.1 as usize] = same[0].1);
        }
    }
    twin
}

fn bits(p: DVec3) -> [u64; 3] {
    (p + 0.0).to_array().map(f64::to_bits)
}

/// Equal bits, equal hash; sorting one word is much faster than sorting three.
fn hash(bits: [u64; 3]) -> u64 {
    bits.iter().fold(0, |h, b| {
        let x = (h ^ b).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        (x ^ (x >> 32)).wrapping_mul(0xD6E8_FEB8_6659_FD93).rotate_left(23)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_soup_of_two_triangles_becomes_a_square() {
        let at = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let soup = TriMesh {
            points: vec![
                at(9.0, 9.0), // stray
                at(0.0, 0.0),
                at(1.0, 0.0),
                at(1.0, 1.0),
                at(-0.0, 0.0),
                at(1.0, 1.0),
                at(0.0, 1.0),
            ],
            faces: vec![[1, 2, 3], [4, 5, 6], [1, 4, 2]],
        };
        let (mesh, counts) = welded(&soup);
        assert_eq!(mesh.points, vec![at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)]);
        assert_eq!(mesh.faces, vec![[0, 1, 2], [0, 2, 3]]);
        assert_eq!(counts, Welding { unreferenced: 1, merged: 2, collapsed: 1 });
        assert_eq!(weld(&mesh), mesh);
    }

    #[test]
    fn snapping_is_idempotent_and_has_no_negative_zero() {
        let mut mesh = TriMesh { points: vec![DVec3::new(0.1, -0.0, -1e-60)], faces: vec![] };
        snap(&mut mesh);
        let once = mesh.clone();
        assert_eq!(mesh.points[0].x, f64::from(0.1f32));
        assert!(mesh.points[0].y.is_sign_positive() && mesh.points[0].z.is_sign_positive());
        snap(&mut mesh);
        assert_eq!(mesh, once);
    }
}
