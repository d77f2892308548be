//! Thresholds and constants of moments of logs.

use super::super::numeric::levels::levels;

levels! {
    /// Length of a piece in correlation times of the residuals. Pieces of this length are nearly independent.
    PIECE: f64 = 10.0;

    /// Smallest number of shares with samples, which are the folds of the held-out error.
    FEWEST_SHARES: usize = 4;

    /// Ratio between the largest and smallest bandwidth of logs above which there is a finding.
    OTHER_FILTER: f64 = 1.5;

    /// Difference between the largest and smallest delay of logs above which there is a finding [s].
    OTHER_DELAY: f64 = 2e-3;
}
