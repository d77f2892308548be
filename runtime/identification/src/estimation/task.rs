//! Data that all stages of an estimate share.

use super::super::robot::Robot;
use super::super::run::PreparedRun;
use super::delays::FirstFit;
use super::layout::Layout;
use super::loads::Loads;
use super::normal::Values;
use super::prior::Prior;
use super::residuals::{Forces, RunOffsets, forces};
use super::result::Gravity;
use super::rows::Rows;
use super::settings::EstimationSettings;
use super::sums::Piece;

/// The robot, the data and the settings, as the stages need them.
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
    /// Delays of a first fit, if they are unknown; they have been removed from the runs.
    pub(super) first_fit: Option<&'a FirstFit>,
}

impl Task<'_> {
    pub(super) fn rows(&self) -> Rows<'_> {
        self.rows_where(self.gravity)
    }

    pub(super) fn rows_where(&self, gravity: Gravity) -> Rows<'_> {
        let rows = Rows::new(self.robot, self.layout, gravity, self.settings.filter.as_ref(), self.loads);
        rows.with_rates(self.first_fit.map(|fit| fit.rates.as_slice()))
    }

    pub(super) fn forces(&self, values: &Values, offsets: &RunOffsets) -> Forces {
        forces(&mut self.rows(), self.layout, self.runs, values, offsets)
    }
}
