use crate::util::Folder;
use serde_json::Value;
use std::f64::consts::{PI, TAU};
use std::fs;

/// A block and a rod that one feature joins, and a name that must be escaped.
const PAIR: &str = r#"version = 1
name = "<b>bar</b> & \"rod\""
[grid]
resolution = 24
[shapes.bar]
solid = { parts = [{ box = { center = [0, 0, 10], size = [20, 12, 20] } }] }
[shapes.rod]
solid = { parts = [{ cylinder = { from = [3, 0, 0], to = [3, 0, 26], radius = 5 } }] }
[[features]]
name = "body"
on.bar.box = { center = [0, 0, 10], size = [22, 14, 22] }
on.rod.cylinder = { from = [3, 0, -1], to = [3, 0, 27], radius = 6 }
[morph]
between = ["bar", "rod"]
t = [0.5, 0, 1]
"#;

fn compared(recipe: &str, args: &[&str]) -> (Folder, String) {
    let folder = Folder::new();
    folder.put("r.toml", recipe);
    let ran = folder.run(&[&["compare", "r.toml", "-o", "out"], args].concat()).ends(0);
    let said = ran.stderr();
    (folder, said)
}

fn json(folder: &Folder) -> Value {
    serde_json::from_str(&fs::read_to_string(folder.join("out/metrics.json")).unwrap()).unwrap()
}

/// Rows of `metrics.csv` as (column, value) look-ups; no cell of these holds a comma.
fn table(folder: &Folder) -> (Vec<String>, Vec<Vec<String>>) {
    let text = fs::read_to_string(folder.join("out/metrics.csv")).unwrap();
    let mut lines = text.lines().map(|l| l.split(',').map(str::to_owned).collect::<Vec<_>>());
    (lines.next().unwrap(), lines.collect())
}

#[test]
fn every_method_at_every_time_with_known_numbers() {
    let (folder, _) = compared(PAIR, &["--methods", "linear,graft"]);
    let (header, rows) = table(&folder);
    assert_eq!(rows.len(), 6);
    let cell = |row: &[String], name: &str| -> f64 {
        let at = header.iter().position(|h| h == name).unwrap();
        row[at].parse().unwrap_or_else(|_| panic!("{name}: `{}`", row[at]))
    };
    let times: Vec<f64> = rows.iter().map(|r| cell(r, "t")).collect();
    assert_eq!(times, [0.0, 0.5, 1.0, 0.0, 0.5, 1.0], "sorted, whatever the recipe's order");
    for row in &rows {
        assert_eq!(&row[header.iter().position(|h| h == "closed").unwrap()], "true");
        assert_eq!((cell(row, "pieces"), cell(row, "genus")), (1.0, 0.0));
    }
    // linear at its ends is the parents: a cell is 26/24 = 1.08 mm
    let (bar, rod) = (&rows[0], &rows[2]);
    assert!(cell(bar, "hausdorff_to_a_mm") < 0.02 && cell(rod, "hausdorff_to_b_mm") < 0.02);
    // from the bar's top corner (-10, 6, 20) to the rod's side, and the same both ways round
    let want = 13f64.hypot(6.0) - 5.0;
    assert!((cell(bar, "hausdorff_to_b_mm") - want).abs() < 1.1, "{bar:?}");
    assert!((cell(rod, "hausdorff_to_a_mm") - want).abs() < 1.1, "{rod:?}");
    assert!((cell(bar, "min_wall_mm") - 12.0).abs() < 0.3, "{bar:?}");
    assert!((cell(rod, "min_wall_mm") - 10.0).abs() < 0.5, "{rod:?}");
    assert!((cell(bar, "volume_mm3") / 4800.0 - 1.0).abs() < 0.03, "{bar:?}");
    assert!(cell(bar, "gradient_error") < 0.1, "{bar:?}");
    let step = header.iter().position(|h| h == "step_mm").unwrap();
    assert_eq!((rows[0][step].as_str(), rows[3][step].as_str()), ("", ""), "no frame before");
}

#[test]
fn the_report_is_whole_and_asks_nobody() {
    let (folder, _) = compared(PAIR, &["--json"]);
    let page = fs::read_to_string(folder.join("out/report.html")).unwrap();
    assert!(
        page.contains("&lt;b&gt;bar&lt;/b&gt; &amp; &quot;rod&quot;")
            && !page.contains("<b>bar</b> & ")
    );
    assert!(!page.contains("{{") && page.ends_with("</html>\n"));
    for outside in ["src=\"http", "href=\"http", "url(", "@import", "XMLHttp", "fetch("] {
        assert!(!page.contains(outside), "{outside}");
    }
    let all = json(&folder);
    let names: Vec<&str> =
        all["methods"].as_array().unwrap().iter().map(|m| m["method"].as_str().unwrap()).collect();
    for name in ["linear", "space-time", "feature-volume", "graft:paper", "graft", "graft:erode"] {
        assert!(names.contains(&name), "{name} of {names:?}");
        assert!(page.contains(&format!("alt=\"{name} at t = 0.5\"")), "{name}");
        let mesh = format!("out/meshes/{}-0.5.stl", name.replace(':', "-"));
        assert!(folder.join(&mesh).is_file(), "{mesh}");
    }
    assert!(!names.iter().any(|n| n.starts_with("pde")), "no surfaces here");
    assert!(all["claims"].as_array().unwrap().len() >= 4);
    assert!(folder.join("out/sheet.png").is_file());
    assert_eq!(all["recipe_sha256"].as_str().unwrap().len(), 64);
}

