//! Levels (numbers that decide) of friction laws.

use super::super::numeric::levels::levels;

levels! {
    /// Number k for the speed from which the data determine a law: the k-th smallest speed of samples away from rests and
    /// reversals.
    RESOLVING: usize = 10;

    /// Share of a term's size that must change within the runs. A term with a smaller change is determined by errors of the
    /// data, and its coefficient grows by the missing part.
    LEAST_CHANGE: f64 = 0.01;

    /// Least R² on held-out data of a law that may be written. Below 0.05 the law removes less than 2.6 % of the torque's
    /// root mean square. It would have no measurable effect as a feed-forward, and its terms would have no meaning.
    LEAST_R_SQUARED: f64 = 0.05;

    /// Share of the described speed below which the largest speed of a log gives a finding.
    SMALL_PART: f64 = 0.1;

    /// Ratio of a speed or a friction to its described limit that no joint has.
    ABSURD: f64 = 3.0;

    /// Condition number of the chosen terms above which the coefficients are doubted. The curve may still be accurate.
    DOUBTFUL_CONDITION: f64 = 100.0;

    /// Largest speed up to which a law is bounded, as a multiple of the largest speed in the data.
    FARTHEST: f64 = 10.0;

    /// Largest growth of the torque beyond the speeds in the data, as a multiple of the growth of the speed. Viscous
    /// friction minus a dry friction of a third of it has this growth. A robot that compensates its dry friction may have a
    /// remainder of this kind.
    MOST_GROWTH: f64 = 1.5;

    /// Largest ratio of a law at speeds at which the data do not determine it to the law at the least speed at which they
    /// do. False peaks of simulated arms that stick have ratios of 1.8 to 2.4. Laws of a harmonic drive and true Stribeck
    /// laws have ratios of at most 1.2.
    MOST_UNRESOLVED: f64 = 1.5;

    /// Number of standard errors by which static friction has to exceed Coulomb friction.
    DISTINCT: f64 = 2.0;

    /// Smallest number of samples that determine the fall from static to Coulomb friction.
    FEWEST_SLOW: usize = 10;

    /// Least share of F_s − F_c by which the law exceeds the Coulomb friction F_c at some speed, with the static friction
    /// F_s.
    REACHED: f64 = 0.1;

    /// Smallest number of samples that show a drift.
    FEWEST_OF_DRIFT: usize = 20;

    /// Significance level of a trend.
    DRIFT_LEVEL: f64 = 0.01;
}
