use super::functions::Operator;
use super::surface::Profile;
use super::*;
use crate::num::lsq::{self, Dense};
use glam::{DVec2, DVec3, dvec2, dvec3};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

fn even(n: usize, to: f64) -> Vec<f64> {
    (0..n).map(|i| to * i as f64 / (n - 1) as f64).collect()
}

fn cylinders_with(basis: Basis, terms: usize, points: usize) -> Blend {
    Blend::new(BlendSpec { basis, terms, collocation: [points; 2], ..cylinders().unwrap() })
        .unwrap()
}

fn shaped(handles: Handles, terms: usize) -> BlendSpec {
    BlendSpec { handles, terms, collocation: [terms + 4; 2], ..cylinders().unwrap() }
}

/// Largest distance from the closed form, component by component, on 101 x 101 points.
fn error(blend: &Blend, t: f64) -> f64 {
    let (us, vs) = (even(101, 1.0), even(101, TAU));
    let exact = blend.exact().unwrap().surface(t).unwrap().jets(&us, &vs);
    let got = blend.surface(t).unwrap().jets(&us, &vs);
    exact.iter().zip(&got).fold(0.0, |m: f64, (a, b)| m.max((a.s - b.s).abs().max_element()))
}

#[test]
fn the_closed_form_has_the_known_points() {
    // METHODS A-002, from an independent solution
    let exact = cylinders_with(Basis::Bubble, 5, 11).exact().unwrap();
    let known = [
        ([0.5, PI / 2.0, 0.0], dvec3(1.194_420_932_070_983_5, 0.0, 1.0)),
        ([0.25, PI / 6.0, 0.0], dvec3(0.731_993_632_964_395_6, 0.807_332_547_943_631_4, 1.40625)),
        ([0.75, 4.0, 0.3], dvec3(-0.642_206_712_966_173_7, -0.520_635_941_997_733_2, 0.59375)),
    ];
    for ([u, v, t], s) in known {
        let got = exact.surface(t).unwrap().point(0, dvec2(u, v));
        assert!((got - s).length() < 1e-14, "{got} {s}");
    }
}

#[test]
fn bubbles_converge_geometrically() {
    for (terms, most) in [(5, 2.4e-5), (7, 6.3e-8), (10, 1e-11)] {
        let e = error(&cylinders_with(Basis::Bubble, terms, 11), 0.0);
        assert!(e <= most, "K = {terms}: {e:.3e}");
    }
}

#[test]
fn corrected_sines_converge_slowly() {
    for (terms, points, t, most) in [
        (5, 11, 0.0, 3.1e-3),
        (7, 11, 0.0, 3.1e-3),
        (5, 11, 0.3, 5.0e-3),
        (5, 41, 0.0, 1.45e-3),
        (10, 41, 0.0, 1.09e-3),
        (20, 41, 0.0, 8.7e-4),
    ] {
        let e = error(&cylinders_with(Basis::Sine, terms, points), t);
        assert!(e <= most && e > 0.9 * most, "K = {terms}, L = {points}: {e:.3e}");
    }
}

/// Paper 002, eq. 12 as printed: value, second and fourth derivative, and the slope.
fn printed(k: usize, u: f64) -> [f64; 4] {
    let (w, s) = (PI * k as f64, if k % 2 == 1 { -1.0 } else { 1.0 });
    let sin = (w * u).sin();
    [
        s * w * (1.0 - u) * u * u + sin,
        s * w * (2.0 - 6.0 * u) - w * w * sin,
        w.powi(4) * sin,
        s * w * (2.0 * u - 3.0 * u * u) + w * (w * u).cos(),
    ]
}

