//! Automatic parameters, measured on the shapes as they lie in the hybrid's frames (GRAFT.md,
//! recipe E; METHODS B).

use super::hybrid::{Hybrid, Looked, Placed};
use super::inner::{Local, grow};
use super::plan::{Form, Inner, SpaceTime};
use super::space_time::{Bounded, height_for_volume};
use crate::job::{self, Cancelled, Job};
use crate::num::Aabb;
use glam::DVec3;
use rayon::prelude::*;

/// Samples along each side of a feature: 24³ see a leg of a tenth of the feature's width.
const FEATURE_SIDE: usize = 24;
/// Samples along the longest side of the whole shape: 64 see a leg of 15 mm on a chair of 900 mm.
const WHOLE_SIDE: f64 = 64.0;
/// Least reach, mm: a feature whose parts nearly agree still has to hold what stands beside it.
const LEAST_REACH: f64 = 20.0;
/// Factor on the measured reach, since the samples miss the very farthest point.
const REACH_MARGIN: f64 = 1.1;
/// Largest level of the linear form, mm: more fattens thin members instead of mending them.
const LEVEL_CAP: f64 = 12.0;
/// Largest share of its half thickness by which a shape is thinned: more leaves nothing of its traits.
const THINNEST: f64 = 0.7;
/// Largest share by which a shape is thickened where the merged shapes have too little volume.
const THICKEST: f64 = 0.3;
/// A share at which even a shape of nine tenths of the weight is at its limit.
const LARGEST_SHARE: f64 = 3.5;
/// Halvings of the range of shares: to a thousandth.
const HALVINGS: u32 = 12;
/// Ratio of the weights from which on a lesser shape is there whole: below it parts come and go.
const WHOLE_FROM: f64 = 0.4;
/// The same where it comes at once.
const AT_ONCE_FROM: f64 = 0.3;
/// Largest height of the space-time blend in units of the reach: near t = 0 and 1 the blend is weak,
/// and the height that would keep the volume grows without bound.
const HEIGHT_CAP: f64 = 4.0;
/// Least height of the half-cylinders' blend in units of the reach: half way their base is zero all
/// over the first shape, and only the blend says that this is inside.
const CYLINDERS_FLOOR: f64 = 0.02;

/// What is measured for one feature.
pub(super) struct Measured {
    pub local: Local,
    /// How much each shape is thinned, mm.
    pub thin: Vec<f64>,
}

/// Half of the least thickness that a member is thinned to, cells: less falls between samples.
const HALF_LEAST: f64 = 0.75;
/// Share of a shape's volume in a feature that may be in members thinner than its thin ones. Smaller, a
/// few posts keep a thick back from being thinned (volumes of 1.5 to 2 over a third of 84 frames); where
/// this breaks them the search takes the union.
const THIN_MEMBERS: f64 = 0.3;
/// Least rate at which the depth grows on the way to the middle of a member: along the axis of a leg that
/// widens it grows more slowly.
const CLIMB: f64 = 0.3;

/// Samples of a feature: a cube of them, a row a sample.
pub(super) struct Site<'a> {
    /// Values of the k shapes.
    pub g: &'a [f64],
    /// Volumes of the shapes' elements over that of the result's.
    pub sizes: &'a [f64],
    /// From sample to sample, mm; none where the samples are no cube.
    pub step: Option<DVec3>,
    /// Side of the result's cells, mm.
    pub cell: f64,
}

/// Parameters of one feature from its samples and the weights `lam` of the k shapes.
pub(super) fn measured(at: &Site<'_>, lam: &[f64], inner: Inner) -> Measured {
    let (mut local, wanted) = local(at.g, lam, at.sizes);
    let mut thin = vec![0.0; lam.len()];
    match inner {
        Inner::Linear => (local.apart, local.level) = (0.0, 0.0),
        Inner::Mean => local.apart = 0.0,
        Inner::Grow | Inner::Erode | Inner::SpaceTime => local.apart = 1.0,
        Inner::Merge | Inner::Union => {
            local.apart = 1.0;
            // by even shares what grows in may be loose until it meets the rest; at once it rarely is
            local.reach = match inner {
                Inner::Merge => revealed(at.g, lam, local.reach),
                _ => local.reach / AT_ONCE_FROM,
            };
            if inner == Inner::Merge {
                thin = thinning(at, lam, local.reach, wanted);
            }
        }
        Inner::Auto => {}
    }
    Measured { local, thin }
}

