//! The four morphs between PDE surfaces (Gonzalez Castro and Ugail 2007, section III).

use super::{
    Frame, PdeSurface,
    chain::{chains, pair},
    patch::{Patch, mode_list},
    solution::{Mode, Solution},
};
use crate::surface::{Motion, Surface, SurfaceError};
use std::sync::Arc;

/// What is blended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// The curves, then solved (III.A).
    #[default]
    Boundary,
    /// Nothing: the source loses its modes down to one, then the target gains its own (III.B).
    ///
    /// The paper's eq. 11 goes down to no mode, a bare line; its text says one, as done here. With
    /// m = Ns + Nt frames the frames at t = i/(m - 1) have Ns, ..., 1, 1, ..., Nt modes; between
    /// them the mode in question fades, and the two one-mode surfaces are blended.
    Modes,
    /// The curves, with the modes going down to one and up again (III.C). At t = i/m, m = Ns + Nt, the
    /// count is the largest of 1, Ns - i and Nt - (m - i); between, a mode fades.
    Combined,
    /// The spines and radial parts of the two solved surfaces (III.D). The same map as `Boundary` where
    /// both sides agree in `a`, modes and nodes, and epsilons are plain; cheaper, nothing is solved
    /// again.
    Spine,
}

/// How far the blend has gone at time t: gamma t^power.
///
/// The paper's eq. 9 has gamma (i - 1)/m for the i-th of m frames, and three ranges of i that
/// contradict it and each other; here t runs from 0 to 1 and both ends are frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Epsilon {
    /// 1 ends at the target; more goes past it. At least 0.
    pub gamma: f64,
    /// 1 is steady; less hurries at the start, more at the end. Over 0.
    pub power: f64,
}

impl Default for Epsilon {
    fn default() -> Self {
        Self { gamma: 1.0, power: 1.0 }
    }
}

impl Epsilon {
    /// gamma t.
    pub fn steady(gamma: f64) -> Self {
        Self { gamma, power: 1.0 }
    }

    /// gamma t^power.
    pub fn at(&self, t: f64) -> f64 {
        self.gamma * t.powf(self.power)
    }

    fn check(&self, at: &str) -> Result<(), SurfaceError> {
        if !(self.gamma.is_finite() && self.gamma >= 0.0) {
            let why = format!("gamma {}; a finite number of at least 0", self.gamma);
            return Err(SurfaceError::new(at, why));
        }
        if !(self.power.is_finite() && self.power > 0.0) {
            let why = format!("power {}; a finite number over 0", self.power);
            return Err(SurfaceError::new(at, why));
        }
        Ok(())
    }
}

/// How to morph.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MorphOptions {
    /// What is blended.
    pub method: Method,
    /// How far, for everything without its own below. `Modes` has no use for it.
    pub epsilon: Epsilon,
    /// How far each of the four curves of every patch, for `Boundary` and `Combined`. Where patches
    /// join, the first and the last should agree, or the joint opens.
    pub curves: Option<[Epsilon; 4]>,
    /// How far the radial part, for `Spine`.
    pub radial: Option<Epsilon>,
}

impl MorphOptions {
    fn check(&self) -> Result<(), SurfaceError> {
        self.epsilon.check("gamma")?;
        for (k, curve) in self.curves.iter().flatten().enumerate() {
            curve.check(&format!("curves[{k}]"))?;
        }
        self.radial.map_or(Ok(()), |r| r.check("radial"))
    }

    fn warnings(&self, from: &PdeSurface, to: &PdeSurface) -> Vec<String> {
        let mut out = vec![];
        let by_curve = matches!(self.method, Method::Boundary | Method::Combined);
        if self.radial.is_some() && self.method != Method::Spine {
            out.push("radial: only the method spine uses it".into());
        }
        match self.curves {
            Some(_) if !by_curve => {
                out.push("curves: only the methods boundary and combined use them".into());
            }
            Some([first, .., last]) if first != last => {
                let joined = |s: &PdeSurface| chains(&s.patches).iter().any(|c| c.len() > 1);
                if joined(from) || joined(to) {
                    out.push("curves: the first and last differ, so joints of patches open".into());
                }
            }
            _ => {}
        }
        out
    }
}

/// A morph of two PDE surfaces; see [`Method`], and for patches without partner the text at
/// [`PdeMorph::new`].
#[derive(Clone, Debug, PartialEq)]
pub struct PdeMorph {
    pairs: Vec<[Patch; 2]>,
    options: MorphOptions,
    warnings: Vec<String>,
}

impl PdeMorph {
    /// Pairs the patches of two surfaces, whose numbers may differ.
    ///
    /// The first chain of patches on one side belongs to the first on the other, and so on; both are
    /// cut where either has a joint, without moving a point. A chain without partner grows out of, or
    /// shrinks to, one point of the other side's first chain, so put the main body first.
    ///
    /// # Errors
    /// A gamma below 0, a power not over 0, or either not finite.
    pub fn new(
        from: &PdeSurface,
        to: &PdeSurface,
        options: MorphOptions,
    ) -> Result<Self, SurfaceError> {
        options.check()?;
        let named = |side: &str, s: &PdeSurface| {
            s.warnings.iter().map(|w| format!("{side}.{w}")).collect::<Vec<_>>()
        };
        let mut warnings = named("from", from);
        warnings.extend(named("to", to));
        warnings.extend(options.warnings(from, to));
        Ok(Self { pairs: pair(&from.patches, &to.patches), options, warnings })
    }

