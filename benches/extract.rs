//! Sampling and meshing a gyroid within a ball: points and triangles a second.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use fieldgraft::field::{Field, sample::sample};
use fieldgraft::grid::Lattice;
use fieldgraft::iso::{Mesher, extract};
use fieldgraft::job::Quiet;
use fieldgraft::num::{Aabb, Interval};
use glam::DVec3;
use std::f64::consts::TAU;

/// Wave length, mm.
const WAVE: f64 = 20.0;
/// Radius of the ball, mm.
const RADIUS: f64 = 50.0;

struct Gyroid;

impl Field for Gyroid {
    fn value(&self, p: DVec3) -> f64 {
        let k = TAU / WAVE;
        let (s, c) = ((p * k).map(f64::sin), (p * k).map(f64::cos));
        let gyroid = s.x * c.y + s.y * c.z + s.z * c.x;
        // each part of the gyroid's gradient is at most k
        (gyroid / (k * 3f64.sqrt())).max(p.length() - RADIUS)
    }
    fn bound(&self, b: &Aabb) -> Interval {
        Interval::ball(self.value(b.centre()), b.radius())
    }
    fn support(&self) -> Aabb {
        Aabb::around(DVec3::ZERO, DVec3::splat(RADIUS))
    }
}

fn lattice(cells: u32) -> Lattice {
    Lattice::covering(&Gyroid.support(), 2.0 * RADIUS / f64::from(cells - 2))
}

fn sampling(c: &mut Criterion) {
    let mut group = c.benchmark_group("sample");
    group.sample_size(10);
    for cells in [128, 256] {
        let Ok(s) = sample(&Gyroid, lattice(cells), &Quiet) else {
            continue;
        };
        group.throughput(Throughput::Elements(s.stats.evaluated));
        group.bench_function(BenchmarkId::new("gyroid", cells), |b| {
            b.iter(|| sample(&Gyroid, lattice(cells), &Quiet));
        });
    }
    group.finish();
}

fn meshing(c: &mut Criterion) {
    let mut group = c.benchmark_group("extract");
    group.sample_size(10);
    for cells in [128, 256] {
        let Ok(s) = sample(&Gyroid, lattice(cells), &Quiet) else {
            continue;
        };
        for mesher in [Mesher::Cone, Mesher::SurfaceNets] {
            let triangles = extract(&s.bricks, mesher, &Quiet).map_or(0, |m| m.faces.len());
            group.throughput(Throughput::Elements(triangles as u64));
            group.bench_function(BenchmarkId::new(format!("{mesher:?}"), cells), |b| {
                b.iter(|| extract(&s.bricks, mesher, &Quiet));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, sampling, meshing);
criterion_main!(benches);
