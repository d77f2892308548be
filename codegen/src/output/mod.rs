//! Stage 6: source files reach the disk, whole or not at all; the only stage that touches files.

mod write;

pub use write::{Outcome, WriteError, check, write};
