//! Thin walls of a mesh made thicker: sheets that enclose nothing, and members thinner than cells can
//! hold.
//!
//! The middle of every thin wall is found from its triangles: half the way to the opposite side,
//! inwards. It is given the thickness asked for, and joined to the shape. Edges of thick parts, which
//! are as near to a side but not to an opposite one, stay as they are.

use super::{Field, Shared};
use crate::bvh::Bvh;
use crate::job::{Cancelled, Job, check};
use crate::mesh::TriMesh;
use crate::num::{Aabb, Interval};
use glam::DVec3;
use rayon::prelude::*;

/// A shape and the middle sheets of its thin walls.
struct Walls {
    solid: Shared,
    middle: Bvh,
    /// Half the thickness, mm.
    half: f64,
    /// Nothing is added below: feet stay on the floor.
    floor: f64,
}

/// What was made thicker, as shares of the mesh's area.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Thickened {
    /// Faces with outside on both sides.
    pub sheets: f64,
    /// Faces of walls thinner than asked for.
    pub walls: f64,
}

/// Longest edge of a piece of a triangle, over the thickness: each is judged at its middle.
const PIECE: f64 = 1.5;
/// Distance off a face at which inside and outside are told apart, over the thickness.
const OFF: f64 = 0.02;
/// A wall this much thinner than asked for is thin.
const THIN: f64 = 0.95;
/// Least rate at which the opposite side comes nearer, going inwards: 1 straight towards it, 0 along a
/// side.
const OPPOSITE: f64 = 0.5;
/// Walls whose middles differ by less than this share of the thickness are of one thickness.
const EVEN: f64 = 0.1;
/// Pieces looked at together.
const RUN: usize = 256;

/// The field with walls of at least `thickness` mm, and what that changed; `mesh` is what the field
/// was made of.
///
/// # Errors
/// [`Cancelled`] when the job is.
pub fn thickened(
    field: Shared,
    mesh: &TriMesh,
    thickness: f64,
    job: &dyn Job,
) -> Result<(Shared, Thickened), Cancelled> {
    let pieces = pieces(mesh, PIECE * thickness);
    let found = pieces
        .par_chunks(RUN)
        .map(|run| {
            check(job)?;
            let at: Vec<_> = run.iter().map(|p| p.at).collect();
            Ok(middles(&*field, &at, thickness))
        })
        .collect::<Result<Vec<_>, Cancelled>>()?;
    let found: Vec<Option<Wall>> = found.into_iter().flatten().collect();
    let (mut middle, mut changed) = (Vec::new(), Thickened::default());
    let (pieces, found) = (&pieces[..], &found[..]);
    let mut from = 0;
    for face in pieces.chunk_by(|a, b| a.face == b.face) {
        let walls = &found[from..from + face.len()];
        from += face.len();
        for (p, wall) in face.iter().zip(walls) {
            let Some(wall) = wall else { continue };
            let share = if wall.depth > 0.0 { &mut changed.walls } else { &mut changed.sheets };
            *share += area(&p.at);
        }
        let whole = mesh.faces[face[0].face as usize].map(|v| mesh.points[v as usize]);
        match alike(walls, EVEN * thickness) {
            // few large triangles are searched faster than many small ones
            Some(by) => middle.push(whole.map(|p| p + by)),
            None => {
                let walls = face.iter().zip(walls).filter_map(|(p, w)| Some((p, w.as_ref()?)));
                middle.extend(walls.map(|(p, w)| p.at.map(|q| q + w.by)));
            }
        }
    }
    if middle.is_empty() {
        return Ok((field, changed));
    }
    let all: f64 = pieces.iter().map(|p| area(&p.at)).sum();
    (changed.sheets, changed.walls) = (changed.sheets / all, changed.walls / all);
    let floor = mesh.bounds().min.z;
    let walls = Walls { solid: field, middle: Bvh::new(&middle), half: 0.5 * thickness, floor };
    Ok((std::sync::Arc::new(walls), changed))
}

fn area([a, b, c]: &[DVec3; 3]) -> f64 {
    0.5 * (b - a).cross(c - a).length()
}

/// A piece of a triangle.
struct Piece {
    face: u32,
    at: [DVec3; 3],
}

/// A thin wall under a piece.
struct Wall {
    /// From the face to the wall's middle.
    by: DVec3,
    /// How thick it is, mm; nought for a sheet.
    depth: f64,
}

/// The way to the middle, where all pieces of a face lie on walls of one thickness.
fn alike(walls: &[Option<Wall>], within: f64) -> Option<DVec3> {
    let first = walls.first()?.as_ref()?.by;
    let near = |w: &Option<Wall>| w.as_ref().is_some_and(|w| w.by.distance(first) <= within);
    walls.iter().all(near).then_some(first)
}

