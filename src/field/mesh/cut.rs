//! A face cut along the faces that touch it, until each piece is surface, or is not.

use crate::bvh::Outline;
use glam::DVec3;

/// What lies on the two sides of a piece of a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Class {
    /// Outside in front, inside behind.
    Surface,
    /// Inside in front, outside behind.
    Reversed,
    /// Inside on both sides.
    Buried,
    /// Outside on both sides.
    Nothing,
}

impl Class {
    /// Whether inside and outside change across it.
    pub(super) fn is_surface(self) -> bool {
        matches!(self, Self::Surface | Self::Reversed)
    }
}

/// Lengths that the work on contacts goes by, mm.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    /// Faces nearer than this to each other are in contact.
    pub slack: f64,
    /// How far off a face its two sides are looked at; less than `slack`.
    pub offset: f64,
    /// Pieces smaller than this are not cut any further.
    pub floor: f64,
}

/// Work spent on one face at most, and more for each face that touches it, in faces looked at;
/// asking what lies beside a piece counts as `ASK`. A leg through a seat needs some hundreds.
const WORK: usize = 4096;
const WORK_EACH: usize = 256;
const ASK: usize = 16;
/// Cuts along one branch; halving alone brings any face below any sensible floor by then.
const DEPTH: u32 = 64;
/// With more faces than this across a piece it is halved first, so that each half meets fewer.
const CROWD: usize = 12;

/// A convex piece of a face.
pub(super) struct Piece {
    pub corners: Vec<DVec3>,
    pub class: Class,
    /// Whether faces still run across it.
    pub doubtful: bool,
}

/// Points with normal . p = offset.
#[derive(Clone, Copy)]
struct Plane {
    normal: DVec3,
    offset: f64,
}

impl Plane {
    fn through(p: DVec3, normal: DVec3) -> Self {
        Self { normal, offset: normal.dot(p) }
    }

    fn height(&self, p: DVec3) -> f64 {
        self.normal.dot(p) - self.offset
    }

    fn range(&self, corners: &[DVec3]) -> (f64, f64) {
        let heights = corners.iter().map(|&p| self.height(p));
        heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), h| (lo.min(h), hi.max(h)))
    }

    /// The parts of a convex polygon in front of and behind the plane.
    fn split(&self, corners: &[DVec3]) -> [Vec<DVec3>; 2] {
        let mut parts = [vec![], vec![]];
        for (i, &p) in corners.iter().enumerate() {
            let q = corners[(i + 1) % corners.len()];
            let (h, g) = (self.height(p), self.height(q));
            if h >= 0.0 {
                parts[0].push(p);
            }
            if h <= 0.0 {
                parts[1].push(p);
            }
            if h * g < 0.0 {
                let x = p + (q - p) * (h / (h - g));
                parts.iter_mut().for_each(|part| part.push(x));
            }
        }
        parts
    }
}

/// Cuts one face.
pub(super) struct Cutter<'a> {
    /// All faces, by their corners.
    pub triangles: &'a [[DVec3; 3]],
    pub normals: &'a [DVec3],
    pub scale: Scale,
    /// The face's own normal.
    pub normal: DVec3,
    budget: usize,
    parts: Vec<Part>,
    /// Work spent so far.
    spent: usize,
}

/// A part of a face: one piece, or what the next two parts, with all that they are cut into, make up.
struct Part {
    corners: Vec<DVec3>,
    cut: bool,
    doubtful: bool,
}

/// A face cut as far as it goes. What each part is shall be told for [`Cuts::middles`], in order.
pub(super) struct Cuts {
    parts: Vec<Part>,
    /// Work spent.
    pub spent: usize,
}

impl Cuts {
    /// A point of each part that is not cut any further.
    pub(super) fn middles(&self) -> impl Iterator<Item = DVec3> {
        let whole = self.parts.iter().filter(|p| !p.cut);
        whole.map(|p| p.corners.iter().sum::<DVec3>() / p.corners.len() as f64)
    }

    /// The pieces, those of one class that were one before joined again; `classes` has one for each
    /// of the middles.
    pub(super) fn pieces(self, classes: &mut impl Iterator<Item = Class>) -> Vec<Piece> {
        let mut pieces = vec![];
        join(&mut self.parts.into_iter(), classes, &mut pieces);
        pieces
    }
}

/// Adds the pieces of the next part.
fn join(
    parts: &mut impl Iterator<Item = Part>,
    classes: &mut impl Iterator<Item = Class>,
    out: &mut Vec<Piece>,
) {
    let Some(Part { corners, cut, doubtful }) = parts.next() else {
        return;
    };
    if !cut {
        let class = classes.next().unwrap_or(Class::Nothing);
        return out.push(Piece { corners, class, doubtful });
    }
    let first = out.len();
    join(parts, classes, out);
    let second = out.len();
    join(parts, classes, out);
    if let [a, b] = &out[first..]
        && second == first + 1
        && a.class == b.class
    {
        let (class, doubtful) = (a.class, a.doubtful || b.doubtful);
        out.truncate(first);
        out.push(Piece { corners, class, doubtful });
    }
}

