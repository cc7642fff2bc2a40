//! A field as a file: the dense samples in NumPy's format, origin and step beside them.

use super::failure::Failure;
use super::watch::Watch;
use fieldgraft::field::Field;
use fieldgraft::grid::Lattice;
use fieldgraft::job::{self, Job};
use fieldgraft::run::place_text;
use glam::DVec3;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// Most samples that are written dense: 16 GB of f32.
const MOST: u64 = 4_000_000_000;

/// Whether the files could be put there.
pub fn check_output(path: &Path, force: bool) -> Result<(), Failure> {
    for p in [path.to_owned(), sidecar(path)] {
        if p.is_dir() {
            return Err(Failure::usage(format!("{}: is a folder", p.display())));
        }
        if !force && p.symlink_metadata().is_ok() {
            let why = "exists already; overwrite it with --force";
            return Err(Failure::usage(format!("{}: {why}", p.display())));
        }
    }
    Ok(())
}

fn sidecar(path: &Path) -> PathBuf {
    path.with_extension("json")
}

/// Samples the field on every point of the lattice and writes `f32` of shape (z, y, x), millimetres,
/// negative inside.
pub fn write(
    path: &Path,
    field: &dyn Field,
    lattice: Lattice,
    force: bool,
    watch: &Watch,
) -> Result<(), Failure> {
    if lattice.samples() > MOST {
        let why = format!("{} samples are more than {MOST}; use larger cells", lattice.samples());
        return Err(Failure::new(Failure::LIMIT, why));
    }
    watch.stage("sample");
    let fail = |e: std::io::Error| {
        Failure::new(Failure::FAILED, format!("{}: cannot be written: {e}", path.display()))
    };
    let mut out = BufWriter::new(fieldgraft::place::beside(path).map_err(fail)?);
    out.write_all(&header(lattice.size)).map_err(fail)?;
    let [nx, ny, nz] = lattice.size;
    let mut values = vec![0.0; nx as usize * ny as usize];
    for k in 0..nz {
        job::check(watch)?;
        watch.done(f64::from(k) / f64::from(nz));
        layer(field, &lattice, k, &mut values);
        for v in &values {
            out.write_all(&(*v as f32).to_le_bytes()).map_err(fail)?;
        }
    }
    let file = out.into_inner().map_err(|e| fail(e.into_error()))?;
    let placed = if force { file.persist(path) } else { file.persist_noclobber(path) };
    placed.map_err(|e| fail(e.error))?;
    let about = serde_json::json!({
        "origin_mm": lattice.origin.to_array(),
        "step_mm": lattice.step,
        "size": lattice.size,
        "order": "value[k, j, i] lies at origin + step * (i, j, k)",
        "sign": "negative inside",
    });
    let about = serde_json::to_string_pretty(&about).unwrap_or_default() + "\n";
    place_text(&sidecar(path), &about, force)?;
    watch.say(&format!("{}: {nx} x {ny} x {nz} samples", path.display()));
    Ok(())
}

/// The samples of one layer, rows in parallel.
fn layer(field: &dyn Field, lattice: &Lattice, k: u32, values: &mut [f64]) {
    use rayon::prelude::*;
    let nx = lattice.size[0];
    values.par_chunks_mut(nx as usize).enumerate().for_each(|(j, row)| {
        let at: Vec<DVec3> = (0..nx).map(|i| lattice.point(i, j as u32, k)).collect();
        field.values(&at, row);
    });
}

/// Version 1.0 of the format: magic, length, a Python literal padded to 64 bytes.
fn header([nx, ny, nz]: [u32; 3]) -> Vec<u8> {
    let mut text =
        format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({nz}, {ny}, {nx}), }}");
    while (10 + text.len() + 1) % 64 != 0 {
        text.push(' ');
    }
    text.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend_from_slice(&(text.len() as u16).to_le_bytes());
    bytes.extend_from_slice(text.as_bytes());
    bytes
}

#[cfg(test)]
mod tests {
    use super::header;

    #[test]
    fn the_header_is_padded_and_names_the_shape() {
        let h = header([3, 20, 100]);
        assert_eq!(h.len() % 64, 0);
        assert_eq!(&h[..8], b"\x93NUMPY\x01\x00");
        assert_eq!(usize::from(u16::from_le_bytes([h[8], h[9]])), h.len() - 10);
        let text = String::from_utf8_lossy(&h[10..]);
        assert!(text.contains("'shape': (100, 20, 3)") && text.ends_with('\n'));
    }
}
