//! `blend`.

use super::scaled::scaled;
use super::{Parametric, SurfaceFile, below, check_scale, plain, problem};
use crate::recipe::Problem;
use crate::recipe::surface::{self as entry, Formula, Kind};
use crate::surface::blend::{Basis, Blend, BlendSpec, Handles, Side};
use crate::surface::{Motion, SurfaceError};
use std::sync::Arc;

pub fn blend(e: &entry::Blend) -> Result<SurfaceFile, Problem> {
    check_scale(e.scale)?;
    if e.exact && e.beside {
        return Err(Problem::new("exact", "the closed form stands alone; remove `beside`"));
    }
    let spec = BlendSpec {
        handles: Handles { beta: e.beta, gamma: e.gamma, lambda: e.lambda, rho: e.rho, eta: e.eta },
        terms: e.terms,
        basis: match e.basis {
            entry::Basis::Bubble => Basis::Bubble,
            entry::Basis::Sine => Basis::Sine,
        },
        collocation: e.collocation,
        v: e.v,
        at: [side(&e.at_0, "at-0")?, side(&e.at_1, "at-1")?],
    };
    let solved = Blend::new(spec).map_err(|s| as_written(e, s))?;
    let count = solved.functions().len();
    let exact = solved.exact();
    let motion: Arc<dyn Motion> = if e.exact {
        Arc::new(exact.clone().map_err(problem)?)
    } else if e.beside {
        Arc::new(solved.beside().map_err(problem)?)
    } else {
        Arc::new(solved)
    };
    let basis = match e.basis {
        entry::Basis::Bubble => "bubble",
        entry::Basis::Sine => "sine",
    };
    let how = if e.exact {
        "in closed form".to_owned()
    } else {
        format!("with {} {basis} terms each", e.terms)
    };
    let functions = if count == 1 { "function" } else { "functions" };
    let story = format!("C1 blend of {count} {functions}, {how}");
    let object = Parametric::Motion(scaled(motion, e.scale));
    let exact = exact.ok().map(|x| Parametric::Motion(scaled(Arc::new(x), e.scale)));
    Ok(SurfaceFile { exact, ..plain(Kind::Blend, object, story) })
}

/// A failure of the library by the key that is in the file: it calls a surface at its cut a position
/// and a tangent.
fn as_written(e: &entry::Blend, s: SurfaceError) -> Problem {
    let ends = [(&e.at_0, "at-0"), (&e.at_1, "at-1")];
    let cut = ends.into_iter().find(|(side, at)| side.surface.is_some() && s.at.starts_with(at));
    match (cut, s.at.find('[')) {
        (Some((_, at)), Some(i)) => Problem::new(format!("{at}.surface{}", &s.at[i..]), s.why),
        _ => problem(s),
    }
}

/// One end: position and tangent, or a surface and its cut.
fn side(e: &entry::Side, at: &str) -> Result<Side, Problem> {
    let texts = |f: &'_ [Formula; 3]| f.clone().map(|f| f.0);
    let entry::Side { position, tangent, surface, from, cut } = e;
    match (position, tangent, surface) {
        (Some(p), Some(t), None) => {
            if let Some((key, _)) =
                [("from", from), ("cut", cut)].into_iter().find(|(_, x)| x.is_some())
            {
                return Err(Problem::new(format!("{at}.{key}"), "only a `surface` has it"));
            }
            let (p, t) = (texts(p), texts(t));
            let [p, t] = [&p, &t].map(|x| x.each_ref().map(String::as_str));
            Side::new(p, t).map_err(below(at))
        }
        (None, None, Some(s)) => {
            let number = |x: &Option<f64>, key: &str| match x {
                Some(x) if x.is_finite() => Ok(*x),
                Some(x) => Err(Problem::new(format!("{at}.{key}"), format!("got {x}"))),
                None => Err(Problem::new(at, format!("missing key `{key}`, a number u"))),
            };
            let (from, cut) = (number(from, "from")?, number(cut, "cut")?);
            let s = texts(s);
            Side::cut(s.each_ref().map(String::as_str), from, cut).map_err(below(at))
        }
        _ => {
            let why = "expected `position` and `tangent`, or `surface` with `from` and `cut`";
            Err(Problem::new(at, why))
        }
    }
}
