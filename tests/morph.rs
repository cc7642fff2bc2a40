//! Morphs of our own chairs with their own features, from recipe to mesh.

use crate::util::Folder;
use fieldgraft::bvh::Bvh;
use fieldgraft::check::{Options, inspect};
use fieldgraft::field::Shared;
use fieldgraft::field::sample::{sample, sample_dense};
use fieldgraft::grid::{Brick, Bricks, Lattice};
use fieldgraft::iso::{Mesher, extract, extract_sharp};
use fieldgraft::job::Quiet;
use fieldgraft::mesh::TriMesh;
use fieldgraft::num::Aabb;
use fieldgraft::recipe::{GridEntry, MesherEntry, Recipe, ShapeEntry};
use fieldgraft::run::{FrameResult, Work, make};
use fieldgraft::scene::{Draft, Scene, Single, Variant};
use glam::DVec3;
use rayon::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};

fn recipes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data/recipes")
}

/// The text of the family's recipe with another `[morph]`.
fn text(resolution: u32, morph: &str) -> String {
    let text = fs::read_to_string(recipes().join("chair-family.toml")).unwrap();
    let (shapes, _) = text.split_once("[morph]").unwrap();
    let shapes = shapes.replace("resolution = 256", &format!("resolution = {resolution}"));
    shapes + "[morph]\n" + morph
}

/// The family's shapes and features with other hybrids.
fn scene(resolution: u32, morph: &str) -> Scene {
    let file = recipes().join("test.toml");
    let (recipe, source) = Recipe::parse(&text(resolution, morph), &file).unwrap();
    let draft = Draft::open(recipe, source, &recipes(), &Quiet).unwrap();
    draft.build(&Quiet).unwrap()
}

/// `[[hybrids]]` of the keys given, called by them.
fn hybrids<S: AsRef<str>>(keys: impl IntoIterator<Item = S>) -> String {
    let one = |keys: S| {
        let keys = keys.as_ref();
        format!("[[hybrids]]\nname = '''{keys}'''\n{keys}\n")
    };
    keys.into_iter().map(one).collect()
}

fn field(variant: &Variant, t: f64) -> Shared {
    variant.morph(t, &Quiet).unwrap().at(t, &Quiet).unwrap()
}

/// The mesh of a hybrid at a time, as a run makes it.
fn frame(scene: &Scene, variant: &Variant, t: f64) -> FrameResult {
    let work = Work {
        variant: &variant.name,
        t,
        lattice: scene.lattice,
        mesher: MesherEntry::Print,
        crumbs: variant.crumbs,
        verify: false,
    };
    make(&work, &|job| variant.morph(t, &Quiet).unwrap().at(t, job), &Quiet).unwrap()
}

/// Every pair method and every inner function, weighting and blend of a graft.
fn methods() -> Vec<String> {
    let mut all: Vec<String> = ["linear", "feature-volume", "level-set", "transport", "warp"]
        .map(|m| format!("method = '{m}'"))
        .into();
    for form in ["l", "s", "half-cylinders"] {
        all.push(format!("method = 'space-time'\nspace-time = {{ form = '{form}' }}"));
    }
    for blend in ["maps", "fields"] {
        for inner in ["linear", "space-time", "grow", "erode", "auto"] {
            all.push(format!("method = 'graft'\nblend = '{blend}'\ninner = '{inner}'"));
        }
        for form in ["s", "half-cylinders"] {
            all.push(format!(
                "method = 'graft'\nblend = '{blend}'\ninner = 'space-time'\nspace-time = {{ form = '{form}' }}"
            ));
        }
        for weighting in ["transfinite", "inverse-square"] {
            all.push(format!("method = 'graft'\nblend = '{blend}'\nweighting = '{weighting}'"));
        }
    }
    all
}

/// A surface to measure from and to.
struct Surface {
    points: Vec<DVec3>,
    bvh: Bvh,
}

impl Surface {
    fn of(mesh: &TriMesh) -> Self {
        let faces: Vec<_> = (0..mesh.faces.len()).map(|i| mesh.corners(i)).collect();
        let middles = faces.iter().map(|[a, b, c]| (*a + *b + *c) / 3.0);
        Self { points: middles.chain(mesh.points.iter().copied()).collect(), bvh: Bvh::new(&faces) }
    }

