//! Figures of METHODS A-004: 41 x 41 nodes, flat at rest, zero tangents, the force 800 on z. The
//! reference is exact in time (all modes of the difference operator).

use super::*;
use crate::surface::{Motion, SurfaceError};
use glam::{DVec3, dvec2};

fn e(text: &str) -> Expr {
    Expr::parse(text, &VARIABLES).unwrap()
}

fn xyz(text: [&str; 3]) -> [Expr; 3] {
    text.map(e)
}

fn with(f: impl FnOnce(&mut Options)) -> Options {
    let mut o = Options::default();
    f(&mut o);
    o
}

fn heights(d: &Dynamic, s: &State) -> Vec<f64> {
    d.nodes(s).unwrap().iter().map(|p| p.z).collect()
}

/// Largest |z|.
fn reach(d: &Dynamic, s: &State) -> f64 {
    heights(d, s).iter().fold(0.0, |m: f64, z| m.max(z.abs()))
}

fn near(got: f64, want: f64, share: f64, what: &str) {
    assert!((got - want).abs() <= share * want.abs(), "{what}: {got}, expected {want}");
}

/// Largest |z| at t = 0, dt, 2 dt, ... and the last state.
fn history(d: &Dynamic) -> Vec<f64> {
    let mut state = d.start();
    let mut out = vec![reach(d, &state)];
    for _ in 0..d.options().steps {
        d.step(&mut state).unwrap();
        out.push(reach(d, &state));
    }
    out
}

/// Steady state, peak, time of the peak, |z| at .01 .02 .03 .05 .1 .2, share of nodes above half.
type Row = (f64, f64, f64, [f64; 6], f64);

fn row(mut o: Options, dt: f64, (steady, peak, time, at, above): Row) {
    (o.dt, o.steps) = (dt, (0.2 / dt).round() as usize);
    let d = Dynamic::new(o).unwrap();
    let balance = d.steady(0.0).unwrap();
    near(reach(&d, &balance), steady, 1e-5, "steady state");
    let half = steady / 2.0;
    let area = heights(&d, &balance).iter().filter(|z| z.abs() > half).count() as f64 / 1600.0;
    near(area, above, 2e-3, "area above half");
    let all = history(&d);
    let (k, highest) =
        all.iter().enumerate().fold((0, 0.0), |m, (k, &z)| if z > m.1 { (k, z) } else { m });
    near(highest, peak, 2e-3, "peak");
    assert!((k as f64 * dt - time).abs() < 6e-4, "peak at {}, expected {time}", k as f64 * dt);
    for (t, want) in [0.01, 0.02, 0.03, 0.05, 0.1, 0.2].into_iter().zip(at) {
        near(all[(t / dt).round() as usize], want, 0.01, &format!("t = {t}"));
    }
}

#[test]
fn table_base() {
    let at = [0.51987, 1.57607, 1.97688, 0.35292, 0.79401, 1.34677];
    row(Options::default(), 2e-4, (1.01772, 1.9875, 0.029, at, 0.268));
}

#[test]
fn table_b_10() {
    let at = [0.38529, 0.18857, 0.09288, 0.07074, 0.14469, 0.27333];
    row(with(|o| o.control[2].b = 10.0), 1e-4, (0.21581, 0.45494, 0.0135, at, 0.293));
}

#[test]
fn table_c_minus_1_5() {
    let at = [0.51713, 2.04288, 3.09628, 2.35696, 2.59126, 1.72152];
    row(with(|o| o.control[2].c = -1.5), 2e-4, (1.79627, 3.41424, 0.0366, at, 0.233));
}

#[test]
fn table_d_minus_0_001() {
    let at = [0.45801, 1.63113, 2.90749, 2.30593, 2.18725, 1.90385];
    row(with(|o| o.control[2].d = -0.001), 2e-4, (1.65757, 3.33799, 0.0378, at, 0.371));
}

#[test]
fn table_eta_20() {
    let at = [0.28796, 0.71052, 0.92305, 1.01846, 1.01776, 1.01772];
    row(with(|o| o.eta = 20.0), 2e-4, (1.01772, 1.02077, 0.0605, at, 0.268));
}

