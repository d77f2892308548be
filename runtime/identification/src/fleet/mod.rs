//! Identification from more logs than one machine can hold. The logs are reduced to moments: sums of products that can be
//! added in any order.
//!
//! Each log is reduced to [`LogMoments`] by itself ([`reduce()`]), on any machine. The sums of each joint and share are
//! exact integers (`exact`), so that they give the same bytes in whatever order they are added ([`LogMoments::sum`]). They
//! are written to a file (`file`), and [`identify_moments`] identifies the robot from them.

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
