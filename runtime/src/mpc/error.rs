//! Errors of the construction of a predictive controller.

use super::row::RowFault;
use crate::control_loop::TooFast;
use crate::dynamics::{AttitudeError, Named};
use crate::feed_forward::FeedForwardError;
use crate::lqr::LqrError;
use crate::qp::QpError;
use thiserror::Error;

/// Reason why a predictive controller cannot be constructed.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MpcError {
    /// An option is out of its range.
    #[error("{option}{} is {value}, but must be {range}", .index.map(|i| format!("[{i}]")).unwrap_or_default())]
    Option {
        /// Name of the option.
        option: &'static str,
        /// Index of the component; `None` for an option with one value.
        index: Option<usize>,
        /// Value of the option that is out of range.
        value: f64,
        /// Allowed range of the option, as text.
        range: &'static str,
    },
    /// A row ([`MpcRow`](super::MpcRow)) is not valid.
    #[error("row {row}: {fault}")]
    Row {
        /// Name of the row.
        row: String,
        /// Reason why the row is not valid.
        fault: RowFault,
    },
    /// The limits of a joint that follows several coordinates are not ensured. The limits of the coordinates allow
    /// positions or speeds beyond the limits of this joint, and a row for this joint is missing.
    #[error(
        "joint {} can exceed its limits, because it follows several joints and no row of the MPC limits it. Add \
         `.with_rows(MpcRow::of_limits(&robot))` to the options, or a row with the name of this joint",
        Named(.joint)
    )]
    Dependent {
        /// Name of the joint.
        joint: &'static str,
    },
    /// A motor has a torque–speed line, which limits its torque at high speed, but a row for this line is missing.
    #[error(
        "motor {} has a torque–speed line, but no row of the MPC enforces it. Add `.with_rows(MpcRow::of_limits(&robot))` to the \
         options, or a row with the name of this motor",
        Named(.motor)
    )]
    TorqueSpeed {
        /// Name of the motor, which is the name of its input.
        motor: &'static str,
    },
    /// `position_limits` has a finite limit for a joint with a quaternion, which is not allowed.
    #[error(
        "`position_limits` limits joint {}, whose position is a quaternion. Set the limits of this joint to infinity",
        Named(.joint)
    )]
    Limit {
        /// Name of the joint.
        joint: &'static str,
    },
    /// A quaternion of the trajectory does not represent an attitude.
    #[error("the trajectory at {time} s is not valid: {error}")]
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
    #[error("the terminal weight at {time} s of the trajectory cannot be computed: {reason}{}", remedy(.reason))]
    Terminal {
        /// Time on the trajectory (s).
        time: f64,
        /// Error of the Riccati solver.
        reason: LqrError,
    },
    /// A joint of the model is too fast for the prediction over one period. This was found at a state of the
    /// trajectory, or at rest at a position of the trajectory.
    #[error("at {time} s of the trajectory, {what}")]
    TooFast {
        /// Time on the trajectory (s).
        time: f64,
        /// Joint and its rate.
        what: TooFast,
    },
    /// The trajectory or the equations of motion are not finite.
    #[error("the trajectory or the equations of motion are not finite at {time} s")]
    NotFinite {
        /// Time on the trajectory (s).
        time: f64,
    },
}

/// Checks that all values of an option are in range. The error names the first value out of range.
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

/// Advice for the case that the Riccati equation of the terminal weight has no solution.
fn remedy(reason: &LqrError) -> &'static str {
    match reason {
        LqrError::NotStabilizable(_) => {
            ". If no input acts on a part of the motion, e.g. the momentum of a satellite, set its weights to 0 and \
             `terminal_weight` to `TerminalWeight::Discounted`"
        }
        _ => "",
    }
}
