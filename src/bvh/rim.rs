use super::triangle::{LANES, Points};
use super::{Bvh, Node};
use fearless_simd::{Level, Simd, dispatch, f64x8, mask64x8, prelude::*};
use glam::DVec3;
use std::f64::consts::PI;

/// The rims of an oriented mesh: the edges where its faces do not cancel. Away from faces the
/// winding number varies only because of them, as the field of a current along the rims
/// (Biot and Savart): |grad w| <= 1/(4 pi) sum of length / distance².
#[derive(Clone, Debug)]
pub struct Rim {
    bvh: Bvh,
    /// Length of the edges in each node, times their multiplicity.
    lengths: Vec<f64>,
    /// Half the diagonal of each node's box, mm.
    radii: Vec<f64>,
    /// Length of the edge in each slot, times its multiplicity.
    edges: Vec<f64>,
}

impl Rim {
    /// From segments and how many faces are missing at each.
    pub fn new(segments: &[([DVec3; 2], u32)]) -> Self {
        let flat: Vec<_> = segments.iter().map(|&([a, b], _)| [a, b, b]).collect();
        let bvh = Bvh::new(&flat);
        let length = |&face: &u32| {
            let ([a, b], times) = segments[face as usize];
            a.distance(b) * f64::from(times)
        };
        let edges: Vec<f64> = bvh.faces.iter().map(length).collect();
        let mut lengths = vec![0.0; bvh.nodes.len()];
        for (i, &Node { first, count, .. }) in bvh.nodes.iter().enumerate().rev() {
            let (first, count) = (first as usize, count as usize);
            lengths[i] = if count > 0 {
                edges[first..first + count].iter().sum()
            } else {
                lengths[first] + lengths[first + 1]
            };
        }
        let radii = bvh.nodes.iter().map(|node| node.bounds.radius()).collect();
        Self { bvh, lengths, radii, edges }
    }

    /// Memory that they take, bytes.
    pub fn bytes(&self) -> usize {
        let own = [&self.lengths, &self.radii, &self.edges].map(|all| size_of_val(&all[..]));
        self.bvh.bytes() + own.iter().sum::<usize>()
    }

    /// Length of all rims, mm.
    pub fn length(&self) -> f64 {
        self.lengths.first().copied().unwrap_or(0.0)
    }

    /// Upper bounds of |grad w| per mm over up to eight balls, of those whose bit is set in `of`;
    /// infinite where a ball touches a rim or as soon as it exceeds its `most`, 0 for the others. What
    /// a ball gets does not depend on the others.
    pub fn variations(&self, balls: &[(DVec3, f64)], of: u8, most: [f64; LANES]) -> [f64; LANES] {
        dispatch!(Level::new(), s => self.walk(s, balls, of, most))
    }

