//! The studio: light from many directions, each with a depth map of what it reaches first.

use super::camera::Camera;
use super::scene::Scene;
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::f32::consts::{PI, TAU};

/// Directions all round; fewer, and shadows on the ground show their edges.
const SKY: usize = 48;
/// Directions within the key light's disc.
const KEY: usize = 16;
/// Radius of the key light's disc, radians: softens the edge of its shadow.
const KEY_RADIUS: f32 = 0.22;
/// Texels along the longer side of a depth map.
const TEXELS: f32 = 320.0;
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

struct Light {
    toward: Vec3,
    color: Vec3,
    map: DepthMap,
}

pub(super) struct Lights {
    lights: Vec<Light>,
    /// What an open floor receives.
    open: Vec3,
}

impl Lights {
    pub fn new(scene: &Scene, camera: &Camera) -> Self {
        let directions = directions(camera);
        let lights: Vec<Light> = directions
            .into_par_iter()
            .map(|(toward, color)| Light {
                toward,
                color,
                map: DepthMap::new(scene, toward),
            })
            .collect();
        let open = lights.iter().map(|l| l.color * l.toward.z.max(0.0)).sum();
        Self { lights, open }
    }

    /// The light that reaches each spot; 1 is what an open floor receives.
    pub fn reach(&self, spots: &[Spot]) -> Vec<Vec3> {
        let mut sums = vec![Vec3::ZERO; spots.len()];
        // Light by light: one depth map at a time stays in the cache.
        for light in &self.lights {
            for (spot, sum) in spots.iter().zip(&mut sums) {
                let slant = spot.normal.dot(light.toward);
                if slant > 0.0 {
                    let (open, _) = light.map.open(spot, light.toward);
                    *sum += light.color * (slant * open);
                }
            }
        }
        sums.iter_mut().for_each(|sum| *sum /= self.open);
        sums
    }

    /// For spots of the floor the light that reaches them, and how far off the nearest thing is
    /// that keeps some of it away; 0 when nothing does.
    pub fn on_floor(&self, spots: &[Spot]) -> Vec<[f32; 2]> {
        let mut sums = vec![[0.0, f32::INFINITY]; spots.len()];
        let weigh = |l: &Light| l.color.element_sum() * l.toward.z.max(0.0);
        for light in self.lights.iter().filter(|l| l.toward.z > 0.0) {
            for (spot, [sum, nearest]) in spots.iter().zip(&mut sums) {
                let (open, distance) = light.map.open(spot, light.toward);
                *sum += weigh(light) * open;
                *nearest = nearest.min(distance);
            }
        }
        let all: f32 = self.lights.iter().map(weigh).sum();
        let finite = |d: f32| if d.is_finite() { d } else { 0.0 };
        sums.into_iter()
            .map(|[sum, nearest]| [sum / all, finite(nearest)])
            .collect()
    }
}

/// Where light comes from, and how much.
fn directions(camera: &Camera) -> Vec<(Vec3, Vec3)> {
    // The camera's bearing, so that every view is lit alike. From above, the picture's bottom.
    let level = Vec3::new(camera.toward.x, camera.toward.y, 0.0);
    let front = level.normalize_or(-camera.up);
    let key = (front * 0.55 - camera.right * 0.75 + Vec3::Z * 1.05).normalize();
    let fill = (front * 0.8 + camera.right * 0.9 + Vec3::Z * 0.35).normalize();
    let sky = (0..SKY).map(|i| {
        let toward = spiral(i, SKY);
        let above = 0.5 + 0.5 * toward.z;
        let glow = 0.30 + 0.95 * above * above + 0.55 * toward.dot(fill).max(0.0).powi(2);
        (toward, Vec3::new(0.97, 0.99, 1.03) * (glow / SKY as f32))
    });
    let (u, v) = key.any_orthonormal_pair();
    let disc = (0..KEY).map(|i| {
        let r = ((i as f32 + 0.5) / KEY as f32).sqrt() * KEY_RADIUS;
        let (sin, cos) = (i as f32 * GOLDEN).sin_cos();
        (
            (key + (u * cos + v * sin) * r).normalize(),
            Vec3::new(1.03, 1.0, 0.95) * (0.42 / KEY as f32),
        )
    });
    sky.chain(disc).collect()
}

/// The angle that spreads points evenly over a spiral.
const GOLDEN: f32 = PI * 0.763_932;

