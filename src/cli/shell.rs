//! `schema`, `completions`, `man`: texts about the program itself.

use super::failure::Failure;
use super::{Cli, watch};
use clap::{Args, CommandFactory};
use clap_complete::Shell;
use fieldgraft::recipe;

/// Which schema to print.
#[derive(Args)]
pub struct Schema {
    /// That of surface files instead
    #[arg(long)]
    surface: bool,
}

impl Schema {
    /// Prints it.
    pub fn run(self) -> Result<(), Failure> {
        let schema = if self.surface { recipe::surface_schema() } else { recipe::schema() };
        watch::put(&serde_json::to_string_pretty(&schema).unwrap_or_default())
    }
}

/// Which completions to print.
#[derive(Args)]
pub struct Completions {
    /// The shell
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

impl Completions {
    /// Prints them.
    pub fn run(self) -> Result<(), Failure> {
        let mut text = Vec::new();
        clap_complete::generate(self.shell, &mut Cli::command(), "fieldgraft", &mut text);
        watch::put(&String::from_utf8_lossy(&text))
    }
}

/// Which manual page to print.
#[derive(Args)]
pub struct Man {
    /// The page of this command; by default that of the whole program
    #[arg(value_name = "COMMAND")]
    command: Option<String>,
}

impl Man {
    /// Prints it.
    pub fn run(self) -> Result<(), Failure> {
        let mut program = Cli::command();
        program.build();
        let page = match &self.command {
            None => program,
            Some(name) => {
                let known: Vec<&str> = program.get_subcommands().map(|c| c.get_name()).collect();
                let hint = recipe::did_you_mean(name, known);
                let found = program.find_subcommand(name).cloned();
                found
                    .ok_or_else(|| Failure::usage(format!("no command is called `{name}`{hint}")))?
            }
        };
        let mut text = Vec::new();
        clap_mangen::Man::new(page)
            .render(&mut text)
            .map_err(|e| Failure::new(Failure::FAILED, e.to_string()))?;
        watch::put(&String::from_utf8_lossy(&text))
    }
}
