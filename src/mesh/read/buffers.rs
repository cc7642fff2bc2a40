//! The bytes a glTF refers to: its own chunk, `data:` URIs, and files inside its own folder.

use crate::mesh::error::{Parsed, fault};
use std::{
    borrow::Cow,
    collections::BTreeMap,
    fs::File,
    io::Read,
    path::{Component, Path, PathBuf},
};

/// One buffer as the JSON declares it.
#[derive(serde::Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Declared {
    #[serde(default)]
    uri: Option<String>,
    byte_length: u64,
}

/// All buffers.
pub(super) struct Buffers<'a> {
    loaded: Vec<Cow<'a, [u8]>>,
    /// Which of the loaded ones each declared one is.
    index: Vec<usize>,
}

impl<'a> Buffers<'a> {
    /// Loads what is declared. The same URI twice is loaded once, so that the memory stays within
    /// the bytes there are.
    pub fn load(declared: &[Declared], chunk: Option<&'a [u8]>, folder: &Path) -> Parsed<Self> {
        let (mut loaded, mut index) = (Vec::new(), Vec::new());
        let mut known = BTreeMap::new();
        for (i, buffer) in declared.iter().enumerate() {
            let at = format!("buffers[{i}]");
            let key = match (&buffer.uri, chunk) {
                (Some(uri), _) => Some(decoded(uri, &at)?),
                (None, Some(_)) if i == 0 => None,
                (None, _) => return fault(at, "no uri, and no binary chunk that it could mean"),
            };
            let n = *known.entry(key.clone()).or_insert(loaded.len());
            if n == loaded.len() {
                loaded.push(match key {
                    Some(uri) => Cow::Owned(fetch(&uri, folder, &at)?),
                    None => Cow::Borrowed(chunk.unwrap_or_default()),
                });
            }
            let (has, wants) = (loaded[n].len(), buffer.byte_length);
            if wants > has as u64 {
                return fault(at, format!("byteLength is {wants}, but there are {has} bytes"));
            }
            index.push(n);
        }
        Ok(Self { loaded, index })
    }

    pub fn get(&self, declared: usize) -> Option<&[u8]> {
        self.index.get(declared).and_then(|&n| self.loaded.get(n)).map(|b| &**b)
    }

    /// Bytes in memory.
    pub fn total(&self) -> u64 {
        self.loaded.iter().map(|b| b.len() as u64).sum()
    }
}

/// A URI without its percent signs; `data:` ones stay as they are.
fn decoded(uri: &str, at: &str) -> Parsed<String> {
    if uri.starts_with("data:") || !uri.contains('%') {
        return Ok(uri.into());
    }
    let mut out = Vec::new();
    let mut bytes = uri.bytes();
    while let Some(b) = bytes.next() {
        let mut digit = || bytes.next().and_then(|b| char::from(b).to_digit(16));
        if b != b'%' {
            out.push(b);
        } else if let (Some(high), Some(low)) = (digit(), digit()) {
            out.push((high * 16 + low) as u8);
        } else {
            return fault(at, format!("`{}` has a bad percent escape", brief(uri)));
        }
    }
    match String::from_utf8(out) {
        Ok(s) => Ok(s),
        Err(_) => fault(at, format!("`{}` is not UTF-8 once decoded", brief(uri))),
    }
}

fn fetch(uri: &str, folder: &Path, at: &str) -> Parsed<Vec<u8>> {
    match uri.strip_prefix("data:") {
        Some(data) => from_data(data, at),
        None => from_file(uri, folder, at),
    }
}

fn from_data(data: &str, at: &str) -> Parsed<Vec<u8>> {
    let body =
        data.split_once(',').and_then(|(kind, body)| kind.ends_with(";base64").then_some(body));
    let Some(body) = body else {
        return fault(at, "a data: URI that is not base64");
    };
    match base64(body.as_bytes()) {
        Some(bytes) => Ok(bytes),
        None => fault(at, "a data: URI with broken base64"),
    }
}

