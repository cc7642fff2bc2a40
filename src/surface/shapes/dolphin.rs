//! A dolphin of five PDE patches.

use crate::surface::pde::{Boundary, Options};
use glam::{DAffine3, DMat3, DVec3, dvec3};

/// The dolphin: body, tail flukes, dorsal fin, right and left side fin; about 320 mm from beak to
/// flukes, nose to -X, Y up as the Klein bottle that it morphs with. For the default options: `a` = 1,
/// five modes and the remainder.
///
/// Every patch is closed by itself, a pillow between two folds: the body between the lines of the
/// back and the belly, a fin between the middles of its two faces. The fins begin inside the body, so
/// the union of the five, by winding number, is one solid.
pub fn dolphin() -> Vec<Boundary> {
    vec![body(), FLUKES.patch(), DORSAL.patch(), SIDE.patch(), SIDE.patch_mirrored()]
}

/// Along the body, from the beak (v = 0) to the tail: factors of cos(nv) from n = 0. Closer steps at the
/// head.
const ALONG: [f64; 3] = [-18.125, -145.0, 18.125];

/// Height of the back and of the belly, and half the width: factors of cos(nv) from n = 0, and of
/// sin(nv) from n = 1. They were fitted to drawn outlines of a bottlenose dolphin.
const BACK: [f64; 13] =
    [2.29, -8.99, -25.25, 2.47, 3.73, 1.67, 0.8, -0.72, -1.44, -0.85, -0.04, 0.6, 0.63];
const BELLY: [f64; 13] =
    [-25.85, -5.75, 3.69, 0.44, -2.32, 1.23, 0.15, 0.17, 0.32, -0.02, -0.03, 0.0, -0.05];
const WIDTH: [f64; 12] =
    [22.29, -0.17, -6.281, 0.26, 1.57, 0.28, 0.97, 0.0, -0.22, -0.52, -0.14, 0.02];

fn body() -> Boundary {
    let line = |heights: [f64; 13]| -> Vec<DVec3> {
        let along = ALONG.iter().chain(std::iter::repeat(&0.0));
        heights.iter().zip(along).map(|(y, x)| dvec3(*x, *y, 0.0)).collect()
    };
    let rim = WIDTH.map(|z| DVec3::Z * z);
    Boundary::pillow(&line(BACK), &line(BELLY), &rim, &Options::default())
}

/// A fin: its outline goes round from the tip (v = 0) along the front edge to the root and back.
struct Fin {
    root: DVec3,
    /// Unit vectors from root to tip, from front to back, and from face to face.
    axes: [DVec3; 3],
    /// Places from root to tip: factors of cos(nv) from n = 0, as the next two.
    span: &'static [f64],
    /// Half way between the front and the back edge.
    middle: &'static [f64],
    /// Half the thickness, at the middle.
    half: &'static [f64],
    /// Half the distance of the edges: factors of sin(nv) from n = 1.
    chord: &'static [f64],
}

const FLUKES: Fin = Fin {
    root: dvec3(131.0, -13.2, 0.0),
    axes: [DVec3::Z, dvec3(0.99, -0.139, 0.0), dvec3(0.139, 0.99, 0.0)],
    span: &[0.0, 72.0],
    middle: &[30.1, 0.0, 17.36, 0.0, -1.86, 0.0, 2.41, 0.0, -1.65, 0.0, 1.12],
    half: &[2.6, 0.0, -1.4],
    chord: &[15.88, 0.0, -3.44, 0.0, -0.72, 0.0, 0.59, 0.0, -0.64, 0.0, 0.47],
};

const DORSAL: Fin = Fin {
    root: DVec3::ZERO,
    axes: [DVec3::Y, DVec3::X, DVec3::Z],
    span: &[33.5, 31.5],
    middle: &[13.74, 11.89, 10.37],
    half: &[3.75, -2.75],
    chord: &[21.0, -8.4],
};

const SIDE: Fin = Fin {
    root: dvec3(-72.0, -15.0, 14.0),
    axes: [dvec3(0.12, -0.618, 0.777), dvec3(0.993, 0.074, -0.094), dvec3(0.0, 0.783, 0.622)],
    span: &[26.0, 32.0],
    middle: &[7.95, 17.19, 5.86],
    half: &[3.0, -2.0],
    chord: &[13.5, -3.04],
};

impl Fin {
    fn patch(&self) -> Boundary {
        self.placed(&DAffine3::IDENTITY)
    }

    fn patch_mirrored(&self) -> Boundary {
        self.placed(&DAffine3::from_scale(dvec3(1.0, 1.0, -1.0)))
    }

    fn placed(&self, by: &DAffine3) -> Boundary {
        let [out, back, up] = self.axes;
        let frame =
            *by * DAffine3::from_mat3_translation(DMat3::from_cols(out, back, up), self.root);
        let get = |list: &[f64], n: usize| list.get(n).copied().unwrap_or(0.0);
        let face = |side: f64| -> Vec<DVec3> {
            (0..self.span.len().max(self.middle.len()).max(self.half.len()))
                .map(|n| {
                    let at = [self.span, self.middle, self.half].map(|list| get(list, n));
                    let at = dvec3(at[0], at[1], side * at[2]);
                    if n == 0 { frame.transform_point3(at) } else { frame.transform_vector3(at) }
                })
                .collect()
        };
        let edge = |c: &f64| frame.transform_vector3(DVec3::Y * *c);
        let rim: Vec<DVec3> = self.chord.iter().map(edge).collect();
        Boundary::pillow(&face(1.0), &face(-1.0), &rim, &Options::default())
    }
}
