//! Search for a low-pass filter that efforts passed before they were recorded.
//!
//! A drive, a driver or a script may smooth the efforts, while the positions are not smoothed. Then the two sides of the
//! equation of motion have different bandwidths. For example, friction that jumps when a joint reverses seems to grow
//! slowly with the speed. Least squares is correct again if both sides pass the filter with the lower bandwidth (parallel
//! filtering, Gautier 1997).

use super::super::error::Result;
use super::super::methods::filter::Band;
use super::super::robot::Robot;
use super::super::run::PreparedRun;
use super::choice::Recorded;
use super::levels;
use super::regression::{Columns, Problem, Sample, problems, spread};
use super::result::Delay;
use nalgebra::DMatrix;

/// Filter orders that are tried. A higher order has a steeper edge.
const ORDERS: [u32; 3] = [1, 2, 4];

/// Ratios of neighbouring candidate frequencies, from coarse to fine.
const STEPS: [f64; 6] = [1.4, 1.2, 1.1, 1.05, 1.025, 1.0125];

/// A low-pass filter that was tried, and its effect: the decrease of ln RSS (residual sum of squares) of each effort.
struct Tried {
    band: Band,
    drops: Vec<f64>,
}

impl Tried {
    fn mean(&self) -> f64 {
        self.drops.iter().sum::<f64>() / self.drops.len().max(1) as f64
    }

    /// Returns the filter with the larger mean decrease of ln RSS (residual sum of squares).
    fn or(self, other: Self) -> Self {
        if other.mean() > self.mean() { other } else { self }
    }
}

impl<'a> Recorded<'a> {
    /// Searches the low-pass filter of the efforts. The result is `None` if the motion does not explain every effort better
    /// with a filter. All other signals must pass the filter that is found.
    ///
    /// Each effort has separate parameters, as in the search for delays. Friction has several widths, because a friction
    /// law that grows slowly with the speed must not look like a filter. A filter is accepted only if its frequency is
    /// below a quarter of `bandwidth` and it lowers ln RSS of each effort by more than 0.1. If a joint has a quaternion, no
    /// filter is searched, because filtered quaternions lose their unit length.
    ///
    /// - `bandwidth`: half-amplitude frequency of the smoothing filter in Hz
    /// - `delays`: delay that was removed from each effort
    pub(super) fn band(
        &self,
        robot: &'a dyn Robot,
        bandwidth: f64,
        delays: &[Delay],
    ) -> Result<Option<Band>> {
        if !robot.quaternion_joints().is_empty() {
            return Ok(None);
        }
        let how = self.smoothing(bandwidth, None, delays.iter().map(|d| d.removed).collect());
        let smoothed = self.smooth(&how, bandwidth)?;
        let runs: Vec<&PreparedRun> = smoothed.iter().map(|s| &s.run).collect();
        let fits =
            Fits::new(self.columns(robot, &runs, Some(how.filter()?), &levels::ROUNDINGS.get()), &runs);
        Ok(fits.best(levels::NARROWER.get() * bandwidth, self.lowest(bandwidth)))
    }
}

/// Fits of the efforts with and without a low-pass filter.
struct Fits<'a> {
    columns: Columns<'a>,
    runs: &'a [&'a PreparedRun],
    samples: Vec<Sample>,
    /// Values of each effort at the samples.
    efforts: Vec<DMatrix<f64>>,
    /// ln RSS of each effort without a low-pass filter; `None` if the columns cannot explain the effort or explain it
    /// exactly.
    without: Vec<Option<f64>>,
}

impl<'a> Fits<'a> {
    fn new(columns: Columns<'a>, runs: &'a [&'a PreparedRun]) -> Self {
        let samples = spread(runs, levels::BAND_SAMPLES.get(), 0);
        let effort = |m: usize| {
            DMatrix::from_iterator(samples.len(), 1, samples.iter().map(|(r, i)| runs[*r].efforts[m][*i]))
        };
        let efforts = (0..runs.first().map_or(0, |run| run.efforts.len())).map(effort).collect();
        let mut fits = Self { columns, runs, samples, efforts, without: Vec::new() };
        fits.without = fits.misfits(&fits.columns);
        fits
    }

    /// Returns ln RSS of each effort; `None` if the columns cannot explain the effort or explain it exactly.
    fn misfits(&self, columns: &Columns) -> Vec<Option<f64>> {
        let misfit = |(problem, effort): (Option<Problem>, &DMatrix<f64>)| {
            let left = problem?.misfits(effort)[0];
            (left.is_finite() && left > 0.0).then(|| left.ln())
        };
        problems(columns, self.runs, &self.samples).into_iter().zip(&self.efforts).map(misfit).collect()
    }

    /// Tries a low-pass filter, and returns it with its effect.
    fn through(&self, frequency: f64, order: u32) -> Tried {
        let band = Band { frequency, order };
        let misfits = self.misfits(&self.columns.behind(band));
        let drops = self.without.iter().zip(misfits).filter_map(|(before, after)| Some((*before)? - after?));
        Tried { band, drops: drops.collect() }
    }

    /// Returns the best low-pass filter with a frequency from `lowest` to `highest` in Hz; `None` if no filter in this
    /// range is good enough.
    fn best(&self, highest: f64, lowest: f64) -> Option<Band> {
        let mut best = self.through(highest, ORDERS[1]);
        let octaves = (1..).map(|k| highest * 0.5_f64.powi(k)).take_while(|frequency| *frequency >= lowest);
        for frequency in octaves {
            best = best.or(self.through(frequency, ORDERS[1]));
        }
        if best.mean() < levels::DROP.get() {
            return None;
        }
        best = self.narrowed(best, &STEPS[..2]);
        for order in [ORDERS[0], ORDERS[2]] {
            let other = self.through(best.band.frequency, order);
            best = best.or(self.narrowed(other, &STEPS[1..2]));
        }
        best = self.narrowed(best, &STEPS[2..]);
        let lowers_all = best.drops.iter().all(|drop| *drop > levels::DROP.get());
        (lowers_all && best.band.frequency < highest).then_some(best.band)
    }

    /// Returns the best filter of the order of `best`. It is found with decreasing steps of the frequency.
    fn narrowed(&self, mut best: Tried, steps: &[f64]) -> Tried {
        for step in steps {
            let Band { frequency, order } = best.band;
            for neighbour in [frequency / step, frequency * step] {
                best = best.or(self.through(neighbour, order));
            }
        }
        best
    }
}
