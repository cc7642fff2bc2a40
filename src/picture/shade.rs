//! From samples to pixels: colour, light, the shadow on the ground.

use super::camera::Camera;
use super::depth_map::Spot;
use super::ground::Ground;
use super::light::Lights;
use super::patch::{Gatherer, Patch};
use super::raster::{Band, Raster, SAMPLES, SIDE};
use super::scene::Scene;
use super::{Image, Style};
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Samples of a pixel in all.
const ALL: f32 = SIDE * SIDE;
/// Rows of pixels drawn in one go.
const ROWS: usize = 16;
/// How far the colour of a face seen from behind goes over to [`WARM`].
const TINT: f32 = 0.55;
/// Linear colour that faces seen from behind tend to.
const WARM: Vec3 = Vec3::new(0.75, 0.16, 0.06);
/// What a surface seen at a slant mirrors of the light: rounds off limbs against each other.
const SHEEN: f32 = 0.10;
/// Light that reaches every corner: bounces between surfaces. An open floor receives 1.
const AMBIENT: f32 = 0.05;
/// Brightness in all.
const EXPOSURE: f32 = 1.02;
/// How dark a shadow on the ground may get: 1 is black.
const SHADOW: f32 = 0.75;

pub(super) fn draw(
    image: &mut Image,
    scene: &Scene,
    camera: &Camera,
    lights: &Lights,
    style: &Style,
) {
    let (width, height) = (image.width() as usize, image.height() as usize);
    let samples = (width * SAMPLES, height * SAMPLES);
    let (raster, ground) = rayon::join(
        || Raster::new(scene, camera, samples.1, ROWS * SAMPLES),
        || Ground::new(scene, lights, width.max(height)),
    );
    let (background, own) = (linear(style.background), linear(style.color));
    let colors = [own, own.lerp(WARM, TINT)];
    let painter = Painter { scene, camera, lights, ground, raster, background, colors };
    let bands = image.pixels_mut().par_chunks_mut(width * ROWS).enumerate();
    bands.for_each(|(index, pixels)| {
        let band = painter.raster.band(index, samples.0, samples.1);
        painter.paint(&band, pixels, index * ROWS);
    });
}

struct Painter<'a> {
    scene: &'a Scene,
    camera: &'a Camera,
    lights: &'a Lights,
    ground: Ground,
    raster: Raster<'a>,
    /// Linear colour behind the mesh, and of its faces seen from their fronts and backs.
    background: Vec3,
    colors: [Vec3; 2],
}

impl Painter<'_> {
    fn paint(&self, band: &Band, pixels: &mut [[u8; 3]], top: usize) {
        let width = band.width / SAMPLES;
        let mut gatherer = Gatherer::new(self.scene, self.camera, &self.raster, band);
        let mut sums = vec![Vec3::ZERO; pixels.len()];
        for (pixel, sum) in sums.iter_mut().enumerate() {
            let (x, y) = (pixel % width, pixel / width);
            let bare = gatherer.pixel(x, y, pixel) as f32;
            if bare > 0.0 {
                *sum = self.background * (self.floor(x, top + y) * bare / ALL);
            }
        }
        let patches = gatherer.finish();
        let spots: Vec<Spot> = patches.iter().map(Patch::spot).collect();
        let lights = self.lights.reach(&spots);
        for ((patch, spot), light) in patches.iter().zip(&spots).zip(lights) {
            sums[patch.pixel] += self.color(patch.behind, spot, light) * (patch.count / ALL);
        }
        // Much of a picture is of one colour.
        let mut last = (Vec3::ZERO, encode(Vec3::ZERO));
        for (pixel, sum) in pixels.iter_mut().zip(sums) {
            if sum != last.0 {
                last = (sum, encode(sum));
            }
            *pixel = last.1;
        }
    }

    fn color(&self, behind: bool, spot: &Spot, light: Vec3) -> Vec3 {
        let base = self.colors[usize::from(behind)];
        let straight = spot.normal.dot(self.camera.sight(spot.at)).clamp(0.0, 1.0);
        (light + AMBIENT) * EXPOSURE * (base + SHEEN * (1.0 - straight).powi(4))
    }

    /// The light on the floor under a pixel; 1 where the floor cannot be seen.
    fn floor(&self, x: usize, y: usize) -> f32 {
        let (origin, direction) = self.camera.ray(Vec2::new(x as f32, y as f32) + 0.5);
        if direction.z > -1e-3 {
            return 1.0;
        }
        let at = origin + direction * ((self.ground.z - origin.z) / direction.z);
        1.0 - (1.0 - self.ground.light(at.truncate())) * SHADOW
    }
}

/// From sRGB to linear light.
fn linear(color: [u8; 3]) -> Vec3 {
    let channel = |c: u8| {
        let c = f32::from(c) / 255.0;
        if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    };
    Vec3::from(color.map(channel))
}

/// From linear light to sRGB.
fn encode(light: Vec3) -> [u8; 3] {
    let channel = |c: f32| {
        let c = c.clamp(0.0, 1.0);
        let c = if c <= 0.003_130_8 { c * 12.92 } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
        (c * 255.0).round() as u8
    };
    light.to_array().map(channel)
}
