//! The surfaces that a blend lies between.

use super::functions::samples;
use super::{Blend, BlendSpec, Side};
use crate::num::expr::Program;
use crate::num::{Expr, ExprError};
use crate::surface::{Domain, Jet, Motion, Surface, SurfaceError};
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// How a primary surface goes on from the blend.
#[derive(Clone, Debug)]
pub enum Extent {
    /// Straight along the tangent, for this part of the blend's length in u.
    Straight { reach: f64 },
    /// A surface over u, v, t, from one u to the cut.
    Cut { surface: [Expr; 3], from: f64, cut: f64 },
}

/// A surface beside a blend, in motion with it.
#[derive(Clone, Debug)]
pub struct Primary {
    /// Position, derivative by u, derivative by v, over u, v, t.
    program: Program,
    key: String,
    u: [f64; 2],
    v: [f64; 2],
}

impl Primary {
    pub(super) fn new(spec: &BlendSpec, end: usize) -> Result<Self, SurfaceError> {
        let key = format!("at-{end}");
        let long = |e: ExprError| SurfaceError::new(key.clone(), e.to_string());
        let side = &spec.at[end];
        let (surface, u) = match &side.extent {
            Extent::Straight { reach } => {
                let u = if end == 0 { [-reach, 0.0] } else { [0.0, *reach] };
                (straight(side).ok_or_else(|| SurfaceError::new(&*key, "unknown variables"))?, u)
            }
            Extent::Cut { surface, from, cut } => {
                (surface.to_vec(), [from.min(*cut), from.max(*cut)])
            }
        };
        let mut all = surface.clone();
        for variable in [0, 1] {
            for s in &surface {
                all.push(s.derivative(variable).map_err(long)?);
            }
        }
        Ok(Self { program: Program::new(&all), key, u, v: spec.v })
    }
}

/// Position plus u times tangent, over u, v, t.
fn straight(side: &Side) -> Option<Vec<Expr>> {
    let names = ["u", "v", "t"];
    let u = Expr::parse("u", &names).ok()?;
    let each = side.position.iter().zip(&side.tangent);
    each.map(|(c, t)| Some(c.over(&names)?.plus(&u.times(&t.over(&names)?)))).collect()
}

/// A primary surface at one time.
struct Still {
    primary: Primary,
    t: f64,
    wraps: bool,
}

impl Still {
    fn jet(&self, uv: DVec2) -> Result<Jet, ExprError> {
        let mut x = [0.0; 9];
        self.primary.program.eval(&[uv.x, uv.y, self.t], &mut x)?;
        let three = |i: usize| DVec3::new(x[i], x[i + 1], x[i + 2]);
        Ok(Jet { s: three(0), su: three(3), sv: three(6) })
    }

    /// Tries the surface on a grid; whether its last v is its first.
    fn closes(&self) -> Result<bool, ExprError> {
        let (mut gap, mut size) = (0.0, 0.0f64);
        let Primary { u, v, .. } = self.primary;
        for i in 0..5 {
            let u = u[0] + (u[1] - u[0]) * f64::from(i) / 4.0;
            let first = self.jet(DVec2::new(u, v[0]))?.s;
            for j in 1..=64 {
                let d =
                    self.jet(DVec2::new(u, v[0] + (v[1] - v[0]) * f64::from(j) / 64.0))?.s - first;
                size = size.max(d.length());
                gap = if j == 64 { d.length().max(gap) } else { gap };
            }
        }
        Ok(gap <= 1e-9 * size)
    }
}

impl Surface for Still {
    fn domain(&self, _patch: usize) -> Domain {
        Domain { u: self.primary.u, v: self.primary.v, wraps: [false, self.wraps] }
    }

    fn jet(&self, _patch: usize, uv: DVec2) -> Jet {
        let none = DVec3::NAN;
        Self::jet(self, uv).unwrap_or(Jet { s: none, su: none, sv: none })
    }
}

impl Motion for Primary {
    fn at(&self, t: f64) -> Result<Arc<dyn Surface>, SurfaceError> {
        let mut still = Still { primary: self.clone(), t, wraps: false };
        still.wraps =
            still.closes().map_err(|e| SurfaceError::new(self.key.clone(), e.to_string()))?;
        Ok(Arc::new(still))
    }
}

/// A blend between its primary surfaces: patches 0 and 2, the blend is patch 1.
#[derive(Clone, Debug)]
pub struct Beside {
    pub(super) blend: Blend,
    pub(super) primary: [Primary; 2],
}

impl Motion for Beside {
    fn at(&self, t: f64) -> Result<Arc<dyn Surface>, SurfaceError> {
        let [first, last] = &self.primary;
        Ok(Arc::new(Three([first.at(t)?, self.blend.at(t)?, last.at(t)?])))
    }
}

struct Three([Arc<dyn Surface>; 3]);

impl Surface for Three {
    fn patches(&self) -> usize {
        3
    }

    fn domain(&self, patch: usize) -> Domain {
        self.0[patch.min(2)].domain(0)
    }

    fn jet(&self, patch: usize, uv: DVec2) -> Jet {
        self.0[patch.min(2)].jet(0, uv)
    }
}

/// Evaluates the boundary data all over v and t in [0, 1].
pub fn check_values(spec: &BlendSpec) -> Result<(), SurfaceError> {
    let all: Vec<Expr> =
        spec.at.iter().flat_map(|s| [&s.position, &s.tangent]).flatten().cloned().collect();
    let (program, mut out) = (Program::new(&all), vec![0.0; all.len()]);
    let bad = |p: &[f64; 2]| program.eval(p, &mut out).is_err();
    let place = samples(spec.v, 65, 9).into_iter().find(bad);
    place.map_or(Ok(()), |p| check_place(spec, p))
}

/// Evaluates the boundary data at a (v, t); the error names the expression.
pub fn check_place(spec: &BlendSpec, place: [f64; 2]) -> Result<(), SurfaceError> {
    for (end, side) in spec.at.iter().enumerate() {
        for (kind, three) in [("position", &side.position), ("tangent", &side.tangent)] {
            for (i, e) in three.iter().enumerate() {
                let at = || format!("at-{end}.{kind}[{i}]");
                e.eval(&place).map_err(|e| SurfaceError::new(at(), e.to_string()))?;
            }
        }
    }
    Ok(())
}
