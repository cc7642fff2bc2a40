use crate::util::{Folder, block};

const RECIPE: &str = r#"version = 1
[grid]
resolution = 24
[shapes.low]
mesh = "low.obj"
up = "z"
[shapes.tall]
mesh = "tall.obj"
up = "z"
[[features]]
name = "body"
on.low.box = { center = [0, 0, 0], size = [22, 22, 12] }
on.tall.box = { center = [0, 0, 0], size = [12, 12, 32] }
[morph]
between = ["low", "tall"]
t = [0.0, 1.0]
"#;

fn folder() -> Folder {
    let folder = Folder::new();
    folder.put("low.obj", &block([0.0; 3], [10.0, 10.0, 5.0]));
    folder.put("tall.obj", &block([0.0; 3], [5.0, 5.0, 15.0]));
    folder.put("r.toml", RECIPE);
    folder
}

/// The recipe with one change.
fn changed(from: &str, to: &str) -> Folder {
    let folder = folder();
    let text = RECIPE.replacen(from, to, 1);
    assert_ne!(text, RECIPE, "{from}");
    folder.put("r.toml", &text);
    folder
}

#[test]
fn a_missing_file() {
    let folder = folder();
    folder.run(&["check", "gone.obj"]).fails(3, &["gone.obj", "cannot"]);
    folder.run(&["run", "gone.toml"]).fails(3, &["gone.toml"]);
    folder.run(&["run", "."]).fails(3, &["no regular file"]);
    folder.run(&["morph", "low.obj", "gone.stl", "-o", "x.stl"]).fails(3, &["gone.stl"]);
    changed("tall.obj", "tal.obj")
        .run(&["run", "r.toml"])
        .fails(3, &["r.toml:8: shapes.tall.mesh: tal.obj"]);
}

#[test]
fn a_wrong_key_with_what_was_meant() {
    changed("resolution", "resolutoin")
        .run(&["run", "r.toml"])
        .fails(3, &["r.toml:3: grid.resolutoin: unknown key", "did you mean `resolution`?"]);
    folder()
        .run(&["run", "r.toml", "--set", "grid.resolutoin=3"])
        .fails(3, &["r.toml: grid.resolutoin", "did you mean `resolution`?"]);
}

#[test]
fn a_feature_without_a_partner() {
    changed("on.tall.box = { center = [0, 0, 0], size = [12, 12, 32] }\n", "")
        .run(&["run", "r.toml"])
        .fails(3, &["features[0].on", "feature `body` has no element on `tall`"]);
}

#[test]
fn a_mesh_with_no_triangles() {
    let folder = folder();
    folder.put("low.obj", "v 0 0 0\nv 1 0 0\n");
    folder.run(&["run", "r.toml"]).fails(3, &["r.toml:5", "low.obj", "no triangles"]);
    folder.run(&["convert", "low.obj", "x.stl"]).fails(3, &["low.obj", "no triangles"]);
    assert_eq!(folder.names(), ["low.obj", "r.toml", "tall.obj"]);
}

#[test]
fn more_memory_than_allowed() {
    let folder = folder();
    let args = ["run", "r.toml", "--set", "grid.resolution=1500", "--max-memory", "100M"];
    folder.run(&args).fails(5, &["100 MB", "--max-memory"]);
    let args =
        ["run", "r.toml", "--set", "grid.resolution=1500", "--max-memory", "100M", "--dry-run"];
    folder.run(&args).fails(5, &["100 MB"]);
    let args = ["convert", "low.obj", "x.stl", "--voxel", "0.002", "--max-memory", "1G"];
    folder.run(&args).fails(5, &["1.0 GB"]);
    folder.run(&["run", "r.toml", "--max-memory", "lots"]).fails(2, &["lots"]);
    assert_eq!(folder.names(), ["low.obj", "r.toml", "tall.obj"]);
}

#[test]
fn an_output_that_is_there() {
    let folder = folder();
    folder.put("x.stl", "mine");
    let args = ["morph", "low.obj", "tall.obj", "-o", "x.stl", "--resolution", "24"];
    folder.run(&args).fails(2, &["x.stl", "--force"]);
    assert_eq!(std::fs::read_to_string(folder.join("x.stl")).unwrap(), "mine");
    folder.run(&[&args[..], &["--force"]].concat()).ends(0);
    folder.run(&["picture", "low.obj", "-o", "x.stl"]).fails(2, &["png"]);
}

#[test]
fn an_unknown_word() {
    let folder = folder();
    let args = ["morph", "low.obj", "tall.obj", "-o", "x.stl", "--method"];
    folder.run(&[&args[..], &["linaer"]].concat()).fails(2, &["did you mean `linear`?"]);
    folder.run(&[&args[..], &["graft"]].concat()).fails(2, &["features", "recipe"]);
    changed("[morph]", "[morph]\nmethod = \"grafd\"")
        .run(&["run", "r.toml"])
        .fails(3, &["morph.method", "did you mean `graft`?"]);
    folder.run(&["moprh"]).ends(2);
}

#[test]
fn usage_that_cannot_be() {
    let folder = folder();
    let morph =
        |rest: &[&str]| folder.run(&[&["morph", "low.obj", "tall.obj", "-o"], rest].concat());
    morph(&["x.stl", "-t", "0:1:0.5"]).fails(2, &["3 times", "{t}"]);
    morph(&["x.stl", "-t", "1.5"]).fails(2, &["1.5"]);
    morph(&["x.stl", "--weights", "1,2,3"]).fails(2, &["3 weights for 2 meshes"]);
    morph(&["x.stl", "--up", "y,z,y"]).fails(2, &["--up", "3 values for 2 inputs"]);
    morph(&["x.doc"]).fails(3, &["x.doc", "stl"]);
    morph(&["x.stl", "--resolution", "1"]).fails(2, &["grid.resolution", "4 to"]);
    folder.run(&["morph", "low.obj", "-o", "x.stl"]).ends(2);
    changed("t = [0.0, 1.0]", "t = [0.0, 0.0]").run(&["run", "r.toml"]).fails(2, &["2 results"]);
    changed("t = [0.0, 1.0]", "t = []").run(&["run", "r.toml"]).fails(3, &["morph.t"]);
    changed("between = [\"low\", \"tall\"]\n", "")
        .run(&["run", "r.toml"])
        .fails(3, &["morph: which shapes?"]);
    changed("version = 1", "version = 2").run(&["run", "r.toml"]).fails(3, &["r.toml:1: version"]);
}

#[test]
fn results_stay_in_their_folder() {
    changed("[morph]", "[output]\nmesh = \"../{t}.stl\"\n[morph]")
        .run(&["run", "r.toml"])
        .fails(3, &["output.mesh", "leaves the output folder"]);
}
