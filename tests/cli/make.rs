use crate::util::{Folder, block};
use serde_json::Value;
use std::fs;

/// Two boxes, one lying and one standing, both on the floor.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.put("low.obj", &block([0.0, 0.0, 5.0], [10.0, 10.0, 5.0]));
    folder.put("tall.obj", &block([100.0, 0.0, 15.0], [5.0, 5.0, 15.0]));
    folder
}

fn json(folder: &Folder, file: &str) -> Value {
    serde_json::from_str(&fs::read_to_string(folder.join(file)).unwrap()).unwrap()
}

#[test]
fn morph_makes_a_mesh_a_time_and_a_report() {
    let folder = folder();
    let args = [
        "morph",
        "low.obj",
        "tall.obj",
        "--up",
        "z",
        "-t",
        "0:1:0.5",
        "-o",
        "h-{t}.stl",
        "--resolution",
        "40",
        "--picture",
        "h-{t}.png",
        "--strict",
        "--json",
    ];
    let ran = folder.run(&args).ends(0);
    let expected = [
        "h-0.5.png",
        "h-0.5.stl",
        "h-0.png",
        "h-0.stl",
        "h-1.png",
        "h-1.stl",
        "h.run.json",
        "h.toml",
        "low.obj",
        "tall.obj",
    ];
    assert_eq!(folder.names(), expected);
    let report = json(&folder, "h.run.json");
    assert_eq!(serde_json::from_str::<Value>(&ran.stdout()).unwrap(), report);
    let frames = report["frames"].as_array().unwrap();
    assert_eq!(frames.len(), 3);
    for f in frames {
        assert_eq!(f["health"]["printable"], true, "{ran}");
        assert_eq!(f["health"]["self_intersections"], 0);
        assert_eq!(f["pieces"], 1);
    }
    // the ends are the inputs: 4000 and 3000 mm3, all edges a little blunt
    for (f, volume) in [(&frames[0], 4000.0), (&frames[2], 3000.0)] {
        let got = f["health"]["volume_mm3"].as_f64().unwrap();
        assert!((got / volume - 1.0).abs() < 0.06, "{got} for {volume}");
        assert!((f["volume_kept"].as_f64().unwrap() - 1.0).abs() < 0.06, "{f}");
    }
    // laid over each other by their boxes, the second stands where the first does
    let x = frames[2]["health"]["bbox_mm"][1][0].as_f64().unwrap();
    assert!((x - 5.0).abs() < 1.0, "{x}");
    assert_eq!(report["inputs"].as_array().unwrap().len(), 2);
    assert_eq!(report["inputs"][0]["sha256"].as_str().unwrap().len(), 64);
}

#[test]
fn the_same_bytes_on_any_number_of_threads_and_from_the_written_recipe() {
    let folder = folder();
    let args = |threads: &'static str, out: &'static str| {
        [
            "morph",
            "low.obj",
            "tall.obj",
            "--method",
            "space-time",
            "--up",
            "z",
            "-o",
            out,
            "--resolution",
            "40",
            "--threads",
            threads,
        ]
    };
    folder.run(&args("1", "one.ply")).ends(0);
    folder.run(&[&args("3", "three.ply")[..], &["--recipe", "r.toml"]].concat()).ends(0);
    let bytes = |name: &str| fs::read(folder.join(name)).unwrap();
    assert!(bytes("one.ply") == bytes("three.ply"), "other bytes on other threads");
    folder.run(&["run", "r.toml", "-o", "out", "--set", "output.mesh=again.ply"]).ends(0);
    let (a, b) = (json(&folder, "one.run.json"), json(&folder, "out/run.json"));
    assert_eq!(a["frames"][0]["health"], b["frames"][0]["health"]);
}

#[test]
fn setting_the_resolution_replaces_the_voxel_and_back() {
    let folder = folder();
    let args = ["morph", "low.obj", "tall.obj", "--up", "z", "-o", "h.stl", "--voxel", "3"];
    folder.run(&[&args[..], &["--recipe", "r.toml"]].concat()).ends(0);
    let voxel = |set: &str| {
        let ran = folder.run(&["run", "r.toml", "--set", set, "--dry-run", "--json"]).ends(0);
        serde_json::from_str::<Value>(&ran.stdout()).unwrap()["voxel_mm"].as_f64().unwrap()
    };
    let longest = 48.0 * voxel("grid.resolution=48");
    assert!((24.0 * voxel("grid.resolution=24") - longest).abs() < 1e-9);
    assert_eq!(voxel("grid.voxel=2.5"), 2.5);
}

