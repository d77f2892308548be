//! Sums of products ("moments"): of samples in memory, and of whole logs, in files that add up in any order.
//!
//! Sparse regression needs no more than [`Moments`] of its samples (`products`). A fleet's logs become
//! [`LogMoments`] one by one (`reduce`), wherever they are: sums by joint and share that are exact integers
//! (`exact`), so that they add up to the same bytes in any order and by any tree (`logs`, [`Sum`]). `file` is
//! their form on disk, and `fit` identifies the robot from them.

mod exact;
mod file;
mod fit;
mod logs;
mod products;
mod reduce;
#[cfg(test)]
mod tests;

pub use fit::identify_moments;
pub use logs::{LogMoments, ReducedLog, Sum};
pub(crate) use products::contiguous_blocks;
pub use products::{Moments, Samples};
pub use reduce::reduce;
