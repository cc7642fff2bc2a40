//! The nodes of the unit square and the difference operator on them.

use super::Control;

/// Nodes on [0, 1]², with a ring of ghosts around them.
///
/// A *net* is one number a node and ghost, u-rows of v: node (i, j) stands at
/// `(i + 1) * (n_v + 2) + j + 1`. The unknowns are the nodes off the boundary, ordered along the
/// shorter side first, so that the band of the matrix is twice the shorter side.
#[derive(Clone, Debug)]
pub struct Grid {
    /// Nodes along u and v, at least [`Self::LEAST`].
    pub size: [usize; 2],
    /// The net index of each unknown.
    pub unknowns: Vec<usize>,
}

/// One edge of the square, in the order u = 0, u = 1, v = 0, v = 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// 0 where u is fixed, 1 where v is.
    pub axis: usize,
    /// Whether it is the last node along that axis.
    pub last: bool,
}

/// The four edges, in the order in which boundary data lists them.
pub const EDGES: [Edge; 4] = [
    Edge { axis: 0, last: false },
    Edge { axis: 0, last: true },
    Edge { axis: 1, last: false },
    Edge { axis: 1, last: true },
];

/// What the surface file calls the edges.
pub const EDGE_NAMES: [&str; 4] = ["u0", "u1", "v0", "v1"];

impl Grid {
    /// Fewest nodes along a side: three unknowns, so that the operator sees both boundaries once.
    pub const LEAST: usize = 5;

    /// A grid of `size` nodes.
    pub fn new(size: [usize; 2]) -> Self {
        let mut grid = Self { size, unknowns: vec![] };
        let [slow, fast] = grid.order();
        grid.unknowns = (1..size[slow] - 1)
            .flat_map(|s| (1..size[fast] - 1).map(move |f| (s, f)))
            .map(|(s, f)| if slow == 0 { grid.net(s, f) } else { grid.net(f, s) })
            .collect();
        grid
    }

    /// The axes in the order of the unknowns, slow one first.
    pub fn order(&self) -> [usize; 2] {
        if self.size[1] <= self.size[0] { [0, 1] } else { [1, 0] }
    }

    /// Net index of a node.
    pub fn net(&self, i: usize, j: usize) -> usize {
        (i + 1) * (self.size[1] + 2) + j + 1
    }

    /// Numbers in a net.
    pub fn net_len(&self) -> usize {
        (self.size[0] + 2) * (self.size[1] + 2)
    }

    /// The step in the net along an axis.
    fn stride(&self, axis: usize) -> usize {
        if axis == 0 { self.size[1] + 2 } else { 1 }
    }

    /// Parameter distance of neighbours along an axis.
    pub fn step(&self, axis: usize) -> f64 {
        1.0 / (self.size[axis] - 1) as f64
    }

    /// Parameter of a node along an axis; the last one is exactly 1.
    pub fn parameter(&self, axis: usize, i: usize) -> f64 {
        i as f64 / (self.size[axis] - 1) as f64
    }

    /// Parameters of the node that a net index stands for.
    pub fn uv(&self, net: usize) -> [f64; 2] {
        let row = self.size[1] + 2;
        let [i, j] = [net / row, net % row].map(|k| k.saturating_sub(1));
        [self.parameter(0, i), self.parameter(1, j)]
    }

    /// The nodes of an edge: net index of each, along the edge, and the way inwards.
    pub fn edge(&self, edge: Edge) -> (Vec<usize>, isize) {
        let across = edge.axis;
        let k = if edge.last { self.size[across] - 1 } else { 0 };
        let nodes = (0..self.size[1 - across])
            .map(|s| if across == 0 { self.net(k, s) } else { self.net(s, k) })
            .collect();
        let inwards = self.stride(across) as isize;
        (nodes, if edge.last { -inwards } else { inwards })
    }

    /// b, c and d over the powers of the steps.
    pub fn coefficients(&self, control: &Control) -> [f64; 3] {
        let [hu, hv] = [self.step(0), self.step(1)].map(|h| h * h);
        [control.b / (hu * hu), control.c / (hu * hv), control.d / (hv * hv)]
    }

    /// The operator b ∂⁴/∂u⁴ + c ∂⁴/∂u²∂v² + d ∂⁴/∂v⁴ at every unknown (You and Zhang 2007,
    /// eq. 3), boundary and ghosts taken from the net.
    pub fn operate(&self, control: &Control, net: &[f64], out: &mut [f64]) {
        let [b, c, d] = self.coefficients(control);
        let (u, v) = (self.stride(0), self.stride(1));
        for (out, &p) in out.iter_mut().zip(&self.unknowns) {
            let x = |k: usize| net[k];
            let near_u = x(p - u) + x(p + u);
            let near_v = x(p - v) + x(p + v);
            let far_u = x(p - 2 * u) + x(p + 2 * u);
            let far_v = x(p - 2 * v) + x(p + 2 * v);
            let slant = (x(p - u - v) + x(p + u - v)) + (x(p - u + v) + x(p + u + v));
            *out = b * (6.0 * x(p) - 4.0 * near_u + far_u)
                + c * (4.0 * x(p) - 2.0 * (near_u + near_v) + slant)
                + d * (6.0 * x(p) - 4.0 * near_v + far_v);
        }
    }
}
