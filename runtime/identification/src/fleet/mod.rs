//! Logs of a fleet: more than one machine holds, reduced to sums of products that add up in any order.
//!
//! The logs become [`LogMoments`] one by one (`reduce`), wherever they are: sums by joint and share that are exact integers
//! (`exact`), so that they add up to the same bytes in any order and by any tree (`logs`, [`LogMoments::sum`]). `file` is
//! their form on disk, and `fit` identifies the robot from them.

mod exact;
mod file;
mod fit;
mod levels;
mod logs;
mod reduce;
#[cfg(test)]
mod tests;

pub use fit::identify_moments;
pub use logs::{LogMoments, ReducedLog};
pub use reduce::reduce;
