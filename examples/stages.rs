//! Seconds of each stage from a mesh file to a mesh, as a line of JSON; what `benches/peers` times.
//! `cargo run --release --example stages -- chair.obj 512 [--all] [--nets] [--dump FILE.npy]`; `gyroid`
//! instead of a file is a gyroid in a ball. `--all` also takes the distance at every point of the
//! lattice, `--nets` also runs fast-surface-nets on the same samples, `--dump` writes them (f32, z y x;
//! what is farther than three steps from the surface is cut to that).

use fast_surface_nets::ndshape::RuntimeShape;
use fast_surface_nets::{SurfaceNetsBuffer, surface_nets};
use fieldgraft::field::mesh::{MeshField, MeshOptions};
use fieldgraft::field::{Field, Shared, sample::sample};
use fieldgraft::grid::{Bricks, Lattice};
use fieldgraft::iso::{Mesher, extract};
use fieldgraft::job::Quiet;
use fieldgraft::mesh::{Assume, read};
use fieldgraft::num::{Aabb, Interval};
use fieldgraft::run::peak_memory;
use glam::DVec3;
use rayon::prelude::*;
use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// The gyroid of wave length 20 in a ball of radius 50.
struct Gyroid;

impl Field for Gyroid {
    fn value(&self, p: DVec3) -> f64 {
        let k = std::f64::consts::TAU / 20.0;
        let (s, c) = ((p * k).map(f64::sin), (p * k).map(f64::cos));
        // each part of the gyroid's gradient is at most k
        let gyroid = (s.x * c.y + s.y * c.z + s.z * c.x) / (k * 3f64.sqrt());
        gyroid.max(p.length() - 50.0)
    }

    fn bound(&self, b: &Aabb) -> Interval {
        Interval::ball(self.value(b.centre()), b.radius())
    }

    fn support(&self) -> Aabb {
        Aabb::around(DVec3::ZERO, DVec3::splat(50.0))
    }
}

/// Distances at all points of a lattice, in runs of 8³; the sum keeps the work from being left out.
fn everywhere(field: &dyn Field, lattice: &Lattice) -> f64 {
    let [nx, ny, nz] = lattice.size;
    let blocks = [nx, ny, nz].map(|n| n.div_ceil(8));
    let count = blocks.iter().product::<u32>();
    let sums = (0..count).into_par_iter().map(|b| {
        let at = [b % blocks[0], b / blocks[0] % blocks[1], b / (blocks[0] * blocks[1])];
        let [x, y, z] = at.map(|i| 8 * i);
        let points: Vec<DVec3> = (z..nz.min(z + 8))
            .flat_map(|k| {
                (y..ny.min(y + 8)).flat_map(move |j| (x..nx.min(x + 8)).map(move |i| [i, j, k]))
            })
            .map(|c| lattice.bounds().min + DVec3::from(c.map(f64::from)) * lattice.step)
            .collect();
        let mut out = vec![0.0; points.len()];
        field.values(&points, &mut out);
        out.iter().sum::<f64>()
    });
    sums.sum()
}

/// All samples of the lattice, x fastest, cut to three steps.
fn dense(bricks: &Bricks<f32>) -> Vec<f32> {
    let Lattice { step, size: [nx, ny, nz], .. } = bricks.lattice;
    let far = 3.0 * step as f32;
    let mut all = vec![far; nx as usize * ny as usize * nz as usize];
    for (n, row) in all.chunks_exact_mut(nx as usize).enumerate() {
        let [j, k] = [n % ny as usize, n / ny as usize];
        bricks.row([0, j as i64, k as i64], -far, far, row);
        row.iter_mut().for_each(|v| *v = v.clamp(-far, far));
    }
    all
}

/// Writes samples as NumPy reads them.
fn dump(path: &str, [nx, ny, nz]: [u32; 3], samples: &[f32]) -> std::io::Result<()> {
    let about =
        format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({nz}, {ny}, {nx}), }}");
    let mut out = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    out.extend(format!("{about:<117}\n").bytes());
    out.extend(samples.iter().flat_map(|v| v.to_le_bytes()));
    std::fs::write(path, out)
}

/// Seconds that fast-surface-nets takes.
fn nets(size: [u32; 3], samples: &[f32]) -> f64 {
    let shape = RuntimeShape::<u32, 3>::new(size);
    let start = Instant::now();
    let mut mesh = SurfaceNetsBuffer::default();
    surface_nets(samples, &shape, [0; 3], size.map(|n| n - 1), &mut mesh);
    let seconds = start.elapsed().as_secs_f64();
    assert!(!mesh.indices.is_empty(), "it makes a mesh");
    seconds
}

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [file, cells, rest @ ..] = args.as_slice() else {
        return Err("usage: stages FILE|gyroid CELLS [--all] [--nets] [--dump FILE.npy]".into());
    };
    let cells: f64 = cells.parse()?;
    let mut clock = Instant::now();
    let mut lap = || std::mem::replace(&mut clock, Instant::now()).elapsed().as_secs_f64();
    let (mut read_s, mut field_s) = (0.0, 0.0);
    let field: Shared = match file.as_str() {
        "gyroid" => Arc::new(Gyroid),
        file => {
            let loaded = read(Path::new(file), Assume::default())?;
            read_s = lap();
            let field = MeshField::new(&loaded.mesh, &MeshOptions::default(), &Quiet)?.0;
            field_s = lap();
            Arc::new(field)
        }
    };
    let box_ = field.support();
    let step = box_.size().max_element() / cells;
    let lattice = Lattice::covering(&box_.grow(4.0 * step), step);
    lap();
    let samples = sample(&*field, lattice, &Quiet)?;
    let sample_s = lap();
    let mesh = extract(&samples.bricks, Mesher::Cone, &Quiet)?;
    let extract_s = lap();
    let option = |name: &str| rest.iter().position(|a| a == name);
    let nets_s = option("--nets").map(|_| nets(lattice.size, &dense(&samples.bricks)));
    if let Some(path) = option("--dump").and_then(|n| rest.get(n + 1)) {
        dump(path, lattice.size, &dense(&samples.bricks))?;
    }
    lap();
    let peak = peak_memory().unwrap_or(0);
    let all_s = option("--all").map(|_| (everywhere(&*field, &lattice), lap()).1);
    let [all_s, nets_s] = [all_s, nets_s].map(|s| s.map_or("null".to_owned(), |s| s.to_string()));
    println!(
        "{{\"read\": {read_s}, \"field\": {field_s}, \"sample\": {sample_s}, \"extract\": {extract_s}, \
         \"all_points\": {all_s}, \"fast_surface_nets\": {nets_s}, \"triangles\": {}, \"peak_bytes\": {peak}}}",
        mesh.faces.len()
    );
    Ok(())
}
