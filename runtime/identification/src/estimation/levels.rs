//! Numbers that decide in the estimate.

use super::super::numeric::levels::levels;

levels! {
    /// Squared distance of two runs, as a share of one's own way, up to which they are one motion.
    ALIKE_MOTIONS: f64 = 0.01;

    /// Share of the longer run that the shorter one has to cover.
    COVERED: f64 = 0.8;

    /// Samples by which runs are compared.
    COMPARED_SAMPLES: usize = 400;

    /// A joint that moves less than this [rad or m] stands still; a shaft, less than its gear makes of it.
    STANDSTILL: f64 = 1e-3;

    /// Standard deviation of friction as a share of the described one.
    DESCRIBED_FRICTION: f64 = 0.5;

    /// Least standard deviation of friction, as a share of the joint's largest force: descriptions hold placeholders, and many have no
    /// friction.
    LEAST_FRICTION: f64 = 0.1;

    /// Standard deviation of an offset as a share of the largest force: class 1 of torque sensors.
    OFFSET: f64 = 0.01;

    /// Factor of this standard deviation if the data ask for more: cables, springs, and sensors whose zero nobody set.
    LARGER_OFFSET: f64 = 10.0;

    /// Speeds at which a described law is compared with viscous and Coulomb friction.
    SPEEDS: usize = 20;

    /// Share of the body's own radius of gyration, squared, below which a description's inertia is not believed:
    /// exporters write point masses and thin bodies.
    OWN_FLOOR: f64 = 0.01;

    /// Share of the mean radius of gyration of all bodies, squared, below which a description's inertia is not believed.
    COMMON_FLOOR: f64 = 1e-3;

    /// Standard deviation of a described body in `Prior::round_metric`: 17 % of its mass, and 7 % of its radius of gyration for each coordinate of its
    /// centre. In 24 logs of a simulated arm (masses within a factor of 1.25, centres within some 12 mm) 90 % intervals of the
    /// constants that are known within a factor of 2 hold 83, 94 and 96 % with 0.1, 0.12 and 0.14.
    BODIES: f64 = 0.12;

    /// Largest standard deviation of ln K: three decades.
    GAINS: f64 = 7.0;

    /// Smallest weight of the description that is tried.
    LEAST_WEIGHT: f64 = 1e-3;

    /// Factor by which a body may be trusted less.
    LESS_TRUST: f64 = 0.01;

    /// Multiples of the deviation beyond which a sample loses weight (Huber 1964): 99.9 % efficient for normal
    /// errors. Friction at reversals has heavy tails without outliers; smaller multiples would remove it.
    HUBER: f64 = 2.5;

    /// Blocks over all runs, at most: more would cost time and change nothing.
    MOST_BLOCKS: usize = 600;

    /// Number K of cosines over the number of correlation times to the power ⅔: K is `0.4 T^⅔` for T samples with a first autocorrelation
    /// of 0.7 (Lazarus et al. 2018).
    COSINES: f64 = 1.3;

    /// Fewest cosines that give a variance.
    FEWEST_COSINES: usize = 4;

    /// Change of a share s₁ between two passes, in standard errors, below which they have settled.
    SETTLED_LOADS: f64 = 0.1;

    /// A hypothesis counts as better if it lowers the held-out error by this share and by two standard errors, and if no joint's error
    /// grows by this share: a fault in one place is explained in part by changes elsewhere.
    ///
    /// A larger multiple of the standard error for many hypotheses (Dunn 1961) loses true ones: folds with little motion make the error
    /// large even if every fold gains.
    CLEARLY: f64 = 0.1;

    /// R² below which a joint is hardly explained, and its sign is doubted.
    POOR: f64 = 0.5;

    /// Power of driving friction, as a share of the power of a force as large as the measured one.
    NOTICEABLE_POWER: f64 = 0.05;

    /// Least samples for which friction that drives a joint shows a wrong sign: ten periods of the usual filter.
    FEWEST_SAMPLES: usize = 100;

    /// Share of the residual's variance that one quantity may explain before it is a doubt.
    SUSPICIOUS: f64 = 0.1;

    /// Least share of this variance in correlation times over samples: chance alone explains about one.
    BY_CHANCE: f64 = 10.0;

    /// Factor between estimated and described rigid forces beyond which a unit may be wrong.
    OTHER_UNIT: f64 = 3.0;

    /// Factor of the forces of the robot as a whole beyond which results are refused: no description has bodies that are so wrong.
    ANOTHER_UNIT: f64 = 10.0;

    /// Share of the largest described force from which on a joint carries the robot.
    CARRIES: f64 = 0.1;

    /// Largest ratio of a factor to that of a unit: described masses are guesses.
    GUESS: f64 = 2.5;

    /// Slope of smoothed Coulomb friction, `tanh(slope · speed)`, over shares of a joint's largest speed.
    STEEPNESS: f64 = 30.0;

    /// Angle from which a tilt matters [rad]: 2°.
    LEAST_TILT: f64 = 0.035;

    /// Weight of the description that leaves bodies practically free and keeps all equations regular.
    FREE_BODIES: f64 = 1e-3;

    /// Variance of an angle under independent residuals [rad²] from which the data do not determine it.
    UNTOLD: f64 = 0.01;
}
