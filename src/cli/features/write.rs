//! The suggested recipe as a text for people.

use super::super::failure::Failure;
use fieldgraft::parts::{Note, Suggestion};
use fieldgraft::recipe::{FeatureEntry, PlainOr, Recipe, ShapeEntry};
use fieldgraft::scene::suggest;
use std::fmt::Write;
use std::path::{Component, Path, PathBuf};

/// The grid of suggested recipes.
pub(super) const RESOLUTION: u32 = 128;

/// A complete recipe; `path` is where it will stand.
pub(super) fn recipe(
    path: &Path,
    shapes: &[(String, ShapeEntry)],
    suggestion: &Suggestion,
) -> Result<String, Failure> {
    let mut out = String::new();
    let names: Vec<&str> = shapes.iter().map(|(name, _)| name.as_str()).collect();
    // writing to a string cannot fail
    let _ = writeln!(
        out,
        "# Suggested by `fieldgraft features suggest`: look at the elements, then edit what is wrong.\n\
         # Millimetres, z up; fronts look to -y, left is -x, floors are at z = 0. The elements fit the\n\
         # shapes as they stand here: for other sizes suggest again, with --height.\n\
         version = 1\nname = {}\n\n[grid]\nresolution = {RESOLUTION}",
        quoted(&names.join(" x "))
    );
    for ((name, entry), guess) in shapes.iter().zip(&suggestion.shapes) {
        let mut entry = entry.clone();
        for file in [&mut entry.mesh].into_iter().flatten() {
            *file = beside(path, file);
        }
        if let Some(PlainOr::Plain(file)) = &mut entry.solid {
            *file = beside(path, file);
        }
        let _ = writeln!(out, "\n# {}", super::words(guess));
        for w in &guess.warnings {
            let _ = writeln!(out, "# look here: {w}");
        }
        let _ = writeln!(out, "[shapes.{}]\n{}", key(name), shape(&entry)?);
    }
    let notes = suggestion.features.iter().map(|f| (&f.note, f.confidence));
    for (feature, (note, sure)) in suggest::features(suggestion).iter().zip(notes) {
        let _ = write!(out, "\n{}{}", comment(note, sure, &names), entry(feature, &names)?);
    }
    out.push_str(&morph(&names, suggestion.features.is_empty()));
    // what is written must be read again
    Recipe::parse(&out, path)
        .map_err(|e| Failure::new(Failure::FAILED, format!("the suggested recipe: {e}")))?;
    Ok(out)
}

/// A path as the recipe has to name it: relative to the recipe's folder where that can be told.
pub fn beside(recipe: &Path, file: &Path) -> PathBuf {
    let folder = recipe.parent().unwrap_or(Path::new(""));
    let plain = |p: &Path| p.components().all(|c| matches!(c, Component::Normal(_)));
    if file.is_absolute() || folder.as_os_str().is_empty() {
        return file.to_owned();
    }
    if let Ok(inner) = file.strip_prefix(folder) {
        return inner.to_owned();
    }
    if plain(folder) {
        let up: PathBuf = folder.components().map(|_| "..").collect();
        return up.join(file);
    }
    std::path::absolute(file).unwrap_or_else(|_| file.to_owned())
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// A name as a key.
fn key(name: &str) -> String {
    let bare =
        !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
    if bare { name.to_owned() } else { quoted(name) }
}

fn shape(entry: &ShapeEntry) -> Result<String, Failure> {
    let fail = |e: toml::ser::Error| Failure::new(Failure::FAILED, format!("recipe: {e}"));
    let mut entry = entry.clone();
    // a table in one line: more keys may follow
    let thicken = entry.thicken.take().map(toml::Value::try_from).transpose().map_err(fail)?;
    let text = toml::to_string(&entry).map_err(fail)?;
    let line = thicken.map_or_else(String::new, |t| format!("thicken = {t}"));
    Ok(format!("{}\n{line}", text.trim_end()).trim_end().to_owned())
}

fn comment(note: &Note, sure: f64, names: &[&str]) -> String {
    let note = match note {
        Note::Found => String::new(),
        Note::Absent(at) => {
            let of: Vec<&str> = at.iter().filter_map(|&i| names.get(i).copied()).collect();
            format!("none on {}: its element there is where one would be", of.join(" and "))
        }
        Note::Whole => "the bases are of different kinds: one element round all of each".to_owned(),
        Note::Mixed => "different numbers of legs: one may stand for two".to_owned(),
        Note::Slab => "no part: a slab of the whole".to_owned(),
    };
    let doubt = if sure < 0.5 { format!("confidence {sure:.2}") } else { String::new() };
    match (note.is_empty(), doubt.is_empty()) {
        (true, true) => String::new(),
        (false, false) => format!("# {note}; {doubt}\n"),
        _ => format!("# {note}{doubt}\n"),
    }
}

/// A feature, an element a line.
fn entry(feature: &FeatureEntry, names: &[&str]) -> Result<String, Failure> {
    let mut out = format!("[[features]]\nname = {}\n", quoted(&feature.name));
    for name in names {
        let Some(element) = feature.on.get(*name) else { continue };
        let table = toml::Table::try_from(element)
            .map_err(|e| Failure::new(Failure::FAILED, format!("recipe: {e}")))?;
        for (what, value) in table {
            let _ = writeln!(out, "on.{}.{what} = {value}", key(name));
        }
    }
    Ok(out)
}

fn morph(names: &[&str], plain: bool) -> String {
    let list: Vec<String> = names.iter().map(|n| quoted(n)).collect();
    let list = list.join(", ");
    match names {
        [_] => format!(
            "\n# One shape alone: add others, and their elements, to morph.\n\
             [morph]\nmethod = \"linear\"\namong = [{list}]\n"
        ),
        [_, _] => {
            let method = if plain { "space-time" } else { "graft" };
            format!(
                "\n[morph]\nmethod = \"{method}\"\nbetween = [{list}]\nt = [0.0, 0.25, 0.5, 0.75, 1.0]\n\
                 \n[output]\nmesh = \"hybrid-{{t}}.stl\"\npicture = \"hybrid-{{t}}.png\"\n"
            )
        }
        _ => {
            let method = if plain { "space-time" } else { "group" };
            let row: Vec<String> = names.iter().map(|n| format!("{} = 1", key(n))).collect();
            format!(
                "\n[morph]\nmethod = \"{method}\"\namong = [{list}]\n\
                 [morph.weights]\ndefault = {{ {} }}\n\
                 \n[output]\nmesh = \"hybrid.stl\"\npicture = \"hybrid.png\"\n",
                row.join(", ")
            )
        }
    }
}
