//! The frames of a hybrid in files that play them: moving pictures, and a GLB of the meshes.

use super::{Prediction, Settings, files};
use crate::job::{Cancelled, Job, check};
use crate::mesh::{FlipBook, TriMesh};
use crate::picture::{Film, Image, Style, is_animation, render};
use crate::recipe::OutputEntry;
use serde::Serialize;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Most frames of an animation. A GLB has a node and a mesh a frame, all of them held at once.
pub const MOST_FRAMES: usize = 1000;

/// How frames are played.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Playing {
    /// Frames a second, 0.1 to 50.
    pub fps: f64,
    /// Whether they run back from the last to the first.
    pub ping_pong: bool,
}

impl Default for Playing {
    fn default() -> Self {
        Self { fps: OutputEntry::FPS, ping_pong: true }
    }
}

impl Playing {
    /// What a recipe says.
    pub fn of(output: &OutputEntry) -> Self {
        let plain = Self::default();
        let ping_pong = output.ping_pong.unwrap_or(plain.ping_pong);
        Self { fps: output.fps.unwrap_or(plain.fps), ping_pong }
    }

    /// Frames by number as they are shown: in the order of their times, and perhaps back again,
    /// without showing the ends twice.
    pub fn turns(&self, times: &[f64]) -> Vec<usize> {
        let mut turns: Vec<usize> = (0..times.len()).collect();
        turns.sort_by(|&a, &b| times[a].total_cmp(&times[b]));
        if self.ping_pong && turns.len() > 2 {
            let back: Vec<usize> = turns[1..turns.len() - 1].iter().rev().copied().collect();
            turns.extend(back);
        }
        turns
    }
}

/// What became of an animation.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct AnimationReport {
    /// The hybrid's name, empty for a recipe's only one.
    pub hybrid: String,
    /// The file, when it was written.
    pub file: Option<String>,
    /// Its size.
    pub file_bytes: Option<u64>,
    /// Different frames in it.
    pub frames: usize,
    /// Frames shown until it starts again.
    pub turns: usize,
    /// Frames a second.
    pub fps: f64,
    /// Times that have no frame, because none could be made.
    pub skipped: Vec<f64>,
    /// Seconds to put it together: drawing what was not drawn already, packing, writing.
    pub seconds: f64,
    /// Why it was not written.
    pub error: Option<String>,
    /// Why there is nothing to write.
    pub note: Option<String>,
}

/// A kind of animation that is being made, or why it cannot be.
type Making<T> = Option<Result<T, String>>;

/// Collects the frames of one hybrid and writes its animations. Pictures are held packed, meshes
/// as the GLB will hold them.
pub struct Reel {
    hybrid: String,
    pictures: Vec<PathBuf>,
    meshes: Option<PathBuf>,
    film: Making<Film>,
    book: Making<FlipBook>,
    playing: Playing,
    style: Style,
    force: bool,
    times: Vec<f64>,
    skipped: Vec<f64>,
    seconds: [f64; 2],
}

impl Reel {
    /// For the animations of a hybrid that the settings name; there may be none.
    pub fn new(hybrid: &str, settings: &Settings) -> Self {
        let names = settings.names.animations(hybrid);
        let (pictures, meshes): (Vec<_>, Vec<_>) = names.into_iter().partition(|p| is_animation(p));
        let meshes = meshes.into_iter().next();
        let open = |path: &PathBuf| {
            files::folder_of(path).map_err(|e| e.to_string())?;
            let color = settings.style.color;
            FlipBook::new(path, &settings.note(), color, settings.force).map_err(|e| told(&e))
        };
        Self {
            hybrid: hybrid.to_owned(),
            film: (!pictures.is_empty()).then(|| Ok(Film::default())),
            book: meshes.as_ref().map(open),
            pictures,
            meshes,
            playing: settings.playing,
            style: settings.style,
            force: settings.force,
            times: vec![],
            skipped: vec![],
            seconds: [0.0; 2],
        }
    }