#[test]
fn the_printed_sines_miss_the_tangent_at_the_first_end() {
    // every one leaves a slope of k pi at u = 0, which no coefficient but zero repairs: eq. 10 has
    // c1 = b-bar where the slope of the sines must be taken off
    for k in 1..8 {
        assert!((printed(k, 0.0)[3] - PI * k as f64).abs() < 1e-12);
        assert!(printed(k, 1.0)[3].abs() < 1e-12);
    }
    // solved for x of the test case at t = 0, with the right-hand side mended: G'''' - 12.1 G'' + c G = 0
    // with c = 3 for exp(t) sin(v), from 1.6 to 0, and c = 1 for exp(-t) sin(v), from 0 to 0.8
    let (terms, us) = (5, even(11, 1.0));
    let mut slope = 0.0;
    for (c, ends) in [(3.0, [1.6, 0.0, 0.0, 0.0]), (1.0, [0.0, 0.0, 0.8, 0.0])] {
        let residual = |[z, zz, z4]: [f64; 3]| z4 - 12.1 * zz + c * z;
        let a = Dense::from_fn(11, terms, |l, k| {
            let [z, zz, z4, _] = printed(k + 1, us[l]);
            residual([z, zz, z4])
        });
        let b = Dense::from_fn(11, 1, |l, _| {
            let cubics = profile::cubics(us[l]);
            -(0..4)
                .map(|i| ends[i] * residual([cubics[i][0], cubics[i][2], cubics[i][4]]))
                .sum::<f64>()
        });
        let p = lsq::solve(a, b).x;
        slope += (0..terms).map(|k| p.at(k, 0) * printed(k + 1, 0.0)[3]).sum::<f64>();
    }
    // METHODS: 0.4236 instead of 0
    assert!((slope.abs() - 0.4236).abs() < 1e-4, "{slope}");
    // ours meets the same tangent exactly
    let ours = cylinders_with(Basis::Sine, 5, 11).surface(0.0).unwrap();
    assert!(ours.jet(0, dvec2(0.0, PI / 2.0)).su.x.abs() < 1e-12);
}

/// All examples with both bases.
fn all() -> Vec<Blend> {
    let specs = [cylinders().unwrap(), frustum().unwrap(), cone().unwrap()];
    let both = |s: &BlendSpec| {
        [Basis::Bubble, Basis::Sine]
            .map(|basis| Blend::new(BlendSpec { basis, terms: 7, ..s.clone() }).unwrap())
    };
    specs.iter().flat_map(both).collect()
}

#[test]
fn ends_are_met_exactly() {
    for blend in all() {
        for t in [0.0, 0.3, 0.77, 1.0] {
            let s = blend.surface(t).unwrap();
            for v in even(13, TAU) {
                for (u, side) in [0.0, 1.0].into_iter().zip(&blend.spec().at) {
                    let jet = s.jet(0, dvec2(u, v));
                    let value =
                        |e: &[Expr; 3]| DVec3::from(e.clone().map(|e| e.eval(&[v, t]).unwrap()));
                    let (c, tangent) = (value(&side.position), value(&side.tangent));
                    let size = 1.0 + c.length() + tangent.length();
                    assert!((jet.s - c).length() < 1e-12 * size, "{u} {v} {t}");
                    assert!((jet.su - tangent).length() < 1e-12 * size, "{u} {v} {t}");
                }
            }
        }
    }
}

/// Largest gap between derivatives and central differences.
fn slope_error(s: &dyn Surface, patch: usize) -> f64 {
    let (d, h) = (s.domain(patch), 1e-5);
    let mut worst = 0.0f64;
    for i in 1..8 {
        let f = f64::from(i) / 8.0;
        let uv = dvec2(d.u[0] + (d.u[1] - d.u[0]) * f, d.v[0] + (d.v[1] - d.v[0]) * (1.0 - f));
        let jet = s.jet(patch, uv);
        let slope =
            |e: DVec2| (s.point(patch, uv + e * h) - s.point(patch, uv - e * h)) / (2.0 * h);
        worst = worst.max((slope(DVec2::X) - jet.su).length());
        worst = worst.max((slope(DVec2::Y) - jet.sv).length());
    }
    worst
}

#[test]
fn derivatives_are_those_of_the_position() {
    for blend in all() {
        let three = blend.beside().unwrap().at(0.4).unwrap();
        assert_eq!(three.patches(), 3);
        for patch in 0..3 {
            // sizes of 100, and third derivatives of some 10^4 at wave number 8: h^2 times that / 6
            assert!(slope_error(&*three, patch) < 1e-5, "{patch}");
        }
    }
    let exact = cylinders_with(Basis::Bubble, 5, 11).exact().unwrap().at(0.2).unwrap();
    assert!(slope_error(&*exact, 0) < 1e-8);
}

