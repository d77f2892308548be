//! Numbers that decide about moments of logs.

use super::super::numeric::levels::levels;

levels! {
    /// Length of a piece in correlation times of the residuals: pieces are nearly independent then.
    PIECE: f64 = 10.0;

    /// Fewest shares with samples: folds of the held-out error.
    FEWEST_SHARES: usize = 4;

    /// Ratio between bandwidths of logs beyond which it is said.
    OTHER_FILTER: f64 = 1.5;

    /// Difference between delays of logs beyond which it is said [s].
    OTHER_DELAY: f64 = 2e-3;

    /// Share of the logs below which a doubt about single ones is only counted.
    RARE: f64 = 0.1;
}
