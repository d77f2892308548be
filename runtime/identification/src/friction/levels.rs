//! Thresholds and constants of the identification of friction laws.

use super::super::numeric::levels::levels;

levels! {
    /// Rank k of the speed from which on the data determine a law. It is the k-th smallest speed of the samples away from
    /// rests and reversals.
    RESOLVING: usize = 10;

    /// Smallest change of a term within the runs, as a share of the term's size, at which the term may be part of a law. If
    /// the change is smaller, errors of the data determine the coefficient.
    LEAST_CHANGE: f64 = 0.01;

    /// Least R² on held-out data of a law that may be written. Below 0.05 the law removes less than 2.6 % of the torque's
    /// root mean square. It would have no measurable effect as a feed-forward, and its terms would have no meaning.
    LEAST_R_SQUARED: f64 = 0.05;

    /// Smallest ratio of the largest speed in a log to the described speed limit. If the ratio is smaller, there is a finding.
    SMALL_PART: f64 = 0.1;

    /// Ratio of a speed or a friction torque to its described limit above which the data or the law must be wrong.
    ABSURD: f64 = 3.0;

    /// Condition number of the chosen terms above which the coefficients are doubted. The curve may still be accurate.
    DOUBTFUL_CONDITION: f64 = 100.0;

    /// Largest speed up to which a law is bounded, as a multiple of the largest speed in the data.
    FARTHEST: f64 = 10.0;

    /// Largest growth of the torque beyond the speeds in the data, as a multiple of the growth of the speed. This growth
    /// belongs to viscous friction minus a dry friction of a third of its size. A robot that compensates too much dry friction
    /// may have such a law.
    MOST_GROWTH: f64 = 1.5;

    /// Largest ratio of a law's torque at speeds too low to be resolved by the data to its torque at the smallest resolved
    /// speed. False peaks of simulated arms that stick have ratios of 1.8 to 2.4. Laws of a harmonic drive and true Stribeck
    /// laws have ratios of at most 1.2.
    MOST_UNRESOLVED: f64 = 1.5;

    /// Number of standard errors by which static friction has to exceed Coulomb friction.
    DISTINCT: f64 = 2.0;

    /// Significance level of the test for a trend.
    DRIFT_LEVEL: f64 = 0.01;
}
