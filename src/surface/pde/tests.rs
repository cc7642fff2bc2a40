use super::*;
use crate::surface::{Motion, shapes};
use glam::dvec3;
use proptest::prelude::*;

const PLAIN: Options = Options { a: 1.0, modes: 5, remainder: false };

fn ring(mean: [f64; 3], radius: f64) -> Curve {
    let [x, y] = [DVec3::X * radius, DVec3::Y * radius];
    let bump = [dvec3(0.1, 0.0, 0.2) * radius, dvec3(-0.05, 0.1, 0.0) * radius];
    Curve::Terms { mean: mean.into(), terms: vec![[x, y], bump] }
}

/// A patch of points with modes up to 6, nothing symmetric about it.
fn lumpy(nodes: [f64; 4], count: usize) -> Boundary {
    let curve = |k: usize| {
        let at = |j: usize| {
            let v = TAU * j as f64 / count as f64;
            let r = 5.0 + k as f64 + 0.7 * (3.0 * v + k as f64).cos() + 0.2 * (6.0 * v).sin();
            dvec3(r * v.cos(), r * v.sin() + 0.3 * (2.0 * v).cos(), 4.0 * k as f64 + v.sin())
        };
        Curve::Points((0..count).map(at).collect())
    };
    Boundary { nodes, curves: [0, 1, 2, 3].map(curve) }
}

fn named(shape: &dyn Surface, divisions: usize, options: Options) -> PdeSurface {
    PdeSurface::new(&shapes::cut(shape, divisions, 32).unwrap(), options).unwrap()
}

/// Largest distance between a shape and its patches, at `size` points a patch.
fn deviation(shape: &dyn Surface, divisions: usize, size: [u32; 2]) -> f64 {
    let pde = named(shape, divisions, PLAIN);
    let [u0, u1] = shape.domain(0).u;
    let far = |patch: usize, i: u32, j: u32| {
        let w = f64::from(i) / f64::from(size[0] - 1);
        let v = TAU * f64::from(j) / f64::from(size[1]);
        let u = u0 + (u1 - u0) * (patch as f64 + w) / divisions as f64;
        pde.point(patch, DVec2::new(w, v)).distance(shape.point(0, DVec2::new(u, v)))
    };
    let all = (0..divisions)
        .flat_map(|p| (0..size[0]).flat_map(move |i| (0..size[1]).map(move |j| (p, i, j))));
    all.fold(0.0, |most: f64, (p, i, j)| most.max(far(p, i, j)))
}

fn apart(a: &Frame, b: &Frame) -> f64 {
    let steps =
        |n: u32, most: f64| (0..n).map(|i| most * f64::from(i) / f64::from(n - 1)).collect();
    let (us, vs): (Vec<f64>, Vec<f64>) = (steps(21, 1.0), steps(24, 6.0));
    assert_eq!(a.patches.len(), b.patches.len());
    a.grid(&us, &vs).iter().zip(b.grid(&us, &vs)).fold(0.0, |m, (p, q)| m.max((*p - q).length()))
}

fn morph(from: &PdeSurface, to: &PdeSurface, method: Method) -> PdeMorph {
    PdeMorph::new(from, to, MorphOptions { method, ..MorphOptions::default() }).unwrap()
}

// The figures of the next two tests were found with another program, by dense solves in the printed
// basis.
#[test]
fn shell_of_nine_patches_is_the_shell() {
    let shell = shapes::SeaShell::default();
    for (size, want) in [([11, 20], 1.3577e-3), ([41, 40], 1.4072e-3)] {
        let far = deviation(&shell, 9, size);
        assert!((far / want - 1.0).abs() < 1e-4, "{size:?}: {far}, not {want}");
    }
}

#[test]
fn klein_bottle_wants_its_kink_at_a_joint() {
    let bottle = shapes::KleinBottle::default();
    for (divisions, want) in [(8, 0.018350), (9, 0.26853), (10, 0.010040)] {
        let far = deviation(&bottle, divisions, [11, 20]);
        assert!((far / want - 1.0).abs() < 1e-4, "{divisions}: {far}, not {want}");
    }
}

