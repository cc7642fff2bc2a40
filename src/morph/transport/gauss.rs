//! Convolution with a Gaussian axis by axis, over the whole length of each axis: mass must feel what
//! is far, where the Gaussian is tiny but not zero, so it is neither cut off nor done by FFT.

use crate::job::{Cancelled, Job, check};
use rayon::prelude::*;

/// Least factor of a kernel: it reaches 15 √γ far along an axis.
const LEAST: f64 = 1e-100;
/// What is less counts as nothing. Times a factor it is still a normal number, and those that are
/// not cost a hundred times more.
const NOTHING: f64 = 1e-200;

/// Samples that one thread takes at least: handing out less costs more than it gains.
pub(super) const SHARE: usize = 1 << 15;

/// `x`, or 0 where it is next to nothing.
pub(super) fn flushed(x: f64) -> f64 {
    if x < NOTHING { 0.0 } else { x }
}

/// A Gaussian over a lattice, exp(-r² / γ), r in samples.
pub(super) struct Gauss {
    size: [usize; 3],
    /// By axis: the kernel at -(n - 1) ..= n - 1.
    kernels: [Vec<f64>; 3],
}

impl Gauss {
    pub fn new(size: [u32; 3]) -> Self {
        Self { size: size.map(|n| n as usize), kernels: [const { Vec::new() }; 3] }
    }

    /// Another width.
    pub fn set(&mut self, gamma: f64) {
        self.kernels = self.size.map(|n| {
            let at = |i: usize| i as f64 - (n as f64 - 1.0);
            let factor = |i: usize| (-at(i) * at(i) / gamma).exp();
            (0..2 * n - 1).map(|i| if factor(i) < LEAST { 0.0 } else { factor(i) }).collect()
        });
    }

    /// Of samples that are zero along most rows.
    pub fn from(&self, mut data: Vec<f64>, job: &dyn Job) -> Result<Vec<f64>, Cancelled> {
        check(job)?;
        let all = vec![true; self.size[1]];
        self.planes(&mut data, |_| &all, [0, 1]);
        check(job)?;
        Ok(self.across(&data))
    }

    /// Where only some rows along x are wanted; the others are left unfinished.
    pub fn onto(&self, data: &[f64], rows: &[bool], job: &dyn Job) -> Result<Vec<f64>, Cancelled> {
        check(job)?;
        let mut data = self.across(data);
        check(job)?;
        let y = self.size[1];
        self.planes(&mut data, |k| &rows[k * y..(k + 1) * y], [1, 0]);
        Ok(data)
    }

    /// Along x (0) and y (1) in every plane, in that order.
    fn planes<'a>(
        &self,
        data: &mut [f64],
        rows: impl Fn(usize) -> &'a [bool] + Sync,
        order: [usize; 2],
    ) {
        let [x, y, _] = self.size;
        let share = SHARE / (x * y) + 1;
        data.par_chunks_exact_mut(x * y).with_min_len(share).enumerate().for_each(|(k, plane)| {
            let rows = rows(k);
            if !rows.contains(&true) {
                return;
            }
            for axis in order {
                match axis {
                    0 => self.along_x(plane, rows),
                    _ => self.along_y(plane, rows),
                }
            }
        });
    }

    fn along_x(&self, plane: &mut [f64], rows: &[bool]) {
        let x = self.size[0];
        let mut out = vec![0.0; x];
        for (row, _) in plane.chunks_exact_mut(x).zip(rows).filter(|(_, wanted)| **wanted) {
            if row.iter().all(|&v| v == 0.0) {
                continue;
            }
            out.fill(0.0);
            for (i, &v) in row.iter().enumerate().filter(|(_, v)| **v != 0.0) {
                add(&mut out, v, &self.kernels[0][x - 1 - i..2 * x - 1 - i]);
            }
            row.iter_mut().zip(&out).for_each(|(to, &v)| *to = flushed(v));
        }
    }

    fn along_y(&self, plane: &mut [f64], rows: &[bool]) {
        let [x, y, _] = self.size;
        let full: Vec<bool> =
            plane.chunks_exact(x).map(|row| row.iter().any(|&v| v != 0.0)).collect();
        let mut out = vec![0.0; x * y];
        for (j, to) in out.chunks_exact_mut(x).enumerate().filter(|(j, _)| rows[*j]) {
            for (i, from) in plane.chunks_exact(x).enumerate().filter(|(i, _)| full[*i]) {
                add(to, self.kernels[1][y - 1 + j - i], from);
            }
        }
        plane.iter_mut().zip(&out).for_each(|(to, &v)| *to = flushed(v));
    }

    /// Along z.
    fn across(&self, data: &[f64]) -> Vec<f64> {
        let [x, y, z] = self.size;
        let full: Vec<bool> =
            data.chunks_exact(x * y).map(|p| p.iter().any(|&v| v != 0.0)).collect();
        let mut out = vec![0.0; data.len()];
        let share = SHARE / (x * y) + 1;
        out.par_chunks_exact_mut(x * y).with_min_len(share).enumerate().for_each(|(k, to)| {
            for (i, from) in data.chunks_exact(x * y).enumerate().filter(|(i, _)| full[*i]) {
                add(to, self.kernels[2][z - 1 + k - i], from);
            }
            to.iter_mut().for_each(|v| *v = flushed(*v));
        });
        out
    }
}

/// to += factor * from
fn add(to: &mut [f64], factor: f64, from: &[f64]) {
    if factor == 0.0 {
        return;
    }
    for (t, f) in to.iter_mut().zip(from) {
        *t += factor * f;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Quiet;

    #[test]
    fn a_point_becomes_the_kernel_and_masks_agree() {
        let (size, gamma) = ([7u32, 5, 6], 3.0);
        let mut gauss = Gauss::new(size);
        gauss.set(gamma);
        let [x, y, z] = gauss.size;
        let mut one = vec![0.0; x * y * z];
        one[2 + x * (3 + y)] = 2.0;
        let got = gauss.from(one.clone(), &Quiet).unwrap();
        for (n, got) in got.iter().enumerate() {
            let d = [n % x, n / x % y, n / (x * y)].map(|i| i as f64);
            let r2 = (d[0] - 2.0).powi(2) + (d[1] - 3.0).powi(2) + (d[2] - 1.0).powi(2);
            assert!((got - 2.0 * (-r2 / gamma).exp()).abs() < 1e-14);
        }
        let some: Vec<f64> = (0..x * y * z).map(|n| ((n * 37) % 11) as f64).collect();
        let whole = gauss.from(some.clone(), &Quiet).unwrap();
        let rows: Vec<bool> = (0..y * z).map(|r| r % 3 == 1).collect();
        let part = gauss.onto(&some, &rows, &Quiet).unwrap();
        for n in (0..whole.len()).filter(|n| rows[n / x]) {
            assert!((part[n] / whole[n] - 1.0).abs() < 1e-12);
        }
    }
}
