use crate::util::Folder;
use serde_json::Value;
use std::fs;

/// A ball becomes two bars: from one piece to two.
const RECIPE: &str = r#"version = 1
name = "ball x bars"
[grid]
resolution = 24
[shapes.ball]
solid = { parts = [{ ellipsoid = { center = [0, 0, 10], size = [20, 20, 20] } }] }
[shapes.bars]
solid = { parts = [{ box = { center = [-8, 0, 10], size = [8, 16, 20] } }, { box = { center = [8, 0, 10], size = [8, 16, 20] } }] }
[morph]
method = "linear"
between = ["ball", "bars"]
t = [0.0, 0.5, 1.0]
[output]
mesh = "{t}.stl"
animation = ["play/morph.webp", "{name}.gif", "morph.glb"]
fps = 4
"#;

fn folder() -> Folder {
    let folder = Folder::new();
    folder.put("r.toml", RECIPE);
    folder
}

/// The JSON of a GLB.
fn document(bytes: &[u8]) -> Value {
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    serde_json::from_slice(&bytes[20..20 + length]).unwrap()
}

#[test]
fn a_run_plays_its_frames_in_every_file_it_names() {
    let folder = folder();
    let ran = folder.run(&["run", "r.toml", "-o", "out", "--json"]).ends(0);
    let report: Value = serde_json::from_str(&ran.stdout()).unwrap();
    let animations = report["animations"].as_array().unwrap();
    assert_eq!(animations.len(), 3, "{ran}");
    for (animation, name) in
        animations.iter().zip(["play/morph.webp", "ball x bars.gif", "morph.glb"])
    {
        let path = folder.join("out").join(name);
        let bytes = fs::metadata(&path).unwrap().len();
        assert_eq!(animation["file_bytes"], bytes, "{name}");
        assert!(animation["file"].as_str().unwrap().ends_with(name));
        assert_eq!((&animation["frames"], &animation["turns"]), (&3.into(), &4.into()));
        assert!(ran.stderr().contains(name) && ran.stderr().contains("1.0 s at 4"), "{ran}");
    }
    let glb = document(&fs::read(folder.join("out/morph.glb")).unwrap());
    let nodes = glb["nodes"].as_array().unwrap();
    let names: Vec<&str> = nodes.iter().filter_map(|n| n["name"].as_str()).collect();
    assert_eq!(names, ["t 0", "t 0.5", "t 1"]);
    assert_eq!(glb["animations"][0]["channels"].as_array().unwrap().len(), 3);
    // what plays nothing sees the ball
    let ball = folder.run(&["check", "out/0.stl", "out/morph.glb", "--json"]);
    let both: Vec<Value> =
        ball.stdout().lines().map(|l| serde_json::from_str(l).unwrap()).collect();
    assert_eq!(both[0]["triangles"], both[1]["triangles"], "{ball}");
    folder.run(&["run", "r.toml", "-o", "out"]).fails(2, &["--force"]);
}

#[test]
fn animations_have_the_same_bytes_on_any_number_of_threads() {
    let folder = folder();
    folder.run(&["run", "r.toml", "-o", "one", "--threads", "1"]).ends(0);
    folder.run(&["run", "r.toml", "-o", "three", "--threads", "3"]).ends(0);
    for name in ["play/morph.webp", "ball x bars.gif", "morph.glb"] {
        let bytes = |folder_name: &str| fs::read(folder.join(folder_name).join(name)).unwrap();
        assert_eq!(bytes("one"), bytes("three"), "{name}");
    }
}

#[test]
fn one_frame_makes_no_animation_and_a_bad_name_is_refused() {
    let folder = folder();
    let ran = folder.run(&["run", "r.toml", "-o", "one", "-t", "0.5"]).ends(0);
    assert!(ran.stderr().contains("a single frame does not move"), "{ran}");
    assert!(!folder.join("one/morph.glb").exists() && folder.join("one/0.5.stl").exists());
    folder.run(&["run", "r.toml", "-o", "two", "--dry-run"]).ends(0);
    assert!(!folder.join("two").exists());
    let refused = |value: &str, expected: &[&str]| {
        let set = format!("output.animation={value}");
        folder.run(&["run", "r.toml", "-o", "two", "--set", &set]).fails(3, expected);
    };
    refused("\"a.mp4\"", &["output.animation", "a.mp4", ".webp"]);
    refused("[\"a.glb\", \"{t}.gif\"]", &["output.animation[1]", "no {t}"]);
    refused("[\"a.glb\", \"b.glb\"]", &["output.animation[1]", "another .glb"]);
    refused("\"../a.glb\"", &["output.animation", "leaves the output folder"]);
    let fps = ["run", "r.toml", "-o", "two", "--set", "output.fps=0"];
    folder.run(&fps).fails(3, &["output.fps", "0.1 to 50"]);
    let many = ["run", "r.toml", "-o", "two", "-t", "0:1:0.0005"];
    folder.run(&many).fails(5, &["2001 frames", "at most 1000"]);
    assert!(!folder.join("two").exists());
}

/// A vase of one row of points that gets wider.
const VASE: &str = r#"kind = "blend"
beta = 1.0
gamma = 12.1
lambda = 1.0
rho = 1.0
eta = 1.0
v = [0.0, 6.283185307179586]
[at-0]
position = ["(1 + t) * 10 * cos(v)", "(1 + t) * 10 * sin(v)", "0"]
tangent = ["0", "0", "20"]
[at-1]
position = ["10 * cos(v)", "10 * sin(v)", "20"]
tangent = ["0", "0", "20"]
"#;

#[test]
fn a_surface_that_moves_becomes_one_mesh_with_targets() {
    let folder = Folder::new();
    folder.put("vase.toml", VASE);
    let args = ["surface", "vase.toml", "--samples", "5x9", "-t", "0:1:0.25", "-o", "m.glb"];
    let ran = folder.run(&[&args[..], &["--json"]].concat()).ends(0);
    let report: Value = serde_json::from_str(&ran.stdout()).unwrap();
    let bytes = fs::read(folder.join("m.glb")).unwrap();
    assert_eq!(report["motion"]["file_bytes"], bytes.len());
    let glb = document(&bytes);
    let mesh = &glb["meshes"][0];
    let targets = mesh["primitives"][0]["targets"].as_array().unwrap();
    assert_eq!(targets.len(), 4);
    let names = &mesh["extras"]["targetNames"];
    assert_eq!(*names, serde_json::json!(["t 0.25", "t 0.5", "t 0.75", "t 1"]));
    // the last pose is wider by 10 mm at the foot, in x from 10 to 20
    let reach = |i: &Value, key: &str| {
        glb["accessors"][i.as_u64().unwrap() as usize][key][0].as_f64().unwrap()
    };
    let base = &mesh["primitives"][0]["attributes"]["POSITION"];
    assert!((reach(base, "max") - 10.0).abs() < 1.0, "{}", reach(base, "max"));
    let moved = reach(&targets[3]["POSITION"], "max");
    assert!((moved - 10.0).abs() < 1.0, "{moved}");
    folder.run(&args).fails(2, &["--force"]);
    folder.run(&[&args[..], &["--force", "--derivatives"]].concat()).fails(2, &["{t}"]);
}
