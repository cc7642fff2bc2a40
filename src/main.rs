//! The `fieldgraft` command.
fn main() {}
