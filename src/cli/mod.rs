//! The command line: arguments -> calls, messages, exit codes. One file a command.
//!
//! stdout carries data, stderr messages. Exit codes: 0 done; 1 the run failed; 2 usage; 3 bad
//! input; 4 made, but not printable, with `--strict`; 5 over a limit; 130 interrupted.

mod check;
mod compare;
mod convert;
mod failure;
mod features;
mod guard;
mod inputs;
mod morph;
mod npy;
mod picture;
mod run;
mod shell;
mod steps;
mod surface;
mod watch;

use clap::{Args, Parser, Subcommand};
use failure::Failure;
use std::process::ExitCode;
use watch::Watch;

/// Grafts shapes inside signed distance fields: meshes in, printable hybrids out.
///
/// Lengths are millimetres, Z is up, t runs from 0 to 1.
#[derive(Parser)]
#[command(name = "fieldgraft", version, max_term_width = 100)]
struct Cli {
    #[command(flatten)]
    common: Common,
    #[command(subcommand)]
    command: Command,
}

/// Where the options of every command stand in its help.
const GENERAL: &str = "General options";

/// What every command takes.
#[derive(Args, Clone, Debug)]
struct Common {
    /// Say nothing but errors
    #[arg(short, long, global = true, help_heading = GENERAL, conflicts_with = "verbose")]
    quiet: bool,
    /// Say more: timings and what was found
    #[arg(short, long, global = true, help_heading = GENERAL)]
    verbose: bool,
    /// Threads to use; all cores by default
    #[arg(long, global = true, help_heading = GENERAL, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,
}

#[derive(Subcommand)]
enum Command {
    /// Morph two meshes or more into hybrids, without a recipe
    Morph(Box<morph::Morph>),
    /// Make what a recipe says, or one shape from its file
    Run(Box<run::Run>),
    /// Compare methods on one recipe: numbers, pictures and one report
    Compare(Box<compare::Compare>),
    /// Tell whether meshes can be printed: closed, manifold, free of self-contact, of one piece
    Check(check::Check),
    /// Turn any mesh, solid or surface into a clean watertight mesh
    Convert(Box<convert::Convert>),
    /// Find the parts of chairs, and suggest feature elements for them
    #[command(subcommand)]
    Features(features::Features),
    /// Draw meshes: one picture, or a sheet of many
    Picture(picture::Picture),
    /// Sample a parametric surface or curve, as points (CSV) or as a mesh
    Surface(Box<surface::Surface>),
    /// Print the JSON Schema of the recipe
    Schema(shell::Schema),
    /// Print the completions of a shell
    Completions(shell::Completions),
    /// Print the manual page
    Man(shell::Man),
}

impl Command {
    /// Does it.
    fn run(self, watch: &Watch) -> Result<(), Failure> {
        match self {
            Self::Morph(c) => c.run(watch),
            Self::Run(c) => c.run(watch),
            Self::Compare(c) => c.run(watch),
            Self::Check(c) => c.run(watch),
            Self::Convert(c) => c.run(watch),
            Self::Features(c) => c.run(watch),
            Self::Picture(c) => c.run(watch),
            Self::Surface(c) => c.run(watch),
            Self::Schema(c) => c.run(),
            Self::Completions(c) => c.run(),
            Self::Man(c) => c.run(),
        }
    }

    /// Whether it does without threads.
    fn is_text(&self) -> bool {
        matches!(self, Self::Schema(_) | Self::Completions(_) | Self::Man(_))
    }
}

/// What commands that make files take.
#[derive(Args, Clone, Debug)]
struct Making {
    /// Overwrite what is there
    #[arg(long)]
    force: bool,
    /// Say how large the work would be, and stop
    #[arg(long)]
    dry_run: bool,
    /// Refuse work that would need more memory, such as 500M or 2G; by default 80% of what is free
    #[arg(long, value_name = "SIZE", value_parser = inputs::size)]
    max_memory: Option<u64>,
    /// Fail (4) when a result cannot be printed; counts self-intersections too
    #[arg(long)]
    strict: bool,
    /// Count self-intersections, and search for what is smaller than a cell
    #[arg(long)]
    verify: bool,
    /// Print the report as JSON
    #[arg(long)]
    json: bool,
}

/// Stack of a thread, bytes: that of a program's first one.
const STACK: usize = 8 << 20;

/// Runs the command and gives its exit code.
pub fn main() -> ExitCode {
    let cli = Cli::parse();
    guard::guarded(move || work(cli))
}

fn work(cli: Cli) -> ExitCode {
    let watch = Watch::new(&cli.common);
    let done = if cli.command.is_text() {
        cli.command.run(&watch)
    } else {
        let threads = cli.common.threads.map_or(0, |n| n as usize);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK);
        match pool.build_global() {
            // one of the threads that work does this too: each has memory of its own to use again
            Ok(()) => rayon::scope(|_| cli.command.run(&watch)),
            Err(why) => {
                let why = format!("not enough memory to start threads: {why}");
                Err(Failure::new(Failure::LIMIT, why))
            }
        }
    };
    watch.close();
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.tell();
            ExitCode::from(failure.code)
        }
    }
}
