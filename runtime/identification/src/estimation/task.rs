//! Robot, runs and settings that all stages of an estimate share.

use super::super::robot::Robot;
use super::super::run::PreparedRun;
use super::delays::FirstFit;
use super::layout::Layout;
use super::loads::Loads;
use super::normal::Values;
use super::prior::Prior;
use super::residuals::{Forces, RunOffsets, forces};
use super::result::Gravity;
use super::rows::{More, Rows};
use super::settings::EstimationSettings;
use super::sums::Piece;

/// The robot, the data and the settings of an estimate.
#[derive(Clone)]
pub(super) struct Task<'a> {
    pub(super) robot: &'a dyn Robot,
    pub(super) runs: &'a [PreparedRun],
    pub(super) settings: &'a EstimationSettings,
    pub(super) layout: &'a Layout,
    pub(super) prior: &'a Prior,
    pub(super) gravity: Gravity,
    pub(super) pieces: Vec<Piece>,
    pub(super) loads: Option<&'a Loads>,
    /// First fit with unknown delays. The estimated delays have been removed from [`Self::runs`]. `None` if the delays are
    /// known.
    pub(super) first_fit: Option<&'a FirstFit>,
    /// Columns that a hypothesis adds to the regressor.
    pub(super) more: Option<More<'a>>,
}

impl Task<'_> {
    pub(super) fn rows(&self) -> Rows<'_> {
        let rows =
            Rows::new(self.robot, self.layout, self.gravity, self.settings.filter.as_ref(), self.loads);
        rows.with_rates(self.first_fit.map(|fit| fit.rates.as_slice())).with_more(self.more)
    }

    pub(super) fn forces(&self, values: &Values, offsets: &RunOffsets) -> Forces {
        forces(&mut self.rows(), self.layout, self.runs, values, offsets)
    }

    /// Extends this task by additional parameters, and calls a function with the extended task.
    ///
    /// - `count`: number of additional parameters
    /// - `more`: change of the regressor, with the columns of the additional parameters at the end
    pub(super) fn with_more<T>(&self, count: usize, more: More, of: impl FnOnce(&Task) -> T) -> T {
        let layout = self.layout.with_more_parameters(count);
        let described = [&self.prior.described[..], &vec![1.0; count]].concat();
        let prior = Prior::new(&described, self.robot.bodies(), self.prior.joints.clone());
        let task = Task { layout: &layout, prior: &prior, more: Some(more), ..self.clone() };
        of(&task)
    }
}