    /// The input itself, far finer than the meshes measured against it.
    fn input(shape: &str, step: f64) -> Self {
        let entry: ShapeEntry =
            toml::from_str(&format!("solid = '../chairs/{shape}.toml'")).unwrap();
        let grid = GridEntry { voxel: Some(step / 3.0), ..GridEntry::default() };
        let single = Single::open(shape, entry, &grid, &recipes()).unwrap();
        let lattice = single.lattice;
        let (field, _) = single.field(&Quiet).unwrap();
        let samples = sample(&*field, lattice, &Quiet).unwrap();
        Self::of(&extract(&samples.bricks, Mesher::Cone, &Quiet).unwrap())
    }

    /// The farthest of its points from another surface, mm.
    fn farthest(&self, from: &Self) -> (f64, DVec3) {
        let stride = (self.points.len() / 6000).max(1);
        let some: Vec<_> = self.points.iter().step_by(stride).collect();
        some.par_iter()
            .map(|&&p| (from.bvh.distance(p), p))
            .reduce(|| (0.0, DVec3::ZERO), |a, b| if b.0 > a.0 { b } else { a })
    }
}

/// Fails unless the mesh lies within a voxel of the input, and the input of the mesh.
fn same(what: &str, mesh: Option<&TriMesh>, input: &Surface, voxel: f64) {
    let made = Surface::of(mesh.unwrap_or_else(|| panic!("{what}: empty")));
    let (out, back) = (made.farthest(input), input.farthest(&made));
    eprintln!("H {}: {:.2} {:.2} voxel {voxel:.2}", what.replace("\n", "; "), out.0, back.0);
    assert!(out.0 <= voxel, "{what}: {} mm off the input at {}", out.0, out.1);
    assert!(back.0 <= voxel, "{what}: misses the input by {} mm at {}", back.0, back.1);
}

#[test]
fn every_method_gives_the_inputs_back_at_its_ends() {
    let shapes = ["ladderback", "plank"];
    let keys = methods();
    let scene = scene(96, &format!("between = ['ladderback', 'plank']\n{}", hybrids(keys)));
    let step = scene.lattice.step;
    for (t, shape) in [0.0, 1.0].into_iter().zip(shapes) {
        let input = Surface::input(shape, step);
        scene.variants.par_iter().for_each(|v| {
            let made = frame(&scene, v, t);
            same(&format!("{} at {t}", v.name), made.mesh.as_ref(), &input, step);
        });
    }
}

#[test]
fn a_weight_of_one_in_a_group_gives_that_shape_back() {
    let shapes = ["ladderback", "plank", "bistro"];
    let mut keys = Vec::new();
    for shape in shapes {
        for method in [
            "method = 'linear'",
            "method = 'space-time'",
            "method = 'group'",
            "method = 'transport'",
            "method = 'warp'",
            "method = 'group'\nblend = 'fields'\ninner = 'linear'",
            "method = 'group'\ninner = 'space-time'",
        ] {
            keys.push(format!("{method}\nweights = {{ default = {{ {shape} = 2 }} }}"));
        }
    }
    let scene =
        scene(96, &format!("among = ['ladderback', 'plank', 'bistro']\n{}", hybrids(&keys)));
    let step = scene.lattice.step;
    for (shape, variants) in shapes.iter().zip(scene.variants.chunks(7)) {
        let input = Surface::input(shape, step);
        variants.par_iter().for_each(|v| {
            same(&v.name, frame(&scene, v, 0.0).mesh.as_ref(), &input, step);
        });
    }
}

/// The inner functions and blends of a graft, other than at its ends.
fn grafts() -> Vec<String> {
    let mut all = Vec::new();
    for blend in ["maps", "fields"] {
        for inner in ["linear", "space-time", "grow", "erode", "auto"] {
            all.push(format!("blend = '{blend}'\ninner = '{inner}'"));
        }
    }
    all
}

