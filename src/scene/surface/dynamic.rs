//! `dynamic`.

use super::scaled::scaled;
use super::{Parametric, SurfaceFile, check_scale, plain, problem};
use crate::num::Expr;
use crate::recipe::surface::{self as entry, Formula, Kind, StartWord};
use crate::recipe::{PlainOr, Problem};
use crate::surface::dynamic::{
    Boundary, Control, Curves, Dynamic, EDGE_NAMES, Edges, Options, Scheme, Start, TangentsOf,
    VARIABLES,
};
use std::sync::Arc;

/// Most steps: days on a fine grid, so a slip of the hand.
const MOST_STEPS: usize = 10_000_000;

pub fn dynamic(e: &entry::Dynamic) -> Result<SurfaceFile, Problem> {
    check_scale(e.scale)?;
    if e.steps > MOST_STEPS {
        return Err(Problem::new("steps", format!("{} steps; at most {MOST_STEPS}", e.steps)));
    }
    let control = |c: &entry::Control| Control { b: c.b, c: c.c, d: c.d };
    let options = Options {
        grid: e.grid,
        dt: e.dt,
        steps: e.steps,
        scheme: match e.scheme {
            entry::Scheme::Trapezoidal => Scheme::Trapezoidal,
            entry::Scheme::Implicit => Scheme::Implicit,
        },
        rho: e.rho,
        eta: e.eta,
        control: match &e.control {
            PlainOr::Plain(three) => three.each_ref().map(control),
            PlainOr::Table(one) => [control(one); 3],
        },
        force: three(&e.force, "force")?,
        boundary: boundary(&e.boundary)?,
        start: start(&e.start)?,
    };
    let duration = options.dt * options.steps as f64;
    if !(duration.is_finite()) {
        return Err(Problem::new("dt", format!("{} steps of {} never end", e.steps, e.dt)));
    }
    let [nu, nv] = e.grid;
    let story = format!(
        "dynamic surface on {nu} x {nv} nodes, {} steps of {} to t = {duration}",
        e.steps, e.dt
    );
    // one table for all components has no index
    let one = matches!(e.control, PlainOr::Table(_));
    let motion = Arc::new(Dynamic::new(options).map_err(|s| match problem(s) {
        p if one => Problem::new(p.at.replace("control[0]", "control"), p.why),
        p => p,
    })?);
    let object = Parametric::Motion(scaled(motion, e.scale));
    Ok(SurfaceFile { duration: Some(duration), ..plain(Kind::Dynamic, object, story) })
}

/// Three expressions in u, v and t.
fn three(f: &[Formula; 3], at: &str) -> Result<[Expr; 3], Problem> {
    let one = |i: usize| {
        Expr::parse(&f[i].0, &VARIABLES)
            .map_err(|e| Problem::new(format!("{at}[{i}]"), e.to_string()))
    };
    Ok([one(0)?, one(1)?, one(2)?])
}

fn boundary(e: &entry::Boundary) -> Result<Boundary, Problem> {
    let zero = Some([(); 3].map(|()| Formula::default()));
    let curves = match &e.curves {
        Some(PlainOr::Table(all)) => Curves::Given(Box::new(edges(all, None, "boundary.curves")?)),
        Some(PlainOr::Plain(entry::Curves::Flat)) | None => Curves::Flat,
    };
    Ok(Boundary {
        curves,
        tangents: Box::new(edges(&e.tangents, zero, "boundary.tangents")?),
        tangents_of: match e.tangents_of {
            entry::TangentsOf::Displacement => TangentsOf::Displacement,
            entry::TangentsOf::Position => TangentsOf::Position,
        },
    })
}

/// Expressions of all four edges; `default` stands for those left out.
fn edges(e: &entry::Edges, default: Option<[Formula; 3]>, at: &str) -> Result<Edges, Problem> {
    let all = [&e.u0, &e.u1, &e.v0, &e.v1];
    let one = |k: usize| {
        let name = EDGE_NAMES[k];
        match all[k].as_ref().or(default.as_ref()) {
            Some(f) => three(f, &format!("{at}.{name}")),
            None => Err(Problem::new(at, format!("missing key `{name}`, x, y and z of that edge"))),
        }
    };
    Ok([one(0)?, one(1)?, one(2)?, one(3)?])
}

fn start(e: &entry::Start) -> Result<Start, Problem> {
    Ok(match e {
        PlainOr::Plain(StartWord::Rest) => Start::Rest,
        PlainOr::Plain(StartWord::Steady) => Start::Steady,
        PlainOr::Table(t) => Start::Given {
            position: three(&t.position, "start.position")?,
            velocity: three(&t.velocity, "start.velocity")?,
        },
    })
}