/// The triangles of a mesh, cut until no edge is longer than `most`.
fn pieces(mesh: &TriMesh, most: f64) -> Vec<Piece> {
    let mut out = Vec::new();
    for (face, f) in mesh.faces.iter().enumerate() {
        let mut open = vec![f.map(|v| mesh.points[v as usize])];
        while let Some(t) = open.pop() {
            let length = |i: usize| t[i].distance_squared(t[(i + 1) % 3]);
            let longest = (0..3).fold(0, |l, i| if length(i) > length(l) { i } else { l });
            if length(longest) <= most * most {
                if area(&t) > 0.0 {
                    out.push(Piece { face: face as u32, at: t });
                }
                continue;
            }
            let [a, b, c] = [t[longest], t[(longest + 1) % 3], t[(longest + 2) % 3]];
            let m = a.midpoint(b);
            open.extend([[m, b, c], [a, m, c]]);
        }
    }
    out
}

/// A piece, looked at from its middle.
struct Spot {
    /// Its place in the run.
    n: usize,
    at: DVec3,
    inward: DVec3,
}

impl Spot {
    fn new((n, [a, b, c]): (usize, &[DVec3; 3])) -> Self {
        let outward = (b - a).cross(c - a).normalize_or_zero();
        Self { n, at: (a + b + c) / 3.0, inward: -outward }
    }

    fn turned(self) -> Self {
        Self { inward: -self.inward, ..self }
    }
}

/// Values this far inwards of spots.
fn inwards(field: &dyn Field, spots: &[Spot], by: f64) -> Vec<f64> {
    let at: Vec<DVec3> = spots.iter().map(|s| s.at + by * s.inward).collect();
    let mut out = vec![0.0; at.len()];
    field.values(&at, &mut out);
    out
}

/// Those spots that have no thick wall inwards.
fn unsettled(field: &dyn Field, spots: Vec<Spot>, half: f64) -> Vec<Spot> {
    let f = inwards(field, &spots, half);
    spots.into_iter().zip(f).filter(|(_, f)| *f > -THIN * half).map(|(s, _)| s).collect()
}

/// The walls under those pieces of a run that have thin ones.
fn middles(field: &dyn Field, run: &[[DVec3; 3]], thickness: f64) -> Vec<Option<Wall>> {
    let (half, off) = (0.5 * thickness, OFF * thickness);
    // most faces are turned outwards, and few walls are thin
    let spots = unsettled(field, run.iter().enumerate().map(Spot::new).collect(), half);
    let spots = unsettled(field, spots.into_iter().map(Spot::turned).collect(), half);
    let sides = [off, -off].map(|by| inwards(field, &spots, by));
    let mut out: Vec<Option<Wall>> = run.iter().map(|_| None).collect();
    let mut walls = Vec::new();
    for (n, s) in spots.into_iter().enumerate() {
        let (inside, outside) = (sides[0][n], sides[1][n]);
        if inside.min(outside) > 0.0 {
            out[s.n] = Some(Wall { by: DVec3::ZERO, depth: 0.0 });
        } else if inside.max(outside) > -0.5 * off {
            walls.push(if inside <= outside { s } else { s.turned() });
        }
    }
    let [here, next] = [half, half + off].map(|by| inwards(field, &walls, by));
    for ((s, f), next) in walls.into_iter().zip(here).zip(next) {
        let depth = (half - f).clamp(off, thickness);
        if next - f > OPPOSITE * off && depth < THIN * thickness {
            out[s.n] = Some(Wall { by: 0.5 * depth * s.inward, depth });
        }
    }
    out
}

impl Walls {
    fn joined(&self, solid: f64, distance: f64, p: DVec3) -> f64 {
        solid.min((distance - self.half).max(self.floor - p.z))
    }
}

impl Field for Walls {
    fn value(&self, p: DVec3) -> f64 {
        self.joined(self.solid.value(p), self.middle.distance(p), p)
    }

    fn values(&self, at: &[DVec3], out: &mut [f64]) {
        self.solid.values(at, out);
        for ((f, hit), &p) in out.iter_mut().zip(self.middle.nearest_all(at)).zip(at) {
            *f = self.joined(*f, hit.distance2.sqrt(), p);
        }
    }

    fn bound(&self, b: &Aabb) -> Interval {
        let radius = b.radius();
        if !radius.is_finite() {
            return Interval::ALL;
        }
        let centre = b.centre();
        let round_off = 1e-12 * (self.half + centre.abs().max_element());
        let sheet = Interval::ball(self.middle.distance(centre) - self.half, radius);
        let floor = Interval::new(self.floor - b.max.z, self.floor - b.min.z);
        self.solid.bound(b).min(sheet.max(floor).widen(round_off))
    }

