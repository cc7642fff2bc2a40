//! How much a text takes once it is parsed, looked up before it is: a table with one key takes a
//! thousand bytes for five of the text. Also how deep it goes.
//!
//! Only quotes, brackets, dots, commas and the like are told apart; what is no TOML or JSON is the
//! parser's to refuse.

/// Deepest nesting that is read: brackets in brackets, or the parts of a key.
pub(super) const DEEPEST: usize = 64;

/// What a text may take, bytes.
const MOST: usize = 64 << 20;
// As measured over texts of nothing else; with the place of each, by its key.
const TABLE: usize = 1300;
const LIST: usize = 400;
const VALUE: usize = 250;

/// Where a text becomes too much, and why.
#[derive(Debug, PartialEq)]
pub(super) struct Excess {
    /// Bytes before it.
    pub at: usize,
    pub why: String,
}

/// Whether a text can be parsed within [`MOST`] and is no deeper than [`DEEPEST`].
pub(super) fn check(text: &str, json: bool) -> Result<(), Excess> {
    let mut scan =
        Scan { text: text.as_bytes(), json, at: 0, taken: 0, open: vec![], key: Some(1) };
    while scan.at < scan.text.len() {
        scan.step()?;
    }
    Ok(())
}

struct Scan<'a> {
    text: &'a [u8],
    json: bool,
    at: usize,
    /// What was seen so far takes that many bytes.
    taken: usize,
    /// Brackets that are open; whether it is one of a table.
    open: Vec<bool>,
    /// In a key of TOML or a heading: how many parts it has so far.
    key: Option<usize>,
}

impl Scan<'_> {
    fn step(&mut self) -> Result<(), Excess> {
        let byte = self.text[self.at];
        self.at += 1;
        match byte {
            b'"' => self.string(b'"'),
            b'\'' if !self.json => self.string(b'\''),
            b'#' if !self.json => self.comment(),
            b'\n' if self.open.is_empty() => self.key = Some(1),
            b'=' => {
                self.key = None;
                return self.take(VALUE);
            }
            b'.' => return self.dot(),
            b'[' if self.open.is_empty() && self.key.is_some() && !self.json => {
                return self.take(TABLE);
            }
            b'{' | b'[' => return self.opened(byte == b'{'),
            b'}' | b']' => drop(self.open.pop()),
            b',' => {
                self.key = self.open.last().is_some_and(|&table| table).then_some(1);
                return self.take(VALUE);
            }
            _ => {}
        }
        Ok(())
    }

    fn opened(&mut self, table: bool) -> Result<(), Excess> {
        self.open.push(table);
        self.key = table.then_some(1);
        self.take(if table { TABLE } else { LIST })?;
        self.deep(self.open.len())
    }

    fn dot(&mut self) -> Result<(), Excess> {
        let Some(parts) = self.key.as_mut().filter(|_| !self.json) else { return Ok(()) };
        *parts += 1;
        let parts = *parts;
        self.take(TABLE)?;
        self.deep(parts)
    }

    fn take(&mut self, bytes: usize) -> Result<(), Excess> {
        self.taken += bytes;
        let why = || {
            format!(
                "too many tables, lists and values: read up to here, they take {} MB",
                MOST >> 20
            )
        };
        if self.taken > MOST { Err(Excess { at: self.at - 1, why: why() }) } else { Ok(()) }
    }

    fn deep(&self, levels: usize) -> Result<(), Excess> {
        let why = || format!("nested deeper than {DEEPEST} levels");
        if levels > DEEPEST { Err(Excess { at: self.at - 1, why: why() }) } else { Ok(()) }
    }

    fn comment(&mut self) {
        let rest = self.text[self.at..].iter();
        self.at += rest.take_while(|&&b| b != b'\n').count();
    }

    /// Goes behind a string, of which the first quote is read.
    fn string(&mut self, quote: u8) {
        let triple = [quote; 2];
        let long = !self.json && self.text[self.at..].starts_with(&triple);
        if long {
            self.at += 2;
        }
        while let Some(&byte) = self.text.get(self.at) {
            self.at += 1;
            match byte {
                b'\\' if quote == b'"' => self.at += 1,
                b'\n' if !long => return,
                b if b == quote && !long => return,
                b if b == quote && self.text[self.at..].starts_with(&triple) => {
                    self.at += 2;
                    return;
                }
                _ => {}
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Excess, check};

    fn wrong(text: &str, json: bool) -> Excess {
        check(text, json).unwrap_err()
    }

    #[test]
    fn what_ships_is_far_from_too_much() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
        for folder in ["recipes", "surfaces", "chairs"] {
            for entry in std::fs::read_dir(root.join(folder)).unwrap().flatten() {
                if entry.path().extension().is_some_and(|e| e == "toml") {
                    let text = std::fs::read_to_string(entry.path()).unwrap();
                    assert_eq!(check(&text.repeat(20), false), Ok(()), "{entry:?}");
                }
            }
        }
    }

    #[test]
    fn too_many_tables_are_told_where_they_are() {
        let many = "[a.b]\n".repeat(100_000);
        assert!(wrong(&many, false).why.starts_with("too many tables"));
        assert!([0, 2].contains(&(wrong(&many, false).at % 6)), "at no dot or bracket");
        assert_eq!(check(&format!("a = '''{many}'''\n"), false), Ok(()));
        assert_eq!(check(&format!("a = \"\"\"\\\"{many}\"\"\"\n"), false), Ok(()));
        assert_eq!(check(&many.replace('[', "#["), false), Ok(()));
        for text in ["{},", "[],", "1,"] {
            let list = format!("[{}]", text.repeat(700_000));
            assert!(wrong(&list, true).why.starts_with("too many"), "{text}");
            assert!(wrong(&format!("a = {list}"), false).why.starts_with("too many"), "{text}");
        }
        // numbers have dots that are none of a key
        assert_eq!(check(&format!("a = [{}]\n", "1.5, ".repeat(200_000)), false), Ok(()));
    }

    #[test]
    fn depth_is_that_of_brackets_and_of_keys() {
        let lists = |n: usize| format!("a = {}{}\n", "[".repeat(n), "]".repeat(n));
        assert_eq!(check(&lists(64), false), Ok(()));
        assert_eq!(
            wrong(&lists(65), false),
            Excess { at: 68, why: "nested deeper than 64 levels".into() }
        );
        let dots =
            |n: usize| format!("[a{}]\nb = 1.5\nc{} = 1\n", ".a".repeat(n - 1), ".a".repeat(n - 1));
        assert_eq!(check(&dots(64), false), Ok(()));
        assert!(wrong(&dots(65), false).why.starts_with("nested deeper"));
        assert_eq!(check("[a.b]\n[a.c]\n'x.y' = \"a]'\"\nb.c = [\n 1.5,\n 2.5]\n", false), Ok(()));
        assert!(wrong(&"[".repeat(65), true).why.starts_with("nested deeper"));
        assert_eq!(check(&format!("\"{}", "[".repeat(65)), true), Ok(()));
    }
}
