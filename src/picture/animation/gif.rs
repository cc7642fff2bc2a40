//! GIF: 256 colours, chosen once for all frames, or what keeps still would flicker.

use super::{durations, webp::unpack};
use ::gif::{Encoder, Frame, Repeat};
use color_quant::NeuQuant;
use std::collections::HashMap;
use std::io;

/// Colours of the palette that are learnt. One more is the background's own, to the letter.
const LEARNT: usize = 255;

/// A GIF of frames packed as WebP.
pub(super) fn encode(
    size: [u32; 2],
    frames: &[Vec<u8>],
    turns: &[usize],
    seconds: f64,
) -> io::Result<Vec<u8>> {
    let palette = Palette::of(frames)?;
    let [Ok(width), Ok(height)] = size.map(u16::try_from) else {
        return Err(io::Error::other("larger than a GIF can be"));
    };
    let mut packed = Vec::with_capacity(frames.len());
    for frame in frames {
        let buffer = palette.indices(&unpack(frame)?).into();
        let mut frame = Frame { width, height, buffer, ..Frame::default() };
        frame.make_lzw_pre_encoded();
        packed.push(frame);
    }
    let mut gif = Encoder::new(Vec::new(), width, height, &palette.colors).map_err(other)?;
    gif.set_repeat(Repeat::Infinite).map_err(other)?;
    for (&turn, delay) in turns.iter().zip(durations(turns.len(), seconds * 100.0)) {
        packed[turn].delay = u16::try_from(delay).unwrap_or(u16::MAX);
        gif.write_lzw_pre_encoded_frame(&packed[turn]).map_err(other)?;
    }
    gif.into_inner().map_err(other)
}

fn other(e: ::gif::EncodingError) -> io::Error {
    io::Error::other(e)
}

/// Colours, and which of them stands for each colour there is.
struct Palette {
    colors: Vec<u8>,
    nearest: HashMap<[u8; 3], u8>,
}

impl Palette {
    fn of(frames: &[Vec<u8>]) -> io::Result<Self> {
        let mut counts: HashMap<[u8; 3], u64> = HashMap::new();
        for frame in frames {
            for color in unpack(frame)?.as_chunks::<3>().0 {
                *counts.entry(*color).or_default() += 1;
            }
        }
        let mut counts: Vec<([u8; 3], u64)> = counts.into_iter().collect();
        counts.sort_unstable();
        let background = counts.iter().max_by_key(|c| c.1).map_or([255; 3], |c| c.0);
        let mut seen = Vec::new();
        for &([r, g, b], count) in &counts {
            // by count alone the large even parts would get all colours, without it specks would
            let times = (count as f64).sqrt().ceil() as usize;
            (0..times).for_each(|_| seen.extend_from_slice(&[r, g, b, 255]));
        }
        let learnt = NeuQuant::new(1, LEARNT, &seen);
        let mut colors = learnt.color_map_rgb();
        colors.extend_from_slice(&background);
        let stands_for = |color: [u8; 3]| {
            let [r, g, b] = color;
            let index = learnt.index_of(&[r, g, b, 255]);
            if color == background { LEARNT as u8 } else { index as u8 }
        };
        let nearest = counts.iter().map(|c| (c.0, stands_for(c.0))).collect();
        Ok(Self { colors, nearest })
    }

    fn indices(&self, pixels: &[u8]) -> Vec<u8> {
        let index = |color: &[u8; 3]| self.nearest.get(color).copied().unwrap_or_default();
        pixels.as_chunks::<3>().0.iter().map(index).collect()
    }
}
