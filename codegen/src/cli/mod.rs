//! The command line of the program `gelenk`.

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
mod interface;
mod mechanism;
mod new;
mod place;
mod print;
mod progress;
mod report;
mod schema;

use std::process::ExitCode;

use arguments::{Arguments, Command};

/// Runs the program with the arguments of the process.
///
/// Exit codes:
///
/// - 0: success
/// - 1: error in a description or file, or output that is out of date
/// - 2: wrong command line
/// - 3: internal error
#[must_use]
pub fn run() -> ExitCode {
    let arguments = Arguments::read();
    let format = arguments.format;
    let result = failure::guarded(|| match &arguments.command {
        Command::Generate(what) => generate::generate(what, format),
        Command::Check(what) => generate::check(what, format),
        Command::Export(what) => export::export(what, format),
        Command::Inspect(what) => inspect::inspect(what, format),
        Command::Identify(what) => identify::identify(what, format),
        Command::New(what) => new::new(what, format),
        Command::Report(what) => report::write(what, format),
        Command::Schema => schema::schema(),
    });
    result.unwrap_or_else(|failure| ExitCode::from(failure.say(format)))
}
