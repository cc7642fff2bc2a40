//! Where things stand in a recipe's text: keys to lines, and parse errors to keys.

use super::bulk::{self, DEEPEST};
use super::strict::Strict;
use crate::num::near::did_you_mean;
use serde::de::DeserializeOwned;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::de::{DeTable, DeValue};

/// Something wrong at a key, before the file and line are known.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{at}: {why}")]
pub struct Problem {
    /// The key, such as `features[2].on.lounge.box.size`; empty for the whole file.
    pub at: String,
    /// What is wrong, got and expected.
    pub why: String,
}

impl Problem {
    /// A problem at a key.
    pub fn new(at: impl Into<String>, why: impl Into<String>) -> Self {
        Self { at: at.into(), why: why.into() }
    }
}

/// A recipe or solid that cannot be used: file, line, key, cause.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}{}{why}", place(.file, .line), colon(.at))]
pub struct RecipeError {
    /// The file as it was named.
    pub file: PathBuf,
    /// The line, counted from 1, where it is known.
    pub line: Option<usize>,
    /// The key; empty for the whole file.
    pub at: String,
    /// What is wrong.
    pub why: String,
}

/// `file:line: `, as far as they are known.
fn place(file: &Path, line: &Option<usize>) -> String {
    match line {
        _ if file.as_os_str().is_empty() => String::new(),
        Some(n) => format!("{}:{n}: ", file.display()),
        None => format!("{}: ", file.display()),
    }
}

fn colon(at: &str) -> String {
    if at.is_empty() { String::new() } else { format!("{at}: ") }
}

/// Largest recipe or solid that is read, bytes. Parsed, a text takes up to two hundred times as much;
/// the largest that ships has 30 kB.
const LARGEST: u64 = 3 << 19;

/// The text of a recipe or solid file.
///
/// # Errors
/// What keeps it from being read, in words: missing, no regular file, too large, not UTF-8.
pub fn read_text(path: &Path) -> Result<String, String> {
    let fail = |e: std::io::Error| format!("cannot be read: {e}");
    let about = fs::metadata(path).map_err(fail)?;
    if !about.is_file() {
        return Err("is no regular file".to_owned());
    }
    if about.len() > LARGEST {
        return Err(format!("has {} bytes; at most {LARGEST} are read", about.len()));
    }
    fs::read_to_string(path).map_err(fail)
}

/// The `kind` that a TOML or JSON text begins with, if it has one: `solid`, or that of a surface file.
/// Recipes have none.
pub fn kind(text: &str, file: &Path) -> Option<String> {
    bulk::check(text, is_json(file)).ok()?;
    if is_json(file) {
        let value: serde_json::Value = serde_json::from_str(text).ok()?;
        return value.get("kind")?.as_str().map(str::to_owned);
    }
    let table: toml::Table = text.parse().ok()?;
    table.get("kind")?.as_str().map(str::to_owned)
}

fn is_json(file: &Path) -> bool {
    file.extension().is_some_and(|e| e.eq_ignore_ascii_case("json"))
}

/// Keys, and the bytes of their names and values. Where a key is not kept, one above it tells the line.
#[derive(Clone, Debug, Default)]
pub(super) struct Places {
    pub all: Vec<(String, Range<usize>)>,
    /// Of all the keys.
    bytes: usize,
}

/// Longest key, with those above it, below which keys are looked for.
pub(super) const LONGEST: usize = 1000;

/// Most bytes of keys that are kept: a long key over many values would be kept with each of them.
const KEYS: usize = 16 << 20;

impl Places {
    /// Keeps a place, if there is room. Its number among those kept.
    pub fn push(&mut self, key: &str, at: Range<usize>) -> Option<usize> {
        self.bytes = self.bytes.saturating_add(key.len());
        let room = self.bytes <= KEYS;
        if room {
            self.all.push((key.to_owned(), at));
        }
        room.then(|| self.all.len() - 1)
    }
}

/// A text, its name, and where its keys stand.
#[derive(Clone, Debug)]
pub struct Source {
    file: PathBuf,
    text: String,
    places: Places,
}

impl Source {
    /// Reads a text into `T`; JSON when the name ends in `.json`, else TOML.
    ///
    /// # Errors
    /// Bad grammar, an unknown key (with the nearest known one), a wrong type.
    pub fn read<T: DeserializeOwned>(text: &str, file: &Path) -> Result<(T, Self), RecipeError> {
        let json = is_json(file);
        let mut source =
            Self { file: file.to_owned(), text: text.to_owned(), places: Places::default() };
        bulk::check(text, json).map_err(|e| source.fail(Some(e.at..e.at), &e.why))?;
        if json { source.read_json() } else { source.read_toml() }.map(|t| (t, source))
    }

    /// A recipe that was never written down, such as a command line: no file, no lines.
    pub fn unwritten() -> Self {
        Self::unplaced(String::new(), Path::new(""))
    }

    /// A text of which neither keys nor lines are to be looked up, because a program wrote it.
    pub fn unplaced(text: String, file: &Path) -> Self {
        Self { file: file.to_owned(), text, places: Places::default() }
    }

