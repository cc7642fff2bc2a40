//! Mesh files in and out, and the state of a mesh: 131,072 triangles of a bumpy ring.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use fieldgraft::check::{self, Options};
use fieldgraft::mesh::{Assume, TriMesh, read, snap, write};
use glam::{DVec3, dvec3};
use std::error::Error;
use std::f64::consts::TAU;
use std::hint::black_box;

/// A torus with bumps, `n` by `n` points, in single precision as files hold them.
fn bumpy(n: u32) -> TriMesh {
    let at = |i: u32, j: u32| -> DVec3 {
        let angle = |k: u32| f64::from(k) / f64::from(n) * TAU;
        let ((s, c), (t, d)) = (angle(i).sin_cos(), angle(j).sin_cos());
        let r = 60.0 + 4.0 * (9.0 * angle(i)).sin() * (7.0 * angle(j)).cos();
        dvec3((200.0 + r * d) * c, (200.0 + r * d) * s, r * t)
    };
    let id = |i: u32, j: u32| i % n * n + j % n;
    let mut mesh = TriMesh::default();
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        mesh.points.push(at(i, j));
        let [a, b, c, d] = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
        mesh.faces.extend([[a, b, c], [a, c, d]]);
    }
    snap(&mut mesh);
    mesh
}

fn files(c: &mut Criterion) -> Result<(), Box<dyn Error>> {
    let mesh = bumpy(256);
    let folder = tempfile::tempdir()?;
    let path = |kind: &str| folder.path().join(format!("bumpy.{kind}"));
    let mut group = c.benchmark_group("files");
    group.sample_size(10).throughput(Throughput::Elements(mesh.faces.len() as u64));
    for kind in ["stl", "obj", "ply", "glb"] {
        let path = path(kind);
        group.bench_function(BenchmarkId::new("write", kind), |b| {
            b.iter(|| write(&path, black_box(&mesh), "", true).is_ok());
        });
        group.bench_function(BenchmarkId::new("read", kind), |b| {
            b.iter(|| read(black_box(&path), Assume::default()).is_ok());
        });
    }
    group.finish();

    let mut group = c.benchmark_group("check");
    group.sample_size(10).throughput(Throughput::Elements(mesh.faces.len() as u64));
    for self_intersections in [false, true] {
        let options = Options { self_intersections };
        let name = if self_intersections { "with self-intersections" } else { "without" };
        group.bench_function(name, |b| b.iter(|| check::inspect(black_box(&mesh), &options)));
    }
    group.finish();
    Ok(())
}

fn all(c: &mut Criterion) {
    if let Err(e) = files(c) {
        eprintln!("files: {e}");
    }
}

criterion_group!(benches, all);
criterion_main!(benches);
