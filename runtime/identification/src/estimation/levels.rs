//! Levels (numbers that decide) of the estimate.

use super::super::numeric::levels::levels;

levels! {
    /// Largest squared distance of two runs, as a share of the squared displacements of one run, at which the runs count as
    /// the same motion.
    ALIKE_MOTIONS: f64 = 0.01;

    /// Share of the longer run's length that the shorter run must have to be the same motion.
    COVERED: f64 = 0.8;

    /// Number of samples by which runs are compared.
    COMPARED_SAMPLES: usize = 400;

    /// Travel below which a joint is at rest [rad or m]. For a shaft it is multiplied by the gear ratio.
    STANDSTILL: f64 = 1e-3;

    /// Standard deviation of friction, as a share of the described friction.
    DESCRIBED_FRICTION: f64 = 0.5;

    /// Least standard deviation of friction, as a share of the joint's largest force. Descriptions may have placeholders or
    /// no friction.
    LEAST_FRICTION: f64 = 0.1;

    /// Standard deviation of an offset, as a share of the largest force: class 1 of torque sensors.
    OFFSET: f64 = 0.01;

    /// Factor of [`OFFSET`] if the data require more: cables, springs, and sensors whose zero was never set.
    LARGER_OFFSET: f64 = 10.0;

    /// Number of speeds at which a described friction law is compared with viscous and Coulomb friction.
    SPEEDS: usize = 20;

    /// Share of the body's own radius of gyration, squared, that is added to a described inertia, because exporters write
    /// point masses and thin bodies.
    OWN_FLOOR: f64 = 0.01;

    /// Share of the mean radius of gyration of all bodies, squared, that is added to a described inertia.
    COMMON_FLOOR: f64 = 1e-3;

    /// Standard deviation of a described body in `Prior::round_metric`: 17 % of its mass, and 7 % of its radius of gyration
    /// for each coordinate of its centre. It was chosen with 24 logs of a simulated arm (masses within a factor of 1.25,
    /// centres within about 12 mm). There the 90 % intervals of the motor constants that are known within a factor of 2
    /// contain 83 %, 94 % and 96 % of the true values for 0.1, 0.12 and 0.14.
    BODIES: f64 = 0.12;

    /// Largest standard deviation of ln K, which is three decades of the gain K.
    GAINS: f64 = 7.0;

    /// Smallest weight of the description that is tried.
    LEAST_WEIGHT: f64 = 1e-3;

    /// Factor by which the weight of a described body may be reduced.
    LESS_TRUST: f64 = 0.01;

    /// Multiple of the standard deviation beyond which a sample loses weight (Huber 1964). The fit is 99.9 % efficient for
    /// normal errors. Friction at reversals has heavy tails without outliers, which smaller multiples would remove.
    HUBER: f64 = 2.5;

    /// Largest number of blocks over all runs. More blocks take more time and change nothing.
    MOST_BLOCKS: usize = 600;

    /// Number K of cosines divided by T^⅔ for T correlation times. It corresponds to K = `0.4 T^⅔` for T samples with a
    /// first autocorrelation of 0.7 (Lazarus et al. 2018).
    COSINES: f64 = 1.3;

    /// Smallest number of cosines from which a variance is estimated.
    FEWEST_COSINES: usize = 4;

    /// Change of a share s₁ of the load between two passes, in standard errors, below which the shares have settled.
    SETTLED_LOADS: f64 = 0.1;

    /// Share of the held-out error by which a hypothesis must lower the error to be clearly better. It must also lower the
    /// error by two standard errors, and it must not raise the error of a joint by this share, because a fault in one place
    /// is partly explained by changes elsewhere.
    ///
    /// A larger multiple of the standard error for many hypotheses (Dunn 1961) rejects true hypotheses, because folds with
    /// little motion make the standard error large even if every fold improves.
    CLEARLY: f64 = 0.1;

    /// R² below which a joint is hardly explained, so that its sign is doubted.
    POOR: f64 = 0.5;

    /// Power of friction that drives a joint, as a share of the power of a force with the size of the measured one, from
    /// which on there is a finding.
    NOTICEABLE_POWER: f64 = 0.05;

    /// Smallest number of samples for which friction that drives a joint shows a wrong sign: ten periods of the usual
    /// filter.
    FEWEST_SAMPLES: usize = 100;

    /// Share of the residual's variance that one quantity may explain without a finding.
    SUSPICIOUS: f64 = 0.1;

    /// Least share of the residual's variance that one quantity must explain for a finding, as a multiple of the correlation
    /// time divided by the number of samples. Chance alone gives a multiple of about one.
    BY_CHANCE: f64 = 10.0;

    /// Ratio of estimated and described rigid forces beyond which a unit may be wrong.
    OTHER_UNIT: f64 = 3.0;

    /// Ratio of the forces of the whole robot beyond which the result is refused. No description has an error of this size.
    ANOTHER_UNIT: f64 = 10.0;

    /// Share of the largest described force from which on a joint carries the robot.
    CARRIES: f64 = 0.1;

    /// Largest ratio of an estimated factor to the factor of a unit for the unit to be named. Described masses are
    /// inaccurate.
    GUESS: f64 = 2.5;

    /// Slope of smoothed Coulomb friction, `tanh(slope · speed)`, with the speed as a share of the joint's largest speed.
    STEEPNESS: f64 = 30.0;

    /// Smallest angle of a tilt that matters [rad]: 2°.
    LEAST_TILT: f64 = 0.035;

    /// Number of samples by which weights are compared.
    COMPARED_WEIGHTS: usize = 50;

    /// Weight of the description at which bodies are practically free and all equations are regular.
    FREE_BODIES: f64 = 1e-3;

    /// Variance of an angle under independent residuals [rad²] from which on the data do not determine the angle.
    UNTOLD: f64 = 0.01;
}