#[test]
fn a_dry_run_predicts_and_writes_nothing() {
    let folder = folder();
    let args = ["morph", "low.obj", "tall.obj", "--up", "z", "--resolution", "64", "-o", "h.stl"];
    let ran = folder.run(&[&args[..], &["--dry-run", "--json"]].concat()).ends(0);
    assert_eq!(folder.names(), ["low.obj", "tall.obj"]);
    let p: Value = serde_json::from_str(&ran.stdout()).unwrap();
    let made = folder.run(&[&args[..], &["--json"]].concat()).ends(0);
    let report: Value = serde_json::from_str(&made.stdout()).unwrap();
    let frame = &report["frames"][0];
    for (key, got) in [
        ("triangles", &frame["health"]["triangles"]),
        ("active_bricks", &frame["active_bricks"]),
        ("file_bytes", &frame["file_bytes"]),
    ] {
        let ratio = p[key].as_f64().unwrap() / got.as_f64().unwrap();
        assert!((0.4..2.5).contains(&ratio), "{key}: {p} against {got}");
    }
}

const GROUP: &str = r#"version = 1
name = "three"
[grid]
resolution = 32
[shapes.a]
solid = { parts = [{ box = { center = [0, 0, 5], size = [20, 20, 10] } }] }
[shapes.b]
solid = { parts = [{ cylinder = { from = [0, 0, 0], to = [0, 0, 20], radius = 10 } }] }
[shapes.c]
solid = { parts = [{ ellipsoid = { center = [0, 0, 10], size = [24, 16, 20] } }] }
[[features]]
name = "body"
on.a.box = { center = [0, 0, 5], size = [22, 22, 12] }
on.b.cylinder = { from = [0, 0, -1], to = [0, 0, 21], radius = 11 }
on.c.ellipsoid = { center = [0, 0, 10], size = [26, 18, 22] }
[morph]
method = "group"
among = ["a", "b", "c"]
[morph.weights]
default = { a = 1, b = 1, c = 1 }
[[hybrids]]
name = "even"
[[hybrids]]
name = "mostly-b"
weights = { body = { b = 1 } }
[output]
mesh = "meshes/{name}.stl"
picture = "{name}.png"
"#;

#[test]
fn a_group_makes_every_hybrid_and_a_weight_of_one_gives_the_shape() {
    let folder = Folder::new();
    folder.put("g.toml", GROUP);
    let ran = folder.run(&["run", "g.toml", "-o", "out", "--strict"]).ends(0);
    let report = json(&folder, "out/run.json");
    let frames = report["frames"].as_array().unwrap();
    let names: Vec<&str> = frames.iter().map(|f| f["hybrid"].as_str().unwrap()).collect();
    assert_eq!(names, ["even", "mostly-b"]);
    assert!(folder.join("out/meshes/even.stl").is_file() && folder.join("out/even.png").is_file());
    // the cylinder: pi 10² 20 = 6283 mm3
    let volume = frames[1]["health"]["volume_mm3"].as_f64().unwrap();
    assert!((volume / 6283.2 - 1.0).abs() < 0.03, "{volume}\n{ran}");
    folder.run(&["run", "g.toml", "-o", "out"]).fails(2, &["--force"]);
    folder.run(&["run", "g.toml", "-o", "two", "--only", "evn"]).fails(2, &["`even`"]);
    folder.run(&["run", "g.toml", "-o", "two", "--only", "even"]).ends(0);
    assert!(!folder.join("two/meshes/mostly-b.stl").exists());
}

#[test]
fn an_empty_result_fails_and_the_others_are_made() {
    let folder = folder();
    // laid far apart, the mean of two distances is positive everywhere in between
    let args = [
        "morph",
        "low.obj",
        "tall.obj",
        "--up",
        "z",
        "--align",
        "none",
        "--method",
        "linear",
        "-t",
        "0,0.5,1",
        "-o",
        "h-{t}.stl",
        "--voxel",
        "1",
    ];
    folder.run(&args).fails(1, &["1 of 3 frames failed", "empty"]);
    let expected = ["h-0.stl", "h-1.stl", "h.run.json", "low.obj", "tall.obj"];
    assert_eq!(folder.names(), expected);
    let report = json(&folder, "h.run.json");
    assert!(report["frames"][1]["error"].as_str().unwrap().contains("empty"));
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_leaves_no_half_file() {
    use std::process::{Command, Stdio};
    use std::time::Duration;
    let folder = folder();
    let args = [
        "morph",
        "low.obj",
        "tall.obj",
        "--method",
        "space-time",
        "--up",
        "z",
        "-t",
        "0:1:0.01",
        "-o",
        "h-{t}.stl",
        "--resolution",
        "128",
    ];
    let mut child =
        folder.command(&args).stderr(Stdio::null()).stdout(Stdio::null()).spawn().unwrap();
    // once a first frame is there, the handler certainly is
    while !folder.join("h-0.stl").exists() && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(5));
    }
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    for name in folder.names() {
        let whole = name.starts_with("h-") && name.ends_with(".stl");
        assert!(whole || name.ends_with(".obj"), "left behind: {name}");
        if whole {
            let bytes = fs::read(folder.join(&name)).unwrap();
            let count = u32::from_le_bytes([bytes[80], bytes[81], bytes[82], bytes[83]]);
            assert_eq!(bytes.len(), 84 + 50 * count as usize, "{name}");
        }
    }
}