impl<'a> Cutter<'a> {
    pub(super) fn new(
        triangles: &'a [[DVec3; 3]],
        normals: &'a [DVec3],
        scale: Scale,
        normal: DVec3,
    ) -> Self {
        Self { triangles, normals, scale, normal, budget: 0, parts: vec![], spent: 0 }
    }

    /// Cuts face `index` along the faces that touch it.
    pub(super) fn face(mut self, index: usize, contacts: &[u32]) -> Cuts {
        self.budget = WORK + WORK_EACH * contacts.len();
        self.cut(self.triangles[index].to_vec(), contacts, true, DEPTH);
        Cuts { parts: self.parts, spent: self.spent }
    }

    /// Cuts a part along those of the contacts that touch it: the whole face is touched by all.
    fn cut(&mut self, corners: Vec<DVec3>, contacts: &[u32], whole: bool, depth: u32) {
        self.spent += contacts.len();
        let outline = Outline::new(&corners, self.scale.slack);
        let near = |some: &[u32]| if whole { some.to_vec() } else { self.near(&outline, some) };
        // a plane is had for less than it is told what is near
        let plane = |&b: &u32| Some((b, self.plane(&corners, b)?));
        let across: Vec<(u32, Plane)> = contacts.iter().filter_map(plane).collect();
        let faces: Vec<u32> = across.iter().map(|a| a.0).collect();
        let mut planes = faces.chunks(Outline::MOST).flat_map(near);
        let Some(first) = planes.next() else {
            return self.leaf(corners, false);
        };
        let (size, halving) = halving(&corners);
        if depth == 0 || self.spent > self.budget || size < self.scale.floor {
            return self.leaf(corners, true);
        }
        let first = across.iter().find(|a| a.0 == first).map_or(halving, |a| a.1);
        let crowded = across.len() > CROWD && planes.nth(CROWD - 1).is_some();
        let [front, back] = if crowded { halving } else { first }.split(&corners);
        if front.len() < 3 || back.len() < 3 {
            return self.leaf(corners, true);
        }
        let near: Vec<u32> = contacts.chunks(Outline::MOST).flat_map(near).collect();
        self.parts.push(Part { corners, cut: true, doubtful: false });
        self.cut(front, &near, false, depth - 1);
        self.cut(back, &near, false, depth - 1);
    }

    /// Those of some faces that touch a part.
    fn near(&self, outline: &Outline, some: &[u32]) -> Vec<u32> {
        let flat = |&b: &u32| (&self.triangles[b as usize], self.normals[b as usize]);
        let bits = outline.near(&some.iter().map(flat).collect::<Vec<_>>());
        let near = some.iter().enumerate().filter(|&(i, _)| bits >> i & 1 == 1);
        near.map(|(_, &b)| b).collect()
    }

    fn leaf(&mut self, corners: Vec<DVec3>, doubtful: bool) {
        self.spent += ASK;
        self.parts.push(Part { corners, cut: false, doubtful });
    }

    /// A plane along which touching face `b` may part inside from outside on the piece, if it
    /// runs across the piece: the face's own, or through a side of it when the two are coplanar.
    fn plane(&self, corners: &[DVec3], b: u32) -> Option<Plane> {
        let (t, n) = (&self.triangles[b as usize], self.normals[b as usize]);
        let own = Plane::through(t[0], n);
        let least = 0.5 * self.scale.slack;
        let across = |(lo, hi): (f64, f64)| lo < -least && hi > least;
        let range = own.range(corners);
        let (lo, hi) = range;
        if lo > -2.0 * self.scale.slack && hi < 2.0 * self.scale.slack {
            let sides = [0, 1, 2].map(|i| {
                let along = t[(i + 1) % 3] - t[i];
                Plane::through(t[i], self.normal.cross(along).normalize_or_zero())
            });
            let ranges = sides.map(|side| side.range(corners));
            // inwards of a side is in front of it, or behind where the two normals are opposed
            let facing = self.normal.dot(n);
            let out = |&(lo, hi): &(f64, f64)| {
                if facing > 0.0 { hi < least } else { lo > -least }
            };
            if ranges.iter().any(out) {
                return None;
            }
            return sides.into_iter().zip(ranges).find(|&(_, r)| across(r)).map(|(side, _)| side);
        }
        across(range).then_some(own)
    }
}

/// The longest distance from the first corner, and the plane that halves it.
fn halving(corners: &[DVec3]) -> (f64, Plane) {
    let mut best = (0.0, DVec3::ZERO, DVec3::ZERO);
    for (i, &p) in corners.iter().enumerate() {
        for &q in &corners[..i] {
            let d = p.distance_squared(q);
            if d > best.0 {
                best = (d, p, q);
            }
        }
    }
    let (d2, p, q) = best;
    (d2.sqrt(), Plane::through((p + q) * 0.5, (p - q).normalize_or_zero()))
}
