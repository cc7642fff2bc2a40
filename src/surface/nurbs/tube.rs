//! Tubes round curves.

use super::super::{Domain, Jet, Motion, Surface};
use super::curve::Curve;
use super::morph::CurveMorph;
use super::{SurfaceError, wrong};
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

/// The round ends take this share of the parameters of a run each.
const CAP: f64 = 0.1;

/// Tangents on both sides of a break that differ by more (radians) make a corner.
const CORNER: f64 = 1e-6;

/// Nodes stand so close that the tangent turns by less than this from one to the next (its cosine):
/// the frame between them is carried by the least rotation, which fails at half a turn.
const TURN: f64 = 0.8;

/// A piece gets this many nodes at most before its tangent counts as wild.
const MOST_NODES: usize = 4096;

/// A tube gets this many nodes at most, however many pieces the curve has.
const MOST_IN_ALL: usize = 1 << 22;

/// The tube of a radius round a curve: one closed patch a smooth run of the curve.
///
/// A run from corner to corner, or from end to end, is closed by half balls, so that corners are
/// rounded and the union of the patches is a solid; a closed smooth curve is one ring. u follows the
/// curve (u of the curve, with the half balls before and after it), v goes round it, 0 to 2 pi. The
/// frame is carried along with the least rotation; in a ring what is missing at the end is spread
/// over its length.
pub struct Tube {
    curve: Arc<dyn Curve>,
    radius: f64,
    runs: Vec<Run>,
}

/// A stretch of the curve without corners.
struct Run {
    nodes: Vec<Node>,
    ends: [f64; 2],
    ring: bool,
    /// Turn of the frame from the first to the last node.
    twist: f64,
}

/// A parameter on a piece, the tangent there and a normal.
#[derive(Clone, Copy)]
struct Node {
    u: f64,
    piece: usize,
    t: DVec3,
    n: DVec3,
}

/// A point of the curve, its tangent, and the frame across it, each with its derivative.
struct Frame {
    c: [DVec3; 2],
    t: DVec3,
    n: [DVec3; 2],
    b: [DVec3; 2],
}

/// The tube of a radius (mm) round a curve.
///
/// # Errors
/// A radius that is not positive, a curve that stands still or turns on the spot.
pub fn tube(curve: Arc<dyn Curve>, radius: f64) -> Result<Tube, SurfaceError> {
    if !(radius > 0.0 && radius <= 1e12) {
        return wrong("radius", format!("radius is {radius}; expected a positive number of mm"));
    }
    let breaks = curve.breaks();
    let pieces = breaks.len() - 1;
    let (mut runs, mut count): (Vec<Run>, usize) = (vec![], 0);
    for piece in 0..pieces {
        let nodes = nodes(&*curve, piece)?;
        count += nodes.len();
        if count > MOST_IN_ALL {
            return wrong("curve", format!("the tube needs more than {MOST_IN_ALL} nodes"));
        }
        let end = breaks[piece + 1];
        match runs.last_mut() {
            Some(run) if !corner(run.nodes[run.nodes.len() - 1].t, nodes[0].t) => {
                // The node at the break stands twice, once for each piece.
                run.nodes.extend(nodes);
                run.ends[1] = end;
            }
            _ => runs.push(Run { nodes, ends: [breaks[piece], end], ring: false, twist: 0.0 }),
        }
    }
    let ring = runs.len() == 1 && curve.closed() && {
        let nodes = &runs[0].nodes;
        !corner(nodes[nodes.len() - 1].t, nodes[0].t)
    };
    for run in &mut runs {
        run.carry(ring);
    }
    Ok(Tube { curve, radius, runs })
}

fn corner(a: DVec3, b: DVec3) -> bool {
    a.dot(b) <= 0.0 || a.cross(b).length() > CORNER
}

/// Nodes of a piece, its ends included, without normals yet.
fn nodes(curve: &dyn Curve, piece: usize) -> Result<Vec<Node>, SurfaceError> {
    let breaks = curve.breaks();
    let [a, b] = [breaks[piece], breaks[piece + 1]];
    let mut count = 8;
    while count <= MOST_NODES {
        let at = |i: usize| {
            let u = if i == count { b } else { a + (b - a) * i as f64 / count as f64 };
            match curve.jet(piece, u).d1.try_normalize() {
                Some(t) => Ok(Node { u, piece, t, n: DVec3::ZERO }),
                None => wrong("curve", format!("the curve stands still at u = {u}")),
            }
        };
        let nodes: Vec<Node> = (0..=count).map(at).collect::<Result<_, _>>()?;
        if nodes.windows(2).all(|w| w[0].t.dot(w[1].t) >= TURN) {
            return Ok(nodes);
        }
        count *= 2;
    }
    wrong("curve", format!("the curve turns on the spot between u = {a} and {b}"))
}

