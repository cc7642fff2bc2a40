//! What holds at the four edges: curves, tangents, and the rest patch between them.

use super::grid::{EDGE_NAMES, EDGES, Grid};
use crate::num::{Expr, ExprError};
use crate::surface::SurfaceError;

/// Variables of every expression of a dynamic surface.
pub const VARIABLES: [&str; 3] = ["u", "v", "t"];

/// Expressions of x, y, z for the edges u = 0, u = 1, v = 0, v = 1.
pub type Edges = [[Expr; 3]; 4];

/// The four boundary curves.
#[derive(Clone, Debug)]
pub enum Curves {
    /// The edges of the unit square x = u, y = v, z = 0, at all times.
    Flat,
    /// Positions, mm, in u, v (one of them is fixed on each edge) and t.
    Given(Box<Edges>),
}

/// Of what the tangents are derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TangentsOf {
    /// Of the displacement from the rest patch: zero tangents leave an edge as level as the rest
    /// patch is. The rest patch is the bilinear Coons patch of the curves at that time, so with
    /// flat curves the flat square. (The paper sets "all tangents to zero" on a flat square; read
    /// as derivatives of x and y, that would squash the square in its own plane.)
    #[default]
    Displacement,
    /// Of the position itself, as the paper's eq. 2 is written.
    Position,
}

/// The boundary data of a dynamic surface (You and Zhang 2007, eq. 2).
#[derive(Clone, Debug)]
pub struct Boundary {
    /// Where the edges are.
    pub curves: Curves,
    /// Derivative by u on the edges u = 0 and 1, by v on the edges v = 0 and 1.
    pub tangents: Box<Edges>,
    /// What they are derivatives of.
    pub tangents_of: TangentsOf,
}

/// Boundary data of one component at one time, in the order of the edges, a number a node.
#[derive(Clone, Debug, PartialEq)]
pub struct Rim {
    /// Positions.
    curves: [Vec<f64>; 4],
    /// Derivatives of the position across the edge.
    tangents: [Vec<f64>; 4],
}

/// An expression that has no value, by the key it came from.
pub fn fault(at: String) -> impl Fn(ExprError) -> SurfaceError {
    move |e| SurfaceError::new(at.clone(), e.to_string())
}

impl Boundary {
    /// Flat curves and zero tangents.
    pub fn flat() -> Self {
        let zero = || Expr::number(0.0, &VARIABLES);
        let tangents = Box::new([(); 4].map(|()| [(); 3].map(|()| zero())));
        Self { curves: Curves::Flat, tangents, tangents_of: TangentsOf::Displacement }
    }

    /// Whether a component's data never changes.
    pub fn constant(&self, component: usize) -> bool {
        let still = |e: &Edges| e.iter().all(|e| !e[component].depends_on(2));
        still(&self.tangents)
            && match &self.curves {
                Curves::Flat => true,
                Curves::Given(edges) => still(edges),
            }
    }

    /// Whether a component is pulled out of the flat square by nothing.
    pub fn at_rest(&self, component: usize) -> bool {
        let zero = |e: &[Expr; 3]| e[component].as_number() == Some(0.0);
        matches!(self.curves, Curves::Flat)
            && self.tangents_of == TangentsOf::Displacement
            && self.tangents.iter().all(zero)
    }

    /// The data of one component at a time.
    ///
    /// # Errors
    /// Expressions without a value; curves that do not meet at a corner.
    pub fn rim(&self, grid: &Grid, component: usize, t: f64) -> Result<Rim, SurfaceError> {
        let curves = match &self.curves {
            Curves::Flat => EDGES.map(|e| {
                let (nodes, _) = grid.edge(e);
                nodes.iter().map(|&p| grid.uv(p).get(component).copied().unwrap_or(0.0)).collect()
            }),
            Curves::Given(edges) => {
                let curves = sample(grid, edges, component, t, "curves")?;
                meet(&curves, component, t)?;
                curves
            }
        };
        let mut tangents = sample(grid, &self.tangents, component, t, "tangents")?;
        if self.tangents_of == TangentsOf::Displacement {
            for (k, edge) in EDGES.iter().enumerate() {
                let flat = f64::from(u8::from(component == edge.axis));
                for (s, x) in tangents[k].iter_mut().enumerate() {
                    *x += match self.curves {
                        Curves::Flat => flat,
                        Curves::Given(_) => rest_tangent(grid, &curves, k, s),
                    };
                }
            }
        }
        Ok(Rim { curves, tangents })
    }
}

