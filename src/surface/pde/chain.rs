//! Chains of patches, and cutting two surfaces so that they have patches in pairs.

use super::patch::Patch;
use glam::{DVec2, DVec3};
use std::{f64::consts::TAU, ops::Range};

/// Two cuts closer than this in a chain's length are one.
const NEAR: f64 = 1e-9;

/// Runs of patches of which each ends in the curve that the next begins with.
pub(super) fn chains(patches: &[Patch]) -> Vec<Range<usize>> {
    let mut out: Vec<Range<usize>> = vec![];
    for (i, patch) in patches.iter().enumerate() {
        let joins = i > 0 && {
            let (end, start) = (patches[i - 1].solution.curve(1.0), patch.solution.curve(0.0));
            end.same(&start)
        };
        match out.last_mut() {
            Some(chain) if joins => chain.end = i + 1,
            _ => out.push(i..i + 1),
        }
    }
    out
}

/// Both surfaces as patches that correspond one to one.
///
/// The first chain of one side belongs to the first of the other, and so on. Two chains are both
/// cut where either has a joint, in equal parts of each chain, which changes no point of them. A chain
/// without partner grows from, or shrinks to, one point of the other side's first chain: the point
/// with the u and v at which its own side's first chain comes nearest to its middle. So a dolphin's
/// fins grow out of where its body will be.
pub(super) fn pair(from: &[Patch], to: &[Patch]) -> Vec<[Patch; 2]> {
    let (a, b) = (chains(from), chains(to));
    let mut pairs = vec![];
    for (a, b) in a.iter().zip(&b) {
        let (a, b) = (&from[a.clone()], &to[b.clone()]);
        let cuts = cuts(a.len(), b.len());
        pairs.extend(cuts.windows(2).map(|w| [piece(a, w), piece(b, w)]));
    }
    let (Some(first_a), Some(first_b)) = (a.first(), b.first()) else { return pairs };
    let (first_a, first_b) = (&from[first_a.clone()], &to[first_b.clone()]);
    for extra in a.iter().skip(b.len()) {
        let seed = seed(&from[extra.clone()], first_a, first_b);
        pairs.extend(from[extra.clone()].iter().map(|p| [p.clone(), p.shrunk(seed)]));
    }
    for extra in b.iter().skip(a.len()) {
        let seed = seed(&to[extra.clone()], first_b, first_a);
        pairs.extend(to[extra.clone()].iter().map(|p| [p.shrunk(seed), p.clone()]));
    }
    pairs
}

/// Where to cut chains of `m` and `n` patches, in [0, 1].
fn cuts(m: usize, n: usize) -> Vec<f64> {
    let joints = |count: usize| (0..=count).map(move |i| i as f64 / count as f64);
    let mut all: Vec<f64> = joints(m).chain(joints(n)).collect();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|b, a| *b - *a < NEAR);
    all
}

/// The part of a chain between two cuts, all of it in one patch.
fn piece(chain: &[Patch], cut: &[f64]) -> Patch {
    let count = chain.len() as f64;
    let middle = (cut[0] + cut[1]) / 2.0 * count;
    let i = (middle as usize).min(chain.len() - 1);
    let local = |x: f64| {
        let u = x * count - i as f64;
        if u.abs() < NEAR * count {
            0.0
        } else if (u - 1.0).abs() < NEAR * count {
            1.0
        } else {
            u
        }
    };
    chain[i].part(local(cut[0]), local(cut[1]))
}

/// The point of chain `there` that corresponds to the point of chain `here` nearest the middle of
/// `extra`.
fn seed(extra: &[Patch], here: &[Patch], there: &[Patch]) -> DVec3 {
    let middles = extra.iter().flat_map(|p| (0..=8).map(|i| p.solution.spine(f64::from(i) / 8.0)));
    let middle = middles.sum::<DVec3>() / (9.0 * extra.len() as f64);
    let (steps, turns) = (24usize, 48u32);
    let mut best = (f64::INFINITY, DVec2::ZERO);
    for i in 0..=steps * here.len() {
        let x = i as f64 / (steps * here.len()) as f64;
        for j in 0..turns {
            let v = TAU * f64::from(j) / f64::from(turns);
            let far = point(here, x, v).distance_squared(middle);
            if far < best.0 {
                best = (far, DVec2::new(x, v));
            }
        }
    }
    point(there, best.1.x, best.1.y)
}

/// The point of a chain at `x` in [0, 1] of its length.
fn point(chain: &[Patch], x: f64, v: f64) -> DVec3 {
    let along = x * chain.len() as f64;
    let i = (along as usize).min(chain.len() - 1);
    chain[i].solution.point(DVec2::new(along - i as f64, v))
}