    /// What the user should know.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The surface at `t`; source and target at 0 and 1 (with gamma 1).
    ///
    /// # Errors
    /// A time outside [0, 1]; curves between the two that overflow.
    pub fn frame(&self, t: f64) -> Result<Frame, SurfaceError> {
        if !(0.0..=1.0).contains(&t) {
            return Err(SurfaceError::new("t", format!("{t}; a number in [0, 1]")));
        }
        let epsilon = self.options.epsilon.at(t);
        let radial = self.options.radial.map_or(epsilon, |e| e.at(t));
        let one = |[a, b]: &[Patch; 2]| match self.options.method {
            Method::Boundary => self.solve(a, b, t, &[Fade::NONE; 2]),
            Method::Modes => Ok(modes(a, b, t)),
            Method::Combined => self.solve(a, b, t, &combined(a.modes, b.modes, t)),
            Method::Spine => Ok(a.solution.blend(&b.solution, epsilon, radial)),
        };
        Ok(Frame { patches: self.pairs.iter().map(one).collect::<Result<_, _>>()? })
    }

    /// Blends the curves and solves. Each side brings the modes it has itself, so the ends are source
    /// and target also where the sides differ in the number of modes, in `a` or in the nodes.
    fn solve(
        &self,
        from: &Patch,
        to: &Patch,
        t: f64,
        fades: &[Fade; 2],
    ) -> Result<Solution, SurfaceError> {
        let overall = self.options.epsilon;
        let eps = self.options.curves.unwrap_or([overall; 4]).map(|e| e.at(t));
        let inside = overall.at(t).clamp(0.0, 1.0);
        let mix = |x: f64, y: f64| if x == y { x } else { x * (1.0 - inside) + y * inside };
        let nodes = std::array::from_fn(|k| mix(from.nodes[k], to.nodes[k]));
        let means = std::array::from_fn(|k| {
            from.curves[k].mean * (1.0 - eps[k]) + to.curves[k].mean * eps[k]
        });
        let mut list: Vec<Mode> = vec![];
        let sides = [(from, eps.map(|e| 1.0 - e)), (to, eps)];
        for ((side, share), fade) in sides.into_iter().zip(fades) {
            for mode in mode_list(&side.curves, side.modes, side.remainder) {
                add(&mut list, mode, &share.map(|s| s * fade.weight(mode.n, mode.rest)));
            }
        }
        list.retain(|m| m.cos.iter().chain(&m.sin).any(|c| *c != glam::DVec3::ZERO));
        let a = mix(from.a, to.a);
        Solution::solve(&nodes, a, &means, &list).ok_or_else(|| {
            SurfaceError::new(
                "t",
                format!("a {a} with curves at u = {nodes:?} overflows at t = {t}"),
            )
        })
    }
}

impl Motion for PdeMorph {
    fn at(&self, t: f64) -> Result<Arc<dyn Surface>, SurfaceError> {
        Ok(Arc::new(self.frame(t)?))
    }
}

/// Adds a mode with a share for each curve.
fn add(list: &mut Vec<Mode>, mode: Mode, share: &[f64; 4]) {
    let twin = |m: &Mode| (m.n, m.level, m.rest) == (mode.n, mode.level, mode.rest);
    let at = list.iter().position(twin).unwrap_or_else(|| {
        list.push(Mode { cos: Default::default(), sin: Default::default(), ..mode });
        list.len() - 1
    });
    for (k, share) in share.iter().enumerate() {
        list[at].cos[k] += mode.cos[k] * *share;
        list[at].sin[k] += mode.sin[k] * *share;
    }
}

/// How much of its modes a side keeps.
#[derive(Clone, Copy, Debug)]
struct Fade {
    /// Modes kept; the last one partly when it is not whole.
    count: f64,
    /// How much of the remainder.
    rest: f64,
}

impl Fade {
    const NONE: Self = Self { count: f64::INFINITY, rest: 1.0 };

    fn weight(&self, n: usize, rest: bool) -> f64 {
        if rest { self.rest } else { (self.count - n as f64 + 1.0).clamp(0.0, 1.0) }
    }
}

/// III.C: the same number of modes on both sides; the remainder leaves with the first mode of its
/// side (the paper leaves it out, but for source and target themselves).
fn combined(from: usize, to: usize, t: f64) -> [Fade; 2] {
    let (from, to) = (from as f64, to as f64);
    let frames = from + to;
    let (done, left) = (frames * t, frames * (1.0 - t));
    let count = (from - done).max(to - left).max(1.0);
    [done, left].map(|steps| Fade { count, rest: (1.0 - steps).clamp(0.0, 1.0) })
}

/// III.B.
fn modes(from: &Patch, to: &Patch, t: f64) -> Solution {
    let frames = (from.modes + to.modes) as f64 - 1.0;
    let (done, left) = (frames * t, frames * (1.0 - t));
    let faded = |side: &Patch, steps: f64| {
        let count = (side.modes as f64 - steps).max(1.0);
        let fade = Fade { count, rest: (1.0 - steps).clamp(0.0, 1.0) };
        side.solution.weighted(|term| fade.weight(term.n, term.rest))
    };
    let over = (done - (from.modes as f64 - 1.0)).clamp(0.0, 1.0);
    faded(from, done).blend(&faded(to, left), over, over)
}
