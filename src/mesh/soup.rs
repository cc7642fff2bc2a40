//! Points and polygons as a file has them, before anything is cut, welded or counted.

use super::{
    TriMesh, Up,
    error::{Parsed, fault},
    found::Polygons,
    polygon::{Cut, triangulate},
};
use glam::DVec3;

/// Raw contents of a file. The optional lists are empty where they would say nothing.
#[derive(Default)]
pub(super) struct Soup {
    /// In the file's axes and unit.
    pub points: Vec<DVec3>,
    /// Corners of all polygons, one after the other.
    pub corners: Vec<u32>,
    /// Corners of each polygon; empty when all are triangles.
    pub sizes: Vec<u32>,
    /// Line of each point, for text files.
    pub point_lines: Vec<u32>,
    /// Line of each polygon, for text files.
    pub lines: Vec<u32>,
    /// Number of the first point, for messages: 1 in OBJ.
    pub first: u64,
}

impl Soup {
    /// The polygons in order.
    fn rings(&self) -> impl Iterator<Item = &[u32]> {
        let (threes, mut rest) = if self.sizes.is_empty() {
            (self.corners.chunks_exact(3), &self.corners[..0])
        } else {
            ([].chunks_exact(3), &self.corners[..])
        };
        let mixed = self.sizes.iter().map(move |&n| {
            let (ring, tail) = rest.split_at(rest.len().min(n as usize));
            rest = tail;
            ring
        });
        threes.chain(mixed)
    }

    /// Refuses corners that are no points, and points that are used but no numbers (or, in units
    /// of `mm`, too large for f32).
    pub fn check(&self, mm: f64) -> Parsed<()> {
        let sound = |p: DVec3| (p * mm).abs().cmple(DVec3::splat(f64::from(f32::MAX))).all();
        let bad = |&v: &u32| self.points.get(v as usize).is_none_or(|&p| !sound(p));
        for (i, ring) in self.rings().enumerate() {
            let Some(&v) = ring.iter().find(|v| bad(v)) else {
                continue;
            };
            let number = u64::from(v) + self.first;
            let face = place("face", i as u64 + self.first, self.lines.get(i));
            let Some(p) = self.points.get(v as usize) else {
                let count = self.points.len();
                return fault(face, format!("point {number}, but there are {count} points"));
            };
            let at = place("point", number, self.point_lines.get(v as usize));
            let what = if p.is_finite() { "beyond the range of f32" } else { "not finite" };
            return fault(at, format!("({}, {}, {}) is {what}, and used by {face}", p.x, p.y, p.z));
        }
        Ok(())
    }

    /// Triangles in mm, Z up. Call [`Soup::check`] first.
    pub fn cut(self, up: Up, mm: f64) -> (TriMesh, Polygons) {
        let mut kinds = Polygons::default();
        let mut faces = Vec::with_capacity(self.corners.len() / 3);
        for ring in self.rings() {
            if let [a, b, c] = *ring {
                kinds.triangles += 1;
                faces.push([a, b, c]);
                continue;
            }
            match ring.len() {
                0..=2 => kinds.nothing += 1,
                4 => kinds.quads += 1,
                _ => kinds.larger += 1,
            }
            if ring.len() > 3 {
                let before = faces.len();
                match triangulate(ring, &self.points, &mut faces) {
                    _ if faces.len() == before => kinds.nothing += 1,
                    Cut::Convex => {}
                    Cut::Concave => kinds.concave += 1,
                    Cut::Tangled => kinds.tangled += 1,
                }
            }
        }
        let mut points = self.points;
        points.iter_mut().for_each(|p| *p = up.to_z(*p) * mm);
        (TriMesh { points, faces }, kinds)
    }
}

/// `line 12 (face 3)`, or only `face 3` where there are no lines.
fn place(what: &str, number: u64, line: Option<&u32>) -> String {
    match line {
        Some(line) => format!("line {line} ({what} {number})"),
        None => format!("{what} {number}"),
    }
}
