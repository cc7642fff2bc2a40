//! Sums of products G(u) F(v, t), and the surface they make at one time.

use super::functions::{Function, T, V};
use super::profile::{Basis, cubics};
use super::{BlendSpec, exact::Wave, primary};
use crate::num::expr::{Program, sums};
use crate::surface::{Domain, Jet, Surface, SurfaceError};
use glam::{DVec2, DVec3};

/// The functions of u that G is made of.
#[derive(Clone, Debug)]
pub enum Profile {
    /// Four cubics and corrections.
    Series { basis: Basis, terms: usize },
    /// Solutions of the equation.
    Waves(Vec<Wave>),
}

impl Profile {
    fn len(&self) -> usize {
        match self {
            Self::Series { terms, .. } => 4 + terms,
            Self::Waves(waves) => waves.len(),
        }
    }

    /// Values and derivatives at `u`.
    fn slopes(&self, u: f64, values: &mut [f64], slopes: &mut [f64]) {
        match self {
            Self::Series { basis, .. } => {
                for ((x, dx), cubic) in values.iter_mut().zip(&mut *slopes).zip(cubics(u)) {
                    (*x, *dx) = (cubic[0], cubic[1]);
                }
                basis.slopes(
                    u,
                    values.get_mut(4..).unwrap_or(&mut []),
                    slopes.get_mut(4..).unwrap_or(&mut []),
                );
            }
            Self::Waves(waves) => {
                for ((x, dx), wave) in values.iter_mut().zip(slopes).zip(waves) {
                    [*x, *dx] = wave.at(u);
                }
            }
        }
    }
}

/// sum_j G_j(u) F_j(v, t), G_j a weighted sum of profile functions.
#[derive(Clone, Debug)]
pub struct Separated {
    pub functions: Vec<Function>,
    /// A row a function, a weight a profile function.
    pub weights: Vec<Vec<DVec3>>,
    pub profile: Profile,
}

/// Points over v at which the surface of a time is tried before it is handed out.
const TRIED: usize = 65;

impl Separated {
    /// The surface at `t`: functions that differ only by t become one.
    pub fn at(&self, t: f64, spec: &BlendSpec) -> Result<BlendSurface, SurfaceError> {
        let held: Vec<_> = self.functions.iter().map(|f| f.f.with(T, t)).collect();
        let sums = sums(&held);
        let count = self.profile.len();
        let mut weights = vec![DVec3::ZERO; count * sums.functions.len()];
        for (row, terms) in self.weights.iter().zip(&sums.terms) {
            for &(m, x) in terms {
                for (to, from) in weights[m * count..].iter_mut().zip(row) {
                    *to += *from * x;
                }
            }
        }
        let long = |e: crate::num::ExprError| SurfaceError::new("at-0, at-1", e.to_string());
        let mut program = sums.functions.clone();
        for f in &sums.functions {
            program.push(f.derivative(V).map_err(long)?);
        }
        let program = Program::new(&program);
        let mut surface = BlendSurface {
            profile: self.profile.clone(),
            weights,
            program,
            v: spec.v,
            t,
            wraps: false,
        };
        surface.check(spec)?;
        surface.wraps = surface.closes();
        Ok(surface)
    }
}

/// A blend at one time, one patch over u in [0, 1] and the v of its file.
#[derive(Clone, Debug)]
pub struct BlendSurface {
    profile: Profile,
    /// A row of profile weights for every function.
    weights: Vec<DVec3>,
    /// The functions of v, then their derivatives.
    program: Program,
    v: [f64; 2],
    t: f64,
    wraps: bool,
}

impl BlendSurface {
    /// Whether the end functions exist over all of v.
    fn check(&self, spec: &BlendSpec) -> Result<(), SurfaceError> {
        let mut out = vec![0.0; self.program.len()];
        for i in 0..TRIED {
            let v = self.v[0] + (self.v[1] - self.v[0]) * i as f64 / (TRIED - 1) as f64;
            if let Err(e) = self.program.eval(&[v, self.t], &mut out) {
                // the boundary expression at fault says more than a part of it
                primary::check_place(spec, [v, self.t])?;
                return Err(SurfaceError::new("at-0, at-1", e.to_string()));
            }
        }
        Ok(())
    }

