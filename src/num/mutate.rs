//! Broken copies of valid files, the same every time: for tests of whatever reads files.

/// Xorshift (Marsaglia 2003).
pub(crate) struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    pub fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % n.max(1) as u64) as usize
    }
}

/// What readers trip over, in text and in JSON.
const WORDS: &[&[u8]] = &[
    b"-1",
    b"0",
    b"nan",
    b"inf",
    b"1e999",
    b"-1e308",
    b"1e-320",
    b"4294967295",
    b"4294967296",
    b"18446744073709551615",
    b"-9223372036854775808",
    b"\n",
    b"\r\n",
    b"\\\n",
    b" ",
    b"\t",
    b"f ",
    b"\"",
    b"\\u0000",
    b"\\ud800",
    b"[",
    b"]",
    b"{",
    b"}",
    b",",
    b"=",
    b"(",
    b")",
    b"^",
    b"null",
    b"true",
    b"..",
    b"\x1b[",
    b"\xff\xfe",
    b"\xef\xbb\xbf",
];

/// The bytes of the number, or word, round a place.
fn token(bytes: &[u8], at: usize) -> std::ops::Range<usize> {
    let inside = |b: &u8| b.is_ascii_alphanumeric() || matches!(b, b'.' | b'-' | b'+' | b'_');
    let start = bytes[..at].iter().rposition(|b| !inside(b)).map_or(0, |i| i + 1);
    let end = bytes[at..].iter().position(|b| !inside(b)).map_or(bytes.len(), |i| at + i);
    start..end.max(start)
}

/// One change.
fn change(bytes: &mut Vec<u8>, random: &mut Random) {
    let at = random.below(bytes.len());
    let upto = |n: usize| at..(at + n).min(bytes.len());
    match random.below(10) {
        0 => bytes[at] = random.below(256) as u8,
        1 => bytes[at] ^= 1 << random.below(8),
        2 => bytes.truncate(at),
        3 => drop(bytes.drain(upto(random.below(9)))),
        4 => {
            let word = WORDS[random.below(WORDS.len())];
            let gone = upto(random.below(2) * word.len());
            bytes.splice(gone, word.iter().copied());
        }
        5 | 6 => {
            let word = WORDS[random.below(WORDS.len())];
            let gone = token(bytes, at);
            bytes.splice(gone, word.iter().copied());
        }
        7 => {
            let all = upto(4);
            bytes[all].fill([0, 0xFF, 0x7F][random.below(3)]);
        }
        8 => {
            // a token of the file in the place of another
            let other = token(bytes, random.below(bytes.len()));
            let copy = bytes[other].to_vec();
            let gone = token(bytes, at);
            bytes.splice(gone, copy);
        }
        _ => {
            let copy = bytes[upto(random.below(60))].to_vec();
            let to = random.below(bytes.len());
            bytes.splice(to..to, copy);
        }
    }
    if bytes.is_empty() {
        bytes.push(b' ');
    }
}

/// The file with one to five changes.
pub(crate) fn mutated(whole: &[u8], seed: u64) -> Vec<u8> {
    let mut random = Random::new(seed);
    let mut bytes = whole.to_vec();
    for _ in 0..=random.below(5) {
        change(&mut bytes, &mut random);
    }
    bytes
}

/// How many broken copies a test tries: so many, or what `FIELDGRAFT_MUTATIONS` says.
pub(crate) fn count(normal: u64) -> u64 {
    std::env::var("FIELDGRAFT_MUTATIONS").ok().and_then(|n| n.parse().ok()).unwrap_or(normal)
}