/// The bytes of base64 text, padded or not; `None` where it is broken.
fn base64(text: &[u8]) -> Option<Vec<u8>> {
    let end = text.iter().rposition(|&b| b != b'=').map_or(0, |i| i + 1);
    let mut out = Vec::with_capacity(end / 4 * 3 + 3);
    for group in text[..end].chunks(4) {
        let mut word = 0u32;
        for &b in group {
            word = word << 6
                | match b {
                    b'A'..=b'Z' => u32::from(b - b'A'),
                    b'a'..=b'z' => u32::from(b - b'a') + 26,
                    b'0'..=b'9' => u32::from(b - b'0') + 52,
                    b'+' => 62,
                    b'/' => 63,
                    _ => return None,
                };
        }
        if group.len() == 1 {
            return None;
        }
        let word = word << (6 * (4 - group.len()));
        out.extend_from_slice(&word.to_be_bytes()[1..group.len()]);
    }
    Some(out)
}

/// Reads a file of the glTF's own folder; nothing may lead out of it, symbolic links included.
fn from_file(uri: &str, folder: &Path, at: &str) -> Parsed<Vec<u8>> {
    let refused = |why: &str| fault(at, format!("`{}` {why}", brief(uri)));
    let relative = Path::new(uri);
    let plain = relative.components().all(|c| matches!(c, Component::Normal(_)));
    if uri.is_empty() || !plain || uri.contains([':', '\\', '\0', '?', '#']) {
        return refused("is not read: a buffer must be a file in the folder of its glTF");
    }
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let real = |p: &Path| -> std::io::Result<PathBuf> { p.canonicalize() };
    let (home, path) = match (real(folder), real(&folder.join(relative))) {
        (Ok(home), Ok(path)) => (home, path),
        (Err(e), _) | (_, Err(e)) => return refused(&format!("cannot be read: {e}")),
    };
    if !path.starts_with(&home) {
        return refused("is not read: it leads out of the folder of its glTF");
    }
    if !path.is_file() {
        return refused("is not a regular file");
    }
    let mut bytes = Vec::new();
    let read = File::open(&path).and_then(|f| {
        let size = f.metadata()?.len();
        let room = usize::try_from(size).unwrap_or(usize::MAX);
        bytes.try_reserve_exact(room).map_err(std::io::Error::other)?;
        f.take(size).read_to_end(&mut bytes)
    });
    match read {
        Ok(_) => Ok(bytes),
        Err(e) => refused(&format!("cannot be read: {e}")),
    }
}

fn brief(uri: &str) -> String {
    super::text::shown(uri.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_every_length() {
        // RFC 4648, section 10.
        for (text, bytes) in [
            ("", ""),
            ("Zg==", "f"),
            ("Zm8=", "fo"),
            ("Zm9v", "foo"),
            ("Zm9vYg", "foob"),
            ("Zm9vYmE=", "fooba"),
            ("Zm9vYmFy", "foobar"),
        ] {
            assert_eq!(base64(text.as_bytes()).as_deref(), Some(bytes.as_bytes()), "{text}");
        }
        assert_eq!(base64(b"Zm9v!A"), None);
        assert_eq!(base64(b"Zm9vY"), None);
    }

    #[test]
    fn nothing_leads_out_of_the_folder() {
        let outer = tempfile::tempdir().unwrap();
        let folder = outer.path().join("inner");
        std::fs::create_dir(&folder).unwrap();
        std::fs::write(outer.path().join("out.bin"), b"secret").unwrap();
        std::fs::write(folder.join("in side.bin"), b"ours").unwrap();
        std::fs::create_dir(folder.join("sub")).unwrap();
        let get = |uri: &str| {
            let uri = decoded(uri, "buffers[0]")?;
            fetch(&uri, &folder, "buffers[0]")
        };
        assert_eq!(get("in%20side.bin").unwrap(), b"ours");
        let absolute = outer.path().join("out.bin").display().to_string();
        #[cfg(unix)]
        std::os::unix::fs::symlink(outer.path().join("out.bin"), folder.join("link.bin")).unwrap();
        for uri in [
            "../out.bin",
            "sub/../../out.bin",
            "%2e%2e/out.bin",
            "..%2Fout.bin",
            "..\\out.bin",
            &absolute,
            "file:///etc/passwd",
            "http://localhost/x",
            "c:/x",
            "link.bin",
            "sub",
            "",
            "%zz",
            "%ff",
            "missing.bin",
            "data:text/plain,abc",
            "data:;base64,A",
        ] {
            let fault = get(uri).expect_err(uri);
            assert!(fault.place == "buffers[0]" && !fault.why.is_empty());
        }
    }
}
