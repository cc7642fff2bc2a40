use super::Lattice;

/// Samples along a side of a brick.
pub const BRICK: u32 = 8;

/// A block of 8³ samples, or the one sign that all of them have.
#[derive(Clone, Debug, PartialEq)]
pub enum Brick<T> {
    /// Every sample is inside (f < 0).
    Inside,
    /// Every sample is outside (f >= 0).
    Outside,
    /// The samples, x fastest: sample (i, j, k) of the brick at `i + 8 j + 64 k`.
    Band(Box<[T; 512]>),
}

/// Samples over a lattice, in bricks of 8³; brick (a, b, c) holds samples 8a.., 8b.., 8c.. .
///
/// The last bricks may reach beyond the lattice; their samples there mean nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Bricks<T> {
    /// Where the samples lie.
    pub lattice: Lattice,
    /// Bricks along x, y, z.
    pub size: [u32; 3],
    /// All bricks, x fastest.
    pub bricks: Vec<Brick<T>>,
}

impl<T> Bricks<T> {
    /// As many bricks as the lattice needs, all of them outside.
    pub fn outside(lattice: Lattice) -> Self {
        let size = lattice.size.map(|n| n.div_ceil(BRICK));
        let count = size.iter().map(|&n| n as usize).product();
        Self {
            lattice,
            size,
            bricks: std::iter::repeat_with(|| Brick::Outside).take(count).collect(),
        }
    }

    /// Where in [`Bricks::bricks`] brick `b` stands.
    pub fn index(&self, b: [u32; 3]) -> usize {
        let [x, y, z] = b.map(|n| n as usize);
        (z * self.size[1] as usize + y) * self.size[0] as usize + x
    }

    /// Which brick stands at `index`: the inverse of [`Bricks::index`].
    pub fn place(&self, index: usize) -> [u32; 3] {
        let [x, y] = [self.size[0].max(1) as usize, self.size[1].max(1) as usize];
        [index % x, index / x % y, index / (x * y)].map(|n| n as u32)
    }

    /// Brick `b`; none outside the lattice.
    pub fn brick(&self, b: [u32; 3]) -> Option<&Brick<T>> {
        let within = b.iter().zip(&self.size).all(|(&b, &n)| b < n);
        if within { self.bricks.get(self.index(b)) } else { None }
    }

    /// Number of bricks that hold samples.
    pub fn active(&self) -> usize {
        self.bricks.iter().filter(|b| matches!(b, Brick::Band(_))).count()
    }
}

impl<T: Copy> Bricks<T> {
    /// Samples (i.., j, k) along x. Those of a brick of one sign are `inside` or `outside`; beyond
    /// the lattice everything is `outside`.
    pub fn row(&self, [i, j, k]: [i64; 3], inside: T, outside: T, out: &mut [T]) {
        let size = self.lattice.size.map(i64::from);
        out.fill(outside);
        if !(0..size[1]).contains(&j) || !(0..size[2]).contains(&k) {
            return;
        }
        let mut n = usize::try_from(-i).unwrap_or(0);
        while n < out.len() && i + (n as i64) < size[0] {
            let x = i + n as i64;
            let run = (8 - x % 8).min(size[0] - x).min((out.len() - n) as i64) as usize;
            let to = &mut out[n..n + run];
            match self.brick([(x / 8) as u32, (j / 8) as u32, (k / 8) as u32]) {
                Some(Brick::Band(s)) => {
                    let from = (x % 8 + 8 * (j % 8) + 64 * (k % 8)) as usize;
                    to.copy_from_slice(&s[from..from + run]);
                }
                Some(Brick::Inside) => to.fill(inside),
                Some(Brick::Outside) | None => {}
            }
            n += run;
        }
    }