    /// Takes a frame: its mesh, unless there is none, and its picture, if it was drawn already.
    ///
    /// # Errors
    /// Cancelled. Other failures stand in the reports.
    pub fn add(
        &mut self,
        t: f64,
        mesh: Option<&TriMesh>,
        image: Option<Image>,
        job: &dyn Job,
    ) -> Result<(), Cancelled> {
        let Some(mesh) = mesh else {
            self.skipped.push(t);
            return Ok(());
        };
        self.times.push(t);
        if self.film.is_some() {
            job.stage("picture");
            let style = self.style;
            let add = |film: &mut Film| {
                let image = image.map_or_else(|| render(mesh, &style), Ok);
                image.and_then(|i| film.push(&i)).map_err(|e| told(&e))
            };
            step(&mut self.film, &mut self.seconds[0], add);
        }
        let name = format!("t {}", files::time_word(t));
        let add = |book: &mut FlipBook| book.push(&name, mesh).map_err(|e| told(&e));
        step(&mut self.book, &mut self.seconds[1], add);
        check(job)
    }

    /// Writes the files.
    ///
    /// # Errors
    /// Cancelled; nothing is written then. Other failures stand in the reports.
    pub fn finish(self, job: &dyn Job) -> Result<Vec<AnimationReport>, Cancelled> {
        if self.film.is_some() || self.book.is_some() {
            check(job)?;
            job.stage("animation");
        }
        let turns = self.playing.turns(&self.times);
        let seconds = 1.0 / self.playing.fps;
        let mut reports = vec![];
        if let Some(film) = &self.film {
            for path in &self.pictures {
                let start = Instant::now();
                let written = self.ready(film.as_ref()).map(|film| {
                    files::folder_of(path).map_err(|e| e.to_string())?;
                    film.save(path, &turns, seconds, self.force).map_err(|e| told(&e))
                });
                let spent = self.seconds[0] + start.elapsed().as_secs_f64();
                reports.push(self.report(path, written, turns.len(), spent));
                check(job)?;
            }
        }
        let mut this = self;
        if let (Some(book), Some(path)) = (this.book.take(), this.meshes.take()) {
            let start = Instant::now();
            let written =
                this.ready(book).map(|book| book.write(&turns, seconds).map_err(|e| told(&e)));
            let spent = this.seconds[1] + start.elapsed().as_secs_f64();
            reports.push(this.report(&path, written, turns.len(), spent));
        }
        Ok(reports)
    }

    /// What can be written, or why not: an error, or a note.
    fn ready<T, E: ToString>(&self, made: Result<T, E>) -> Result<T, Refusal> {
        match self.times.len() + self.skipped.len() {
            0 | 1 => return Err(Refusal::Note("a single frame does not move".to_owned())),
            asked if self.times.len() < 2 => {
                let made = self.times.len();
                return Err(Refusal::Error(format!("{made} of {asked} frames were made")));
            }
            _ => {}
        }
        made.map_err(|e| Refusal::Error(e.to_string()))
    }

    fn report(
        &self,
        path: &Path,
        written: Result<Result<u64, String>, Refusal>,
        turns: usize,
        seconds: f64,
    ) -> AnimationReport {
        let mut report = AnimationReport {
            hybrid: self.hybrid.clone(),
            frames: self.times.len(),
            turns,
            fps: self.playing.fps,
            skipped: self.skipped.clone(),
            seconds,
            ..AnimationReport::default()
        };
        let refused = |why: String| {
            let name = path.display().to_string();
            if why.contains(&name) { why } else { format!("{name}: {why}") }
        };
        match written {
            Ok(Ok(bytes)) => {
                report.file = Some(path.display().to_string());
                report.file_bytes = Some(bytes);
            }
            Ok(Err(why)) | Err(Refusal::Error(why)) => report.error = Some(refused(why)),
            Err(Refusal::Note(why)) => report.note = Some(refused(why)),
        }
        report
    }
}

/// Why nothing is written.
enum Refusal {
    Error(String),
    Note(String),
}

/// Works on what is being made; once it failed, it is left alone.
fn step<T>(
    making: &mut Making<T>,
    seconds: &mut f64,
    work: impl FnOnce(&mut T) -> Result<(), String>,
) {
    let start = Instant::now();
    if let Some(Ok(it)) = making
        && let Err(why) = work(it)
    {
        *making = Some(Err(why));
    }
    *seconds += start.elapsed().as_secs_f64();
}

/// An error and its causes.
fn told(e: &dyn Error) -> String {
    let mut text = e.to_string();
    let mut cause = e.source();
    while let Some(e) = cause {
        text = format!("{text}: {e}");
        cause = e.source();
    }
    text
}

