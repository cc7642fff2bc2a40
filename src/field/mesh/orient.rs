//! Which way each shell faces: solids outwards, cavities inwards.

use super::shells::Shell;
use super::soup::Sets;
use crate::bvh::Winding;
use crate::num::Aabb;
use glam::DVec3;
use std::collections::BTreeMap;

/// Corners of a shell that are looked at to find what contains it.
const PROBES: usize = 8;
/// A winding number beyond this counts as inside a container, small holes and all.
const WITHIN: f64 = 0.75;

/// An open shell whose volume is less than this times its area to the power 3/2 is a sheet
/// with no inside to turn outwards; a ball has 0.094.
const FLAT: f64 = 5e-3;

/// One shell, measured.
struct Measured {
    /// Signed volume, mm³; an open shell is closed by a lid on each rim, a flat one has none.
    volume: f64,
    bounds: Aabb,
    probes: Vec<DVec3>,
}

fn measure(points: &[DVec3], faces: &[[u32; 3]], shell: &Shell) -> Measured {
    let at = |v: u32| points[v as usize];
    let corners = || shell.faces.iter().flat_map(|&f| faces[f as usize]);
    let bounds = Aabb::of(corners().map(at));
    let origin = bounds.centre();
    let cone = |t: [DVec3; 3]| {
        let [a, b, c] = t.map(|p| p - origin);
        a.dot(b.cross(c)) / 6.0
    };
    let own = shell.faces.iter().map(|&f| cone(faces[f as usize].map(at)));
    let volume = own.sum::<f64>() + lids(points, &shell.rim).into_iter().map(cone).sum::<f64>();
    let size = |&f: &u32| {
        let [a, b, c] = faces[f as usize].map(at);
        (b - a).cross(c - a).length() * 0.5
    };
    let area: f64 = shell.faces.iter().map(size).sum();
    let flat = !shell.rim.is_empty() && volume.abs() < FLAT * area.powf(1.5);
    let volume = if flat { 0.0 } else { volume };
    let step = (shell.faces.len() * 3).div_ceil(PROBES).max(1);
    let probes = corners().step_by(step).map(at).collect();
    Measured { volume, bounds, probes }
}

/// Triangles that close the rims: each connected rim has a fan round its middle.
fn lids(points: &[DVec3], rim: &[([u32; 2], u32)]) -> Vec<[DVec3; 3]> {
    let at = |v: u32| points[v as usize];
    let mut ends: Vec<u32> = rim.iter().flat_map(|r| r.0).collect();
    ends.sort_unstable();
    ends.dedup();
    let place = |v: u32| ends.partition_point(|&e| e < v) as u32;
    let mut sets = Sets::new(ends.len());
    rim.iter().for_each(|&([a, b], _)| sets.join(place(a), place(b)));
    let mut middles: BTreeMap<u32, (DVec3, f64)> = BTreeMap::new();
    for &([a, b], _) in rim {
        let length = at(a).distance(at(b));
        let (sum, total) = middles.entry(sets.find(place(a))).or_default();
        *sum += (at(a) + at(b)) * (0.5 * length);
        *total += length;
    }
    let mut out = vec![];
    for &([a, b], n) in rim {
        let (sum, total) = middles[&sets.find(place(a))];
        // the lid runs along the rim against the faces
        let lid = [at(b), at(a), sum / total.max(f64::MIN_POSITIVE)];
        out.extend(std::iter::repeat_n(lid, n as usize));
    }
    out
}

fn holds(outer: &Aabb, inner: &Aabb) -> bool {
    outer.contains(inner.min) && outer.contains(inner.max)
}

/// Turns shells that are inside out; a shell wholly inside another keeps its orientation relative
/// to that one, so that cavities stay cavities. Returns how many were turned.
pub(super) fn right(points: &[DVec3], faces: &mut [[u32; 3]], shells: &[Shell]) -> usize {
    let all: Vec<_> = shells.iter().map(|s| measure(points, faces, s)).collect();
    let mut order: Vec<usize> = (0..shells.len()).collect();
    // containers come before what they contain
    order.sort_by(|&i, &j| all[j].volume.abs().total_cmp(&all[i].volume.abs()).then(i.cmp(&j)));
    let mut winding: Vec<Option<Winding>> = vec![None; shells.len()];
    let mut turn = vec![false; shells.len()];
    // what has no volume contains nothing
    let solid = order.iter().filter(|&&i| all[i].volume != 0.0).count();
    for (rank, &i) in order.iter().enumerate() {
        // the last that contains it is the smallest
        let container = order[..rank.min(solid)].iter().rev().copied().find(|&j| {
            if !holds(&all[j].bounds, &all[i].bounds) {
                return false;
            }
            let corners = |&f: &u32| faces[f as usize].map(|v| points[v as usize]);
            let w = winding[j].get_or_insert_with(|| {
                Winding::new(&shells[j].faces.iter().map(corners).collect::<Vec<_>>())
            });
            let inside = |&p: &DVec3| {
                let number = w.number(p, WITHIN);
                number >= WITHIN || number < 0.0 && w.number(p, -WITHIN) <= -WITHIN
            };
            all[i].probes.iter().all(inside)
        });
        turn[i] = match container {
            Some(j) => turn[j],
            None => all[i].volume < 0.0,
        };
    }
    for (shell, _) in shells.iter().zip(&turn).filter(|(_, t)| **t) {
        shell.faces.iter().for_each(|&f| faces[f as usize].swap(1, 2));
    }
    turn.iter().filter(|&&t| t).count()
}
