//! Symmetric band matrices: the LDLᵀ factorisation, its inertia, and solves.

/// A symmetric band matrix, lower half, row by row.
///
/// Row `r` holds columns `r - band ..= r`; the entries of the first rows that fall left of the
/// matrix exist and stay 0, so that every row has the same length.
#[derive(Clone, Debug)]
pub struct Band {
    band: usize,
    rows: Vec<f64>,
}

/// Why a matrix has no LDLᵀ factorisation without pivoting.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("pivot {row} of {rows} is zero or not a number")]
pub struct Singular {
    /// The row whose pivot failed.
    pub row: usize,
    /// Rows of the matrix.
    pub rows: usize,
}

impl Band {
    /// Numbers that a matrix of this shape stores, `None` if that overflows.
    #[must_use]
    pub fn entries(rows: usize, band: usize) -> Option<usize> {
        rows.checked_mul(band.checked_add(1)?)
    }

    /// The zero matrix with `rows` rows and `band` sub-diagonals.
    #[must_use]
    pub fn zero(rows: usize, band: usize) -> Self {
        Self { band, rows: vec![0.0; rows * (band + 1)] }
    }

    /// Number of rows.
    #[must_use]
    pub fn size(&self) -> usize {
        self.rows.len() / (self.band + 1)
    }

    /// Adds to the entry `offset` columns left of the diagonal; outside the band nothing happens.
    pub fn add(&mut self, row: usize, offset: usize, value: f64) {
        if offset <= self.band.min(row)
            && let Some(x) = self.rows.get_mut((row + 1) * (self.band + 1) - 1 - offset)
        {
            *x += value;
        }
    }

    /// Factors A = L D Lᵀ without pivoting: about rows × band² multiplications.
    ///
    /// Stable for definite matrices; for others the signs of D still give the inertia (Sylvester),
    /// though the pivots may be inaccurate when one is tiny.
    ///
    /// # Errors
    /// A pivot that is zero to rounding.
    pub fn factor(mut self) -> Result<Ldl, Singular> {
        let (band, width, size) = (self.band, self.band + 1, self.size());
        let mut pivots = vec![0.0; size];
        for r in 0..size {
            let (done, rest) = self.rows.split_at_mut(r * width);
            let row = &mut rest[..width];
            let largest = row[band].abs();
            for k in band.saturating_sub(r)..band {
                // Row `c` of L starts `band - k` columns left of this one's start.
                let c = r + k - band;
                let above = &done[c * width..][..width];
                row[k] -= dot(&row[..k], &above[band - k..band]);
            }
            // So far the row holds L D; dividing by D gives L, and their product the pivot.
            for k in band.saturating_sub(r)..band {
                let l = row[k] / pivots[r + k - band];
                row[band] -= l * row[k];
                row[k] = l;
            }
            let pivot = row[band];
            if !(pivot.abs() > 1e-14 * largest && pivot.is_finite()) {
                return Err(Singular { row: r, rows: size });
            }
            pivots[r] = pivot;
        }
        Ok(Ldl { band, rows: self.rows, pivots })
    }
}

/// The factors of a [`Band`] matrix: solves in rows × band × 2 multiplications a right side.
#[derive(Clone, Debug)]
pub struct Ldl {
    band: usize,
    rows: Vec<f64>,
    pivots: Vec<f64>,
}

impl Ldl {
    /// Negative pivots: the number of negative eigenvalues of the matrix.
    #[must_use]
    pub fn negative(&self) -> usize {
        self.pivots.iter().filter(|&&d| d < 0.0).count()
    }

