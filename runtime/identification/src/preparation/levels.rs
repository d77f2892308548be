//! Thresholds (levels) of the preparation.

use super::super::numeric::levels::levels;

levels! {
    /// Half width, in samples, of the windows that separate motion from rest.
    REST_WINDOW: usize = 8;

    /// Share of a joint's largest speed below which the joint sticks or creeps.
    SLOW: f64 = 0.01;

    /// Speed below which a speed counts as zero, as a multiple of the standard deviation of the speed's noise.
    SPEED_NOISE: f64 = 4.0;

    /// Largest limit of the speed that follows from noise, as a share of a joint's largest speed. With more noise, rest
    /// cannot be separated from motion.
    MOST_NOISE: f64 = 0.1;

    /// Smallest ratio of two durations of a rest: the time below the speed limit, and the time between this limit and twice
    /// this limit. If the speed changes its sign, the ratio is 1 at a constant acceleration, and 2.4 if the acceleration is
    /// zero at the change.
    FLAT: f64 = 2.0;

    /// Extension of a rest at each end, as a share of the bandwidth's period. It is the width of the main lobe of the
    /// filter. A rest is extended because the filtered speed shows motion before the motion begins. The terms of friction
    /// are computed from this speed and pass the filter again.
    REACH: f64 = 1.0;

    /// Number of bands of a spectrum in each octave.
    BANDS_PER_OCTAVE: f64 = 6.0;

    /// Number of candidate bandwidths in each octave.
    BANDWIDTHS_PER_OCTAVE: f64 = 6.0;

    /// Largest difference between the errors of equally good bandwidths, as a share of the acceleration's power. The
    /// largest of the equally good bandwidths is used, so that the efforts can decide among them.
    EQUAL_BANDWIDTHS: f64 = 1e-3;

    /// Longest pause that is always interpolated, in time steps of the log.
    SHORT_PAUSE: f64 = 3.5;

    /// Longest pause that is always interpolated, as a share of the bandwidth's period.
    SHORT_PERIOD: f64 = 0.2;

    /// Bandwidth in Hz for the interpolation of pauses before a bandwidth is chosen.
    USUAL_BANDWIDTH: f64 = 5.0;

    /// Number of prepared samples in each period of the bandwidth.
    OVERSAMPLING: f64 = 10.0;

    /// Smallest share of the duration of all pieces that must remain after their ends are cut off.
    KEPT: f64 = 0.6;

    /// Largest bandwidth, as a share of the rate at which the slowest channel has new samples.
    HIGHEST_BANDWIDTH: f64 = 0.2;

    /// Smallest decrease of ln RSS (residual sum of squares) for which an effort gets its own delay or a low-pass filter.
    /// Errors of the model can imitate delays and filters. The decrease is then small although it is significant.
    DROP: f64 = 0.1;

    /// Largest relative growth of the unexplained part of the efforts that a smaller bandwidth may cause.
    LOSS: f64 = 0.02;

    /// Number of samples in the regressions that compare bandwidths.
    BANDWIDTH_SAMPLES: usize = 1500;

    /// Number of fits of one set of parameters to all efforts. The weights of each fit follow from the fit before it.
    FITS: usize = 3;

    /// Number of samples in the regressions that compare low-pass filters.
    BAND_SAMPLES: usize = 400;

    /// Largest candidate frequency of a low-pass filter of the efforts, as a share of the bandwidth. Two other effects
    /// resemble a low-pass filter: friction at reversals that depends on more than the speed, and a delay that is not known
    /// exactly. Simulated arms with stiction, and logs with jitter, have the smallest misfit at 0.36 to 0.7 of the
    /// bandwidth.
    NARROWER: f64 = 0.25;

    /// Widths of the smooth signs of the velocity, as shares of a joint's largest speed. The smooth signs represent Coulomb
    /// friction and friction that grows more slowly with the speed.
    ROUNDINGS: [f64; 3] = [0.002, 0.05, 0.4];

    /// Width of the smooth sign of the velocity, as a share of a joint's largest speed.
    SHARP: f64 = 0.02;

    /// Smallest delay in s that the preparation removes. The common estimate finds smaller delays by one
    /// linear step. The relative error of this step is about half of delay times angular frequency: 3 % for
    /// this delay and 1 Hz. The estimate takes the rotors into account and has one set of bodies for all
    /// efforts. In the preparation, each effort has separate parameters, whose errors imitate delays of some
    /// milliseconds.
    FAR: f64 = 0.01;

    /// Smallest and largest delay of the search in s. If a delay is negative, the positions are late.
    DELAYS: [f64; 2] = [-0.08, 0.08];

    /// Range of delays, in s, that is searched first. The larger range [`DELAYS`] is searched only if most
    /// efforts fit best at the negative end of this range. The reason is that errors of the model imitate
    /// large delays.
    USUAL_DELAYS: [f64; 2] = [-0.02, 0.08];

    /// Step of the coarse grid of delays in s.
    COARSE_DELAYS: f64 = 4e-3;

    /// Largest number of samples in the regressions that find delays.
    DELAY_SAMPLES: usize = 2000;

    /// Number of blocks of consecutive samples. A standard error from blocks takes correlated residuals into account.
    DELAY_BLOCKS: usize = 16;

    /// Number of folds that compare an effort's own delay with the common one.
    DELAY_FOLDS: usize = 8;

    /// Smallest assumed standard deviation of the delays of one robot's efforts, in s.
    DELAY_SPREAD: f64 = 1e-3;
}
