//! The motion: states at any time, from a few that are kept.

use super::step::Stepper;
use super::{Options, State};
use crate::surface::bicubic::Bicubic;
use crate::surface::{Motion, Surface, SurfaceError};
use glam::DVec3;
use std::sync::{Arc, Mutex, PoisonError};

/// States kept along the way, so that going back costs at most that share of all steps.
const KEPT: usize = 64;

/// A surface that moves by forces, inertia and damping.
///
/// As a [`Motion`] its t in [0, 1] is the share of the whole time `steps * dt`. Between two steps
/// the nodes move linearly. States are computed when first asked for; one in 64 is kept.
#[derive(Debug)]
pub struct Dynamic {
    stepper: Stepper,
    /// States 0, stride, 2 stride, ... as far as anyone asked.
    kept: Mutex<Vec<State>>,
    stride: usize,
}

impl Dynamic {
    /// Checks the options and factors the matrices.
    ///
    /// # Errors
    /// Options out of range, expressions without a value at t = 0, curves that do not meet, and
    /// control parameters that are ill-posed on this grid.
    pub fn new(options: Options) -> Result<Self, SurfaceError> {
        let stride = options.steps.div_ceil(KEPT).max(1);
        let stepper = Stepper::new(options)?;
        let kept = Mutex::new(vec![stepper.start()?]);
        Ok(Self { stepper, kept, stride })
    }

    /// What it was made of.
    pub fn options(&self) -> &Options {
        &self.stepper.options
    }

    /// The state at t = 0.
    pub fn start(&self) -> State {
        let kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept[0].clone()
    }

    /// Takes a state one step on, beyond the last step too; a state that failed is of no more use.
    ///
    /// # Errors
    /// A state of another grid, expressions without a value at that time, curves that do not meet, a surface that overflows.
    pub fn step(&self, state: &mut State) -> Result<(), SurfaceError> {
        self.own(state)?;
        self.stepper.step(state)
    }

    /// Refuses the state of a surface on another grid.
    fn own(&self, state: &State) -> Result<(), SurfaceError> {
        let [nu, nv] = self.stepper.grid.size;
        if state.size == [nu, nv] {
            return Ok(());
        }
        let [u, v] = state.size;
        Err(SurfaceError::new("grid", format!("a state of {u} x {v} nodes, expected {nu} x {nv}")))
    }

    /// The balance of force and boundary at time `t` (in the equation's units), at rest.
    ///
    /// # Errors
    /// As [`Self::step`].
    pub fn steady(&self, t: f64) -> Result<State, SurfaceError> {
        self.stepper.steady(t)
    }

    /// The state after that many steps.
    ///
    /// # Errors
    /// As [`Self::step`].
    pub fn state(&self, step: usize) -> Result<State, SurfaceError> {
        let wanted = step / self.stride;
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        while kept.len() <= wanted.min(KEPT) {
            let mut state = kept[kept.len() - 1].clone();
            for _ in 0..self.stride {
                self.step(&mut state)?;
            }
            kept.push(state);
        }
        let mut state = kept[wanted.min(kept.len() - 1)].clone();
        drop(kept);
        while state.step < step {
            self.step(&mut state)?;
        }
        Ok(state)
    }

    /// The nodes of a state, u-rows of v, mm.
    ///
    /// # Errors
    /// A state of another grid.
    pub fn nodes(&self, state: &State) -> Result<Vec<DVec3>, SurfaceError> {
        self.own(state)?;
        let grid = &self.stepper.grid;
        let [nu, nv] = grid.size;
        let nodes = (0..nu).flat_map(|i| (0..nv).map(move |j| grid.net(i, j)));
        Ok(nodes.map(|p| DVec3::from([0, 1, 2].map(|k| state.position[k][p]))).collect())
    }

    /// The C1 surface through the nodes of a state, with the given tangents at its edges.
    ///
    /// # Errors
    /// A state of another grid.
    pub fn surface(&self, state: &State) -> Result<Bicubic, SurfaceError> {
        self.own(state)?;
        self.through(state, state, 0.0)
    }

    fn through(&self, a: &State, b: &State, part: f64) -> Result<Bicubic, SurfaceError> {
        Bicubic::new(self.stepper.grid.size, self.stepper.between(a, b, part))
            .ok_or_else(|| SurfaceError::new("grid", "too few nodes for a surface"))
    }
}

impl Motion for Dynamic {
    fn at(&self, t: f64) -> Result<Arc<dyn Surface>, SurfaceError> {
        if !(0.0..=1.0).contains(&t) {
            return Err(SurfaceError::new("t", format!("{t} is outside [0, 1]")));
        }
        let steps = t * self.options().steps as f64;
        let nearest = steps.round();
        // A time meant to be that of a step is one: 0.29 * 100 is 28.999999999999996.
        let steps = if (steps - nearest).abs() < 1e-9 * nearest.max(1.0) { nearest } else { steps };
        let (whole, part) = (steps.floor(), steps.fract());
        let a = self.state(whole as usize)?;
        if part == 0.0 {
            return Ok(Arc::new(self.surface(&a)?));
        }
        let mut b = a.clone();
        self.step(&mut b)?;
        Ok(Arc::new(self.through(&a, &b, part)?))
    }
}