/// The methods that do not blend; their own lattices coarse, to be quick.
fn others() -> [String; 3] {
    ["method = 'level-set'", "method = 'transport'\ntransport.samples = 40", "method = 'warp'"]
        .map(str::to_owned)
}

/// Bit for bit, but where only the sign is known.
fn agree(sparse: &Bricks<f32>, dense: &Bricks<f32>) -> bool {
    sparse.bricks.iter().zip(&dense.bricks).all(|(a, b)| {
        let Brick::Band(b) = b else { return false };
        match a {
            Brick::Inside => b.iter().all(|&v| v < 0.0),
            Brick::Outside => b.iter().all(|&v| v >= 0.0),
            Brick::Band(a) => a.iter().zip(&**b).all(|(a, b)| {
                if a.is_finite() { a.to_bits() == b.to_bits() } else { (*a < 0.0) == (*b < 0.0) }
            }),
        }
    })
}

#[test]
fn sparse_is_dense_for_grafts() {
    let mut keys = grafts();
    keys.extend(others());
    keys.push("blend = 'fields'\ninner = 'linear'\nweighting = 'transfinite'".to_owned());
    keys.push("weighting = 'inverse-square'\nframes = 'plank'".to_owned());
    let scene = scene(48, &format!("between = ['windsor', 'plank']\n{}", hybrids(keys)));
    for v in &scene.variants {
        let f = field(v, 0.4);
        let sparse = sample(&*f, scene.lattice, &Quiet).unwrap();
        let dense = sample_dense(&*f, scene.lattice, &Quiet).unwrap();
        assert!(
            sparse.stats.evaluated < dense.stats.evaluated / 2,
            "{}: {:?}",
            v.name,
            sparse.stats
        );
        assert!(agree(&sparse.bricks, &dense.bricks), "{}", v.name);
        let mesh = |b| extract(b, Mesher::Cone, &Quiet).unwrap();
        assert!(mesh(&sparse.bricks) == mesh(&dense.bricks), "{}", v.name);
    }
}

