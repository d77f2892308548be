//! Parts of a period.

/// Parts of a period, in their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Reading positions and judging them.
    Read,
    /// The controller, and its fallback.
    Control,
    /// Limits of inputs and states.
    Check,
    /// Writing inputs.
    Write,
    /// Handing the record over to the log.
    Log,
}

/// Number of stages.
pub const STAGES: usize = 5;
