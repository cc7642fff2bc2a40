//! Which faces cut, touch or fold over others: a box hierarchy finds the pairs, exact
//! predicates judge them.

use super::triangles::{Triangle, meet};
use super::weld::Welded;
use crate::bvh::hierarchy;
use crate::num::Aabb;
use glam::{DVec3, Vec3A};
use obvhs::{BvhBuildParams, aabb::Aabb as Box32};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Beyond this (mm) the predicates' products would overflow.
const FARTHEST: f64 = 1e100;

/// Whether each face meets another beyond the vertices and the edge they share. Faces without
/// area are left out. `None` when some point is not finite, or absurdly far away.
pub(super) fn contacts(mesh: &Welded) -> Option<Vec<bool>> {
    if !mesh.points.iter().all(|p| p.abs().cmplt(DVec3::splat(FARTHEST)).all()) {
        return None;
    }
    // of faces over the same vertices one stands for all: a pile of n copies has n² pairs
    let piles = piles(mesh);
    let mut triangles = Vec::with_capacity(piles.len());
    let mut solid = |pile: &Vec<u32>| {
        let names = mesh.faces[pile[0] as usize];
        let t = Triangle::new(names.map(|v| mesh.points[v as usize]), names);
        t.map(|t| triangles.push(t)).is_some()
    };
    let piles: Vec<Vec<u32>> = piles.into_iter().filter(|pile| solid(pile)).collect();
    let mut met = vec![false; mesh.faces.len()];
    for (pile, met_it) in piles.iter().zip(meetings(&triangles)) {
        pile.iter().for_each(|&i| met[i as usize] = met_it || pile.len() > 1);
    }
    Some(met)
}

/// Faces over the same three vertices.
pub(super) fn piles(mesh: &Welded) -> Vec<Vec<u32>> {
    let mut keys: Vec<([u32; 3], u32)> = mesh
        .faces
        .iter()
        .zip(0..)
        .map(|(f, i)| {
            let mut key = *f;
            key.sort_unstable();
            (key, i)
        })
        .collect();
    keys.par_sort_unstable();
    keys.chunk_by(|a, b| a.0 == b.0).map(|pile| pile.iter().map(|k| k.1).collect()).collect()
}

fn meetings(triangles: &[Triangle]) -> Vec<bool> {
    let met: Vec<AtomicBool> = triangles.iter().map(|_| AtomicBool::new(false)).collect();
    let boxes = boxes(triangles);
    if boxes.is_empty() {
        return Vec::new();
    }
    let tree = hierarchy(&boxes, BvhBuildParams::fast_build());
    // Who meets something has nothing more to find out, and leaves off: many copies of a mesh that
    // differ by rounding have far more pairs than can be looked at.
    let left_off: Vec<AtomicBool> = triangles.iter().map(|_| AtomicBool::new(false)).collect();
    // Neighbours in the tree are neighbours in space: a run of queries stays in the cache.
    let each = |f: &(dyn Fn(usize) + Sync)| {
        tree.primitive_indices
            .par_chunks(256)
            .for_each(|run| run.iter().for_each(|&i| f(i as usize)));
    };
    // The marks only ever rise, and each is looked at until it is risen or there is no pair left: their
    // end state does not depend on who comes first.
    let look = |i: usize, other: &dyn Fn(usize) -> bool| {
        let mine = &boxes[i];
        tree.aabb_traverse(*mine, |tree, node| {
            let node = &tree.nodes[node as usize];
            let first = node.first_index as usize;
            for &j in &tree.primitive_indices[first..first + node.prim_count as usize] {
                let j = j as usize;
                let pair = other(j) && mine.intersect_aabb(&boxes[j]);
                if pair && meet(&triangles[i], &triangles[j]) {
                    met[i].store(true, Relaxed);
                    met[j].store(true, Relaxed);
                }
                if met[i].load(Relaxed) {
                    return false;
                }
            }
            true
        });
    };
    each(&|i| {
        if !met[i].load(Relaxed) {
            look(i, &|j| j > i);
        }
        left_off[i].store(met[i].load(Relaxed), Relaxed);
    });
    if left_off.iter().any(|l| l.load(Relaxed)) {
        // pairs that the lesser of the two left off before
        each(&|i| {
            if !met[i].load(Relaxed) {
                look(i, &|j| j < i && left_off[j].load(Relaxed));
            }
        });
    }
    met.into_iter().map(AtomicBool::into_inner).collect()
}

/// Boxes in f32, in a frame of about unit size. Every step of the way there is monotone, also
/// in its rounding, so boxes that met still meet.
fn boxes(triangles: &[Triangle]) -> Vec<Box32> {
    let all = Aabb::of(triangles.iter().flat_map(|t| t.at));
    let (centre, size) = (all.centre(), all.radius().max(f64::MIN_POSITIVE));
    let small = |p: DVec3| -> Vec3A { ((p - centre) / size).as_vec3a() };
    triangles
        .par_iter()
        .map(|t| {
            let own = Aabb::of(t.at);
            Box32::new(small(own.min), small(own.max))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Triangles over few places, so that all ways of meeting occur.
        #[test]
        fn finds_what_trying_all_pairs_finds(
            points in prop::collection::vec(prop::array::uniform3(0_i32..6), 12),
            faces in prop::collection::vec(prop::array::uniform3(0_u32..12), 1..40),
        ) {
            let points: Vec<DVec3> =
                points.iter().map(|p| DVec3::from(p.map(f64::from)) * 0.1).collect();
            let welded = Welded { points: points.into(), faces: faces.into(), astray: 0 };
            let triangle = |f: &[u32; 3]| Triangle::new(f.map(|v| welded.points[v as usize]), *f);
            let all: Vec<Option<Triangle>> = welded.faces.iter().map(triangle).collect();
            let meets = |i: usize| {
                all.iter().enumerate().any(|(j, other)| match (&all[i], other) {
                    (Some(a), Some(b)) => i != j && meet(a, b),
                    _ => false,
                })
            };
            let want: Vec<bool> = (0..all.len()).map(meets).collect();
            prop_assert_eq!(contacts(&welded), Some(want));
        }
    }
}
