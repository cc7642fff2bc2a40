//! PDE surfaces: patches that solve (D_uu + a^2 D_vv)^2 X = 0 in closed form through four closed
//! curves each, and their morphs (Gonzalez Castro and Ugail 2007).
//!
//! - A *patch* runs along u in [0, 1] and closes in v, period 2 pi. Its four *curves* sit at four
//!   *nodes* of u.
//! - The *modes* are the Fourier terms of v that are used; the *remainder* takes up the others, so
//!   that the patch passes through its curves exactly.
//! - The *spine* is the mean over v, a cubic of u; what is left is the *radial* part.
//! - Patches of which one ends where the next begins form a *chain*.
//!
//! Such a patch is a shell: to bound a solid, its ends must be poles or folds.
//!
//! ```
//! use fieldgraft::surface::{Surface, pde::{Boundary, Curve, Options, PdeSurface}};
//! use glam::{DVec2, DVec3};
//! let ring = |r: f64, z: f64| Curve::Terms {
//!     mean: DVec3::Z * z,
//!     terms: vec![[DVec3::X * r, DVec3::Y * r]],
//! };
//! let vase = Boundary::new([ring(10.0, 0.0), ring(16.0, 20.0), ring(8.0, 40.0), ring(12.0, 60.0)]);
//! let surface = PdeSurface::new(&[vase], Options::default())?;
//! let p = surface.point(0, DVec2::new(1.0 / 3.0, 0.0));
//! assert!((p - DVec3::new(16.0, 0.0, 20.0)).length() < 1e-12);
//! # Ok::<(), fieldgraft::surface::SurfaceError>(())
//! ```

mod basis;
mod chain;
mod curve;
mod morph;
mod patch;
mod pillow;
mod solution;
#[cfg(test)]
mod tests;

pub use curve::{Curve, MOST_POINTS};
pub use morph::{Epsilon, Method, MorphOptions, PdeMorph};
pub use patch::{Boundary, NODES, Options};
pub use solution::Solution;

use super::{Domain, Jet, Surface, SurfaceError};
use glam::{DVec2, DVec3};
use patch::Patch;
use rayon::prelude::*;
use solution::Waves;
use std::f64::consts::TAU;

/// A surface of PDE patches.
#[derive(Clone, Debug, PartialEq)]
pub struct PdeSurface {
    patches: Vec<Patch>,
    warnings: Vec<String>,
}

impl PdeSurface {
    /// Solves all patches.
    ///
    /// # Errors
    /// No patches; `a` below 1 or not finite; no modes; the remainder with `a (modes + 1)` over 20;
    /// nodes that do not increase or leave [0, 1]; curves of different lengths, too few points for
    /// the modes, numbers that are not finite. The error names the entry: `patches[2].curves[1]`.
    pub fn new(patches: &[Boundary], options: Options) -> Result<Self, SurfaceError> {
        options.check()?;
        if patches.is_empty() {
            return Err(SurfaceError::new("patches", "none; at least one"));
        }
        let key = |i| format!("patches[{i}]");
        let warnings =
            patches.iter().enumerate().filter_map(|(i, p)| options.warning(&p.nodes, &key(i)));
        let warnings = warnings.collect();
        let solve = |(i, p)| Patch::new(p, &options, &key(i));
        let patches = patches.iter().enumerate().map(solve).collect::<Result<_, _>>()?;
        Ok(Self { patches, warnings })
    }

    /// What the user should know about this surface, such as that it may overshoot.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The closed forms.
    pub fn frame(&self) -> Frame {
        Frame { patches: self.patches.iter().map(|p| p.solution.clone()).collect() }
    }

    /// The spine of each chain of patches as a polyline of `steps` pieces a patch, mm.
    pub fn spine(&self, steps: usize) -> Vec<Vec<DVec3>> {
        let line = |chain: &std::ops::Range<usize>| {
            let mut points = vec![];
            for (k, patch) in self.patches[chain.clone()].iter().enumerate() {
                let first = usize::from(k > 0);
                let at = |i| patch.solution.spine(i as f64 / steps.max(1) as f64);
                points.extend((first..=steps.max(1)).map(at));
            }
            points
        };
        chain::chains(&self.patches).iter().map(line).collect()
    }

    /// Positions at every u and v of patch after patch, u slowest.
    pub fn grid(&self, us: &[f64], vs: &[f64]) -> Vec<DVec3> {
        grid(self.patches.iter().map(|p| &p.solution).collect(), us, vs)
    }
}

/// A PDE surface at one moment of a morph: closed forms only.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// The patches.
    pub patches: Vec<Solution>,
}

impl Frame {
    /// Positions at every u and v of patch after patch, u slowest.
    pub fn grid(&self, us: &[f64], vs: &[f64]) -> Vec<DVec3> {
        grid(self.patches.iter().collect(), us, vs)
    }
}

fn grid(patches: Vec<&Solution>, us: &[f64], vs: &[f64]) -> Vec<DVec3> {
    let waves = Waves::new(vs, patches.iter().map(|p| p.modes()).max().unwrap_or(0));
    let each = us.len() * vs.len();
    let mut out = vec![DVec3::ZERO; patches.len() * each];
    if each > 0 {
        let work = out.par_chunks_mut(each).zip(patches);
        work.for_each(|(out, patch)| patch.rows(us, &waves, out));
    }
    out
}

const DOMAIN: Domain = Domain { u: [0.0, 1.0], v: [0.0, TAU], wraps: [false, true] };

impl Surface for PdeSurface {
    fn patches(&self) -> usize {
        self.patches.len()
    }
    fn domain(&self, _patch: usize) -> Domain {
        DOMAIN
    }
    fn jet(&self, patch: usize, uv: DVec2) -> Jet {
        self.patches[patch].solution.jet(uv)
    }
    fn point(&self, patch: usize, uv: DVec2) -> DVec3 {
        self.patches[patch].solution.point(uv)
    }
}

impl Surface for Frame {
    fn patches(&self) -> usize {
        self.patches.len()
    }
    fn domain(&self, _patch: usize) -> Domain {
        DOMAIN
    }
    fn jet(&self, patch: usize, uv: DVec2) -> Jet {
        self.patches[patch].jet(uv)
    }
    fn point(&self, patch: usize, uv: DVec2) -> DVec3 {
        self.patches[patch].point(uv)
    }
}
