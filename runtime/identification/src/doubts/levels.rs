//! Numbers that decide whether a log or a law is doubted.

use super::super::numeric::levels::levels;

levels! {
    /// Factor beyond a limit of speed or effort that no right log reaches: the least confusion of units is rpm or a gear.
    FAR: f64 = 3.0;

    /// The same for positions, which may be counted from elsewhere.
    FAR_AWAY: f64 = 10.0;

    /// Share of a limit of speed or effort by which descriptions round it.
    ROUNDED: f64 = 0.1;

    /// The same for positions, of their range.
    ROUNDED_POSITIONS: f64 = 0.01;

    /// Loss of held-out R² from which it is said.
    NOTICEABLE: f64 = 0.01;
}
