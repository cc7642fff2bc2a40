//! The main job, from files to a mesh file, and its stages: a pair and the family of seven chairs
//! at 128, 256 and 512 cells.
//!
//! Every end-to-end case first runs once in a process of its own, which tells its largest
//! resident set.

use criterion::{BenchmarkId, Criterion, SamplingMode, criterion_group, criterion_main};
use fieldgraft::field::{Shared, mesh::MeshField, sample::sample, sampled::Sampled};
use fieldgraft::grid::Lattice;
use fieldgraft::iso::{Mesher, extract};
use fieldgraft::job::Quiet;
use fieldgraft::mesh::{Assume, read, write};
use fieldgraft::recipe::Recipe;
use fieldgraft::run::peak_memory;
use fieldgraft::scene::{Draft, Scene};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::time::Duration;
use std::{env, fs};

type Tried<T> = Result<T, Box<dyn Error>>;

const CHAIRS: [&str; 7] =
    ["bistro", "ladderback", "lounge", "plank", "shell", "tubular", "windsor"];
/// Tells a child process what to run: the recipe and the resolution.
const CHILD: &str = "FIELDGRAFT_BENCH_CHILD";

fn data(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data").join(path)
}

/// Writes the recipes of the pair and the family, which read the chairs' mesh files.
fn prepare(folder: &Path) -> Tried<()> {
    let chairs = data("chairs").display().to_string();
    let family =
        fs::read_to_string(data("recipes/chair-family.toml"))?.replace("../chairs", &chairs);
    let (shapes, _) = family.split_once("[morph]").ok_or("no [morph] in the family's recipe")?;
    let pair = "[morph]\nmethod = 'graft'\nbetween = ['windsor', 'plank']\nt = [0.5]\n";
    fs::write(folder.join("pair.toml"), format!("{shapes}{pair}"))?;
    let group = format!(
        "[morph]\nmethod = 'group'\namong = {CHAIRS:?}\n[morph.weights]\nseat = {{ windsor = 3, plank = 1 }}\n\
         back = {{ ladderback = 1, shell = 1 }}\n"
    );
    fs::write(folder.join("family.toml"), format!("{shapes}{group}"))?;
    Ok(())
}

fn open(recipe: &Path, cells: u32) -> Tried<Scene> {
    let text = fs::read_to_string(recipe)?;
    let (mut all, source) = Recipe::parse(&text, recipe)?;
    all.grid.resolution = Some(cells);
    let beside = recipe.parent().ok_or("no folder")?;
    Ok(Draft::open(all, source, beside, &Quiet)?.build(&Quiet)?)
}

/// The first hybrid's field.
fn hybrid(scene: &Scene) -> Tried<Shared> {
    let variant = scene.variants.first().ok_or("no hybrid")?;
    Ok(variant.morph(0.5, &Quiet)?.at(0.5, &Quiet)?)
}

/// From files to a mesh file.
fn whole(recipe: &Path, cells: u32) -> Tried<usize> {
    let scene = open(recipe, cells)?;
    let samples = sample(&*hybrid(&scene)?, scene.lattice, &Quiet)?;
    let mesh = extract(&samples.bricks, Mesher::Cone, &Quiet)?;
    write(&recipe.with_extension("stl"), &mesh, "", true)?;
    Ok(mesh.faces.len())
}

/// The work of a child process, if this is one.
fn as_child() -> Tried<bool> {
    let Ok(what) = env::var(CHILD) else { return Ok(false) };
    let (recipe, cells) = what.split_once('|').ok_or("no resolution")?;
    let triangles = whole(Path::new(recipe), cells.parse()?)?;
    let peak = peak_memory().map_or("unknown".to_owned(), |b| format!("{:.0} MB", b as f64 / 1e6));
    println!("{triangles} triangles, peak memory {peak}");
    Ok(true)
}

fn memory(recipe: &Path, cells: u32) -> Tried<String> {
    let mut child = Command::new(env::current_exe()?);
    let output = child.env(CHILD, format!("{}|{cells}", recipe.display())).output()?;
    Ok(String::from_utf8(output.stdout)?.trim().to_owned())
}

fn must<T>(tried: Tried<T>) -> T {
    tried.unwrap_or_else(|e| panic!("{e}"))
}

fn end_to_end(c: &mut Criterion, folder: &Path) {
    let mut group = c.benchmark_group("files-to-stl");
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    group.warm_up_time(Duration::from_millis(1)).measurement_time(Duration::from_secs(1));
    for name in ["pair", "family"] {
        for cells in [128, 256, 512] {
            let recipe = folder.join(format!("{name}.toml"));
            println!("{name}/{cells}: {}", must(memory(&recipe, cells)));
            group.bench_function(BenchmarkId::new(name, cells), |b| {
                b.iter(|| must(whole(&recipe, cells)));
            });
        }
    }
    group.finish();
}

fn stages(c: &mut Criterion, folder: &Path) {
    let mut group = c.benchmark_group("stage");
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    group.warm_up_time(Duration::from_millis(1)).measurement_time(Duration::from_secs(1));
    let mesh = must(read(&data("chairs/windsor.obj"), Assume::default()).map_err(Into::into)).mesh;
    group.bench_function("mesh to field", |b| {
        b.iter(|| MeshField::new(&mesh, &Default::default(), &Quiet));
    });
    let exact = must(MeshField::new(&mesh, &Default::default(), &Quiet).map_err(Into::into)).0;
    let exact: Shared = Arc::new(exact);
    for cells in [128, 256] {
        let step = exact.support().size().max_element() / f64::from(cells);
        group.bench_function(BenchmarkId::new("sampled form", cells), |b| {
            b.iter(|| Sampled::new(exact.clone(), step, &Quiet));
        });
        let scene = must(open(&folder.join("pair.toml"), cells));
        let (field, on): (Shared, Lattice) = (must(hybrid(&scene)), scene.lattice);
        group.bench_function(BenchmarkId::new("graft at t", cells), |b| {
            b.iter(|| must(hybrid(&scene)));
        });
        group.bench_function(BenchmarkId::new("sample", cells), |b| {
            b.iter(|| sample(&*field, on, &Quiet));
        });
        let samples = must(sample(&*field, on, &Quiet).map_err(Into::into));
        group.bench_function(BenchmarkId::new("extract", cells), |b| {
            b.iter(|| extract(&samples.bricks, Mesher::Cone, &Quiet));
        });
    }
    group.finish();
}

fn all(c: &mut Criterion) {
    if must(as_child()) {
        // nothing more; criterion has no cases to run
        return;
    }
    let folder = must(tempfile::tempdir().map_err(Into::into));
    must(prepare(folder.path()));
    stages(c, folder.path());
    end_to_end(c, folder.path());
}

criterion_group!(benches, all);
criterion_main!(benches);
