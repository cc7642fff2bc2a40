//! One step of time.

use super::boundary::{Rim, fault};
use super::grid::Grid;
use super::solver::Solver;
use super::{Control, Options, Scheme, Start};
use crate::num::Expr;
use crate::surface::SurfaceError;
use glam::DVec3;
use std::borrow::Cow;

/// Largest coordinate of a state, mm; what goes beyond is a runaway, not a surface.
const FARTHEST: f64 = 1e12;

/// Positions and velocities of the nodes at one step.
#[derive(Clone, Debug)]
pub struct State {
    /// Steps taken since t = 0.
    pub step: usize,
    /// Nodes along u and v.
    pub(super) size: [usize; 2],
    /// A net (nodes and ghosts) for x, y and z.
    pub(super) position: [Vec<f64>; 3],
    /// Velocities of the unknowns.
    pub(super) velocity: [Vec<f64>; 3],
    /// Forces at this step, where the step before has worked them out.
    force: [Vec<f64>; 3],
}

/// Everything that stays the same from step to step.
#[derive(Debug)]
pub struct Stepper {
    pub(super) options: Options,
    pub(super) grid: Grid,
    /// The factored matrix and the components that it steps.
    systems: Vec<(Solver, Vec<usize>)>,
    /// Forces that do not depend on time, at the unknowns.
    forces: [Option<Vec<f64>>; 3],
    /// Boundary data that does not depend on time.
    rims: [Option<Rim>; 3],
}

impl Stepper {
    /// Checks the options, evaluates what is constant, and factors the matrices.
    pub fn new(options: Options) -> Result<Self, SurfaceError> {
        super::check::options(&options)?;
        let grid = Grid::new(options.grid);
        let mut new = Self {
            options,
            grid,
            systems: vec![],
            forces: [const { None }; 3],
            rims: [const { None }; 3],
        };
        for k in 0..3 {
            if !new.options.force[k].depends_on(2) {
                new.forces[k] = Some(new.force_at(k, 0.0)?);
            }
            if new.options.boundary.constant(k) {
                new.rims[k] = Some(new.rim(k, 0.0)?);
            }
        }
        super::check::definite(&new.options, &new.grid)?;
        let live = (0..3).filter(|&k| !new.idle(k));
        new.systems = new.factor(live, new.shift())?;
        Ok(new)
    }

    /// What the matrix of a step has on its diagonal besides the operator.
    fn shift(&self) -> f64 {
        let Options { rho, eta, dt, .. } = self.options;
        match self.options.scheme {
            Scheme::Trapezoidal => 4.0 * rho / (dt * dt) + 2.0 * eta / dt,
            Scheme::Implicit => rho / (dt * dt) + 0.5 * eta / dt,
        }
    }

    /// Whether nothing ever moves a component of the flat square.
    fn idle(&self, k: usize) -> bool {
        let o = &self.options;
        o.force[k].as_number() == Some(0.0)
            && o.boundary.at_rest(k)
            && !matches!(o.start, Start::Given { .. })
    }

    /// Factors operator plus shift, once for all components of the same control parameters.
    fn factor(
        &self,
        components: impl Iterator<Item = usize>,
        shift: f64,
    ) -> Result<Vec<(Solver, Vec<usize>)>, SurfaceError> {
        let mut groups: Vec<(Control, Vec<usize>)> = vec![];
        for k in components {
            let control = self.options.control[k];
            match groups.iter_mut().find(|g| g.0 == control) {
                Some(group) => group.1.push(k),
                None => groups.push((control, vec![k])),
            }
        }
        let factored = groups.into_iter().map(|(control, list)| {
            let solver = Solver::new(&self.grid, &control, shift)
                .map_err(|e| SurfaceError::new("control", format!("cannot solve: {e}")))?;
            Ok((solver, list))
        });
        factored.collect()
    }

    /// The time of a step.
    pub fn time(&self, step: usize) -> f64 {
        step as f64 * self.options.dt
    }

    fn rim(&self, k: usize, t: f64) -> Result<Rim, SurfaceError> {
        match &self.rims[k] {
            Some(rim) => Ok(rim.clone()),
            None => self.options.boundary.rim(&self.grid, k, t),
        }
    }

