//! What the samples of a band see, gathered into patches: pieces of surface to be lit as one.

use super::camera::{Camera, Eye};
use super::depth_map::Spot;
use super::lanes::{Eight, Eight3, LANES, Vec8, put, take};
use super::raster::{Band, NONE, Plane, Raster, SAMPLES, SIDE};
use super::scene::Scene;
use fearless_simd::{Level, Simd, dispatch, f32x8, prelude::*};
use glam::Vec3;

/// Samples of one pixel whose normals differ less than this (cosine) are lit together.
const ALIKE: f32 = 0.95;
/// Faces that are kept ready: those that two rows of pixels see, for the most part.
const KEPT: usize = 1024;

/// The samples of one pixel that lie on one piece of surface.
#[derive(Clone, Copy)]
pub(super) struct Patch {
    /// Which of the band's pixels.
    pub pixel: usize,
    /// How many samples.
    pub count: f32,
    /// Sum of their places.
    at: Vec3,
    /// Normal of the first.
    first: Vec3,
    /// Sum of their normals.
    normal: Vec3,
    /// Whether they see its back.
    pub behind: bool,
}

impl Patch {
    fn add(&mut self, at: Vec3, normal: Vec3) {
        self.at += at;
        self.normal += normal;
        self.count += 1.0;
    }

    pub fn spot(&self) -> Spot {
        Spot { at: self.at / self.count, normal: self.normal.normalize_or(self.first) }
    }
}

/// A face made ready for its samples.
#[derive(Clone, Copy)]
struct Face {
    index: u32,
    plane: Plane,
    flat: Vec3,
    corners: [Vec3; 3],
}

/// Samples to be told about, eight at a time.
struct Asked {
    count: usize,
    pixel: [usize; LANES],
    /// Where they lie on the camera's plane, and their nearness.
    plane: Eight3,
    near: Eight,
    /// The normal of the face, and the one between its corners', of any length.
    flat: Eight3,
    smooth: Eight3,
}

/// Goes through the samples of a band.
pub(super) struct Gatherer<'a> {
    scene: &'a Scene,
    raster: &'a Raster<'a>,
    band: &'a Band,
    eye: Eye,
    level: Level,
    /// What columns and rows of samples add to their places on the camera's plane.
    columns: Vec<Vec3>,
    rows: Vec<Vec3>,
    faces: Vec<Face>,
    asked: Asked,
    patches: Vec<Patch>,
    /// The first patch of the pixel of the last one.
    first: usize,
}

impl<'a> Gatherer<'a> {
    pub fn new(scene: &'a Scene, camera: &Camera, raster: &'a Raster, band: &'a Band) -> Self {
        let centre = |i: usize| (i as f32 + 0.5) / SIDE;
        let height = band.face.len() / band.width;
        let none = [[0.0; LANES]; 3];
        let face = Face {
            index: NONE,
            plane: Plane::default(),
            flat: Vec3::ZERO,
            corners: [Vec3::ZERO; 3],
        };
        Self {
            scene,
            raster,
            band,
            eye: camera.eye(),
            level: Level::new(),
            columns: (0..band.width).map(|x| camera.across(centre(x))).collect(),
            rows: (0..height).map(|y| camera.along(centre(band.top + y))).collect(),
            faces: vec![face; KEPT],
            asked: Asked {
                count: 0,
                pixel: [0; LANES],
                plane: none,
                near: [1.0; LANES],
                flat: none,
                smooth: none,
            },
            patches: Vec::new(),
            first: 0,
        }
    }

    /// Collects what the samples of a pixel see, column and row counted within the band; the number
    /// of samples that see nothing. Pixels come one after another.
    pub fn pixel(&mut self, x: usize, y: usize, pixel: usize) -> usize {
        let mut misses = 0;
        for sy in y * SAMPLES..(y + 1) * SAMPLES {
            for sx in x * SAMPLES..(x + 1) * SAMPLES {
                let at = sy * self.band.width + sx;
                match self.band.face[at] {
                    NONE => misses += 1,
                    face => self.ask(face, [sx, sy], self.band.near[at], pixel),
                }
            }
        }
        misses
    }

    /// All that was collected.
    pub fn finish(mut self) -> Vec<Patch> {
        self.answer();
        self.patches
    }

    fn ask(&mut self, index: u32, [x, y]: [usize; 2], near: f32, pixel: usize) {
        let slot = index as usize % KEPT;
        if self.faces[slot].index != index {
            let normals = &self.scene.normals;
            self.faces[slot] = Face {
                index,
                plane: self.raster.plane(index),
                flat: normals.flat(index as usize),
                corners: normals.smooth(index as usize),
            };
        }
        let face = &self.faces[slot];
        let [a, b, c] = face.corners;
        let shares = face.plane.shares(x, self.band.top + y);
        let asked = &mut self.asked;
        let lane = asked.count;
        asked.pixel[lane] = pixel;
        asked.near[lane] = near;
        put(&mut asked.plane, lane, self.columns[x] + self.rows[y]);
        put(&mut asked.flat, lane, face.flat);
        put(&mut asked.smooth, lane, a * shares[0] + b * shares[1] + c * shares[2]);
        asked.count += 1;
        if asked.count == LANES {
            self.answer();
        }
    }

    fn answer(&mut self) {
        let (at, normal, behind) = dispatch!(self.level, s => self.asked.facing(s, &self.eye));
        for lane in 0..std::mem::take(&mut self.asked.count) {
            let (pixel, behind) = (self.asked.pixel[lane], behind >> lane & 1 == 1);
            self.add(pixel, take(&at, lane), take(&normal, lane), behind);
        }
    }

    fn add(&mut self, pixel: usize, at: Vec3, normal: Vec3, behind: bool) {
        if self.patches.last().is_none_or(|p| p.pixel != pixel) {
            self.first = self.patches.len();
        }
        let alike = |p: &&mut Patch| p.behind == behind && p.first.dot(normal) > ALIKE;
        match self.patches[self.first..].iter_mut().find(alike) {
            Some(patch) => patch.add(at, normal),
            None => {
                let (first, count) = (normal, 1.0);
                self.patches.push(Patch { pixel, count, at, first, normal, behind });
            }
        }
    }
}

impl Asked {
    /// Places, normals on the side that is seen, and a bit for each that sees a back.
    #[inline(always)]
    fn facing<S: Simd>(&self, s: S, eye: &Eye) -> (Eight3, Eight3, u64) {
        let zero = f32x8::splat(s, 0.0);
        let at = eye.unsee(Vec8::load(s, &self.plane), f32x8::simd_from(s, self.near));
        let sight = eye.sight(at);
        let flat = Vec8::load(s, &self.flat);
        let behind = flat.dot(sight).simd_lt(zero);
        let smooth = Vec8::load(s, &self.smooth).unit_or(flat);
        let normal = smooth.times(behind.select(f32x8::splat(s, -1.0), f32x8::splat(s, 1.0)));
        // Bent back where it looks away: what is seen faces the eye.
        let away = normal.dot(sight).min(zero);
        let normal = normal.less(sight.times(away)).unit_or(sight);
        (at.store(), normal.store(), behind.to_bitmask())
    }
}
