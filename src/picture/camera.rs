//! Where the camera stands, and which pixel a point falls on.

use super::lanes::Vec8;
use super::scene::Scene;
use fearless_simd::{Simd, f32x8, prelude::*};
use glam::{Vec2, Vec3};
use std::str::FromStr;

/// Where the camera stands. Z is up and the front looks to -Y.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum View {
    /// From the front right and above, through a long lens.
    #[default]
    Iso,
    /// From -Y towards +Y, without perspective.
    Front,
    /// From +X towards -X, without perspective.
    Side,
    /// From above, without perspective; the front is at the bottom.
    Top,
}

impl View {
    /// All views, with their names.
    pub const ALL: [(&'static str, View); 4] =
        [("iso", View::Iso), ("front", View::Front), ("side", View::Side), ("top", View::Top)];

    /// Unit vectors to the right, up in the picture, and towards the camera.
    fn axes(self) -> [Vec3; 3] {
        match self {
            View::Iso => {
                let (sin, cos) = ISO_TURN.to_radians().sin_cos();
                let (rise, run) = ISO_RISE.to_radians().sin_cos();
                let toward = Vec3::new(sin * run, -cos * run, rise);
                let right = Vec3::new(cos, sin, 0.0);
                [right, toward.cross(right), toward]
            }
            View::Front => [Vec3::X, Vec3::Z, Vec3::NEG_Y],
            View::Side => [Vec3::Y, Vec3::Z, Vec3::X],
            View::Top => [Vec3::X, Vec3::Y, Vec3::Z],
        }
    }
}

impl FromStr for View {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let names = Self::ALL.map(|(name, _)| name).join(", ");
        let found = Self::ALL.into_iter().find(|(known, _)| *known == name);
        found.map(|(_, view)| view).ok_or_else(|| format!("no view `{name}`; there are {names}"))
    }
}

/// Degrees to the right of the front.
const ISO_TURN: f32 = 33.0;
/// Degrees above the floor.
const ISO_RISE: f32 = 20.0;
/// Distance of the eye from the centre, in half diagonals of the frame: a lens of about 100 mm.
const ISO_EYE: f32 = 5.5;
/// Share of the picture left free on each side.
const MARGIN: f32 = 0.08;

/// A point as the picture sees it.
#[derive(Clone, Copy)]
pub(super) struct Seen {
    /// Pixels from the left and the top.
    pub at: Vec2,
    /// Larger is nearer; linear over a triangle in the picture.
    pub near: f32,
}

pub(super) struct Camera {
    pub right: Vec3,
    pub up: Vec3,
    pub toward: Vec3,
    /// Distance of the eye from the origin; none without perspective.
    eye: Option<f32>,
    /// Pixels a unit, at the origin's depth.
    pub zoom: f32,
    /// What stands in the middle of the picture, at the origin's depth.
    middle: Vec2,
    half: Vec2,
}

impl Camera {
    pub fn new(view: View, size: [u32; 2], scene: &Scene) -> Self {
        let [right, up, toward] = view.axes();
        let eye = (view == View::Iso).then_some(ISO_EYE);
        let half = Vec2::from(size.map(|n| n as f32)) * 0.5;
        let mut camera = Self { right, up, toward, eye, zoom: 1.0, middle: Vec2::ZERO, half };
        let used = scene.faces.iter().flatten().map(|&v| scene.points[v as usize]);
        let (low, high) = match &scene.frame {
            Some(frame) => camera.extent(frame.iter().copied()),
            None => camera.extent(used),
        };
        let room = half * 2.0 * (1.0 - 2.0 * MARGIN);
        camera.middle = (low + high) * 0.5;
        camera.zoom = (room / (high - low).max(Vec2::splat(1e-6))).min_element();
        camera
    }

    /// Corners of the rectangle that holds some points, on the plane through the origin.
    fn extent(&self, points: impl Iterator<Item = Vec3>) -> (Vec2, Vec2) {
        let start = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        points
            .filter_map(|p| self.flatten(p))
            .fold(start, |(low, high), (xy, _)| (low.min(xy), high.max(xy)))
    }

    /// Onto the plane through the origin, with nearness; `None` behind or at the eye.
    fn flatten(&self, p: Vec3) -> Option<(Vec2, f32)> {
        let (xy, z) = (Vec2::new(p.dot(self.right), p.dot(self.up)), p.dot(self.toward));
        match self.eye {
            None => Some((xy, z)),
            Some(eye) if z < eye * 0.99 => Some((xy * (eye / (eye - z)), 1.0 / (eye - z))),
            Some(_) => None,
        }
    }

    /// Where a point falls; `None` behind or at the eye.
    pub fn see(&self, p: Vec3) -> Option<Seen> {
        let (xy, near) = self.flatten(p)?;
        let from_middle = (xy - self.middle) * self.zoom;
        Some(Seen { at: self.half + Vec2::new(from_middle.x, -from_middle.y), near })
    }

    /// What a step towards the eye, small and near the origin, adds to nearness.
    pub fn nearness(&self, step: f32) -> f32 {
        self.eye.map_or(step, |eye| step / (eye * eye))
    }

    /// What to find points by that fall somewhere.
    pub fn eye(&self) -> Eye {
        Eye { toward: self.toward, far: self.eye }
    }

    /// What stands on the plane through the origin, upright to the line of sight, in a column of the
    /// picture: with [`Camera::along`], where a pixel looks.
    pub fn across(&self, x: f32) -> Vec3 {
        self.right * ((x - self.half.x) / self.zoom + self.middle.x)
    }

    /// The same for a row.
    pub fn along(&self, y: f32) -> Vec3 {
        self.up * ((self.half.y - y) / self.zoom + self.middle.y)
    }

    /// The line of sight through a place in the picture: where it starts, and its direction,
    /// one unit long along the camera's axis.
    pub fn ray(&self, at: Vec2) -> (Vec3, Vec3) {
        let on_plane = self.across(at.x) + self.along(at.y);
        match self.eye {
            None => (on_plane, -self.toward),
            Some(eye) => (self.toward * eye, (on_plane - self.toward * eye) / eye),
        }
    }

    /// Unit vector from a point to the eye.
    pub fn sight(&self, p: Vec3) -> Vec3 {
        self.eye.map_or(self.toward, |eye| (self.toward * eye - p).normalize_or(self.toward))
    }
}

/// Where the camera stands: finds points again by what is seen of them, eight at a time.
pub(super) struct Eye {
    toward: Vec3,
    /// Distance from the origin; none without perspective.
    far: Option<f32>,
}

impl Eye {
    /// The points behind or before some on the plane through the origin, that near.
    #[inline(always)]
    pub fn unsee<S: Simd>(&self, plane: Vec8<S>, near: f32x8<S>) -> Vec8<S> {
        let s = near.token();
        let Some(far) = self.far else {
            return plane.plus(Vec8::splat(s, self.toward).times(near));
        };
        // The direction advances one unit of depth a unit.
        let eye = Vec8::splat(s, self.toward * far);
        eye.plus(plane.less(eye).over(f32x8::splat(s, far)).over(near))
    }

    /// Unit vectors from points to the eye.
    #[inline(always)]
    pub fn sight<S: Simd>(&self, points: Vec8<S>) -> Vec8<S> {
        let toward = Vec8::splat(points.x.token(), self.toward);
        let Some(far) = self.far else {
            return toward;
        };
        Vec8::splat(points.x.token(), self.toward * far).less(points).unit_or(toward)
    }
}
