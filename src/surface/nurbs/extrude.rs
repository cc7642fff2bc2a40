//! Closed planar curves made solid.

use super::curve::{Curve, polyline};
use super::{SurfaceError, wrong};
use crate::mesh::TriMesh;
use crate::mesh::polygon::{Cut, MOST_CORNERS, triangulate};
use glam::{DVec2, DVec3};
use robust::{Coord, orient2d};

/// The solid between a closed planar curve and its copy `height` (mm) along the normal of its plane,
/// the normal that points up (or, for an upright plane, back or to the right). Its walls stay within
/// `tolerance` (mm) of the curve; the mesh is closed.
///
/// # Errors
/// A curve that is open, not planar to the tolerance, or meets itself; a height or tolerance that is
/// not positive, or a tolerance that asks for too many points.
pub fn extrude(curve: &dyn Curve, height: f64, tolerance: f64) -> Result<TriMesh, SurfaceError> {
    if !(height > 0.0 && height <= 1e12) {
        return wrong("height", format!("height is {height}; expected a positive number of mm"));
    }
    if !curve.closed() {
        let [a, b] = curve.domain();
        let gap = curve.point(a).distance(curve.point(b));
        return wrong("curve", format!("the curve is open: its ends are {gap} mm apart"));
    }
    let mut ring = polyline(curve, tolerance)?;
    ring.dedup();
    if ring.len() > MOST_CORNERS {
        let why = format!("{} points at {tolerance} mm; the most is {MOST_CORNERS}", ring.len());
        return wrong("tolerance", why);
    }
    let normal = stand(&mut ring, tolerance)?;
    simple(&ring, normal)?;
    let n = ring.len() as u32;
    let mut cap = vec![];
    if triangulate(&(0..n).collect::<Vec<_>>(), &ring, &mut cap) == Cut::Tangled {
        return wrong("curve", "the curve meets itself");
    }
    let mut mesh = TriMesh::default();
    mesh.points.extend(&ring);
    mesh.points.extend(ring.iter().map(|p| p + normal * height));
    mesh.faces.extend(cap.iter().map(|&[a, b, c]| [a, c, b]));
    mesh.faces.extend(cap.iter().map(|f| f.map(|i| i + n)));
    for i in 0..n {
        let j = (i + 1) % n;
        mesh.faces.extend([[i, j, j + n], [i, j + n, i + n]]);
    }
    Ok(mesh)
}

/// The unit normal of the ring's plane, turned up; the ring is turned so that it goes
/// counter-clockwise seen from there.
fn stand(ring: &mut [DVec3], tolerance: f64) -> Result<DVec3, SurfaceError> {
    let o = ring[0];
    let sum: DVec3 = ring.windows(2).map(|w| (w[0] - o).cross(w[1] - o)).sum();
    let Some(mut normal) = sum.try_normalize() else {
        return wrong("curve", "the curve encloses no area");
    };
    if let Some(off) = ring.iter().map(|&p| (p - o).dot(normal).abs()).reduce(f64::max)
        && off > tolerance
    {
        return wrong("curve", format!("the curve is not planar: it leaves its plane by {off} mm"));
    }
    // The largest component decides, z before y before x where they are equal.
    let [x, y, z] = normal.to_array();
    let main = [y, x].into_iter().fold(z, |m, c| if c.abs() > m.abs() + 1e-9 { c } else { m });
    if main < 0.0 {
        ring.reverse();
        normal = -normal;
    }
    Ok(normal)
}

/// Refuses a ring of which two sides touch.
fn simple(ring: &[DVec3], normal: DVec3) -> Result<(), SurfaceError> {
    let x = normal.any_orthonormal_vector();
    let y = normal.cross(x);
    let flat: Vec<DVec2> = ring.iter().map(|p| DVec2::new(p.dot(x), p.dot(y))).collect();
    let n = flat.len();
    let side = |i: usize| [flat[i], flat[(i + 1) % n]];
    let low = |i: usize| side(i)[0].x.min(side(i)[1].x);
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &j| low(i).total_cmp(&low(j)));
    for (k, &i) in order.iter().enumerate() {
        let high = side(i)[0].x.max(side(i)[1].x);
        for &j in order[k + 1..].iter().take_while(|&&j| low(j) <= high) {
            let meets = match ((i + 1) % n == j, (j + 1) % n == i) {
                (true, true) => true,
                (true, _) => folds(side(i), side(j)),
                (_, true) => folds(side(j), side(i)),
                _ => touch(side(i), side(j)),
            };
            if meets {
                let p = ring[i];
                let why = format!("the curve meets itself near ({}, {}, {})", p.x, p.y, p.z);
                return wrong("curve", why);
            }
        }
    }
    Ok(())
}

fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(c))
}

/// Whether a side goes straight back over the one before.
fn folds([a, b]: [DVec2; 2], [_, c]: [DVec2; 2]) -> bool {
    turn(a, b, c) == 0.0 && (b - a).dot(c - b) < 0.0
}

/// Whether two sides share a point.
fn touch([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let [p, q] = [turn(a, b, c), turn(a, b, d)];
    let [r, s] = [turn(c, d, a), turn(c, d, b)];
    let apart = |x: f64, y: f64| (x > 0.0 && y > 0.0) || (x < 0.0 && y < 0.0);
    if apart(p, q) || apart(r, s) {
        return false;
    }
    // All four on one line: they touch if their boxes do.
    let over = |u: f64, v: f64, w: f64, x: f64| u.min(v) <= w.max(x) && w.min(x) <= u.max(v);
    over(a.x, b.x, c.x, d.x) && over(a.y, b.y, c.y, d.y)
}