#[test]
fn a_grid_is_its_points() {
    for blend in all() {
        let s = blend.surface(0.6).unwrap();
        let (us, vs) = (even(5, 1.0), even(7, TAU));
        let grid = s.jets(&us, &vs);
        for (i, jet) in grid.iter().enumerate() {
            assert_eq!(*jet, s.jet(0, dvec2(us[i / 7], vs[i % 7])));
        }
    }
}

#[test]
fn primary_surfaces_join_smoothly() {
    for blend in all() {
        for t in [0.0, 0.5, 1.0] {
            let three = blend.beside().unwrap().at(t).unwrap();
            let cut = |patch: usize| match (&blend.spec().at[patch / 2].extent, patch) {
                (Extent::Cut { cut, .. }, _) => *cut,
                _ => 0.0,
            };
            for (patch, u) in [(0, 0.0), (2, 1.0)] {
                for v in even(9, TAU) {
                    let a = three.jet(patch, dvec2(cut(patch), v));
                    let b = three.jet(1, dvec2(u, v));
                    let gap =
                        (a.s - b.s).length() + (a.su - b.su).length() + (a.sv - b.sv).length();
                    assert!(gap < 1e-10 * (1.0 + b.s.length()), "{patch} {v} {t}: {gap}");
                }
            }
        }
    }
}

#[test]
fn a_strip_closes_to_a_ring() {
    let blend = Blend::new(frustum().unwrap()).unwrap();
    let wraps = |t: f64| blend.at(t).unwrap().domain(0).wraps;
    assert_eq!([wraps(0.0), wraps(0.5), wraps(1.0)], [[false; 2], [false; 2], [false, true]]);
    let three = blend.beside().unwrap().at(0.0).unwrap();
    assert_eq!([0, 1, 2].map(|p| three.domain(p).wraps[1]), [false, false, true]);
}

#[test]
fn applications_have_the_papers_boundaries() {
    // eqs 29 to 32 as printed, but for sin v in the y tangents of 31 and 32; constants of the examples
    let strip = [
        Side::new(
            [
                "(1-t)*(-20*sinh(0.5*v-pi/2)+6*sin(3*v))+30*t*cos(-v)",
                "(1-t)*(-20*cosh(0.25*v)+6*cos(3*v))+30*t*sin(-v)",
                "(1-t)*(90+30)+110*t",
            ],
            ["0", "0", "-(1-t)*30"],
        ),
        Side::new(
            [
                "0.8*(1-t)*60*sin(1*v)+45*t*cos(-v)",
                "0.8*(1-t)*60*cos(1*v)+45*t*sin(-v)",
                "(1-t)*0+10*t",
            ],
            ["(1-t)*60*sin(1*v)", "(1-t)*60*cos(1*v)", "-40*t"],
        ),
    ];
    let s = "sin(pi*t/2)";
    let fill = |x: &str| x.replace('S', s);
    let wrinkled = [
        [
            [
                "(1-S)*(50*cos(v)+4*cos(8*v))+0.36*100*S*cos(v)",
                "(1-S)*(50*sin(v)+4*sin(8*v))+0.36*100*S*sin(v)",
                "(1-S)*120+S*(180+0.6*(-60)+15*cos(v))",
            ],
            ["1.2*100*S*cos(v)", "1.2*100*S*sin(v)", "-80*(1-S)+(-60)*S"],
        ],
        [
            [
                "1.5*(1-S)*45*cos(v)+0.8*75*S*cos(0.3)*cos(v)",
                "1.5*(1-S)*30*sin(v)+0.8*75*S*sin(v)",
                "(1-S)*(20-0.5*60)+S*(-10+0.8*75*sin(0.3)*cos(v))",
            ],
            [
                "-(1-S)*45*cos(v)+75*S*cos(0.3)*cos(v)",
                "-(1-S)*30*sin(v)+75*S*sin(v)",
                "-60*(1-S)+75*S*sin(0.3)*cos(v)",
            ],
        ],
    ];
    let wrinkled = wrinkled.map(|[p, t]| {
        let (p, t) = (p.map(fill), t.map(fill));
        Side::new([0, 1, 2].map(|i| p[i].as_str()), [0, 1, 2].map(|i| t[i].as_str()))
    });
    for (spec, sides) in [(frustum().unwrap(), strip), (cone().unwrap(), wrinkled)] {
        for (ours, papers) in spec.at.iter().zip(sides) {
            let papers = papers.unwrap();
            let pairs = ours.position.iter().zip(&papers.position);
            for (a, b) in pairs.chain(ours.tangent.iter().zip(&papers.tangent)) {
                for x in [[0.3, 0.0], [2.0, 0.4], [5.0, 0.9], [6.2, 1.0]] {
                    let (a, b) = (a.eval(&x).unwrap(), b.eval(&x).unwrap());
                    assert!((a - b).abs() < 1e-12, "{a} {b}");
                }
            }
        }
    }
}

