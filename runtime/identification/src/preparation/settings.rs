//! Settings of the preparation.

/// Settings of the preparation. A setting that is `None` is chosen from the data.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PreparationSettings {
    /// Half-amplitude frequency of the low-pass filter for all signals, in Hz; `None` chooses it from the
    /// data.
    pub bandwidth: Option<f64>,
    /// Sample rate of the prepared runs in Hz. By default it is ten times the bandwidth, but not more than the rate of the
    /// log.
    pub rate: Option<f64>,
    /// Longest pause between samples, in s, that is interpolated. A run is split at longer pauses. By default it is a fifth
    /// of the period of the bandwidth, or 3.5 time steps of the log if this is longer.
    pub largest_gap: Option<f64>,
    /// Whether positions are smoothed by total-variation regularization (TVDiff; Chartrand 2011) at the level of their
    /// noise before they pass the filter. A linear filter commutes with derivatives. Therefore the velocities are the
    /// velocities of TVDiff, passed through the filter that the efforts also pass.
    pub total_variation: bool,
    /// Delay of the efforts relative to the positions in s, positive if the efforts are late. The value 0
    /// keeps the efforts unshifted. `None` estimates the delays.
    pub delay: Option<f64>,
    /// Time in s that is cut off at each end of a piece (a part of a run between gaps), because the filter has samples only on
    /// one side there. By default it is one period of the bandwidth.
    pub cut: Option<f64>,
    /// Whether the robot compensates gravity, so that the efforts of the log do not include the robot's weight.
    /// [`crate::identify::identify`] uses the setting of [`crate::estimation::EstimationSettings`] instead of this one.
    pub gravity_compensated: bool,
}
