//! Eight points walk the tree of dipoles together. Each opens only what it must, and every lane's
//! arithmetic is its own: the result is that of the point alone, bit for bit.

use super::Winding;
use super::dipole::Dipole;
use crate::bvh::Node;
use crate::bvh::triangle::LANES;
use crate::num::lanes::Vec8;
use fearless_simd::{Simd, SimdMask, f64x8, mask64x8, prelude::*};
use glam::DVec3;
use std::f64::consts::PI;

impl Dipole {
    /// 4 pi times the winding number seen from d = centre - q, |d|² = r2.
    #[inline(always)]
    fn solid_angle<S: Simd>(&self, d: Vec8<S>, r2: f64x8<S>) -> f64x8<S> {
        let i2 = f64x8::splat(r2.token(), 1.0) / r2;
        let Vec8 { x, y, z } = d;
        let i3 = i2 * i2.sqrt();
        let [xx, yy, zz, xy, xz, yz] = self.second;
        let (ax, ay, az) = (x * xx, y * yy, z * zz);
        let square = ax * x + ay * y + az * z + x * xy * y + x * xz * z + y * yz * z;
        let t = &self.third;
        let cube = x * x * (x * t[0] + y * t[3] + z * t[4])
            + y * y * (y * t[1] + x * t[5] + z * t[6])
            + z * z * (z * t[2] + x * t[7] + y * t[8])
            + x * t[9] * y * z;
        let lines = square * 3.0 + d.along(self.third_line) * 1.5;
        i3 * (d.along(self.first) + self.trace - i2 * (lines - i2 * 7.5 * cube))
    }
}

/// Angles in (-pi, pi] summed as a product of complex numbers: one arc tangent for all, and the
/// full turns counted by the side of the real axis on which each factor lies.
struct Angles<S: Simd> {
    re: f64x8<S>,
    im: f64x8<S>,
    turns: f64x8<S>,
}

impl<S: Simd> Angles<S> {
    #[inline(always)]
    fn none(s: S) -> Self {
        let zero = f64x8::splat(s, 0.0);
        Self { re: f64x8::splat(s, 1.0), im: zero, turns: zero }
    }

    /// Adds the direction of `re` + i `im` in the lanes of `here`.
    #[inline(always)]
    fn add(&mut self, re: f64x8<S>, im: f64x8<S>, here: mask64x8<S>) {
        let s = re.token();
        let (zero, one) = (f64x8::splat(s, 0.0), f64x8::splat(s, 1.0));
        let (x, y) = (self.re * re - self.im * im, self.re * im + self.im * re);
        let size = x.abs().max(y.abs());
        // a point on a corner sees nothing of that triangle; no number is greater than none
        let here = here & size.simd_gt(zero) & x.simd_eq(x) & y.simd_eq(y);
        let up = self.im.simd_ge(zero) & im.simd_ge(zero) & y.simd_lt(zero);
        let flat = y.simd_eq(zero) & x.simd_lt(zero);
        let down = self.im.simd_lt(zero) & im.simd_lt(zero) & (y.simd_gt(zero) | flat);
        self.turns = (here & up).select(self.turns + one, self.turns);
        self.turns = (here & down).select(self.turns - one, self.turns);
        self.re = here.select(x, self.re);
        self.im = here.select(y, self.im);
        // far from where the next product could overflow or vanish nothing needs to be scaled
        let fine = size.simd_ge(f64x8::splat(s, 1e-100)) & size.simd_lt(f64x8::splat(s, 1e100));
        let scaled = here & !fine;
        if scaled.any_true() {
            self.re = scaled.select(x / size, self.re);
            self.im = scaled.select(y / size, self.im);
        }
    }

    #[inline(always)]
    fn total(&self, lane: usize) -> f64 {
        self.im[lane].atan2(self.re[lane]) + 2.0 * PI * self.turns[lane]
    }
}

