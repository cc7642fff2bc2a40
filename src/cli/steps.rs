//! The steps that `morph` and `run` share: draft, limits, scene, frames, report.

use super::Making;
use super::convert::plain;
use super::failure::Failure;
use super::watch::Watch;
use fieldgraft::job::Job;
use fieldgraft::mesh::check_output;
use fieldgraft::picture::{Style, is_animation};
use fieldgraft::recipe::{GridEntry, Recipe, Source};
use fieldgraft::run::{
    self, AnimationReport, FrameReport, Growth, Names, Playing, Prediction, Probe, Report,
    Settings, ShapeReport, animation_memory, available_memory, coarsening, predict, reset_peak,
};
use fieldgraft::scene::{Draft, sha256};
use std::path::Path;
use std::time::Instant;

/// Puts the recipe that was chosen in place, and returns its text.
pub type Written<'a> = dyn Fn(&Recipe) -> Result<String, Failure> + 'a;

/// A recipe ready to be made.
pub struct Task<'a> {
    /// The recipe.
    pub recipe: Recipe,
    /// Its text.
    pub source: Source,
    /// The folder its paths are relative to.
    pub beside: &'a Path,
    /// Where results go.
    pub names: Names,
    /// The recipe's file, if it has one.
    pub file: Option<String>,
    /// Writes down the recipe that is carried out; by default its text is the source.
    pub written: Option<&'a Written<'a>>,
}

/// What was made.
pub struct Made {
    /// The report.
    pub report: Report,
    /// The text of the recipe that was carried out.
    pub text: String,
}

/// Makes everything and judges it, or says how large it would be.
pub fn make(work: Task<'_>, making: &Making, watch: &Watch) -> Result<(), Failure> {
    match made(work, making, watch)? {
        Some(made) => finish(&made.report, making, watch),
        None => Ok(()),
    }
}

/// Makes everything; nothing but a prediction with `--dry-run`.
pub fn made(work: Task<'_>, making: &Making, watch: &Watch) -> Result<Option<Made>, Failure> {
    let start = Instant::now();
    let Task { recipe, source, beside, names, file, written } = work;
    let frames = frames(&recipe);
    if !making.dry_run {
        check_outputs(&names, &frames, making.force)?;
    }
    let mesher = recipe.output.mesher;
    let given = source.text().to_owned();
    let playing = Playing::of(&recipe.output);
    let style = Style::default();
    let with_animations = |mut p: Prediction| {
        p.memory_bytes += animation_memory(&p, &names.animations, style.size);
        p
    };
    let moving = names.animations.iter().any(|n| is_animation(Path::new(n)));
    let picture = (names.picture.is_some() || moving).then_some(style.size);
    let coarse = making.dry_run.then(|| (coarser(&recipe), source.clone()));
    let draft = Draft::open(recipe, source, beside, watch).map_err(plain)?;
    let first = with_animations(predict(&draft, picture));
    let limit = limit(making);
    if let Some((recipe, source)) = coarse {
        refuse(&first, limit)?;
        let by = coarsening(&draft);
        let recipe = recipe(draft.step() * by);
        let (growth, lattice) = (Growth::of(&draft, by), draft.lattice());
        drop(draft);
        reset_peak();
        let scene = Draft::open(recipe, source, beside, watch)
            .and_then(|d| d.build(watch))
            .map_err(plain)?;
        scene.notes.iter().for_each(|n| watch.say(n));
        watch.stage("predict");
        let probe = Probe { coarse: &scene, coarser: by, first, growth, picture };
        let p = with_animations(probe.predict(&lattice, watch)?);
        tell_prediction(&p, making, watch)?;
        return refuse(&p, limit).map(|()| None);
    }
    refuse(&first, limit)?;
    let scene = draft.build(watch).map_err(plain)?;
    let text = written.map_or(Ok(given), |write| write(&scene.recipe))?;
    let recipe_hash = sha256(text.as_bytes());
    scene.notes.iter().for_each(|n| watch.say(n));
    let settings = Settings {
        names,
        mesher,
        force: making.force,
        verify: making.verify || making.strict,
        playing,
        style,
        recipe_hash: recipe_hash.clone(),
    };
    let seconds = start.elapsed().as_secs_f64();
    for s in &scene.shapes {
        let [field, samples] = s.seconds;
        watch.detail(&format!("{}: field {field:.2} s, samples {samples:.2} s", s.name));
    }
    let report = Report {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        recipe: file,
        recipe_sha256: recipe_hash,
        arguments: arguments(),
        inputs: scene.inputs.clone(),
        shapes: scene.shapes.iter().map(ShapeReport::of).collect(),
        threads: rayon::current_num_threads(),
        seconds_shapes: seconds,
        seconds_total: seconds,
        notes: scene.notes.clone(),
        searches: scene.searches.clone(),
        ..Report::default()
    };
    let mut told = |f: &FrameReport| tell(f, watch);
    let report = run::run(&scene, &settings, report, watch, &mut told)?;
    Ok(Some(Made { report, text }))
}

