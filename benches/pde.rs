//! PDE surfaces: solving, the frames of a morph, triangles.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use fieldgraft::surface::SurfaceError;
use fieldgraft::surface::pde::{Method, MorphOptions, Options, PdeMorph, PdeSurface};
use fieldgraft::surface::shapes::{KleinBottle, SeaShell, cut, dolphin};
use fieldgraft::surface::tessellate::tessellate;
use std::f64::consts::TAU;
use std::hint::black_box;

/// Paper 000: frames of a sequence, both ends included, and points of a patch along u and v.
const FRAMES: u32 = 13;
const POINTS: u32 = 40;

/// Four curves of 64 points, five modes: one patch, nine, the dolphin's five.
fn solving(c: &mut Criterion) -> Result<(), SurfaceError> {
    let mut group = c.benchmark_group("pde");
    let plain = Options { remainder: false, ..Options::default() };
    let shell = cut(&SeaShell::default(), 9, 64)?;
    for (name, patches, options) in [
        ("a patch", &shell[..1], plain),
        ("a patch with remainder", &shell[..1], Options::default()),
        ("nine patches", &shell[..], plain),
        ("a dolphin", &dolphin()[..], Options::default()),
    ] {
        group.bench_function(BenchmarkId::new("solve", name), |b| {
            b.iter(|| PdeSurface::new(black_box(patches), options).is_ok());
        });
    }
    Ok(())
}

/// Paper 000, sections IV.A to IV.D: shell to Klein bottle, nine patches each, 40 x 40 points a patch
/// (there 1.448, 0.989, 1.921 and 0.738 s a sequence), all solving included.
fn sequences(c: &mut Criterion) -> Result<(), SurfaceError> {
    let mut group = c.benchmark_group("pde");
    let plain = Options { remainder: false, ..Options::default() };
    let us: Vec<f64> = (0..POINTS).map(|i| f64::from(i) / f64::from(POINTS - 1)).collect();
    let vs: Vec<f64> = (0..POINTS).map(|j| TAU * f64::from(j) / f64::from(POINTS)).collect();
    let curves = [cut(&SeaShell::default(), 9, 64)?, cut(&KleinBottle::default(), 9, 64)?];
    let [from, to] = [PdeSurface::new(&curves[0], plain)?, PdeSurface::new(&curves[1], plain)?];
    let methods = [Method::Boundary, Method::Modes, Method::Combined, Method::Spine];
    for method in methods {
        let morph = |a: &PdeSurface, b: &PdeSurface| {
            PdeMorph::new(a, b, MorphOptions { method, ..Default::default() })
        };
        let made = morph(&from, &to)?;
        group.throughput(Throughput::Elements(u64::from(9 * POINTS * POINTS)));
        group.bench_function(
            BenchmarkId::new("frame of 9 x 40 x 40", format!("{method:?}")),
            |b| {
                b.iter(|| Ok::<_, SurfaceError>(made.frame(black_box(0.4))?.grid(&us, &vs)));
            },
        );
        group.throughput(Throughput::Elements(u64::from(FRAMES * 9 * POINTS * POINTS)));
        group.bench_function(BenchmarkId::new("sequence of 13", format!("{method:?}")), |b| {
            b.iter(|| {
                let (from, to) =
                    (PdeSurface::new(&curves[0], plain)?, PdeSurface::new(&curves[1], plain)?);
                let morph = morph(&from, &to)?;
                for i in 0..FRAMES {
                    let t = f64::from(i) / f64::from(FRAMES - 1);
                    black_box(morph.frame(t)?.grid(&us, &vs));
                }
                Ok::<_, SurfaceError>(())
            });
        });
    }
    Ok(())
}

fn triangles(c: &mut Criterion) -> Result<(), SurfaceError> {
    let mut group = c.benchmark_group("pde");
    group.sample_size(10);
    let animal = PdeSurface::new(&dolphin(), Options::default())?;
    for tolerance in [0.5, 0.1] {
        group.bench_function(BenchmarkId::new("tessellate the dolphin", tolerance), |b| {
            b.iter(|| tessellate(&animal, black_box(tolerance)).is_ok());
        });
    }
    Ok(())
}

fn surfaces(c: &mut Criterion) {
    // the named shapes solve, or the tests say so
    let _ = solving(c).and_then(|()| sequences(c)).and_then(|()| triangles(c));
}

criterion_group!(benches, surfaces);
criterion_main!(benches);
