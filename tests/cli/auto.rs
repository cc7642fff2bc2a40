//! `morph` with its defaults: parts found, parameters searched, the recipe written.

use crate::util::Folder;
use serde_json::Value;
use std::fs;

/// Two chairs that differ in every part: round legs and spindles, square legs and a panel.
fn chairs() -> Folder {
    let folder = Folder::new();
    let windsor = r#"kind = "solid"
[[parts]]
box = { center = [0, 0, 435], size = [420, 400, 40] }
[[parts]]
cylinder = { from = [170, 165, 0], to = [150, 150, 430], radius = 18 }
mirror = "xy"
[[parts]]
cylinder = { from = [160, 185, 430], to = [160, 205, 880], radius = 15 }
mirror = "x"
[[parts]]
cylinder = { from = [60, 185, 430], to = [60, 205, 880], radius = 12 }
mirror = "x"
[[parts]]
box = { center = [0, 205, 880], size = [360, 30, 60] }
"#;
    let panel = r#"kind = "solid"
[[parts]]
box = { center = [0, 0, 455], size = [460, 440, 50] }
[[parts]]
box = { center = [200, 190, 220], size = [46, 46, 440] }
mirror = "xy"
[[parts]]
box = { center = [0, 205, 650], size = [420, 30, 380] }
"#;
    folder.put("windsor.toml", windsor);
    folder.put("panel.toml", panel);
    folder
}

fn json(folder: &Folder, file: &str) -> Value {
    serde_json::from_str(&fs::read_to_string(folder.join(file)).unwrap()).unwrap()
}

#[test]
fn two_chairs_become_one_chair_and_a_recipe_of_it() {
    let folder = chairs();
    let args = ["morph", "windsor.toml", "panel.toml", "--resolution", "64"];
    let times = ["-t", "0.25:0.75:0.25", "-o", "h-{t}.stl"];
    let ran = folder.run(&[&args[..], &times].concat()).ends(0);
    let said = ran.stderr();
    for word in ["found: ", "kept: ", "next: ", "legs", "h.toml"] {
        assert!(said.contains(word), "{word}: {said}");
    }
    let report = json(&folder, "h.run.json");
    assert_eq!(report["searches"][0]["style"], "average");
    for f in report["frames"].as_array().unwrap() {
        assert_eq!(f["pieces"], 1, "{f}");
        let kept = f["volume_kept"].as_f64().unwrap();
        assert!((0.8..1.3).contains(&kept), "{kept}");
    }
    for name in ["h-0.25.png", "h-0.5.png", "h-0.75.png", "h.toml"] {
        assert!(folder.join(name).is_file(), "{name}");
    }
    folder.run(&["run", "h.toml", "-o", "again"]).ends(0);
    for t in ["0.25", "0.5", "0.75"] {
        let bytes = |name: String| fs::read(folder.join(&name)).unwrap();
        assert_eq!(bytes(format!("h-{t}.stl")), bytes(format!("again/h-{t}.stl")));
    }
    folder.run(&[&args[..], &times].concat()).fails(2, &["--force"]);
}

#[test]
fn styles_are_words_of_auto() {
    let folder = chairs();
    let args = ["morph", "windsor.toml", "panel.toml", "--resolution", "32", "-o", "x.stl"];
    folder.run(&[&args[..], &["--style", "swop"]].concat()).fails(2, &["did you mean `swap`?"]);
    let linear = ["--style", "swap", "--method", "linear"];
    folder.run(&[&args[..], &linear].concat()).fails(2, &["--style"]);
    folder.run(&[&args[..], &["--style", "swap"]].concat()).ends(0);
    assert_eq!(json(&folder, "x.run.json")["searches"][0]["style"], "swap");
}

