//! The faces, and pieces of faces, across which inside and outside change: the surface. What lies
//! inside the union of several shells, or has outside on both sides, is none.

use super::cut::{Class, Cuts, Cutter, Piece, Scale};
use super::inside::Inside;
use super::soup::{Sets, Sides};
use crate::bvh::{Bvh, Flat, Winding, apart};
use crate::job::{Cancelled, Job, check};
use glam::DVec3;
use rayon::prelude::*;

/// Faces whose contacts are looked for together.
const RUN: usize = 64;
/// Runs, or faces, worked on between two looks at the job and the limits.
const CHUNK: usize = 256;
/// Work spent on cutting in all, and for each face; some seconds at most. Faces beyond are left
/// whole, by their middles.
const LIMIT: usize = 10_000_000;
const LIMIT_EACH: usize = 500;
/// Faces whose two sides are looked at together.
const GROUP: usize = Winding::LANES / 2;
/// Faces looked at to tell that a patch is of one class.
const PROBES: usize = 8;
/// Faces lower than this many slacks are no sheets but leftovers at seams.
const SHEET: f64 = 4.0;

/// When the side of a face on which a point lies tells whether it is inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Trust {
    /// Where the point's foot lies within the face by more than this, mm.
    Within(f64),
    /// Near another point on the same side whose sign is known.
    Local,
    /// Nowhere.
    Never,
}

/// The surface, ready for measuring distances.
#[derive(Clone, Debug, Default)]
pub(super) struct Surface {
    /// Whether it is all faces as they were given, in their order.
    pub whole: bool,
    pub triangles: Vec<[DVec3; 3]>,
    /// For each, when its sides tell inside from outside.
    pub trust: Vec<Trust>,
    /// Triangles left out although the sign may change across them after all.
    pub ghosts: Vec<[DVec3; 3]>,
    /// Culled pieces of faces in contact: a face so near to one of them does not tell the sign.
    pub culled: Vec<[DVec3; 3]>,
    /// Faces with outside on both sides over most of their area: sheets.
    pub sheets: Vec<[DVec3; 3]>,
    pub buried_area: f64,
    pub nothing_area: f64,
    pub buried_faces: usize,
    pub contact_faces: usize,
}

/// Faces over shared points, with what is asked of them again and again.
struct Faces<'a> {
    faces: &'a [[u32; 3]],
    triangles: Vec<[DVec3; 3]>,
    /// Unit normals, zero for a face without area.
    normals: Vec<DVec3>,
    inside: &'a Inside,
    scale: Scale,
}

/// Faces of one class, with what their sides tell.
type Group = (Vec<u32>, Class, Trust);

/// Whether some groups are all of so many faces, in their order, and all surface as they are.
fn all_surface(groups: &[Group], faces: usize) -> bool {
    groups.iter().all(|g| g.1 == Class::Surface)
        && groups.iter().flat_map(|g| &g.0).copied().eq(0..faces as u32)
}

fn area(t: &[DVec3]) -> f64 {
    (1..t.len().saturating_sub(1))
        .map(|i| (t[i] - t[0]).cross(t[i + 1] - t[0]).length() * 0.5)
        .sum()
}

/// Least height of a triangle.
fn height(t: &[DVec3; 3]) -> f64 {
    let longest = (0..3).map(|i| t[i].distance(t[(i + 1) % 3])).fold(0.0, f64::max);
    2.0 * area(t) / longest
}

/// Whether two faces with a common side lie flat on each other, within `slack`; corner `apex` of
/// the first is the one off that side.
fn folded(
    t: &[DVec3; 3],
    apex: usize,
    u: &[DVec3; 3],
    g: [u32; 3],
    f: [u32; 3],
    slack: f64,
) -> bool {
    let (a, b, p) = (t[(apex + 1) % 3], t[(apex + 2) % 3], t[apex]);
    let Some(q) = (0..3).find(|&i| !f.contains(&g[i])).map(|i| u[i]) else {
        return true;
    };
    let along = (b - a).normalize_or_zero();
    let across = |x: DVec3| (x - a) - along * (x - a).dot(along);
    let (p, q) = (across(p), across(q));
    // the lower one against the plane of the higher one
    let (low, high) = if p.length() < q.length() { (p, q) } else { (q, p) };
    low.dot(high) > 0.0 && low.reject_from(high).length() < slack
}

fn middle(t: &[DVec3; 3]) -> DVec3 {
    (t[0] + t[1] + t[2]) / 3.0
}

