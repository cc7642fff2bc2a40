//! Convolution with a Gaussian axis by axis, over the whole length of each axis: mass must feel what
//! is far, where the Gaussian is tiny but not zero, so it is neither cut off nor done by FFT. Along
//! an axis it is a product with a symmetric matrix.

use crate::job::{Cancelled, Job, check};
use ndarray::linalg::general_mat_mul;
use ndarray::{Array2, ArrayView2, ArrayViewMut2, Axis, Slice};
use rayon::prelude::*;

/// Least factor of a kernel: it reaches 15 √γ far along an axis.
const LEAST: f64 = 1e-100;
/// What is less counts as nothing. Times a factor it is still a normal number, and those that are
/// not cost a hundred times more.
const NOTHING: f64 = 1e-200;

/// Samples that one thread takes at least: handing out less costs more than it gains.
pub(super) const SHARE: usize = 1 << 15;

/// Columns of a product along z that are made at once.
const COLUMNS: usize = 1024;

/// `x`, or 0 where it is next to nothing.
pub(super) fn flushed(x: f64) -> f64 {
    if x < NOTHING { 0.0 } else { x }
}

/// A Gaussian over a lattice, exp(-r² / γ), r in samples.
pub(super) struct Gauss {
    size: [usize; 3],
    /// By axis: the factors between all places along it.
    kernels: [Array2<f64>; 3],
}

impl Gauss {
    pub fn new(size: [u32; 3], gamma: f64) -> Self {
        let size = size.map(|n| n as usize);
        let kernels = size.map(|n| {
            Array2::from_shape_fn((n, n), |(i, j)| {
                let r = i.abs_diff(j) as f64;
                let factor = (-r * r / gamma).exp();
                if factor < LEAST { 0.0 } else { factor }
            })
        });
        Self { size, kernels }
    }

    /// Of samples that are zero along most rows.
    pub fn from(&self, mut data: Vec<f64>, job: &dyn Job) -> Result<Vec<f64>, Cancelled> {
        check(job)?;
        self.planes(&mut data, |_, plane| {
            let rows = indices(plane.rows().into_iter().map(|r| r.iter().any(|&v| v != 0.0)));
            let along_x = flush(plane.select(Axis(0), &rows).dot(&self.kernels[0]));
            // the matrix is symmetric: its rows are its columns
            let spread = self.kernels[1].select(Axis(0), &rows);
            plane.assign(&flush(spread.t().dot(&along_x)));
        });
        check(job)?;
        Ok(self.across(&data))
    }

    /// Where only some rows along x are wanted; the others are left unfinished.
    pub fn onto(&self, data: &[f64], rows: &[bool], job: &dyn Job) -> Result<Vec<f64>, Cancelled> {
        check(job)?;
        let mut data = self.across(data);
        check(job)?;
        let y = self.size[1];
        self.planes(&mut data, |k, plane| {
            let rows = indices(rows[k * y..(k + 1) * y].iter().copied());
            let along_y = flush(self.kernels[1].select(Axis(0), &rows).dot(plane));
            let done = flush(along_y.dot(&self.kernels[0]));
            rows.iter().zip(done.rows()).for_each(|(&j, row)| plane.row_mut(j).assign(&row));
        });
        Ok(data)
    }

    /// Every plane of one z.
    fn planes(&self, data: &mut [f64], each: impl Fn(usize, &mut ArrayViewMut2<'_, f64>) + Sync) {
        let [x, y, _] = self.size;
        data.par_chunks_exact_mut(x * y).enumerate().for_each(|(k, plane)| {
            if let Ok(mut plane) = ArrayViewMut2::from_shape((y, x), plane) {
                each(k, &mut plane);
            }
        });
    }

    /// Along z.
    fn across(&self, data: &[f64]) -> Vec<f64> {
        let [x, y, z] = self.size;
        let mut out = Array2::zeros((z, x * y));
        let full = indices(data.chunks_exact(x * y).map(|p| p.iter().any(|&v| v != 0.0)));
        if let (Some(&first), Some(&last), Ok(data)) =
            (full.first(), full.last(), ArrayView2::from_shape((z, x * y), data))
        {
            let range = Slice::from(first..=last);
            let planes = data.slice_axis(Axis(0), range);
            let kernel = self.kernels[2].slice_axis(Axis(1), range);
            let columns = planes.axis_chunks_iter(Axis(1), COLUMNS).into_par_iter();
            let outs = out.axis_chunks_iter_mut(Axis(1), COLUMNS).into_par_iter();
            outs.zip(columns).for_each(|(mut out, columns)| {
                general_mat_mul(1.0, &kernel, &columns, 0.0, &mut out);
                out.mapv_inplace(flushed);
            });
        }
        out.into_raw_vec_and_offset().0
    }
}

fn indices(wanted: impl Iterator<Item = bool>) -> Vec<usize> {
    wanted.enumerate().filter_map(|(i, w)| w.then_some(i)).collect()
}

fn flush(mut values: Array2<f64>) -> Array2<f64> {
    values.mapv_inplace(flushed);
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Quiet;

    #[test]
    fn a_point_becomes_the_kernel_and_masks_agree() {
        let (size, gamma) = ([7u32, 5, 6], 3.0);
        let gauss = Gauss::new(size, gamma);
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