    /// Whether the last v gives the points of the first, to a billionth of its size.
    fn closes(&self) -> bool {
        let us: Vec<f64> = (0..9).map(|i| f64::from(i) / 8.0).collect();
        let ends = self.jets(&us, &[self.v[0], 0.5 * (self.v[0] + self.v[1]), self.v[1]]);
        let size = ends.iter().fold(0.0, |m: f64, j| m.max((j.s - ends[0].s).length()));
        ends.chunks(3).all(|j| (j[0].s - j[2].s).length() <= 1e-9 * size)
    }

    /// Number of functions of v.
    fn count(&self) -> usize {
        self.program.len() / 2
    }

    /// G and its derivative at `u`, for every function.
    fn across(&self, u: f64, mut give: impl FnMut(usize, DVec3, DVec3)) {
        let n = self.profile.len();
        with_room(2 * n, |room| {
            let (values, slopes) = room.split_at_mut(n);
            self.profile.slopes(u, values, slopes);
            for (m, weights) in self.weights.chunks(n.max(1)).enumerate() {
                let (mut g, mut dg) = (DVec3::ZERO, DVec3::ZERO);
                for ((w, x), dx) in weights.iter().zip(&*values).zip(&*slopes) {
                    g += *w * *x;
                    dg += *w * *dx;
                }
                give(m, g, dg);
            }
        });
    }

    /// Position and derivatives at every pair of `us` and `vs`, v fastest: many times faster than
    /// point by point, and the same numbers.
    pub fn jets(&self, us: &[f64], vs: &[f64]) -> Vec<Jet> {
        let count = self.count();
        let mut along = vec![f64::NAN; vs.len() * 2 * count];
        for (row, &v) in along.chunks_mut((2 * count).max(1)).zip(vs) {
            self.functions(v, row);
        }
        let mut out = Vec::with_capacity(us.len() * vs.len());
        let mut across = vec![[DVec3::ZERO; 2]; count];
        for &u in us {
            self.across(u, |m, g, dg| across[m] = [g, dg]);
            if count == 0 {
                out.extend(vs.iter().map(|_| ZERO));
            }
            for row in along.chunks((2 * count).max(1)) {
                let (f, df) = row.split_at(count);
                let mut jet = ZERO;
                for (([g, dg], f), df) in across.iter().zip(f).zip(df) {
                    jet.s += *g * *f;
                    jet.su += *dg * *f;
                    jet.sv += *g * *df;
                }
                out.push(jet);
            }
        }
        out
    }

    /// The functions of v and their derivatives; not numbers where they do not exist.
    fn functions(&self, v: f64, out: &mut [f64]) {
        if self.program.eval(&[v, self.t], out).is_err() {
            out.fill(f64::NAN);
        }
    }
}

const ZERO: Jet = Jet { s: DVec3::ZERO, su: DVec3::ZERO, sv: DVec3::ZERO };

impl Surface for BlendSurface {
    fn domain(&self, _patch: usize) -> Domain {
        Domain { u: [0.0, 1.0], v: self.v, wraps: [false, self.wraps] }
    }

    fn jet(&self, _patch: usize, uv: DVec2) -> Jet {
        let count = self.count();
        let mut jet = ZERO;
        with_room(2 * count, |row| {
            self.functions(uv.y, row);
            self.across(uv.x, |m, g, dg| {
                jet.s += g * row[m];
                jet.su += dg * row[m];
                jet.sv += g * row[count + m];
            });
        });
        jet
    }
}

/// Lends `n` numbers to work in, without allocating for the usual few.
fn with_room<R>(n: usize, work: impl FnOnce(&mut [f64]) -> R) -> R {
    match [0.0; 64].get_mut(..n) {
        Some(room) => work(room),
        None => work(&mut vec![0.0; n]),
    }
}
