//! Broken copies of recipes, solids and surface files: each is read or refused in one line.

use super::super::{Recipe, RecipeError, kind, parse_solid, parse_surface};
use crate::num::Expr;
use crate::num::mutate::{count, mutated};
use rayon::prelude::*;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// What a text is read as.
#[derive(Clone, Copy, PartialEq)]
enum As {
    Recipe,
    Solid,
    Surface,
}

fn read(given: As, text: &str, file: &Path) -> Result<(), RecipeError> {
    kind(text, file);
    match given {
        As::Recipe => Recipe::parse(text, file).map(|(r, _)| {
            // what is read can be written, and read again
            let again = toml::to_string(&r).unwrap();
            assert!(Recipe::parse(&again, Path::new("r.toml")).unwrap().0 == r, "{text}");
        }),
        As::Solid => parse_solid(text, file).map(drop),
        As::Surface => parse_surface(text, file).map(drop),
    }
}

/// Some shipped files of every kind, TOML and JSON.
fn samples() -> Vec<(As, &'static str, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
    let mut all = vec![(As::Recipe, "r.toml", super::PAIR.to_owned())];
    for (given, name) in [
        (As::Recipe, "recipes/chair-pair.toml"),
        (As::Recipe, "recipes/chair-swaps.toml"),
        (As::Recipe, "recipes/real-pair.toml"),
        (As::Solid, "chairs/shell.toml"),
        (As::Solid, "chairs/windsor.toml"),
        (As::Surface, "surfaces/klein-bottle.toml"),
        (As::Surface, "surfaces/klein-to-dolphin.toml"),
        (As::Surface, "surfaces/blend-cylinders.toml"),
        (As::Surface, "surfaces/letter-e.toml"),
        (As::Surface, "surfaces/letters-e-g.toml"),
        (As::Surface, "surfaces/dynamic-plate.toml"),
    ] {
        all.push((given, "r.toml", std::fs::read_to_string(root.join(name)).unwrap()));
    }
    let json = |(given, _, text): &(As, &str, String)| {
        let table: toml::Table = text.parse().unwrap();
        (*given, "r.json", serde_json::to_string_pretty(&table).unwrap())
    };
    all.extend(all.iter().map(json).collect::<Vec<_>>());
    all
}

fn try_all(given: As, all: u64) {
    let samples: Vec<_> = samples().into_iter().filter(|s| s.0 == given).collect();
    let good = AtomicU64::new(0);
    (0..all as usize).into_par_iter().with_min_len(200).for_each(|seed| {
        let (_, name, whole) = &samples[seed % samples.len()];
        let bytes = mutated(whole.as_bytes(), seed as u64 + 1);
        // a file that is no UTF-8 is refused before it is parsed
        let Ok(text) = String::from_utf8(bytes) else { return };
        match read(given, &text, Path::new(name)) {
            Ok(()) => drop(good.fetch_add(1, Relaxed)),
            Err(e) => {
                let said = e.to_string();
                assert!(said.len() > 12 && !said.contains('\n'), "{said:?}");
            }
        }
    });
    let good = good.into_inner();
    println!("{good} of {all} broken copies are read, the others refused");
    assert!(good > all / 200 && good < all * 99 / 100, "{good} of {all} read");
}

#[test]
fn a_hundred_thousand_broken_recipes_never_panic() {
    try_all(As::Recipe, count(100_000));
}

#[test]
fn broken_solids_and_surface_files_never_panic() {
    try_all(As::Solid, count(50_000));
    try_all(As::Surface, count(100_000));
}

#[test]
fn a_hundred_thousand_broken_expressions_never_panic() {
    let good = AtomicU64::new(0);
    let wholes =
        ["1.6*exp(t)*sin(v)^2 - -2^3/(v+1)", "-(atan2(v,t)+pi)*sqrt(abs(v))", "min(v,max(t,0.5))"];
    let all = count(100_000);
    (0..all as usize).into_par_iter().with_min_len(500).for_each(|seed| {
        let whole = wholes[seed % 3];
        let Ok(text) = String::from_utf8(mutated(whole.as_bytes(), seed as u64 + 1)) else {
            return;
        };
        if let Ok(f) = Expr::parse(&text, &["v", "t"]) {
            good.fetch_add(1, Relaxed);
            let _ = f.eval(&[0.5, 0.25]);
            if let Ok(g) = f.derivative(0) {
                let _ = g.eval(&[0.5, 0.25]);
            }
        }
    });
    let good = good.into_inner();
    assert!(good > all / 100, "{good} of {all} read");
}
