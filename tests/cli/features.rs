use crate::util::Folder;
use serde_json::Value;
use std::fs;
use std::path::Path;

fn chair(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data/chairs").join(name).display().to_string()
}

fn found(folder: &Folder, args: &[&str]) -> Value {
    let args = [&["features", "suggest", "--json"], args].concat();
    serde_json::from_str(&folder.run(&args).ends(0).stdout()).unwrap()
}

/// Our own chairs, of which everything is known: seat height (mm), arms.
#[test]
fn our_chairs_are_understood() {
    let folder = Folder::new();
    let known = [
        ("bistro.obj", 455.0, "no arms"),
        ("ladderback.ply", 443.0, "no arms"),
        ("lounge.glb", 430.0, "two arms"),
        ("plank.stl", 450.0, "no arms"),
        ("shell.ply", 450.0, "no arms"),
        ("tubular.stl", 450.0, "two arms"),
        ("windsor.obj", 458.0, "two arms"),
    ];
    let files: Vec<String> = known.iter().map(|k| chair(k.0)).collect();
    let mut args: Vec<&str> = files.iter().map(String::as_str).collect();
    args.extend(["--thicken", "0,0,0,0,0,22,0"]);
    let all = found(&folder, &args);
    for (shape, (file, seat, arms)) in all["shapes"].as_array().unwrap().iter().zip(known) {
        let words = shape["found"].as_str().unwrap();
        assert!(words.contains("four legs") && words.contains("a back"), "{file}: {words}");
        assert!(words.contains(arms), "{file}: {words}");
        let high = shape["seat_mm"].as_f64().unwrap();
        assert!((high - seat).abs() < 20.0, "{file}: seat {high}, expected {seat}");
        assert!(shape["confidence"].as_f64().unwrap() > 0.7, "{file}: {words}");
        assert_eq!(shape["turn_deg"], 0.0, "{file}");
    }
    assert_eq!(all["features"].as_array().unwrap().len(), 8, "seat, back, two arms, four legs");
}

/// The recipe that is written runs, whatever the order of the meshes, and stands every chair on the floor.
#[test]
fn the_suggested_recipe_runs() {
    let folder = Folder::new();
    let (a, b) = (chair("plank.stl"), chair("shell.ply"));
    let file = "sub/pair.toml";
    folder.run(&["features", "suggest", &a, &b, "-o", file, "--picture", "sheet.png"]).ends(0);
    let text = fs::read_to_string(folder.join(file)).unwrap();
    assert!(text.contains("name = \"leg front left\"") && text.contains("method = \"graft\""));
    let again = folder.run(&["features", "suggest", &a, &b, "-o", file]);
    again.fails(2, &["pair.toml", "--force"]);
    folder.run(&["features", "suggest", &a, &b, "-o", file, "--force", "--threads", "1"]).ends(0);
    assert_eq!(fs::read_to_string(folder.join(file)).unwrap(), text, "the same on one thread");
    let run = ["run", file, "-t", "0.5", "--set", "grid.resolution=48", "--json"];
    let ran: Value = serde_json::from_str(&folder.run(&run).ends(0).stdout()).unwrap();
    assert_eq!(ran["frames"][0]["pieces"], 1);
    let swapped = found(&folder, &[&b, &a]);
    let straight = found(&folder, &[&a, &b]);
    let names = |v: &Value| -> Vec<String> {
        let of = |f: &Value| f["name"].as_str().unwrap().to_owned();
        v["features"].as_array().unwrap().iter().map(of).collect()
    };
    assert_eq!(names(&swapped), names(&straight));
    assert_eq!(swapped["shapes"][1], straight["shapes"][0]);
}

#[test]
fn what_is_no_chair_gets_slabs_and_is_said_so() {
    let folder = Folder::new();
    folder.put("box.obj", &crate::util::block([0.0; 3], [40.0, 40.0, 50.0]));
    let ran = folder.run(&["features", "suggest", "box.obj", "-o", "r.toml"]).ends(0);
    assert!(ran.stdout().contains("no chair"), "{ran}");
    assert!(fs::read_to_string(folder.join("r.toml")).unwrap().contains("name = \"middle\""));
}
