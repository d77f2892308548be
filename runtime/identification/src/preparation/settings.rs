//! Settings of the preparation.

/// Settings of the preparation. A setting that is `None` is chosen from the data.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PreparationSettings {
    /// Half-amplitude frequency of the filter \[Hz\].
    pub bandwidth: Option<f64>,
    /// Sample rate of the prepared runs \[Hz\]. By default it is ten times the bandwidth, at most the rate of the log.
    pub rate: Option<f64>,
    /// Longest pause between samples that is interpolated \[s\]. A longer pause splits the run. By default it is a fifth of
    /// the period of the bandwidth, or 3.5 steps of the log if this is longer.
    pub largest_gap: Option<f64>,
    /// Whether positions pass total-variation regularization (TVDiff; Chartrand 2011) at the level of their noise before the
    /// filter. A linear filter commutes with derivatives, so the velocities are those of TVDiff after the filter of the
    /// efforts.
    pub total_variation: bool,
    /// Time by which efforts are later than positions \[s\]; 0 leaves the efforts as they are.
    pub delay: Option<f64>,
    /// Time that is cut off at either end of a piece \[s\], because the filter sees only one side there. By default it is
    /// one period of the bandwidth.
    pub cut: Option<f64>,
    /// Whether the robot compensates gravity. The efforts of the log are then without the robot's weight.
    /// [`crate::identify::identify`] takes this setting from [`crate::estimation::EstimationSettings`] instead.
    pub gravity_compensated: bool,
}
