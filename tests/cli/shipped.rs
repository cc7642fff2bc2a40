//! What ships in `data/` is read by the program that ships with it.

use crate::util::Folder;
use fieldgraft::recipe::{Recipe, ShapeEntry, parse_solid};
use std::fs;
use std::path::{Path, PathBuf};

pub fn texts(folder: &str) -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("data").join(folder);
    let Ok(entries) = fs::read_dir(&root) else {
        return Vec::new();
    };
    let toml = |p: &PathBuf| p.extension().is_some_and(|e| e == "toml");
    let mut files: Vec<PathBuf> = entries.map(|e| e.unwrap().path()).filter(toml).collect();
    files.sort();
    files.into_iter().map(|p| (p.clone(), fs::read_to_string(p).unwrap())).collect()
}

#[test]
fn recipes_are_read_and_begin_with_a_comment() {
    for (path, text) in texts("recipes") {
        if let Err(e) = Recipe::parse(&text, &path) {
            panic!("{e}");
        }
        assert!(text.starts_with('#'), "{} says nothing about itself", path.display());
    }
}

#[test]
fn solids_are_read() {
    for (path, text) in texts("chairs") {
        if let Err(e) = parse_solid(&text, &path) {
            panic!("{e}");
        }
    }
}

/// Every key of a shipped recipe is in the schema, at its place.
#[test]
fn recipes_hold_no_key_that_the_schema_lacks() {
    let schema = fieldgraft::recipe::schema();
    for (path, text) in texts("recipes") {
        let tree: toml::Table = text.parse().unwrap();
        let tree = serde_json::to_value(tree).unwrap();
        let mut wrong = Vec::new();
        walk(&tree, &schema, &schema, "", &mut wrong);
        assert!(wrong.is_empty(), "{}: {wrong:?}", path.display());
    }
    let mut wrong = Vec::new();
    let bad = serde_json::json!({ "version": 1, "grid": { "reslution": 3 } });
    walk(&bad, &schema, &schema, "", &mut wrong);
    assert_eq!(wrong, ["grid.reslution"]);
}

/// Collects the keys of `value` that `schema` does not allow.
pub fn walk(
    value: &serde_json::Value,
    schema: &serde_json::Value,
    root: &serde_json::Value,
    at: &str,
    wrong: &mut Vec<String>,
) {
    if let Some(name) = schema["$ref"].as_str() {
        let name = name.trim_start_matches("#/$defs/");
        return walk(value, &root["$defs"][name], root, at, wrong);
    }
    if let Some(choices) = schema["anyOf"].as_array() {
        let fits = choices.iter().any(|choice| {
            let mut inner = Vec::new();
            walk(value, choice, root, at, &mut inner);
            inner.is_empty()
        });
        if !fits {
            wrong.push(at.to_owned());
        }
        return;
    }
    if let Some(members) = value.as_object() {
        for (key, member) in members {
            let at = if at.is_empty() { key.clone() } else { format!("{at}.{key}") };
            if let Some(known) = schema["properties"].get(key) {
                walk(member, known, root, &at, wrong);
            } else if schema["additionalProperties"].is_object() {
                walk(member, &schema["additionalProperties"], root, &at, wrong);
            } else if schema.get("properties").is_some() {
                wrong.push(at);
            }
        }
    }
    if let (Some(items), Some(kind)) = (value.as_array(), schema.get("items")) {
        for (i, item) in items.iter().enumerate() {
            walk(item, kind, root, &format!("{at}[{i}]"), wrong);
        }
    }
}

/// Every shipped recipe can be made as far as a dry run goes, at its preview.
#[test]
fn recipes_can_be_made() {
    let folder = Folder::new();
    for (path, text) in texts("recipes") {
        let (recipe, _) = Recipe::parse(&text, &path).unwrap();
        let beside = path.parent().unwrap();
        let there = |s: &ShapeEntry| s.mesh.as_ref().is_none_or(|m| beside.join(m).is_file());
        if !recipe.shapes.values().all(there) {
            println!("{}: skipped, its meshes are not fetched", path.display());
            continue;
        }
        let args = ["run", path.to_str().unwrap(), "--dry-run", "--profile", "preview", "--json"];
        let ran = folder.run(&args).ends(0);
        let p: serde_json::Value = serde_json::from_str(&ran.stdout()).unwrap();
        assert!(p["triangles"].as_u64().unwrap() > 0, "{ran}");
    }
    assert!(folder.names().is_empty(), "a dry run writes nothing");
}
