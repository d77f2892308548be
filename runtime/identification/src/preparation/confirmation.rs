//! The bandwidth that efforts confirm.

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
    /// The widest bandwidth, up to `widest`, at which the motion explains the efforts as well as at any other.
    ///
    /// What the positions show above their noise need not be motion of a rigid robot: gears and links vibrate. One set
    /// of parameters has to explain all efforts, because parameters of each effort's own explain its vibration too. Efforts are
    /// taken as they were measured, so that bandwidths compare. Among equals the widest rounds the steps of
    /// friction least.
    pub(super) fn confirmed(&self, robot: &'a dyn Robot, widest: f64, delays: &[Delay]) -> Result<f64> {
        let tried = candidates(self.lowest(widest).min(widest), widest, 2.0);
        let cut = self.settings.cut.unwrap_or(1.0 / tried[0]);
        let (mut least, mut scores) = (f64::INFINITY, Vec::new());
        for bandwidth in tried.iter().rev() {
            let mut how = self.smoothing(*bandwidth, None, delays.iter().map(|d| d.removed).collect());
            // The same samples for all, so that their residuals compare.
            (how.cut, how.step, how.lowest) = (cut, self.output_step(widest), tried[0]);
            let unexplained = self.unexplained(robot, &how, widest)?;
            least = least.min(unexplained);
            scores.push(unexplained);
            if unexplained > least + levels::HOPELESS_BANDWIDTH.get() {
                break;
            }
        }
        let chosen = tried.iter().rev().zip(scores).find(|(_, score)| *score <= least + levels::LOSS.get());
        Ok(chosen.map_or(widest, |(bandwidth, _)| *bandwidth))
    }

    /// Mean over the efforts of the logarithm of 1 − R²: one set of parameters by least squares on the filtered efforts,
    /// judged on the efforts as they were measured.
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
