//! Errors of the construction of a predictive controller.

use super::row::RowFault;
use crate::control_loop::TooFast;
use crate::dynamics::{AttitudeError, Named};
use crate::feed_forward::FeedForwardError;
use crate::lqr::LqrError;
use crate::qp::QpError;
use thiserror::Error;

/// Reason for which a controller cannot be made.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MpcError {
    /// An option is out of its range.
    #[error("{option}{} is {value}; it must be {range}", .index.map(|i| format!("[{i}]")).unwrap_or_default())]
    Option {
        /// Name of the option.
        option: &'static str,
        /// Index of the component; `None` for an option with one value.
        index: Option<usize>,
        /// Value that was given.
        value: f64,
        /// Allowed range.
        range: &'static str,
    },
    /// A row cannot be used.
    #[error("row {row}: {fault}")]
    Row {
        /// Name of the row.
        row: String,
        /// Fault of the row.
        fault: RowFault,
    },
    /// A joint follows several coordinates, and the bounds of these coordinates allow positions or speeds
    /// beyond the limits of the joint. A row for this joint is missing.
    #[error(
        "joint {} follows others and can leave its limits within theirs: give the options rows for it, \
         `.with_rows(MpcRow::of_limits(&robot))`, or rows of your own that have its name",
        Named(.joint)
    )]
    Dependent {
        /// Name of the joint.
        joint: &'static str,
    },
    /// The torque of a motor falls with its speed, and a row for its torque–speed line is missing.
    #[error(
        "motor {} gives less torque the faster it turns, and no row keeps its torque–speed line: give the options all rows of the \
         robot, `.with_rows(MpcRow::of_limits(&robot))`, or rows of your own that have its name",
        Named(.motor)
    )]
    TorqueSpeed {
        /// Name of the motor, which is the name of its input.
        motor: &'static str,
    },
    /// A position of a joint with a quaternion has a limit, which is not allowed.
    #[error(
        "position_limits has a limit of joint {}, whose attitude is a quaternion: leave them infinite there", Named(.joint)
    )]
    Limit {
        /// Name of the joint.
        joint: &'static str,
    },
    /// A quaternion of the trajectory does not represent an attitude.
    #[error("at {time} s of the trajectory {error}")]
    Attitude {
        /// Time on the trajectory (s).
        time: f64,
        /// Joint and fault of the quaternion.
        error: AttitudeError,
    },
    /// The horizon or the sizes are out of the range of the QP solver.
    #[error(transparent)]
    Qp(#[from] QpError),
    /// The feed-forward of the model cannot be computed.
    #[error(transparent)]
    FeedForward(#[from] FeedForwardError),
    /// The Riccati equation of the terminal weight has no solution.
    #[error("no terminal weight at {time} s of the trajectory: {reason}{}", remedy(.reason))]
    Terminal {
        /// Time on the trajectory (s).
        time: f64,
        /// Error of the Riccati solver.
        reason: LqrError,
    },
    /// A joint of the model is too fast for the prediction over a period, at a state of the trajectory or at
    /// rest at its position.
    #[error("at {time} s of the trajectory {what}")]
    TooFast {
        /// Time on the trajectory (s).
        time: f64,
        /// Joint and its rate.
        what: TooFast,
    },
    /// The trajectory or the equations of motion are not finite.
    #[error("at {time} s trajectory or equations of motion are not finite")]
    NotFinite {
        /// Time on the trajectory (s).
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
