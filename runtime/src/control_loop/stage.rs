//! Parts of a period.

/// Parts of a period in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Reading of positions and plausibility check.
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
