//! Broken copies of small valid files: each is read or refused, none panics.

use super::*;
use crate::num::mutate::{count, mutated};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Reads a broken copy; whether it could be read.
fn try_one(extension: &str, bytes: &[u8]) -> bool {
    match parsed(bytes, extension) {
        Ok(loaded) => {
            let points = &loaded.mesh.points;
            let sound = |&v: &u32| points.get(v as usize).is_some_and(|p| p.is_finite());
            assert!(loaded.mesh.faces.iter().flatten().all(sound));
            assert!(!loaded.found.summary().contains("nan"));
            true
        }
        Err(text) => {
            assert!(text.len() > 10, "{extension}: `{text}`");
            assert!(text.len() < 1000 && !text.chars().any(char::is_control), "{text:?}");
            false
        }
    }
}

/// 100 000 for each reader; ten million were tried by hand.
#[test]
fn a_hundred_thousand_broken_files_a_reader_never_panic() {
    let samples = samples();
    let readers = ["obj", "stl", "ply", "glb", "gltf"];
    for reader in readers {
        let mine: Vec<_> = samples.iter().filter(|s| s.0 == reader).collect();
        let (read, all) = (AtomicU64::new(0), count(100_000));
        (0..all as usize).into_par_iter().with_min_len(500).for_each(|seed| {
            let whole = &mine[seed % mine.len()].1;
            let bytes = mutated(whole, seed as u64 + 1);
            read.fetch_add(u64::from(try_one(reader, &bytes)), Relaxed);
        });
        let read = read.into_inner();
        println!("{reader}: {read} of {all} broken copies are read, the others refused");
        assert!(read > all / 100 && read < all * 99 / 100, "{reader}: {read} of {all} read");
    }
}