#[test]
fn functions_are_found_in_the_boundaries() {
    let blend = cylinders_with(Basis::Bubble, 5, 11);
    let mut found = blend.functions();
    found.sort();
    // the paper's five (section 4)
    assert_eq!(found, ["1", "exp(-t)*cos(v)", "exp(t)*cos(v)", "exp(t)*sin(v)", "sin(v)*exp(-t)"]);
    // sin(-v) is a multiple of sin(v), and their data add up
    let side = |x: &str| Side::new([x, "0", "0"], ["0"; 3]).unwrap();
    let at = [side("sin(v) + sin(-v)/2"), side("0")];
    let blend = Blend::new(BlendSpec { at, ..cylinders().unwrap() }).unwrap();
    assert_eq!(blend.functions(), ["sin(v)"]);
    let x = blend.surface(0.0).unwrap().point(0, dvec2(0.0, 1.0)).x;
    assert!((x - 0.5 * 1.0f64.sin()).abs() < 1e-15);
}

#[test]
fn closed_forms_of_every_kind_agree_with_bubbles() {
    let h = |gamma, lambda, eta| Handles { beta: 1.0, gamma, lambda, rho: 0.0, eta };
    // real roots, complex ones, imaginary ones, and one function of each
    for handles in [h(12.1, 2.0, 1.0), h(1.0, 5.0, 0.0), h(-3.0, -20.0, 0.0), h(1.0, 2.0, 4.0)] {
        let e = error(&Blend::new(shaped(handles, 14)).unwrap(), 0.2);
        assert!(e < 1e-12, "{handles:?}: {e:.1e}");
    }
    // fast decay does not overflow
    let stiff = Blend::new(shaped(h(1e4, 1.0, 0.0), 5)).unwrap().exact().unwrap();
    assert!(stiff.surface(0.0).unwrap().point(0, dvec2(0.5, 1.0)).is_finite());
}

#[test]
fn repeated_roots_have_no_closed_form() {
    let h = |gamma, lambda, rho, eta| Handles { beta: 1.0, gamma, lambda, rho, eta };
    // r^2 - 2r + 1, and r^2 - 12.1 r + 0 for exp(-t)
    for handles in [h(2.0, 1.0, 0.0, 0.0), h(12.1, 1.0, 1.0, 2.0)] {
        let e = Blend::new(shaped(handles, 7)).unwrap().exact().unwrap_err();
        assert!(e.to_string().contains("has repeated roots"), "{e}");
    }
    let e = Blend::new(cone().unwrap()).unwrap().exact().unwrap_err();
    assert!(e.to_string().contains("no multiples of it"), "{e}");
    let flat = Handles { beta: 0.0, ..cylinders().unwrap().handles };
    let e = Blend::new(shaped(flat, 7)).unwrap().exact().unwrap_err();
    assert_eq!(e.at, "beta");
}

/// A spec whose only data are these x positions at both ends.
fn plain_x(x: [&str; 2], handles: Handles, terms: usize) -> BlendSpec {
    let at = x.map(|x| Side::new([x, "0", "0"], ["0"; 3]).unwrap());
    BlendSpec { at, ..shaped(handles, terms) }
}

#[test]
fn coupled_functions_are_solved_together() {
    // S = t at both ends with eta = 1: S_uuuu + S_t = 0 has S = t - u^2 (1 - u)^2 / 24, where eq. 7
    // would make G depend on t
    let h = Handles { beta: 1.0, gamma: 0.0, lambda: 0.0, rho: 0.0, eta: 1.0 };
    let blend = Blend::new(plain_x(["t", "t"], h, 3)).unwrap();
    for t in [0.0, 0.4, 1.0] {
        let s = blend.surface(t).unwrap();
        for u in even(9, 1.0) {
            let exact = t - (u * (1.0 - u)).powi(2) / 24.0;
            assert!((s.point(0, dvec2(u, 1.0)).x - exact).abs() < 1e-14);
        }
    }
    // S = v^2 with gamma: S_uuuu + gamma S_uuvv = 0 has S = v^2 where G'' = 0
    let h = Handles { beta: 1.0, gamma: 5.0, lambda: 1.0, rho: 1.0, eta: 0.0 };
    let s = Blend::new(plain_x(["v^2", "v^2"], h, 5)).unwrap().surface(0.0).unwrap();
    assert!((s.point(0, dvec2(0.3, 2.0)).x - 4.0).abs() < 1e-12);
}