    fn bytes(&self) -> usize {
        self.solid.bytes() + self.middle.bytes()
    }

    fn support(&self) -> Aabb {
        let mut sheet = self.middle.bounds().grow(self.half);
        sheet.min.z = sheet.min.z.max(self.floor);
        self.solid.support().hull(sheet)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::mesh::{MeshField, MeshOptions};
    use crate::field::sampled::Sampled;
    use crate::job::Quiet;
    use std::sync::Arc;

    /// A box as triangles, outward.
    fn block(low: [f64; 3], high: [f64; 3]) -> TriMesh {
        let e = crate::element::Element::block(
            0.5 * (DVec3::from(low) + DVec3::from(high)),
            0.5 * (DVec3::from(high) - DVec3::from(low)),
            glam::DQuat::IDENTITY,
        );
        crate::element::tessellate(&e.unwrap(), 4).unwrap()
    }

    fn made(mesh: &TriMesh, thickness: f64) -> (Shared, Thickened) {
        let (field, _) = MeshField::new(mesh, &MeshOptions::default(), &Quiet).unwrap();
        thickened(Arc::new(field), mesh, thickness, &Quiet).unwrap()
    }

    #[test]
    fn a_thin_plate_gets_its_thickness_and_a_thick_one_is_left_alone() {
        let mut mesh = block([0.0, 0.0, 0.0], [100.0, 80.0, 60.0]);
        let (same, changed) = made(&mesh, 10.0);
        assert_eq!(changed, Thickened::default());
        assert!((same.value(DVec3::new(50.0, 40.0, 59.0)) + 1.0).abs() < 1e-9);
        // a plate of 2 mm beside it
        mesh.append(&block([120.0, 0.0, 0.0], [122.0, 80.0, 60.0]));
        let (field, changed) = made(&mesh, 10.0);
        assert!((0.1..0.5).contains(&changed.walls) && changed.sheets == 0.0, "{changed:?}");
        for (x, f) in [(121.0, -5.0), (116.0, 0.0), (126.0, 0.0), (110.0, 6.0)] {
            let v = field.value(DVec3::new(x, 40.0, 30.0));
            assert!((v - f).abs() < 1e-6, "{x}: {v}");
        }
        // the thick part and the floor are where they were
        assert!((field.value(DVec3::new(-1.0, 40.0, 30.0)) - 1.0).abs() < 1e-9);
        assert!(field.value(DVec3::new(121.0, 40.0, -0.5)) > 0.0);
    }

    #[test]
    fn a_sheet_beside_a_solid_gets_its_thickness() {
        let mut mesh = block([0.0, 0.0, 0.0], [100.0, 80.0, 60.0]);
        let corners = [[50.0, 40.0, 60.0], [90.0, 40.0, 60.0], [90.0, 40.0, 160.0]];
        let at = mesh.points.len() as u32;
        mesh.points.extend(corners.map(DVec3::from));
        mesh.faces.push([at, at + 1, at + 2]);
        let (field, changed) = made(&mesh, 8.0);
        assert!(changed.sheets > 0.0 && changed.walls == 0.0, "{changed:?}");
        assert!((field.value(DVec3::new(85.0, 41.0, 110.0)) + 3.0).abs() < 1e-6);
    }

    #[test]
    fn bounds_and_batches_agree_with_values() {
        let mesh = block([0.0, 0.0, 0.0], [3.0, 80.0, 60.0]);
        let (field, _) = made(&mesh, 9.0);
        let at: Vec<DVec3> = (0..400)
            .map(|i| {
                let x = |k: u32| f64::from(i * k % 97);
                DVec3::new(x(7) - 40.0, x(11), x(13) - 20.0)
            })
            .collect();
        let mut all = vec![0.0; at.len()];
        field.values(&at, &mut all);
        for (p, v) in at.iter().zip(&all) {
            assert_eq!(field.value(*p), *v);
            let b = Aabb::around(*p, DVec3::splat(4.0));
            let bound = field.bound(&b);
            for c in b.corners().into_iter().chain([*p]) {
                assert!(bound.contains(field.value(c)), "{p}");
            }
            assert!(*v > 0.0 || field.support().contains(*p));
        }
        let volume = Sampled::new(field, 2.0, &Quiet).unwrap().volume();
        assert!(volume > 9.0 * 80.0 * 60.0 && volume < 9.0 * 89.0 * 69.0, "{volume}");
    }
}