    /// The name the text was given.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// The text itself.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Adds file and line to a problem.
    pub fn locate(&self, p: Problem) -> RecipeError {
        RecipeError { file: self.file.clone(), line: self.line_of(&p.at), at: p.at, why: p.why }
    }

    /// The line of a key, or of the nearest key above it that is there.
    pub fn line_of(&self, key: &str) -> Option<usize> {
        let mut key = key;
        while !key.is_empty() {
            if let Some((_, at)) = self.places.all.iter().find(|(k, _)| k == key) {
                return Some(self.line_at(at.start));
            }
            key = key.rfind(['.', '[']).map_or("", |cut| &key[..cut]);
        }
        None
    }

    fn line_at(&self, offset: usize) -> usize {
        1 + self.text.bytes().take(offset).filter(|&b| b == b'\n').count()
    }

    /// The key with the smallest span that holds all of these bytes.
    fn key_at(&self, span: &Range<usize>) -> String {
        let holds = |r: &Range<usize>| r.contains(&span.start) && span.end <= r.end;
        let holds = self.places.all.iter().filter(|(_, r)| holds(r));
        // of equal spans the last is the deepest
        let key = holds.rev().min_by_key(|(_, r)| r.len()).map(|(k, _)| k.clone());
        key.unwrap_or_default()
    }

    fn fail(&self, span: Option<Range<usize>>, message: &str) -> RecipeError {
        let at = span.as_ref().map(|s| self.key_at(s)).unwrap_or_default();
        RecipeError {
            file: self.file.clone(),
            line: span.map(|s| self.line_at(s.start)),
            at,
            why: explain(message),
        }
    }

    fn read_toml<T: DeserializeOwned>(&mut self) -> Result<T, RecipeError> {
        let text = self.text.clone();
        let table = DeTable::parse(&text).map_err(|e| self.fail(e.span(), e.message()))?;
        self.index_table("", table.get_ref(), 0);
        // parsed twice, but not held twice: empty tables in tables take a thousand times their text
        drop(table);
        let read = toml::Deserializer::parse(&text).and_then(|d| T::deserialize(Strict(d)));
        read.map_err(|e| {
            let mut fault = self.fail(e.span(), e.message());
            // of the top table only its first key is pointed at, which is not to blame
            let inner = e
                .span()
                .is_some_and(|s| text.get(s.start..).unwrap_or_default().starts_with(['[', '{']));
            if e.message().starts_with("missing field") && !inner {
                fault.at.clear();
            }
            fault
        })
    }

    fn index_table(&mut self, above: &str, table: &DeTable<'_>, depth: usize) {
        for (name, value) in table {
            let name_span = name.span();
            let key = join(above, name.get_ref());
            self.places.push(&key, name_span);
            self.index_value(key, value.span(), value.get_ref(), depth);
        }
    }

    fn index_value(&mut self, key: String, span: Range<usize>, value: &DeValue<'_>, depth: usize) {
        self.places.push(&key, span);
        if depth > DEEPEST || key.len() > LONGEST {
            return;
        }
        match value {
            DeValue::Table(t) => self.index_table(&key, t, depth + 1),
            DeValue::Array(a) => {
                for (i, v) in a.iter().enumerate() {
                    self.index_value(format!("{key}[{i}]"), v.span(), v.get_ref(), depth + 1);
                }
            }
            _ => {}
        }
    }

    fn read_json<T: DeserializeOwned>(&mut self) -> Result<T, RecipeError> {
        let text = self.text.clone();
        self.places = super::json::places(&text);
        serde_json::from_str(&text).map_err(|e| {
            let message = e.to_string();
            let message = message.split(" at line ").next().unwrap_or_default();
            let start = text.split_inclusive('\n').take(e.line().saturating_sub(1));
            let offset = start.map(str::len).sum::<usize>() + e.column();
            // the column is that of the last byte read, counted from 1, often just past a value
            let last = offset.saturating_sub(2);
            let mut fault = self.fail(Some(last..last + 1), message);
            fault.line = Some(e.line());
            fault
        })
    }
}

/// `above.name`, with the name in quotes where it is not a bare key.
pub(crate) fn join(above: &str, name: &str) -> String {
    let bare = name.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '-');
    let name = if bare { name.to_owned() } else { format!("{name:?}") };
    if above.is_empty() { name } else { format!("{above}.{name}") }
}

/// A parser's message in one line, with the name that was probably meant.
pub(super) fn explain(message: &str) -> String {
    let message = message.trim().replace('\n', ", ");
    let mut ticks = message.split('`').skip(1).step_by(2);
    let unknown = message.starts_with("unknown field") || message.starts_with("unknown variant");
    match ticks.next() {
        Some(word) if unknown => {
            let known: Vec<&str> = ticks.collect();
            let hint = did_you_mean(word, known.iter().copied());
            let what = if message.starts_with("unknown field") { "key" } else { "value" };
            if known.is_empty() {
                format!("unknown {what} `{word}`")
            } else if hint.is_empty() {
                format!("unknown {what} `{word}`; known: {}", known.join(", "))
            } else {
                format!("unknown {what} `{word}`{hint}")
            }
        }
        _ => message.replace("missing field", "missing key"),
    }
}
