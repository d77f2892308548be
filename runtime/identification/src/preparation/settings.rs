//! Choices that a user may make about the preparation.

/// Choices of the preparation; each is found from the data where it is `None`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PreparationSettings {
    /// Half-amplitude frequency of the filter \[Hz\].
    pub bandwidth: Option<f64>,
    /// Sample rate of the prepared runs \[Hz\]; by itself ten times the bandwidth, at most that of the log.
    pub rate: Option<f64>,
    /// Longest pause between samples that is interpolated \[s\]; a longer one splits the run. By itself a
    /// fifth of the bandwidth's period, at least three steps of the log.
    pub largest_gap: Option<f64>,
    /// Positions pass total-variation regularization (TVDiff; Chartrand 2011) at their noise before the filter. A linear filter commutes with derivatives: velocities are those of TVDiff behind the filter of the efforts.
    pub total_variation: bool,
    /// How much later efforts are than positions \[s\]; 0 leaves them as they are.
    pub delay: Option<f64>,
    /// Time cut off at either end of a piece \[s\], where the filter sees one side only; by itself one period of
    /// the bandwidth.
    pub cut: Option<f64>,
    /// The robot compensates gravity: efforts are what moves it beyond its weight. The call from logs to a robot takes the
    /// setting of the estimation in its place.
    pub gravity_compensated: bool,
}
