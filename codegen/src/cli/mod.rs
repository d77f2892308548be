//! The program `gelenk`.

mod arguments;
mod bytes;
mod choices;
#[cfg(feature = "symbolica")]
mod closed_form;
mod export;
mod failure;
mod generate;
mod identify;
mod inspect;
mod inspect_forces;
mod interface;
mod mechanism;
mod new;
mod new_feet;
mod new_project;
mod new_propellers;
mod new_robot;
mod place;
mod print;
mod progress;
mod report;

use std::process::ExitCode;

use clap::Parser;

use arguments::{Arguments, Command};
use failure::Failure;

/// Runs the program with the arguments of the process. Exit code 0 on success, 1 where the description (or a
/// file) is at fault or the output is stale, 2 for a wrong command line.
#[must_use]
pub fn run() -> ExitCode {
    let arguments = Arguments::parse();
    let result = match &arguments.command {
        Command::Generate(what) => generate::generate(what, arguments.format),
        Command::Check(what) => generate::check(what, arguments.format),
        Command::Export(what) => export::export(what, arguments.format),
        Command::Inspect(what) => inspect::inspect(what, arguments.format),
        Command::Identify(what) => identify::identify(what, arguments.format),
        Command::New(what) => new::new(what, arguments.format),
        Command::Report(what) => report::write(what, arguments.format),
    };
    match result {
        Ok(code) => code,
        Err(Failure::Descriptions(all)) => {
            print::problems(&all, arguments.format);
            ExitCode::from(1)
        }
        Err(Failure::Usage(message)) => {
            print::err(&format!("error: {message}\n\nFor more information, try '--help'.\n"));
            ExitCode::from(2)
        }
        Err(Failure::Problem(message)) => {
            print::err(&format!("error: {message}\n"));
            ExitCode::from(1)
        }
    }
}
