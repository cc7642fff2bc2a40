//! Small dense least squares: Householder QR with column pivoting.

/// A dense matrix, held by columns.
#[derive(Clone, Debug, PartialEq)]
pub struct Dense {
    rows: usize,
    cols: usize,
    data: Vec<f64>,
}

impl Dense {
    /// Zeros.
    pub fn new(rows: usize, cols: usize) -> Self {
        Self { rows, cols, data: vec![0.0; rows * cols] }
    }

    /// From its entries, row and column given.
    pub fn from_fn(rows: usize, cols: usize, f: impl Fn(usize, usize) -> f64) -> Self {
        let at = |j| (0..rows).map(move |i| (i, j));
        Self { rows, cols, data: (0..cols).flat_map(at).map(|(i, j)| f(i, j)).collect() }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// A column.
    pub fn col(&self, j: usize) -> &[f64] {
        &self.data[j * self.rows..(j + 1) * self.rows]
    }

    /// A column, to write.
    pub fn col_mut(&mut self, j: usize) -> &mut [f64] {
        &mut self.data[j * self.rows..(j + 1) * self.rows]
    }

    /// An entry.
    pub fn at(&self, i: usize, j: usize) -> f64 {
        self.data[j * self.rows + i]
    }
}

/// The least-squares solution of smallest norm.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// A column of unknowns for every right-hand side.
    pub x: Dense,
    /// Number of independent columns.
    pub rank: usize,
    /// Largest over smallest diagonal entry of R, columns scaled to length one: within a small factor
    /// of the condition number. Infinite when `rank` is less than the number of columns.
    pub condition: f64,
}

/// Pivots below this part of the largest count as zero: a hundred times the round-off of a few
/// hundred operations, and far below what the data of a well-posed problem leave.
const NOTHING: f64 = 1e-13;

/// Minimises |A X - B| column by column of B.
///
/// Columns of A are scaled to length one first. Where they are dependent, the scaled unknowns are
/// those of smallest norm. A and B have equally many rows.
pub fn solve(mut a: Dense, mut b: Dense) -> Solution {
    let lengths: Vec<f64> = (0..a.cols).map(|j| length(a.col(j))).collect();
    for (j, &n) in lengths.iter().enumerate().filter(|(_, n)| **n > 0.0) {
        a.col_mut(j).iter_mut().for_each(|x| *x /= n);
    }
    let (order, rank, condition) = triangle(&mut a, &mut b);
    let mut y = if rank == a.cols { upper(&a, &b, rank) } else { least(&a, &b, rank) };
    let mut x = Dense::new(a.cols, b.cols);
    for c in 0..b.cols {
        for (from, &to) in order.iter().enumerate() {
            let n = if lengths[to] > 0.0 { lengths[to] } else { 1.0 };
            x.col_mut(c)[to] = y.col_mut(c)[from] / n;
        }
    }
    Solution { x, rank, condition }
}

/// The triangle R of A = QR, without pivoting: as many rows as needed for all that A says about
/// least squares.
pub fn compress(mut a: Dense) -> Dense {
    let steps = a.rows.min(a.cols);
    let mut none = Dense::new(a.rows, 0);
    for k in 0..steps {
        reflect(&mut a, &mut none, k);
    }
    Dense::from_fn(steps, a.cols, |i, j| if i <= j { a.at(i, j) } else { 0.0 })
}

fn length(x: &[f64]) -> f64 {
    // scaled, so that squares neither overflow nor vanish
    let most = x.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    if most == 0.0 || !most.is_finite() {
        return most;
    }
    most * x.iter().map(|x| (x / most) * (x / most)).sum::<f64>().sqrt()
}