    #[inline(always)]
    fn walk<S: Simd>(
        &self,
        s: S,
        balls: &[(DVec3, f64)],
        of: u8,
        most: [f64; LANES],
    ) -> [f64; LANES] {
        let zero = f64x8::splat(s, 0.0);
        let (mut at, mut radius) = ([DVec3::ZERO; LANES], [0.0; LANES]);
        for (i, &(centre, r)) in balls.iter().take(LANES).enumerate() {
            (at[i], radius[i]) = (centre, r);
        }
        let centre = Points::of(s, &at);
        let radius = f64x8::simd_from(s, radius);
        let most = f64x8::simd_from(s, most) * (4.0 * PI);
        let (mut total, mut stack) = (zero, Vec::with_capacity(64));
        // lanes that are not infinite yet
        let mut finite =
            of & u8::MAX.checked_shr((LANES - balls.len().min(LANES)) as u32).unwrap_or(0);
        let all = finite;
        if !self.bvh.is_empty() {
            stack.push((0u32, all));
        }
        while let Some((index, open)) = stack.pop() {
            finite &= !(total.simd_gt(most).to_bitmask() as u8);
            let open = open & finite;
            if open == 0 {
                continue;
            }
            let Node { bounds, first, count } = self.bvh.nodes[index as usize];
            let far = centre.distances(&bounds) - radius;
            let here = mask64x8::from_bitmask(s, u64::from(open));
            let seen = here & far.simd_gt(f64x8::splat(s, 2.0 * self.radii[index as usize]));
            let lengths = f64x8::splat(s, self.lengths[index as usize]);
            total = seen.select(total + lengths / (far * far), total);
            let open = open & !(seen.to_bitmask() as u8);
            if open == 0 {
                continue;
            }
            if count == 0 {
                stack.extend([(first, open), (first + 1, open)]);
                continue;
            }
            let here = mask64x8::from_bitmask(s, u64::from(open));
            for slot in first as usize..(first + count) as usize {
                let far = centre.distances2(&self.bvh.tris[slot]).sqrt() - radius;
                let meets = here & far.simd_le(zero);
                finite &= !(meets.to_bitmask() as u8);
                let edge = f64x8::splat(s, self.edges[slot]);
                total = here.select(total + edge / (far * far), total);
            }
        }
        // what was added last counts too
        finite &= !(total.simd_gt(most).to_bitmask() as u8);
        let total: [f64; LANES] = (total / (4.0 * PI)).into();
        std::array::from_fn(|i| match () {
            () if finite >> i & 1 == 1 => total[i],
            () if all >> i & 1 == 1 => f64::INFINITY,
            () => 0.0,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;
    use proptest::prelude::*;

    /// A wavy rim of so many segments.
    fn wave(n: usize) -> Vec<([DVec3; 2], u32)> {
        let at = |i: usize| {
            let a = i as f64 / n as f64 * 2.0 * PI;
            dvec3(a.cos(), a.sin(), 0.3 * (5.0 * a).sin()) * 10.0
        };
        (0..n).map(|i| ([at(i), at(i + 1)], 1 + i as u32 % 2)).collect()
    }

    proptest! {
        #[test]
        fn bounds_hold_and_are_those_of_each_ball_alone(
            balls in prop::collection::vec(((-15.0..15.0, -15.0..15.0, -9.0..9.0), 0.0..3.0), 1..9),
        ) {
            let edges = wave(300);
            let rim = Rim::new(&edges);
            let balls: Vec<(DVec3, f64)> =
                balls.into_iter().map(|((x, y, z), r)| (dvec3(x, y, z), r)).collect();
            let most = [f64::INFINITY; LANES];
            let all = rim.variations(&balls, u8::MAX, most);
            let some = rim.variations(&balls, 0b101, most);
            for (i, &ball) in balls.iter().enumerate() {
                prop_assert_eq!(rim.variations(&[ball], 1, most)[0], all[i]);
                prop_assert_eq!(some[i], if i == 0 || i == 2 { all[i] } else { 0.0 });
                // the current's field where it is greatest, taken at the ends of each segment
                let nearest = |p: DVec3| (p.distance(ball.0) - ball.1).max(0.0);
                let least: f64 = edges
                    .iter()
                    .map(|&([a, b], n)| {
                        let far = nearest(a).max(nearest(b)).max(a.distance(b));
                        a.distance(b) * f64::from(n) / (far * far)
                    })
                    .sum();
                let touches = edges.iter().any(|([a, b], _)| nearest(*a).min(nearest(*b)) <= 0.0);
                prop_assert!(!touches || all[i].is_infinite());
                prop_assert!(all[i] * 4.0 * PI > 0.9 * least, "{} {}", all[i] * 4.0 * PI, least);
                // not much more than that where the rim is far
                let far = edges.iter().all(|([a, _], _)| nearest(*a) > 3.0);
                prop_assert!(!far || all[i] * 4.0 * PI < 3.0 * least);
                let little = rim.variations(&[ball], 1, [all[i] / 2.0; LANES])[0];
                prop_assert!(little.is_infinite());
            }
        }
    }

    #[test]
    fn no_rim_varies_nothing() {
        let rim = Rim::new(&[]);
        assert_eq!(rim.variations(&[(DVec3::ZERO, 1.0)], 1, [1.0; LANES]), [0.0; LANES]);
    }
}
