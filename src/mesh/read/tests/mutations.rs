//! Broken copies of small valid files: each is read or refused, none panics.

use super::*;

/// Xorshift (Marsaglia 2003): the same files every time.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % n.max(1) as u64) as usize
    }
}

fn mutate(bytes: &mut Vec<u8>, random: &mut Random) {
    const WORDS: [&[u8]; 10] = [
        b"-1",
        b"nan",
        b"1e999",
        b"4294967295",
        b"18446744073709551615",
        b"\n",
        b"\\\n",
        b" ",
        b"0",
        b"f ",
    ];
    let at = random.below(bytes.len());
    match random.below(7) {
        0 => bytes[at] = random.below(256) as u8,
        1 => bytes[at] ^= 1 << random.below(8),
        2 => bytes.truncate(at),
        3 => {
            let end = (at + random.below(9)).min(bytes.len());
            bytes.drain(at..end);
        }
        4 => {
            let word = WORDS[random.below(WORDS.len())];
            let end = (at + random.below(2) * word.len()).min(bytes.len());
            bytes.splice(at..end, word.iter().copied());
        }
        5 => {
            let end = (at + 4).min(bytes.len());
            bytes[at..end].fill([0, 0xFF, 0x7F][random.below(3)]);
        }
        _ => {
            let end = (at + random.below(60)).min(bytes.len());
            let copy = bytes[at..end].to_vec();
            let to = random.below(bytes.len());
            bytes.splice(to..to, copy);
        }
    }
    if bytes.is_empty() {
        bytes.push(b' ');
    }
}

#[test]
fn twenty_thousand_broken_files_never_panic() {
    let samples = samples();
    let (mut read, mut refused) = (0, 0);
    for seed in 1..=2500u64 {
        for (extension, whole) in &samples {
            let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15));
            let mut bytes = whole.clone();
            for _ in 0..=random.below(4) {
                mutate(&mut bytes, &mut random);
            }
            match parsed(&bytes, extension) {
                Ok(loaded) => {
                    read += 1;
                    assert!(loaded.mesh.faces.iter().flatten().all(|&v| {
                        loaded.mesh.points.get(v as usize).is_some_and(|p| p.is_finite())
                    }));
                    assert!(!loaded.found.summary().contains("nan"));
                }
                Err(text) => {
                    refused += 1;
                    assert!(text.len() > 10, "{extension}: `{text}`");
                }
            }
        }
    }
    assert!(read > 2000 && refused > 2000, "{read} read, {refused} refused");
}