#[test]
fn passes_through_its_curves() {
    for nodes in [NODES, [0.0, 0.15, 0.8, 1.0], [0.1, 0.4, 0.5, 0.9]] {
        for count in [11, 12, 40] {
            let boundary = lumpy(nodes, count);
            let options = Options { modes: 3, ..Options::default() };
            let surface = PdeSurface::new(std::slice::from_ref(&boundary), options).unwrap();
            for (u, curve) in nodes.into_iter().zip(&boundary.curves) {
                let Curve::Points(points) = curve else { unreachable!() };
                for (j, p) in points.iter().enumerate() {
                    let v = TAU * j as f64 / count as f64;
                    let got = surface.point(0, DVec2::new(u, v));
                    assert!((got - *p).length() < 1e-11, "u {u} point {j}: {got} not {p}");
                }
            }
        }
    }
}

#[test]
fn without_remainder_curves_keep_their_first_modes() {
    let boundary = lumpy(NODES, 40);
    let cut = PdeSurface::new(&[boundary], Options { modes: 4, ..PLAIN }).unwrap();
    assert_eq!(cut.patches[0].solution.modes(), 4);
    let curve = cut.patches[0].solution.curve(NODES[2]);
    for n in 1..=4 {
        let (got, want) = (curve.term(n), cut.patches[0].curves[2].term(n));
        assert!((0..2).all(|k| (got[k] - want[k]).length() < 1e-13));
    }
}

#[test]
fn derivatives_match_differences() {
    let options = Options { a: 1.5, modes: 3, remainder: true };
    let surface = PdeSurface::new(&[lumpy([0.0, 0.3, 0.7, 1.0], 16)], options).unwrap();
    let h = 1e-5;
    for uv in [[0.1, 0.3], [0.5, 2.0], [0.93, 5.9]].map(DVec2::from) {
        let jet = surface.jet(0, uv);
        let slope = |d: DVec2| (surface.point(0, uv + d) - surface.point(0, uv - d)) / (2.0 * h);
        assert!((jet.s - surface.point(0, uv)).length() < 1e-12);
        assert!((jet.su - slope(DVec2::X * h)).length() < 1e-6, "{uv}");
        assert!((jet.sv - slope(DVec2::Y * h)).length() < 1e-6, "{uv}");
    }
}

/// (D_uu + a^2 D_vv)^2 X from the derivatives of the closed form, and the size of its parts.
fn residual(solution: &Solution, a: f64, uv: DVec2) -> (f64, f64) {
    let (mut sum, mut size) = (DVec3::ZERO, 0.0);
    for term in &solution.terms {
        let n2 = (term.n * term.n) as f64;
        let (sin, cos) = (term.n as f64 * uv.y).sin_cos();
        for (order, factor) in [(4, 1.0), (2, -2.0 * a * a * n2), (0, (a * a * n2).powi(2))] {
            let f = term.basis.derivative(uv.x, order);
            for (k, f) in f.iter().enumerate() {
                let part = (term.cos[k] * cos + term.sin[k] * sin) * (f * factor);
                sum += part;
                size += part.length();
            }
        }
    }
    (sum.length(), size)
}

#[test]
fn solves_the_equation_but_for_the_remainder() {
    for a in [1.0, 2.5] {
        let options = Options { a, modes: 3, remainder: true };
        let whole = PdeSurface::new(&[lumpy(NODES, 16)], options).unwrap();
        let plain =
            PdeSurface::new(&[lumpy(NODES, 16)], Options { remainder: false, ..options }).unwrap();
        for uv in [[0.2, 0.5], [0.6, 3.0]].map(DVec2::from) {
            let (rest, size) = residual(&plain.patches[0].solution, a, uv);
            assert!(rest < 1e-12 * size, "{rest} of {size}");
            let (rest, size) = residual(&whole.patches[0].solution, a, uv);
            assert!(rest > 1e-3 * size, "the remainder must not solve it: {rest} of {size}");
        }
    }
}

