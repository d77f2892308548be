//! Settings and errors.

use gelenk_dynamics::dynamics::Named;
use thiserror::Error;

/// Largest delay of an input, in periods.
pub const MOST_DELAY: usize = 8;

/// Settings of the recursive estimation.
///
/// [`AdaptationSettings::new`] gives the defaults. They were chosen with simulated joints
/// (`runtime/examples/support/warming.rs`); a test varies only the drift times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdaptationSettings {
    /// Measurement period (s).
    pub period: f64,
    /// Time constant of each of the filter's two poles (s).
    pub time_constant: f64,
    /// Periods until an input acts, at most [`MOST_DELAY`].
    pub delay: usize,
    /// Largest change of friction as a share of the described friction at the largest speed. Parameters are
    /// clipped to this box; the prior's standard deviation is half of it.
    pub largest_change: f64,
    /// Times in which a random walk of the terms reaches the prior's standard deviation (s), from slow to
    /// fast.
    pub drift_times: [f64; 3],
    /// Memory of noise, correlation, weights of the drift rates, and prediction errors (s of motion).
    pub memory: f64,
    /// Time of motion (s) after which residuals outside the prediction interval of the learned law count as a
    /// change of the joint, not as contact.
    pub patience: f64,
    /// Time constant with which the acting law follows the learned law (s).
    pub blending: f64,
    /// Share of the largest speed below which a joint is at rest.
    pub rest: f64,
}

impl AdaptationSettings {
    /// Settings for a period (s): poles of 0.04 s or three periods, no delay, changes up to 90 %, drift
    /// within 40000, 4000 or 400 s, memory of 20 s, patience of 20 s, blending of 0.5 s, rest below 1 % of
    /// the largest speed.
    #[must_use]
    pub fn new(period: f64) -> Self {
        Self {
            period,
            time_constant: (3.0 * period).max(0.04),
            delay: 0,
            largest_change: 0.9,
            drift_times: [40000.0, 4000.0, 400.0],
            memory: 20.0,
            patience: 20.0,
            blending: 0.5,
            rest: 0.01,
        }
    }

    pub(super) fn check(&self) -> Result<(), AdaptationError> {
        let positive = |name, value: f64| require(name, value, "positive (s)", value > 0.0);
        positive("period", self.period)?;
        require(
            "time_constant",
            self.time_constant,
            "at least the period (s)",
            self.time_constant >= self.period,
        )?;
        self.drift_times.iter().try_for_each(|time| positive("drift_times", *time))?;
        let memory = self.memory;
        require("memory", memory, "at least 100 time constants (s)", memory >= 100.0 * self.time_constant)?;
        positive("patience", self.patience)?;
        require("blending", self.blending, "at least the period (s)", self.blending >= self.period)?;
        let change = self.largest_change;
        require("largest_change", change, "above 0 and below 1", change > 0.0 && change < 1.0)?;
        require("rest", self.rest, "above 0 and below 1", self.rest > 0.0 && self.rest < 1.0)?;
        require("delay", self.delay as f64, "at most 8 periods", self.delay <= MOST_DELAY)
    }
}

fn require(name: &'static str, value: f64, needed: &'static str, holds: bool) -> Result<(), AdaptationError> {
    if holds && value.is_finite() { Ok(()) } else { Err(AdaptationError::Setting { name, value, needed }) }
}

/// Reasons why friction cannot be learned.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum AdaptationError {
    /// A setting is out of range.
    #[error("setting {name} of the adaptation is {value}; it must be {needed}")]
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// Value of the setting.
        value: f64,
        /// The allowed values.
        needed: &'static str,
    },
    /// The bounds of a load's parameter are empty or infinite, or exclude 0.
    #[error("parameter {0} of the load needs finite bounds with 0 between them")]
    Load(usize),
    /// Bounds of a joint that is not learned, or bounds that are negative or NaN.
    #[error(
        "joint {0} cannot have these bounds: the joint must be learned, and the bounds must be at least 0"
    )]
    Bounds(usize),
    /// The description lacks the magnitudes of a joint.
    #[error(
        "the size of the friction of joint {} is unknown: describe a finite speed limit, and friction or a \
         finite effort limit",
        Named(.name)
    )]
    Scale {
        /// Name of the joint.
        name: &'static str,
    },
    /// The learned friction cannot be compensated.
    #[error(
        "learned friction needs one drive per learned joint that loads no other joint; inputs at frames and \
         driven joints are not supported"
    )]
    Inputs,
    /// The saved state has a different length.
    #[error("the saved state has {found} numbers; this robot's has {needed}")]
    Length {
        /// Numbers that were given.
        found: usize,
        /// Numbers that are needed.
        needed: usize,
    },
    /// The saved state has another origin.
    #[error(
        "the saved state belongs to another {0}: start without it, or use the same description, period, filter and delay"
    )]
    Origin(&'static str),
    /// A saved number is not valid.
    #[error("number {0} of the saved state is not valid")]
    Number(usize),
}
