//! Thresholds and constants of planned motions.

use super::super::numeric::levels::levels;

levels! {
    /// Speed within which Coulomb friction changes its sign, as a share of the joint's largest speed.
    SIGN_SHARE: f64 = 0.02;

    /// Share by which a start motion that exceeds limits is reduced in each trial.
    SMALLER: f64 = 0.3;

    /// Smallest size of a start motion that is tried, as a share of the size that the limits allow.
    SMALLEST: f64 = 0.1;

    /// Smallest usable lever of a cylinder, as a share of its longest lever. Shorter levers are near a dead centre.
    SHORT: f64 = 0.25;
}