#[test]
fn nothing_overflows_at_a_n_700() {
    let mut curves = [0.0, 1.0, 2.0, 3.0].map(|z| ring([0.0, 0.0, z], 2.0));
    for (k, curve) in curves.iter_mut().enumerate() {
        let Curve::Terms { terms, .. } = curve else { unreachable!() };
        terms.resize(100, [DVec3::splat(1e-3), DVec3::splat(k as f64 * 1e-3)]);
    }
    let options = Options { a: 7.0, modes: 100, remainder: false };
    let surface = PdeSurface::new(&[Boundary::new(curves.clone())], options).unwrap();
    assert_eq!(surface.warnings().len(), 1);
    for i in 0..=200 {
        let jet = surface.jet(0, DVec2::new(f64::from(i) / 200.0, 1.0));
        assert!(jet.s.is_finite() && jet.su.is_finite() && jet.sv.is_finite());
    }
    for (u, curve) in NODES.into_iter().zip(&curves) {
        let want = curve.fourier(100, "curve").unwrap().point(1.0);
        assert!((surface.point(0, DVec2::new(u, 1.0)) - want).length() < 1e-11);
    }
}

#[test]
fn boundary_and_spine_are_one_map() {
    let shell = named(&shapes::SeaShell::default(), 9, PLAIN);
    let bottle = named(&shapes::KleinBottle::default(), 9, PLAIN);
    let ball = shapes::SuperEllipsoid::default();
    let toroid = shapes::SuperToroid::default();
    let mut pairs = vec![(shell, bottle)];
    for modes in [1, 5, 10] {
        let options = Options { modes, ..PLAIN };
        pairs.push((named(&ball, 3, options), named(&toroid, 3, options)));
    }
    let rest = Options { modes: 4, remainder: true, ..PLAIN };
    pairs.push((named(&ball, 2, rest), named(&toroid, 2, rest)));
    for (from, to) in &pairs {
        let [a, d] = [Method::Boundary, Method::Spine].map(|m| morph(from, to, m));
        for t in [0.0, 0.2, 0.5, 0.9, 1.0] {
            let far = apart(&a.frame(t).unwrap(), &d.frame(t).unwrap());
            assert!(far < 1e-12, "t {t}: {far}");
        }
    }
}

#[test]
fn boundary_and_spine_differ_with_a() {
    let ball = shapes::SuperEllipsoid::default();
    let toroid = shapes::SuperToroid::default();
    let (from, to) = (named(&ball, 1, PLAIN), named(&toroid, 1, Options { a: 2.0, ..PLAIN }));
    let [a, d] =
        [Method::Boundary, Method::Spine].map(|m| morph(&from, &to, m).frame(0.5).unwrap());
    assert!(apart(&a, &d) > 1e-3);
}

#[test]
fn every_morph_ends_in_its_sides() {
    let rest = Options { modes: 3, ..Options::default() };
    let from = PdeSurface::new(&[lumpy(NODES, 24)], rest).unwrap();
    let other = lumpy([0.0, 0.2, 0.7, 1.0], 15);
    let to = PdeSurface::new(&[other], Options { a: 1.7, modes: 5, remainder: true }).unwrap();
    for method in [Method::Boundary, Method::Modes, Method::Combined, Method::Spine] {
        let morph = morph(&from, &to, method);
        assert!(apart(&morph.frame(0.0).unwrap(), &from.frame()) < 1e-12, "{method:?}");
        assert!(apart(&morph.frame(1.0).unwrap(), &to.frame()) < 1e-12, "{method:?}");
        // no jump anywhere: a small step in time is a small step in space
        for i in 0..200 {
            let [s, t] = [f64::from(i), f64::from(i + 1)].map(|i| morph.frame(i / 200.0).unwrap());
            assert!(apart(&s, &t) < 0.5, "{method:?} at {i}");
        }
    }
}