    /// The cube of `side`³ samples from `lo` on, x fastest, by the rules of [`Bricks::row`].
    pub fn cube(&self, lo: [i64; 3], side: usize, inside: T, outside: T, out: &mut [T]) {
        out.fill(outside);
        let [xs, ys, zs] = [0, 1, 2].map(|a| runs(lo[a], side, i64::from(self.lattice.size[a])));
        for z in &zs {
            for y in &ys {
                for x in &xs {
                    let samples = match self.brick([x.brick, y.brick, z.brick]) {
                        Some(Brick::Band(samples)) => Some(samples),
                        Some(Brick::Inside) => None,
                        Some(Brick::Outside) | None => continue,
                    };
                    for (k, j) in (0..z.len).flat_map(|k| (0..y.len).map(move |j| (k, j))) {
                        let to = x.to + side * (y.to + j + side * (z.to + k));
                        let to = &mut out[to..to + x.len];
                        match samples {
                            Some(samples) => {
                                let from = x.from + 8 * (y.from + j) + 64 * (z.from + k);
                                to.copy_from_slice(&samples[from..from + x.len]);
                            }
                            None => to.fill(inside),
                        }
                    }
                }
            }
        }
    }

    /// Sample (i, j, k), by the rules of [`Bricks::row`].
    pub fn sample(&self, at: [i64; 3], inside: T, outside: T) -> T {
        let mut one = [outside];
        self.row(at, inside, outside, &mut one);
        one[0]
    }
}

/// A run of samples along an axis in one brick.
struct Run {
    brick: u32,
    /// Its first sample within the brick, and within the whole run.
    from: usize,
    to: usize,
    len: usize,
}

/// The `side` samples from `lo` on, as far as they lie in 0..size, brick by brick.
fn runs(lo: i64, side: usize, size: i64) -> Vec<Run> {
    let wide = i64::from(BRICK);
    let mut runs = Vec::with_capacity(3);
    let (mut at, end) = (lo.max(0), (lo + side as i64).min(size));
    while at < end {
        let next = ((at / wide + 1) * wide).min(end);
        let [from, to, len] = [at % wide, at - lo, next - at].map(|n| n as usize);
        runs.push(Run { brick: (at / wide) as u32, from, to, len });
        at = next;
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::{Brick, Bricks};
    use crate::grid::Lattice;
    use glam::DVec3;

    fn some() -> Bricks<i32> {
        let lattice = Lattice { origin: DVec3::ZERO, step: 1.0, size: [19, 9, 8] };
        let mut b = Bricks::outside(lattice);
        let at = b.index([1, 0, 0]);
        b.bricks[at] = Brick::Band(Box::new(std::array::from_fn(|n| n as i32)));
        let at = b.index([2, 0, 0]);
        b.bricks[at] = Brick::Inside;
        b
    }

    #[test]
    fn place_inverts_index() {
        let b = some();
        assert_eq!((b.size, b.bricks.len(), b.active()), ([3, 2, 1], 6, 1));
        for i in 0..b.bricks.len() {
            assert_eq!(b.index(b.place(i)), i);
        }
    }

    #[test]
    fn a_row_crosses_bricks_and_ends_outside() {
        let b = some();
        let mut row = [0; 24];
        b.row([-2, 1, 2], -1, 1000, &mut row);
        let mut want = [1000; 24];
        for (n, w) in want[10..18].iter_mut().enumerate() {
            *w = n as i32 + 8 + 128;
        }
        want[18..21].fill(-1);
        assert_eq!(row, want);
        assert_eq!(b.sample([18, 0, 0], -1, 1000), -1);
        assert_eq!(b.sample([19, 0, 0], -1, 1000), 1000);
        assert_eq!(b.sample([8, -1, 0], -1, 1000), 1000);
    }
    #[test]
    fn a_cube_is_made_of_rows() {
        let b = some();
        for (lo, side) in [([-2, -1, -3], 24), ([7, 0, 0], 9), ([14, 3, 2], 10), ([0, 0, 0], 9)] {
            let mut cube = vec![0; side * side * side];
            b.cube(lo, side, -1, 1000, &mut cube);
            for (n, got) in cube.chunks_exact(side).enumerate() {
                let at = [lo[0], lo[1] + (n % side) as i64, lo[2] + (n / side) as i64];
                let mut row = vec![0; side];
                b.row(at, -1, 1000, &mut row);
                assert_eq!(got, row);
            }
        }
    }
}
