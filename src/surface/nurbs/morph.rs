//! Morphs of rational B-splines: the targets' weights over time, their masses, and the frames.

use super::super::{Motion, Surface};
use super::blended::{Blended, Masses};
use super::compatible::compatible;
use super::curve::Curve;
use super::impact::Impact;
use super::masses::{self, Averaging, Design, MorphOptions, Rows};
use super::net::{Net, is_mass};
use super::{RationalCurve, RationalSurface, SurfaceError, wrong};
use glam::DVec2;
use std::sync::Arc;

/// What morphs of curves and of surfaces share.
#[derive(Clone)]
pub(super) struct Mix {
    nets: Arc<Vec<Net>>,
    path: Vec<Vec<f64>>,
    scale: Vec<f64>,
    base: Base,
    stages: Vec<Stage>,
}

/// Masses where nothing is designed.
#[derive(Clone)]
enum Base {
    Ones,
    Own,
    Given(Masses),
}

/// Masses designed for a time.
#[derive(Clone)]
struct Stage {
    t: f64,
    masses: Masses,
}

/// A frame: a B-spline when the masses are the targets' own.
enum Frame {
    Spline(Net),
    Blended(Blended),
}

impl Mix {
    fn new(targets: &[&Net], options: &MorphOptions) -> Result<Self, SurfaceError> {
        let k = targets.len();
        if k < 2 {
            return wrong("targets", format!("{k} targets; expected two or more"));
        }
        let nets = compatible(targets)?;
        let scale = match options.scale.len() {
            0 => vec![1.0; k],
            n if n == k => options.scale.clone(),
            n => return wrong("scale", format!("{n} numbers; {k} targets need {k}")),
        };
        if let Some(i) = scale.iter().position(|&s| !is_mass(s)) {
            let why = format!("scale is {}; expected a positive number", scale[i]);
            return wrong(format!("scale[{i}]"), why);
        }
        let path = path(&options.weights, k)?;
        let base = base(options, &nets)?;
        let mut mix = Self { nets: Arc::new(nets), path, scale, base, stages: vec![] };
        for (n, design) in options.designs.iter().enumerate() {
            mix.design(design, &format!("design[{n}]"))?;
        }
        Ok(mix)
    }

    /// Weights times scales at a time, with sum 1.
    fn shares(&self, t: f64) -> Result<Vec<f64>, SurfaceError> {
        if !(0.0..=1.0).contains(&t) {
            return wrong("t", format!("t is {t}; expected 0 to 1"));
        }
        let last = self.path.len() - 1;
        let at = t * last as f64;
        let i = (at as usize).min(last.saturating_sub(1));
        let (a, b, s) = (&self.path[i], &self.path[(i + 1).min(last)], at - i as f64);
        let weight = |k: usize| (a[k] * (1.0 - s) + b[k] * s) * self.scale[k];
        Ok(unit((0..self.nets.len()).map(weight).collect()))
    }

    /// Masses at a time; None where all are one.
    fn masses(&self, t: f64) -> Option<Masses> {
        let after = self.stages.partition_point(|s| s.t <= t);
        match (after.checked_sub(1).map(|i| &self.stages[i]), self.stages.get(after)) {
            (Some(a), Some(b)) if a.t < t => {
                let odds = |t: f64| (t / (1.0 - t)).ln();
                let s = (odds(t) - odds(a.t)) / (odds(b.t) - odds(a.t));
                let between = |(x, y): (&f64, &f64)| (x.ln() * (1.0 - s) + y.ln() * s).exp();
                let lists = a.masses.iter().zip(b.masses.iter());
                Some(Arc::new(lists.map(|(x, y)| x.iter().zip(y).map(between).collect()).collect()))
            }
            (Some(stage), _) | (None, Some(stage)) => Some(stage.masses.clone()),
            (None, None) => match &self.base {
                Base::Ones => None,
                Base::Own => Some(Arc::new(self.nets.iter().map(Net::masses).collect())),
                Base::Given(masses) => Some(masses.clone()),
            },
        }
    }

    /// R_i and W of the controls at a time.
    fn controls(&self, t: f64) -> Result<(Vec<Vec<f64>>, Vec<f64>), SurfaceError> {
        let shares = self.shares(t)?;
        let count = self.nets[0].poles.len();
        let masses =
            self.masses(t).unwrap_or_else(|| Arc::new(vec![vec![1.0; count]; shares.len()]));
        let part = |i: usize, k: usize| shares[i] * masses[i][k];
        let total: Vec<f64> =
            (0..count).map(|k| (0..shares.len()).map(|i| part(i, k)).sum()).collect();
        let share = |i: usize| (0..count).map(|k| part(i, k) / total[k]).collect();
        Ok(((0..shares.len()).map(share).collect(), total))
    }

