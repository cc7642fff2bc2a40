use super::*;
use glam::{DVec2, dvec2, dvec3};

fn even(n: usize, to: f64) -> Vec<f64> {
    (0..n).map(|i| to * i as f64 / (n - 1) as f64).collect()
}

fn cylinders_with(basis: Basis, terms: usize, points: usize) -> Blend {
    Blend::new(BlendSpec { basis, terms, collocation: [points; 2], ..cylinders().unwrap() })
        .unwrap()
}

/// Largest distance from the closed form on 101 x 101 points.
fn error(blend: &Blend, t: f64) -> f64 {
    let (us, vs) = (even(101, 1.0), even(101, std::f64::consts::TAU));
    let exact = blend.exact().unwrap().surface(t).unwrap().jets(&us, &vs);
    let got = blend.surface(t).unwrap().jets(&us, &vs);
    exact.iter().zip(&got).fold(0.0, |m: f64, (a, b)| m.max((a.s - b.s).abs().max_element()))
}

#[test]
fn figures() {
    for (basis, ks) in [(Basis::Bubble, [5, 7, 10]), (Basis::Sine, [5, 7, 9])] {
        for k in ks {
            let b = cylinders_with(basis, k, 11);
            println!("{basis:?} {k} {:.3e} {:.3e}", error(&b, 0.0), error(&b, 0.3));
        }
    }
    for k in [5, 7, 10, 20] {
        let b = cylinders_with(Basis::Sine, k, 41);
        println!("sine 41 {k} {:.3e}", error(&b, 0.0));
    }
    for s in [frustum().unwrap(), cone().unwrap()] {
        let now = std::time::Instant::now();
        let b = Blend::new(s).unwrap();
        println!("{:?} {:?}", now.elapsed(), b.functions());
    }
}
