//! Identification from more logs than one machine can hold. The logs are reduced to moments: sums of products that can be
//! added in any order.
//!
//! Each log is reduced to [`LogMoments`] separately ([`reduce()`]), on any machine. The samples are divided into groups
//! (shares). The sums of each joint and share are stored as integers, whose addition has no rounding errors (`exact`). So the
//! total has the same bytes for every order in which the sums are added ([`LogMoments::sum`]). Moments are stored in files
//! (`file`), and [`identify_moments`] identifies the robot from moments.

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
