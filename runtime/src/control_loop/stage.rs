//! Stages of a period.

/// Stages of a period, in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Reading of the measurement and plausibility check.
    Read,
    /// Controller and its fallback.
    Control,
    /// Limits of inputs and states.
    Check,
    /// Writing inputs.
    Write,
    /// Adding a record to the log.
    Log,
}

/// Number of stages.
pub const STAGES: usize = 5;
