//! The studio: light from many directions, each with a depth map of what it reaches first.

use super::camera::Camera;
use super::caster::{Caster, texels};
use super::depth_map::{DepthMap, Packet, Spot};
use super::lanes::{Eight, Eight3, LANES, Vec8, take};
use super::scene::Scene;
use fearless_simd::{Level, Simd, dispatch, f32x8, mask32x8, prelude::*};
use glam::Vec3;
use rayon::prelude::*;
use std::f32::consts::PI;

/// Directions of the sky; fewer, and shadows on the ground show their edges.
const ABOVE: usize = 72;
/// Directions of the bounce from below, which is dim.
const BELOW: usize = 16;
/// Detail of the sky's depth maps beside the key light's: its shadows are soft.
const SKY_DETAIL: f32 = 0.7;
/// Directions within the key light's disc; fewer, and rods cast bundles of stripes.
const KEY: usize = 28;
/// Radius of the key light's disc, radians: softens the edge of its shadow.
const KEY_RADIUS: f32 = 0.22;

struct Light {
    color: Vec3,
    map: DepthMap,
}

pub(super) struct Lights {
    lights: Vec<Light>,
    /// What an open floor receives.
    open: Vec3,
}

/// Memory that drawing a picture of that size takes whatever the mesh, bytes: its lights' depth maps
/// and the picture itself.
pub fn working_memory([width, height]: [u32; 2]) -> f64 {
    /// How much of a square a map covers, on average over directions.
    const COVER: f64 = 0.85;
    let side = width.max(height) as f32;
    let map = |pixels: f32| f64::from(texels(pixels)).powi(2) * 4.0 * COVER;
    let sky = (ABOVE + BELOW) as f64 * map(side * SKY_DETAIL);
    sky + KEY as f64 * map(side) + 3.0 * f64::from(width) * f64::from(height)
}

impl Lights {
    /// For a picture with that many pixels along its longer side.
    pub fn new(scene: &Scene, camera: &Camera, pixels: u32) -> Self {
        let (sky, key) = directions(camera);
        let caster = |detail: f32| Caster::of(scene, pixels as f32 * detail);
        let (fine, coarse) = rayon::join(|| caster(1.0), || caster(SKY_DETAIL));
        let sky = sky.into_par_iter().map(|from| (from, &coarse));
        let key = key.into_par_iter().map(|from| (from, &fine));
        let light = |((toward, color), caster)| Light { color, map: DepthMap::new(caster, toward) };
        let lights: Vec<Light> = sky.chain(key).map(light).collect();
        let open = lights.iter().map(|l| l.color * l.map.toward.z.max(0.0)).sum();
        Self { lights, open }
    }

    /// The light that reaches each spot; 1 is what an open floor receives.
    pub fn reach(&self, spots: &[Spot]) -> Vec<Vec3> {
        let packets: Vec<Packet> = spots.chunks(LANES).map(Packet::of).collect();
        let sums = dispatch!(Level::new(), s => self.sum(s, &packets));
        let at = |i: usize| take(&sums[i / LANES], i % LANES) / self.open;
        (0..spots.len()).map(at).collect()
    }

    #[inline(always)]
    fn sum<S: Simd>(&self, s: S, packets: &[Packet]) -> Vec<Eight3> {
        let mut sums = vec![[[0.0; LANES]; 3]; packets.len()];
        let zero = f32x8::splat(s, 0.0);
        // Light by light: one depth map at a time stays in the cache.
        for light in &self.lights {
            for (packet, sum) in packets.iter().zip(&mut sums) {
                let spots = packet.load(s);
                let slant = spots.normal.dot(Vec8::splat(s, light.map.toward));
                let lit = slant.simd_gt(zero);
                if lit.any_true() {
                    let part = lit.select(slant * light.map.open(s, &spots, lit).share, zero);
                    let more = Vec8::splat(s, light.color).times(part);
                    *sum = Vec8::load(s, sum).plus(more).store();
                }
            }
        }
        sums
    }

