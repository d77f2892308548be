//! Logs as other programs write them.

mod bags;
mod printed;
mod refusals;
mod styles;
mod testing;
