//! How work runs, never what it computes: cancelling and progress.

/// Watches over a long computation. All methods may be called from any thread.
pub trait Job: Sync {
    /// Whether the user wants the work to stop; asked often, so it must be cheap.
    fn cancelled(&self) -> bool {
        false
    }
    /// Told the share of the current stage that is done, in [0, 1].
    fn done(&self, _share: f64) {}
    /// Told that a stage begins: one or two words, such as `sample`.
    fn stage(&self, _name: &str) {}
}

/// Runs to the end and tells nobody.
pub struct Quiet;

impl Job for Quiet {}

/// The work was stopped by its [`Job`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

/// `Err(Cancelled)` once the job is cancelled; the one-line check inside long loops.
pub fn check(job: &dyn Job) -> Result<(), Cancelled> {
    if job.cancelled() { Err(Cancelled) } else { Ok(()) }
}
