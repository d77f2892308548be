//! Stage 6: source files reach the disk, whole or not at all.

mod builder;
mod crate_root;
mod out_dir;
mod write;

pub use builder::{BuildError, Builder, build};
pub use crate_root::{documented, is_generated, left_over, root_text};
pub use write::{Outcome, Planned, Replaces, WriteError, check};