#[test]
fn modes_leave_one_by_one() {
    let plain = |modes| Options { modes, ..PLAIN };
    let [from, to] = [24, 15].map(|n| lumpy(NODES, n));
    let solve = |b: &Boundary, modes| {
        PdeSurface::new(std::slice::from_ref(b), plain(modes)).unwrap().frame()
    };
    let [a, b] = [&from, &to].map(|x| PdeSurface::new(std::slice::from_ref(x), plain(3)).unwrap());
    let modes = morph(&a, &b, Method::Modes);
    let frames = [(&from, 3), (&from, 2), (&from, 1), (&to, 1), (&to, 2), (&to, 3)];
    for (i, (side, count)) in frames.into_iter().enumerate() {
        let far = apart(&modes.frame(i as f64 / 5.0).unwrap(), &solve(side, count));
        assert!(far < 1e-12, "frame {i}: {far}");
    }
    // combined: 3, 2, 1, 1, 1, 2, 3 modes of the blended curves
    let combined = morph(&a, &b, Method::Combined);
    for (i, count) in [3, 2, 1, 1, 1, 2, 3].into_iter().enumerate() {
        let t = i as f64 / 6.0;
        let [a, b] =
            [&from, &to].map(|x| PdeSurface::new(std::slice::from_ref(x), plain(count)).unwrap());
        let far =
            apart(&combined.frame(t).unwrap(), &morph(&a, &b, Method::Boundary).frame(t).unwrap());
        assert!(far < 1e-12, "frame {i}: {far}");
    }
}

#[test]
fn patches_are_paired_by_cutting() {
    let options = Options { modes: 4, ..PLAIN };
    let bottle = named(&shapes::KleinBottle::default(), 10, options);
    let shell = named(&shapes::SeaShell::default(), 4, options);
    for method in [Method::Boundary, Method::Spine] {
        let morph = morph(&bottle, &shell, method);
        let frame = morph.frame(1.0).unwrap();
        // joints at tenths and quarters
        assert_eq!(frame.patches.len(), 12);
        for x in [0.0, 0.031, 0.3, 0.77, 0.99] {
            let cuts = [0.0, 0.1, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.75, 0.8, 0.9, 1.0];
            let i = cuts.windows(2).position(|w| (w[0]..w[1]).contains(&x)).unwrap();
            let w = (x - cuts[i]) / (cuts[i + 1] - cuts[i]);
            let got = frame.point(i, DVec2::new(w, 2.0));
            let patch = (x * 4.0) as usize;
            let want = shell.point(patch, DVec2::new(x * 4.0 - patch as f64, 2.0));
            assert!((got - want).length() < 1e-10, "{method:?} at {x}: {got} not {want}");
        }
        // still one tube on the way
        let middle = morph.frame(0.4).unwrap();
        for i in 1..12 {
            let [a, b] = [(i - 1, 1.0), (i, 0.0)].map(|(p, u)| middle.point(p, DVec2::new(u, 1.0)));
            assert!((a - b).length() < 1e-9, "{method:?} joint {i}");
        }
    }
}

#[test]
fn a_patch_without_partner_grows_from_a_point() {
    let tube =
        |x: f64, r: f64| Boundary::new([0.0, 1.0, 2.0, 3.0].map(|z| ring([x, 0.0, 10.0 * z], r)));
    let one = PdeSurface::new(&[tube(0.0, 4.0)], PLAIN).unwrap();
    let two = PdeSurface::new(&[tube(100.0, 8.0), tube(120.0, 1.0)], PLAIN).unwrap();
    let seed = morph(&one, &two, Method::Spine).frame(0.0).unwrap();
    assert_eq!(seed.patches.len(), 2);
    let p = seed.point(1, DVec2::new(0.3, 1.0));
    assert_eq!(p, seed.point(1, DVec2::new(0.8, 4.0)));
    // on the side of the first tube that faces where the second will be, and at half its height
    assert!(p.x > 4.0 && (p.z - 15.0).abs() < 2.0, "{p}");
    let back = morph(&two, &one, Method::Boundary).frame(1.0).unwrap();
    assert!((back.point(1, DVec2::new(0.3, 1.0)) - p).length() < 1e-12);
}

