//! Levels (numbers that decide) of doubts about a log or a friction law.

use super::super::numeric::levels::levels;

levels! {
    /// Factor beyond a limit of speed or effort that no correct log reaches. The smallest wrong factors come from rpm or
    /// from a gear.
    FAR: f64 = 3.0;

    /// Factor beyond a limit of position that no correct log reaches. Positions may be counted from another zero.
    FAR_AWAY: f64 = 10.0;

    /// Share of a limit of speed or effort by which a description may round the limit.
    ROUNDED: f64 = 0.1;

    /// Share of the range of positions by which a description may round its limits.
    ROUNDED_POSITIONS: f64 = 0.01;

    /// Loss of held-out R² from which on there is a finding.
    NOTICEABLE: f64 = 0.01;
}
