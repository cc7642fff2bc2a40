//! The one test binary: what needs the whole crate, or the built command.

/// The seven chairs of `data/chairs`.
mod chairs;
/// The command: messages, exit codes, files.
mod cli;
/// Dirty meshes, and the solids that they mean.
mod dirty;
/// A module imports from lower floors only.
mod floors;
/// Files made to do harm, given to the built command.
#[cfg(target_os = "linux")]
mod hostile;
/// Morphs of our own chairs with their features.
mod morph;
/// Parametric surfaces together with the rest.
mod surfaces;
/// Running the command and looking at what it did.
mod util;