/// The reach at which a lesser shape of two grows in by even shares of its volume until it is there
/// whole: by distance alone nearly all of it would come at once.
fn revealed(g: &[f64], lam: &[f64], reach: f64) -> f64 {
    let whole = reach / WHOLE_FROM;
    let mut present = (0..lam.len()).filter(|&j| lam[j] > 0.0);
    let (Some(a), Some(b), None) = (present.next(), present.next(), present.next()) else {
        return whole;
    };
    let (lesser, top) = if lam[a] < lam[b] { (a, b) } else { (b, a) };
    let ratio = lam[lesser] / lam[top];
    let inside = g.chunks_exact(lam.len()).filter(|row| row[lesser] < 0.0);
    let mut far: Vec<f64> = inside.map(|row| row[top]).collect();
    if ratio >= WHOLE_FROM || far.is_empty() {
        return whole;
    }
    let rank = (ratio / WHOLE_FROM * far.len() as f64) as usize;
    let rank = rank.min(far.len() - 1);
    let (_, far, _) = far.select_nth_unstable_by(rank, f64::total_cmp);
    far.max(0.0) / ratio
}

/// Half thicknesses of a shape, mm.
#[derive(Clone, Copy, Default)]
struct Half {
    mean: f64,
    /// Of its thin members.
    low: f64,
}

impl Half {
    fn of(at: &Site<'_>, k: usize, j: usize) -> Self {
        let depth = |n: usize| -at.g[n * k + j];
        let inside: Vec<usize> = (0..at.g.len() / k).filter(|&n| depth(n) > 0.0).collect();
        if inside.is_empty() {
            return Self::default();
        }
        let sum: f64 = inside.iter().map(|&n| depth(n)).sum();
        // depths in a plate run evenly from none to its half thickness
        let mean = 2.0 * sum / inside.len() as f64;
        let Some(step) = at.step else { return Self { mean, low: mean } };
        let mut middle: Vec<f64> = inside.iter().map(|&n| climb(&depth, step, n)).collect();
        let rank = (THIN_MEMBERS * (middle.len() - 1) as f64) as usize;
        let low = *middle.select_nth_unstable_by(rank, f64::total_cmp).1;
        Self { mean, low }
    }
}

/// The depth in the middle of the member that sample `n` lies in.
fn climb(depth: &impl Fn(usize) -> f64, step: DVec3, mut n: usize) -> f64 {
    let side = FEATURE_SIDE;
    let ways = [(1, side, step.x), (side, side, step.y), (side * side, side, step.z)];
    loop {
        let here = depth(n);
        let mut best = (CLIMB, n);
        for (by, side, step) in ways {
            let place = n / by % side;
            let next = [(place > 0).then(|| n - by), (place + 1 < side).then(|| n + by)];
            for m in next.into_iter().flatten() {
                let rate = (depth(m) - here) / step;
                if rate > best.0 {
                    best = (rate, m);
                }
            }
        }
        if best.1 == n {
            return here;
        }
        n = best.1;
    }
}

