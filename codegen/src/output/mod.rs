//! Interface for build scripts, and atomic writing of source files.

mod builder;
mod cargo;
mod crate_root;
mod modules;
mod out_dir;
mod write;

pub use builder::{Builder, build};
pub use crate_root::{documented, is_generated, left_over, root_text};
pub use modules::BuildError;
pub use write::{Outcome, Planned, Replaces, WriteError, check};
