//! Where the keys of a JSON text stand. Only well-formed JSON is told about; what is not well
//! formed is the parser's to refuse.

use super::bulk::DEEPEST;
use super::source::{LONGEST, Places, join};

/// Every key and the bytes of its value.
pub(super) fn places(text: &str) -> Places {
    let mut scan = Scan { text: text.as_bytes(), at: 0, places: Places::default() };
    // bad grammar ends the scan early; what was found so far still helps
    let _ = scan.value(String::new(), 0);
    scan.places
}

struct Scan<'a> {
    text: &'a [u8],
    at: usize,
    places: Places,
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
        let end = self.text.len();
        let slot = if key.is_empty() { None } else { self.places.push(&key, start..end) };
        if depth > DEEPEST || key.len() > LONGEST {
            return None;
        }
        match self.text.get(self.at)? {
            b'{' => self.members(&key, depth)?,
            b'[' => self.items(&key, depth)?,
            b'"' => drop(self.string()?),
            _ => self.scalar(),
        }
        if let Some(place) = slot.and_then(|i| self.places.all.get_mut(i)) {
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
            self.places.push(&key, start..self.at);
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
        let found = places(text).all;
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