/// Memory that animations take beside a run of that size, bytes: for a GLB all meshes as the file
/// has them, and for moving pictures a packed frame each.
pub fn animation_memory(p: &Prediction, names: &[String], size: [u32; 2]) -> u64 {
    let pictures = names.iter().any(|n| is_animation(Path::new(n)));
    let meshes = names.iter().any(|n| !is_animation(Path::new(n)));
    // half as many points as triangles, 12 bytes each, and 12 a triangle
    let mesh = if meshes { 18 * p.triangles } else { 0 };
    let [width, height] = size.map(u64::from);
    // packed, a picture has about a quarter of its bytes at most
    let picture = if pictures { width * height } else { 0 };
    p.frames * (mesh + picture)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Quiet;
    use crate::recipe::MesherEntry;
    use crate::run::Names;
    use glam::DVec3;
    use std::fs;

    fn settings(folder: &Path, animations: &[&str]) -> Settings {
        Settings {
            names: Names {
                folder: folder.to_owned(),
                mesh: "{t}.stl".to_owned(),
                picture: None,
                animations: animations.iter().map(|n| (*n).to_owned()).collect(),
                report: "run.json".to_owned(),
                unnamed: "morph".to_owned(),
            },
            mesher: MesherEntry::Print,
            force: false,
            verify: false,
            playing: Playing { fps: 4.0, ping_pong: true },
            style: Style { size: [32, 24], ..Style::default() },
            recipe_hash: "1f3a".repeat(16),
        }
    }

    fn corner(edge: f64) -> TriMesh {
        let points = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|p| p * edge).to_vec();
        TriMesh { points, faces: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] }
    }

    #[test]
    fn frames_are_shown_by_time_and_back() {
        let there = Playing { fps: 8.0, ping_pong: false };
        let back = Playing { ping_pong: true, ..there };
        let times = [1.0, 0.0, 0.5];
        assert_eq!(there.turns(&times), [1, 2, 0]);
        assert_eq!(back.turns(&times), [1, 2, 0, 2]);
        assert_eq!(back.turns(&times[..2]), [1, 0], "two frames have no way back of their own");
        assert!(back.turns(&[]).is_empty());
    }

    #[test]
    fn a_frame_that_failed_is_skipped_and_said() {
        let folder = tempfile::tempdir().unwrap();
        let settings = settings(folder.path(), &["in/{name}.webp", "{name}.gif", "{name}.glb"]);
        let mut reel = Reel::new("", &settings);
        for (t, edge) in [(0.0, 1.0), (0.5, f64::NAN), (0.75, 2.0), (1.0, 3.0)] {
            let mesh = (edge > 0.0).then(|| corner(edge));
            reel.add(t, mesh.as_ref(), None, &Quiet).unwrap();
        }
        let reports = reel.finish(&Quiet).unwrap();
        assert_eq!(reports.len(), 3);
        for (report, name) in reports.iter().zip(["in/morph.webp", "morph.gif", "morph.glb"]) {
            let path = folder.path().join(name);
            assert_eq!(report.file.as_deref(), Some(&*path.display().to_string()));
            assert_eq!(report.file_bytes, Some(fs::metadata(path).unwrap().len()));
            assert_eq!((report.frames, report.turns, &report.skipped[..]), (3, 4, &[0.5][..]));
            assert!(report.error.is_none() && report.note.is_none());
        }
    }

    #[test]
    fn what_does_not_move_is_no_error_but_one_frame_of_two_is() {
        let folder = tempfile::tempdir().unwrap();
        let settings = settings(folder.path(), &["a.webp", "a.glb"]);
        let made = |frames: &[bool]| {
            let mut reel = Reel::new("", &settings);
            for (i, &made) in frames.iter().enumerate() {
                let mesh = made.then(|| corner(1.0));
                reel.add(i as f64, mesh.as_ref(), None, &Quiet).unwrap();
            }
            reel.finish(&Quiet).unwrap()
        };
        for report in made(&[true]) {
            assert!(report.note.unwrap().contains("single frame") && report.error.is_none());
        }
        for report in made(&[true, false]) {
            assert!(report.error.unwrap().contains("1 of 2 frames") && report.note.is_none());
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        fs::write(folder.path().join("a.glb"), b"mine").unwrap();
        let reports = made(&[true, true]);
        assert!(reports[0].file.is_some(), "the other file is written all the same");
        let error = reports[1].error.as_deref().unwrap();
        assert!(error.contains("a.glb") && error.contains("--force"), "{error}");
    }
}
