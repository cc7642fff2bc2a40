//! Parametric surfaces: solving and sampling.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fieldgraft::surface::blend::{Basis, Blend, BlendSpec, cone, cylinders, frustum};
use fieldgraft::surface::{Motion, SurfaceError};
use glam::dvec2;
use std::f64::consts::TAU;
use std::hint::black_box;

fn even(n: u32, to: f64) -> Vec<f64> {
    (0..n).map(|i| to * f64::from(i) / f64::from(n - 1)).collect()
}

/// Paper 002, Table 1: 100 x 100 points of the test case (there 0.597 s in closed form, 0.077 s with
/// five terms, 0.111 s with ten).
fn blends(c: &mut Criterion) -> Result<(), SurfaceError> {
    let (us, vs) = (even(100, 1.0), even(100, TAU));
    let mut group = c.benchmark_group("blend");
    for (name, make) in [("frustum", frustum()), ("cone", cone())] {
        let spec = make?;
        group.bench_function(format!("solve/{name}"), |b| b.iter(|| Blend::new(spec.clone())));
    }
    group.throughput(Throughput::Elements((us.len() * vs.len()) as u64));
    for (basis, terms) in [(Basis::Bubble, 5), (Basis::Bubble, 10), (Basis::Sine, 5)] {
        let spec = BlendSpec { basis, terms, ..cylinders()? };
        group.bench_function(format!("solve and 100 x 100/{basis:?} {terms}"), |b| {
            b.iter(|| {
                Ok::<_, SurfaceError>(Blend::new(spec.clone())?.surface(0.1)?.jets(&us, &vs))
            });
        });
        let blend = Blend::new(spec)?;
        group.bench_function(format!("next time, 100 x 100/{basis:?} {terms}"), |b| {
            b.iter(|| Ok::<_, SurfaceError>(blend.surface(black_box(0.1))?.jets(&us, &vs)));
        });
        let surface = blend.at(0.1)?;
        group.bench_function(format!("10,000 points alone/{basis:?} {terms}"), |b| {
            b.iter(|| {
                let row =
                    |u: &f64| vs.iter().map(|v| surface.point(0, dvec2(*u, *v)).x).sum::<f64>();
                us.iter().map(row).sum::<f64>()
            });
        });
    }
    let exact = Blend::new(cylinders()?)?.exact()?;
    group.bench_function("next time, 100 x 100/closed form", |b| {
        b.iter(|| Ok::<_, SurfaceError>(exact.surface(black_box(0.1))?.jets(&us, &vs)));
    });
    group.finish();
    Ok(())
}

fn surfaces(c: &mut Criterion) {
    // the shipped blends solve, or the tests say so
    let _ = blends(c);
}

criterion_group!(benches, surfaces);
criterion_main!(benches);
