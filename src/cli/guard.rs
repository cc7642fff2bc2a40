//! What must not end the program without a word: our own errors, and memory that runs out.

use super::failure::{Failure, plain};
use fieldgraft::run::address_space;
use std::io::Write;
use std::panic::{self, AssertUnwindSafe, PanicHookInfo};
use std::process::{Command, ExitCode, ExitStatus};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Set for the process that does the work while another watches over it.
const WATCHED: &str = "FIELDGRAFT_WATCHED";

/// Runs the command so that whatever happens is said in a line.
///
/// Where the address space is limited (`ulimit -v`) an allocation may fail anywhere, and the
/// language then ends the process with a signal. There, and only there, the work is done by a
/// second process, and this one says what became of it.
pub fn guarded(work: impl FnOnce() -> ExitCode) -> ExitCode {
    if address_space().is_some()
        && std::env::var_os(WATCHED).is_none()
        && let Some(code) = watched()
    {
        return code;
    }
    if std::env::var_os("RUST_BACKTRACE").is_none_or(|v| v == "0") {
        let said = AtomicBool::new(false);
        panic::set_hook(Box::new(move |info| {
            if !said.swap(true, Ordering::Relaxed) {
                let _ = writeln!(std::io::stderr(), "error: {}", paragraph(info));
            }
        }));
    }
    panic::catch_unwind(AssertUnwindSafe(work)).unwrap_or(ExitCode::from(Failure::FAILED))
}

/// What is said of an error of our own.
fn paragraph(info: &PanicHookInfo<'_>) -> String {
    let payload = info.payload();
    let what = payload.downcast_ref::<&str>().copied();
    let what = what.or(payload.downcast_ref::<String>().map(String::as_str)).unwrap_or("unknown");
    let what = what.lines().next().unwrap_or_default();
    let at = info.location().map(|l| {
        let file = l.file().rsplit_once("src/").map_or(l.file(), |(_, file)| file);
        format!(" ({file}:{})", l.line())
    });
    let at = at.unwrap_or_default();
    let text = format!("internal error, or too little memory: {what}{at}; please report it");
    plain(&text).into_owned()
}

/// Has the work done by a second process; `None` if there cannot be one.
fn watched() -> Option<ExitCode> {
    let program = std::env::current_exe().ok()?;
    let stop = Arc::new(AtomicBool::new(false));
    let heard = stop.clone();
    let _ = ctrlc::set_handler(move || heard.store(true, Ordering::Relaxed));
    let mut worker = Command::new(program);
    worker.args(std::env::args_os().skip(1)).env(WATCHED, std::process::id().to_string());
    // a failed allocation would be followed by a trace of itself
    worker.env("RUST_BACKTRACE", "0");
    // glibc lays 64 MB of address space aside for each thread's heap: here all have one heap
    if std::env::var_os("MALLOC_ARENA_MAX").is_none() {
        worker.env("MALLOC_ARENA_MAX", "1");
    }
    let mut worker = worker.spawn().ok()?;
    loop {
        if let Some(status) = worker.try_wait().ok()? {
            return Some(told(status));
        }
        if stop.swap(false, Ordering::Relaxed) {
            // a terminal tells both; another program may have told only this one
            let _ = Command::new("kill").args(["-INT", &worker.id().to_string()]).status();
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// The exit code of the worker; its death is put in words.
fn told(status: ExitStatus) -> ExitCode {
    if let Some(code) = status.code() {
        return ExitCode::from(u8::try_from(code).unwrap_or(Failure::FAILED));
    }
    let space = address_space().unwrap_or_default();
    let why = format!(
        "out of memory: this process may have only {} of address space (ulimit -v); use larger \
         cells (--resolution, --voxel) or fewer --threads, or raise the limit; nothing was left \
         half written",
        super::steps::human(space)
    );
    Failure::new(Failure::LIMIT, why).tell();
    ExitCode::from(Failure::LIMIT)
}

/// Whether the process that watches over this one is gone, and with it whoever waited.
#[cfg(unix)]
pub fn orphaned() -> bool {
    let watcher = std::env::var(WATCHED).ok().and_then(|id| id.parse().ok());
    watcher.is_some_and(|id: u32| std::os::unix::process::parent_id() != id)
}

/// Whether the process that watches over this one is gone; told only on Unix.
#[cfg(not(unix))]
pub fn orphaned() -> bool {
    false
}

/// Whether another process watches over this one.
pub fn is_watched() -> bool {
    std::env::var_os(WATCHED).is_some()
}
