//! Levels (numbers that decide) of logs.

use super::super::numeric::levels::levels;

levels! {
    /// Distance of a spike from the usual range, in units of this range. No motion has an effort of this size.
    SPIKE: f64 = 5.0;

    /// Largest number of consecutive samples of a spike. A longer one is an event: a collision, or a motion in a log at
    /// rest.
    LONGEST_SPIKE: usize = 3;

    /// Largest share of the samples that may be spikes. The usual range leaves out twice this share at each end.
    MOST_SPIKES: f64 = 0.005;

    /// Share of the samples at an extreme value from which on efforts seem to be cut off.
    CUT_OFF_SHARE: f64 = 0.01;

    /// Least ratio of the number of samples at a limit to the number at the next value. A coarse sensor has many samples at
    /// each value, and a wave has more samples at its crest than next to it.
    MORE_THAN_BESIDE: usize = 8;

    /// Least share of the steps of time that are pauses, if rows come in bursts.
    PAUSES: f64 = 0.02;

    /// Least length of a pause between bursts, in units of the usual step.
    BURST: f64 = 10.0;

    /// Time beyond which a clock counts from an epoch, or from the start of a machine [s].
    EPOCH: f64 = 1e6;

    /// Largest difference of a quaternion's length from 1. Three digits give a smaller difference.
    FARTHEST_LENGTH: f64 = 0.02;

    /// Least correlation of a column of velocities with the slope of the positions.
    RELATED: f64 = 0.8;

    /// Largest relative difference of a correct velocity from the slope of the positions.
    SAME_VELOCITY: f64 = 0.15;

    /// Number of samples of the windows over which velocities and positions are compared.
    VELOCITY_WINDOW: usize = 10;

    /// Travel below which a joint is at rest [rad]. A tenth of the number is taken in m.
    TRAVEL: f64 = 2e-3;

    /// Largest distance of a jump of a position from a full turn [rad]. No joint moves by 5.8 rad between two samples.
    TURN: f64 = 0.5;

    /// Least and largest share of a limit that values in the right unit use.
    SEEN: [f64; 2] = [0.05, 1.1];
}