#[test]
fn table_rho_1() {
    let at = [0.04761, 0.18791, 0.46454, 1.29705, 1.99198, 0.42552];
    row(with(|o| o.rho = 1.0), 2e-4, (1.01772, 2.08429, 0.0921, at, 0.268));
}

/// The printed scheme, step by step (METHODS: measured with an independent program).
#[test]
fn implicit_scheme_is_equation_6() {
    for (dt, steps, peak, at) in [(1e-4, 300, 1.95736, 1.94250), (1e-3, 40, 1.79587, 1.76840)] {
        let d = Dynamic::new(Options { dt, steps, scheme: Scheme::Implicit, ..Options::default() });
        let all = history(&d.unwrap());
        near(all.iter().fold(0.0, |m: f64, z| m.max(*z)), peak, 1e-5, "peak");
        near(all[(0.03 / dt).round() as usize], at, 1e-5, "t = 0.03");
    }
}

#[test]
fn steady_plate_converges_to_the_clamped_plate() {
    // Uniformly loaded clamped square plate, middle: .00126532 q (Timoshenko).
    let mut error = f64::INFINITY;
    for (n, want) in [(11, 1.09576), (21, 1.03391), (41, 1.01772), (81, 1.01363)] {
        let d = Dynamic::new(with(|o| o.grid = [n; 2])).unwrap();
        let got = reach(&d, &d.steady(0.0).unwrap());
        near(got, want, 1e-5, &format!("{n} nodes"));
        let now = got - 0.00126532 * 800.0;
        assert!(error.is_infinite() || (3.7..4.3).contains(&(error / now)), "second order");
        error = now;
    }
}

#[test]
fn steady_tangents() {
    let pulled = |tangents: [&str; 4]| {
        let d = Dynamic::new(with(|o| {
            let row = |k: usize| xyz(["0", "0", tangents[k]]);
            *o.boundary.tangents = [0, 1, 2, 3].map(row);
        }))
        .unwrap();
        let z = heights(&d, &d.steady(0.0).unwrap());
        let least = z.iter().fold(f64::INFINITY, |m, z| m.min(*z));
        let most = z.iter().fold(f64::NEG_INFINITY, |m, z| m.max(*z));
        (z[20 * 41 + 20], least, most)
    };
    let (centre, _, most) = pulled(["3", "0", "0", "0"]);
    near(centre, 1.19464, 1e-5, "b1 = 3, centre");
    near(most, 1.20802, 1e-5, "b1 = 3, highest");
    let (centre, least, _) = pulled(["0", "10", "0", "0"]);
    near(least, -0.59904, 1e-5, "b3 = 10, lowest");
    near(centre, 0.42801, 2e-5, "b3 = 10, centre");
    let (_, least, most) = pulled(["3", "3", "3", "0"]);
    near(least, -0.09490, 2e-4, "b1 = b3 = b5 = 3, lowest");
    near(most, 1.25021, 1e-5, "b1 = b3 = b5 = 3, highest");
    let (centre, least, most) = pulled(["-3", "3", "-3", "3"]);
    near(least, -0.18381, 1e-4, "all four, lowest");
    near(most, 0.31007, 2e-5, "all four, highest");
    near(centre, most, 1e-9, "all four, centre is the top");
}

#[test]
fn ill_posed_control_is_refused_where_it_fails() {
    let tiny = |n: usize, all: bool| {
        Dynamic::new(with(|o| {
            o.grid = [n; 2];
            o.control[2].d = -0.001;
            if all {
                o.control = [o.control[2]; 3];
            }
        }))
    };
    assert!(tiny(41, true).is_ok() && tiny(71, false).is_ok());
    let refused = tiny(81, true).unwrap_err();
    assert_eq!(refused.at, "control.d");
    assert!(refused.why.contains("ill-posed on this grid"), "{refused}");
    assert!(refused.why.contains("25 negative eigenvalues"), "{refused}");
    assert_eq!(tiny(81, false).unwrap_err().at, "control[2].d");
    // Below -2 sqrt(b d) the mixed term is at fault, on any grid fine enough.
    let c = Dynamic::new(with(|o| o.control = [Control { b: 1.0, c: -2.5, d: 1.0 }; 3]));
    assert_eq!(c.unwrap_err().at, "control.c");
    let none = Dynamic::new(with(|o| o.control = [Control { b: 0.0, c: 0.0, d: 0.0 }; 3]));
    assert!(none.unwrap_err().why.contains("eigenvalue of zero"));
}

