//! Choice of the filter's bandwidth from the efforts: the largest bandwidth at which the motion explains the efforts well.

use super::super::error::Result;
use super::super::robot::Robot;
use super::super::run::PreparedRun;
use super::bandwidth::candidates;
use super::choice::Recorded;
use super::levels;
use super::regression::spread;
use super::result::Delay;
use super::signals::{Smoothed, Smoothing};
use super::together::{Efforts, together};
use nalgebra::DVector;

impl<'a> Recorded<'a> {
    /// Returns the largest bandwidth, up to `widest` in Hz, at which the motion explains the efforts about as well as at
    /// the best bandwidth.
    ///
    /// A motion above the noise of the positions need not be a motion of the rigid robot, because gears and links vibrate.
    /// One set of parameters must explain all efforts. With separate parameters for each effort, the vibration would be
    /// explained, too. The motion is compared with the unfiltered efforts, so that the scores of different bandwidths are
    /// comparable. Of equally good bandwidths, the largest one smooths the steps of friction least.
    pub(super) fn confirmed(&self, robot: &'a dyn Robot, widest: f64, delays: &[Delay]) -> Result<f64> {
        let tried = candidates(self.lowest(widest).min(widest), widest, 2.0);
        let cut = self.settings.cut.unwrap_or(1.0 / tried[0]);
        let (mut least, mut scores) = (f64::INFINITY, Vec::new());
        for bandwidth in tried.iter().rev() {
            let mut how = self.smoothing(*bandwidth, None, delays.iter().map(|d| d.removed).collect());
            // The samples are the same for all bandwidths, so that their residuals are comparable.
            (how.cut, how.step, how.lowest) = (cut, self.output_step(widest), tried[0]);
            let unexplained = self.unexplained(robot, &how, widest)?;
            least = least.min(unexplained);
            scores.push(unexplained);
        }
        let chosen = tried.iter().rev().zip(scores).find(|(_, score)| *score <= least + levels::LOSS.get());
        Ok(chosen.map_or(widest, |(bandwidth, _)| *bandwidth))
    }

    /// Returns the mean of ln(1 − R²) over the efforts. One set of parameters is fitted to the filtered efforts by least
    /// squares. The residuals are those of the unfiltered efforts.
    fn unexplained(&self, robot: &'a dyn Robot, how: &Smoothing, split: f64) -> Result<f64> {
        let smoothed = self.smooth(how, split)?;
        let runs: Vec<&PreparedRun> = smoothed.iter().map(|s| &s.run).collect();
        let samples = spread(&runs, levels::BANDWIDTH_SAMPLES.get(), 0);
        let column = |of: &dyn Fn(&Smoothed) -> &Vec<f64>| {
            DVector::from_iterator(samples.len(), samples.iter().map(|(r, i)| of(&smoothed[*r])[*i]))
        };
        let efforts = || 0..how.delays.len();
        let efforts = Efforts {
            filtered: efforts().map(|m| column(&|s| &s.run.efforts[m])).collect(),
            measured: efforts().map(|m| column(&|s| &s.measured[m])).collect(),
        };
        let scores =
            together(&self.columns(robot, &runs, None, &[levels::SHARP.get()]), &runs, &samples, &efforts);
        Ok(if scores.is_empty() { 0.0 } else { scores.iter().sum::<f64>() / scores.len() as f64 })
    }
}