    fn design(&mut self, design: &Design, key: &str) -> Result<(), SurfaceError> {
        let t = design.t;
        if !(t > 0.0 && t < 1.0) {
            return wrong(format!("{key}.t"), format!("t is {t}; expected above 0 and below 1"));
        }
        let (shares, (_, total)) = (self.shares(t)?, self.controls(t)?);
        let masses = masses::designed(design, &self.nets, &shares, total, key)?;
        let at = self.stages.partition_point(|s| s.t < t);
        if self.stages.get(at).is_some_and(|s| s.t == t) {
            self.stages.remove(at);
        }
        self.stages.insert(at, Stage { t, masses: Arc::new(masses) });
        Ok(())
    }

    fn frame(&self, t: f64) -> Result<Frame, SurfaceError> {
        let shares = self.shares(t)?;
        if let Some(i) = shares.iter().position(|&l| l == 1.0) {
            return Ok(Frame::Spline(self.nets[i].clone()));
        }
        if matches!(self.base, Base::Own) && self.stages.is_empty() {
            let mut sum = self.nets[0].clone();
            for (k, pole) in sum.poles.iter_mut().enumerate() {
                *pole = self.nets.iter().zip(&shares).map(|(net, &l)| net.poles[k] * l).sum();
            }
            return Ok(Frame::Spline(sum));
        }
        Ok(Frame::Blended(self.blended(t, shares)))
    }

    fn blended(&self, t: f64, shares: Vec<f64>) -> Blended {
        Blended::new(self.nets.clone(), shares, self.masses(t))
    }

    fn distances(&self, t: f64, uv: DVec2) -> Result<Vec<f64>, SurfaceError> {
        Ok(self.blended(t, self.shares(t)?).distances(uv))
    }

    fn rows(&self, list: &[f64]) -> Rows {
        list.chunks(self.nets[0].width()).map(<[f64]>::to_vec).collect()
    }
}

fn base(options: &MorphOptions, nets: &[Net]) -> Result<Base, SurfaceError> {
    if options.averaging == Averaging::Linear {
        for (key, given) in [("masses", options.masses.len()), ("design", options.designs.len())] {
            if given > 0 {
                return wrong(key, "linear averaging has no masses; use weighted averaging");
            }
        }
        return Ok(Base::Ones);
    }
    if options.masses.is_empty() {
        return Ok(Base::Own);
    }
    if options.masses.len() != nets.len() {
        let (have, need) = (options.masses.len(), nets.len());
        return wrong("masses", format!("{have} nets of masses; {need} targets need {need}"));
    }
    let each = options.masses.iter().zip(nets).enumerate();
    let lists: Result<Vec<_>, _> =
        each.map(|(i, (rows, net))| masses::masses(rows, net, &format!("masses[{i}]"))).collect();
    Ok(Base::Given(Arc::new(lists?)))
}

/// Checked weights over time.
fn path(rows: &[Vec<f64>], k: usize) -> Result<Vec<Vec<f64>>, SurfaceError> {
    if rows.is_empty() {
        return match k {
            2 => Ok(vec![vec![1.0, 0.0], vec![0.0, 1.0]]),
            _ => wrong("weights", format!("missing; {k} targets need them")),
        };
    }
    for (n, row) in rows.iter().enumerate() {
        let at = format!("weights[{n}]");
        if row.len() != k {
            return wrong(at, format!("{} numbers; {k} targets need {k}", row.len()));
        }
        if let Some(i) = row.iter().position(|&l| !(l == 0.0 || is_mass(l))) {
            let why = format!("weight is {}; expected zero or a positive number", row[i]);
            return wrong(format!("{at}[{i}]"), why);
        }
        if row.iter().all(|&l| l == 0.0) {
            return wrong(at, "all weights are zero");
        }
    }
    Ok(rows.iter().map(|row| unit(row.clone())).collect())
}

/// Divided by their sum.
fn unit(list: Vec<f64>) -> Vec<f64> {
    let sum: f64 = list.iter().sum();
    list.into_iter().map(|l| l / sum).collect()
}

