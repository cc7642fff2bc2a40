//! What one direction of light reaches first.

use super::caster::Caster;
use super::lanes::{Eight3, LANES, Vec8, put};
use fearless_simd::{Level, Simd, dispatch, f32x4, f32x8, i32x4, i32x8, mask32x8, prelude::*};
use glam::{Vec2, Vec3};
use std::ops::Range;

/// Share by which a triangle is taken larger, so that rounding leaves no gap between two.
const SLACK: f32 = 1e-4;
/// How far a point is lifted off its surface before it is looked up, in texels. Less, and slanted
/// surfaces shade themselves in stripes; more, and light leaks into corners.
const LIFT: f32 = 1.3;

/// A place to light.
#[derive(Clone, Copy)]
pub(super) struct Spot {
    pub at: Vec3,
    /// Unit normal on the side that is seen.
    pub normal: Vec3,
}

/// Eight places in memory; the last one fills the lanes left over.
pub(super) struct Packet {
    at: Eight3,
    normal: Eight3,
}

impl Packet {
    /// Of at least one.
    pub fn of(spots: &[Spot]) -> Self {
        let mut packet = Self { at: [[0.0; LANES]; 3], normal: [[0.0; LANES]; 3] };
        for lane in 0..LANES {
            let Spot { at, normal } = spots[lane.min(spots.len() - 1)];
            put(&mut packet.at, lane, at);
            put(&mut packet.normal, lane, normal);
        }
        packet
    }

    #[inline(always)]
    pub fn load<S: Simd>(&self, s: S) -> Spots<S> {
        Spots { at: Vec8::load(s, &self.at), normal: Vec8::load(s, &self.normal) }
    }
}

/// Eight places to light.
pub(super) struct Spots<S: Simd> {
    pub at: Vec8<S>,
    pub normal: Vec8<S>,
}

/// How near to the light the first surface lies, on a grid across the light's direction.
pub(super) struct DepthMap {
    /// Unit vector to the light.
    pub toward: Vec3,
    /// Columns and rows of the grid, in texels a unit.
    across: Vec3,
    along: Vec3,
    /// The origin's place in the grid.
    origin: Vec2,
    /// How far off its surface a spot is looked up.
    lift: f32,
    width: usize,
    height: usize,
    /// Column by column, then one that is drawn into but not looked at.
    depth: Vec<f32>,
}

/// Faces looked at before some are drawn.
const AT_ONCE: usize = 128;
/// Texels of a column that are drawn at once, in two columns.
const STRIP: usize = 4;

impl DepthMap {
    pub fn new(caster: &Caster, toward: Vec3) -> Self {
        let (across, along) = toward.any_orthonormal_pair();
        let flat = |p: Vec3| Vec2::new(p.dot(across), p.dot(along));
        let corners = caster.corners.map(flat);
        let low = corners.into_iter().fold(Vec2::INFINITY, Vec2::min);
        let size = corners.into_iter().fold(Vec2::NEG_INFINITY, Vec2::max) - low;
        let scale = caster.texels / size.max_element().max(1e-6);
        // A free texel all round, so that lookups need no care at the border.
        let [width, height] = (size * scale).to_array().map(|n| n as usize + 3);
        let (across, along, origin) = (across * scale, along * scale, 1.0 - low * scale);
        let lift = LIFT / scale;
        let depth = vec![f32::NEG_INFINITY; (width + 1) * height + STRIP];
        let mut map = Self { toward, across, along, origin, lift, width, height, depth };
        dispatch!(Level::new(), s => map.draw_all(s, caster));
        map
    }

    #[inline(always)]
    fn draw_all<S: Simd>(&mut self, s: S, caster: &Caster) {
        let points = self.places(s, &caster.points);
        let toward = self.toward;
        let mut boxes = [([0; 3], [0; 4]); AT_ONCE];
        for group in caster.groups.iter().filter(|g| !g.looks_away(toward)) {
            for faces in caster.faces[group.faces.clone()].chunks(AT_ONCE) {
                // In two steps, and the first without a choice: they follow no rule.
                let mut count = 0;
                for face in faces {
                    let [a, b, c] = *face;
                    let corners = [&points[a as usize], &points[b as usize], &points[c as usize]];
                    let (low, high, front) = span(s, corners);
                    let some = (low[0] < high[0]) & (low[1] < high[1]);
                    boxes[count] = (*face, [low[0], high[0], low[1], high[1]]);
                    count += usize::from(some & (front | !caster.closed));
                }
                for (face, [left, right, top, bottom]) in &boxes[..count] {
                    let right = (*right as usize).min(self.width);
                    let bottom = (*bottom as usize).min(self.height);
                    let corner = |v: u32| {
                        let [x, y, z, _] = points[v as usize];
                        Vec3::new(x, y, z)
                    };
                    let corners = [corner(face[0]), corner(face[1]), corner(face[2])];
                    self.fill(s, corners, *left as usize..right, *top as usize..bottom);
                }
            }
        }
    }

