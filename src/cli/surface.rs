//! `surface`: parametric surfaces and curves as points or as meshes.

mod frame;
mod motion;
mod out;
mod rows;

use super::failure::Failure;
use super::watch::Watch;
use clap::{Args, ValueHint};
use fieldgraft::job::{self, Job};
use fieldgraft::recipe::surface::Kind;
use fieldgraft::recipe::{SurfaceMethod, numbers, word};
use fieldgraft::run::time_word;
use fieldgraft::scene::surface::{self, SurfaceFile};
use frame::{Frame, Wanted};
use out::Target;
use serde_json::json;
use std::path::{Path, PathBuf};

/// What to sample.
#[derive(Args)]
pub struct Surface {
    /// The surface file (TOML or JSON, `kind = "pde"` and so on)
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    file: PathBuf,
    /// Where it goes: CSV, STL, OBJ, PLY or GLB; `{t}` stands for the time; by default CSV to stdout.
    /// Several times in one GLB, whose name has no `{t}`, become a mesh that moves
    #[arg(short, long, value_name = "OUT")]
    output: Option<String>,
    /// Times: numbers, or ranges such as 0:1:0.125; repeatable. In [0, 1]; for kind dynamic, in the
    /// equation's units. By default 0.5 for a morph, 0 for a blend, the end for kind dynamic
    #[arg(short, value_name = "T", value_parser = times, allow_hyphen_values = true,
        action = clap::ArgAction::Append)]
    t: Vec<Times>,
    /// Points over u and v, both ends included, such as 33x65; N for a curve
    #[arg(long, value_name = "NUxNV", value_parser = samples)]
    samples: Option<[usize; 2]>,
    /// Triangles no farther than this from the surface, where --samples is not given; by default a
    /// 2000th of its size
    #[arg(long, value_name = "MM", conflicts_with = "samples")]
    tolerance: Option<f64>,
    /// Also the derivatives by u and v, in CSV
    #[arg(long, conflicts_with = "spine")]
    derivatives: bool,
    /// The spine of a PDE surface instead, as CSV or OBJ
    #[arg(long)]
    spine: bool,
    /// Morph to this file, which no morph file is needed for
    #[arg(long, value_name = "FILE", requires = "method")]
    to: Option<PathBuf>,
    /// How: pde-boundary, pde-modes, pde-combined, pde-spine, nurbs-linear or nurbs-weighted
    #[arg(long, value_name = "METHOD", requires = "to", value_parser = word::<SurfaceMethod>)]
    method: Option<SurfaceMethod>,
    /// Overwrite what is there
    #[arg(long)]
    force: bool,
    /// Print a report as JSON
    #[arg(long, requires = "output")]
    json: bool,
}

/// Times as they were typed.
#[derive(Clone, Debug)]
struct Times(Vec<f64>);

/// Most times of one command; a typo in a range's step must not fill the disk.
const MOST_TIMES: usize = 10_001;

fn times(text: &str) -> Result<Times, String> {
    let all = numbers(text)?;
    match all.iter().find(|t| !t.is_finite()) {
        Some(t) => Err(format!("got {t}; expected finite numbers")),
        None => Ok(Times(all)),
    }
}

fn samples(text: &str) -> Result<[usize; 2], String> {
    let parts: Vec<Option<usize>> = text.split(['x', 'X']).map(|s| s.parse().ok()).collect();
    let all = match parts[..] {
        [Some(n)] => [n, n],
        [Some(u), Some(v)] => [u, v],
        _ => return Err("expected two numbers such as 33x65".to_owned()),
    };
    match all.iter().find(|n| **n < 2) {
        Some(n) => Err(format!("got {n}; both ends need at least 2")),
        None => Ok(all),
    }
}

