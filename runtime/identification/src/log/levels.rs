//! Numbers that decide about logs.

use super::super::numeric::levels::levels;

levels! {
    /// Distance of a spike from the usual range, in units of it. No motion makes such an effort.
    SPIKE: f64 = 5.0;

    /// Most samples of a spike in a row. More are an event: a collision, or a motion in a log that rests.
    LONGEST_SPIKE: usize = 3;

    /// Largest share of the samples that may be spikes. The usual range leaves out twice as many at each end.
    MOST_SPIKES: f64 = 0.005;

    /// Share of the samples at an extreme from which on efforts look cut off.
    CUT_OFF_SHARE: f64 = 0.01;

    /// Least ratio of the samples at a limit to those at the next level: a coarse sensor has many samples at each level, and a wave
    /// has more at its crest than next to it.
    MORE_THAN_BESIDE: usize = 8;

    /// Share of the steps of time that are pauses, if rows come in bursts.
    PAUSES: f64 = 0.02;

    /// Such a pause in units of the usual step.
    BURST: f64 = 10.0;

    /// Time beyond which a clock counts from an epoch, or from the start of a machine [s].
    EPOCH: f64 = 1e6;

    /// Largest difference of a quaternion's length from 1: three digits differ by less.
    FARTHEST_LENGTH: f64 = 0.02;

    /// Least correlation of a column of velocities with the slope of the positions.
    RELATED: f64 = 0.8;

    /// Largest relative difference of a right velocity from the slope of the positions.
    SAME_VELOCITY: f64 = 0.15;

    /// Samples of the windows over which they are compared.
    VELOCITY_WINDOW: usize = 10;

    /// Travel below which a joint stands still [rad; a tenth in m].
    TRAVEL: f64 = 2e-3;

    /// Distance from a full turn up to which a jump of a position is one [rad]: no joint moves by 5.8 rad between two samples.
    TURN: f64 = 0.5;

    /// Least and largest share of a limit that values in the right unit use.
    SEEN: [f64; 2] = [0.05, 1.1];
}
