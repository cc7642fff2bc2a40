//! Which way each shell faces: solids outwards, cavities inwards.

use super::shells::Shell;
use crate::bvh::Winding;
use crate::num::Aabb;
use glam::DVec3;

/// Corners of a shell that are looked at to find what contains it.
const PROBES: usize = 8;
/// A winding number beyond this counts as inside a container, small holes and all.
const WITHIN: f64 = 0.75;

/// One shell, measured.
struct Measured {
    /// Signed volume, mm³; an open shell is closed by cones over its rims.
    volume: f64,
    bounds: Aabb,
    probes: Vec<DVec3>,
}

fn measure(points: &[DVec3], faces: &[[u32; 3]], shell: &Shell) -> Measured {
    let at = |v: u32| points[v as usize];
    let corners = || shell.faces.iter().flat_map(|&f| faces[f as usize]);
    let bounds = Aabb::of(corners().map(at));
    // the mean of the rim is the tip of the cones
    let (mut middle, mut length) = (DVec3::ZERO, 0.0);
    for &([a, b], _) in &shell.rim {
        let part = at(a).distance(at(b));
        middle += (at(a) + at(b)) * (0.5 * part);
        length += part;
    }
    let origin = if length > 0.0 {
        middle / length
    } else {
        bounds.centre()
    };
    let part = |&f: &u32| {
        let [a, b, c] = faces[f as usize].map(|v| at(v) - origin);
        a.dot(b.cross(c)) / 6.0
    };
    let volume = shell.faces.iter().map(part).sum();
    let step = (shell.faces.len() * 3).div_ceil(PROBES).max(1);
    let probes = corners().step_by(step).map(at).collect();
    Measured {
        volume,
        bounds,
        probes,
    }
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
    order.sort_by(|&i, &j| {
        all[j]
            .volume
            .abs()
            .total_cmp(&all[i].volume.abs())
            .then(i.cmp(&j))
    });
    let mut winding: Vec<Option<Winding>> = vec![None; shells.len()];
    let mut turn = vec![false; shells.len()];
    for (rank, &i) in order.iter().enumerate() {
        // the last that contains it is the smallest
        let container = order[..rank].iter().rev().copied().find(|&j| {
            if !holds(&all[j].bounds, &all[i].bounds) {
                return false;
            }
            let corners = |&f: &u32| faces[f as usize].map(|v| points[v as usize]);
            let w = winding[j].get_or_insert_with(|| {
                Winding::new(&shells[j].faces.iter().map(corners).collect::<Vec<_>>())
            });
            let inside = |&p: &DVec3| w.number(p, WITHIN).abs() >= WITHIN;
            all[i].probes.iter().all(inside)
        });
        turn[i] = match container {
            Some(j) => turn[j],
            None => all[i].volume < 0.0,
        };
    }
    for (shell, _) in shells.iter().zip(&turn).filter(|(_, t)| **t) {
        shell
            .faces
            .iter()
            .for_each(|&f| faces[f as usize].swap(1, 2));
    }
    turn.iter().filter(|&&t| t).count()
}
