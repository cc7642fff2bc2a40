use crate::util::{Folder, block};
use serde_json::Value;
use std::fs;
use std::path::PathBuf;

/// A square of 40 mm in the plane of x and z that turns over: half way it is a line.
const FLIP: [&str; 2] = [
    "kind = \"nurbs\"\ndegree = [1]\nknots_u = [0, 0, 1, 2, 3, 4, 4]\n\
     net = [[[0, 0, 0, 1], [40, 0, 0, 1], [40, 0, 40, 1], [0, 0, 40, 1], [0, 0, 0, 1]]]\n",
    "kind = \"nurbs\"\ndegree = [1]\nknots_u = [0, 0, 1, 2, 3, 4, 4]\n\
     net = [[[0, 0, 0, 1], [0, 0, 40, 1], [40, 0, 40, 1], [40, 0, 0, 1], [0, 0, 0, 1]]]\n",
];

fn surface(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("data/surfaces").join(name)
}

fn json(folder: &Folder, file: &str) -> Value {
    serde_json::from_str(&fs::read_to_string(folder.join(file)).unwrap()).unwrap()
}

#[test]
fn a_surface_file_is_a_recipe_of_one_shape() {
    let folder = Folder::new();
    let bottle = surface("klein-bottle.toml");
    let bottle = bottle.to_str().unwrap();
    folder.run(&["run", bottle, "-o", "out"]).fails(3, &["klein-bottle.toml", "one side only"]);
    let set = "grid.resolution=40";
    let args = ["run", bottle, "--thickness", "12", "-t", "0.5", "--set", set, "-o", "out"];
    let args = [&args[..], &["--strict"]].concat();
    folder.run(&args).ends(0);
    let health = &json(&folder, "out/run.json")["frames"][0]["health"];
    assert_eq!(health["closed"], true);
    assert_eq!(health["printable"], true);
    assert!(folder.join("out/klein-bottle.stl").is_file());
    // the same on any number of threads
    for n in ["1", "2"] {
        let out = format!("out-{n}");
        let args = ["--threads", n, "run", bottle, "--thickness", "12", "--set", set, "-o", &out];
        folder.run(&args).ends(0);
    }
    let [one, two] = ["out-1", "out-2"].map(|o| folder.join(o).join("klein-bottle.stl"));
    assert_eq!(fs::read(one).unwrap(), fs::read(two).unwrap());
    let e = folder.run(&["run", bottle, "--thickness", "-1", "-o", "o"]);
    e.fails(2, &["more than 0"]);
}

#[test]
fn a_time_without_a_shape_does_not_stop_the_others() {
    let folder = Folder::new();
    folder.put("a.toml", FLIP[0]);
    folder.put("b.toml", FLIP[1]);
    folder.put("flip.toml", "kind = \"nurbs-morph\"\ntargets = [\"a.toml\", \"b.toml\"]\n");
    let set = ["--set", "grid.resolution=24"];
    let args = ["run", "flip.toml", "--thickness", "10", "-t", "0:1:0.5", "-o", "out"];
    let ran = folder.run(&[&args[..], &set].concat());
    ran.fails(1, &["1 of 3 frames failed", "flip", "t = 0.5", "no area"]);
    let frames = json(&folder, "out/run.json")["frames"].clone();
    for i in [0, 2] {
        let volume = frames[i]["health"]["volume_mm3"].as_f64().unwrap();
        assert!((volume / 16_000.0 - 1.0).abs() < 0.05, "{volume}");
    }
    assert!(frames[1]["error"].is_string() && frames[1]["file"].is_null());
    assert!(folder.join("out/flip-1.stl").is_file());
}

#[test]
fn surfaces_stand_beside_meshes() {
    let folder = Folder::new();
    folder.put("a.toml", FLIP[0]);
    folder.put("box.obj", &block([0.0, 0.0, 20.0], [20.0, 5.0, 20.0]));
    let args = ["convert", "a.toml", "a.stl", "--thickness", "10", "--resolution", "24"];
    folder.run(&args).ends(0);
    let volume = json(&folder, "a.run.json")["frames"][0]["health"]["volume_mm3"].clone();
    assert!((volume.as_f64().unwrap() / 16_000.0 - 1.0).abs() < 0.05, "{volume}");
    folder.run(&["convert", "a.toml", "b.stl"]).fails(3, &["a.toml", "curve", "`thickness`"]);
    folder.run(&["convert", "box.obj", "b.stl", "--thickness", "4"]).fails(3, &["`thicken`"]);
    // one value for all is for those that can have it
    let args = ["morph", "a.toml", "box.obj", "--thickness", "10", "--up", "z", "-o", "m.stl"];
    folder.run(&[&args[..], &["--resolution", "24"]].concat()).ends(0);
    let volume = json(&folder, "m.run.json")["frames"][0]["health"]["volume_mm3"].clone();
    assert!((volume.as_f64().unwrap() / 16_000.0 - 1.0).abs() < 0.05, "{volume}");
    let args = ["picture", "a.toml", "--thickness", "10", "-o", "a.png", "--size", "64x64"];
    folder.run(&args).ends(0);
    let plate = surface("dynamic-plate.toml");
    let args = ["picture", plate.to_str().unwrap(), "-o", "b.png", "--size", "64x64", "--at", "1"];
    folder.run(&args).ends(0);
}