#[test]
fn curves_and_radius_have_their_own_epsilon() {
    let [from, to] = [PLAIN; 2].map(|o| PdeSurface::new(&[lumpy(NODES, 16)], o).unwrap());
    let flat = PdeSurface::new(
        &[Boundary::new([0.0, 1.0, 2.0, 3.0].map(|z| ring([0.0, 0.0, z], 1.0)))],
        PLAIN,
    )
    .unwrap();
    let still = Epsilon::steady(0.0);
    let options = MorphOptions { method: Method::Spine, radial: Some(still), ..Default::default() };
    let spine = PdeMorph::new(&from, &flat, options).unwrap().frame(1.0).unwrap();
    let uv = DVec2::new(0.4, 2.0);
    let radius = |f: &Frame| f.point(0, uv) - f.patches[0].spine(uv.x);
    assert!((radius(&spine) - radius(&from.frame())).length() < 1e-13);
    assert!((spine.patches[0].spine(0.4) - flat.frame().patches[0].spine(0.4)).length() < 1e-13);

    let early = Epsilon { gamma: 1.0, power: 0.5 };
    let curves = Some([Epsilon::default(), still, early, Epsilon::default()]);
    let options = MorphOptions { curves, ..Default::default() };
    let frame = PdeMorph::new(&to, &flat, options).unwrap().frame(0.25).unwrap();
    for (k, eps) in [0.25, 0.0, 0.5, 0.25].into_iter().enumerate() {
        let [a, b] = [&to, &flat].map(|s| s.frame().point(0, DVec2::new(NODES[k], 1.0)));
        let got = frame.point(0, DVec2::new(NODES[k], 1.0));
        assert!((got - (a * (1.0 - eps) + b * eps)).length() < 1e-12, "curve {k}");
    }
    // gamma 2 goes as far beyond the target
    let options = MorphOptions { epsilon: Epsilon::steady(2.0), ..Default::default() };
    let frame = PdeMorph::new(&to, &flat, options).unwrap().frame(1.0).unwrap();
    let [a, b] = [&to, &flat].map(|s| s.point(0, uv));
    assert!((frame.point(0, uv) - (b * 2.0 - a)).length() < 1e-12);
}

#[test]
fn spine_is_the_mean_over_v() {
    let shell = named(&shapes::SeaShell::default(), 9, PLAIN);
    let lines = shell.spine(4);
    assert_eq!(lines.len(), 1);
    assert_eq!(lines[0].len(), 9 * 4 + 1);
    let ring = (0..16).map(|j| shell.point(0, DVec2::new(0.25, TAU * f64::from(j) / 16.0)));
    assert!((lines[0][1] - ring.sum::<DVec3>() / 16.0).length() < 1e-14);
}

#[test]
fn a_grid_is_its_points() {
    let surface = PdeSurface::new(
        &[lumpy(NODES, 16), lumpy(NODES, 11)],
        Options { modes: 3, ..Options::default() },
    )
    .unwrap();
    let (us, vs) = ([0.0, 0.4, 1.0], [0.0, 1.0, 2.5, 6.0]);
    let grid = surface.grid(&us, &vs);
    assert_eq!(grid.len(), 2 * 12);
    for (i, p) in grid.iter().enumerate() {
        let uv = DVec2::new(us[i % 12 / 4], vs[i % 4]);
        assert!((*p - surface.point(i / 12, uv)).length() < 1e-13);
    }
    assert!(surface.grid(&[], &vs).is_empty() && surface.grid(&us, &[]).is_empty());
}