/// One component of the edges' expressions at their nodes.
fn sample(
    grid: &Grid,
    edges: &Edges,
    component: usize,
    t: f64,
    key: &str,
) -> Result<[Vec<f64>; 4], SurfaceError> {
    let mut out = [const { vec![] }; 4];
    for (k, edge) in EDGES.iter().enumerate() {
        let at = format!("boundary.{key}.{}[{component}]", EDGE_NAMES[k]);
        let (nodes, _) = grid.edge(*edge);
        let values = nodes.iter().map(|&p| {
            let [u, v] = grid.uv(p);
            edges[k][component].eval(&[u, v, t])
        });
        out[k] = values.collect::<Result<_, _>>().map_err(fault(at))?;
    }
    Ok(out)
}

/// Refuses curves whose ends differ by more than a millionth of their size.
fn meet(curves: &[Vec<f64>; 4], component: usize, t: f64) -> Result<(), SurfaceError> {
    let size = curves.iter().flatten().fold(1.0, |m: f64, x| m.max(x.abs()));
    for (a, first) in [(0, true), (1, true), (0, false), (1, false)] {
        // The corner at the start (end) of edge u = a is an end of edge v = 0 (v = 1).
        let b = if first { 2 } else { 3 };
        let end = |k: usize, first: bool| {
            let end = if first { curves[k].first() } else { curves[k].last() };
            end.copied().unwrap_or(0.0)
        };
        let (p, q) = (end(a, first), end(b, a == 0));
        if (p - q).abs() > 1e-6 * size {
            let (at, other) = (EDGE_NAMES[a], EDGE_NAMES[b]);
            return Err(SurfaceError::new(
                format!("boundary.curves.{other}[{component}]"),
                format!("is {q} in the corner where {at} is {p}, at t = {t}"),
            ));
        }
    }
    Ok(())
}

/// The bilinear Coons patch of the curves at a node.
pub fn rest(grid: &Grid, curves: &[Vec<f64>; 4], i: usize, j: usize) -> f64 {
    let (a, b) = (grid.parameter(0, i), grid.parameter(1, j));
    let [u0, u1, v0, v1] = curves;
    let lerp = |x: f64, y: f64, s: f64| x + s * (y - x);
    let (low, high) = (lerp(u0[0], u1[0], a), lerp(u0[u0.len() - 1], u1[u1.len() - 1], a));
    lerp(u0[j], u1[j], a) + lerp(v0[i], v1[i], b) - lerp(low, high, b)
}

/// Derivative of the rest patch across an edge at its node `s`: one-sided, of second order.
fn rest_tangent(grid: &Grid, curves: &[Vec<f64>; 4], edge: usize, s: usize) -> f64 {
    let axis = EDGES[edge].axis;
    let x = |k: usize| {
        let k = if EDGES[edge].last { grid.size[axis] - 1 - k } else { k };
        if axis == 0 { rest(grid, curves, k, s) } else { rest(grid, curves, s, k) }
    };
    let slope = (4.0 * x(1) - 3.0 * x(0) - x(2)) / (2.0 * grid.step(axis));
    if EDGES[edge].last { -slope } else { slope }
}

impl Rim {
    /// The rest patch between the curves, as a net with this rim.
    pub fn rest(&self, grid: &Grid) -> Vec<f64> {
        let mut net = vec![0.0; grid.net_len()];
        for i in 0..grid.size[0] {
            for j in 0..grid.size[1] {
                net[grid.net(i, j)] = rest(grid, &self.curves, i, j);
            }
        }
        self.impose(grid, &mut net);
        net
    }

    /// Puts the curves on the boundary nodes of a net and renews its ghosts: the central
    /// difference across an edge is the tangent there, x₋₁ = x₁ - 2 h T, x₊₁ = x₋₁ + 2 h T.
    pub fn impose(&self, grid: &Grid, net: &mut [f64]) {
        for (edge, curve) in EDGES.iter().zip(&self.curves) {
            let (nodes, _) = grid.edge(*edge);
            for (p, x) in nodes.iter().zip(curve) {
                net[*p] = *x;
            }
        }
        for (edge, tangents) in EDGES.iter().zip(&self.tangents) {
            let reach = 2.0 * grid.step(edge.axis) * if edge.last { 1.0 } else { -1.0 };
            let (nodes, inwards) = grid.edge(*edge);
            for (&p, t) in nodes.iter().zip(tangents) {
                net[p.wrapping_add_signed(-inwards)] =
                    net[p.wrapping_add_signed(inwards)] + reach * t;
            }
        }
    }
}
