mod mutations;

use super::{Auto, InnerEntry, MethodEntry, PlainOr, Recipe, UpAxis, word};
use crate::weight::Ease;
use std::path::Path;

const PAIR: &str = r#"version = 1
name = "dining x lounge"
[grid]
resolution = 256
preview = 64
[shapes.dining]
mesh = "../chairs/dining.obj"
up = "y"
unit = "cm"
height = 900.0
[shapes.lounge]
mesh = "../chairs/lounge.glb"
thicken = 6.0
[[features]]
name = "leg front left"
[features.on.dining]
cylinder = { from = [-210, -190, 0], to = [-200, -200, 430], radius = 40 }
[features.on.lounge]
box = { center = [-260, -240, 150], size = [90, 90, 300], rotate_deg = [0, 8, 0] }
twist_deg = 20.0
[features.morph]
t = "t^2"
deform = "t"
offset = 4.0
[morph]
method = "graft"
between = ["dining", "lounge"]
blend = "maps"
inner = "grow"
weighting = "smooth"
t = [0.0, 0.25, 0.5, 0.75, 1.0]
[morph.space-time]
a0 = 1.0
[output]
mesh = "hybrid-{t}.stl"
picture = "hybrid-{t}.png"
"#;

fn parse(text: &str) -> Result<Recipe, String> {
    Recipe::parse(text, Path::new("r.toml")).map(|(r, _)| r).map_err(|e| e.to_string())
}

#[test]
fn the_contracts_example_is_read() {
    let r = parse(PAIR).unwrap();
    assert_eq!(r.shapes["dining"].up, Some(UpAxis::Y));
    assert_eq!(r.shapes["lounge"].thicken, Some(PlainOr::Plain(6.0)));
    let feature = &r.features[0];
    assert_eq!(feature.morph.as_ref().unwrap().t.as_ref().unwrap().0, Ease::Power(2.0));
    assert_eq!(feature.on["lounge"].twist_deg, Some(20.0));
    assert_eq!(r.morph.method, Some(MethodEntry::Graft));
    assert_eq!(r.morph.inner, Some(InnerEntry::Grow));
    assert_eq!(r.morph.space_time.as_ref().unwrap().a0, Auto::Value(1.0));
    assert_eq!(r.morph.t.as_ref().unwrap().0.len(), 5);
}

#[test]
fn what_is_written_is_read_again_in_both_formats() {
    let r = parse(PAIR).unwrap();
    assert_eq!(parse(&toml::to_string(&r).unwrap()).unwrap(), r);
    let json = serde_json::to_string_pretty(&r).unwrap();
    assert_eq!(Recipe::parse(&json, Path::new("r.json")).unwrap().0, r);
}

#[test]
fn hybrids_override_row_by_row() {
    let text = r#"version = 1
[shapes.c1]
mesh = "a.obj"
[shapes.c2]
mesh = "b.obj"
[[features]]
name = "seat"
on.c1.box = { center = [0, 0, 0], size = [1, 1, 1] }
on.c2.box = { center = [0, 0, 0], size = [1, 1, 1] }
[morph]
method = "group"
among = ["c1", "c2"]
[morph.weights]
default = { c1 = 1, c2 = 1 }
seat = { c1 = 1 }
[[hybrids]]
name = "heir-1"
weights = { seat = { c1 = 3, c2 = 1 } }
"#;
    let r = parse(text).unwrap();
    let all = r.variants();
    assert_eq!(all.len(), 1);
    assert_eq!(all[0].0, "hybrids[0]");
    assert_eq!(all[0].1.weights["seat"]["c1"], 3.0);
    assert_eq!(all[0].1.weights["default"]["c2"], 1.0);
    assert_eq!(all[0].1.among.as_ref().unwrap().len(), 2);
}

