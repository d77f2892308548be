//! Numbers that decide about a load.

use crate::numeric::levels::levels;

levels! {
    /// Blocks of time over all logs, for errors that are correlated within a block.
    BLOCKS: usize = 24;

    /// A joint slower than this share of its largest speed sticks or reverses: its dry friction takes any value up to
    /// the static one, so its effort says nothing about the load.
    STICKING: f64 = 0.01;

    /// A joint whose largest speed is below this share of the fastest joint's stands still.
    STILL: f64 = 1e-3;

    /// Density of the ball that stands for what the motion does not show of a load [kg/m³]: plastics, or
    /// half as much metal as air.
    DENSITY: f64 = 1500.0;

    /// How far from the frame's origin a load's mass is, before anything is known of it [m].
    REACH: f64 = 0.3;

    /// Weight of the ball as a share of [`super::PayloadSettings::weight`]: the spread of a load's mass is known to a factor
    /// of about three.
    BALL: f64 = 0.1;
}
