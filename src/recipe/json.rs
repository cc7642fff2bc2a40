//! Where the keys of a JSON text stand. Only well-formed JSON is told about; what is not well
//! formed is the parser's to refuse.

use super::source::join;
use std::ops::Range;

/// Deepest nesting that is followed.
const DEEPEST: usize = 64;

/// Every key and the bytes of its value.
pub(super) fn places(text: &str) -> Vec<(String, Range<usize>)> {
    let mut scan = Scan { text: text.as_bytes(), at: 0, places: Vec::new() };
    // bad grammar ends the scan early; what was found so far still helps
    let _ = scan.value(String::new(), 0);
    scan.places
}

struct Scan<'a> {
    text: &'a [u8],
    at: usize,
    places: Vec<(String, Range<usize>)>,
}

impl Scan<'_> {
    fn space(&mut self) {
        while self.text.get(self.at).is_some_and(u8::is_ascii_whitespace) {
            self.at += 1;
        }
    }

    fn eat(&mut self, byte: u8) -> Option<()> {
        self.space();
        (self.text.get(self.at) == Some(&byte)).then(|| self.at += 1)
    }

    fn value(&mut self, key: String, depth: usize) -> Option<()> {
        self.space();
        let start = self.at;
        let slot = self.places.len();
        if !key.is_empty() {
            self.places.push((key.clone(), start..self.text.len()));
        }
        if depth > DEEPEST {
            return None;
        }
        match self.text.get(self.at)? {
            b'{' => self.members(&key, depth)?,
            b'[' => self.items(&key, depth)?,
            b'"' => drop(self.string()?),
            _ => self.scalar(),
        }
        if let Some(place) = self.places.get_mut(slot).filter(|_| !key.is_empty()) {
            place.1.end = self.at;
        }
        Some(())
    }

    fn members(&mut self, above: &str, depth: usize) -> Option<()> {
        self.at += 1;
        while self.eat(b'}').is_none() {
            self.space();
            let start = self.at;
            let name = self.string()?;
            let key = join(above, &name);
            self.places.push((key.clone(), start..self.at));
            self.eat(b':')?;
            self.value(key, depth + 1)?;
            if self.eat(b',').is_none() {
                return self.eat(b'}');
            }
        }
        Some(())
    }

    fn items(&mut self, above: &str, depth: usize) -> Option<()> {
        self.at += 1;
        let mut i = 0;
        while self.eat(b']').is_none() {
            self.value(format!("{above}[{i}]"), depth + 1)?;
            i += 1;
            if self.eat(b',').is_none() {
                return self.eat(b']');
            }
        }
        Some(())
    }

    fn string(&mut self) -> Option<String> {
        let start = self.at;
        self.eat(b'"')?;
        loop {
            match self.text.get(self.at)? {
                b'\\' => self.at += 2,
                b'"' => break self.at += 1,
                _ => self.at += 1,
            }
        }
        serde_json::from_slice(self.text.get(start..self.at)?).ok()
    }

    fn scalar(&mut self) {
        let ends = |b: &u8| matches!(b, b',' | b']' | b'}') || b.is_ascii_whitespace();
        while self.text.get(self.at).is_some_and(|b| !ends(b)) {
            self.at += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::places;

    #[test]
    fn finds_keys_and_survives_nonsense() {
        let text = r#"{"a": {"b c": [1, {"d": "x\"y"}]}, "e": 2}"#;
        let found = places(text);
        let at =
            |key: &str| found.iter().rev().find(|(k, _)| k == key).map(|(_, r)| &text[r.clone()]);
        assert_eq!(at("a.\"b c\"[1].d"), Some(r#""x\"y""#));
        assert_eq!(at("e"), Some("2"));
        for cut in 0..text.len() {
            places(&text[..cut]);
        }
        places(&"[".repeat(100_000));
    }
}
