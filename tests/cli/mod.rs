/// Files that play the frames of a morph.
mod animation;
/// `morph` with its defaults: parts found, parameters searched.
mod auto;
/// `check` and its JSON.
mod check;
/// `compare`: methods, measures, the report.
mod compare;
/// `convert`: meshes and solids in, meshes and fields out.
mod convert;
/// What is wrong, and what is said about it.
mod errors;
/// Killed runs, full disks, too little memory.
mod faults;
/// `features suggest`: parts found, recipes written.
mod features;
/// `morph` and `run`: files, reports, limits.
mod make;
/// The recipes and solids that ship with the crate.
mod shipped;
/// `surface`: files of every kind, their samples and meshes, and what is wrong with them.
mod surface;
/// Surface files as recipes, and as shapes among others.
mod surfaces;
/// `schema`, `completions`, `man`.
mod texts;
