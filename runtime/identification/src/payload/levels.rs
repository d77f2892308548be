//! Thresholds and constants of the identification of a load.

use crate::numeric::levels::levels;

levels! {
    /// Number of blocks of time over all logs. Errors may be correlated within a block.
    BLOCKS: usize = 24;

    /// Share of a joint's largest speed below which the joint counts as sticking or reversing. Its dry friction then takes
    /// any value up to the static one, so its effort contains no information about the load.
    STICKING: f64 = 0.01;

    /// Density [kg/m³] of the ball from which the parameters follow that the motion does not determine. Plastics have this
    /// density, and so has metal with twice its volume of air.
    DENSITY: f64 = 1500.0;

    /// Assumed distance of a load's mass from the frame's origin before the fit [m].
    REACH: f64 = 0.3;

    /// Weight of the ball as a share of [`super::PayloadSettings::weight`]. The value belongs to a distribution of the load's
    /// mass that is known to a factor of about three.
    BALL: f64 = 0.1;
}
