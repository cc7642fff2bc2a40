//! GIF: 256 colours, chosen once for all frames, or what keeps still would flicker.

use super::{durations, palette::Palette, webp::unpack};
use ::gif::{Encoder, Frame, Repeat};
use std::io;

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
    let mut gif =
        Encoder::new(Vec::new(), width, height, palette.colors.as_flattened()).map_err(other)?;
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
