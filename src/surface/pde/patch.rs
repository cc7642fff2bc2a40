//! What a patch is given as, checked and solved.

use super::{
    basis::Basis,
    curve::{Curve, Fourier},
    solution::{Mode, Solution},
};
use crate::surface::SurfaceError;
use glam::DVec3;

/// Where the four curves sit in u when nothing else is said. The paper gives four positional
/// conditions and never says where; equal steps reproduce its nine-patch shell.
pub const NODES: [f64; 4] = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0];

/// Past this `a N` four positional conditions overshoot visibly between the curves.
const WARN: f64 = 10.0;

/// Past this `a (N + 1)` the remainder grows more than forty times between the curves: round-off
/// and sampling error of the curves become the shape.
const MOST_REST: f64 = 20.0;

/// What is the same for all patches of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// The equation's parameter, at least 1: how fast the modes of a curve die away from it.
    pub a: f64,
    /// Fourier modes N, at least 1.
    pub modes: usize,
    /// Whether the remainder takes up what the modes leave of the curves.
    pub remainder: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { a: 1.0, modes: 5, remainder: true }
    }
}

/// The four curves of a patch and their u.
#[derive(Clone, Debug, PartialEq)]
pub struct Boundary {
    /// Increasing, in [0, 1]. The patch covers u in [0, 1] whatever they are.
    pub nodes: [f64; 4],
    /// The curve at each node.
    pub curves: [Curve; 4],
}

impl Boundary {
    /// Four curves at the default nodes.
    pub fn new(curves: [Curve; 4]) -> Self {
        Self { nodes: NODES, curves }
    }
}

/// A checked patch and its closed form.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Patch {
    pub nodes: [f64; 4],
    pub a: f64,
    pub modes: usize,
    pub remainder: bool,
    pub curves: [Fourier; 4],
    pub solution: Solution,
}

impl Patch {
    /// Checks and solves; `at` is the patch's key.
    pub fn new(boundary: &Boundary, options: &Options, at: &str) -> Result<Self, SurfaceError> {
        check_nodes(&boundary.nodes, at)?;
        check_lengths(&boundary.curves, at)?;
        let mut curves: [Fourier; 4] = Default::default();
        for (k, (curve, sum)) in boundary.curves.iter().zip(&mut curves).enumerate() {
            *sum = curve.fourier(options.modes, &format!("{at}.curves[{k}]"))?;
        }
        let (nodes, Options { a, modes, remainder }) = (boundary.nodes, *options);
        let list = mode_list(&curves, modes, remainder);
        let means = curves.each_ref().map(|c| c.mean);
        let solution = Solution::solve(&nodes, a, &means, &list).ok_or_else(|| {
            let why = format!("a {a} and {modes} modes overflow with the curves at u = {nodes:?}");
            SurfaceError::new(format!("{at}.u"), why)
        })?;
        Ok(Self { nodes, a, modes, remainder, curves, solution })
    }

    /// The part u in [start, end] as a patch: the same points, curves at the same places of its u.
    pub fn part(&self, start: f64, end: f64) -> Self {
        if (start, end) == (0.0, 1.0) {
            return self.clone();
        }
        let solution = self.solution.part(start, end);
        let curves = self.nodes.map(|u| solution.curve(u));
        Self { a: self.a * (end - start), curves, solution, ..self.clone() }
    }

    /// All of it at one point, with the options of this patch.
    pub fn shrunk(&self, to: DVec3) -> Self {
        let curve = Fourier { mean: to, terms: vec![] };
        let solution =
            Solution { spine: [to, DVec3::ZERO, DVec3::ZERO, DVec3::ZERO], terms: vec![] };
        Self { curves: std::array::from_fn(|_| curve.clone()), solution, ..self.clone() }
    }
}

/// The modes of four curves that the patch uses, the remainder's after the others.
pub(super) fn mode_list(curves: &[Fourier; 4], modes: usize, remainder: bool) -> Vec<Mode> {
    let known = curves.iter().map(|c| c.terms.len()).max().unwrap_or(0);
    let most = if remainder { known } else { known.min(modes) };
    (1..=most)
        .filter_map(|n| {
            let terms = curves.each_ref().map(|c| c.term(n));
            let mode = Mode {
                n,
                level: n.min(modes.saturating_add(1)),
                rest: n > modes,
                cos: terms.map(|t| t[0]),
                sin: terms.map(|t| t[1]),
            };
            let empty = terms.iter().flatten().all(|c| *c == DVec3::ZERO);
            (!empty).then_some(mode)
        })
        .collect()
}

impl Options {
    /// Checks `a`, `modes`, and that the remainder stays within what four positions can carry.
    pub(super) fn check(&self) -> Result<(), SurfaceError> {
        let Self { a, modes, remainder } = *self;
        if !(a.is_finite() && a >= 1.0) {
            return Err(SurfaceError::new("a", format!("{a}; a finite number of at least 1")));
        }
        if modes == 0 {
            return Err(SurfaceError::new("modes", "0; at least 1"));
        }
        let rate = a * (modes as f64 + 1.0);
        if remainder && rate > MOST_REST {
            let why = format!(
                "with a (modes + 1) = {rate} an error of the curves grows {:.0e} times between \
                 them; leave the remainder off, or keep a (modes + 1) to {MOST_REST}",
                Basis { rate, nodes: NODES }.lebesgue()
            );
            return Err(SurfaceError::new("remainder", why));
        }
        Ok(())
    }

    /// What to know about the number of modes; nothing when all is well.
    pub(super) fn warning(&self, nodes: &[f64; 4], at: &str) -> Option<String> {
        let rate = self.a * self.modes as f64;
        (rate > WARN).then(|| {
            let grows = Basis { rate, nodes: *nodes }.lebesgue();
            format!(
                "{at}: a times modes is {rate}, over {WARN}: between its curves the surface may \
                 overshoot by {grows:.1e} times their detail"
            )
        })
    }
}

fn check_nodes(nodes: &[f64; 4], at: &str) -> Result<(), SurfaceError> {
    let inside = nodes.iter().all(|u| (0.0..=1.0).contains(u));
    if inside && nodes.windows(2).all(|w| w[0] < w[1]) {
        return Ok(());
    }
    let why = format!("{nodes:?}; four increasing numbers in [0, 1]");
    Err(SurfaceError::new(format!("{at}.u"), why))
}

fn check_lengths(curves: &[Curve; 4], at: &str) -> Result<(), SurfaceError> {
    let mut first = None;
    for (k, curve) in curves.iter().enumerate() {
        let Curve::Points(points) = curve else { continue };
        let (place, count) = *first.get_or_insert((k, points.len()));
        if count != points.len() {
            let why = format!("{} points; curves[{place}] has {count}", points.len());
            return Err(SurfaceError::new(format!("{at}.curves[{k}]"), why));
        }
    }
    Ok(())
}
