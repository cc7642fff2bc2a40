/// `morph` with its defaults: parts found, parameters searched.
mod auto;
/// `check` and its JSON.
mod check;
/// `convert`: meshes and solids in, meshes and fields out.
mod convert;
/// What is wrong, and what is said about it.
mod errors;
/// `morph` and `run`: files, reports, limits.
mod make;
/// The recipes and solids that ship with the crate.
mod shipped;
/// Surface files as recipes, and as shapes among others.
mod surfaces;
/// `schema`, `completions`, `man`.
mod texts;