/// How much each shape is thinned (thickened, where negative) so that the merged shapes fill `wanted`
/// samples: shares of the half thickness of each, larger for those that weigh less. Thin members keep
/// what the cells can hold.
fn thinning(at: &Site<'_>, lam: &[f64], reach: f64, wanted: f64) -> Vec<f64> {
    let k = lam.len();
    let half = |j: usize| if lam[j] > 0.0 { Half::of(at, k, j) } else { Half::default() };
    let half: Vec<Half> = (0..k).map(half).collect();
    // by weight: at one half all shares are equal, at one there is nothing to thin
    let thin = |share: f64| -> Vec<f64> {
        let by = |(h, l): (&Half, &f64)| {
            let by = (share * 2.0 * (1.0 - l)).clamp(-THICKEST, THINNEST);
            (by * h.mean).min((h.low - HALF_LEAST * at.cell).max(0.0)).max(-LEVEL_CAP)
        };
        half.iter().zip(lam).map(by).collect()
    };
    let mut row = vec![0.0; k];
    let mut inside = |share: f64| {
        let thin = thin(share);
        let mut n = 0u64;
        for g in at.g.chunks_exact(k) {
            for (r, (g, t)) in row.iter_mut().zip(g.iter().zip(&thin)) {
                *r = g + t;
            }
            n += u64::from(grow(&row, lam, reach) < 0.0);
        }
        n as f64
    };
    // at these shares every shape is at one of its limits, unless it is there alone
    let (mut lo, mut hi) = (-LARGEST_SHARE, LARGEST_SHARE);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (lo + hi);
        if inside(middle) > wanted { lo = middle } else { hi = middle }
    }
    thin(hi)
}

/// Parameters of one feature, and how many samples the mean volume is.
fn local(g: &[f64], lam: &[f64], sizes: &[f64]) -> (Local, f64) {
    let k = lam.len();
    let present: Vec<usize> = (0..k).filter(|&j| lam[j] > 0.0).collect();
    let (mut far, mut depth) = (0.0f64, 0.0f64);
    let (mut both, mut either) = (0u64, 0u64);
    let mut wanted = 0.0;
    let mut means = Vec::with_capacity(g.len() / k);
    for row in g.chunks_exact(k) {
        let (mut inside, mut mean, mut most) = (0, 0.0, f64::NEG_INFINITY);
        for &j in &present {
            mean += lam[j] * row[j];
            most = most.max(row[j]);
            if row[j] < 0.0 {
                inside += 1;
                wanted += lam[j] * sizes.get(j).copied().unwrap_or(1.0);
                depth = depth.max(-row[j]);
            }
        }
        if inside > 0 {
            // what one shape holds lies this far from another
            far = far.max(most);
            either += 1;
        }
        both += u64::from(inside == present.len());
        means.push(mean);
    }
    let overlap = if either > 0 { both as f64 / either as f64 } else { 1.0 };
    let level = if present.len() > 1 { level(&mut means, wanted) } else { 0.0 };
    let local = Local {
        reach: (far * REACH_MARGIN).max(LEAST_REACH),
        depth: (depth * REACH_MARGIN).max(1.0),
        apart: ((0.5 - overlap) / 0.3).clamp(0.0, 1.0),
        level,
    };
    (local, wanted)
}

/// The level below which `wanted` of the means lie, within the cap.
fn level(means: &mut [f64], wanted: f64) -> f64 {
    let rank = wanted.round() as usize;
    if rank == 0 || rank > means.len() {
        return 0.0;
    }
    let (_, level, _) = means.select_nth_unstable_by(rank - 1, f64::total_cmp);
    level.clamp(0.0, LEVEL_CAP)
}

/// Volumes of the shapes' elements over that of the result's.
pub(super) fn sizes(f: &Placed) -> Vec<f64> {
    let own = f.element.half.element_product();
    f.maps.iter().map(|m| m.to.half.element_product() / own).collect()
}

/// From sample to sample of a feature, mm.
pub(super) fn step(f: &Placed) -> DVec3 {
    2.0 * f.element.half / FEATURE_SIDE as f64
}

/// Whether shape `j` of k is inside in more than a third of the slices of a feature's samples, along each
/// axis: elements may be wider than what they hold.
pub(super) fn reaches_through(g: &[f64], k: usize, j: usize) -> bool {
    let side = FEATURE_SIDE;
    let mut seen = [[false; FEATURE_SIDE]; 3];
    for (n, _) in g.chunks_exact(k).enumerate().filter(|(_, row)| row[j] < 0.0) {
        let at = [n % side, n / side % side, n / (side * side)];
        at.iter().zip(&mut seen).for_each(|(&at, seen)| seen[at] = true);
    }
    seen.iter().all(|axis| 3 * axis.iter().filter(|s| **s).count() > side)
}

