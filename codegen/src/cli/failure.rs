//! Reasons why a command ends without success, and the exit codes.

use std::any::Any;
use std::panic::{self, AssertUnwindSafe, PanicHookInfo};
use std::process::ExitCode;
use std::sync::Mutex;

use gelenk_identification::IdentificationError;

use super::arguments::Format;
use super::print;
use crate::diagnostic::Diagnostics;
use crate::verify;

/// Exit code if a description or file has an error, or the generated output is out of date.
pub(super) const FAULT: u8 = 1;
/// Exit code for a wrong command line.
pub(super) const USAGE: u8 = 2;
/// Exit code for an internal error.
pub(super) const INTERNAL: u8 = 3;

/// Reason why a command ends without success.
#[derive(Debug)]
pub(super) enum Failure {
    /// Descriptions or logs have errors.
    Descriptions(Vec<Diagnostics>),
    /// The command line is wrong.
    Usage(String),
    /// The program itself has an error.
    Internal(String),
    /// Any other problem, for example a file that cannot be written.
    Problem(String),
}

impl<E: std::error::Error + 'static> From<E> for Failure {
    fn from(error: E) -> Self {
        let any: &dyn Any = &error;
        match any.downcast_ref::<IdentificationError>().map_or(&[][..], IdentificationError::refusals) {
            [] => Self::Problem(error.to_string()),
            found => Self::Descriptions(found.iter().cloned().map(Diagnostics::from).collect()),
        }
    }
}

impl Failure {
    /// Prints the reason of the failure and returns the exit code.
    pub(super) fn say(&self, format: Format) -> u8 {
        match self {
            Self::Descriptions(all) => {
                print::problems(all, format);
                let mut entries = all.iter().flat_map(Diagnostics::entries);
                if entries.any(|entry| entry.code == verify::INTERNAL) { INTERNAL } else { FAULT }
            }
            Self::Problem(message) => {
                print::err(&format!("error: {message}\n"));
                FAULT
            }
            Self::Usage(message) => {
                print::err(&format!("error: {message}\n\nFor more information, try '--help'.\n"));
                USAGE
            }
            Self::Internal(message) => {
                print::err(&format!(
                    "internal error: {message}. Please report it at {}, with the description and the command\n",
                    env!("CARGO_PKG_REPOSITORY")
                ));
                INTERNAL
            }
        }
    }
}

/// Message and place of the first panic. A panic of another thread causes a second panic of the main thread.
static FIRST_PANIC: Mutex<Option<String>> = Mutex::new(None);

/// Runs a command. A panic becomes [`Failure::Internal`]. The process no longer prints panics.
pub(super) fn guarded(command: impl FnOnce() -> Result<ExitCode, Failure>) -> Result<ExitCode, Failure> {
    panic::set_hook(Box::new(keep));
    panic::catch_unwind(AssertUnwindSafe(command)).unwrap_or_else(|_| {
        let first = FIRST_PANIC.lock().ok().and_then(|mut first| first.take());
        Err(Failure::Internal(first.unwrap_or_default()))
    })
}

fn keep(info: &PanicHookInfo<'_>) {
    let message = info.payload_as_str().unwrap_or("panic");
    let place = info.location().map(|place| format!(" at {}:{}", place.file(), place.line()));
    if let Ok(mut first) = FIRST_PANIC.lock() {
        first.get_or_insert(format!("{message}{}", place.unwrap_or_default()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::Diagnostic;
    use std::process::Command;

    #[test]
    fn a_function_that_disagrees_is_a_fault_of_the_program() {
        let problems = |code| vec![Diagnostic::error(code, "wrong").into()];
        assert_eq!(Failure::Descriptions(problems(verify::INTERNAL)).say(Format::Json), INTERNAL);
        assert_eq!(Failure::Descriptions(problems("not-a-joint")).say(Format::Json), FAULT);
    }

    /// Ends the process in which the test below runs it.
    #[test]
    #[ignore = "ends its process"]
    fn panicking() {
        let failure = guarded(|| panic!("the matrix {:?} is empty", [0; 0])).unwrap_err();
        std::process::exit(failure.say(Format::Text).into());
    }

    #[test]
    fn a_panic_becomes_a_message_with_its_place() {
        let mut child = Command::new(std::env::current_exe().unwrap());
        child.args(["--exact", "--ignored", "--nocapture", "cli::failure::tests::panicking"]);
        let output = child.env("RUST_BACKTRACE", "1").output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(3), "{said}");
        let (start, end) = said.split_once(" at codegen/src/cli/failure.rs:").unwrap();
        assert_eq!(start, "internal error: the matrix [] is empty");
        assert!(end.contains(". Please report it at https://"), "{said}");
        assert_eq!(said.lines().count(), 1, "{said}");
    }
}
