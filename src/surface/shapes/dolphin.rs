//! A dolphin of five PDE patches.

use crate::surface::pde::{Boundary, Curve};
use glam::{DVec3, dvec3};

/// The dolphin: body, tail flukes, dorsal fin, left and right side fin; about 310 mm from beak to flukes,
/// nose to -Y, Z up. For the default options: `a` = 1, five modes.
///
/// Every patch is closed by itself: its ends are poles, or folds, curves that run along a line and
/// back. The fins begin inside the body, so the union of the five, by winding number, is one solid.
pub fn dolphin() -> Vec<Boundary> {
    let side = |x| fin(&SIDE.map(|s| s.mirrored(x)));
    vec![body(), fin(&FLUKES), fin(&DORSAL), side(1.0), side(-1.0)]
}

/// The curves of the body as a sum of terms symmetric in x. By curve and n = 0, 1, ...: factors of
/// cos(nv) in x and sin(nv) in y and z for odd n, the other way round for even n.
///
/// Fitted by least squares to drawn outlines of a bottlenose from the side and from above. The first
/// curve is a fold, the line of the mouth; the last is a pole where the flukes sit.
const BODY: [[[f64; 3]; 6]; 4] = [
    [[0.0, -137.2, -4.7], [8.9, 0.0, 0.0], [0.0, 12.4, 0.0], [0.0; 3], [0.0; 3], [0.0; 3]],
    [
        [0.0, -52.1, 1.25],
        [29.4, 12.2, 27.6],
        [0.6, 7.8, -0.7],
        [0.6, -0.3, 0.95],
        [-0.5, 1.2, 0.2],
        [0.2, -0.7, 0.3],
    ],
    [
        [0.0, 22.9, -2.15],
        [23.5, 24.9, 26.15],
        [-2.7, 6.55, 1.55],
        [-0.9, 2.8, -0.2],
        [-0.1, 1.05, 0.25],
        [0.1, -0.6, 0.15],
    ],
    [[0.0, 137.7, 5.0], [0.0; 3], [0.0; 3], [0.0; 3], [0.0; 3], [0.0; 3]],
];

fn body() -> Boundary {
    Boundary::new(BODY.map(|rows| {
        let [mean, terms @ ..] = rows;
        let split = |(i, [x, y, z]): (usize, [f64; 3])| {
            let (across, upright) = (dvec3(x, 0.0, 0.0), dvec3(0.0, y, z));
            if i % 2 == 0 { [across, upright] } else { [upright, across] }
        };
        let terms = terms.into_iter().enumerate().map(split).collect();
        Curve::Terms { mean: mean.into(), terms }
    }))
}

/// A cross-section of a fin: a foil round the line from `front` to `back`, along y.
#[derive(Clone, Copy)]
struct Section {
    /// Place of the section across y: x and z.
    at: [f64; 2],
    /// Front and back edge in y.
    front: f64,
    back: f64,
    /// Half the thickness: a vector in x and z.
    half: [f64; 2],
}

impl Section {
    const fn new(at: [f64; 2], [front, back]: [f64; 2], half: [f64; 2]) -> Self {
        Self { at, front, back, half }
    }

    fn mirrored(self, x: f64) -> Self {
        let turn = |[a, b]: [f64; 2]| [a * x, b];
        Self { at: turn(self.at), half: turn(self.half), ..self }
    }
}

/// How much nearer the front edge than the middle a fin is thickest: 0 is an ellipse.
const FULLNESS: f64 = 0.5;

const FLUKES: [Section; 4] = [
    Section::new([-74.0, 2.0], [163.0, 163.0], [0.0, 0.0]),
    Section::new([-25.0, 4.5], [122.0, 152.0], [0.0, 3.6]),
    Section::new([25.0, 4.5], [122.0, 152.0], [0.0, 3.6]),
    Section::new([74.0, 2.0], [163.0, 163.0], [0.0, 0.0]),
];

const DORSAL: [Section; 4] = [
    Section::new([0.0, 14.0], [-30.0, 36.0], [0.0, 0.0]),
    Section::new([0.0, 36.0], [-8.0, 31.0], [4.2, 0.0]),
    Section::new([0.0, 52.0], [14.0, 34.0], [3.0, 0.0]),
    Section::new([0.0, 65.0], [46.0, 46.0], [0.0, 0.0]),
];

const SIDE: [Section; 4] = [
    Section::new([12.0, -8.0], [-96.0, -58.0], [0.0, 0.0]),
    Section::new([31.0, -22.0], [-84.0, -54.0], [2.1, 3.1]),
    Section::new([49.0, -34.0], [-64.0, -41.0], [1.6, 2.4]),
    Section::new([64.0, -42.0], [-24.0, -24.0], [0.0, 0.0]),
];

fn fin(sections: &[Section; 4]) -> Boundary {
    Boundary::new(sections.map(|s| {
        let half = dvec3(s.half[0], 0.0, s.half[1]);
        let chord = DVec3::Y * (s.back - s.front) / 2.0;
        let mean = dvec3(s.at[0], (s.front + s.back) / 2.0, s.at[1]);
        Curve::Terms { mean, terms: vec![[chord, half], [DVec3::ZERO, half * -FULLNESS / 2.0]] }
    }))
}
