//! Thresholds (levels) for logs.

use super::super::numeric::levels::levels;

levels! {
    /// Distance of a spike from the usual range, as a multiple of the width of this range. No motion has an effort of this
    /// size.
    SPIKE: f64 = 5.0;

    /// Largest number of consecutive samples of a spike. A longer one is an event: a collision, or a motion in a log at
    /// rest.
    LONGEST_SPIKE: usize = 3;

    /// Largest share of the samples that may be spikes. The usual range excludes twice this share at each end.
    MOST_SPIKES: f64 = 0.005;

    /// Smallest share of samples at an extreme value for which efforts count as cut off.
    CUT_OFF_SHARE: f64 = 0.01;

    /// Smallest ratio of the number of samples at a limit to the number at the next value. The ratio is large
    /// for two reasons. A coarse sensor has many samples at each value, and a wave has more samples at its
    /// crest than next to it.
    MORE_THAN_BESIDE: usize = 8;

    /// Smallest share of pauses among the time steps if rows come in bursts.
    PAUSES: f64 = 0.02;

    /// Shortest pause between bursts, as a multiple of the usual time step.
    BURST: f64 = 10.0;

    /// Time in s above which times count from an epoch or from the start of the computer, not from the start of the log.
    EPOCH: f64 = 1e6;

    /// Largest difference of a quaternion's length from 1. Rounding to three digits causes a smaller difference.
    FARTHEST_LENGTH: f64 = 0.02;

    /// Smallest correlation of a column of velocities with the derivative of the positions.
    RELATED: f64 = 0.8;

    /// Largest relative difference of a correct velocity from the derivative of the positions.
    SAME_VELOCITY: f64 = 0.15;

    /// Number of samples in each window for the comparison of velocities and positions.
    VELOCITY_WINDOW: usize = 10;

    /// Travel in rad below which a joint counts as resting. For linear joints it is a tenth of this number, in m.
    TRAVEL: f64 = 2e-3;

    /// Largest difference of a jump of a position from a full turn, in rad. No joint moves by 5.8 rad between two samples.
    TURN: f64 = 0.5;

    /// Smallest and largest share of a limit that values in the right unit reach.
    SEEN: [f64; 2] = [0.05, 1.1];
}
