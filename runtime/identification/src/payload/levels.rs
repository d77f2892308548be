//! Numbers that decide about a load.

use crate::numeric::levels::levels;

levels! {
    /// Density of the ball that has the moments which the motion does not show [kg/m³]: plastics, or half as much metal as air.
    DENSITY: f64 = 1500.0;

    /// Distance of a load's mass from the frame's origin, before anything is known of it [m].
    REACH: f64 = 0.3;

    /// Inverse of the squared distance of loads from the ball, in units of the distance from descriptions: the mass of a load is known to
    /// a factor of about three.
    BALL: f64 = 0.1;

    /// Least share of a joint's residual in the runs with the load by which the load has to enlarge it for a finding.
    WORSE_RESIDUAL: f64 = 0.05;
}