/// Largest residual of the equation between the ends.
fn residual(blend: &Blend) -> f64 {
    let (spec, sum) = (blend.spec(), &blend.sum);
    let Profile::Series { basis, terms } = sum.profile else { return f64::NAN };
    let mut worst = 0.0f64;
    for (u, v, t) in [(0.21, 0.3, 0.13), (0.5, 2.0, 0.5), (0.77, 4.4, 0.91), (0.4, 5.9, 0.33)] {
        let mut r = DVec3::ZERO;
        for (f, weights) in sum.functions.iter().zip(&sum.weights) {
            let operator = Operator::new(&f.f, &spec.handles).unwrap();
            let [fourth, second, none] = operator.columns(&[[v, t]]).unwrap().map(|c| c[0]);
            let mut add =
                |w: DVec3, z: [f64; 5]| r += w * (fourth * z[4] + second * z[2] + none * z[0]);
            profile::cubics(u).iter().zip(weights).for_each(|(z, &w)| add(w, *z));
            basis.jets(u, terms, |k, z| add(weights[4 + k], z));
        }
        worst = worst.max(r.length());
    }
    worst
}

#[test]
fn the_equation_is_solved_better_with_every_term() {
    // sin(pi t / 2) with eta needs cos(pi t / 2): the residual would not go below some number without
    for spec in [frustum().unwrap(), cone().unwrap()] {
        let at = |terms| {
            residual(
                &Blend::new(BlendSpec { terms, collocation: [32, 21], ..spec.clone() }).unwrap(),
            )
        };
        let [a, b, c] = [8, 14, 24].map(at);
        assert!(b < 0.1 * a && c < 1e-4 * a, "{a:.1e} {b:.1e} {c:.1e}");
    }
}

#[test]
fn open_functions_still_make_a_blend() {
    // derivatives of exp(-v^2) are no sums of finitely many of its kind
    let h = Handles { beta: 1.0, gamma: 1.0, lambda: 0.1, rho: 0.0, eta: 0.0 };
    let spec = BlendSpec { v: [-1.0, 1.0], ..plain_x(["exp(-v^2)", "0"], h, 8) };
    let blend = Blend::new(spec).unwrap();
    assert_eq!(blend.functions(), ["exp(-v^2)"]);
    let s = blend.surface(0.0).unwrap();
    assert!((s.point(0, dvec2(0.0, 0.5)).x - (-0.25f64).exp()).abs() < 1e-14);
    assert!((0.0..1.0).contains(&s.point(0, dvec2(0.5, 0.5)).x));
}

#[test]
fn without_beta_the_least_correction_is_taken() {
    // paper 002, Figure 5a; F = 1 leaves a matrix of zeros
    let handles = Handles { beta: 0.0, gamma: 10.0, lambda: 0.01, rho: 0.01, eta: -5.0 };
    let s = Blend::new(shaped(handles, 7)).unwrap().surface(0.0).unwrap();
    for u in even(5, 1.0) {
        let z = profile::cubics(u);
        let cubic = 2.0 * z[0][0] - 3.0 * (z[1][0] + z[3][0]);
        assert!((s.point(0, dvec2(u, 1.0)).z - cubic).abs() < 1e-14);
    }
    // all handles zero: the cubics, whatever the terms
    let none = Handles { beta: 0.0, gamma: 0.0, lambda: 0.0, rho: 0.0, eta: 0.0 };
    let (us, vs) = (even(5, 1.0), even(5, TAU));
    let jets =
        |terms| Blend::new(shaped(none, terms)).unwrap().surface(0.5).unwrap().jets(&us, &vs);
    assert_eq!(jets(7), jets(0));
}

