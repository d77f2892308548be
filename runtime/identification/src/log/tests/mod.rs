//! Logs as other programs write them.

mod bags;
mod levels;
mod printed;
mod refusals;
mod styles;
mod testing;
