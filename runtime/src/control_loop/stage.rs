//! Stages of a period.

/// Stages of a period, in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Reading of the measurement and plausibility check.
    Read,
    /// Computation of the inputs by the controller or its fallback.
    Control,
    /// Check of the limits of inputs and states.
    Check,
    /// Writing of the inputs to the robot.
    Write,
    /// Adding a record to the log.
    Log,
}

/// Number of stages of a period.
pub const STAGES: usize = 5;