/// Measures the features of a hybrid, or the whole shapes over `domain` where it has none.
pub(super) fn locals(
    h: &Hybrid,
    inners: &[Inner],
    domain: &Aabb,
    cell: f64,
    job: &dyn Job,
) -> Result<Vec<Measured>, Cancelled> {
    if h.features.is_empty() {
        let looked = look(h, &lattice(domain), job)?;
        let inner = inners.first().copied().unwrap_or(Inner::Auto);
        let site = Site { g: &looked.g, sizes: &[], step: None, cell };
        return Ok(vec![measured(&site, &h.lam, inner)]);
    }
    let all = rows(h, |f, j| f.lam[j] > 0.0, job)?;
    let each = h.features.iter().zip(inners).zip(&all);
    let one = |((f, &inner), rows): ((&Placed, &Inner), &Vec<f64>)| {
        let sizes = sizes(f);
        let site = Site { g: rows, sizes: &sizes, step: Some(step(f)), cell };
        measured(&site, &f.lam, inner)
    };
    Ok(each.map(one).collect())
}

/// Values of the shapes that are wanted in a feature at its samples, a row a sample; those of the
/// others are zero.
pub(super) fn rows(
    h: &Hybrid,
    wanted: impl Fn(&Placed, usize) -> bool + Sync,
    job: &dyn Job,
) -> Result<Vec<Vec<f64>>, Cancelled> {
    let some = |f: &Placed, at: &[DVec3]| {
        job::check(job)?;
        Ok(h.look_up_some(at, |j| wanted(f, j)))
    };
    let one = |f: &Placed| {
        let at: Vec<DVec3> = cube(FEATURE_SIDE).map(|q| f.element.to_world(q)).collect();
        let parts = at.par_chunks(512).map(|at| some(f, at)).collect::<Result<Vec<_>, _>>()?;
        Ok(parts.concat())
    };
    h.features.iter().map(one).collect()
}

/// Chooses what the user left open of the space-time blend.
pub(super) fn bounded(
    h: &Hybrid,
    want: &SpaceTime,
    domain: &Aabb,
    job: &dyn Job,
) -> Result<Bounded, Cancelled> {
    let k = h.shapes.len();
    let looked = look(h, &lattice(domain), job)?;
    // half-cylinders lie in time too: the one that has ended still bounds the other
    let counts = |l: f64| l > 0.0 || want.form == Form::HalfCylinders;
    let reach = looked
        .g
        .chunks_exact(k)
        .zip(looked.lam.chunks_exact(k))
        .filter(|(g, l)| g.iter().zip(*l).any(|(g, l)| counts(*l) && *g < 0.0))
        .map(|(g, l)| (0..k).filter(|&j| counts(l[j])).map(|j| g[j]).fold(0.0, f64::max))
        .fold(1.0, f64::max);
    let mut b = Bounded {
        form: want.form,
        a0: 0.0,
        a: want.a.clone().unwrap_or_else(|| vec![reach; k]),
        a3: want.a3,
        reach,
    };
    b.a0 = match want.a0 {
        Some(a0) => a0,
        None => {
            let rows = looked.g.chunks_exact(k).zip(looked.lam.chunks_exact(k));
            let wanted: f64 = rows
                .clone()
                .flat_map(|(g, l)| g.iter().zip(l).map(|(g, l)| if *g < 0.0 { *l } else { 0.0 }))
                .sum();
            let samples: Vec<_> = rows.map(|(g, l)| b.parts(g, l)).collect();
            let height = height_for_volume(&samples, wanted, HEIGHT_CAP * reach);
            match want.form {
                Form::HalfCylinders => height.max(CYLINDERS_FLOOR * reach),
                Form::L | Form::S => height,
            }
        }
    };
    Ok(b)
}

/// Cell centres of a cube of `side`³ cells over [-1, 1]³.
fn cube(side: usize) -> impl Iterator<Item = DVec3> {
    let at = move |i: usize| (2.0 * i as f64 + 1.0) / side as f64 - 1.0;
    (0..side * side * side)
        .map(move |n| DVec3::new(at(n % side), at(n / side % side), at(n / (side * side))))
}

