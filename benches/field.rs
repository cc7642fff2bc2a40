//! A bumpy ball as a field: building, one point, many points.

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use fieldgraft::bvh::{Bvh, Winding};
use fieldgraft::field::Field;
use fieldgraft::field::mesh::{MeshField, MeshOptions};
use fieldgraft::job::Quiet;
use fieldgraft::mesh::TriMesh;
use glam::{DVec3, dvec3};
use std::{f64::consts::TAU, hint::black_box};

/// A ball of about 500 mm with bumps: 100 bands by 200 sectors, 39 600 triangles.
fn ball() -> TriMesh {
    let (bands, sectors) = (100u32, 200u32);
    let at = |i: u32, j: u32| {
        let (s, c) = (f64::from(i) / f64::from(sectors) * TAU).sin_cos();
        let (z, r) = ((f64::from(j) / f64::from(bands) - 0.5) * TAU / 2.0).sin_cos();
        let p = dvec3(c * r, s * r, z);
        p * (250.0 + 25.0 * (9.0 * p.x).sin() * (7.0 * p.y).cos() * (8.0 * p.z).sin())
    };
    let mut mesh = TriMesh::default();
    mesh.points.extend([dvec3(0.0, 0.0, -250.0), dvec3(0.0, 0.0, 250.0)]);
    for j in 1..bands {
        mesh.points.extend((0..sectors).map(|i| at(i, j)));
    }
    let id = |i: u32, j: u32| match j {
        0 => 0,
        j if j == bands => 1,
        j => 2 + (j - 1) * sectors + i % sectors,
    };
    for i in 0..sectors {
        for j in 0..bands {
            let [a, b, c, d] = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
            let both = [(j > 0).then_some([a, b, c]), (j + 1 < bands).then_some([a, c, d])];
            mesh.faces.extend(both.into_iter().flatten());
        }
    }
    mesh
}

/// Bricks of 8³ points in Morton order that the surface runs through, at 256 points across.
fn bricks() -> Vec<DVec3> {
    let step = 2.2;
    let bit = |i: u32, axis: u32| (0..3).map(|b| (i >> (3 * b + axis) & 1) << b).sum::<u32>();
    let offset = |i: u32| DVec3::from([0, 1, 2].map(|a| f64::from(bit(i, a)))) * step;
    let turn = |k: u32| {
        let (s, c) = (f64::from(k) * 2.4).sin_cos();
        let z = f64::from(k) / 16.0 - 1.0;
        dvec3(c, s, 0.0) * (1.0 - z * z).max(0.0).sqrt() + DVec3::Z * z
    };
    (0..32).flat_map(|k| (0..512).map(move |i| turn(k) * 250.0 + offset(i))).collect()
}

fn field(c: &mut Criterion) {
    let (mesh, at) = (ball(), bricks());
    let corners: Vec<_> = (0..mesh.faces.len()).map(|i| mesh.corners(i)).collect();
    let build = || MeshField::new(&mesh, &MeshOptions::default(), &Quiet);
    let Ok((field, _)) = build() else { return };
    let (bvh, winding) = (Bvh::new(&corners), Winding::new(&corners));

    let mut one = c.benchmark_group("build");
    one.sample_size(10);
    one.bench_function("bvh", |b| b.iter(|| Bvh::new(black_box(&corners))));
    one.bench_function("field", |b| b.iter_batched(|| (), |()| build(), BatchSize::PerIteration));
    one.finish();

    let mut many = c.benchmark_group("point");
    many.throughput(Throughput::Elements(at.len() as u64));
    many.sample_size(20);
    many.bench_function("nearest", |b| {
        b.iter(|| at.iter().map(|&p| bvh.distance(p)).sum::<f64>());
    });
    many.bench_function("nearest_all", |b| b.iter(|| bvh.nearest_all(&at)));
    many.bench_function("winding", |b| {
        b.iter(|| at.iter().map(|&p| winding.number(p, 0.5)).sum::<f64>());
    });
    let mut out = vec![0.0; at.len()];
    many.bench_function("values", |b| b.iter(|| field.values(&at, &mut out)));
    many.finish();
}

criterion_group!(benches, field);
criterion_main!(benches);