#[test]
fn methods_can_be_played() {
    let args = ["--methods", "linear,graft:erode", "--no-meshes", "--animation", "webp,glb"];
    let (folder, _) = compared(PAIR, &args);
    let all = json(&folder);
    let played = all["animations"].as_array().unwrap();
    assert_eq!(played.len(), 4);
    for (one, name) in
        played.iter().zip(["linear.webp", "linear.glb", "graft-erode.webp", "graft-erode.glb"])
    {
        assert_eq!((&one["frames"], &one["turns"]), (&3.into(), &4.into()));
        let file = folder.join(&format!("out/animations/{name}"));
        assert_eq!(fs::metadata(file).unwrap().len(), one["file_bytes"].as_u64().unwrap());
    }
    let again = folder.run(&["compare", "r.toml", "-o", "out", "--animation", "glb"]);
    again.fails(2, &["exists already"]);
    folder.run(&["compare", "r.toml", "--animation", "mp4"]).ends(2);
}

#[test]
fn a_method_that_does_not_apply_leaves_a_row_and_the_rest_goes_on() {
    let start = PAIR.find("[[features]]").unwrap();
    let end = PAIR.find("[morph]").unwrap();
    let plain = PAIR[..start].to_owned() + &PAIR[end..];
    let (folder, said) = compared(&plain, &["--methods", "graft,linear", "--no-meshes"]);
    assert!(said.contains("graft: does not apply: ") && said.contains("features"), "{said}");
    let all = json(&folder);
    let rows = all["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 6);
    for (row, t) in rows.iter().zip([0.0, 0.5, 1.0]) {
        assert_eq!((&row["method"], &row["t"]), (&"graft".into(), &t.into()));
        assert!(row["error"].as_str().unwrap().contains("features"), "{row}");
    }
    assert!(rows[3..].iter().all(|r| r["method"] == "linear" && r["error"].is_null()));
    assert!(all["methods"][0]["error"].as_str().unwrap().contains("features"));
    let page = fs::read_to_string(folder.join("out/report.html")).unwrap();
    assert!(page.contains("this method needs features"));
    assert!(!folder.join("out/meshes").exists());
    // by default only what applies is made
    let (folder, _) = compared(&plain, &["--no-meshes", "-t", "0.5"]);
    assert!(json(&folder)["methods"].as_array().unwrap().iter().all(|m| m["made"] == 1));
}

#[test]
fn a_frame_without_a_mesh_says_why() {
    // far apart, the mean of two distances is positive everywhere half way
    let apart = PAIR.replace("[3, 0, 0], to = [3, 0, 26]", "[90, 0, 0], to = [90, 0, 26]");
    let (folder, _) = compared(&apart, &["--methods", "linear,space-time", "--no-meshes"]);
    let all = json(&folder);
    let rows = all["rows"].as_array().unwrap();
    assert!(rows[1]["error"].as_str().unwrap().contains("nothing is inside"), "{}", rows[1]);
    assert!(rows[2]["error"].is_null() && rows[2]["step_mm"].is_null(), "{}", rows[2]);
    assert_eq!(all["methods"][0]["made"], 2);
    let page = fs::read_to_string(folder.join("out/report.html")).unwrap();
    assert!(page.contains("nothing is inside") && page.contains("no mesh"));
}

#[test]
fn what_cannot_be_compared() {
    let folder = Folder::new();
    folder.put("r.toml", PAIR);
    let compare = |args: &[&str]| folder.run(&[&["compare", "r.toml", "-o", "out"], args].concat());
    compare(&["--methods", "lineer"]).fails(2, &["did you mean `linear`?"]);
    compare(&["--methods", "pde-spine"]).fails(3, &["no method applies", "pde-spine"]);
    compare(&["--crumbs", "2"]).ends(2);
    compare(&["--max-memory", "1M"]).fails(5, &["would be needed"]);
    let dry = compare(&["--dry-run"]).ends(0);
    assert!(dry.stdout().contains("frames") && !folder.join("out").exists(), "{dry}");
    let help = folder.run(&["compare", "--methods", "help"]).ends(0);
    assert!(help.stdout().contains("graft:erode"), "{help}");
    folder.run(&["compare"]).ends(2);
    compare(&["--methods", "linear", "-t", "0.5", "--no-meshes"]).ends(0);
    compare(&["--methods", "linear", "-t", "0.5"]).fails(2, &["exists already", "--force"]);
    compare(&["--methods", "linear", "-t", "0.5", "--force", "--strict"]).ends(0);
}

/// A torus about the z axis as OBJ, 160 by 64 points.
fn torus(radius: f64, tube: f64) -> String {
    let (n, m) = (160, 64);
    let mut text = String::new();
    for i in 0..n * m {
        let [u, v] = [i / m * m, i % m * n].map(|k| k as f64 / (n * m) as f64 * TAU);
        let out = radius + tube * v.cos();
        text += &format!("v {} {} {}\n", out * u.cos(), out * u.sin(), tube * v.sin());
    }
    for i in 0..n * m {
        let at = |i: usize, j: usize| (i % n) * m + j % m + 1;
        let (i, j) = (i / m, i % m);
        let corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        text += &format!("f {} {} {} {}\n", corners[0], corners[1], corners[2], corners[3]);
    }
    text
}

/// The rows of `linear` between two shapes at t = 0, 1/2, 1, and the side of a cell.
fn linear(shapes: &str, files: &[(&str, String)]) -> (Vec<Value>, f64) {
    let folder = Folder::new();
    files.iter().for_each(|(name, text)| drop(folder.put(name, text)));
    let tail = "[morph]\nbetween = [\"a\", \"b\"]\nt = [0, 0.5, 1]\n";
    folder.put("r.toml", &format!("version = 1\n[grid]\nresolution = 48\n{shapes}{tail}"));
    let args = ["compare", "r.toml", "-o", "out", "--methods", "linear", "--no-meshes"];
    folder.run(&args).ends(0);
    let all = json(&folder);
    (all["rows"].as_array().unwrap().clone(), all["voxel_mm"].as_f64().unwrap())
}

fn number(row: &Value, key: &str) -> f64 {
    row[key].as_f64().unwrap_or_else(|| panic!("{key}: {row}"))
}

#[test]
fn a_torus_that_shrinks_has_the_measures_of_a_torus() {
    let shapes = "[shapes.a]\nmesh = \"a.obj\"\nplace = \"keep\"\n[shapes.b]\nmesh = \"b.obj\"\n\
                  place = \"keep\"\n";
    let (rows, cell) = linear(shapes, &[("a.obj", torus(20.0, 7.0)), ("b.obj", torus(20.0, 4.0))]);
    for (row, tube) in rows.iter().zip([7.0, 5.5, 4.0]) {
        // second order in the cell, and what the 64-gon lacks
        let off = 0.4 * (cell / tube).powi(2) + 0.002;
        let volume = 2.0 * PI * PI * 20.0 * tube * tube;
        assert!((number(row, "volume_mm3") / volume - 1.0).abs() < off, "{row}");
        let area = 4.0 * PI * PI * 20.0 * tube;
        assert!((number(row, "area_mm2") / area - 1.0).abs() < off, "{row}");
        assert_eq!((&row["genus"], &row["pieces"]), (&1.into(), &1.into()));
        assert!((number(row, "min_wall_mm") - 2.0 * tube).abs() < 0.3 * cell, "{row}");
        for (key, way) in [("hausdorff_to_a_mm", 7.0 - tube), ("hausdorff_to_b_mm", tube - 4.0)] {
            let off = number(row, key) - way;
            let error = number(row, "hausdorff_error_mm");
            assert!(off.abs() < 0.1 * cell + error, "{key}: {row}");
        }
        assert!((number(row, "mean_to_a_mm") - (7.0 - tube)).abs() < 0.05 * cell, "{row}");
    }
    for row in &rows[1..] {
        assert!((number(row, "step_mm") - 1.5).abs() < 0.1 * cell, "{row}");
    }
}

#[test]
fn a_bar_that_splits_becomes_two_pieces() {
    let part = |x: f64, long: f64| {
        format!("{{ box = {{ center = [{x}, 0, 6], size = [{long}, 12, 12] }} }}")
    };
    let solid = |parts: &[String]| format!("solid = {{ parts = [{}] }}\n", parts.join(", "));
    let whole = solid(&[part(0.0, 60.0)]);
    let split = solid(&[part(-20.0, 20.0), part(20.0, 20.0)]);
    let (rows, _) = linear(&format!("[shapes.a]\n{whole}[shapes.b]\n{split}"), &[]);
    let pieces: Vec<&Value> = rows.iter().map(|r| &r["pieces"]).collect();
    assert_eq!((pieces[0], pieces[2]), (&1.into(), &2.into()));
    let half = number(&rows[2], "smallest_piece_share");
    assert!((half - 0.5).abs() < 1e-3, "{half}");
    assert!((number(&rows[2], "smallest_piece_mm3") / 2880.0 - 1.0).abs() < 0.03, "{}", rows[2]);
    assert!((number(&rows[2], "volume_kept") - 1.0).abs() < 0.03, "{}", rows[2]);
    // the middle of the bar's side is half the gap from the edges of the split one's ends
    assert!((number(&rows[2], "hausdorff_to_a_mm") - 10.0).abs() < 0.7, "{}", rows[2]);
}
