//! Thresholds (levels) for findings about a log or a friction law.

use super::super::numeric::levels::levels;

levels! {
    /// Ratio of a speed or an effort to its limit that no correct log reaches. Of the usual faults, speeds in rpm and
    /// efforts on the other side of a gear give the smallest ratios.
    FAR: f64 = 3.0;

    /// Ratio of a position to its limit that no correct log reaches. It is large, because a log may count positions from
    /// another zero.
    FAR_AWAY: f64 = 10.0;

    /// Tolerance of a limit of speed or effort, as a share of the limit. Descriptions often round limits.
    ROUNDED: f64 = 0.1;

    /// Tolerance of the limits of a position, as a share of the range between them. Descriptions often round limits.
    ROUNDED_POSITIONS: f64 = 0.01;

    /// Smallest loss of held-out R² that gives a finding.
    NOTICEABLE: f64 = 0.01;
}
