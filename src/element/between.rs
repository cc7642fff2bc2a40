use super::Element;
use crate::num::Aabb;
use crate::num::lanes::{LANES, Vec8};
use crate::warp::{Ball, Barr};
use fearless_simd::Simd;
use glam::{DAffine3, DMat3, DVec3};

/// The map from one element onto another through their normal coordinates:
/// `pull(p) = to.to_world(from.to_local(p))`.
///
/// Without twist, taper and bend it is one affine map; an element onto its equal is the identity, to
/// the last bit.
#[derive(Clone, Debug)]
pub struct Between {
    /// Where points come from.
    pub from: Element,
    /// Where they go.
    pub to: Element,
    road: Road,
}

#[derive(Clone, Debug)]
enum Road {
    Same,
    Affine { map: DAffine3, stretch: f64 },
    Deformed(Box<Steps>),
}

/// World to the axes of `from`, straighten, scale, deform, to the world from the axes of `to`.
#[derive(Clone, Copy, Debug)]
struct Steps {
    into: DAffine3,
    straighten: Option<Barr>,
    scale: DVec3,
    deform: Option<Barr>,
    out: DAffine3,
}

impl Between {
    /// The map that takes `from` onto `to`.
    pub fn new(from: Element, to: Element) -> Self {
        let road = road(&from, &to);
        Self { from, to, road }
    }

    /// The point of `to` that corresponds to a point of `from`.
    pub fn pull(&self, p: DVec3) -> DVec3 {
        match &self.road {
            Road::Same => p,
            Road::Affine { map, .. } => map.transform_point3(p),
            Road::Deformed(s) => {
                let v = s.into.transform_point3(p);
                let v = s.straighten.map_or(v, |b| b.pull(v)) * s.scale;
                s.out.transform_point3(s.deform.map_or(v, |b| b.push(v)))
            }
        }
    }

    /// [`Between::pull`] of eight points, to the bit.
    #[inline(always)]
    pub(crate) fn pulled<S: Simd>(&self, s: S, p: Vec8<S>) -> Vec8<S> {
        match &self.road {
            Road::Same => p,
            Road::Affine { map, .. } => p.mapped(map),
            Road::Deformed(_) => {
                let mut at = [DVec3::ZERO; LANES];
                for (at, p) in at.iter_mut().zip(p.lanes()) {
                    *at = self.pull(p);
                }
                Vec8::of(s, &at)
            }
        }
    }

    /// No less than the 2-norm of the Jacobian of `pull` anywhere in the box; infinite where the
    /// box reaches the far side of a bend axis and `pull` jumps.
    pub fn stretch(&self, b: &Aabb) -> f64 {
        match &self.road {
            Road::Same => 1.0,
            Road::Affine { stretch, .. } => *stretch,
            Road::Deformed(s) => s.ball(b).stretch * (1.0 + 1e-12),
        }
    }

    /// A box that holds `pull` of every point of the box.
    pub fn image(&self, b: &Aabb) -> Aabb {
        match &self.road {
            Road::Same => *b,
            Road::Affine { map, .. } => affine_image(map, b),
            Road::Deformed(s) => {
                let ball = s.ball(b);
                let half = DVec3::splat(ball.radius);
                Aabb::around(ball.centre, half).grow(slack(ball.centre, half))
            }
        }
    }

    /// A box that holds `self.pull(p) - other.pull(p)` for every point of the box: far smaller than
    /// the two images where the maps are nearly parallel.
    pub fn difference(&self, other: &Between, b: &Aabb) -> Aabb {
        if let (Some(f), Some(g)) = (self.road.affine(), other.road.affine()) {
            let map = DAffine3 {
                matrix3: f.matrix3 - g.matrix3,
                translation: f.translation - g.translation,
            };
            // what cancels had the size of the points themselves
            let size = self.image(b).centre().abs() + other.image(b).centre().abs();
            return affine_image(&map, b)
                .grow(slack(size, f.translation.abs() + g.translation.abs()));
        }
        let (f, g) = (self.image(b), other.image(b));
        Aabb::new(f.min - g.max, f.max - g.min)
    }
}

impl Between {
    /// The whole map, where it is affine.
    pub(crate) fn affine(&self) -> Option<DAffine3> {
        self.road.affine()
    }
}

impl Road {
    fn affine(&self) -> Option<DAffine3> {
        match self {
            Self::Same => Some(DAffine3::IDENTITY),
            Self::Affine { map, .. } => Some(*map),
            Self::Deformed(_) => None,
        }
    }
}

/// A box round the image of a box under an affine map.
fn affine_image(map: &DAffine3, b: &Aabb) -> Aabb {
    let centre = map.transform_point3(b.centre());
    let half = map.matrix3.abs() * (b.size() * 0.5);
    Aabb::around(centre, half).grow(slack(centre, half))
}

/// Covers the round-off of a map's few operations.
fn slack(centre: DVec3, half: DVec3) -> f64 {
    1e-12 * (centre.abs().max_element() + half.max_element() + 1.0)
}

fn road(from: &Element, to: &Element) -> Road {
    let frame = |e: &Element| (e.centre, e.rotation, e.half, e.deform);
    if frame(from) == frame(to) {
        return Road::Same;
    }
    let (straighten, deform) = (from.barr(), to.barr());
    let scale = to.half / from.half;
    let into = DMat3::from_quat(from.rotation).transpose();
    let out = DMat3::from_quat(to.rotation);
    if straighten.is_none() && deform.is_none() {
        let matrix3 = out * DMat3::from_diagonal(scale) * into;
        let map = DAffine3 { matrix3, translation: to.centre - matrix3 * from.centre };
        return Road::Affine { map, stretch: scale.max_element() * (1.0 + 1e-12) };
    }
    Road::Deformed(Box::new(Steps {
        into: DAffine3 { matrix3: into, translation: -(into * from.centre) },
        straighten,
        scale,
        deform,
        out: DAffine3 { matrix3: out, translation: to.centre },
    }))
}

impl Steps {
    /// The image of the ball round a box.
    fn ball(&self, b: &Aabb) -> Ball {
        let ball = Ball::new(b.centre(), b.radius());
        let ball = ball.through(self.into.transform_point3(ball.centre), 1.0);
        let ball = self.straighten.map_or(ball, |s| s.pull_ball(ball));
        let ball = ball.through(ball.centre * self.scale, self.scale.max_element());
        let ball = self.deform.map_or(ball, |d| d.push_ball(ball));
        ball.through(self.out.transform_point3(ball.centre), 1.0)
    }
}
