//! Nets on common degrees and knots.

use super::knots::{Knots, SAME_KNOT};
use super::net::Net;
use super::{RationalCurve, RationalSurface, SurfaceError, wrong};

/// A common net may have this many control points (128 MB of poles a target): two tall and wide nets
/// of a million rows and columns would otherwise ask for 10^12.
const MOST_POLES: usize = 1 << 22;

/// The same surfaces on common degrees, domain (that of the first) and knots: the least that hold
/// all of them. Knots within [`SAME_KNOT`] of the domain are the same knot.
///
/// # Errors
/// None given; a common net that is too large.
pub fn compatible_surfaces(
    targets: &[RationalSurface],
) -> Result<Vec<RationalSurface>, SurfaceError> {
    let nets: Vec<&Net> = targets.iter().map(|s| &s.net).collect();
    Ok(compatible(&nets)?.into_iter().map(RationalSurface::of).collect())
}

/// The same curves on common degree, domain (that of the first) and knots; see
/// [`compatible_surfaces`].
///
/// # Errors
/// None given; a common net that is too large.
pub fn compatible_curves(targets: &[RationalCurve]) -> Result<Vec<RationalCurve>, SurfaceError> {
    let nets: Vec<&Net> = targets.iter().map(|c| &c.net).collect();
    Ok(compatible(&nets)?.into_iter().map(RationalCurve::of).collect())
}

pub(super) fn compatible(targets: &[&Net]) -> Result<Vec<Net>, SurfaceError> {
    let Some(first) = targets.first() else {
        return wrong("targets", "no targets; expected two or more");
    };
    if let Some(i) = targets.iter().position(|n| n.is_curve() != first.is_curve()) {
        let kind = |n: &Net| if n.is_curve() { "a curve" } else { "a surface" };
        let why = format!("{}; the first target is {}", kind(targets[i]), kind(first));
        return wrong(format!("targets[{i}]"), why);
    }
    let common = [0, 1].map(|axis| {
        let all: Vec<&Knots> = targets.iter().map(|n| &n.along[axis]).collect();
        Common::of(&all)
    });
    let [width, height] = [0, 1].map(|axis| common[axis].knots.count());
    if width.saturating_mul(height).saturating_mul(targets.len()) > MOST_POLES {
        let why = format!(
            "the {} common nets would have {width} x {height} control points; the most is {MOST_POLES} in all",
            targets.len()
        );
        return wrong("targets", why);
    }
    let lift = |(i, net): (usize, &&Net)| {
        common
            .iter()
            .enumerate()
            .fold((*net).clone(), |net, (axis, common)| common.lift(net, axis, &common.own[i]))
    };
    Ok(targets.iter().enumerate().map(lift).collect())
}

/// The least knots that hold several vectors, and each vector with its values moved onto them.
struct Common {
    knots: Knots,
    own: Vec<Vec<f64>>,
}

impl Common {
    fn of(all: &[&Knots]) -> Self {
        let degree = all.iter().map(|k| k.degree).max().unwrap_or(0);
        let [a, b] = all[0].domain();
        // (value on the first's domain, target, repeats at the common degree)
        let mut found: Vec<(f64, usize, usize)> = vec![];
        for (i, knots) in all.iter().enumerate() {
            let onto = |t: f64| rescale(t, knots.domain(), [a, b]);
            let raise = degree - knots.degree;
            found.extend(knots.distinct().into_iter().map(|(t, n)| (onto(t), i, n + raise)));
        }
        found.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        let mut merged: Vec<(f64, usize)> = vec![];
        let mut own = vec![vec![]; all.len()];
        for cluster in clusters(&found, SAME_KNOT * (b - a)) {
            let first = cluster.iter().find(|k| k.1 == 0).unwrap_or(&cluster[0]);
            let repeats = cluster.iter().map(|k| k.2).max().unwrap_or(0);
            merged.push((first.0, repeats));
            cluster.iter().for_each(|k| own[k.1].push(first.0));
        }
        let own = own.iter().zip(all).map(|(values, knots)| {
            let each = values.iter().zip(knots.distinct());
            each.flat_map(|(&t, (_, n))| std::iter::repeat_n(t, n)).collect()
        });
        let own = own.collect();
        Self { knots: Knots::of(degree, &merged), own }
    }

    /// Brings a net, whose knots moved to `values`, on the common degree and knots along `axis`.
    fn lift(&self, mut net: Net, axis: usize, values: &[f64]) -> Net {
        net.along[axis].values = values.to_vec();
        for _ in net.along[axis].degree..self.knots.degree {
            net = net.raised(axis);
        }
        net.on(axis, self.knots.clone())
    }
}

/// A parameter moved from one domain to another; the ends go exactly to the ends.
fn rescale(t: f64, [c, d]: [f64; 2], [a, b]: [f64; 2]) -> f64 {
    match t {
        _ if [a, b] == [c, d] => t,
        _ if t == c => a,
        _ if t == d => b,
        _ => a + (t - c) / (d - c) * (b - a),
    }
}

/// Runs of knots that are within `same` of the first of the run.
fn clusters(found: &[(f64, usize, usize)], same: f64) -> Vec<&[(f64, usize, usize)]> {
    let mut out = vec![];
    let mut rest = found;
    while let Some(first) = rest.first() {
        let n = rest.iter().take_while(|k| k.0 - first.0 <= same).count();
        let (run, tail) = rest.split_at(n);
        out.push(run);
        rest = tail;
    }
    out
}