/// Cell centres of a lattice over the domain.
fn lattice(domain: &Aabb) -> Vec<DVec3> {
    let size = domain.size();
    let step = size.max_element() / WHOLE_SIDE;
    let n = (size / step).ceil().as_uvec3().max(glam::UVec3::ONE);
    let mut at = Vec::with_capacity((n.x * n.y * n.z) as usize);
    for k in 0..n.z {
        for j in 0..n.y {
            for i in 0..n.x {
                at.push(domain.min + (glam::UVec3::new(i, j, k).as_dvec3() + 0.5) * step);
            }
        }
    }
    at
}

/// Looks a hybrid up at many points, in parallel, rows in the order of the points.
fn look(h: &Hybrid, at: &[DVec3], job: &dyn Job) -> Result<Looked, Cancelled> {
    let parts: Vec<Looked> = at
        .par_chunks(512)
        .map(|at| {
            job::check(job)?;
            let mut l = Looked::default();
            h.look_up(at, &mut l);
            Ok(l)
        })
        .collect::<Result<_, Cancelled>>()?;
    let mut all = Looked::default();
    for p in parts {
        all.g.extend(p.g);
        all.lam.extend(p.lam);
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A board of half thickness 6, and four rods of half thickness 4 with about as much volume.
    #[test]
    fn thin_members_beside_a_thick_one_are_seen() {
        let half = DVec3::splat(48.0);
        let depth = |p: DVec3| {
            let board = (p.z.abs() - 6.0).max(p.x.abs() - 10.0);
            let rod = |x: f64| (p.x - x).abs().max(p.y.abs()) - 4.0;
            [-38.0, -22.0, 22.0, 38.0].map(rod).into_iter().fold(board, f64::min)
        };
        let g: Vec<f64> = cube(FEATURE_SIDE).map(|q| depth(q * half)).collect();
        let site = |cell: f64| Site { g: &g, sizes: &[1.0], step: Some(half / 12.0), cell };
        let found = Half::of(&site(0.0), 1, 0);
        assert!((2.0..7.0).contains(&found.mean), "{}", found.mean);
        assert!((1.0..=4.0).contains(&found.low), "{}", found.low);
        // cells of half a member and more leave nothing to thin
        let two: Vec<f64> = g.iter().flat_map(|v| [*v, *v]).collect();
        let thin = |cell: f64| {
            let at = Site { g: &two, sizes: &[0.2, 0.2], step: Some(half / 12.0), cell };
            measured(&at, &[0.5, 0.5], Inner::Merge).thin
        };
        assert!(thin(0.5)[0] > 0.5, "{:?}", thin(0.5));
        assert_eq!(thin(6.0), [0.0, 0.0]);
    }

    #[test]
    fn a_lesser_shape_grows_in_by_even_shares_of_its_volume() {
        // nine tenths of it lie within 10 mm of the dominant one, the rest up to 100 mm away
        let far = |n: usize| if n < 900 { n as f64 / 90.0 } else { n as f64 - 899.0 };
        let g: Vec<f64> = (0..1000).flat_map(|n| [far(n), -1.0]).collect();
        for share in [0.2, 0.5, 0.8] {
            let ratio = share * WHOLE_FROM;
            let lam = [1.0 / (1.0 + ratio), ratio / (1.0 + ratio)];
            let level = revealed(&g, &lam, 100.0) * ratio;
            let there = (0..1000).filter(|&n| far(n) < level).count() as f64 / 1000.0;
            assert!((there - share).abs() < 0.01, "{share}: {there}");
        }
        // from there on all of it
        assert!(revealed(&g, &[0.6, 0.4], 100.0) * 0.4 / 0.6 >= 100.0);
    }

    #[test]
    fn what_juts_in_does_not_reach_through() {
        let at = |p: DVec3, low: f64| if p.z > low && p.x.abs() < 0.8 { -1.0 } else { 1.0 };
        let g = |low: f64| cube(FEATURE_SIDE).map(|q| at(q, low)).collect::<Vec<_>>();
        assert!(reaches_through(&g(-0.9), 1, 0));
        assert!(!reaches_through(&g(0.6), 1, 0));
    }
}
