use crate::util::{Folder, block};
use serde_json::Value;

#[test]
fn json_has_an_object_a_file_with_known_numbers() {
    let folder = Folder::new();
    folder.put("a.obj", &block([0.0; 3], [5.0, 10.0, 15.0]));
    // the last two faces are missing
    let open = block([0.0; 3], [5.0; 3]).lines().take(12).fold(String::new(), |t, l| t + l + "\n");
    folder.put("open.obj", &open);
    let ran = folder.run(&["check", "a.obj", "open.obj", "--up", "z", "--json"]).ends(0);
    let lines: Vec<Value> =
        ran.stdout().lines().map(|l| serde_json::from_str(l).unwrap()).collect();
    let (a, open) = (&lines[0], &lines[1]);
    for key in [
        "file",
        "triangles",
        "vertices",
        "closed",
        "manifold_edges",
        "manifold_vertices",
        "oriented",
        "self_intersections",
        "components",
        "genus",
        "volume_mm3",
        "area_mm2",
        "bbox_mm",
        "min_wall_mm",
        "floating_parts",
        "balanced",
        "printable",
        "reasons",
    ] {
        assert!(a.get(key).is_some(), "{key}\n{ran}");
    }
    assert_eq!(a["file"], "a.obj");
    assert_eq!((a["triangles"].as_u64(), a["vertices"].as_u64()), (Some(12), Some(8)));
    assert_eq!(a["printable"], true);
    assert_eq!(a["genus"], 0);
    assert_eq!(a["volume_mm3"], 6000.0);
    assert_eq!(a["area_mm2"], 2200.0);
    assert_eq!(a["bbox_mm"], serde_json::json!([[-5.0, -10.0, -15.0], [5.0, 10.0, 15.0]]));
    // the thinner of its sides, and it stands on one of them
    assert!((a["min_wall_mm"].as_f64().unwrap() - 10.0).abs() < 1e-9, "{a}");
    assert_eq!((&a["balanced"], &open["min_wall_mm"]), (&Value::Bool(true), &Value::Null));
    assert_eq!(open["closed"], false);
    assert_eq!(open["volume_mm3"], Value::Null);
    assert_eq!(open["printable"], false);
    assert!(!open["reasons"].as_array().unwrap().is_empty());
    assert!(ran.stderr().contains("a.obj: z up, unit mm: 10.0 x 20.0 x 30.0 mm"), "{ran}");
}

#[test]
fn strict_fails_for_what_cannot_be_printed() {
    let folder = Folder::new();
    folder.put("tri.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.run(&["check", "tri.obj"]).ends(0);
    folder.run(&["check", "tri.obj", "--strict"]).fails(4, &["tri.obj", "not printable"]);
    folder.run(&["check", "tri.obj", "gone.obj", "--strict"]).fails(3, &["gone.obj"]);
}

#[test]
fn height_and_unit_scale() {
    let folder = Folder::new();
    folder.put("a.obj", &block([0.0; 3], [1.0, 1.0, 2.0]));
    let ran = folder.run(&["check", "a.obj", "--up", "z", "--unit", "cm"]).ends(0);
    assert!(ran.stderr().contains("20.0 x 20.0 x 40.0 mm"), "{ran}");
    let ran = folder.run(&["check", "a.obj", "--up", "z", "--print-height", "100"]).ends(0);
    assert!(ran.stderr().contains("50.0 x 50.0 x 100.0 mm"), "{ran}");
    folder.run(&["check", "a.obj", "--print-height", "0"]).fails(2, &["--print-height"]);
}

#[test]
fn walls_are_judged_by_the_nozzle() {
    let folder = Folder::new();
    folder.put("plate.obj", &block([0.0; 3], [20.0, 20.0, 0.15]));
    let args = ["check", "plate.obj", "--up", "z", "--strict", "--nozzle"];
    folder.run(&[&args[..], &["0.2"]].concat()).ends(0);
    let ran = folder.run(&[&args[..], &["0.4"]].concat()).fails(4, &["not printable"]);
    assert!(ran.stdout().contains("thinnest wall has 0.30 mm"), "{ran}");
}
