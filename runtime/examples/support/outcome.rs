//! How an example ends where something is at fault: with the error in words.

use std::error::Error;
use std::process::ExitCode;

/// Result of the parts of an example.
pub type Outcome<T> = Result<T, Box<dyn Error>>;

/// Prints `error: …` with all causes, and is exit code 1 then.
pub fn end(outcome: Outcome<()>) -> ExitCode {
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {}", with_causes(error.as_ref()));
            ExitCode::FAILURE
        }
    }
}

/// An error and its causes; causes that a message repeats are left out.
fn with_causes(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let words = error.to_string();
        if !text.contains(&words) {
            text.push_str(": ");
            text.push_str(&words);
        }
        cause = error.source();
    }
    text
}
