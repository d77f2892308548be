//! Levels (numbers that decide) of a planned motion.

use super::super::numeric::levels::levels;

levels! {
    /// Speed within which Coulomb friction changes its sign, as a share of the joint's largest speed.
    SIGN_SHARE: f64 = 0.02;

    /// Share by which a start that is not possible is reduced in each trial.
    SMALLER: f64 = 0.3;

    /// Smallest size that is tried.
    SMALLEST: f64 = 0.1;

    /// Share by which a motion grows in each trial, as long as that lowers its score.
    LARGER: f64 = 0.1;

    /// Share of the longest lever of a cylinder below which a lever is short, which is near a dead centre.
    SHORT: f64 = 0.25;
}