/// Point `i` of `n` spread evenly over the unit sphere.
fn spiral(i: usize, n: usize) -> Vec3 {
    let z = 1.0 - (2.0 * i as f32 + 1.0) / n as f32;
    let (sin, cos) = (i as f32 * GOLDEN % TAU).sin_cos();
    let r = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(r * cos, r * sin, z)
}

/// How near to the light the first surface lies, on a grid across the light's direction.
struct DepthMap {
    across: Vec3,
    along: Vec3,
    low: Vec2,
    /// Texels a unit.
    scale: f32,
    width: usize,
    height: usize,
    depth: Vec<f32>,
}

impl DepthMap {
    fn new(scene: &Scene, toward: Vec3) -> Self {
        let (across, along) = toward.any_orthonormal_pair();
        let flat = |p: Vec3| Vec2::new(p.dot(across), p.dot(along));
        let corners = scene.corners().map(flat);
        let low = corners.into_iter().fold(Vec2::INFINITY, Vec2::min);
        let size = corners.into_iter().fold(Vec2::NEG_INFINITY, Vec2::max) - low;
        let scale = TEXELS / size.max_element().max(1e-6);
        let [width, height] = (size * scale).to_array().map(|n| n as usize + 1);
        let depth = vec![f32::NEG_INFINITY; width * height];
        let mut map = Self {
            across,
            along,
            low,
            scale,
            width,
            height,
            depth,
        };
        let at = |p: &Vec3| ((flat(*p) - low) * scale - 0.5).extend(p.dot(toward));
        let points: Vec<Vec3> = scene.points.iter().map(at).collect();
        for f in &scene.faces {
            map.draw(f.map(|v| points[v as usize]));
        }
        map
    }

    /// Draws a triangle whose x, y are texels (centres at whole numbers) and z its nearness.
    fn draw(&mut self, [a, b, c]: [Vec3; 3]) {
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let (left, top) = (
            low.x.ceil().max(0.0) as usize,
            low.y.ceil().max(0.0) as usize,
        );
        let right = ((high.x.floor() + 1.0).max(0.0) as usize).min(self.width);
        let bottom = ((high.y.floor() + 1.0).max(0.0) as usize).min(self.height);
        if left >= right || top >= bottom {
            return;
        }
        let area = (b - a).truncate().perp_dot((c - a).truncate());
        if area == 0.0 {
            return;
        }
        let share = |p: Vec3, q: Vec3, x: f32, y: f32| {
            ((q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x)) / area
        };
        for y in top..bottom {
            for x in left..right {
                let (px, py) = (x as f32, y as f32);
                let w = [
                    share(b, c, px, py),
                    share(c, a, px, py),
                    share(a, b, px, py),
                ];
                if w.iter().all(|&w| w >= -1e-5) {
                    let depth = &mut self.depth[y * self.width + x];
                    *depth = depth.max(w[0] * a.z + w[1] * b.z + w[2] * c.z);
                }
            }
        }
    }

    /// The share of a spot that the light reaches, smooth between texels, and the distance to
    /// what stands nearest in its way.
    fn open(&self, spot: &Spot, toward: Vec3) -> (f32, f32) {
        let at = spot.at + (spot.normal + toward * 0.5) * (LIFT / self.scale);
        let flat = Vec2::new(at.dot(self.across), at.dot(self.along));
        let place = (flat - self.low) * self.scale - 0.5;
        let corner = place.floor();
        let part = place - corner;
        let (x, y) = (corner.x as i32, corner.y as i32);
        let outside = x < -1 || y < -1 || x >= self.width as i32 || y >= self.height as i32;
        if outside {
            return (1.0, f32::INFINITY);
        }
        let (near, mut nearest) = (at.dot(toward), f32::INFINITY);
        let mut free = |x: i32, y: i32| {
            let inside = x >= 0 && y >= 0 && x < self.width as i32 && y < self.height as i32;
            let at = |x: i32, y: i32| self.depth[y as usize * self.width + x as usize];
            let gap = if inside { at(x, y) - near } else { -1.0 };
            if gap > 0.0 {
                nearest = nearest.min(gap);
                return 0.0;
            }
            1.0
        };
        let upper = free(x, y) * (1.0 - part.x) + free(x + 1, y) * part.x;
        let lower = free(x, y + 1) * (1.0 - part.x) + free(x + 1, y + 1) * part.x;
        (upper * (1.0 - part.y) + lower * part.y, nearest)
    }
}