    /// Where points fall, texels, and how near to the light.
    #[inline(always)]
    fn places<S: Simd>(&self, s: S, points: &[Vec3]) -> Vec<[f32; 4]> {
        let (a, b, c) = (self.across, self.along, self.toward);
        let x = f32x4::simd_from(s, [a.x, b.x, c.x, 0.0]);
        let y = f32x4::simd_from(s, [a.y, b.y, c.y, 0.0]);
        let z = f32x4::simd_from(s, [a.z, b.z, c.z, 0.0]);
        let origin = f32x4::simd_from(s, [self.origin.x, self.origin.y, 0.0, 0.0]);
        let mut places = vec![[0.0; 4]; points.len()];
        for (p, place) in points.iter().zip(&mut places) {
            let across = x * f32x4::splat(s, p.x) + y * f32x4::splat(s, p.y);
            *place = (across + z * f32x4::splat(s, p.z) + origin).into();
        }
        places
    }

    #[inline(always)]
    fn fill<S: Simd>(
        &mut self,
        s: S,
        [a, b, c]: [Vec3; 3],
        columns: Range<usize>,
        rows: Range<usize>,
    ) {
        let area = (b - a).truncate().perp_dot((c - a).truncate());
        if area == 0.0 {
            return;
        }
        // Share of a corner at the first centre, and its steps to the right and down; the third
        // is what is left.
        let part = 1.0 / area;
        let centre = Vec2::new(columns.start as f32 + 0.5, rows.start as f32 + 0.5);
        let share = |p: Vec3, q: Vec3| {
            let (side, to) = ((q - p).truncate(), centre - p.truncate());
            Vec3::new(side.perp_dot(to), -side.y, side.x) * part
        };
        let (u, v) = (share(b, c), share(c, a));
        let depth = u * (a.z - c.z) + v * (b.z - c.z);
        let depth = depth.with_x(c.z + depth.x);
        let splat = |v: f32| f32x8::splat(s, v);
        // Lanes are four rows of a column, then those of the next.
        let row = f32x8::simd_from(s, [0.0, 1.0, 2.0, 3.0, 0.0, 1.0, 2.0, 3.0]);
        let column = f32x8::simd_from(s, [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]);
        for i in (0..rows.len()).step_by(STRIP) {
            let down = row + splat(i as f32);
            let has_row = down.simd_lt(splat(rows.len() as f32));
            let (mut us, mut vs) = (start(s, u, down), start(s, v, down));
            let mut zs = start(s, depth, down);
            for x in columns.clone().step_by(2) {
                let has_column = column.simd_lt(splat((columns.end - x) as f32));
                let within = us.simd_ge(splat(-SLACK))
                    & vs.simd_ge(splat(-SLACK))
                    & (us + vs).simd_le(splat(1.0 + SLACK));
                let z = (within & has_row & has_column).select(zs, splat(f32::NEG_INFINITY));
                let (left, right) = z.split();
                let at = x * self.height + rows.start + i;
                raise(s, left, &mut self.depth[at..at + STRIP]);
                raise(s, right, &mut self.depth[at + self.height..at + self.height + STRIP]);
                (us, vs, zs) = (next(us, u.y), next(vs, v.y), next(zs, depth.y));
            }
        }
    }

    /// The share of each spot that the light reaches, smooth between texels, and how much nearer to
    /// the light the texels round it are: those that stand in its way are more than 0. Only where
    /// `asked`; elsewhere, and off the map, all of it, and nothing.
    #[inline(always)]
    pub fn open<S: Simd>(&self, s: S, spots: &Spots<S>, asked: mask32x8<S>) -> Open<S> {
        let splat = |v: f32| f32x8::splat(s, v);
        let lift = spots.normal.plus(Vec8::splat(s, self.toward * 0.5)).times(splat(self.lift));
        let at = spots.at.plus(lift);
        let x = at.dot(Vec8::splat(s, self.across)) + splat(self.origin.x) - splat(0.5);
        let y = at.dot(Vec8::splat(s, self.along)) + splat(self.origin.y) - splat(0.5);
        let inside = asked
            & x.simd_ge(splat(0.0))
            & y.simd_ge(splat(0.0))
            & x.simd_lt(splat((self.width - 1) as f32))
            & y.simd_lt(splat((self.height - 1) as f32));
        if !inside.any_true() {
            return Open { share: splat(1.0), gaps: None };
        }
        let (left, top) =
            (inside.select(x, splat(0.0)).trunc(), inside.select(y, splat(0.0)).trunc());
        let first: [i32; LANES] =
            (left * splat(self.height as f32) + top).to_int::<i32x8<S>>().into();
        let near = at.dot(Vec8::splat(s, self.toward));
        let mut texels = [[[0.0; 2]; LANES]; 2];
        for lane in 0..LANES {
            let first = first[lane] as usize;
            let square = &self.depth[first..first + self.height + 2];
            texels[0][lane] = [square[0], square[1]];
            texels[1][lane] = [square[self.height], square[self.height + 1]];
        }
        let ((a, c), (b, d)) = (columns(s, &texels[0]), columns(s, &texels[1]));
        let gaps = [a - near, b - near, c - near, d - near];
        let (right, down) = (x - left, y - top);
        let upper = between(free(gaps[0]), free(gaps[1]), right);
        let lower = between(free(gaps[2]), free(gaps[3]), right);
        let share = inside.select(between(upper, lower, down), splat(1.0));
        Open { share, gaps: Some((inside, gaps)) }
    }
}