/// Turns A into R in place, its columns in the returned order, and B into Q^T B.
fn triangle(a: &mut Dense, b: &mut Dense) -> (Vec<usize>, usize, f64) {
    let mut order: Vec<usize> = (0..a.cols).collect();
    let (mut first, mut last) = (0.0, 0.0);
    for k in 0..a.rows.min(a.cols) {
        let rest = |j: usize| length(&a.col(j)[k..]);
        let best =
            (k..a.cols).map(|j| (j, rest(j))).fold((k, -1.0), |m, c| if c.1 > m.1 { c } else { m });
        first = if k == 0 { best.1 } else { first };
        if best.1 <= NOTHING * first {
            return (order, k, f64::INFINITY);
        }
        last = best.1;
        if best.0 != k {
            order.swap(k, best.0);
            for i in 0..a.rows {
                a.data.swap(k * a.rows + i, best.0 * a.rows + i);
            }
        }
        reflect(a, b, k);
    }
    let rank = a.rows.min(a.cols);
    let condition = if rank < a.cols { f64::INFINITY } else { first / last };
    (order, rank, if a.cols == 0 { 1.0 } else { condition })
}

/// The reflection that ends column `k` below its diagonal, applied to all later columns and to B.
/// The reflector, of length sqrt(2), stays below the diagonal of column `k`, its head beside it.
fn reflect(a: &mut Dense, b: &mut Dense, k: usize) -> f64 {
    let mut w = a.col(k)[k..].to_vec();
    let n = length(&w);
    if n == 0.0 {
        return 0.0;
    }
    let alpha = if w[0] > 0.0 { -n } else { n };
    w[0] -= alpha;
    let size = length(&w);
    w.iter_mut().for_each(|x| *x *= std::f64::consts::SQRT_2 / size);
    for j in k..a.cols {
        mirror(&w, &mut a.col_mut(j)[k..]);
    }
    for j in 0..b.cols {
        mirror(&w, &mut b.col_mut(j)[k..]);
    }
    let head = w[0];
    a.col_mut(k)[k] = alpha;
    a.col_mut(k)[k + 1..].copy_from_slice(&w[1..]);
    head
}

/// x - w (w.x), for w.w = 2.
fn mirror(w: &[f64], x: &mut [f64]) {
    let dot: f64 = w.iter().zip(&*x).map(|(w, x)| w * x).sum();
    for (x, w) in x.iter_mut().zip(w) {
        *x -= dot * w;
    }
}

/// R y = b by back substitution, R the leading `n` rows and columns.
fn upper(r: &Dense, b: &Dense, n: usize) -> Dense {
    let mut y = Dense::new(r.cols, b.cols);
    for c in 0..b.cols {
        for i in (0..n).rev() {
            let known: f64 = (i + 1..n).map(|j| r.at(i, j) * y.at(j, c)).sum();
            y.col_mut(c)[i] = (b.at(i, c) - known) / r.at(i, i);
        }
    }
    y
}

/// The y of smallest norm with [R11 R12] y = b: through the triangle of the transpose.
fn least(r: &Dense, b: &Dense, rank: usize) -> Dense {
    let wide = |i: usize, j: usize| if j >= i { r.at(i, j) } else { 0.0 };
    let mut t = Dense::from_fn(r.cols, rank, |i, j| wide(j, i));
    let mut none = Dense::new(r.cols, 0);
    let heads: Vec<f64> = (0..rank).map(|k| reflect(&mut t, &mut none, k)).collect();
    let mut y = Dense::new(r.cols, b.cols);
    for c in 0..b.cols {
        for i in 0..rank {
            let known: f64 = (0..i).map(|j| t.at(j, i) * y.at(j, c)).sum();
            y.col_mut(c)[i] = (b.at(i, c) - known) / t.at(i, i);
        }
        for k in (0..rank).rev() {
            let mut w = t.col(k)[k..].to_vec();
            w[0] = heads[k];
            mirror(&w, &mut y.col_mut(c)[k..]);
        }
    }
    y
}

#[cfg(test)]
mod tests {
    use super::{Dense, compress, solve};
    use proptest::prelude::*;