/// Whether every result can be written, before anything is made.
fn check_outputs(names: &Names, frames: &[(String, f64)], force: bool) -> Result<(), Failure> {
    names.check(frames, force)?;
    for (hybrid, t) in frames {
        let path = names.mesh(hybrid, *t);
        let there = path.parent().is_none_or(|p| p.as_os_str().is_empty() || p.is_dir());
        match path.file_name() {
            // a folder still to be made holds nothing; only the name can be wrong
            Some(name) if !there => check_output(Path::new(name), true)?,
            _ => check_output(&path, force)?,
        }
    }
    Ok(())
}

/// What the command line said.
pub fn arguments() -> Vec<String> {
    std::env::args_os().skip(1).map(|a| a.to_string_lossy().into_owned()).collect()
}

/// Prints the report and judges it.
pub fn finish(report: &Report, making: &Making, watch: &Watch) -> Result<(), Failure> {
    if making.json {
        watch.put(&report.to_json())?;
    }
    if let Some(mb) = report.peak_memory_mb {
        watch.detail(&format!("{:.2} s, peak memory {mb:.0} MB", report.seconds_total));
    }
    report.animations.iter().for_each(|a| tell_animation(a, watch));
    let failed = report.frames.iter().filter(|f| f.error.is_some()).count();
    if failed > 0 {
        let of = report.frames.len();
        let why = report.frames.iter().find_map(|f| f.error.clone()).unwrap_or_default();
        let why = if of == 1 { why } else { format!("{failed} of {of} frames failed: {why}") };
        return Err(Failure::new(Failure::FAILED, why));
    }
    if let Some(why) = report.animations.iter().find_map(|a| a.error.as_ref()) {
        return Err(Failure::new(Failure::FAILED, why));
    }
    if making.strict && !report.printable() {
        let why = "not printable (--strict): see the reasons above";
        return Err(Failure::new(Failure::UNPRINTABLE, why));
    }
    Ok(())
}

/// One or two lines on a frame.
pub fn tell(f: &FrameReport, watch: &Watch) {
    f.notes.iter().for_each(|n| watch.say(n));
    let what = if f.hybrid.is_empty() {
        format!("t {}", run::time_word(f.t))
    } else {
        format!("{} (t {})", f.hybrid, run::time_word(f.t))
    };
    let (Some(health), None) = (&f.health, &f.error) else {
        watch.say(&format!("{what}: {}", f.error.as_deref().unwrap_or("no mesh")));
        return;
    };
    let mut parts = vec![format!("{} triangles", health.triangles)];
    parts.extend(f.pieces.map(|n| if n == 1 { "1 piece".into() } else { format!("{n} pieces") }));
    parts.extend(health.volume_mm3.map(|v| format!("{:.0} cm3", v / 1000.0)));
    parts.extend(f.volume_kept.map(|v| format!("{:.0}% of the parents'", v * 100.0)));
    if f.crumbs.count > 0 {
        let (n, share) = (f.crumbs.count, f.crumbs.share * 100.0);
        parts.push(format!("{n} loose pieces dropped ({share:.2}%)"));
    }
    if f.border_clipped {
        parts.push("closed at the border of the grid: more padding would show more".into());
    }
    if !health.printable {
        parts.push(format!("NOT printable: {}", health.reasons.join("; ")));
    }
    let file = f.file.as_deref().unwrap_or("not written");
    watch.say(&format!("{what}: {file}: {}", parts.join(", ")));
    let s = &f.seconds;
    watch.detail(&format!(
        "  morph {:.2} s, sample {:.2} s, mesh {:.2} s, check {:.2} s, write {:.2} s, picture {:.2} s; {} of {} bricks",
        s.morph, s.sample, s.mesh, s.check, s.write, s.picture, f.active_bricks, f.bricks
    ));
}