    /// An expression at every unknown.
    fn sample(&self, e: &Expr, t: f64, at: String) -> Result<Vec<f64>, SurfaceError> {
        let value = |&p: &usize| {
            let [u, v] = self.grid.uv(p);
            e.eval(&[u, v, t])
        };
        self.grid.unknowns.iter().map(value).collect::<Result<_, _>>().map_err(fault(at))
    }

    fn force_at(&self, k: usize, t: f64) -> Result<Vec<f64>, SurfaceError> {
        self.sample(&self.options.force[k], t, format!("force[{k}]"))
    }

    fn force(&self, k: usize, t: f64) -> Result<Cow<'_, [f64]>, SurfaceError> {
        match &self.forces[k] {
            Some(force) => Ok(Cow::Borrowed(force)),
            None => self.force_at(k, t).map(Cow::Owned),
        }
    }

    /// Adds force minus operator: what a net of component `k` lacks to balance.
    fn add_lack(&self, k: usize, force: &[f64], net: &[f64], out: &mut [f64]) {
        let mut pull = vec![0.0; out.len()];
        self.grid.operate(&self.options.control[k], net, &mut pull);
        for ((out, f), pull) in out.iter_mut().zip(force).zip(pull) {
            *out += f - pull;
        }
    }

    /// The state at rest in the rest patch at time `t`.
    fn rest(&self, t: f64) -> Result<State, SurfaceError> {
        let mut state = State {
            step: 0,
            size: self.grid.size,
            position: [const { vec![] }; 3],
            velocity: [(); 3].map(|()| vec![0.0; self.grid.unknowns.len()]),
            force: [const { vec![] }; 3],
        };
        for k in 0..3 {
            state.position[k] = self.rim(k, t)?.rest(&self.grid);
        }
        Ok(state)
    }

    /// The state at t = 0.
    pub fn start(&self) -> Result<State, SurfaceError> {
        let mut state = match &self.options.start {
            Start::Steady => return self.steady(0.0),
            Start::Rest | Start::Given { .. } => self.rest(0.0)?,
        };
        if let Start::Given { position, velocity } = &self.options.start {
            for k in 0..3 {
                let inner = self.sample(&position[k], 0.0, format!("start.position[{k}]"))?;
                let net = &mut state.position[k];
                self.grid.unknowns.iter().zip(inner).for_each(|(&p, x)| net[p] = x);
                self.rim(k, 0.0)?.impose(&self.grid, net);
                let at = format!("start.velocity[{k}]");
                state.velocity[k] = self.sample(&velocity[k], 0.0, at)?;
            }
        }
        self.guard(state)
    }

    /// The balance of force and boundary at time `t`, without motion.
    pub fn steady(&self, t: f64) -> Result<State, SurfaceError> {
        let mut state = self.rest(t)?;
        let mut sides = [(); 3].map(|()| vec![0.0; self.grid.unknowns.len()]);
        for (k, side) in sides.iter_mut().enumerate() {
            self.add_lack(k, &self.force(k, t)?, &state.position[k], side);
        }
        let live = (0..3).filter(|&k| !self.idle(k));
        for (solver, list) in self.factor(live, 0.0)? {
            solve(&solver, &list, &mut sides);
            for k in list {
                let rim = self.rim(k, t)?;
                self.shift_by(&mut state.position[k], &sides[k], &rim);
            }
        }
        self.guard(state)
    }

    /// Adds to the unknowns of a net and renews its boundary.
    fn shift_by(&self, net: &mut [f64], by: &[f64], rim: &Rim) {
        self.grid.unknowns.iter().zip(by).for_each(|(&p, x)| net[p] += x);
        rim.impose(&self.grid, net);
    }

    /// The state one step later.
    ///
    /// With r the lack of balance (force minus operator), the unknown is the way x' - x:
    /// ```text
    /// trapezoidal  (4 rho/dt² + 2 eta/dt + K) (x' - x) = r(x, t) + r(x, t + dt) + (4 rho/dt) v
    /// implicit       (rho/dt² + eta/2dt + K) (x' - x) = r(x, t + dt; f at t) + (rho/dt - eta/2) v
    /// ```
    /// where x keeps its unknowns and takes the boundary of the time named. The second is the
    /// paper's eq. 6 over 2 dt² h⁴.
    pub fn step(&self, state: &mut State) -> Result<(), SurfaceError> {
        let Options { dt, scheme, .. } = self.options;
        let mut ways = [const { vec![] }; 3];
        let mut rims = [const { None }; 3];
        for &k in self.systems.iter().flat_map(|s| &s.1) {
            let rim = self.rim(k, self.time(state.step + 1))?;
            ways[k] = self.side(state, k, &rim)?;
            rims[k] = Some(rim);
        }
        for (solver, list) in &self.systems {
            solve(solver, list, &mut ways);
        }
        for k in 0..3 {
            let Some(rim) = &rims[k] else { continue };
            self.shift_by(&mut state.position[k], &ways[k], rim);
            for (v, way) in state.velocity[k].iter_mut().zip(&ways[k]) {
                *v = match scheme {
                    Scheme::Trapezoidal => 2.0 * way / dt - *v,
                    Scheme::Implicit => way / dt,
                };
            }
        }
        state.step += 1;
        self.check(state)
    }

    /// The right side of a step for component `k`; its net takes the boundary after the step.
    fn side(&self, state: &mut State, k: usize, rim: &Rim) -> Result<Vec<f64>, SurfaceError> {
        let Options { rho, eta, dt, scheme, .. } = self.options;
        let (now, next) = (self.time(state.step), self.time(state.step + 1));
        let inertia = match scheme {
            Scheme::Trapezoidal => 4.0 * rho / dt,
            Scheme::Implicit => rho / dt - 0.5 * eta,
        };
        let mut side: Vec<f64> = state.velocity[k].iter().map(|v| inertia * v).collect();
        let force = match std::mem::take(&mut state.force[k]) {
            known if !known.is_empty() => Cow::Owned(known),
            _ => self.force(k, now)?,
        };
        let net = &mut state.position[k];
        if scheme == Scheme::Implicit {
            rim.impose(&self.grid, net);
            self.add_lack(k, &force, net, &mut side);
            return Ok(side);
        }
        self.add_lack(k, &force, net, &mut side);
        rim.impose(&self.grid, net);
        let force = self.force(k, next)?;
        self.add_lack(k, &force, net, &mut side);
        if let Cow::Owned(force) = force {
            state.force[k] = force;
        }
        Ok(side)
    }

    fn guard(&self, state: State) -> Result<State, SurfaceError> {
        self.check(&state).map(|()| state)
    }

    /// Refuses a state that has overflowed or run away.
    fn check(&self, state: &State) -> Result<(), SurfaceError> {
        let sound = |x: &f64| x.abs() <= FARTHEST;
        if state.position.iter().flatten().all(sound) {
            return Ok(());
        }
        let (step, t) = (state.step, self.time(state.step));
        let why = format!("the surface leaves {FARTHEST:e} mm at step {step}, t = {t}");
        Err(SurfaceError::new("steps", why))
    }

    /// The nodes and ghosts between two states: `part` of the way from one to the other.
    pub fn between(&self, a: &State, b: &State, part: f64) -> Vec<DVec3> {
        let x = |k: usize, p: usize| {
            let (a, b) = (a.position[k][p], b.position[k][p]);
            if part == 0.0 { a } else { a + part * (b - a) }
        };
        (0..self.grid.net_len()).map(|p| DVec3::new(x(0, p), x(1, p), x(2, p))).collect()
    }
}

/// Solves for the components of one system.
fn solve(solver: &Solver, list: &[usize], sides: &mut [Vec<f64>; 3]) {
    let mut chosen: Vec<&mut [f64]> = sides
        .iter_mut()
        .enumerate()
        .filter(|(k, _)| list.contains(k))
        .map(|(_, side)| side.as_mut_slice())
        .collect();
    solver.solve(&mut chosen);
}
