//! Settings and errors of the recursive estimation.

use gelenk_dynamics::dynamics::Named;
use thiserror::Error;

/// Largest delay of the inputs that the estimator supports, in periods ([`AdaptationSettings::delay`]).
pub const MOST_DELAY: usize = 8;

/// Settings of the recursive estimation.
///
/// [`AdaptationSettings::new`] returns the defaults. They were chosen with simulated joints
/// (`runtime/examples/support/warming.rs`). No test compares other values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdaptationSettings {
    /// Measurement period (s), which is the period of the calls of [`Adaptation::step`](super::Adaptation::step).
    pub period: f64,
    /// Time constant of each of the two filter poles (s), at least the period.
    pub time_constant: f64,
    /// Delay of the inputs: number of periods until a written input acts, at most [`MOST_DELAY`].
    pub delay: usize,
    /// Largest change of friction, as a share of the described friction at the largest speed; above 0 and below 1. The bounds
    /// of the learned coefficients δ follow from it ([`JointScale::bounds`](super::JointScale::bounds)). The standard deviation
    /// of the prior of a coefficient is half of its bound.
    pub largest_change: f64,
    /// Times in which the drift of the coefficients reaches the standard deviation of the prior (s), from slow to fast drift. One
    /// Kalman filter runs for each time. Rates of change are correlated over a 4000th of the time.
    pub drift_times: [f64; 4],
    /// Time constant of leaky averages, in seconds of motion, at least 100 times [`Self::time_constant`].
    /// The averages estimate the noise, the correlation of samples, the weights of the drift times, and the
    /// prediction errors.
    pub memory: f64,
    /// Time of motion (s) after which residuals outside the prediction interval of the learned law count as a change of the
    /// joint. Before this time they count as contact.
    pub patience: f64,
    /// Time constant with which the acting law follows the learned law (s), at least the period.
    pub blending: f64,
    /// Speed below which a joint counts as at rest, relative to the largest speed; above 0 and below 1.
    pub rest: f64,
}

impl AdaptationSettings {
    /// Default settings for a period (s):
    ///
    /// | setting | value |
    /// |---|---|
    /// | `time_constant` | the larger of 0.04 s and three periods |
    /// | `delay` | 0 |
    /// | `largest_change` | 0.9 |
    /// | `drift_times` | 40000, 4000, 400 and 40 s |
    /// | `memory`, `patience` | 20 s |
    /// | `blending` | 0.5 s |
    /// | `rest` | 0.01 |
    #[must_use]
    pub fn new(period: f64) -> Self {
        Self {
            period,
            time_constant: (3.0 * period).max(0.04),
            delay: 0,
            largest_change: 0.9,
            drift_times: [40000.0, 4000.0, 400.0, 40.0],
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

/// Reason why friction or a load cannot be learned, or a saved state cannot be used.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum AdaptationError {
    /// A setting is out of range.
    #[error("setting {name} of the adaptation is {value}, but must be {needed}")]
    Setting {
        /// Name of the setting.
        name: &'static str,
        /// Value of the setting.
        value: f64,
        /// Allowed values of the setting, as text.
        needed: &'static str,
    },
    /// The bounds of a parameter of the load are not finite, or 0 is not between them. The value is the index of the parameter,
    /// from 0.
    #[error("the bounds of load parameter {0} (counted from 0) must be finite, with 0 between them")]
    Load(usize),
    /// [`Adaptation::set_bounds`](super::Adaptation::set_bounds) was called for a joint whose friction is not learned, or with
    /// bounds that are negative or NaN. The value is the index of the joint, from 0.
    #[error(
        "joint {0} (counted from 0) cannot have these bounds: its friction must be learned, and the bounds must be at least 0"
    )]
    Bounds(usize),
    /// The magnitude of the friction of a joint is unknown, because its description has no finite speed limit, or neither
    /// friction nor a finite effort limit.
    #[error(
        "the magnitude of the friction of joint {} is unknown: add a finite speed limit, and friction or a finite \
         effort limit, to its description",
        Named(.name)
    )]
    Scale {
        /// Name of the joint.
        name: &'static str,
    },
    /// The inputs cannot exert a force on each learned joint alone, or the robot has inputs at frames or driven joints.
    #[error(
        "friction can only be learned if the drives can exert a force on each joint alone. Inputs at frames and driven \
         joints are not supported"
    )]
    Inputs,
    /// The saved state does not have the length of the states of this robot.
    #[error("the saved state has {found} numbers, but the state of this robot has {needed}")]
    Length {
        /// Number of values that were given.
        found: usize,
        /// Number of values that are necessary.
        needed: usize,
    },
    /// The saved state was saved with another description, number of joints, period, time constant or delay. The value names
    /// the difference.
    #[error(
        "the saved state belongs to another {0}: start without this state, or use the same description, period, filter and delay"
    )]
    Origin(&'static str),
    /// A saved number of a joint is not valid. The value is the index of the first number of this joint in the saved state.
    #[error(
        "the saved state is not valid. The numbers of one joint begin at index {0} (counted from 0), and one of them is out of range"
    )]
    Number(usize),
}