#[test]
fn flipped_force_gives_the_mirror_image() {
    let run = |f: f64| {
        let d = Dynamic::new(with(|o| {
            o.grid = [15, 12];
            o.steps = 80;
            o.force[2] = Expr::number(f, &VARIABLES);
        }))
        .unwrap();
        d.nodes(&d.state(80).unwrap()).unwrap()
    };
    let (up, down) = (run(800.0), run(-800.0));
    let flip = DVec3::new(1.0, 1.0, -1.0);
    assert!(up.iter().any(|p| p.z > 0.5));
    assert!(up.iter().zip(&down).all(|(a, b)| *a == *b * flip));
    // The square itself stays symmetric about its middle lines.
    for (i, j) in (0..15).flat_map(|i| (0..12).map(move |j| (i, j))) {
        let (p, q, r) = (up[i * 12 + j].z, up[(14 - i) * 12 + j].z, up[i * 12 + 11 - j].z);
        assert!((p - q).abs() < 1e-11 && (p - r).abs() < 1e-11);
    }
}

/// Polynomials of degree two in u, v and t are exact in all differences and in the trapezoidal
/// rule, so any wrong coefficient, ghost, boundary time or node order shows at full size.
#[test]
fn quadratic_motions_are_exact() {
    for grid in [[7, 11], [12, 6]] {
        let q = ["u^2*v^2+u", "v-u*v^2", "1-u^2+3*u*v^2"];
        // c times the mixed derivative of q.
        let qc = ["4*0.7", "0", "0"];
        let (b, d) = (1.3, 0.4);
        let position: Vec<String> = q.iter().map(|q| format!("({q})*(1+t-3*t^2)")).collect();
        let position = [0, 1, 2].map(|k| e(&position[k]));
        let o = Options {
            grid,
            dt: 0.07,
            steps: 12,
            scheme: Scheme::Trapezoidal,
            rho: 0.3,
            eta: 2.0,
            control: [0.7, 5.0, -0.2].map(|c| Control { b, c, d }),
            force: [0, 1, 2].map(|k| {
                let (q, qc) = (q[k], qc[k]);
                e(&format!("0.3*(-6)*({q})+2*(1-6*t)*({q})+({qc})*(1+t-3*t^2)"))
            }),
            boundary: Boundary {
                curves: Curves::Given(Box::new([(); 4].map(|()| position.clone()))),
                tangents: Box::new(
                    [0, 0, 1, 1].map(|by| [0, 1, 2].map(|k| position[k].derivative(by).unwrap())),
                ),
                tangents_of: TangentsOf::Position,
            },
            start: Start::Given { position: position.clone(), velocity: xyz(q) },
        };
        let d = Dynamic::new(o).unwrap();
        let surface = d.at(1.0).unwrap();
        for k in 0..50 {
            let (u, v) = ((k as f64 * 0.137).fract(), (k as f64 * 0.311).fract());
            let jet = surface.jet(0, dvec2(u, v));
            for (k, position) in position.iter().enumerate() {
                let at = [u, v, 0.84];
                let by = |i| position.derivative(i).unwrap().eval(&at).unwrap();
                assert!((jet.s[k] - position.eval(&at).unwrap()).abs() < 1e-9);
                assert!((jet.su[k] - by(0)).abs() < 1e-8 && (jet.sv[k] - by(1)).abs() < 1e-8);
            }
        }
    }
}

