//! Numbers that decide about friction laws.

use super::super::numeric::levels::levels;

levels! {
    /// Samples away from rests and reversals by which a speed is resolved.
    RESOLVING: usize = 10;

    /// Share of a term's size that must change within the runs. A term that changes less is determined by errors of the data,
    /// not by friction, and its coefficient grows by the missing part.
    LEAST_CHANGE: f64 = 0.01;

    /// Least R² on data that were left out of a law that may be written. Below 0.05 the law takes away less than
    /// 2.6 % of the torque's root mean square: as a feed-forward it changes nothing that could be measured, and
    /// its terms mean nothing.
    LEAST_R_SQUARED: f64 = 0.05;

    /// Share of the described speed below which a log's speed is a finding.
    SMALL_PART: f64 = 0.1;

    /// Ratio of a speed or a friction to its described limit that no joint has.
    ABSURD: f64 = 3.0;

    /// Condition number of the chosen terms above which coefficients are doubted (the curve need not be).
    DOUBTFUL_CONDITION: f64 = 100.0;

    /// Largest speed up to which a law is bounded, in units of the largest one in the data.
    FARTHEST: f64 = 10.0;

    /// How much faster than the speed a torque may grow beyond the speeds in the data: viscous friction less dry friction of a
    /// third of it. A robot that compensates its dry friction may leave such a remainder.
    MOST_GROWTH: f64 = 1.5;

    /// Largest ratio of a law at speeds that are not resolved to the law at the least speed that is. False peaks of simulated arms
    /// that stick have 1.8 to 2.4, laws of a harmonic drive and true Stribeck laws at most 1.2.
    MOST_UNRESOLVED: f64 = 1.5;

    /// Standard errors by which static friction has to exceed Coulomb friction.
    DISTINCT: f64 = 2.0;

    /// Fewest samples that tell of the fall from static to Coulomb friction.
    FEWEST_SLOW: usize = 10;

    /// Least share of F_s − F_c by which the law exceeds F_c at some speed.
    REACHED: f64 = 0.1;

    /// Fewest samples that show a drift.
    FEWEST_OF_DRIFT: usize = 20;

    /// Probability of a chance result below which a trend is named.
    DRIFT_LEVEL: f64 = 0.01;
}