/// A line on an animation.
fn tell_animation(a: &AnimationReport, watch: &Watch) {
    if let Some(why) = a.note.as_ref().or(a.error.as_ref()) {
        watch.say(&format!("no animation: {why}"));
    }
    let (Some(file), Some(bytes)) = (&a.file, a.file_bytes) else { return };
    let mut parts = vec![format!("{} frames", a.frames), human(bytes)];
    parts.push(format!("{:.1} s at {} frames a second", a.turns as f64 / a.fps, a.fps));
    if !a.skipped.is_empty() {
        let times: Vec<String> = a.skipped.iter().map(|&t| run::time_word(t)).collect();
        parts.push(format!("without t {}, which failed", times.join(", ")));
    }
    watch.say(&format!("{file}: {}", parts.join(", ")));
    watch.detail(&format!("  animation {:.2} s", a.seconds));
}

/// Every frame: hybrid and time, as far as the recipe alone tells.
fn frames(recipe: &Recipe) -> Vec<(String, f64)> {
    let times =
        |v: &fieldgraft::recipe::MorphEntry| v.t.as_ref().map_or(vec![0.5], |t| t.0.clone());
    let variants = recipe.variants();
    let each = |(_, v): &(String, fieldgraft::recipe::MorphEntry)| {
        times(v).into_iter().map(|t| (v.name.clone(), t)).collect::<Vec<_>>()
    };
    variants.iter().flat_map(each).collect()
}

/// The memory that may be used, bytes.
pub fn limit(making: &Making) -> Option<u64> {
    making.max_memory.or_else(|| available_memory().map(|free| free / 5 * 4))
}

/// Refuses what is predicted to need more memory than allowed.
pub fn refuse(p: &Prediction, limit: Option<u64>) -> Result<(), Failure> {
    match limit {
        Some(limit) if p.memory_bytes > limit => {
            let why = format!(
                "about {} would be needed at cells of {:.3} mm, more than the {} allowed; use \
                 larger cells (--resolution, --voxel), or raise --max-memory",
                human(p.memory_bytes),
                p.voxel_mm,
                human(limit)
            );
            Err(Failure::new(Failure::LIMIT, why))
        }
        _ => Ok(()),
    }
}

/// The same recipe with cells of another size, mm.
fn coarser(recipe: &Recipe) -> impl FnOnce(f64) -> Recipe + use<> {
    let mut recipe = recipe.clone();
    move |step| {
        recipe.grid = GridEntry { resolution: None, voxel: Some(step), ..recipe.grid };
        recipe
    }
}

/// Prints a prediction.
pub fn tell_prediction(p: &Prediction, making: &Making, watch: &Watch) -> Result<(), Failure> {
    if making.json {
        return watch.put(&serde_json::to_string_pretty(p).unwrap_or_default());
    }
    watch.put(&format!(
        "frames     {}\nvoxel      {:.3} mm\nbricks     about {} of {}\nmemory     about {}\n\
         triangles  about {} a frame\nfile size  about {} a frame (binary STL)",
        p.frames,
        p.voxel_mm,
        p.active_bricks,
        p.bricks,
        human(p.memory_bytes),
        p.triangles,
        human(p.file_bytes)
    ))
}

/// Bytes for a person.
pub fn human(bytes: u64) -> String {
    let b = bytes as f64;
    match b {
        _ if b >= 1e9 => format!("{:.1} GB", b / 1e9),
        _ if b >= 1e6 => format!("{:.0} MB", b / 1e6),
        _ => format!("{:.0} kB", b / 1e3),
    }
}