    /// Solves in place for several right sides; the factor is read twice however many there are.
    ///
    /// # Panics
    /// When a side has fewer numbers than the matrix has rows.
    pub fn solve(&self, sides: &mut [&mut [f64]]) {
        let (band, width) = (self.band, self.band + 1);
        for (r, row) in self.rows.chunks_exact(width).enumerate() {
            let first = band.min(r);
            for x in &mut *sides {
                let (before, here) = x.split_at_mut(r);
                here[0] -= dot(&row[band - first..band], &before[r - first..]);
            }
        }
        for x in &mut *sides {
            x.iter_mut().zip(&self.pivots).for_each(|(x, d)| *x /= d);
        }
        for (r, row) in self.rows.chunks_exact(width).enumerate().rev() {
            let first = band.min(r);
            for x in &mut *sides {
                let (before, here) = x.split_at_mut(r);
                let solved = here[0];
                for (b, l) in before[r - first..].iter_mut().zip(&row[band - first..band]) {
                    *b -= solved * l;
                }
            }
        }
    }
}

/// Inner product in eight running sums, so that it fills vector registers; the order is fixed.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (mut a, mut b) = (a.chunks_exact(8), b.chunks_exact(8));
    let mut sums = [0.0; 8];
    for (a, b) in (&mut a).zip(&mut b) {
        for ((s, a), b) in sums.iter_mut().zip(a).zip(b) {
            *s += a * b;
        }
    }
    let tail: f64 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    let [s, t, u, v, w, x, y, z] = sums;
    ((s + w) + (u + y)) + ((t + x) + (v + z)) + tail
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The chain 2, -1 plus a shift: eigenvalues 2 - 2 cos(k pi / (n + 1)) + shift.
    fn chain(size: usize, shift: f64) -> Band {
        let mut m = Band::zero(size, 1);
        for r in 0..size {
            m.add(r, 0, 2.0 + shift);
            m.add(r, 1, -1.0);
        }
        m
    }

    #[test]
    fn solves_the_chain() {
        // The second difference of x (n + 1 - x) / 2 is -1.
        let size = 40;
        let Ok(ldl) = chain(size, 0.0).factor() else { panic!("the chain is definite") };
        assert_eq!(ldl.negative(), 0);
        let (mut ones, mut twos) = (vec![1.0; size], vec![2.0; size]);
        ldl.solve(&mut [&mut ones, &mut twos]);
        for i in 0..size {
            let x = (i + 1) as f64;
            let want = x * (size as f64 + 1.0 - x) / 2.0;
            assert!((ones[i] - want).abs() < 1e-11 && (twos[i] - 2.0 * want).abs() < 1e-11);
        }
    }

    #[test]
    fn counts_negative_eigenvalues() {
        let size = 30;
        for shift in [-0.1, -0.51, -1.3, -2.1] {
            let want = (1..=size)
                .map(|k| 2.0 - 2.0 * (std::f64::consts::PI * k as f64 / 31.0).cos() + shift)
                .filter(|&e| e < 0.0)
                .count();
            assert_eq!(chain(size, shift).factor().map(|l| l.negative()), Ok(want), "{shift}");
        }
    }

    #[test]
    fn wide_bands_solve() {
        // A = full band of decaying entries, diagonally dominant; the residual is the test.
        let (size, band) = (60, 19);
        let entry = |r: usize, c: usize| match r.abs_diff(c) {
            0 => 30.0 + r as f64,
            d if d <= band => (1.0 + (r * c % 7) as f64) / d as f64,
            _ => 0.0,
        };
        let mut m = Band::zero(size, band);
        for r in 0..size {
            for offset in 0..=band.min(r) {
                m.add(r, offset, entry(r, r - offset));
            }
        }
        let side: Vec<f64> = (0..size).map(|r| (r as f64).sin()).collect();
        let mut x = side.clone();
        let Ok(ldl) = m.factor() else { panic!("dominant") };
        ldl.solve(&mut [&mut x]);
        for (r, want) in side.iter().enumerate() {
            let got: f64 = (0..size).map(|c| entry(r, c) * x[c]).sum();
            assert!((got - want).abs() < 1e-12);
        }
    }

    #[test]
    fn a_zero_pivot_is_an_error() {
        let mut m = chain(3, 0.0);
        m.add(1, 0, -1.5);
        assert_eq!(m.factor().map(|l| l.negative()), Err(Singular { row: 1, rows: 3 }));
    }
}