#[test]
fn resonances_are_refused() {
    // clamped at both ends, G'''' = 500.563901740 G has a solution of its own (4.730040745^4)
    for (basis, terms) in [(Basis::Bubble, 10), (Basis::Bubble, 20)] {
        let near = |lambda| {
            let h = Handles { beta: 1.0, gamma: 0.0, lambda, rho: 0.0, eta: 0.0 };
            Blend::new(BlendSpec { basis, ..plain_x(["sin(v)", "0"], h, terms) })
        };
        let e = near(-500.563_901_740).unwrap_err();
        assert!(e.at == "beta" && e.why.contains("nearly singular"), "{e}");
        assert!(near(-400.0).is_ok() && near(-600.0).is_ok());
    }
}

#[test]
fn bad_specs_name_their_key() {
    let wrong = |change: &dyn Fn(&mut BlendSpec)| {
        let mut spec = cylinders().unwrap();
        change(&mut spec);
        Blend::new(spec).unwrap_err().to_string()
    };
    assert_eq!(
        wrong(&|s| (s.basis, s.terms) = (Basis::Sine, 10)),
        "collocation: 10 sine terms need at least 12 points over u, got 11"
    );
    assert_eq!(
        wrong(&|s| s.terms = 12),
        "collocation: 12 bubble terms need at least 12 points over u, got 11"
    );
    assert_eq!(wrong(&|s| s.terms = 41), "terms: got 41, at most 40 corrections");
    assert_eq!(wrong(&|s| s.collocation[1] = 1), "collocation: got 1, expected 2 to 400");
    assert_eq!(wrong(&|s| s.v = [1.0, 1.0]), "v: got [1, 1], expected a rising range");
    assert_eq!(wrong(&|s| s.handles.rho = f64::NAN), "rho: got NaN, expected a finite number");
    let zero = |s: &mut BlendSpec| s.at[1] = Side::new(["1", "sin(v)/v", "0"], ["0"; 3]).unwrap();
    assert_eq!(wrong(&zero), "at-1.position[1]: division by zero in `sin(v)/v` at v = 0, t = 0");
    let e = Side::new(["0"; 3], ["0", "sni(v)", "0"]).unwrap_err();
    assert_eq!(
        e.to_string(),
        "tangent[1]: character 1: unknown function `sni`; did you mean `sin`?"
    );
    let e = Side::cut(["u", "w", "0"], 0.0, 1.0).unwrap_err();
    assert!(e.to_string().starts_with("surface[1]: character 1: unknown variable `w`"), "{e}");
    // too few points over v and t to tell 1 and cos(v) apart is no matter, each being solved alone
    assert!(Blend::new(BlendSpec { collocation: [11, 2], ..cylinders().unwrap() }).is_ok());
}

#[test]
fn times_without_a_value_are_errors() {
    let at = [
        Side::new(["1/(t - 2)", "sin(v)", "0"], ["0"; 3]).unwrap(),
        Side::new(["0"; 3], ["0"; 3]).unwrap(),
    ];
    let handles = Handles { rho: 0.0, eta: 0.0, ..cylinders().unwrap().handles };
    let blend = Blend::new(BlendSpec { at, handles, ..cylinders().unwrap() }).unwrap();
    assert!(blend.at(1.0).is_ok());
    let e = blend.surface(2.0).unwrap_err();
    assert!(e.to_string().starts_with("at-0.position[0]: division by zero"), "{e}");
    assert!(blend.surface(f64::NAN).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn any_handles_give_numbers_or_an_error(
        exponents in prop::array::uniform5(-300.0..300.0f64),
        signs in prop::array::uniform5(-1.0..1.0f64),
        terms in 0..12usize,
    ) {
        let [beta, gamma, lambda, rho, eta] =
            [0, 1, 2, 3, 4].map(|i| 10f64.powf(exponents[i]) * signs[i].signum());
        let spec = shaped(Handles { beta, gamma, lambda, rho, eta }, terms);
        if let Ok(blend) = Blend::new(spec) {
            let s = blend.surface(0.3).unwrap();
            prop_assert!(s.jets(&even(5, 1.0), &even(5, TAU)).iter().all(|j| j.s.is_finite()));
            if let Ok(exact) = blend.exact() {
                exact.surface(0.3).unwrap().jet(0, dvec2(0.5, 1.0));
            }
        }
    }
}