    fn times(a: &Dense, x: &Dense) -> Dense {
        let dot = |i, c| (0..a.cols()).map(|j| a.at(i, j) * x.at(j, c)).sum();
        Dense::from_fn(a.rows(), x.cols(), dot)
    }

    #[test]
    fn a_line_through_three_points() {
        // y = a + b x through (0, 1), (1, 3), (2, 4): a = 7/6, b = 3/2
        let a = Dense::from_fn(3, 2, |i, j| if j == 0 { 1.0 } else { i as f64 });
        let b = Dense::from_fn(3, 1, |i, _| [1.0, 3.0, 4.0][i]);
        let s = solve(a, b);
        assert!((s.x.at(0, 0) - 7.0 / 6.0).abs() < 1e-15 && (s.x.at(1, 0) - 1.5).abs() < 1e-15);
        assert!(s.rank == 2 && s.condition < 10.0);
    }

    #[test]
    fn dependent_columns_share_the_load() {
        // x + y = 2 twice over, and z free: the smallest solution is (1, 1, 0)
        let a = Dense::from_fn(3, 3, |_, j| if j < 2 { 1.0 } else { 0.0 });
        let s = solve(a, Dense::from_fn(3, 1, |_, _| 2.0));
        assert_eq!((s.rank, s.condition), (1, f64::INFINITY));
        for (j, expected) in [1.0, 1.0, 0.0].into_iter().enumerate() {
            assert!((s.x.at(j, 0) - expected).abs() < 1e-14);
        }
    }

    #[test]
    fn nothing_is_solved_by_nothing() {
        let s = solve(Dense::new(4, 2), Dense::from_fn(4, 1, |_, _| 1.0));
        assert_eq!((s.rank, s.x), (0, Dense::new(2, 1)));
        assert_eq!(solve(Dense::new(4, 0), Dense::new(4, 3)).rank, 0);
        assert_eq!(solve(Dense::new(0, 2), Dense::new(0, 1)).x, Dense::new(2, 1));
    }

    #[test]
    fn an_ill_conditioned_matrix_says_so() {
        // Hilbert 6 x 6: condition number 1.5e7; its scaling changes that little
        let h = Dense::from_fn(6, 6, |i, j| 1.0 / (i + j + 1) as f64);
        let s = solve(h.clone(), times(&h, &Dense::from_fn(6, 1, |_, _| 1.0)));
        assert!((1e5..1e8).contains(&s.condition), "{}", s.condition);
        assert!((0..6).all(|j| (s.x.at(j, 0) - 1.0).abs() < 1e-8));
    }

    proptest! {
        #[test]
        fn residuals_are_normal_and_solutions_least(
            rows in 1..9usize, cols in 1..7usize, rank in 1..7usize,
            data in prop::collection::vec(-1.0..1.0f64, 200),
        ) {
            let rank = rank.min(rows).min(cols);
            let d = |i: usize| data[i % 200];
            let left = Dense::from_fn(rows, rank, |i, j| d(i * 7 + j));
            let right = Dense::from_fn(rank, cols, |i, j| d(70 + i * 7 + j));
            let a = times(&left, &right);
            let b = Dense::from_fn(rows, 2, |i, j| d(150 + 2 * i + j));
            let s = solve(a.clone(), b.clone());
            // random factors may be nearly dependent: such cases say so themselves
            prop_assume!(s.rank == rank);
            let r = times(&a, &s.x);
            for c in 0..2 {
                for j in 0..cols {
                    let n: f64 = (0..rows).map(|i| a.at(i, j) * (r.at(i, c) - b.at(i, c))).sum();
                    prop_assert!(n.abs() < 1e-9, "{n}");
                }
            }
            // R says the same about lengths as A does
            let (u, v) = (times(&compress(a), &s.x), r);
            for c in 0..2 {
                let square = |m: &Dense| m.col(c).iter().map(|x| x * x).sum::<f64>();
                prop_assert!((square(&u) - square(&v)).abs() < 1e-9 * (1.0 + square(&v)));
            }
        }
    }
}
