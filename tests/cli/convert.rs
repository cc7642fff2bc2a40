use crate::util::{Folder, block};
use serde_json::Value;
use std::fs;

const STOOL: &str = r#"kind = "solid"
[[parts]]
name = "seat"
cylinder = { from = [0, 0, 400], to = [0, 0, 440], radius = 180 }
[[parts]]
name = "leg"
cylinder = { from = [-120, -120, 0], to = [-90, -90, 420], radius = 20 }
taper = 0.8
mirror = "xy"
"#;

fn health(folder: &Folder, file: &str) -> Value {
    let ran = folder.run(&["check", file, "--json", "-q"]).ends(0);
    serde_json::from_str(&ran.stdout()).unwrap()
}

#[test]
fn shells_that_overlap_become_one_printable_solid() {
    let folder = Folder::new();
    // two boxes of 40 x 20 x 20 that share 20 x 20 x 20: together 60 x 20 x 20
    let mut text = block([-10.0, 0.0, 0.0], [20.0, 10.0, 10.0]);
    let shifted = |l: &str| match l.strip_prefix("f ") {
        Some(f) => f
            .split(' ')
            .fold("f".to_owned(), |t, i| format!("{t} {}", i.parse::<u32>().unwrap() + 8)),
        None => l.to_owned(),
    };
    for line in block([10.0, 0.0, 0.0], [20.0, 10.0, 10.0]).lines() {
        text += &(shifted(line) + "\n");
    }
    folder.put("two.obj", &text);
    let args = ["convert", "two.obj", "one.stl", "--up", "z", "--resolution", "60", "--strict"];
    folder.run(&args).ends(0);
    let h = health(&folder, "one.stl");
    assert_eq!((&h["printable"], &h["components"]), (&Value::Bool(true), &Value::from(1)));
    // edges lose less than half a cell on every side: 24000 mm3 within 3%
    let volume = h["volume_mm3"].as_f64().unwrap();
    assert!((volume / 24000.0 - 1.0).abs() < 0.03, "{volume}");
    assert_eq!(folder.names(), ["one.run.json", "one.stl", "two.obj"]);
    let header = fs::read(folder.join("one.stl")).unwrap();
    assert!(header[..80].windows(8).any(|w| w == b"UNITS=mm"));
}

#[test]
fn a_solid_is_one_closed_piece_or_its_raw_shells() {
    let folder = Folder::new();
    folder.put("stool.toml", STOOL);
    folder.run(&["convert", "stool.toml", "stool.ply", "--resolution", "64"]).ends(0);
    let h = health(&folder, "stool.ply");
    assert_eq!((&h["printable"], &h["components"]), (&Value::Bool(true), &Value::from(1)));
    folder.run(&["convert", "stool.toml", "raw.obj", "--shells"]).ends(0);
    let h = health(&folder, "raw.obj");
    assert_eq!(h["components"], 5, "a seat and four legs");
    assert_eq!(h["printable"], false, "they cut each other");
}

#[test]
fn a_field_is_written_with_its_place() {
    let folder = Folder::new();
    folder.put("a.obj", &block([0.0; 3], [10.0; 3]));
    folder.run(&["convert", "a.obj", "a.npy", "--up", "z", "--voxel", "2.5"]).ends(0);
    let about: Value =
        serde_json::from_str(&fs::read_to_string(folder.join("a.json")).unwrap()).unwrap();
    let size: Vec<usize> =
        about["size"].as_array().unwrap().iter().map(|n| n.as_u64().unwrap() as usize).collect();
    let bytes = fs::read(folder.join("a.npy")).unwrap();
    let start = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let values: Vec<f32> = bytes[start..]
        .chunks_exact(4)
        .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
        .collect();
    assert_eq!(values.len(), size.iter().product::<usize>());
    let least = values.iter().copied().fold(f32::INFINITY, f32::min);
    // the middle is 10 mm deep, and a sample lies within half a cell's diagonal of it
    assert!((-10.0..=-10.0 + 2.2).contains(&least), "{least}");
}

#[test]
fn sheets_need_a_thickness() {
    let folder = Folder::new();
    folder.put("sheet.obj", "v 0 0 0\nv 100 0 0\nv 100 100 0\nv 0 100 0\nf 1 2 3 4\n");
    let args = ["convert", "sheet.obj", "out.stl", "--up", "z", "--resolution", "40"];
    folder.run(&args).fails(3, &["thicken"]);
    assert_eq!(folder.names(), ["sheet.obj"]);
    folder.run(&[&args[..], &["--thicken", "10"]].concat()).ends(0);
    assert_eq!(health(&folder, "out.stl")["printable"], true);
}
