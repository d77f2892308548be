//! The reference over the horizon: desired states and feed-forward. Values that the previous period computed for the
//! same times are kept. Stages of the QP that are linearized at the reference are also kept.

use super::node::Node;
use crate::dynamics::Dynamics;
use crate::feed_forward::FeedForward;
#[cfg(not(feature = "std"))]
use crate::no_std::*;
use crate::trajectory::{Sample, Trajectory};

/// Largest difference between times of two horizons that count as equal, in periods. Times of a loop have rounding
/// errors.
const ROUNDING: f64 = 1e-9;

#[derive(Debug, Clone)]
pub(super) struct Reference<const N: usize, const M: usize, const NY: usize> {
    /// Desired states x_ref at the K + 1 nodes of a horizon of K periods.
    pub nodes: Vec<Node<N, NY>>,
    /// Desired state in the middle of each period of the horizon.
    pub middles: Vec<Sample<N, NY>>,
    /// Feed-forward u_ff in the middle of each period.
    pub inputs: Vec<[f64; M]>,
    /// Whether the stage of each period in the QP has been set for this reference.
    pub is_set: Vec<bool>,
    period: f64,
    /// Time of the first node of the first horizon (s); NaN before the first call. Node k is at the time
    /// `first + (passed + k) period`, so the time of a node is the same number in several horizons.
    first: f64,
    passed: f64,
    /// Whether the model has changed since the last call.
    is_stale: bool,
}

impl<const N: usize, const M: usize, const NY: usize> Reference<N, M, NY> {
    /// Allocates the reference for a horizon of `periods` periods of length `period` (s).
    ///
    /// - `neutral`: any valid state
    pub fn new(periods: usize, period: f64, neutral: Node<N, NY>) -> Self {
        Self {
            nodes: vec![neutral; periods + 1],
            middles: vec![Sample::at_rest(neutral.positions); periods],
            inputs: vec![[0.0; M]; periods],
            is_set: vec![false; periods],
            period,
            first: f64::NAN,
            passed: 0.0,
            is_stale: true,
        }
    }

    /// Marks all kept values as invalid, because the model has changed.
    pub fn forget(&mut self) {
        self.is_stale = true;
    }

    /// Time of the middle of period `k` (s).
    pub fn middle_time(&self, k: usize) -> f64 {
        self.time(k as f64 + 0.5)
    }

    fn time(&self, nodes: f64) -> f64 {
        self.first + (self.passed + nodes) * self.period
    }

    /// Computes the reference from `start` (s) on. Returns the number of periods since the previous
    /// reference. If no value of the previous reference is kept, it returns the number of periods in the
    /// horizon.
    ///
    /// The trajectory is sampled again, because it may have changed. Feed-forward and stages are kept if the samples
    /// are equal to the previous samples. For robots with driven joints nothing is kept, because the driven motion
    /// may have changed too.
    pub fn look_ahead<D: Dynamics<N, M, NY>>(
        &mut self,
        start: f64,
        trajectory: &impl Trajectory<N, NY>,
        feed_forward: &FeedForward<D, N, M, NY>,
    ) -> usize {
        self.is_stale |= feed_forward.model().at_time(start, |model| !model.driven_motion().is_empty());
        let passed = self.begin(start);
        self.nodes.copy_within(passed.., 0);
        self.middles.copy_within(passed.., 0);
        self.inputs.copy_within(passed.., 0);
        self.is_set.copy_within(passed.., 0);
        let periods = self.inputs.len();
        self.is_set[periods - passed..].fill(false);
        for k in 0..=periods {
            let Sample { positions, velocities, .. } = trajectory.sample(self.time(k as f64));
            let node = Node { positions, velocities };
            if node != self.nodes[k] {
                self.nodes[k] = node;
                self.is_set[k.saturating_sub(1)..(k + 1).min(periods)].fill(false);
            }
        }
        for k in 0..periods {
            let time = self.middle_time(k);
            let middle = trajectory.sample(time);
            if self.is_stale || k >= periods - passed || middle != self.middles[k] {
                self.middles[k] = middle;
                self.inputs[k] = feed_forward.at_time(time, &middle).inputs;
                self.is_set[k] = false;
            }
        }
        self.is_stale = false;
        passed
    }

    /// Sets the start to `start` (s). Returns the number of periods since the previous start. If the
    /// difference is not a whole number of periods within the horizon, the result is the number K of periods
    /// in the horizon.
    fn begin(&mut self, start: f64) -> usize {
        let periods = self.inputs.len();
        let since = (start - self.time(0.0)) / self.period;
        let passed = since.round();
        // Both conditions are false for NaN.
        if (since - passed).abs() <= ROUNDING && (0.0..periods as f64).contains(&passed) {
            self.passed += passed;
            return passed as usize;
        }
        (self.first, self.passed) = (start, 0.0);
        periods
    }
}
