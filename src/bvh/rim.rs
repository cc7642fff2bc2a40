use super::{Bvh, Node};
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
    /// The same in each slot.
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
        Self { bvh, lengths, edges }
    }

    /// Memory that they take, bytes.
    pub fn bytes(&self) -> usize {
        self.bvh.bytes() + size_of_val(&self.lengths[..]) + size_of_val(&self.edges[..])
    }

    /// Length of all rims, mm.
    pub fn length(&self) -> f64 {
        self.lengths.first().copied().unwrap_or(0.0)
    }

    /// An upper bound of |grad w| per mm over a ball; infinite where the ball touches a rim or
    /// as soon as it exceeds `most`.
    pub fn variation(&self, centre: DVec3, radius: f64, most: f64) -> f64 {
        let most = most * 4.0 * PI;
        let mut total = 0.0;
        let mut stack = vec![];
        if !self.bvh.is_empty() {
            stack.push(0u32);
        }
        while let Some(index) = stack.pop() {
            if total > most {
                return f64::INFINITY;
            }
            let Node { bounds, first, count } = self.bvh.nodes[index as usize];
            let far = bounds.distance(centre) - radius;
            if far > 2.0 * bounds.radius() {
                total += self.lengths[index as usize] / (far * far);
            } else if count == 0 {
                stack.extend([first, first + 1]);
            } else {
                for slot in first as usize..(first + count) as usize {
                    let d2 = self.bvh.tris[slot].distance2(centre.x, centre.y, centre.z);
                    let far = d2.sqrt() - radius;
                    if far <= 0.0 {
                        return f64::INFINITY;
                    }
                    total += self.edges[slot] / (far * far);
                }
            }
        }
        total / (4.0 * PI)
    }
}