impl Surface {
    /// Samples it at every time.
    pub fn run(self, watch: &Watch) -> Result<(), Failure> {
        if self.tolerance.is_some_and(|mm| !(mm > 0.0 && mm.is_finite())) {
            return Err(Failure::usage("--tolerance: expected millimetres, more than 0"));
        }
        watch.stage("read");
        let file = match (&self.to, self.method) {
            (Some(to), Some(method)) => surface::between(&self.file, to, method)?,
            _ => surface::open(&self.file)?,
        };
        watch.say(&format!("{}: {}", self.file.display(), file.story));
        file.warnings.iter().for_each(|w| watch.say(&format!("warning: {w}")));
        let times = self.times(&file, watch)?;
        if self.moves(times.len()) {
            return self.motion(&file, &times, watch);
        }
        let targets = self.targets(&times)?;
        let wanted = Wanted {
            samples: self.samples,
            tolerance: self.tolerance,
            derivatives: self.derivatives,
            spine: self.spine,
            force: self.force,
            measure: self.json,
        };
        let mut frames = Vec::new();
        for ((t, share), target) in times.iter().zip(&targets) {
            job::check(watch)?;
            self.prepare(&file, *share, watch)?;
            let frame = frame::make(&file, *t, *share, target, &wanted, watch)?;
            frame.tell(target, watch);
            frames.push(frame);
        }
        if self.json { self.report(&file, &frames, watch) } else { Ok(()) }
    }

    /// Times as typed, and their share of the whole motion.
    fn times(&self, file: &SurfaceFile, watch: &Watch) -> Result<Vec<(f64, f64)>, Failure> {
        let mut all: Vec<f64> = self.t.iter().flat_map(|t| t.0.iter().copied()).collect();
        if all.len() > MOST_TIMES {
            return Err(Failure::usage(format!("-t: {} times; at most {MOST_TIMES}", all.len())));
        }
        if all.is_empty() {
            all.push(match (file.kind, file.duration) {
                (_, Some(end)) => end,
                (Kind::PdeMorph | Kind::NurbsMorph, _) => 0.5,
                _ => 0.0,
            });
            if file.object.moves() {
                watch.say(&format!("t = {}; choose another with -t", all[0]));
            }
        }
        let end = file.duration.unwrap_or(1.0);
        let share = |t: f64| {
            // a time that was typed as the end is the end
            let over = t > end && t <= end * (1.0 + 1e-9);
            let share = if over { 1.0 } else { t / end };
            if (0.0..=1.0).contains(&share) {
                return Ok((t, share));
            }
            let name = self.file.display();
            Err(Failure::input(format!("{name}: -t: got {t}; it lasts from 0 to {end}")))
        };
        all.into_iter().map(share).collect()
    }

    /// Where each time goes.
    fn targets(&self, times: &[(f64, f64)]) -> Result<Vec<Target>, Failure> {
        let several = times.len() > 1;
        if several && !self.output.as_ref().is_some_and(|o| o.contains("{t}")) {
            let why = format!("{} times need {{t}} in the output's name", times.len());
            return Err(Failure::usage(why));
        }
        let mut targets: Vec<Target> = Vec::new();
        for (t, _) in times {
            let path = self.output.as_ref().map(|o| o.replace("{t}", &time_word(*t)));
            let target = Target::new(path.as_deref().map(Path::new), self.spine, self.force)?;
            if let Target::Csv(p) | Target::Lines(p) | Target::Mesh(p) = &target
                && targets.iter().any(|t| t.path() == Some(p))
            {
                let why = format!("{}: two times would be written to this one file", p.display());
                return Err(Failure::usage(why));
            }
            targets.push(target);
        }
        Ok(targets)
    }

    /// Takes a dynamic surface to its time in pieces, so that it can be interrupted.
    fn prepare(&self, file: &SurfaceFile, share: f64, watch: &Watch) -> Result<(), Failure> {
        const PIECES: usize = 64;
        if file.duration.is_none() {
            return Ok(());
        }
        watch.stage("step");
        for k in 0..PIECES {
            let part = k as f64 / PIECES as f64;
            if part >= share {
                break;
            }
            job::check(watch)?;
            watch.done(part / share);
            file.object.at(part).map_err(|e| file.locate(e))?;
        }
        Ok(())
    }

    fn report(&self, file: &SurfaceFile, frames: &[Frame], watch: &Watch) -> Result<(), Failure> {
        let report = json!({
            "file": self.file.display().to_string(),
            "kind": file.kind,
            "story": file.story,
            "moves": file.object.moves(),
            "duration": file.duration,
            "warnings": file.warnings,
            "inputs": file.inputs,
            "frames": frames,
        });
        watch.put(&serde_json::to_string_pretty(&report).unwrap_or_default())
    }
}
