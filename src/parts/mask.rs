//! Sections of a volume: what is solid in a plane, cell by cell.

use glam::{DMat2, DVec2};

/// A picture of cells that are on or off, x fastest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Mask {
    pub nx: usize,
    pub ny: usize,
    bits: Vec<bool>,
}

/// Cells that hang together, in raster order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Region {
    pub cells: Vec<[usize; 2]>,
}

impl Mask {
    pub fn new(nx: usize, bits: Vec<bool>) -> Self {
        Self { nx, ny: bits.len() / nx.max(1), bits }
    }

    pub fn empty(nx: usize, ny: usize) -> Self {
        Self { nx, ny, bits: vec![false; nx * ny] }
    }

    pub fn get(&self, x: usize, y: usize) -> bool {
        x < self.nx && y < self.ny && self.bits[y * self.nx + x]
    }

    pub fn set(&mut self, x: usize, y: usize) {
        if x < self.nx && y < self.ny {
            self.bits[y * self.nx + x] = true;
        }
    }

    pub fn count(&self) -> usize {
        self.bits.iter().filter(|b| **b).count()
    }

    pub fn or(&mut self, other: &Mask) {
        self.bits.iter_mut().zip(&other.bits).for_each(|(a, b)| *a |= b);
    }

    pub fn and(&self, other: &Mask) -> Mask {
        let bits = self.bits.iter().zip(&other.bits).map(|(a, b)| *a && *b).collect();
        Mask { bits, ..*self }
    }

    /// The cells that are on.
    pub fn cells(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        let on = self.bits.iter().enumerate().filter(|(_, b)| **b);
        on.map(|(n, _)| [n % self.nx, n / self.nx])
    }

    /// Every cell within `radius` of a cell that is on.
    pub fn dilated(&self, radius: f64) -> Mask {
        let mut out = Self::empty(self.nx, self.ny);
        let disc = disc(radius);
        for [x, y] in self.cells() {
            for &[dx, dy] in &disc {
                // what leaves the picture wraps round to large numbers and is not set
                out.set(x.wrapping_add_signed(dx), y.wrapping_add_signed(dy));
            }
        }
        out
    }

    fn inverse(&self) -> Mask {
        Mask { bits: self.bits.iter().map(|b| !b).collect(), ..*self }
    }

    /// Gaps narrower than twice the radius filled.
    pub fn closed(&self, radius: f64) -> Mask {
        let wide = self.dilated(radius);
        let disc = disc(radius);
        let mut out = Self::empty(self.nx, self.ny);
        for [x, y] in wide.cells() {
            // what lies beyond the picture does not wear the border down
            let kept = disc.iter().all(|&[dx, dy]| {
                let (x, y) = (x.wrapping_add_signed(dx), y.wrapping_add_signed(dy));
                x >= self.nx || y >= self.ny || wide.get(x, y)
            });
            if kept {
                out.set(x, y);
            }
        }
        out
    }

    /// With the holes that nothing leads out of filled.
    pub fn filled(&self) -> Mask {
        let mut outside = Self::empty(self.nx, self.ny);
        let mut open = Vec::new();
        let border = |x: usize, y: usize| x == 0 || y == 0 || x + 1 == self.nx || y + 1 == self.ny;
        for y in 0..self.ny {
            for x in 0..self.nx {
                if border(x, y) && !self.get(x, y) {
                    outside.set(x, y);
                    open.push([x, y]);
                }
            }
        }
        while let Some([x, y]) = open.pop() {
            for [dx, dy] in [[1, 0], [-1, 0], [0, 1], [0, -1]] {
                let (x, y) = (x.wrapping_add_signed(dx), y.wrapping_add_signed(dy));
                if x < self.nx && y < self.ny && !self.get(x, y) && !outside.get(x, y) {
                    outside.set(x, y);
                    open.push([x, y]);
                }
            }
        }
        outside.inverse()
    }

    /// The pieces that hang together by edges or corners, largest first.
    pub fn regions(&self) -> Vec<Region> {
        let mut seen = Self::empty(self.nx, self.ny);
        let mut all = Vec::new();
        for [x, y] in self.cells() {
            if seen.get(x, y) {
                continue;
            }
            seen.set(x, y);
            let (mut cells, mut next) = (vec![[x, y]], 0);
            while let Some(&[x, y]) = cells.get(next) {
                next += 1;
                for &[dx, dy] in &AROUND {
                    let (x, y) = (x.wrapping_add_signed(dx), y.wrapping_add_signed(dy));
                    if self.get(x, y) && !seen.get(x, y) {
                        seen.set(x, y);
                        cells.push([x, y]);
                    }
                }
            }
            cells.sort_by_key(|c| (c[1], c[0]));
            all.push(Region { cells });
        }
        // stable: equal ones stay in raster order
        all.sort_by_key(|r| std::cmp::Reverse(r.cells.len()));
        all
    }
}