impl Winding {
    #[inline(always)]
    pub(super) fn walk<S: Simd>(
        &self,
        s: S,
        at: &[DVec3],
        beta: f64,
        open: u8,
        stack: &mut Vec<(u32, u8)>,
        out: &mut [f64; LANES],
    ) {
        let beta2 = beta * beta;
        let q = Vec8::of(s, at);
        let (mut total, mut angles) = (f64x8::splat(s, 0.0), Angles::none(s));
        stack.clear();
        if !self.bvh.is_empty() {
            stack.push((0, open));
        }
        while let Some((index, open)) = stack.pop() {
            let dipole = &self.dipoles[index as usize];
            let d = q.to(dipole.centre);
            let r2 = d.dot(d);
            let here = mask64x8::from_bitmask(s, u64::from(open));
            let far = here & r2.simd_gt(f64x8::splat(s, beta2 * dipole.radius2));
            let seen = far.to_bitmask() as u8;
            if seen != 0 {
                total = far.select(total + dipole.solid_angle(d, r2), total);
            }
            let open = open & !seen;
            if open == 0 {
                continue;
            }
            let Node { first, count, .. } = self.bvh.nodes[index as usize];
            if count == 0 {
                stack.extend([(first + 1, open), (first, open)]);
                continue;
            }
            let here = mask64x8::from_bitmask(s, u64::from(open));
            for &[a, b, c] in &self.bvh.corners[first as usize..(first + count) as usize] {
                let (re, im) = half_angle([q.to(a), q.to(b), q.to(c)]);
                angles.add(re, im, here);
            }
        }
        for (i, w) in out.iter_mut().enumerate().filter(|(i, _)| open >> i & 1 == 1) {
            *w = (total[i] + 2.0 * angles.total(i)) / (4.0 * PI);
        }
    }
}

/// The halves of a triangle's signed solid angles seen from the origins, as the directions of
/// complex numbers (van Oosterom and Strackee 1983): real parts, imaginary parts.
#[inline(always)]
fn half_angle<S: Simd>([a, b, c]: [Vec8<S>; 3]) -> (f64x8<S>, f64x8<S>) {
    let (la, lb, lc) = (a.dot(a).sqrt(), b.dot(b).sqrt(), c.dot(c).sqrt());
    let across = a.dot(b.cross(c));
    (la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb, across)
}

#[cfg(test)]
mod tests {
    use super::{Angles, Vec8, half_angle};
    use fearless_simd::{Level, Simd, SimdMask, dispatch, f64x8, mask64x8, prelude::*};
    use glam::dvec3;

    fn sums<S: Simd>(s: S, step: f64, scale: f64) {
        let mut sum = Angles::none(s);
        let here = mask64x8::from_bitmask(s, 0b101);
        for n in 1..200 {
            let lane = |v| f64x8::splat(s, v);
            sum.add(lane(step.cos() * scale), lane(step.sin() * scale), here);
            for lane in [0, 2] {
                assert!((sum.total(lane) - step * f64::from(n)).abs() < 1e-10);
            }
            assert_eq!(sum.total(1), 0.0);
        }
    }

    #[test]
    fn angles_add_up_over_full_turns() {
        for step in [0.3f64, -0.3, 2.9, -2.9, 1.7] {
            for scale in [1e3, 1e60, 1e-60] {
                dispatch!(Level::new(), s => sums(s, step, scale));
            }
        }
    }

    fn octant<S: Simd>(s: S) -> f64 {
        let at = [dvec3(2.0, 0.0, 0.0), dvec3(0.0, 3.0, 0.0), dvec3(0.0, 0.0, 1.0)];
        let (re, im) = half_angle(at.map(|p| Vec8::of(s, &[p])));
        im[0].atan2(re[0])
    }

    #[test]
    fn an_octant_is_an_eighth_of_the_sphere() {
        let angle = dispatch!(Level::new(), s => octant(s));
        assert!((angle - std::f64::consts::FRAC_PI_4).abs() < 1e-15);
    }
}
