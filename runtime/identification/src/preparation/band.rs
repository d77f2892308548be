//! The low-pass filter that efforts passed before they were recorded.
//!
//! A drive, a driver or a script for evaluation smooths efforts, and positions stay as they are. Then the two sides of the
//! equation of motion have different bands: friction that jumps where a joint reverses seems to grow slowly with the speed.
//! Least squares is right again if both sides pass the narrower band (Gautier 1997, parallel filtering).

use super::super::error::Result;
use super::super::methods::filter::Band;
use super::super::robot::Robot;
use super::super::run::PreparedRun;
use super::choice::Recorded;
use super::levels;
use super::regression::{Columns, Problem, Sample, problems, spread};
use super::result::Delay;
use nalgebra::DMatrix;

/// Orders that are tried; the higher, the steeper.
const ORDERS: [u32; 3] = [1, 2, 4];

/// Steps of the search for the frequency, as factors.
const STEPS: [f64; 6] = [1.4, 1.2, 1.1, 1.05, 1.025, 1.0125];

/// A band, and by how much it lowers ln RSS of each effort.
struct Tried {
    band: Band,
    drops: Vec<f64>,
}

impl Tried {
    fn mean(&self) -> f64 {
        self.drops.iter().sum::<f64>() / self.drops.len().max(1) as f64
    }

    /// The better one.
    fn or(self, other: Self) -> Self {
        if other.mean() > self.mean() { other } else { self }
    }
}

impl<'a> Recorded<'a> {
    /// The band of the efforts, if the motion explains all of them better through it: all other signals have to pass it.
    ///
    /// Each effort has parameters of its own, as in the search for delays, and several widths of friction, because a law that grows
    /// slowly with the speed is not a band. The band has to be narrower than a quarter of the bandwidth, and to lower ln RSS of each
    /// effort by a tenth. If a joint has a quaternion, no band is searched for, because filtered quaternions lose their unit length.
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

/// Efforts that the columns explain through one band or another.
struct Fits<'a> {
    columns: Columns<'a>,
    runs: &'a [&'a PreparedRun],
    samples: Vec<Sample>,
    /// Each effort at the samples.
    efforts: Vec<DMatrix<f64>>,
    /// ln RSS of each effort without a band.
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

    /// ln RSS of each effort; none for an effort that cannot be explained or is explained exactly.
    fn misfits(&self, columns: &Columns) -> Vec<Option<f64>> {
        let misfit = |(problem, effort): (Option<Problem>, &DMatrix<f64>)| {
            let left = problem?.misfits(effort)[0];
            (left.is_finite() && left > 0.0).then(|| left.ln())
        };
        problems(columns, self.runs, &self.samples).into_iter().zip(&self.efforts).map(misfit).collect()
    }

    /// A band and its effect.
    fn through(&self, frequency: f64, order: u32) -> Tried {
        let band = Band { frequency, order };
        let misfits = self.misfits(&self.columns.behind(band));
        let drops = self.without.iter().zip(misfits).filter_map(|(before, after)| Some((*before)? - after?));
        Tried { band, drops: drops.collect() }
    }

    /// The best band from `lowest` to `highest`, if it is one.
    fn best(&self, highest: f64, lowest: f64) -> Option<Band> {
        let mut best = self.through(highest, ORDERS[1]);
        let octaves = (1..).map(|k| highest * 0.5_f64.powi(k)).take_while(|frequency| *frequency >= lowest);
        for frequency in octaves {
            let next = self.through(frequency, ORDERS[1]);
            let is_hopeless = next.mean() < best.mean() - levels::HOPELESS_BAND.get();
            best = best.or(next);
            if is_hopeless {
                break;
            }
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

    /// The best of a band and those of its order at smaller and smaller steps from its frequency.
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
