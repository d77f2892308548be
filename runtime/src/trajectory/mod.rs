//! Desired motions: positions, velocities and accelerations over time.
//!
//! All motions are C²: positions, velocities and accelerations are continuous, and velocities and
//! accelerations are the exact derivatives. Feed-forward and model predictive control rely on this.

mod along;
#[cfg(feature = "std")]
mod cartesian;
mod geodesic;
mod motion;
#[cfg(feature = "online-targets")]
mod online;
mod points;
mod polynomial;
#[cfg(feature = "std")]
mod recording;
mod sampled;
mod sine;
#[cfg(feature = "std")]
mod smoothing;
mod spline;
mod sums;
mod via_points;

pub use along::Along;
#[cfg(feature = "std")]
pub use cartesian::{CartesianError, joint_points, pose_sequence, straight_ways};
pub use geodesic::GeodesicMotion;
pub use motion::{MAX_SAMPLES, MotionLimits, Sample, Trajectory, TrajectoryError};
use motion::{require_finite, require_periods, require_representable};
pub(crate) use motion::{require_positive, whole_periods};
#[cfg(feature = "online-targets")]
pub use online::{OnlineTarget, TargetStatus};
pub use points::PointSequence;
pub use polynomial::RestToRest;
#[cfg(feature = "std")]
pub use recording::{Columns, Inconsistency, Recording};
pub use sampled::Sampled;
pub use sine::{IdentificationMotion, IdentificationSine};
#[cfg(feature = "std")]
pub use smoothing::{Smoothed, SmoothedPoses, Smoothing};
pub use via_points::ViaPoints;