/// The texels that a triangle may cover, in columns and rows, the first and the first beyond; and
/// whether the light sees its front.
#[inline(always)]
fn span<S: Simd>(s: S, [a, b, c]: [&[f32; 4]; 3]) -> ([i32; 4], [i32; 4], bool) {
    let front = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0;
    let (a, b, c) = (f32x4::simd_from(s, *a), f32x4::simd_from(s, *b), f32x4::simd_from(s, *c));
    (texel(s, a.min(b).min(c)), texel(s, a.max(b).max(c)), front)
}

/// The first texel whose centre is not before a place; no less than 0.
#[inline(always)]
fn texel<S: Simd>(s: S, place: f32x4<S>) -> [i32; 4] {
    // Texels count from 0, so that cutting off the fraction is rounding down.
    let place = (place + f32x4::splat(s, 0.5)).max(f32x4::splat(s, 0.0));
    place.to_int::<i32x4<S>>().into()
}

/// What starts at x and rises by y a column and by z a row, in some rows of two columns.
#[inline(always)]
fn start<S: Simd>(s: S, v: Vec3, down: f32x8<S>) -> f32x8<S> {
    let (left, _) = (f32x8::splat(s, v.x) + f32x8::splat(s, v.z) * down).split();
    left.combine(left + f32x4::splat(s, v.y))
}

/// The same two columns on.
#[inline(always)]
fn next<S: Simd>(now: f32x8<S>, step: f32) -> f32x8<S> {
    let (_, before) = now.split();
    let step = f32x4::splat(before.token(), step);
    let left = before + step;
    left.combine(left + step)
}

/// Raises a strip of texels to what is nearer.
#[inline(always)]
fn raise<S: Simd>(s: S, near: f32x4<S>, strip: &mut [f32]) {
    near.max(f32x4::from_slice(s, strip)).store_slice(strip);
}

/// The upper ones and the lower ones of pairs.
#[inline(always)]
fn columns<S: Simd>(s: S, pairs: &[[f32; 2]; LANES]) -> (f32x8<S>, f32x8<S>) {
    let (a, b) = pairs.as_flattened().split_at(LANES);
    let (a, b) = (f32x8::from_slice(s, a), f32x8::from_slice(s, b));
    (a.unzip_low(b), a.unzip_high(b))
}

/// Whether a texel lets light through: 1, or 0.
#[inline(always)]
fn free<S: Simd>(gap: f32x8<S>) -> f32x8<S> {
    let number = |v| f32x8::splat(gap.token(), v);
    gap.simd_gt(number(0.0)).select(number(0.0), number(1.0))
}

#[inline(always)]
fn between<S: Simd>(a: f32x8<S>, b: f32x8<S>, part: f32x8<S>) -> f32x8<S> {
    a + (b - a) * part
}

/// What [`DepthMap::open`] tells.
pub(super) struct Open<S: Simd> {
    /// The share of the light that arrives.
    pub share: f32x8<S>,
    gaps: Option<(mask32x8<S>, [f32x8<S>; 4])>,
}

impl<S: Simd> Open<S> {
    /// The distance to what stands nearest in the light's way, or a smaller one.
    #[inline(always)]
    pub fn nearest(&self, other: f32x8<S>) -> f32x8<S> {
        let Some((inside, gaps)) = self.gaps else {
            return other;
        };
        let mut least = other;
        for gap in gaps {
            let in_way = inside & gap.simd_gt(f32x8::splat(gap.token(), 0.0));
            least = in_way.select(least.min(gap), least);
        }
        least
    }
}

#[cfg(test)]
mod tests {
    use super::super::caster::{Group, tests::hook};
    use super::super::scene::Scene;
    use super::*;

    #[test]
    fn of_a_closed_mesh_the_fronts_alone_are_as_near_as_all() {
        let scene = Scene::new(&hook(), None).unwrap();
        let caster = Caster::of(&scene, 400.0);
        assert!(caster.closed);
        let mut all = Caster::of(&scene, 400.0);
        all.closed = false;
        all.groups = vec![Group::any(0..all.faces.len())];
        for toward in [Vec3::Z, Vec3::new(0.6, 0.7, 0.4), Vec3::new(-0.3, -0.8, -0.5)] {
            let maps = [&caster, &all].map(|c| DepthMap::new(c, toward.normalize()).depth);
            let far = maps[0].iter().zip(&maps[1]).filter(|(a, b)| *a < *b && *b - *a > 1e-4);
            // on outlines a face seen edge on may reach half a texel farther
            assert!(far.count() * 200 < maps[0].len(), "{toward}");
        }
    }
}
