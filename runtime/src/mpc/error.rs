//! Why there is no predictive controller.

use super::row::RowFault;
use crate::control_loop::TooFast;
use crate::dynamics::{AttitudeError, Named};
use crate::feed_forward::FeedForwardError;
use crate::lqr::LqrError;
use crate::qp::QpError;
use thiserror::Error;

/// Why there is no controller.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MpcError {
    /// An option is out of its range.
    #[error("{option}{} is {value}; it must be {range}", .index.map(|i| format!("[{i}]")).unwrap_or_default())]
    Option {
        /// Name of the option.
        option: &'static str,
        /// Its component, if it has several.
        index: Option<usize>,
        /// The value that was given.
        value: f64,
        /// The range that is allowed.
        range: &'static str,
    },
    /// A row cannot be used.
    #[error("row {row}: {fault}")]
    Row {
        /// Its name.
        row: String,
        /// Fault of the row.
        fault: RowFault,
    },
    /// A joint follows several coordinates, and their bounds allow what its limits do not. A row keeps these.
    #[error(
        "joint {} follows others and can leave its limits within theirs: give the options rows for it, \
         `.with_rows(MpcRow::of_limits(&robot))`, or rows of your own that have its name",
        Named(.joint)
    )]
    Dependent {
        /// The joint.
        joint: &'static str,
    },
    /// A motor gives less the faster it turns, and no row says so.
    #[error(
        "motor {} gives less torque the faster it turns, and no row keeps its torque–speed line: give the options all rows of the \
         robot, `.with_rows(MpcRow::of_limits(&robot))`, or rows of your own that have its name",
        Named(.motor)
    )]
    TorqueSpeed {
        /// The motor, as its input is called.
        motor: &'static str,
    },
    /// Positions of a joint with a quaternion have no limits.
    #[error(
        "position_limits has a limit of joint {}, whose attitude is a quaternion: leave them infinite there", Named(.joint)
    )]
    Limit {
        /// The joint.
        joint: &'static str,
    },
    /// A quaternion of the trajectory does not represent an attitude.
    #[error("at {time} s of the trajectory {error}")]
    Attitude {
        /// Where on the trajectory (s).
        time: f64,
        /// Its joint, and its fault.
        error: AttitudeError,
    },
    /// Horizon or sizes do not suit the QP.
    #[error(transparent)]
    Qp(#[from] QpError),
    /// There is no feed-forward for the model.
    #[error(transparent)]
    FeedForward(#[from] FeedForwardError),
    /// The Riccati equation of the terminal weight has no solution.
    #[error("no terminal weight at {time} s of the trajectory: {reason}{}", remedy(.reason))]
    Terminal {
        /// Where on the trajectory (s).
        time: f64,
        /// Why.
        reason: LqrError,
    },
    /// A joint of the model is too fast to be predicted over a period, at a state of the trajectory or at
    /// rest there.
    #[error("at {time} s of the trajectory {what}")]
    TooFast {
        /// Where on the trajectory (s).
        time: f64,
        /// Which joint, and how fast.
        what: TooFast,
    },
    /// Trajectory or equations of motion are not finite.
    #[error("at {time} s trajectory or equations of motion are not finite")]
    NotFinite {
        /// Where on the trajectory (s).
        time: f64,
    },
}

/// Fails for the first value of an option that is out of its range.
pub(super) fn require(
    option: &'static str,
    values: &[f64],
    range: &'static str,
    holds: impl Fn(f64) -> bool,
) -> Result<(), MpcError> {
    match values.iter().position(|x| !holds(*x)) {
        None => Ok(()),
        Some(k) => {
            let index = (values.len() > 1).then_some(k);
            Err(MpcError::Option { option, index, value: values[k], range })
        }
    }
}

/// Remedy if the Riccati equation of the terminal weight has no solution.
fn remedy(reason: &LqrError) -> &'static str {
    match reason {
        LqrError::NotStabilizable(_) => {
            "; if no input reaches a part of the robot, as the momentum of a satellite, set its weights to 0 and terminal_weight \
             to TerminalWeight::Discounted"
        }
        _ => "",
    }
}
