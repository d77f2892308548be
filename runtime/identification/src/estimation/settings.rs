//! Settings of the estimate.

use super::super::error::{Result, require_setting};
use super::super::preparation::Filter;
use super::result::Offsets;

/// Settings of [`super::estimate`]. The defaults suit a log about which nothing is known.
#[derive(Debug, Clone, PartialEq)]
pub struct EstimationSettings {
    /// The recorded efforts exclude gravity, because the robot adds it itself: all of it, or that of the described bodies,
    /// whichever the held-out error asks for ([`Gravity`](super::Gravity)).
    pub gravity_compensated: bool,
    /// Offsets of the efforts; `None` chooses between one for each joint and one for each joint and run by the
    /// held-out error.
    pub offsets: Option<Offsets>,
    /// Factors k of the Coulomb terms tanh(k v), for each joint; `None` chooses them by the held-out error.
    pub steepness: Option<Vec<f64>>,
    /// Whether friction of joints with an input of their own may grow with the load of their gears,
    /// `|τ_l| s₁ tanh(k v)` with 0 < s₁ < 1, where the held-out error asks for it.
    pub load_friction: bool,
    /// Whether reflected inertia (ÿ) and asymmetric viscous friction (|v|) may be added where the held-out error
    /// asks for them.
    pub optional_terms: bool,
    /// Number of folds of contiguous blocks, 4 to 50.
    pub folds: usize,
    /// Number of passes in which outliers lose weight (Huber 1964); 0 trusts every sample alike.
    pub robust_passes: usize,
    /// Whether the inertial parameters must be those of bodies that can exist.
    pub consistent: bool,
    /// The filter that the runs passed. Friction jumps where a joint reverses, and the filter has rounded that in the
    /// efforts: the columns of friction pass it too. `None` leaves them as they are.
    pub filter: Option<Filter>,
    /// Number of the delay of each effort, from 0 on: what is left of the delays that were removed is estimated with all
    /// else. Efforts with the same number share one. `None` if delays are known.
    pub delays: Option<Vec<usize>>,
    /// Level of the intervals, e.g. 0.9.
    pub confidence: f64,
    /// Least R² on held-out data, centred, that a moving joint's fit must have.
    pub least_r_squared: f64,
    /// Numbers of joints whose efforts are not used: they keep their description.
    pub without: Vec<usize>,
    /// Returns the estimate even where a joint's R² is below the least one.
    pub accept_poor: bool,
}

impl Default for EstimationSettings {
    fn default() -> Self {
        Self {
            gravity_compensated: false,
            offsets: None,
            steepness: None,
            load_friction: false,
            optional_terms: true,
            folds: 10,
            robust_passes: 1,
            consistent: true,
            filter: None,
            delays: None,
            confidence: 0.9,
            least_r_squared: 0.3,
            without: Vec::new(),
            accept_poor: false,
        }
    }
}

impl EstimationSettings {
    pub(super) fn check(&self) -> Result<()> {
        let folds = (4..=50).contains(&self.folds);
        require_setting("folds", self.folds as f64, folds, "it must lie between 4 and 50")?;
        let level = self.confidence > 0.0 && self.confidence < 1.0;
        require_setting("confidence", self.confidence, level, "it must lie between 0 and 1")?;
        for k in self.steepness.iter().flatten() {
            require_setting("steepness", *k, *k > 0.0, "it must be positive")?;
        }
        let least = self.least_r_squared < 1.0;
        require_setting("least R²", self.least_r_squared, least, "it must be below 1")?;
        let passes = self.robust_passes <= 20;
        require_setting("robust passes", self.robust_passes as f64, passes, "it must be at most 20")
    }
}
