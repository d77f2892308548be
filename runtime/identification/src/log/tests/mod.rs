//! Logs as other programs write them.

mod printed;
mod refusals;
mod styles;
mod testing;