#[test]
fn bad_input_names_its_key() {
    let good = || lumpy(NODES, 16);
    let fails = |patches: &[Boundary], options: Options, at: &str, why: &str| {
        let error = PdeSurface::new(patches, options).unwrap_err();
        assert_eq!(error.at, at, "{error}");
        assert!(error.why.contains(why), "{error}");
    };
    fails(&[], PLAIN, "patches", "none");
    for a in [0.5, f64::NAN, f64::INFINITY, -1.0] {
        fails(&[good()], Options { a, ..PLAIN }, "a", "at least 1");
    }
    fails(&[good()], Options { modes: 0, ..PLAIN }, "modes", "at least 1");
    fails(&[good()], Options { modes: 20, ..Options::default() }, "remainder", "21");
    fails(&[good()], Options { modes: 8, ..PLAIN }, "patches[0].curves[0]", "need at least 17");
    fails(&[good()], Options { modes: usize::MAX, ..PLAIN }, "patches[0].curves[0]", "need");
    for u in [[0.0, 0.5, 0.4, 1.0], [0.0, 0.0, 0.5, 1.0], [0.0, 0.1, 0.2, 1.1], [f64::NAN; 4]] {
        let bad = Boundary { nodes: u, ..good() };
        fails(&[good(), bad], PLAIN, "patches[1].u", "increasing");
    }
    let mut bad = good();
    bad.curves[1] = Curve::Points(vec![DVec3::ZERO; 20]);
    fails(&[good(), good(), bad], PLAIN, "patches[2].curves[1]", "20 points; curves[0] has 16");
    let mut bad = good();
    let Curve::Points(points) = &mut bad.curves[3] else { unreachable!() };
    points[7].y = f64::NAN;
    fails(&[bad], PLAIN, "patches[0].curves[3]", "entry 7 is not finite");
    let many = Curve::Points(vec![DVec3::ONE; MOST_POINTS + 1]);
    let many = Boundary::new([0, 1, 2, 3].map(|_| many.clone()));
    fails(&[many], PLAIN, "patches[0].curves[0]", "at most 4096");

    let surface = PdeSurface::new(&[good()], PLAIN).unwrap();
    for bad in [f64::NAN, -1.0] {
        let options = MorphOptions { epsilon: Epsilon::steady(bad), ..Default::default() };
        assert_eq!(PdeMorph::new(&surface, &surface, options).unwrap_err().at, "gamma");
        assert!(morph(&surface, &surface, Method::Modes).at(bad).is_err());
    }
}

#[test]
fn warns_of_many_modes_and_idle_options() {
    let many = PdeSurface::new(&[lumpy(NODES, 40)], Options { modes: 12, ..PLAIN }).unwrap();
    assert!(many.warnings()[0].starts_with("patches[0]: a times modes is 12"));
    let radial = Some(Epsilon::default());
    let morph = PdeMorph::new(&many, &many, MorphOptions { radial, ..Default::default() }).unwrap();
    assert_eq!(morph.warnings().len(), 3);
    assert!(morph.warnings()[2].starts_with("radial: "));
}

proptest! {
    #[test]
    fn any_nodes_and_rates_meet_their_curves(
        steps in prop::array::uniform5(0.02f64..1.0), a in 1.0f64..4.0, v in 0.0..TAU
    ) {
        let total: f64 = steps.iter().sum();
        let mut u = 0.0;
        let nodes = [0, 1, 2, 3].map(|k| { u += steps[k] / total; u });
        let options = Options { a, modes: 3, remainder: true };
        let boundary = lumpy(nodes, 16);
        let surface = PdeSurface::new(std::slice::from_ref(&boundary), options).unwrap();
        for (u, curve) in nodes.into_iter().zip(&boundary.curves) {
            let want = curve.fourier(3, "curve").unwrap().point(v);
            prop_assert!((surface.point(0, DVec2::new(u, v)) - want).length() < 1e-8);
        }
    }
}
