//! Exact distance to an axis-aligned ellipse or ellipsoid.

/// Signed distance from `p` to the surface sum (x_i / half_i)² = 1.
///
/// The nearest point is x_i = a_i² p_i / (s + a_i²) with the largest s that puts it on the surface
/// (Eberly, "Distance from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid"). The
/// function of s falls and is convex there, so Newton's steps from the left never overshoot.
pub(super) fn distance<const N: usize>(half: [f64; N], p: [f64; N]) -> f64 {
    let least = half.iter().copied().fold(f64::INFINITY, f64::min);
    // In a plane of symmetry inside, the nearest point may leave the plane: the limit from beside
    // it is the same distance, and this far beside it costs no more than the shift.
    let shift = 1e-13 * least;
    let p = p.map(|x| x.abs().max(shift));
    let level: f64 = p.iter().zip(&half).map(|(x, a)| (x / a) * (x / a)).sum();
    // In units of least, and with u = s + 1: near the short axes' plane u is tiny, and only in
    // this form are its digits kept. z = p / least, r = half / least.
    let z = |i: usize| p[i] / least;
    let beyond = |i: usize| (half[i] / least - 1.0) * (half[i] / least + 1.0);
    let term = |i: usize, u: f64| half[i] / least * z(i) / (u + beyond(i));
    let mut u =
        (0..N).map(|i| half[i] / least * z(i) - beyond(i)).fold(f64::NEG_INFINITY, f64::max);
    for _ in 0..64 {
        let (mut g, mut slope) = (-1.0, 0.0);
        for i in 0..N {
            let t = term(i, u);
            g += t * t;
            slope += t * t / (u + beyond(i));
        }
        let step = 0.5 * g / slope;
        u += step;
        if step <= 1e-15 * u {
            break;
        }
    }
    let squared: f64 = (0..N)
        .map(|i| {
            let near = term(i, u) * half[i];
            (near - p[i]) * (near - p[i])
        })
        .sum();
    if level < 1.0 { -squared.sqrt() } else { squared.sqrt() }
}

#[cfg(test)]
mod tests {
    use super::distance;

    #[test]
    fn spheres_and_axes() {
        assert!((distance([2.0; 3], [3.0, 4.0, 0.0]) - 3.0).abs() < 1e-12);
        assert!((distance([2.0; 3], [0.0; 3]) + 2.0).abs() < 1e-12);
        // from the centre the nearest point is on the short axis
        assert!((distance([100.0, 20.0, 5.0], [0.0; 3]) + 5.0).abs() < 1e-12);
        assert!((distance([100.0, 20.0, 5.0], [130.0, 0.0, 0.0]) - 30.0).abs() < 1e-12);
        assert!((distance([100.0, 20.0], [0.0, 21.0]) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn against_a_fine_polygon() {
        let (a, b) = (100.0, 12.0);
        let dense: Vec<(f64, f64)> = (0..200_000)
            .map(|i| f64::from(i) * std::f64::consts::TAU / 200_000.0)
            .map(|t| (a * t.cos(), b * t.sin()))
            .collect();
        for p in [[50.0, 3.0], [99.0, 0.5], [3.0, 40.0], [160.0, 9.0], [98.0, 0.0], [20.0, 0.0]] {
            let d = dense.iter().map(|q| (q.0 - p[0]).hypot(q.1 - p[1])).fold(f64::MAX, f64::min);
            assert!((distance([a, b], p).abs() - d).abs() < 1e-6, "{p:?} {d}");
        }
    }

    #[test]
    fn continuous_across_the_surface() {
        for h in [-1e-9, 1e-9] {
            assert!((distance([30.0, 20.0, 10.0], [0.0, 0.0, 10.0 + h]) - h).abs() < 1e-11);
        }
    }
}