#[test]
fn order_of_convergence_in_time() {
    // A force that starts gently, so that the modes the grid cannot resolve stay quiet.
    let end = |scheme: Scheme, steps: usize| {
        let d = Dynamic::new(with(|o| {
            (o.grid, o.scheme) = ([11; 2], scheme);
            (o.steps, o.dt) = (steps, 0.05 / steps as f64);
            o.force[2] = e("800*sin(40*t)^2");
        }))
        .unwrap();
        d.nodes(&d.state(steps).unwrap()).unwrap()[5 * 11 + 5].z
    };
    for (scheme, ratio) in [(Scheme::Trapezoidal, 3.8..4.2), (Scheme::Implicit, 1.7..2.4)] {
        let [a, b, c] = [200, 400, 800].map(|n| end(scheme, n));
        assert!(ratio.contains(&((a - b) / (b - c))), "{scheme:?}: {}", (a - b) / (b - c));
    }
}

#[test]
fn any_step_is_stable() {
    for scheme in [Scheme::Trapezoidal, Scheme::Implicit] {
        for dt in [1e-3, 0.1, 10.0] {
            let d = with(|o| (o.grid, o.dt, o.scheme, o.steps) = ([15; 2], dt, scheme, 300));
            let d = Dynamic::new(d).unwrap();
            assert!(history(&d).iter().all(|z| *z < 2.5), "{scheme:?} {dt}");
        }
    }
}

#[test]
fn steady_start_stays_and_massless_surfaces_settle() {
    let d = Dynamic::new(with(|o| (o.grid, o.start) = ([15; 2], Start::Steady))).unwrap();
    let (first, last) = (d.start(), d.state(50).unwrap());
    let far = |a: &[DVec3], b: &[DVec3]| a.iter().zip(b).all(|(a, b)| (*a - *b).length() < 1e-9);
    assert!(far(&d.nodes(&first).unwrap(), &d.nodes(&last).unwrap()));
    let d = Dynamic::new(with(|o| (o.grid, o.rho, o.eta) = ([15; 2], 0.0, 20.0))).unwrap();
    let (last, steady) = (d.state(400).unwrap(), d.steady(0.0).unwrap());
    assert!((reach(&d, &last) / reach(&d, &steady) - 1.0).abs() < 1e-4);
}

#[test]
fn zero_tangents_leave_the_rest_patch_alone() {
    // A skew quadrilateral: its bilinear patch balances without a force.
    let corner = ["1+u+0.5*v-0.3*u*v", "2*v+u*v", "u-v+2*u*v"];
    let d = Dynamic::new(with(|o| {
        o.grid = [9, 13];
        o.steps = 20;
        o.force = xyz(["0", "0", "0"]);
        o.boundary.curves = Curves::Given(Box::new([(); 4].map(|()| xyz(corner))));
    }))
    .unwrap();
    let surface = d.at(1.0).unwrap();
    for (u, v) in [(0.0, 0.0), (0.3, 0.7), (1.0, 0.2), (0.55, 1.0)] {
        let p = surface.point(0, dvec2(u, v));
        for k in 0..3 {
            assert!((p[k] - e(corner[k]).eval(&[u, v, 0.0]).unwrap()).abs() < 1e-9);
        }
    }
}

