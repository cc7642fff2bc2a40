//! A motion in one file: a GLB whose mesh moves.

use super::Surface;
use crate::cli::failure::Failure;
use crate::cli::steps::human;
use crate::cli::watch::Watch;
use fieldgraft::job::{self, Job};
use fieldgraft::mesh::{Motion, check_output, write_motion};
use fieldgraft::picture::Style;
use fieldgraft::run::{Playing, time_word};
use fieldgraft::scene::surface::{Still, SurfaceFile};
use fieldgraft::surface::tessellate::loose_net;
use serde_json::json;
use std::path::Path;

/// Points over u and v of a patch, where none are asked for.
const SAMPLES: [usize; 2] = [41, 41];
/// Most numbers in a file: three a point, for its place and its normal, at each time.
const MOST_NUMBERS: usize = 1 << 29;

impl Surface {
    /// Whether several times go into one GLB.
    pub(super) fn moves(&self, times: usize) -> bool {
        let glb =
            |o: &&String| Path::new(o).extension().is_some_and(|e| e.eq_ignore_ascii_case("glb"));
        times > 1 && self.output.as_ref().filter(glb).is_some_and(|o| !o.contains("{t}"))
    }

    /// Samples every time (as typed, and its share of the whole) on one net and writes the file.
    pub(super) fn motion(
        &self,
        file: &SurfaceFile,
        times: &[(f64, f64)],
        watch: &Watch,
    ) -> Result<(), Failure> {
        if self.spine || self.derivatives || self.tolerance.is_some() {
            let why = "--spine, --derivatives and --tolerance are not for a GLB that moves; put \
                       {t} into the output's name, or leave them out";
            return Err(Failure::usage(why));
        }
        let path = Path::new(self.output.as_deref().unwrap_or_default());
        check_output(path, self.force)?;
        let wrong = |e| Failure::from(file.locate(e));
        let size = self.samples.unwrap_or(SAMPLES);
        let (mut faces, mut poses, mut names) = (vec![], vec![], vec![]);
        for (i, (t, share)) in times.iter().enumerate() {
            job::check(watch)?;
            self.prepare(file, *share, watch)?;
            watch.stage("sample");
            watch.done(i as f64 / times.len() as f64);
            let Still::Surface(surface) = file.object.at(*share).map_err(wrong)? else {
                let why = "a curve has no triangles; put {t} into a name that ends in .csv or .obj";
                return Err(Failure::usage(format!("{}: {why}", path.display())));
            };
            let points = surface.patches().saturating_mul(size[0]).saturating_mul(size[1]);
            if points.saturating_mul(6 * times.len()) > MOST_NUMBERS {
                let why = format!("{points} points at {} times are too many", times.len());
                return Err(Failure::new(Failure::LIMIT, format!("--samples: {why}")));
            }
            let net = loose_net(surface.as_ref(), size).map_err(wrong)?;
            if i == 0 {
                faces = net.faces;
            }
            poses.push(net.points);
            names.push(format!("t {}", time_word(*t)));
        }
        let playing = Playing::default();
        let typed: Vec<f64> = times.iter().map(|t| t.0).collect();
        let mut turns = playing.turns(&typed);
        // what moves without steps has to arrive where it starts again
        turns.extend(turns.first().copied().filter(|_| playing.ping_pong));
        let motion = Motion {
            faces: &faces,
            poses: &poses,
            names: &names,
            turns: &turns,
            seconds: 1.0 / playing.fps,
            color: Style::default().color,
        };
        watch.stage("write");
        let bytes = write_motion(path, &motion, "", self.force)?;
        let (points, seconds) = (poses[0].len(), (turns.len() - 1) as f64 / playing.fps);
        watch.say(&format!(
            "{}: {points} points, {} triangles, {} poses, {seconds:.1} s, {}",
            path.display(),
            faces.len(),
            poses.len(),
            human(bytes)
        ));
        if !self.json {
            return Ok(());
        }
        let report = json!({
            "file": self.file.display().to_string(),
            "kind": file.kind,
            "story": file.story,
            "warnings": file.warnings,
            "inputs": file.inputs,
            "motion": {
                "output": path.display().to_string(),
                "file_bytes": bytes,
                "samples": size,
                "points": points,
                "triangles": faces.len(),
                "t": typed,
                "seconds": seconds,
            },
        });
        watch.put(&serde_json::to_string_pretty(&report).unwrap_or_default())
    }
}