impl Surface {
    /// Sorts out the faces of the shells that `inside` is made of; `bvh` is the tree over them.
    pub(super) fn new(
        triangles: Vec<[DVec3; 3]>,
        faces: &[[u32; 3]],
        bvh: &Bvh,
        inside: &Inside,
        scale: Scale,
        job: &dyn Job,
    ) -> Result<Self, Cancelled> {
        let normal = |t: &[DVec3; 3]| (t[1] - t[0]).cross(t[2] - t[0]).normalize_or_zero();
        let normals = triangles.par_iter().map(normal).collect();
        let all = Faces { faces, triangles, normals, inside, scale };
        let contacts = all.contacts(bvh, job)?;
        let mut surface = Self::default();
        let untouched = all.untouched(bvh, &contacts, job)?;
        if all_surface(&untouched, faces.len()) {
            let trust = untouched.iter().flat_map(|(group, _, t)| group.iter().map(|_| *t));
            let trust = trust.collect();
            return Ok(Self { whole: true, triangles: all.triangles, trust, ..surface });
        }
        for (group, class, trust) in untouched {
            for f in group {
                let t = &all.triangles[f as usize];
                surface.add(t, class, trust);
                surface.buried_faces += usize::from(class == Class::Buried);
                if class == Class::Nothing && height(t) > SHEET * scale.slack {
                    surface.sheets.push(*t);
                }
            }
        }
        all.touched(&contacts, &mut surface, job)?;
        surface.whole = surface.triangles == all.triangles;
        Ok(surface)
    }

    fn add(&mut self, corners: &[DVec3], class: Class, trust: Trust) {
        match class {
            Class::Buried => self.buried_area += area(corners),
            Class::Nothing => self.nothing_area += area(corners),
            Class::Surface | Class::Reversed => {}
        }
        for i in 1..corners.len().saturating_sub(1) {
            let [b, c] = if class == Class::Reversed { [i + 1, i] } else { [i, i + 1] };
            let triangle = [corners[0], corners[b], corners[c]];
            match (class, trust) {
                (Class::Surface | Class::Reversed, _) => {
                    self.triangles.push(triangle);
                    self.trust.push(trust);
                }
                (_, Trust::Within(margin)) if margin > 0.0 => self.culled.push(triangle),
                (_, Trust::Within(_)) => {}
                _ => self.ghosts.push(triangle),
            }
        }
    }
}

