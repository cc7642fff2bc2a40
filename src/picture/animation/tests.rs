use super::*;
use std::fs;

/// Three frames: a square of another colour at another place, on a ground of one colour.
fn film() -> (Film, Vec<Image>) {
    let frame = |i: u32| {
        let mut image = Image::filled(41, 30, [245, 245, 243]).unwrap();
        let color = [[200, 30, 10], [10, 180, 60], [20, 40, 220]][i as usize];
        image.paste(&Image::filled(8, 8, color).unwrap(), 3 + 11 * i, 5);
        image
    };
    let frames: Vec<Image> = (0..3).map(frame).collect();
    let mut film = Film::default();
    frames.iter().for_each(|f| film.push(f).unwrap());
    (film, frames)
}

const TURNS: [usize; 4] = [0, 1, 2, 1];

#[test]
fn a_webp_shows_every_pixel_of_each_turn() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.webp");
    let (film, frames) = film();
    let bytes = film.save(&path, &TURNS, 0.15, false).unwrap();
    let file = fs::read(&path).unwrap();
    assert_eq!(file.len() as u64, bytes);
    let riff = u32::from_le_bytes(file[4..8].try_into().unwrap());
    assert_eq!(
        (&file[..4], riff as usize, &file[8..16]),
        (&b"RIFF"[..], file.len() - 8, &b"WEBPVP8X"[..])
    );
    let mut decoder = image_webp::WebPDecoder::new(io::Cursor::new(&file)).unwrap();
    assert_eq!((decoder.dimensions(), decoder.num_frames()), ((41, 30), 4));
    assert_eq!(decoder.loop_count(), image_webp::LoopCount::Forever);
    assert_eq!(decoder.loop_duration(), 600);
    for turn in TURNS {
        let mut pixels = vec![0; 41 * 30 * 3];
        assert_eq!(decoder.read_frame(&mut pixels).unwrap(), 150);
        assert_eq!(pixels, frames[turn].pixels().as_flattened(), "turn {turn}");
    }
}

#[test]
fn a_gif_keeps_colours_that_are_few() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.GIF");
    let (film, frames) = film();
    film.save(&path, &TURNS, 0.125, false).unwrap();
    let mut options = ::gif::DecodeOptions::new();
    options.set_color_output(::gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(fs::File::open(&path).unwrap()).unwrap();
    assert_eq!((decoder.width(), decoder.height()), (41, 30));
    let mut delays = vec![];
    for turn in TURNS {
        let frame = decoder.read_next_frame().unwrap().unwrap();
        assert!(frame.palette.is_none(), "all frames share one palette");
        delays.push(frame.delay);
        for (got, want) in frame.buffer.as_chunks::<4>().0.iter().zip(frames[turn].pixels()) {
            assert_eq!(got[..3], want[..], "turn {turn}");
        }
    }
    assert!(decoder.read_next_frame().unwrap().is_none());
    assert_eq!(decoder.repeat(), ::gif::Repeat::Infinite);
    // hundredths: 12.5 each, rounded so that the whole takes half a second
    assert_eq!(delays, [13, 12, 13, 12]);
}

#[test]
fn the_same_film_gives_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.gif", "a.webp"] {
        let path = folder.path().join(name);
        let bytes = || {
            film().0.save(&path, &TURNS, 0.1, true).unwrap();
            fs::read(&path).unwrap()
        };
        assert_eq!(bytes(), bytes());
    }
}

#[test]
fn what_cannot_be_a_film_is_refused_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let (mut film, _) = film();
    let odd = film.push(&Image::filled(41, 31, [0; 3]).unwrap()).unwrap_err().to_string();
    assert!(odd.contains("41 x 31") && odd.contains("41 x 30"), "{odd}");
    for (name, turns) in [("a.mp4", &TURNS[..]), ("a.gif", &[]), ("a.webp", &[0, 3])] {
        let e = film.save(&at(name), turns, 0.1, false).unwrap_err().to_string();
        assert!(e.contains(name) && e.contains("gif or webp"), "{e}");
    }
    let e = film.save(&at("none/a.gif"), &TURNS, 0.1, false).unwrap_err();
    assert!(matches!(e, PictureError::Write { .. }), "{e}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    fs::write(at("a.gif"), b"mine").unwrap();
    let e = film.save(&at("a.gif"), &TURNS, 0.1, false).unwrap_err();
    assert!(matches!(e, PictureError::Exists(_)), "{e}");
    assert_eq!(fs::read(at("a.gif")).unwrap(), b"mine");
    film.save(&at("a.gif"), &TURNS, 0.1, true).unwrap();
}

#[test]
fn a_palette_keeps_the_ground_and_comes_near_the_rest() {
    // a smooth ball of 40 000 colours on a ground of one
    let mut image = Image::filled(300, 300, [245, 245, 243]).unwrap();
    let (width, wide) = (image.width() as usize, 200);
    for (y, x) in (0..wide).flat_map(|y| (0..wide).map(move |x| (y, x))) {
        image.pixels_mut()[(y + 50) * width + x + 50] = [x as u8, y as u8, ((x + y) / 2) as u8];
    }
    let palette = palette::Palette::of(&[webp::pack(&image).unwrap()]).unwrap();
    assert_eq!(palette.colors.len(), 256);
    let mut square = 0.0;
    for (i, want) in palette.indices(image.pixels().as_flattened()).iter().zip(image.pixels()) {
        let got = palette.colors[usize::from(*i)];
        if *want == [245, 245, 243] {
            assert_eq!(got, *want);
        }
        square += (0..2).map(|k| f64::from(got[k].abs_diff(want[k])).powi(2)).sum::<f64>();
    }
    // 255 cells of 200² / 255 = 12.5²: the square of the distance is 12.5² / 6 in the best case
    let root = (square / 200f64.powi(2)).sqrt();
    assert!(root < 1.3 * 12.5 / 6f64.sqrt(), "{root}");
}