/// A morph of rational B-spline surfaces by their masses (Ju and Goldman 2003).
///
/// As a [`Motion`] it goes through [`MorphOptions::weights`]; every frame has analytic derivatives.
#[derive(Clone)]
pub struct NurbsMorph {
    mix: Mix,
}

/// A morph of rational B-spline curves by their masses; see [`NurbsMorph`].
#[derive(Clone)]
pub struct CurveMorph {
    mix: Mix,
}

macro_rules! shared {
    ($morph:ident, $target:ident, $what:literal) => {
        impl $morph {
            #[doc = concat!("From two or more ", $what, ", brought on common degrees and knots.")]
            ///
            /// # Errors
            /// Too few targets, tables of another shape than the common net, masses that are not
            /// positive, distances that are not between 0 and 1.
            pub fn new(targets: &[$target], options: &MorphOptions) -> Result<Self, SurfaceError> {
                let nets: Vec<&Net> = targets.iter().map(|t| &t.net).collect();
                Ok(Self { mix: Mix::new(&nets, options)? })
            }

            /// The targets on the common net that masses and distances refer to.
            pub fn targets(&self) -> Vec<$target> {
                self.mix.nets.iter().cloned().map($target::of).collect()
            }

            /// The shares R of the targets at each control, and the weights W of the controls: those
            /// of the second of two targets are the distances to start a [`Design`] from.
            ///
            /// # Errors
            /// A time outside [0, 1].
            pub fn controls(&self, t: f64) -> Result<(Vec<Rows>, Rows), SurfaceError> {
                let (shares, total) = self.mix.controls(t)?;
                let shares = shares.iter().map(|list| self.mix.rows(list)).collect();
                Ok((shares, self.mix.rows(&total)))
            }

            /// The masses of each target at a time, on the common net.
            pub fn masses(&self, t: f64) -> Vec<Rows> {
                let of = |net: &Net| vec![1.0; net.poles.len()];
                let ones = || Arc::new(self.mix.nets.iter().map(of).collect());
                let lists = self.mix.masses(t).unwrap_or_else(ones);
                lists.iter().map(|list| self.mix.rows(list)).collect()
            }

            /// Adds a design, in place of one for the same time.
            ///
            /// # Errors
            /// As for [`Self::new`].
            pub fn design(&mut self, design: &Design) -> Result<(), SurfaceError> {
                self.mix.design(design, "design")
            }

            /// Distances with those round the centre of an area of impact pulled to `to`.
            ///
            /// # Errors
            /// A table of another shape than the common net.
            pub fn pull(
                &self,
                distance: &Rows,
                impact: &Impact,
                to: f64,
            ) -> Result<Rows, SurfaceError> {
                let net = &self.mix.nets[0];
                let list = masses::flat(distance, net, "distance")?;
                Ok(self.mix.rows(&impact.pull(list, net, to)?))
            }
        }
    };
}

shared!(NurbsMorph, RationalSurface, "surfaces");
shared!(CurveMorph, RationalCurve, "curves");

impl NurbsMorph {
    /// The normalised distance D of each target's share at a point; they sum to one.
    ///
    /// # Errors
    /// A time outside [0, 1].
    pub fn distances(&self, t: f64, uv: DVec2) -> Result<Vec<f64>, SurfaceError> {
        self.mix.distances(t, uv)
    }
}

impl CurveMorph {
    /// The normalised distance D of each target's share at a point; they sum to one.
    ///
    /// # Errors
    /// A time outside [0, 1].
    pub fn distances(&self, t: f64, u: f64) -> Result<Vec<f64>, SurfaceError> {
        self.mix.distances(t, DVec2::new(u, 0.0))
    }

    /// The curve at `t`.
    ///
    /// # Errors
    /// A time outside [0, 1].
    pub fn at(&self, t: f64) -> Result<Arc<dyn Curve>, SurfaceError> {
        Ok(match self.mix.frame(t)? {
            Frame::Spline(net) => Arc::new(RationalCurve::of(net)),
            Frame::Blended(curve) => Arc::new(curve),
        })
    }
}

impl Motion for NurbsMorph {
    fn at(&self, t: f64) -> Result<Arc<dyn Surface>, SurfaceError> {
        Ok(match self.mix.frame(t)? {
            Frame::Spline(net) => Arc::new(RationalSurface::of(net)),
            Frame::Blended(surface) => Arc::new(surface),
        })
    }
}