impl Faces<'_> {
    /// What lies on both sides of up to four points of faces.
    fn classes(&self, at: &[(DVec3, DVec3)]) -> [Class; GROUP] {
        classes_of(self.inside.which(&self.sides_of(at)))
    }

    /// The points just in front of and behind points of faces.
    fn sides_of(&self, at: &[(DVec3, DVec3)]) -> Vec<DVec3> {
        let off = |&(p, normal): &(DVec3, DVec3)| {
            let off = normal * self.scale.offset;
            [p + off, p - off]
        };
        at.iter().flat_map(off).collect()
    }

    /// For each face the faces that touch or cross it other than where they are joined, in order.
    fn contacts(&self, bvh: &Bvh, job: &dyn Job) -> Result<Vec<Vec<u32>>, Cancelled> {
        let n = self.triangles.len();
        let mut contacts = vec![vec![]; n];
        // a mesh that crosses itself everywhere is not worth more memory than this
        let mut left = 64 * n + 1_000_000;
        for start in (0..n).step_by(CHUNK * RUN) {
            check(job)?;
            job.done(start as f64 / n as f64);
            let end = n.min(start + CHUNK * RUN);
            let found: Vec<Vec<[u32; 2]>> = (start..end)
                .into_par_iter()
                .step_by(RUN)
                .map(|first| {
                    let mut pairs = bvh.close_pairs(first..end.min(first + RUN), self.scale.slack);
                    pairs.retain(|&pair| self.touch(pair));
                    pairs
                })
                .collect();
            for [i, j] in found.into_iter().flatten().take(left) {
                left -= 1;
                contacts[i as usize].push(j);
                contacts[j as usize].push(i);
            }
        }
        contacts.iter_mut().for_each(|c| c.sort_unstable());
        Ok(contacts)
    }

    /// Whether two faces touch or cross other than where they are joined.
    fn touch(&self, pair: [u32; 2]) -> bool {
        let [i, j] = pair.map(|i| i as usize);
        if self.normals[i] == DVec3::ZERO || self.normals[j] == DVec3::ZERO {
            return false;
        }
        let slack = self.scale.slack;
        let (t, u) = (&self.triangles[i], &self.triangles[j]);
        let (f, g) = (self.faces[i], self.faces[j]);
        let flat = |i: usize| Flat(&self.triangles[i], self.normals[i]);
        let common = [0, 1, 2].map(|k| g.iter().position(|&v| v == f[k]));
        match common {
            [None, None, None] => !apart(flat(i), flat(j), slack),
            [Some(_), Some(_), Some(_)] => true,
            [None, Some(_), Some(_)] => folded(t, 0, u, g, f, slack),
            [Some(_), None, Some(_)] => folded(t, 1, u, g, f, slack),
            [Some(_), Some(_), None] => folded(t, 2, u, g, f, slack),
            // joined at a corner: one's opposite side must reach the other
            [k, l, m] => {
                let opposite = |t: &[DVec3; 3], k: usize| [t[(k + 1) % 3], t[(k + 2) % 3]];
                let own = common.iter().position(Option::is_some).unwrap_or(0);
                let other = k.or(l).or(m).unwrap_or(0);
                let meets =
                    |side: &[DVec3], i: usize| !apart(Flat(side, DVec3::ZERO), flat(i), slack);
                meets(&opposite(t, own), j) || meets(&opposite(u, other), i)
            }
        }
    }

    /// Faces without contacts, by patches of one class each, with their trust.
    fn untouched(
        &self,
        bvh: &Bvh,
        contacts: &[Vec<u32>],
        job: &dyn Job,
    ) -> Result<Vec<Group>, Cancelled> {
        check(job)?;
        let free =
            |f: u32| contacts[f as usize].is_empty() && self.normals[f as usize] != DVec3::ZERO;
        let all: Vec<u32> = (0..self.faces.len() as u32).filter(|&f| free(f)).collect();
        let alone = |faces: &[u32]| -> Vec<Group> {
            let known = self.alone(faces);
            faces.iter().zip(known).map(|(&f, (class, trust))| (vec![f], class, trust)).collect()
        };
        if !self.inside.is_closed() {
            // the winding number varies along an open shell; neighbours share most of the way to it
            let near: Vec<u32> = bvh.order().iter().copied().filter(|&f| free(f)).collect();
            let mut known: Vec<Group> = near.par_chunks(GROUP).flat_map_iter(alone).collect();
            known.par_sort_unstable_by_key(|group| group.0.first().copied());
            return Ok(known);
        }
        let sides = Sides::of(self.faces);
        let mut sets = Sets::new(self.faces.len());
        for (_, edge) in sides.edges() {
            if let [x, y] = edge
                && free(x.face())
                && free(y.face())
            {
                sets.join(x.face(), y.face());
            }
        }
        let mut roots: Vec<(u32, u32)> = all.into_iter().map(|f| (sets.find(f), f)).collect();
        roots.sort_unstable();
        let patches: Vec<Vec<u32>> =
            roots.chunk_by(|a, b| a.0 == b.0).map(|c| c.iter().map(|r| r.1).collect()).collect();
        let patch = |patch: Vec<u32>| match self.patch(&patch) {
            Some(class) => vec![(patch, class, Trust::Within(0.0))],
            None => {
                let known = patch.chunks(GROUP).flat_map(alone);
                known.map(|(f, class, _)| (f, class, Trust::Never)).collect()
            }
        };
        Ok(patches.into_par_iter().flat_map_iter(patch).collect())
    }

    /// The class of a patch of a closed shell, by its largest face and some more.
    fn patch(&self, patch: &[u32]) -> Option<Class> {
        let size = |f: u32| area(&self.triangles[f as usize]);
        let sizes = patch.iter().map(|&f| (f, size(f)));
        let (largest, _) = sizes.max_by(|a, b| a.1.total_cmp(&b.1))?;
        let place = |f: u32| (middle(&self.triangles[f as usize]), self.normals[f as usize]);
        let step = patch.len().div_ceil(PROBES);
        let probes = patch.iter().step_by(step).copied();
        let places: Vec<_> = std::iter::once(largest).chain(probes).map(place).collect();
        let first = self.classes(&places[..1])[0];
        let same = |at: &[(DVec3, DVec3)]| self.classes(at)[..at.len()].iter().all(|&c| c == first);
        places[1..].chunks(GROUP).all(same).then_some(first)
    }

    /// The classes of up to four faces, surface where part of one seems to be, and their trust.
    fn alone(&self, faces: &[u32]) -> Vec<(Class, Trust)> {
        let offset = self.scale.offset;
        let places: Vec<(DVec3, DVec3)> = faces
            .iter()
            .map(|&f| (middle(&self.triangles[f as usize]), self.normals[f as usize]))
            .collect();
        let ball = |(&f, &(centre, _)): (&u32, &(DVec3, DVec3))| {
            let corners = self.triangles[f as usize].iter();
            let radius = corners.fold(0.0, |r: f64, p| r.max(p.distance(centre)));
            // round the point in front
            [Some(radius + 2.0 * offset), None]
        };
        let balls: Vec<_> = faces.iter().zip(&places).flat_map(ball).collect();
        let (inside, sharp) = self.inside.which_and_sharp(&self.sides_of(&places), &balls);
        let known = faces.iter().zip(places).zip(classes_of(inside)).enumerate();
        known
            .map(|(i, ((&f, (centre, n)), class))| {
                if sharp >> (2 * i) & 1 == 1 {
                    return (class, Trust::Within(0.0));
                }
                if class.is_surface() {
                    return (class, Trust::Local);
                }
                let t = &self.triangles[f as usize];
                let toward = t.map(|p| (centre + (p - centre) * 0.75, n));
                let [a, b, c, _] = self.classes(&toward);
                let surface = [a, b, c].into_iter().find(|c| c.is_surface());
                (surface.unwrap_or(class), Trust::Local)
            })
            .collect()
    }

    /// Cuts the faces in contact and adds what is surface.
    fn touched(
        &self,
        contacts: &[Vec<u32>],
        out: &mut Surface,
        job: &dyn Job,
    ) -> Result<(), Cancelled> {
        let all: Vec<u32> =
            (0..contacts.len() as u32).filter(|&f| !contacts[f as usize].is_empty()).collect();
        out.contact_faces = all.len();
        let limit = LIMIT + LIMIT_EACH * self.faces.len();
        let mut spent = 0;
        for chunk in all.chunks(CHUNK) {
            check(job)?;
            let full = spent > limit;
            let cut = |&f: &u32| {
                let contacts = if full { &[][..] } else { &contacts[f as usize][..] };
                let n = self.normals[f as usize];
                let cutter = Cutter::new(&self.triangles, &self.normals, self.scale, n);
                cutter.face(f as usize, contacts)
            };
            let cuts: Vec<Cuts> = chunk.par_iter().map(cut).collect();
            spent += cuts.iter().map(|c| c.spent).sum::<usize>();
            self.sort_out(chunk, cuts, full, out);
        }
        Ok(())
    }

    /// Adds what is surface of faces that have been cut; with `full` none of it is to be trusted.
    fn sort_out(&self, faces: &[u32], cuts: Vec<Cuts>, full: bool, out: &mut Surface) {
        let normal = |f: u32| self.normals[f as usize];
        let places = |(&f, cuts): (&u32, &Cuts)| cuts.middles().map(|p| (p, normal(f))).collect();
        let places: Vec<Vec<(DVec3, DVec3)>> = faces.par_iter().zip(&cuts).map(places).collect();
        let places = places.concat();
        let known = |at: &[(DVec3, DVec3)]| (self.classes(at), at.len());
        let classes: Vec<_> = places.par_chunks(GROUP).map(known).collect();
        let mut classes = classes.into_iter().flat_map(|(classes, n)| classes.into_iter().take(n));
        let pieces: Vec<Vec<Piece>> = cuts.into_iter().map(|c| c.pieces(&mut classes)).collect();
        let all: Vec<&Piece> = pieces.iter().flatten().collect();
        let trust = |some: &[&Piece]| self.trust(some, full);
        let trust: Vec<Trust> = all.par_chunks(Winding::LANES).flat_map_iter(trust).collect();
        let mut trust = trust.into_iter();
        for (&f, face) in faces.iter().zip(&pieces) {
            out.buried_faces += usize::from(face.iter().any(|p| p.class == Class::Buried));
            let t = &self.triangles[f as usize];
            let empty = face.iter().filter(|p| p.class == Class::Nothing);
            let empty: f64 = empty.map(|p| area(&p.corners)).sum();
            if empty > 0.5 * area(t) && height(t) > SHEET * self.scale.slack {
                out.sheets.push(*t);
            }
            for (p, trust) in face.iter().zip(&mut trust) {
                out.add(&p.corners, p.class, trust);
            }
        }
    }

    /// Near the line where faces meet, a piece's side does not tell; of up to eight pieces.
    fn trust(&self, pieces: &[&Piece], full: bool) -> Vec<Trust> {
        let ball = |p: &&Piece| {
            let centre = p.corners.iter().sum::<DVec3>() / p.corners.len() as f64;
            (centre, p.corners.iter().fold(0.0, |r: f64, c| r.max(c.distance(centre))))
        };
        let balls: Vec<_> = pieces.iter().map(ball).collect();
        let sharp = if full { 0 } else { self.inside.which_sharp(&balls) };
        let trust = |(i, p): (usize, &&Piece)| match sharp >> i & 1 {
            1 if !p.doubtful => Trust::Within(2.0 * self.scale.slack),
            _ => Trust::Never,
        };
        pieces.iter().enumerate().map(trust).collect()
    }
}

/// Classes by what is inside: a point in front of each face and one behind, a bit for each.
fn classes_of(inside: u8) -> [Class; GROUP] {
    std::array::from_fn(|i| match inside >> (2 * i) & 3 {
        0b10 => Class::Surface,
        0b01 => Class::Reversed,
        0b11 => Class::Buried,
        _ => Class::Nothing,
    })
}