/// Numbers in [-1, 1) from a linear congruence.
fn random(mut state: u64) -> impl FnMut() -> f64 {
    move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

#[test]
fn bounds_of_grafts_hold() {
    let keys = grafts().into_iter().chain(others()).chain(
        ["s", "half-cylinders"]
            .map(|f| format!("inner = 'space-time'\nspace-time = {{ form = '{f}' }}")),
    );
    let scene = scene(64, &format!("between = ['windsor', 'tubular']\n{}", hybrids(keys)));
    let room = scene.lattice.bounds();
    for (n, v) in scene.variants.iter().enumerate() {
        let f = field(v, 0.35);
        let mut next = random(n as u64);
        for i in 0..150 {
            let mut vector = || DVec3::new(next(), next(), next());
            let centre = room.centre() + vector() * room.size() * 0.5;
            // from a small part of a voxel to a good part of the chair
            let half = vector().abs() * 0.3 * 2f64.powi(i % 10);
            let bound = f.bound(&Aabb::around(centre, half));
            for _ in 0..12 {
                let p = centre + vector() * half;
                let value = f.value(p);
                assert!(bound.contains(value), "{}: {value} at {p} not in {bound:?}", v.name);
            }
        }
    }
}

#[test]
fn meshes_of_hybrids_need_no_repair() {
    let keys = [
        "method = 'linear'",
        "method = 'space-time'",
        "method = 'space-time'\nspace-time = { form = 'half-cylinders' }",
        "method = 'feature-volume'",
        "method = 'level-set'",
        "method = 'transport'\ntransport.samples = 40",
        "method = 'warp'",
        "method = 'graft'",
        "method = 'graft'\nblend = 'fields'\ninner = 'linear'\nweighting = 'transfinite'",
        "method = 'graft'\ninner = 'erode'",
        "method = 'graft'\nblend = 'fields'\ninner = 'space-time'",
    ];
    let scene = scene(64, &format!("between = ['windsor', 'ladderback']\n{}", hybrids(keys)));
    for v in &scene.variants {
        let f = field(v, 0.5);
        let samples = sample(&*f, scene.lattice, &Quiet).unwrap();
        assert!(!samples.stats.border_clipped, "{}", v.name);
        let plain = extract(&samples.bricks, Mesher::Cone, &Quiet).unwrap();
        let sharp = extract_sharp(&samples.bricks, &*f, &Quiet).unwrap();
        for (mesh, how) in [(plain, "cone"), (sharp, "sharp")] {
            let health = inspect(&mesh, &Options { self_intersections: true });
            assert!(health.triangles > 1000, "{} {how}: {}", v.name, health.triangles);
            assert!(
                health.closed && health.manifold_edges && health.manifold_vertices,
                "{} {how}: {:?}",
                v.name,
                health.reasons
            );
            assert!(health.oriented, "{} {how}", v.name);
            assert_eq!(health.self_intersections, Some(0), "{} {how}", v.name);
        }
    }
}

/// Separate patches of the mesh that lie in its lowest hundredth.
fn feet(mesh: &TriMesh) -> usize {
    let bounds = mesh.bounds();
    let low = bounds.min.z + 0.01 * bounds.size().z;
    let floor = |f: &&[u32; 3]| f.iter().any(|&v| mesh.points[v as usize].z < low);
    let faces: Vec<[u32; 3]> = mesh.faces.iter().filter(floor).copied().collect();
    let mut parent: Vec<u32> = (0..mesh.points.len() as u32).collect();
    fn root(parent: &mut [u32], mut i: u32) -> u32 {
        while parent[i as usize] != i {
            parent[i as usize] = parent[parent[i as usize] as usize];
            i = parent[i as usize];
        }
        i
    }
    for [a, b, c] in &faces {
        let a = root(&mut parent, *a);
        for v in [b, c] {
            let v = root(&mut parent, *v);
            parent[v as usize] = a;
        }
    }
    let roots: std::collections::BTreeSet<u32> =
        faces.iter().map(|f| root(&mut parent, f[0])).collect();
    roots.len()
}

/// One piece, standing on four feet, nothing to repair.
fn stands(what: &str, made: &FrameResult) {
    let report = &made.report;
    let health = report.health.as_ref().unwrap_or_else(|| panic!("{what}: {:?}", report.error));
    assert!(health.printable, "{what}: {:?}", health.reasons);
    assert_eq!(report.pieces, Some(1), "{what}");
    assert_eq!(made.mesh.as_ref().map(feet), Some(4), "{what}");
}

#[test]
fn parts_of_different_chairs_stand_as_one() {
    let keys = [
        "weights = { default = { lounge = 1 }, back = { plank = 1 } }",
        "weights = { default = { plank = 1 }, back = { shell = 1 } }",
        "weights = { default = { lounge = 1 }, seat = { plank = 1 }, back = { shell = 1 } }",
        "frames = 'dominant'\nweights = { default = { plank = 1 }, back = { lounge = 1 } }",
    ];
    let morph = "method = 'group'\namong = ['lounge', 'plank', 'shell']\n";
    let scene = scene(96, &(morph.to_owned() + &hybrids(keys)));
    scene.variants.par_iter().for_each(|v| stands(&v.name, &frame(&scene, v, 0.0)));
}

#[test]
fn a_group_of_three_is_one_chair() {
    let keys = [
        "weights = { default = { lounge = 1, plank = 1, shell = 1 } }",
        "weights = { default = { lounge = 1, plank = 2, shell = 3 }, back = { plank = 1, shell = 1 } }",
        "weights = { default = { plank = 3, shell = 1 }, seat = { lounge = 1, shell = 1 } }",
    ];
    let morph = "method = 'group'\namong = ['lounge', 'plank', 'shell']\n";
    let scene = scene(96, &(morph.to_owned() + &hybrids(keys)));
    scene.variants.par_iter().for_each(|v| stands(&v.name, &frame(&scene, v, 0.0)));
}

#[test]
fn a_graft_stays_one_chair_all_the_way() {
    let scene = scene(96, "between = ['windsor', 'plank']\nt = [0, 0.2, 0.4, 0.5, 0.6, 0.8, 1]\n");
    let v = &scene.variants[0];
    v.times.par_iter().for_each(|&t| stands(&format!("t = {t}"), &frame(&scene, v, t)));
}

/// Takes out what differs from run to run.
fn settle(value: &mut serde_json::Value) {
    const OWN: [&str; 3] = ["threads", "arguments", "peak_memory_mb"];
    if let Some(all) = value.as_object_mut() {
        all.retain(|k, _| !k.starts_with("seconds") && !OWN.contains(&k.as_str()));
        all.values_mut().for_each(settle);
    } else if let Some(all) = value.as_array_mut() {
        all.iter_mut().for_each(settle);
    }
}

/// The mesh, the picture and the report of a run.
fn written(dir: &Path) -> (Vec<u8>, Vec<u8>, serde_json::Value) {
    let read = |file: &str| fs::read(dir.join(file)).unwrap();
    let names = fs::read_dir(dir).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    let report = names.into_iter().find(|n| n.ends_with("run.json")).unwrap();
    let mut report: serde_json::Value = serde_json::from_slice(&read(&report)).unwrap();
    settle(&mut report);
    (read("heir.stl"), read("heir.png"), report)
}

#[test]
fn a_run_is_the_same_on_one_thread_and_on_two() {
    let morph = "among = ['windsor', 'plank', 'shell']\ninner = 'auto'\n[morph.weights]\n\
                 back = { windsor = 1, shell = 2 }\n\
                 [output]\nmesh = 'heir.stl'\npicture = 'heir.png'\n";
    let solids = recipes().join("../chairs").display().to_string();
    let made = ["1", "2"].map(|threads| {
        let folder = Folder::new();
        folder.put("heir.toml", &text(64, morph).replace("../chairs", &solids));
        folder.run(&["run", "heir.toml", "--threads", threads, "--verify"]).ends(0);
        written(folder.path())
    });
    let [one, two] = made;
    assert!(one.0.len() > 10_000 && one.1.len() > 1000);
    assert!(one.0 == two.0, "meshes differ");
    assert!(one.1 == two.1, "pictures differ");
    assert_eq!(one.2, two.2);
}

#[test]
fn other_methods_are_the_same_on_one_thread_and_on_two() {
    let solids = recipes().join("../chairs").display().to_string();
    let methods = ["level-set", "transport", "warp"];
    let hybrids: String =
        methods.iter().map(|m| format!("[[hybrids]]\nname = '{m}'\nmethod = '{m}'\n")).collect();
    let morph = format!(
        "between = ['windsor', 'plank']\nt = 0.4\ntransport.samples = 40\n{hybrids}\
         [output]\nmesh = '{{name}}.stl'\n"
    );
    let made = ["1", "2"].map(|threads| {
        let folder = Folder::new();
        folder.put("pair.toml", &text(48, &morph).replace("../chairs", &solids));
        folder.run(&["run", "pair.toml", "--threads", threads]).ends(0);
        methods.map(|m| fs::read(folder.join(&format!("{m}.stl"))).unwrap())
    });
    for (m, (one, two)) in methods.iter().zip(made[0].iter().zip(&made[1])) {
        assert!(one.len() > 10_000 && one == two, "{m}: meshes differ");
    }
}

/// The lattice is the same for all hybrids of a recipe, and holds each of them.
#[test]
fn hybrids_of_a_recipe_fit_their_lattice() {
    let scene = scene(48, "between = ['lounge', 'shell']\nframes = 'shell'\n");
    let f = field(&scene.variants[0], 0.5);
    let samples = sample(&*f, scene.lattice, &Quiet).unwrap();
    assert!(!samples.stats.border_clipped);
    let wide = scene.lattice.bounds().grow(200.0);
    let samples = sample(&*f, Lattice::covering(&wide, scene.lattice.step), &Quiet).unwrap();
    let mesh = extract(&samples.bricks, Mesher::Cone, &Quiet).unwrap();
    let (all, lattice) = (mesh.bounds(), scene.lattice.bounds());
    assert!(lattice.contains(all.min) && lattice.contains(all.max), "{all:?} {lattice:?}");
}
