//! Result type of the examples, and output of errors.

use std::error::Error;
use std::process::ExitCode;

/// Result of the parts of an example.
pub type Outcome<T> = Result<T, Box<dyn Error>>;

/// Returns the exit code of an example. After an error, prints `error: …` with all causes and returns exit code 1.
pub fn end(outcome: Outcome<()>) -> ExitCode {
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {}", with_causes(error.as_ref()));
            ExitCode::FAILURE
        }
    }
}

/// Text of an error and its causes. Causes whose text is already in the message are omitted.
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
