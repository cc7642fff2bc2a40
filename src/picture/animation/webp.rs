//! WebP: single pictures without loss, and the container that makes them move.
//!
//! The encoder knows single pictures only. A moving one is a list of chunks (RIFF): the canvas
//! (VP8X), how often (ANIM), and each turn (ANMF) a head and the chunk (VP8L) of a single picture.

use super::durations;
use crate::picture::Image;
use image_webp::{ColorType, WebPDecoder, WebPEncoder};
use std::io;

/// Bytes of a single picture's file before its VP8L chunk.
const FILE_HEAD: usize = 12;
/// Bytes of what stands before each turn's chunk: name, length, and 16 of its own.
const TURN_HEAD: usize = 24;

/// A single picture's file.
pub(super) fn pack(image: &Image) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let flat = image.pixels().as_flattened();
    WebPEncoder::new(&mut bytes)
        .encode(flat, image.width(), image.height(), ColorType::Rgb8)
        .map_err(io::Error::other)?;
    if bytes.get(FILE_HEAD..FILE_HEAD + 4) != Some(b"VP8L") {
        return Err(io::Error::other("a picture came without its VP8L chunk"));
    }
    Ok(bytes)
}

/// The pixels of a file that [`pack`] made.
pub(super) fn unpack(bytes: &[u8]) -> io::Result<Vec<u8>> {
    let mut decoder = WebPDecoder::new(io::Cursor::new(bytes)).map_err(io::Error::other)?;
    let size = decoder.output_buffer_size();
    let mut pixels = vec![0; size.ok_or_else(|| io::Error::other("a frame is too large"))?];
    decoder.read_image(&mut pixels).map_err(io::Error::other)?;
    Ok(pixels)
}

/// What stands before the chunk of each turn; before the first, the head of the file too.
pub(super) fn heads(
    size: [u32; 2],
    frames: &[Vec<u8>],
    turns: &[usize],
    seconds: f64,
) -> io::Result<Vec<Vec<u8>>> {
    let length = |turn: usize| frames[turn].len() - FILE_HEAD;
    // 4 for `WEBP`, 18 and 14 for the first two chunks
    let riff = turns.iter().fold(36, |sum, &t| sum + TURN_HEAD + length(t));
    let Ok(riff) = u32::try_from(riff) else {
        return Err(io::Error::other(format!("{riff} bytes are more than a WebP can hold")));
    };
    let sides = size.map(|n| n - 1);
    let mut file = [&b"RIFF"[..], &riff.to_le_bytes(), b"WEBP"].concat();
    chunk(&mut file, b"VP8X", 10);
    file.extend_from_slice(&[MOVES, 0, 0, 0]);
    sides.iter().for_each(|&n| file.extend_from_slice(&three(n)));
    chunk(&mut file, b"ANIM", 6);
    file.extend_from_slice(&[0xff, 0xff, 0xff, 0xff]); // behind all frames: white
    file.extend_from_slice(&[0, 0]); // over and over
    let head = |(&turn, ms): (&usize, u32)| {
        let mut out = std::mem::take(&mut file);
        chunk(&mut out, b"ANMF", 16 + length(turn) as u32);
        out.extend_from_slice(&[0; 6]); // at the corner
        sides.iter().for_each(|&n| out.extend_from_slice(&three(n)));
        out.extend_from_slice(&three(ms));
        out.push(REPLACES);
        out
    };
    Ok(turns.iter().zip(durations(turns.len(), seconds * 1000.0)).map(head).collect())
}

/// The whole file: heads, and the chunks of the frames that are shown.
pub(super) fn parts<'a>(
    heads: &'a [Vec<u8>],
    frames: &'a [Vec<u8>],
    turns: &[usize],
) -> Vec<&'a [u8]> {
    let both = |(head, &turn): (&'a Vec<u8>, &usize)| [&head[..], &frames[turn][FILE_HEAD..]];
    heads.iter().zip(turns).flat_map(both).collect()
}

/// The flag of a canvas on which something moves.
const MOVES: u8 = 1 << 1;
/// The flag of a frame that is not blended with the one before.
const REPLACES: u8 = 1 << 1;

fn chunk(out: &mut Vec<u8>, name: &[u8; 4], length: u32) {
    out.extend_from_slice(name);
    out.extend_from_slice(&length.to_le_bytes());
}

/// 24 bits.
fn three(n: u32) -> [u8; 3] {
    let [a, b, c, _] = n.min(0x00ff_ffff).to_le_bytes();
    [a, b, c]
}
