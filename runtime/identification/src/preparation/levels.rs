//! Numbers that decide in the preparation.

use super::super::numeric::levels::levels;

levels! {
    /// Half-width of the windows that separate motion from rest [samples].
    REST_WINDOW: usize = 8;

    /// Share of a joint's largest speed below which it sticks or creeps.
    SLOW: f64 = 0.01;

    /// Standard deviations of the speed's noise below which a speed counts as zero.
    SPEED_NOISE: f64 = 4.0;

    /// Largest share of a joint's largest speed below which noise decides: with more noise, rest cannot be separated from motion.
    MOST_NOISE: f64 = 0.1;

    /// Least ratio of a rest's time below the limit of the speed to its time between the limit and twice the limit. The ratio is 1
    /// if the speed changes its sign at a constant acceleration, and 2.4 if the acceleration is zero there.
    FLAT: f64 = 2.0;

    /// Part of the bandwidth's period by which a rest reaches into its neighbourhood: half the main lobe of the filter twice. The speed
    /// passes the filter, so a smoothed speed shows motion before it begins. The terms of friction, computed from this speed, pass it again.
    REACH: f64 = 1.0;

    /// Bands of a spectrum, and candidate bandwidths, for each octave.
    PER_OCTAVE: f64 = 6.0;

    /// Bandwidths whose error is within this share of the acceleration's power of the least error are equal; the
    /// widest of them is taken, which leaves the choice among them to the efforts.
    EQUAL_BANDWIDTHS: f64 = 1e-3;

    /// Log samples in a pause that is interpolated in any case.
    SHORT_PAUSE: f64 = 3.5;

    /// Share of the bandwidth's period in a pause that is interpolated in any case.
    SHORT_PERIOD: f64 = 0.2;

    /// Bandwidth that allows the pauses in spectra, before any is chosen [Hz].
    USUAL_BANDWIDTH: f64 = 5.0;

    /// Output samples for each period of the bandwidth.
    OVERSAMPLING: f64 = 10.0;

    /// Share of all pieces' duration that has to be left after their ends are cut.
    KEPT: f64 = 0.6;

    /// Highest bandwidth as a share of the rate at which the slowest position has new samples.
    HIGHEST_BANDWIDTH: f64 = 0.2;

    /// Least fall of the logarithm of the residual sum of squares by which a delay of an effort's own counts, or a band: errors of the
    /// model imitate them, and then the fall is small although it is significant.
    DROP: f64 = 0.1;

    /// Relative growth of what the motion leaves unexplained of the efforts that a lower bandwidth may cost.
    LOSS: f64 = 0.02;

    /// Growth after which still lower bandwidths are not tried.
    HOPELESS_BANDWIDTH: f64 = 0.5;

    /// Samples in the regressions that compare bandwidths.
    BANDWIDTH_SAMPLES: usize = 1500;

    /// Fits of one set of parameters to all efforts, each with the weights that follow from the one before.
    FITS: usize = 3;

    /// Samples in the regressions that compare bands.
    BAND_SAMPLES: usize = 400;

    /// Rise of the misfit, as a mean over the efforts of ln RSS, after which lower frequencies are not tried.
    HOPELESS_BAND: f64 = 0.1;

    /// Highest candidate frequency of a band, as a share of the bandwidth. Friction that does not depend on speed alone where a joint
    /// reverses, and a delay that is not known exactly, look like a band: simulated arms that stick, and logs with jitter, have the
    /// least misfit at 0.36 to 0.7 of the bandwidth.
    NARROWER: f64 = 0.25;

    /// Widths of friction as shares of a joint's largest speed: Coulomb friction, and friction that grows more slowly.
    ROUNDINGS: [f64; 3] = [0.002, 0.05, 0.4];

    /// Share of a joint's largest speed within which the sign of its velocity is rounded.
    SHARP: f64 = 0.02;

    /// The estimate of all unknowns finds a delay by one linear step, whose relative error is about half of delay times frequency: 3 % for
    /// this delay \[s\] and 1 Hz. It knows the rotors and one set of bodies for all efforts; here each effort has parameters of its own, and
    /// what they lack imitates delays of some milliseconds.
    FAR: f64 = 0.01;

    /// Smallest and largest delay looked for [s]; negative where positions are the late ones.
    DELAYS: [f64; 2] = [-0.08, 0.08];

    /// Where delays are looked for first: beyond it only where most efforts fit best at its early end, because errors of the model
    /// imitate delays that are far away.
    USUAL_DELAYS: [f64; 2] = [-0.02, 0.08];

    /// Step of the coarse grid [s].
    COARSE_DELAYS: f64 = 4e-3;

    /// Samples in the regressions that find delays, at most.
    DELAY_SAMPLES: usize = 2000;

    /// Blocks of consecutive samples, for a standard error that holds under correlated residuals.
    DELAY_BLOCKS: usize = 16;

    /// Folds on which a delay of an effort's own is compared with the common one.
    DELAY_FOLDS: usize = 8;

    /// Least standard deviation of the delays of one robot's efforts [s].
    DELAY_SPREAD: f64 = 1e-3;
}
