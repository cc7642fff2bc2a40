//! Morphs two mesh files half way and writes the hybrid:
//! `cargo run --release --example morph_two_files -- a.obj b.stl out.stl`

use fieldgraft::check::{Options, inspect};
use fieldgraft::field::mesh::{MeshField, MeshOptions};
use fieldgraft::field::sample::sample;
use fieldgraft::grid::Lattice;
use fieldgraft::iso::{Mesher, extract};
use fieldgraft::job::Quiet;
use fieldgraft::mesh::{Assume, read, write};
use fieldgraft::morph::{Inner, Part, Plan, build};
use std::error::Error;
use std::path::Path;
use std::sync::Arc;

fn part(path: &str) -> Result<Part, Box<dyn Error>> {
    let loaded = read(Path::new(path), Assume::default())?;
    let (field, report) = MeshField::new(&loaded.mesh, &MeshOptions::default(), &Quiet)?;
    for line in report.summary() {
        eprintln!("{path}: {line}");
    }
    Ok(Part { name: path.to_owned(), field: Arc::new(field) })
}

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [a, b, out] = args.as_slice() else {
        return Err("usage: morph_two_files A B OUT".into());
    };
    let plan = Plan::whole(vec![part(a)?, part(b)?], Inner::SpaceTime);
    let morph = build(plan)?;
    let half = morph.at(0.5, &Quiet)?;
    let domain = morph.domain();
    let lattice = Lattice::covering(
        &domain.grow(0.08 * domain.radius()),
        domain.size().max_element() / 128.0,
    );
    let samples = sample(&*half, lattice, &Quiet)?;
    let mesh = extract(&samples.bricks, Mesher::Cone, &Quiet)?;
    let health = inspect(&mesh, &Options::default());
    println!("{} triangles, printable: {}", health.triangles, health.printable);
    write(Path::new(out), &mesh, "two files half way", true)?;
    Ok(())
}
