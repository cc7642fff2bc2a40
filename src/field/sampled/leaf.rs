//! The samples of one leaf.

use super::{CELLS, LEAF, Leaf, SIDE, Sampled, Samples};
use glam::{DVec3, IVec3};
use std::sync::LazyLock;

impl Sampled {
    /// The samples of a leaf, x fastest; made now if they are not yet.
    pub(super) fn samples(&self, leaf: usize) -> &[f32; LEAF] {
        match self.samples[leaf].get() {
            Some(samples) => samples,
            None => self.make_now(leaf),
        }
    }

    /// Made first and put there then: two threads may make the same, but none waits for another, which may
    /// wait for it.
    #[cold]
    fn make_now(&self, leaf: usize) -> &[f32; LEAF] {
        let made = self.make(leaf);
        self.samples[leaf].get_or_init(|| made)
    }

    fn make(&self, leaf: usize) -> Samples {
        let mut samples = Box::new([0f32; LEAF]);
        let Some(field) = &self.field else {
            return samples;
        };
        let Leaf { corner, level } = self.leaves[leaf];
        let mut asked = Vec::with_capacity(LEAF);
        asked.extend_from_slice(&ORDER[..CORE]);
        self.far_faces(leaf, &mut samples, &mut asked);
        let cell = |&n: &usize| self.grid.point(corner + place(n) * (1 << level));
        let at: Vec<DVec3> = asked.iter().map(cell).collect();
        let mut out = vec![0.0; at.len()];
        field.values(&at, &mut out);
        for (n, f) in asked.into_iter().zip(out) {
            samples[n] = f as f32;
        }
        for (n, f) in self.coarser_on_faces(leaf) {
            samples[n] = f;
        }
        samples
    }

    /// Fills the samples of the far faces from the neighbours that are made and have them in their
    /// cores; the field must be asked for those of the others.
    fn far_faces(&self, leaf: usize, samples: &mut Samples, asked: &mut Vec<usize>) {
        let Leaf { corner, level } = self.leaves[leaf];
        for Block { shift, samples: block } in FAR.iter() {
            let cell = corner + shift * (CELLS << level);
            let beside = self.leaf_at(cell);
            let within = cell.cmplt(self.table_size * CELLS).all();
            match self.samples[beside].get() {
                Some(core) if within && self.leaves[beside].level == level => {
                    block.iter().for_each(|&(n, o)| samples[n] = core[o]);
                }
                // a coarser one gives its values when levels are joined
                _ if within && self.leaves[beside].level > level => {}
                _ => asked.extend(block.iter().map(|b| b.0)),
            }
        }
    }

    /// Sample index and new value, for each sample on a face shared with a coarser leaf.
    fn coarser_on_faces(&self, leaf: usize) -> Vec<(usize, f32)> {
        let Leaf { corner, level } = self.leaves[leaf];
        let near = self.beside(leaf);
        let mut out = Vec::new();
        if near.iter().all(|&l| self.leaves[l].level <= level) {
            return out;
        }
        for Block { shift, samples } in SIDES.iter() {
            // the blocks that meet in these samples
            let meet = (0..8).map(|o| {
                let back = IVec3::new(o & 1, o >> 1 & 1, o >> 2 & 1);
                let at = (shift.max(IVec3::ZERO) - back * shift.abs()) + 1;
                near[(at.x + 3 * (at.y + 3 * at.z)) as usize]
            });
            let coarsest = meet.max_by_key(|&l| self.leaves[l].level).unwrap_or(leaf);
            if self.leaves[coarsest].level > level {
                out.extend(samples.iter().map(|&(n, _)| {
                    let u = corner + place(n) * (1 << level);
                    (n, self.interpolate_in(coarsest, u.as_dvec3()) as f32)
                }));
            }
        }
        out
    }

    /// A leaf among those beside it, x fastest: a coarser one fills all of a block of its size.
    pub(super) fn beside(&self, leaf: usize) -> [usize; 27] {
        let Leaf { corner, level } = self.leaves[leaf];
        let side = CELLS << level;
        std::array::from_fn(|n| {
            let n = n as i32;
            let shift = IVec3::new(n % 3, n / 3 % 3, n / 9) - 1;
            self.leaf_at(corner + side / 2 + shift * side)
        })
    }
}

/// Samples of a leaf without its far faces.
const CORE: usize = (SIDE - 1) * (SIDE - 1) * (SIDE - 1);

/// Sample `n` of a leaf as (i, j, k).
fn place(n: usize) -> IVec3 {
    IVec3::new((n % SIDE) as i32, (n / SIDE % SIDE) as i32, (n / (SIDE * SIDE)) as i32)
}

/// Sample indices so that runs of 8, 64 and 512 are cubes; the far faces come last.
static ORDER: LazyLock<Vec<usize>> = LazyLock::new(|| {
    let spread = |x: usize| (x & 1) | (x & 2) << 2 | (x & 4) << 4;
    let mut order: Vec<usize> = (0..LEAF).collect();
    order.sort_by_key(|&n| {
        let (i, j, k) = (n % SIDE, n / SIDE % SIDE, n / (SIDE * SIDE));
        let far = [i, j, k].map(|x| usize::from(x == SIDE - 1));
        let clamped = [i, j, k].map(|x| x.min(SIDE - 2));
        let z = spread(clamped[0]) | spread(clamped[1]) << 1 | spread(clamped[2]) << 2;
        (far[0] | far[1] << 1 | far[2] << 2, z)
    });
    order
});

/// Samples of a leaf that it shares with the same other leaves.
struct Block {
    /// Along each axis on the near side (-1), on neither (0), or on the far side (1).
    shift: IVec3,
    /// Each with its place in the leaf on the other side of the far faces it lies on.
    samples: Vec<(usize, usize)>,
}

impl Block {
    /// Puts samples into blocks by where they lie.
    fn all(samples: &[usize], shift: impl Fn(IVec3) -> IVec3) -> Vec<Self> {
        let mut blocks: Vec<Self> = Vec::new();
        for &n in samples {
            let ijk = place(n);
            let o = ijk.map(|x| x % CELLS).as_usizevec3();
            let (shift, one) = (shift(ijk), (n, o.x + SIDE * (o.y + SIDE * o.z)));
            match blocks.iter_mut().find(|b| b.shift == shift) {
                Some(block) => block.samples.push(one),
                None => blocks.push(Self { shift, samples: vec![one] }),
            }
        }
        blocks
    }
}

/// The samples of the far faces by the neighbour that has them in its core.
static FAR: LazyLock<Vec<Block>> = LazyLock::new(|| {
    let mut blocks = Block::all(&ORDER[CORE..], |ijk| ijk / CELLS);
    // whole faces first, so that runs of 64 that are asked for are planes
    blocks.sort_by_key(|b| b.shift.element_sum());
    blocks
});

/// The samples on faces by the neighbours that have them too.
static SIDES: LazyLock<Vec<Block>> = LazyLock::new(|| {
    let on_face = |&n: &usize| place(n).to_array().iter().any(|x| x % CELLS == 0);
    let samples: Vec<usize> = (0..LEAF).filter(on_face).collect();
    Block::all(&samples, |ijk| ijk / CELLS - ijk.map(|x| i32::from(x == 0)))
});
