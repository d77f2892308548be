//! Numbers that decide about a planned motion.

use super::super::numeric::levels::levels;

levels! {
    /// Speed within which Coulomb friction changes its sign, as a share of the joint's largest.
    SIGN_SHARE: f64 = 0.02;

    /// Share by which a start that is not possible is made smaller each time.
    SMALLER: f64 = 0.3;

    /// The smallest of these sizes.
    SMALLEST: f64 = 0.1;

    /// Share of the larger motion by which a motion grows, as long as that lowers its score.
    LARGER: f64 = 0.1;

    /// Part of the longest lever of a cylinder below which a lever counts as short, near a dead centre.
    SHORT: f64 = 0.25;
}