    /// For spots of the floor the light that reaches them, and how far off the nearest thing is
    /// that keeps some of it away; 0 when nothing does.
    pub fn on_floor(&self, spots: &[Spot]) -> Vec<[f32; 2]> {
        let weigh = |l: &Light| l.color.element_sum() * l.map.toward.z.max(0.0);
        let all: f32 = self.lights.iter().map(weigh).sum();
        let packets: Vec<Packet> = spots.chunks(LANES).map(Packet::of).collect();
        let sums = dispatch!(Level::new(), s => self.sum_on_floor(s, &packets, weigh));
        let finite = |d: f32| if d.is_finite() { d } else { 0.0 };
        let at = |i: usize| {
            let [sum, nearest] = sums[i / LANES].map(|lanes| lanes[i % LANES]);
            [sum / all, finite(nearest)]
        };
        (0..spots.len()).map(at).collect()
    }

    #[inline(always)]
    fn sum_on_floor<S: Simd>(
        &self,
        s: S,
        packets: &[Packet],
        weigh: impl Fn(&Light) -> f32,
    ) -> Vec<[Eight; 2]> {
        let mut sums = vec![[[0.0; LANES], [f32::INFINITY; LANES]]; packets.len()];
        let all = mask32x8::splat(s, true);
        for light in self.lights.iter().filter(|l| l.map.toward.z > 0.0) {
            let weight = f32x8::splat(s, weigh(light));
            for (packet, [sum, nearest]) in packets.iter().zip(&mut sums) {
                let open = light.map.open(s, &packet.load(s), all);
                *sum = (f32x8::simd_from(s, *sum) + weight * open.share).into();
                *nearest = open.nearest(f32x8::simd_from(s, *nearest)).into();
            }
        }
        sums
    }
}

/// A direction light comes from, and its colour times its strength.
type Source = (Vec3, Vec3);

/// The directions of the sky and of the key light.
fn directions(camera: &Camera) -> (Vec<Source>, Vec<Source>) {
    // The camera's bearing, so that every view is lit alike. From above, the picture's bottom.
    let level = Vec3::new(camera.toward.x, camera.toward.y, 0.0);
    let front = level.normalize_or(-camera.up);
    let key = (front * 0.75 - camera.right * 0.75 + Vec3::Z).normalize();
    let fill = (front * 0.8 + camera.right * 0.9 + Vec3::Z * 0.35).normalize();
    let from_sky = |toward: Vec3| {
        let above = 0.5 + 0.5 * toward.z;
        let glow = 0.18 + 0.95 * above * above + 0.60 * toward.dot(fill).max(0.0).powi(2);
        (toward, Vec3::new(0.97, 0.99, 1.03) * (glow * 0.5))
    };
    let above = spiral(ABOVE, 1.0, 0.0).map(from_sky).map(|(l, c)| (l, c / ABOVE as f32));
    let below = spiral(BELOW, 0.0, -1.0).map(from_sky).map(|(l, c)| (l, c / BELOW as f32));
    let (u, v) = key.any_orthonormal_pair();
    let disc = (0..KEY).map(|i| {
        let r = ((i as f32 + 0.5) / KEY as f32).sqrt() * KEY_RADIUS;
        let (sin, cos) = (i as f32 * GOLDEN).sin_cos();
        let toward = (key + (u * cos + v * sin) * r).normalize();
        (toward, Vec3::new(1.03, 1.0, 0.95) * (0.62 / KEY as f32))
    });
    (above.chain(below).collect(), disc.collect())
}

/// The angle that spreads points evenly over a spiral.
const GOLDEN: f32 = PI * 0.763_932;

/// That many points spread evenly over the unit sphere between two heights.
fn spiral(count: usize, from: f32, to: f32) -> impl Iterator<Item = Vec3> {
    (0..count).map(move |i| {
        let z = from + (to - from) * (i as f32 + 0.5) / count as f32;
        let (sin, cos) = (i as f32 * GOLDEN).sin_cos();
        let r = (1.0 - z * z).max(0.0).sqrt();
        Vec3::new(r * cos, r * sin, z)
    })
}