/// `x`, across `from`, turned by the least rotation that takes the unit vector `from` to `to`.
fn turned(x: DVec3, from: DVec3, to: DVec3) -> DVec3 {
    x - to.dot(x) / (1.0 + from.dot(to)) * (from + to)
}

impl Run {
    /// Gives each node its normal, carried from the first one.
    fn carry(&mut self, ring: bool) {
        self.nodes[0].n = self.nodes[0].t.any_orthonormal_vector();
        for i in 1..self.nodes.len() {
            let (old, new) = (self.nodes[i - 1], &mut self.nodes[i]);
            let n = turned(old.n, old.t, new.t);
            new.n = n.reject_from_normalized(new.t).normalize_or(n);
        }
        if ring {
            let (first, last) = (self.nodes[0], self.nodes[self.nodes.len() - 1]);
            let side = first.n.cross(first.t);
            self.ring = true;
            self.twist = -last.n.dot(side).atan2(last.n.dot(first.n));
        }
    }

    /// Half the length of the parameters that a round end takes.
    fn cap(&self) -> f64 {
        if self.ring { 0.0 } else { CAP * (self.ends[1] - self.ends[0]) }
    }

    fn frame(&self, curve: &dyn Curve, u: f64) -> Frame {
        let after = self.nodes.partition_point(|node| node.u <= u);
        let node = &self.nodes[after.clamp(1, self.nodes.len() - 1) - 1];
        let jet = curve.jet(node.piece, u);
        let speed = jet.d1.length();
        let t = jet.d1.try_normalize().unwrap_or(node.t);
        let dt = if speed > 0.0 { (jet.d2 - t * t.dot(jet.d2)) / speed } else { DVec3::ZERO };
        // n = n0 - k (t0 + t) with k = t.n0 / (1 + t0.t)
        let (q, h) = (t.dot(node.n), 1.0 + node.t.dot(t));
        let n = node.n - q / h * (node.t + t);
        let dk = (dt.dot(node.n) - q * node.t.dot(dt) / h) / h;
        let dn = -dk * (node.t + t) - q / h * dt;
        Frame { c: [jet.c, jet.d1], t, n: [n, dn], b: [n.cross(t), dn.cross(t) + n.cross(dt)] }
    }
}

impl Surface for Tube {
    fn patches(&self) -> usize {
        self.runs.len()
    }

    fn domain(&self, patch: usize) -> Domain {
        let run = &self.runs[patch];
        let ([a, b], cap) = (run.ends, run.cap());
        Domain { u: [a - cap, b + cap], v: [0.0, TAU], wraps: [run.ring, true] }
    }

    fn jet(&self, patch: usize, uv: DVec2) -> Jet {
        let run = &self.runs[patch];
        let ([a, b], cap) = (run.ends, run.cap());
        let u = uv.x.max(a).min(b);
        let frame = run.frame(&*self.curve, u);
        let turn = run.twist / (b - a);
        let (sin, cos) = (uv.y + turn * (u - a)).sin_cos();
        let [out, d_out] = [0, 1].map(|k| cos * frame.n[k] + sin * frame.b[k]);
        let round = cos * frame.b[0] - sin * frame.n[0];
        let beyond = if cap > 0.0 { ((uv.x - u) / cap).clamp(-1.0, 1.0) } else { 0.0 };
        let r = self.radius;
        if beyond == 0.0 {
            let su = frame.c[1] + r * (d_out + turn * round);
            return Jet { s: frame.c[0] + r * out, su, sv: r * round };
        }
        // The half ball: a quarter of a turn from the rim to the tip, which is exactly one point.
        let (rise, fall) =
            if beyond.abs() == 1.0 { (beyond, 0.0) } else { (FRAC_PI_2 * beyond).sin_cos() };
        Jet {
            s: frame.c[0] + r * (fall * out + rise * frame.t),
            su: r * FRAC_PI_2 / cap * (fall * frame.t - rise * out),
            sv: r * fall * round,
        }
    }
}

/// The tubes round the curves of a morph.
pub struct TubeMotion {
    morph: CurveMorph,
    radius: f64,
}

impl CurveMorph {
    /// The motion of tubes of a radius (mm) round the curves.
    pub fn tubes(self, radius: f64) -> TubeMotion {
        TubeMotion { morph: self, radius }
    }
}

impl Motion for TubeMotion {
    fn at(&self, t: f64) -> Result<Arc<dyn Surface>, SurfaceError> {
        Ok(Arc::new(tube(self.morph.at(t)?, self.radius)?))
    }
}
