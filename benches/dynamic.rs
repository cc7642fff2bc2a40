//! Parametric surfaces: what a step or a frame costs.

use criterion::{Criterion, criterion_group, criterion_main};
use fieldgraft::num::Expr;
use fieldgraft::surface::dynamic::{Dynamic, Options, VARIABLES};
use std::{hint::black_box, time::Duration};

/// Steps of a dynamic surface at 41 x 41 and 129 x 129 nodes: the paper's plate, which moves in z
/// only; and all three components driven by forces that change in time.
fn dynamic(c: &mut Criterion) {
    let mut group = c.benchmark_group("dynamic");
    group.sample_size(10).measurement_time(Duration::from_secs(2));
    for n in [41, 129] {
        let plate = Options { grid: [n; 2], dt: 1e-3, ..Options::default() };
        let mut driven = plate.clone();
        let force = |text| Expr::parse(text, &VARIABLES);
        let (Ok(x), Ok(y), Ok(z)) =
            (force("80*sin(40*t)*v"), force("80*cos(9*t)"), force("800*sin(30*t+6*u*v)"))
        else {
            return;
        };
        driven.force = [x, y, z];
        group
            .bench_function(format!("new {n}"), |b| b.iter(|| Dynamic::new(plate.clone()).is_ok()));
        for (name, options) in [("plate", plate), ("driven", driven)] {
            let Ok(surface) = Dynamic::new(options) else { return };
            let mut state = surface.start();
            group.bench_function(format!("step {name} {n}"), |b| {
                b.iter(|| black_box(surface.step(&mut state).is_ok()));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, dynamic);
criterion_main!(benches);
