//! The solution in closed form (paper 002, eqs 20 to 28).

use super::functions::{self, Function, Operator};
use super::surface::{Profile, Separated};
use super::{BlendSpec, BlendSurface, solve};
use crate::num::lsq::{self, Dense};
use crate::surface::{Motion, Surface, SurfaceError};
use glam::DVec3;
use std::sync::Arc;

/// A blend that solves its equation to round-off.
#[derive(Clone, Debug)]
pub struct Exact {
    spec: BlendSpec,
    sum: Separated,
}

impl Exact {
    /// The surface at a time, with its own type.
    ///
    /// # Errors
    /// As [`Motion::at`]: an expression without a value at that time.
    pub fn surface(&self, t: f64) -> Result<BlendSurface, SurfaceError> {
        self.sum.at(t, &self.spec)
    }
}

impl Motion for Exact {
    fn at(&self, t: f64) -> Result<Arc<dyn Surface>, SurfaceError> {
        Ok(Arc::new(self.surface(t)?))
    }
}

/// One solution of beta G'''' + b G'' + c G = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wave {
    /// u^n.
    Power(i32),
    /// exp(-decay w) cos(turn w - quarter), w = u, or 1 - u where `back`: never overflows.
    Turn { decay: f64, turn: f64, quarter: f64, back: bool },
}

impl Wave {
    /// Value and derivative.
    pub fn at(self, u: f64) -> [f64; 2] {
        match self {
            Self::Power(0) => [1.0, 0.0],
            Self::Power(n) => [u.powi(n), f64::from(n) * u.powi(n - 1)],
            Self::Turn { decay, turn, quarter, back } => {
                let (w, sign) = if back { (1.0 - u, -1.0) } else { (u, 1.0) };
                let (size, (sin, cos)) = ((-decay * w).exp(), (turn * w - quarter).sin_cos());
                [size * cos, -sign * size * (decay * cos + turn * sin)]
            }
        }
    }
}

/// Numbers below this part of those they come from count as zero: roots then repeat to half the digits.
const ZERO: f64 = 1e-12;

/// The four solutions, from G'''' + b G'' + c G = 0; what is wrong, if they are not four.
fn waves(b: f64, c: f64) -> Result<[Wave; 4], &'static str> {
    if b == 0.0 && c == 0.0 {
        return Ok([0, 1, 2, 3].map(Wave::Power));
    }
    // r = q^2 solves r^2 + b r + c = 0
    let split = b * b - 4.0 * c;
    if split.abs() <= ZERO * (b * b).max(4.0 * c.abs()) || c.abs() <= ZERO * b * b {
        return Err("has repeated roots");
    }
    let turn = |decay, turn, sin: bool, back| {
        let quarter = if sin { std::f64::consts::FRAC_PI_2 } else { 0.0 };
        Wave::Turn { decay, turn, quarter, back }
    };
    if split < 0.0 {
        // q = sqrt(-b/2 + i sqrt(-split)/2), of modulus c^(1/4)
        let modulus = c.sqrt();
        let (re, im) = ((modulus - b / 2.0) / 2.0, (modulus + b / 2.0) / 2.0);
        let (re, im) = (re.max(0.0).sqrt(), im.max(0.0).sqrt());
        let all = [(false, false), (true, false), (false, true), (true, true)];
        return Ok(all.map(|(sin, back)| turn(re, im, sin, back)));
    }
    // the larger root first, so that neither is a difference of near equals
    let large = -0.5 * (b + split.sqrt().copysign(b));
    let pair = |r: f64| {
        let q = r.abs().sqrt();
        if r > 0.0 {
            [turn(q, 0.0, false, false), turn(q, 0.0, false, true)]
        } else {
            [turn(0.0, q, false, false), turn(0.0, q, true, false)]
        }
    };
    let ([a, b], [c, d]) = (pair(large), pair(c / large));
    Ok([a, b, c, d])
}

/// The closed form, function by function.
pub fn exact(spec: &BlendSpec, series: &Separated) -> Result<Exact, SurfaceError> {
    let beta = spec.handles.beta;
    if beta == 0.0 {
        return Err(SurfaceError::new(
            "beta",
            "no closed form without the fourth derivative (beta = 0)",
        ));
    }
    let list = &series.functions;
    let operators = solve::operators(list, &spec.handles)?;
    let (mut all, mut rows) = (Vec::new(), Vec::new());
    for (f, operator) in list.iter().zip(&operators) {
        let refuse =
            |why: &str| SurfaceError::new("beta", format!("no closed form: `{}` {why}", f.f));
        let [b, c] = multiples(operator, spec).map_err(|e| refuse(&e))?;
        let four = waves(b / beta, c / beta).map_err(&refuse)?;
        let weights = ends(f, &four).ok_or_else(|| refuse("meets a resonance of the handles"))?;
        rows.push((all.len(), weights));
        all.extend(four);
    }
    let spread = |(start, four): (usize, [DVec3; 4])| {
        let mut row = vec![DVec3::ZERO; all.len()];
        row[start..start + 4].copy_from_slice(&four);
        row
    };
    let weights = rows.into_iter().map(spread).collect();
    let sum = Separated { functions: list.clone(), weights, profile: Profile::Waves(all.clone()) };
    Ok(Exact { spec: spec.clone(), sum })
}

/// The factors b, c with gamma F_vv = b F and lambda F_vvvv + rho F_tt + eta F_t = c F.
fn multiples(operator: &Operator, spec: &BlendSpec) -> Result<[f64; 2], String> {
    let points = functions::probes(spec.v);
    let [f, second, rest] =
        operator.columns(&points).map_err(|e| format!("has no derivatives: {e}"))?;
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    let square = dot(&f, &f);
    let mut factors = [0.0; 2];
    for (factor, x) in factors.iter_mut().zip([&second, &rest]) {
        let ratio = dot(&f, x) / square;
        let left: f64 = f.iter().zip(x).map(|(f, x)| (x - ratio * f).powi(2)).sum();
        if left > 1e-20 * dot(x, x) {
            return Err("has derivatives that are no multiples of it".into());
        }
        // the first column holds beta F
        *factor = ratio * spec.handles.beta;
    }
    Ok(factors)
}

/// Weights of the four solutions that give the ends of a function.
fn ends(f: &Function, four: &[Wave; 4]) -> Option<[DVec3; 4]> {
    let row = |i: usize, wave: Wave| wave.at(if i < 2 { 0.0 } else { 1.0 })[i % 2];
    let a = Dense::from_fn(4, 4, |i, j| row(i, four[j]));
    let s = lsq::solve(a, Dense::from_fn(4, 3, |i, c| f.ends[i][c]));
    // a wave that decays fast is far from the others, so only a resonance makes this large
    (s.condition < 1e12)
        .then(|| [0, 1, 2, 3].map(|j| DVec3::new(s.x.at(j, 0), s.x.at(j, 1), s.x.at(j, 2))))
}
