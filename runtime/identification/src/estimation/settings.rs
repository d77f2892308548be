//! Settings of the estimate.

use super::super::error::{Result, require_setting};
use super::super::preparation::Filter;
use super::result::Offsets;

/// Settings of [`estimate`](super::estimate()). The defaults suit a log about which nothing is known.
#[derive(Debug, Clone, PartialEq)]
pub struct EstimationSettings {
    /// Whether the recorded efforts exclude gravity because the robot compensates it. The held-out error decides whether the
    /// robot compensates its whole weight or only that of the described bodies ([`Gravity`](super::Gravity)).
    pub gravity_compensated: bool,
    /// Kind of the offsets of the efforts. `None` chooses between one offset for each joint and one for each joint and run,
    /// by the held-out error.
    pub offsets: Option<Offsets>,
    /// Factors k of the Coulomb terms tanh(k v) with the velocity v, one for each joint [s/rad or s/m]. `None` chooses the
    /// factors by the held-out error.
    pub steepness: Option<Vec<f64>>,
    /// Whether load-dependent friction may be added, `|τ_l| s₁ tanh(k v)`. Here τ_l is the load of the gear, s₁ is a
    /// coefficient between 0 and 1, v is the velocity, and k is the factor of [`Self::steepness`]. The term is added to a joint
    /// if it lowers the held-out error. The joint must have an input that drives no other joint.
    pub load_friction: bool,
    /// Whether two terms may be added to the force of a joint: reflected inertia (times the acceleration ÿ) and asymmetric
    /// viscous friction (times |v|, with the velocity v). Each term is added if it lowers the held-out error.
    pub optional_terms: bool,
    /// Number of folds, 4 to 50. Each fold consists of contiguous parts of the runs. For the held-out error, each fold is
    /// predicted by a fit to the other folds.
    pub folds: usize,
    /// Number of repetitions of the fit, at most 20. Each repetition reduces the weights of outliers (Huber 1964). If it is
    /// 0, all samples have the same weight.
    pub robust_passes: usize,
    /// Whether the inertial parameters must be those of physically possible bodies.
    pub consistent: bool,
    /// The filter that the runs passed. In the efforts this filter has rounded the jumps of friction at velocity reversals.
    /// Therefore the regressor columns of friction also pass the filter. `None` if the runs passed no filter.
    pub filter: Option<Filter>,
    /// For each effort, the index of its delay, from 0 on. Efforts with the same index share a delay. The delay that remains
    /// after the preparation is estimated together with all other unknowns. `None` if the delays are known.
    pub delays: Option<Vec<usize>>,
    /// Confidence level of the intervals, between 0 and 1.
    pub confidence: f64,
    /// Smallest acceptable R² of a moving joint on held-out data, below 1.
    pub least_r_squared: f64,
    /// Indices of joints whose efforts are not used. These joints keep their description.
    pub without: Vec<usize>,
    /// Whether the estimate is returned even if the R² of a joint is below [`Self::least_r_squared`].
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