/// Each wrong line, and what its message must hold: place, key, cause.
#[test]
fn errors_tell_file_line_key_and_cause() {
    for (from, to, expected) in [
        ("version = 1", "version = 2", "r.toml:1: version: got 2"),
        ("version = 1\n", "", "missing key `version`"),
        (
            "resolution",
            "resolutoin",
            "grid.resolutoin: unknown key `resolutoin`; did you mean `resolution`?",
        ),
        ("resolution = 256", "resolution = 256\nvoxel = 3", "grid: both"),
        ("resolution = 256", "resolution = \"fine\"", "r.toml:4: grid.resolution: invalid type"),
        ("unit = \"cm\"", "unit = \"ft\"", "shapes.dining.unit: unknown value `ft`"),
        ("twist_deg = 20.0", "twist = 20.0", "features[0].on.lounge.twist: unknown key `twist`"),
        ("size = [90, 90, 300]", "size = [90, 90]", "features[0].on.lounge.box.size"),
        (
            "size = [90, 90, 300]",
            "size = [90, 90, -300]",
            "r.toml:19: features[0].on.lounge.box.size: got -300",
        ),
        (
            "features.on.lounge",
            "features.on.longe",
            "no shape is called `longe`; did you mean `lounge`?",
        ),
        ("t = \"t^2\"", "t = \"t^\"", "r.toml:22: features[0].morph.t: got `t^`"),
        (
            "method = \"graft\"",
            "method = \"grafd\"",
            "unknown value `grafd`; did you mean `graft`?",
        ),
        (
            "between = [\"dining\", ",
            "between = [\"dinning\", ",
            "morph.between: no shape is called `dinning`; did you mean `dining`?",
        ),
        ("[0.0, 0.25, 0.5, 0.75, 1.0]", "[]", "morph.t: no times"),
        ("[0.0, 0.25, 0.5, 0.75, 1.0]", "[2]", "morph.t: got 2"),
        (
            "a0 = 1.0",
            "a0 = \"atuo\"",
            "morph.space-time.a0: unknown value `atuo`; did you mean `auto`?",
        ),
        (
            "weighting = \"smooth\"",
            "weighting = { kind = \"smoth\" }",
            "morph.weighting.kind: unknown value `smoth`",
        ),
        ("hybrid-{t}.stl", "hybrid-{x}.stl", "output.mesh: got `hybrid-{x}.stl`"),
        (
            "thicken = 6.0",
            "thicken = { mm = 6, what = \"all\" }",
            "shapes.lounge.thicken.what: unknown key",
        ),
        ("name = \"dining x lounge\"", "name = \"dining", "r.toml:2"),
    ] {
        let text = PAIR.replacen(from, to, 1);
        assert_ne!(text, PAIR, "{from}");
        let e = parse(&text).unwrap_err();
        assert!(e.contains(expected), "{to}\n expected: {expected}\n got: {e}");
        assert!(e.starts_with("r.toml") && !e.contains('\n'), "{e}");
    }
}

#[test]
fn json_errors_have_places_too() {
    let json = "{\n \"version\": 1,\n \"shapes\": {\"a\": {\n  \"mesh\": \"a.obj\",\n  \"heigth\": 3\n }}\n}";
    let e = Recipe::parse(json, Path::new("r.json")).unwrap_err();
    assert_eq!((e.line, e.at.as_str()), (Some(5), "shapes.a.heigth"), "{e}");
    assert!(e.why.contains("did you mean `height`?"), "{e}");
}

#[test]
fn words_alone() {
    assert_eq!(word::<UpAxis>("y"), Ok(UpAxis::Y));
    assert!(word::<MethodEntry>("space-tim").unwrap_err().contains("did you mean `space-time`?"));
}

#[test]
fn the_schema_names_every_key() {
    let schema = super::schema().to_string();
    for key in ["rotate_deg", "space-time", "deform_weights", "crumbs", "thicken", "\"box\""] {
        assert!(schema.contains(key), "{key}");
    }
}

/// No text may bring the reader down.
#[test]
fn cut_texts_are_errors_or_recipes() {
    for cut in 0..PAIR.len() {
        let _ = parse(&PAIR[..cut]);
    }
    let _ = parse(&format!("version = {}", "[".repeat(50_000)));
    let _ = parse(&format!("a{} = 1", ".a".repeat(50_000)));
}

/// A name with a line break in it, which JSON can have, found by the mutations.
#[test]
fn names_are_told_in_one_line() {
    let text = r#"{"version": 1, "shapes": {"d\ning": {"mesh": "a.stl"}},
        "features": [{"name": "leg", "on": {"dining": {"box": {"center": [0,0,0], "size": [1,1,1]}}}}]}"#;
    let e = Recipe::parse(text, Path::new("r.json")).unwrap_err().to_string();
    assert!(e.contains("did you mean `d\\ning`?") && !e.contains('\n'), "{e}");
}
