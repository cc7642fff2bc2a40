//! The house has floors: a module may import only from lower ones.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

const FLOORS: &[&[&str]] = &[
    &["num", "job", "memory", "place"],
    &["mesh", "grid", "weight", "warp"],
    &["bvh", "surface"],
    &["element"],
    &["field"],
    &["morph", "parts", "iso", "check", "picture", "recipe"],
    &["scene"],
    &["run"],
    &["cli"],
];

fn floor(module: &str) -> Option<usize> {
    FLOORS.iter().position(|f| f.contains(&module))
}

fn sources(dir: &Path, out: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(dir).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, out);
        } else if path.extension().is_some_and(|x| x == "rs") {
            out.push(path);
        }
    }
}

fn word(s: &str) -> String {
    s.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

/// Top-level modules named after `crate::`, braces included.
fn imports(text: &str) -> BTreeSet<String> {
    let code: Vec<&str> = text.lines().map(|l| l.split("//").next().unwrap()).collect();
    let code = code.join(" ");
    let mut found = BTreeSet::new();
    for tail in code.split("crate::").skip(1) {
        let Some(list) = tail.strip_prefix('{') else {
            found.insert(word(tail));
            continue;
        };
        let (mut depth, mut start) = (0, true);
        for (i, c) in list.char_indices() {
            if start && depth == 0 && !c.is_whitespace() {
                found.insert(word(&list[i..]));
                start = false;
            }
            match c {
                '{' => depth += 1,
                '}' if depth == 0 => break,
                '}' => depth -= 1,
                ',' => start = depth == 0,
                _ => {}
            }
        }
    }
    found
}

#[test]
fn imports_are_found() {
    let text = "use crate::{a::{b, c}, d};\nuse crate::e; // crate::f\nfn x() -> crate::g::H {}";
    let expected = ["a", "d", "e", "g"].map(str::to_owned);
    assert_eq!(imports(text), BTreeSet::from(expected));
}

#[test]
fn imports_point_down() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&root, &mut files);
    let mut wrong = Vec::new();
    for file in files {
        let rel = file.strip_prefix(&root).unwrap();
        let first = rel.components().next().unwrap().as_os_str().to_str().unwrap();
        let me = first.trim_end_matches(".rs").to_owned();
        if me == "lib" || me == "main" {
            continue;
        }
        let Some(mine) = floor(&me) else {
            wrong.push(format!("`{me}` has no floor"));
            continue;
        };
        for other in imports(&fs::read_to_string(&file).unwrap()) {
            if let Some(theirs) = floor(&other)
                && other != me
                && theirs >= mine
            {
                let rel = rel.display();
                wrong.push(format!(
                    "{rel}: `{me}` (floor {mine}) imports `{other}` (floor {theirs})"
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "imports must point down:\n{}", wrong.join("\n"));
}
