//! Settings of the identification of a load.

/// Settings of the identification of a load.
#[derive(Debug, Clone, PartialEq)]
pub struct PayloadSettings {
    /// Index of the body that carries the load, from 0. `None` takes the last body.
    pub body: Option<usize>,
    /// Weight of the description, as a number of samples. The distance of a body from its description is `½ tr((P₀⁻¹ ΔP)²)`
    /// with the described pseudo-inertia P₀ and the difference ΔP from it. A body at the distance 1 costs as much as this
    /// number of samples with an error of one standard deviation. The weight must be positive.
    pub weight: f64,
    /// Confidence level of the intervals, between 0 and 1.
    pub confidence: f64,
}

impl Default for PayloadSettings {
    fn default() -> Self {
        Self { body: None, weight: 1.0, confidence: 0.95 }
    }
}
