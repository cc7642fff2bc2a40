//! Parametric surfaces: one point, one frame of a morph.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fieldgraft::surface::nurbs::{MorphOptions, NurbsMorph, RationalSurface};
use fieldgraft::surface::{Motion, Surface};
use glam::DVec2;
use std::{f64::consts::TAU, hint::black_box};

/// A wavy bicubic net of 20 by 16 with masses from 0.5 to 2.
fn wavy(phase: f64) -> RationalSurface {
    let even = |n: usize| -> Vec<f64> {
        let inner = (0..=n - 3).map(|i| i as f64 / (n - 3) as f64);
        [0.0; 3].into_iter().chain(inner).chain([1.0; 3]).collect()
    };
    let point = |i: usize, j: usize| {
        let [u, v] = [i as f64 / 19.0, j as f64 / 15.0];
        let wave = (TAU * (u + v) + phase).sin();
        [100.0 * u, 80.0 * v, 10.0 * wave, 1.25 + 0.75 * wave]
    };
    let net: Vec<Vec<_>> = (0..16).map(|j| (0..20).map(|i| point(i, j)).collect()).collect();
    RationalSurface::new([3, 3], even(20), even(16), &net).expect("the net fits its knots")
}

/// Position and derivatives on a grid of 100 by 100.
fn frame(surface: &dyn Surface) -> f64 {
    let at = |k: u32| f64::from(k) / 99.0;
    let grid = (0..100).flat_map(|j| (0..100).map(move |i| DVec2::new(at(i), at(j))));
    grid.map(|uv| surface.jet(0, uv)).map(|jet| jet.su.cross(jet.sv).length()).sum()
}

fn nurbs(c: &mut Criterion) {
    let targets = [wavy(0.0), wavy(2.0)];
    let masses = targets
        .iter()
        .map(|t| t.net().iter().map(|row| row.iter().map(|p| 2.0 / p[3]).collect()).collect());
    let options = MorphOptions { masses: masses.collect(), ..Default::default() };
    let own = NurbsMorph::new(&targets, &MorphOptions::default()).expect("targets match");
    let given = NurbsMorph::new(&targets, &options).expect("masses match");
    let mut group = c.benchmark_group("nurbs");
    group.throughput(Throughput::Elements(10_000));
    group.bench_function("bicubic, 100 x 100 points with derivatives", |b| {
        b.iter(|| frame(black_box(&targets[0])));
    });
    group.bench_function("morph by own masses, a frame of 100 x 100", |b| {
        b.iter(|| frame(&*own.at(black_box(0.4)).expect("a frame")));
    });
    group.bench_function("morph by given masses, a frame of 100 x 100", |b| {
        b.iter(|| frame(&*given.at(black_box(0.4)).expect("a frame")));
    });
    group.finish();
}

criterion_group!(benches, nurbs);
criterion_main!(benches);
