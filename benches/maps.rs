//! What a hybrid does at each point before it looks a shape up: distances to feature elements, weights of
//! eight features, and the space map from one element to another.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fieldgraft::element::{Element, ElementError};
use fieldgraft::warp::Deform;
use fieldgraft::weight::Weighting;
use glam::{DQuat, DVec3, dvec3};
use std::hint::black_box;

/// 8³ points, 4 mm apart.
fn points() -> Vec<DVec3> {
    let part = |n: u32, by: u32| f64::from(n / by % 8) * 4.0 - 14.0;
    (0..512).map(|n| dvec3(part(n, 1), part(n, 8), part(n, 64))).collect()
}

fn measure(c: &mut Criterion) -> Result<(), ElementError> {
    let at = points();
    let turn = DQuat::from_rotation_z(0.3);
    let plain = Element::block(DVec3::ZERO, dvec3(30.0, 20.0, 200.0), turn)?;
    let deform = Deform { twist: 0.8, taper: 0.6, ..Deform::default() };
    let bent = Element::block(dvec3(5.0, 3.0, 0.0), dvec3(25.0, 25.0, 180.0), DQuat::IDENTITY)?;
    let bent = bent.deformed(deform)?;

    let mut group = c.benchmark_group("map");
    group.throughput(Throughput::Elements(at.len() as u64));
    for (name, from, to) in [("affine", &plain, &plain), ("twist and taper", &plain, &bent)] {
        let between = from.between(to);
        group.bench_function(name, |b| {
            b.iter(|| black_box(&at).iter().map(|&p| between.pull(p)).sum::<DVec3>());
        });
    }
    for (name, element) in [("distance, plain", &plain), ("distance, twist and taper", &bent)] {
        let gauge = element.gauge(5.0);
        group.bench_function(name, |b| {
            b.iter(|| black_box(&at).iter().map(|&p| gauge.distance(p)).sum::<f64>());
        });
    }
    group.finish();

    let distances: Vec<f64> =
        at.iter().flat_map(|p| [0.2, 0.5, 0.9, 1.4].map(|k| p.x * k)).collect();
    let mut group = c.benchmark_group("weigh");
    group.throughput(Throughput::Elements(distances.len() as u64 / 8));
    for (name, weighting) in [
        ("smooth", Weighting::Smooth { epsilon: 30.0, power: 2.0 }),
        ("transfinite", Weighting::Transfinite),
        ("inverse square", Weighting::InverseSquare { epsilon: 30.0 }),
    ] {
        let mut out = [0.0; 8];
        group.bench_function(name, |b| {
            b.iter(|| {
                for d in black_box(&distances).chunks_exact(8) {
                    weighting.weigh(d, &mut out);
                }
                out[0]
            });
        });
    }
    group.finish();
    Ok(())
}

fn all(c: &mut Criterion) {
    if let Err(e) = measure(c) {
        eprintln!("maps: {e}");
    }
}

criterion_group!(benches, all);
criterion_main!(benches);
