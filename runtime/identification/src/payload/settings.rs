//! Settings of a payload estimate.

/// Assumptions of a payload estimate.
#[derive(Debug, Clone, PartialEq)]
pub struct PayloadSettings {
    /// Body that carries the load, from 0; the last one unless stated.
    pub body: Option<usize>,
    /// Cost of a body at distance `½ tr((P₀⁻¹ ΔP)²)` of one from its description, in samples with an error of one standard
    /// deviation.
    pub weight: f64,
    /// Share of intervals that hold the truth, e.g. 0.95.
    pub confidence: f64,
}

impl Default for PayloadSettings {
    fn default() -> Self {
        Self { body: None, weight: 1.0, confidence: 0.95 }
    }
}