#[test]
fn a_group_with_all_weight_on_one_chair_is_that_chair() {
    let folder = chairs();
    let args = ["morph", "windsor.toml", "panel.toml", "windsor.toml", "--resolution", "96"];
    let volume = |more: &[&str], out: &str| {
        folder.run(&[&args[..], &["--weights", "0,1,0", "-o", out], more].concat()).ends(0);
        let frame = json(&folder, &out.replace(".stl", ".run.json"))["frames"][0].clone();
        assert_eq!(frame["pieces"], 1);
        let kept = frame["volume_kept"].as_f64().unwrap();
        assert!((kept - 1.0).abs() < 0.02, "{kept}");
        frame["health"]["volume_mm3"].as_f64().unwrap()
    };
    // the weighted mean of the fields is the panel chair itself, on the same grid
    let (auto, panel) = (volume(&[], "g.stl"), volume(&["--method", "linear"], "p.stl"));
    assert!((auto / panel - 1.0).abs() < 1e-3, "{auto} {panel}");
}

/// A chair as a mesh: four legs and a back of boxes, and a seat that is a sheet.
fn sheet_chair() -> String {
    let mut text = String::new();
    let mut count = 0;
    let mut put = |corners: &[[f64; 3]], faces: &[&[usize]]| {
        for [x, y, z] in corners {
            text.push_str(&format!("v {x} {z} {}\n", -y));
        }
        for f in faces {
            let face: Vec<String> = f.iter().map(|i| (count + i + 1).to_string()).collect();
            text.push_str(&format!("f {}\n", face.join(" ")));
        }
        count += corners.len();
    };
    let mut block = |[x0, y0, z0]: [f64; 3], [x1, y1, z1]: [f64; 3]| {
        let at = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
        let corners: Vec<[f64; 3]> =
            [z0, z1].iter().flat_map(|z| at.map(|[x, y]| [x, y, *z])).collect();
        let sides: [&[usize]; 6] = [
            &[3, 2, 1, 0],
            &[4, 5, 6, 7],
            &[0, 1, 5, 4],
            &[1, 2, 6, 5],
            &[2, 3, 7, 6],
            &[3, 0, 4, 7],
        ];
        put(&corners, &sides);
    };
    for (x, y) in [(-200.0, -200.0), (170.0, -200.0), (-200.0, 170.0), (170.0, 170.0)] {
        block([x, y, 0.0], [x + 30.0, y + 30.0, 450.0]);
    }
    block([-200.0, 175.0, 450.0], [200.0, 200.0, 900.0]);
    put(
        &[
            [-210.0, -210.0, 450.0],
            [210.0, -210.0, 450.0],
            [210.0, 210.0, 450.0],
            [-210.0, 210.0, 450.0],
        ],
        &[&[0, 1, 2, 3]],
    );
    text
}

#[test]
fn a_seat_without_thickness_gets_one_and_the_recipe_says_so() {
    let folder = chairs();
    folder.put("sheet.obj", &sheet_chair());
    let args = ["morph", "sheet.obj", "panel.toml", "--resolution", "64", "-o", "h.stl"];
    let said = folder.run(&args).ends(0).stderr();
    // two of 14 mm cells are more than a fiftieth of 900 mm
    assert!(said.contains("made 18 mm thick") && said.contains("without thickness"), "{said}");
    assert!(said.contains("8 of 8 feet on the floor"), "{said}");
    let recipe = fs::read_to_string(folder.join("h.toml")).unwrap();
    assert!(recipe.contains("which = \"thin\"") && recipe.contains("crumbs = 0.005"), "{recipe}");
    let frame = json(&folder, "h.run.json")["frames"][0].clone();
    assert_eq!(frame["pieces"], 1, "{frame}");
    folder.run(&["run", "h.toml", "-o", "again"]).ends(0);
    let bytes = |name: &str| fs::read(folder.join(name)).unwrap();
    assert_eq!(bytes("h.stl"), bytes("again/h.stl"));
    // other methods leave the mesh as it is
    let said = folder
        .run(&[
            "morph",
            "sheet.obj",
            "panel.toml",
            "--method",
            "linear",
            "--resolution",
            "48",
            "--align",
            "pose",
            "-o",
            "l.stl",
        ])
        .ends(0)
        .stderr();
    assert!(said.contains("no thickness and is lost"), "{said}");
}