#[test]
fn the_motion_meets_its_steps_boundary_and_itself() {
    let d = Dynamic::new(with(|o| {
        (o.grid, o.steps) = ([13, 9], 200);
        o.boundary.tangents[1] = xyz(["0", "0", "5*t*v*(1-v)"]);
        o.force[2] = e("800*cos(20*t)+u");
    }))
    .unwrap();
    let t = 151.0 / 200.0;
    let late = d.at(t).unwrap();
    assert_eq!(*d.at(0.0).unwrap().point(0, dvec2(0.5, 0.5)).as_ref(), [0.5, 0.5, 0.0]);
    let state = d.state(151).unwrap();
    for (i, j) in [(0, 0), (3, 4), (12, 8), (6, 8)] {
        let uv = dvec2(i as f64 / 12.0, j as f64 / 8.0);
        assert!((late.point(0, uv) - d.nodes(&state).unwrap()[i * 9 + j]).length() < 1e-13);
    }
    // The tangent asked for, at a node of the edge u = 1; level where none is.
    let time = 151.0 * d.options().dt;
    let jet = late.jet(0, dvec2(1.0, 0.5));
    assert!((jet.su - DVec3::new(1.0, 0.0, 5.0 * time * 0.25)).length() < 1e-11);
    assert!((late.jet(0, dvec2(0.5, 0.0)).sv - DVec3::Y).length() < 1e-11);
    // Between steps the way is straight; a new motion asked in another order says the same.
    let (next, half) = (d.at(152.0 / 200.0).unwrap(), d.at(151.5 / 200.0).unwrap());
    let again = Dynamic::new(d.options().clone()).unwrap().at(t).unwrap();
    for k in 0..20 {
        let uv = dvec2((k as f64 * 0.37).fract(), (k as f64 * 0.61).fract());
        let mean = 0.5 * (late.point(0, uv) + next.point(0, uv));
        assert!((half.point(0, uv) - mean).length() < 1e-12);
        assert_eq!(again.jet(0, uv), late.jet(0, uv));
    }
}

#[test]
fn bad_options_name_their_key() {
    let why = |f: &dyn Fn(&mut Options)| Dynamic::new(with(f)).err().unwrap();
    let at = |f: &dyn Fn(&mut Options)| why(f).at;
    assert_eq!(at(&|o| o.grid = [4, 41]), "grid");
    assert_eq!(at(&|o| o.grid = [100_000; 2]), "grid");
    assert_eq!(at(&|o| o.grid = [usize::MAX; 2]), "grid");
    assert_eq!(at(&|o| o.dt = 0.0), "dt");
    assert_eq!(at(&|o| o.dt = f64::NAN), "dt");
    assert_eq!(at(&|o| o.steps = 0), "steps");
    assert_eq!(at(&|o| o.rho = -0.1), "rho");
    assert_eq!(at(&|o| o.eta = f64::INFINITY), "eta");
    assert_eq!(at(&|o| (o.rho, o.eta) = (0.0, 0.0)), "rho");
    assert_eq!(at(&|o| o.control[1].c = f64::NAN), "control[1].c");
    assert_eq!(at(&|o| o.force[1] = Expr::parse("v", &["v"]).unwrap()), "force[1]");
    let zero = why(&|o| o.force[2] = e("1/(u-0.5)"));
    assert_eq!(zero.at, "force[2]");
    assert!(zero.why.contains("division by zero") && zero.why.contains("u = 0.5"), "{zero}");
    assert_eq!(
        at(&|o| o.boundary.tangents[2] = xyz(["0", "log(-1-u)", "0"])),
        "boundary.tangents.v0[1]"
    );
    let torn = why(&|o| {
        let mut edges = [(); 4].map(|()| xyz(["u", "v", "0"]));
        edges[3][2] = e("0.1*u");
        o.boundary.curves = Curves::Given(Box::new(edges));
    });
    assert_eq!(
        torn,
        SurfaceError::new("boundary.curves.v1[2]", "is 0.1 in the corner where u1 is 0, at t = 0")
    );
}

#[test]
fn troubles_on_the_way_are_errors() {
    let late = |force: &str| {
        let d = Dynamic::new(with(|o| (o.grid, o.force[2]) = ([9; 2], e(force)))).unwrap();
        d.at(1.0).err().unwrap()
    };
    assert_eq!(late("1/(0.1-t)+0*sqrt(0.1-t)").at, "force[2]");
    let away = late("exp(1000*t)");
    assert_eq!(away.at, "steps");
    assert!(away.why.contains("leaves 1e12 mm at step"), "{away}");
    let d = Dynamic::new(with(|o| o.grid = [9; 2])).unwrap();
    for t in [-0.1, 1.1, f64::NAN] {
        assert_eq!(d.at(t).err().unwrap().at, "t");
    }
    let other = Dynamic::new(with(|o| o.grid = [11; 2])).unwrap();
    assert_eq!(other.step(&mut d.start()).unwrap_err().at, "grid");
    assert_eq!(other.surface(&d.start()).unwrap_err().at, "grid");
}
