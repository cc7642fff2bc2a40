//! Progress on stderr, messages, and being interrupted.

use super::failure::{Failure, plain};
use super::{Common, guard};
use fieldgraft::job::{Cancelled, Job};
use fieldgraft::place;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{ErrorKind, IsTerminal, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Watches over the work of a command.
pub struct Watch {
    stop: Arc<AtomicBool>,
    /// Only on a terminal.
    bar: Option<ProgressBar>,
    quiet: bool,
    /// Whether timings and findings are wanted.
    pub verbose: bool,
}

/// How long the work may take to notice an interruption before the process ends without it.
const PATIENCE: Duration = Duration::from_millis(150);

/// Ticks of a bar; a stage's share is told in them.
const TICKS: u64 = 1000;

impl Watch {
    /// Begins to listen for interruptions.
    pub fn new(common: &Common) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        if guard::is_watched() {
            let orphan = stop.clone();
            std::thread::spawn(move || {
                while !guard::orphaned() {
                    std::thread::sleep(Duration::from_millis(100));
                }
                orphan.store(true, Ordering::Relaxed);
                std::thread::sleep(PATIENCE);
                end(None);
            });
        }
        let bar = (std::io::stderr().is_terminal() && !common.quiet).then(|| {
            let bar = ProgressBar::new(TICKS);
            let style = "{msg:<24} [{bar:32}] {percent:>3}%  {eta} left";
            if let Ok(style) = ProgressStyle::with_template(style) {
                bar.set_style(style.progress_chars("=> "));
            }
            bar.enable_steady_tick(Duration::from_millis(200));
            bar
        });
        let (heard, shown) = (stop.clone(), bar.clone());
        // without a handler the system's own ends the program, which leaves no half file either
        let _ = ctrlc::set_handler(move || {
            heard.store(true, Ordering::Relaxed);
            std::thread::sleep(PATIENCE);
            end(shown.as_ref());
        });
        Self { stop, bar, quiet: common.quiet, verbose: common.verbose }
    }

    /// A message to stderr, above the bar; not when quiet.
    pub fn say(&self, message: &str) {
        if self.quiet {
            return;
        }
        match &self.bar {
            Some(bar) => bar.suspend(|| tell(message)),
            None => tell(message),
        }
    }

    /// A message for `--verbose` only.
    pub fn detail(&self, message: &str) {
        if self.verbose {
            self.say(message);
        }
    }

    /// Data to stdout, with a newline.
    pub fn put(&self, data: &str) -> Result<(), Failure> {
        match &self.bar {
            Some(bar) => bar.suspend(|| put(data)),
            None => put(data),
        }
    }

    /// Takes the bar away.
    pub fn close(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// Ends an interrupted process whose work has not noticed: nothing is left half written.
fn end(bar: Option<&ProgressBar>) {
    place::abandon();
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
    let failure = Failure::from(Cancelled);
    failure.tell();
    std::process::exit(i32::from(failure.code));
}

fn tell(message: &str) {
    // nowhere is left to complain to if stderr is gone
    let _ = writeln!(std::io::stderr(), "{}", plain(message));
}

/// Data to stdout; a reader that went away ends the program without a word.
pub fn put(data: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    let newline = if data.ends_with('\n') { "" } else { "\n" };
    match write!(out, "{data}{newline}").and_then(|()| out.flush()) {
        Ok(()) => Ok(()),
        Err(e) if e.kind() == ErrorKind::BrokenPipe => Err(Failure::new(0, "")),
        Err(e) => Err(Failure::new(Failure::FAILED, format!("stdout: cannot be written: {e}"))),
    }
}

impl Job for Watch {
    fn cancelled(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
    fn done(&self, share: f64) {
        if let Some(bar) = &self.bar {
            bar.set_position((share.clamp(0.0, 1.0) * TICKS as f64) as u64);
        }
    }
    fn stage(&self, name: &str) {
        if let Some(bar) = &self.bar {
            bar.reset();
            bar.set_message(name.to_owned());
        }
    }
}
