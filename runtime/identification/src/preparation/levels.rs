//! Levels (numbers that decide) of the preparation.

use super::super::numeric::levels::levels;

levels! {
    /// Half-width of the windows that separate motion from rest [samples].
    REST_WINDOW: usize = 8;

    /// Share of a joint's largest speed below which the joint sticks or creeps.
    SLOW: f64 = 0.01;

    /// Multiple of the standard deviation of the speed's noise below which a speed counts as zero.
    SPEED_NOISE: f64 = 4.0;

    /// Largest share of a joint's largest speed below which noise decides. With more noise, rest cannot be separated from
    /// motion.
    MOST_NOISE: f64 = 0.1;

    /// Least ratio of two times of a rest: the time below the limit of the speed, and the time between the limit and twice
    /// the limit. The ratio is 1 if the speed changes its sign at a constant acceleration, and 2.4 if the acceleration is
    /// zero there.
    FLAT: f64 = 2.0;

    /// Part of the bandwidth's period by which a rest is extended at both ends: twice half the main lobe of the filter. The
    /// speed passes the filter, so a smoothed speed shows motion before the motion begins. The terms of friction are
    /// computed from this speed and pass the filter again.
    REACH: f64 = 1.0;

    /// Bands of a spectrum for each octave.
    BANDS_PER_OCTAVE: f64 = 6.0;

    /// Candidate bandwidths for each octave.
    BANDWIDTHS_PER_OCTAVE: f64 = 6.0;

    /// Share of the acceleration's power by which the error of a bandwidth may exceed the least error for the bandwidth to
    /// be equally good. The widest of the equally good bandwidths is taken, which leaves the choice among them to the
    /// efforts.
    EQUAL_BANDWIDTHS: f64 = 1e-3;

    /// Length of a pause that is always interpolated, in steps of the log.
    SHORT_PAUSE: f64 = 3.5;

    /// Length of a pause that is always interpolated, as a share of the bandwidth's period.
    SHORT_PERIOD: f64 = 0.2;

    /// Bandwidth by which pauses are interpolated before a bandwidth is chosen [Hz].
    USUAL_BANDWIDTH: f64 = 5.0;

    /// Number of output samples in each period of the bandwidth.
    OVERSAMPLING: f64 = 10.0;

    /// Share of the duration of all pieces that must remain after their ends are cut off.
    KEPT: f64 = 0.6;

    /// Largest bandwidth, as a share of the rate at which the slowest channel has new samples.
    HIGHEST_BANDWIDTH: f64 = 0.2;

    /// Least decrease of the logarithm of the residual sum of squares by which an effort's own delay or a low-pass filter
    /// counts. Errors of the model imitate delays and filters, and the decrease is then small although it is significant.
    DROP: f64 = 0.1;

    /// Largest relative growth of the unexplained part of the efforts by a smaller bandwidth.
    LOSS: f64 = 0.02;

    /// Growth of the unexplained part after which still smaller bandwidths are not tried.
    HOPELESS_BANDWIDTH: f64 = 0.5;

    /// Number of samples in the regressions that compare bandwidths.
    BANDWIDTH_SAMPLES: usize = 1500;

    /// Number of fits of one set of parameters to all efforts. The weights of each fit follow from the fit before.
    FITS: usize = 3;

    /// Number of samples in the regressions that compare low-pass filters.
    BAND_SAMPLES: usize = 400;

    /// Rise of the misfit (mean over the efforts of ln RSS) after which lower frequencies are not tried.
    HOPELESS_BAND: f64 = 0.1;

    /// Largest candidate frequency of a low-pass filter of the efforts, as a share of the bandwidth. Friction at reversals
    /// that does not depend on the speed alone, and a delay that is not known exactly, resemble a low-pass filter. Simulated
    /// arms that stick, and logs with jitter, have the least misfit at 0.36 to 0.7 of the bandwidth.
    NARROWER: f64 = 0.25;

    /// Widths of friction, as shares of a joint's largest speed: Coulomb friction, and friction that grows more slowly.
    ROUNDINGS: [f64; 3] = [0.002, 0.05, 0.4];

    /// Share of a joint's largest speed within which the sign of its velocity is rounded.
    SHARP: f64 = 0.02;

    /// Least delay that the preparation removes \[s\]. The common estimate finds smaller delays by one linear step, whose
    /// relative error is about half of delay times frequency: 3 % for this delay and 1 Hz. The estimate knows the rotors and
    /// has one set of bodies for all efforts. In the preparation each effort has its own parameters, whose errors imitate
    /// delays of some milliseconds.
    FAR: f64 = 0.01;

    /// Smallest and largest delay that is searched [s]. A negative delay is one of the positions.
    DELAYS: [f64; 2] = [-0.08, 0.08];

    /// Range of delays that is searched first. The larger range is searched only if most efforts fit best at the early end
    /// of this one, because errors of the model imitate large delays.
    USUAL_DELAYS: [f64; 2] = [-0.02, 0.08];

    /// Step of the coarse grid of delays [s].
    COARSE_DELAYS: f64 = 4e-3;

    /// Largest number of samples in the regressions that find delays.
    DELAY_SAMPLES: usize = 2000;

    /// Number of blocks of consecutive samples for a standard error that takes correlated residuals into account.
    DELAY_BLOCKS: usize = 16;

    /// Number of folds on which an effort's own delay is compared with the common one.
    DELAY_FOLDS: usize = 8;

    /// Least standard deviation of the delays of one robot's efforts [s].
    DELAY_SPREAD: f64 = 1e-3;
}
