//! Thresholds and constants of the estimate.

use super::super::numeric::levels::levels;

levels! {
    /// Largest difference between two runs that count as the same motion. It is the sum of squared position
    /// differences, divided by the sum of squared displacements of one run from its start.
    ALIKE_MOTIONS: f64 = 0.01;

    /// Share of the longer run's length that the shorter run must have to be the same motion.
    COVERED: f64 = 0.8;

    /// Travel below which a joint is at rest [rad or m]. For a shaft it is multiplied by the gear ratio.
    STANDSTILL: f64 = 1e-3;

    /// Standard deviation of friction, as a share of the described friction.
    DESCRIBED_FRICTION: f64 = 0.5;

    /// Least standard deviation of friction, as a share of the joint's largest force. Descriptions may have placeholders or
    /// no friction.
    LEAST_FRICTION: f64 = 0.1;

    /// Standard deviation of an offset, as a share of the largest force. The value corresponds to torque sensors of accuracy
    /// class 1.
    OFFSET: f64 = 0.01;

    /// Factor of [`OFFSET`] if the data require larger offsets, for example because of cables, springs, or sensors whose zero
    /// was never set.
    LARGER_OFFSET: f64 = 10.0;

    /// Number of speeds at which a described friction law is compared with viscous and Coulomb friction.
    SPEEDS: usize = 20;

    /// Share of the body's squared radius of gyration that is added to a described inertia, because exporters write point
    /// masses and thin bodies.
    OWN_FLOOR: f64 = 0.01;

    /// Share of the squared mean radius of gyration of all bodies that is added to a described inertia.
    COMMON_FLOOR: f64 = 1e-3;

    /// Standard deviation of a described body in `Prior::round_metric`: 17 % of its mass, and 7 % of its
    /// radius of gyration for each coordinate of its centre. It was chosen with 24 logs of a simulated arm
    /// (masses within a factor of 1.25, centres within about 12 mm). For 0.1, 0.12 and 0.14, the 90 %
    /// intervals of the motor constants that are known within a factor of 2 contain 83 %, 94 % and 96 % of
    /// the true values.
    BODIES: f64 = 0.12;

    /// Largest standard deviation of ln K, with the gain K of a drive. The value corresponds to three decades
    /// of K.
    GAINS: f64 = 7.0;

    /// Smallest weight of the description that is tried.
    LEAST_WEIGHT: f64 = 1e-3;

    /// Factor by which the weight of a described body may be reduced.
    LESS_TRUST: f64 = 0.01;

    /// Multiple of the standard deviation beyond which a sample loses weight (Huber 1964). The fit is 99.8 % efficient for
    /// normal errors. Friction at reversals gives large residuals that are not outliers. Smaller multiples would remove them.
    HUBER: f64 = 2.5;

    /// Largest number of blocks of samples, over all runs, from which the covariance is computed. More blocks take more time
    /// and hardly change the covariance.
    MOST_BLOCKS: usize = 600;

    /// Number K of cosines ([`super::cosines`]) divided by T^⅔, if the data are T correlation times long. The value
    /// corresponds to K = `0.4 n^⅔` for n samples with a first autocorrelation of 0.7 (Lazarus et al. 2018).
    COSINES: f64 = 1.3;

    /// Smallest number of cosines from which a variance is estimated.
    FEWEST_COSINES: usize = 4;

    /// Largest change of a load-dependent friction coefficient s₁ between two passes at which it has settled, in standard
    /// errors.
    SETTLED_LOADS: f64 = 0.1;

    /// Share of the held-out error by which a hypothesis must lower the error to be clearly better. The hypothesis must also
    /// lower the error by two standard errors. It must not raise the error of a joint by this share, because changes elsewhere
    /// partly explain a fault in one place.
    ///
    /// A larger multiple of the standard error for many hypotheses (Dunn 1961) rejects true hypotheses. Folds
    /// with little motion make the standard error large even if every fold improves.
    CLEARLY: f64 = 0.1;

    /// R² below which a joint's effort is hardly explained. The sign of this effort is then doubted.
    POOR: f64 = 0.5;

    /// Smallest power of friction that drives a joint for which there is a finding. It is a share of the
    /// power of a force with the size of the measured force.
    NOTICEABLE_POWER: f64 = 0.05;

    /// Smallest number of samples with which estimated friction that drives a joint shows a wrong sign of the effort. It is ten
    /// periods of the usual filter.
    FEWEST_SAMPLES: usize = 100;

    /// Share of the residual's variance that one quantity may explain without a finding.
    SUSPICIOUS: f64 = 0.1;

    /// Least share of the residual's variance that one quantity must explain for a finding. The unit of the
    /// share is the correlation time divided by the number of samples. Chance alone gives a multiple of about
    /// one.
    BY_CHANCE: f64 = 10.0;

    /// Ratio of estimated to described rigid-body forces (or its inverse) beyond which a unit may be wrong.
    OTHER_UNIT: f64 = 3.0;

    /// Ratio of estimated to described forces of the whole robot (or its inverse) beyond which the result is refused. No
    /// description has an error of this size.
    ANOTHER_UNIT: f64 = 10.0;

    /// Smallest described force of a joint that carries the robot, as a share of the largest described force of all joints.
    CARRIES: f64 = 0.1;

    /// Smallest angle of a tilt that matters [rad]: 2°.
    LEAST_TILT: f64 = 0.035;

    /// Number of samples of each run at which gravity forces are compared.
    COMPARED_WEIGHTS: usize = 50;

    /// Weight of the description at which bodies are practically free and all equations are regular.
    FREE_BODIES: f64 = 1e-3;

    /// Variance of an angle [rad²], computed for independent residuals, from which on the data do not determine the angle.
    UNTOLD: f64 = 0.01;
}
