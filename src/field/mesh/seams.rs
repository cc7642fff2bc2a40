//! Rims that lie on each other: edges split at different places, corners a hair apart.

use crate::bvh::Bvh;
use crate::num::Aabb;
use glam::DVec3;
use std::collections::HashMap;

/// For every rim edge (two point indices) the chain of points from its first end to its second:
/// ends are replaced by the first rim point within `tolerance` mm, and rim points within that of
/// the edge are inserted. Rims that coincide in space have the same links then.
pub(super) fn chains(points: &[DVec3], rims: &[(u32, u32)], tolerance: f64) -> Vec<Vec<u32>> {
    let same = clusters(points, rims, tolerance);
    let ends = |&(a, b): &(u32, u32)| (same[&a], same[&b]);
    let at = |v: u32| points[v as usize];
    let flat: Vec<_> = rims.iter().map(ends).map(|(a, b)| [at(a), at(b), at(b)]).collect();
    let bvh = Bvh::new(&flat);
    let mut inner: Vec<Vec<(f64, u32)>> = vec![vec![]; rims.len()];
    let mut heads: Vec<u32> = same.values().copied().collect();
    heads.sort_unstable();
    heads.dedup();
    for v in heads {
        let p = at(v);
        for edge in bvh.overlapping(&Aabb::new(p, p), tolerance) {
            let (a, b) = ends(&rims[edge as usize]);
            let along = at(b) - at(a);
            let t = (p - at(a)).dot(along) / along.length_squared();
            let off = (at(a) + along * t).distance(p);
            if v != a && v != b && t > 0.0 && t < 1.0 && off <= tolerance {
                inner[edge as usize].push((t, v));
            }
        }
    }
    let chain = |(edge, mut inner): (&(u32, u32), Vec<(f64, u32)>)| {
        inner.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        let (a, b) = ends(edge);
        std::iter::once(a).chain(inner.into_iter().map(|(_, v)| v)).chain([b]).collect()
    };
    rims.iter().zip(inner).map(chain).collect()
}

/// For every rim point the first one within the tolerance of it.
fn clusters(points: &[DVec3], rims: &[(u32, u32)], tolerance: f64) -> HashMap<u32, u32> {
    let mut rim: Vec<u32> = rims.iter().flat_map(|&(a, b)| [a, b]).collect();
    rim.sort_unstable();
    rim.dedup();
    let mut heads: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    let mut same = HashMap::new();
    for v in rim {
        let p = points[v as usize];
        let cell = (p / tolerance).floor().to_array().map(|x| x as i64);
        let near = (0..27i64).find_map(|i| {
            let step = [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1];
            let key: [i64; 3] = std::array::from_fn(|k| cell[k].saturating_add(step[k]));
            let close = |h: &&u32| points[**h as usize].distance(p) <= tolerance;
            heads.get(&key)?.iter().find(close).copied()
        });
        if near.is_none() {
            heads.entry(cell).or_default().push(v);
        }
        same.insert(v, near.unwrap_or(v));
    }
    same
}