const AROUND: [[isize; 2]; 8] =
    [[1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [1, -1], [-1, 1], [-1, -1]];

/// Offsets within a radius.
fn disc(radius: f64) -> Vec<[isize; 2]> {
    let r = radius.floor() as isize;
    let within = |d: &[isize; 2]| ((d[0] * d[0] + d[1] * d[1]) as f64) <= radius * radius;
    (-r..=r).flat_map(|y| (-r..=r).map(move |x| [x, y])).filter(within).collect()
}

impl Region {
    pub fn area(&self) -> f64 {
        self.cells.len() as f64
    }

    pub fn points(&self) -> impl Iterator<Item = DVec2> + '_ {
        self.cells.iter().map(|c| DVec2::new(c[0] as f64, c[1] as f64))
    }

    pub fn centre(&self) -> DVec2 {
        self.points().sum::<DVec2>() / self.area().max(1.0)
    }

    pub fn mask(&self, nx: usize, ny: usize) -> Mask {
        let mut mask = Mask::empty(nx, ny);
        self.cells.iter().for_each(|c| mask.set(c[0], c[1]));
        mask
    }

    /// Extent along x and y, in cells.
    pub fn extent(&self) -> DVec2 {
        let low = self.points().fold(DVec2::INFINITY, DVec2::min);
        let high = self.points().fold(DVec2::NEG_INFINITY, DVec2::max);
        high - low + 1.0
    }

    /// Extent along the longer principal axis and across it, in cells.
    pub fn spread(&self) -> DVec2 {
        let c = self.centre();
        let mut m = DMat2::ZERO;
        for p in self.points() {
            let d = p - c;
            m += DMat2::from_cols(d * d.x, d * d.y);
        }
        let angle = 0.5 * (2.0 * m.x_axis.y).atan2(m.x_axis.x - m.y_axis.y);
        let along = DVec2::from_angle(angle);
        let across = along.perp();
        let reach = |axis: DVec2| {
            let (lo, hi) = self
                .points()
                .map(|p| p.dot(axis))
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| (lo.min(x), hi.max(x)));
            hi - lo + 1.0
        };
        DVec2::new(reach(along), reach(across))
    }

    /// Share of a disc round the region's own centre that it covers.
    pub fn core(&self, radius: f64) -> f64 {
        let c = self.centre();
        let near = self.points().filter(|p| p.distance(c) <= radius).count() as f64;
        let cells = disc(radius).len().max(1) as f64;
        (near / cells).min(1.0)
    }
}

/// The value below which a share of the numbers lie; 0 for none.
pub(super) fn quantile(numbers: &[f64], share: f64) -> f64 {
    let mut sorted = numbers.to_vec();
    sorted.sort_by(f64::total_cmp);
    match sorted.len() {
        0 => 0.0,
        n => {
            let at = share.clamp(0.0, 1.0) * (n - 1) as f64;
            let (low, high) = (at.floor() as usize, at.ceil() as usize);
            sorted[low] + (sorted[high] - sorted[low]) * at.fract()
        }
    }
}

/// The middle one; 0 for none.
pub(super) fn median(numbers: &[f64]) -> f64 {
    quantile(numbers, 0.5)
}

/// y = a + b x with the least sum of absolute residuals, by repeated weighting; b = 0 where the
/// x do not differ.
pub(super) fn line(points: &[(f64, f64)]) -> (f64, f64) {
    let mut fit = (0.0, 0.0);
    let mut weights = vec![1.0; points.len()];
    for _ in 0..20 {
        let sum = |f: &dyn Fn(f64, f64) -> f64| -> f64 {
            points.iter().zip(&weights).map(|(&(x, y), w)| w * f(x, y)).sum()
        };
        let n = sum(&|_, _| 1.0);
        if n <= 0.0 {
            return fit;
        }
        let (mx, my) = (sum(&|x, _| x) / n, sum(&|_, y| y) / n);
        let sxx = sum(&|x, _| (x - mx).powi(2));
        let sxy = sum(&|x, y| (x - mx) * (y - my));
        let b = if sxx > 1e-9 { sxy / sxx } else { 0.0 };
        fit = (my - b * mx, b);
        for (w, &(x, y)) in weights.iter_mut().zip(points) {
            *w = 1.0 / (y - fit.0 - fit.1 * x).abs().max(0.05);
        }
    }
    fit
}
