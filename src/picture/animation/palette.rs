//! Few colours that stand for many.

use super::webp::unpack;
use glam::DVec3;
use std::collections::HashMap;
use std::io;

/// Colours of a palette.
const MOST: usize = 256;

/// Colours, and which of them stands for each colour there is.
pub(super) struct Palette {
    pub colors: Vec<[u8; 3]>,
    index: HashMap<[u8; 3], u8>,
}

/// A colour, and how much it counts.
type Weighed = ([u8; 3], f64);

impl Palette {
    /// The colours of some packed frames; all of them, if they are few.
    pub fn of(frames: &[Vec<u8>]) -> io::Result<Self> {
        let mut counts: HashMap<[u8; 3], u64> = HashMap::new();
        for frame in frames {
            for color in unpack(frame)?.as_chunks::<3>().0 {
                *counts.entry(*color).or_default() += 1;
            }
        }
        let mut counts: Vec<([u8; 3], u64)> = counts.into_iter().collect();
        counts.sort_unstable();
        let all: Vec<[u8; 3]> = counts.iter().map(|c| c.0).collect();
        let colors = if all.len() <= MOST { all.clone() } else { chosen(counts) };
        let index = all.iter().map(|&c| (c, nearest(c, &colors))).collect();
        Ok(Self { colors, index })
    }

    /// The pixels as places in the palette.
    pub fn indices(&self, pixels: &[u8]) -> Vec<u8> {
        let index = |color: &[u8; 3]| self.index.get(color).copied().unwrap_or_default();
        pixels.as_chunks::<3>().0.iter().map(index).collect()
    }
}

/// The most frequent colour to the letter, which is the background; for the rest, boxes of colours
/// are cut in two, always the one with the largest error, across its longest axis at its mean.
fn chosen(mut counts: Vec<([u8; 3], u64)>) -> Vec<[u8; 3]> {
    let most = (0..counts.len()).max_by_key(|&i| counts[i].1).unwrap_or_default();
    let background = counts.remove(most).0;
    // by count alone the even parts would get all colours; each once, the specks would
    let mut boxes = vec![Group::of(counts.iter().map(|c| (c.0, (c.1 as f64).sqrt())).collect())];
    while boxes.len() < MOST - 1 {
        let error = |i: &usize| boxes[*i].error;
        let Some(worst) = (0..boxes.len()).max_by(|a, b| error(a).total_cmp(&error(b))) else {
            break;
        };
        let (low, high) = boxes[worst].cut();
        if low.is_empty() || high.is_empty() {
            break;
        }
        boxes[worst] = Group::of(low);
        boxes.push(Group::of(high));
    }
    let mut colors: Vec<[u8; 3]> = boxes.iter().map(Group::color).collect();
    colors.push(background);
    colors
}

/// Colours that one is to stand for.
struct Group {
    members: Vec<Weighed>,
    mean: DVec3,
    /// The sum of the weighted squares of distances from the mean, by axis.
    spread: DVec3,
    error: f64,
}

fn vector([r, g, b]: [u8; 3]) -> DVec3 {
    DVec3::new(r.into(), g.into(), b.into())
}

impl Group {
    fn of(members: Vec<Weighed>) -> Self {
        let weight: f64 = members.iter().map(|m| m.1).sum();
        let sum: DVec3 = members.iter().map(|m| vector(m.0) * m.1).sum();
        let mean = if weight > 0.0 { sum / weight } else { DVec3::ZERO };
        let square = |m: &Weighed| (vector(m.0) - mean).powf(2.0) * m.1;
        let spread: DVec3 = members.iter().map(square).sum();
        Self { members, mean, spread, error: spread.element_sum() }
    }

    /// Those below the mean on the axis with the largest spread, and the others.
    fn cut(&self) -> (Vec<Weighed>, Vec<Weighed>) {
        let axis = self.spread.max_position();
        self.members.iter().partition(|m| f64::from(m.0[axis]) < self.mean[axis])
    }

    fn color(&self) -> [u8; 3] {
        self.mean.to_array().map(|x| x.round() as u8)
    }
}

/// The first of the closest colours.
fn nearest(color: [u8; 3], colors: &[[u8; 3]]) -> u8 {
    let apart =
        |c: &[u8; 3]| -> u32 { (0..3).map(|k| u32::from(c[k].abs_diff(color[k])).pow(2)).sum() };
    let best = (0..colors.len()).min_by_key(|&i| apart(&colors[i]));
    best.unwrap_or_default() as u8
}
