//! The reference over the horizon: desired states and feed-forward. What the period before has computed of the same instants is
//! kept, and with it the stages that are linearized there.

use super::node::Node;
use crate::dynamics::Dynamics;
use crate::feed_forward::FeedForward;
#[cfg(not(feature = "std"))]
use crate::no_std::*;
use crate::trajectory::{Sample, Trajectory};

/// Largest distance of a start from the instants of the start before, in periods: rounding of the times of a loop.
const ROUNDING: f64 = 1e-9;

#[derive(Debug, Clone)]
pub(super) struct Reference<const N: usize, const M: usize, const NY: usize> {
    /// x_ref at the K + 1 nodes.
    pub nodes: Vec<Node<N, NY>>,
    /// The desired state in the middle of each of the K periods.
    pub middles: Vec<Sample<N, NY>>,
    /// u_ff in the middle of each period.
    pub inputs: Vec<[f64; M]>,
    /// Whether the stage of each period is set for this reference.
    pub is_set: Vec<bool>,
    period: f64,
    /// Node k is at `first + (passed + k) period`, so that an instant of several horizons is one number. NaN before the first start.
    first: f64,
    passed: f64,
    /// True if the model is another one than that of the last call.
    is_stale: bool,
}

impl<const N: usize, const M: usize, const NY: usize> Reference<N, M, NY> {
    /// - `neutral`: any state
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

    /// Nothing is kept, because the model is another one.
    pub fn forget(&mut self) {
        self.is_stale = true;
    }

    /// The middle of period `k` (s).
    pub fn middle_time(&self, k: usize) -> f64 {
        self.time(k as f64 + 0.5)
    }

    fn time(&self, nodes: f64) -> f64 {
        self.first + (self.passed + nodes) * self.period
    }

    /// The reference from `start` (s) on; how many periods have passed since the one before, all K if nothing of it is kept.
    ///
    /// The motion is sampled anew, because it may change. Feed-forward and stages are kept where it has not changed; of robots with
    /// driven joints none are, because the motion of these may change too.
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

    /// Begins at `start` (s); how many periods have passed since the last start.
    fn begin(&mut self, start: f64) -> usize {
        let periods = self.inputs.len();
        let since = (start - self.time(0.0)) / self.period;
        let passed = since.round();
        // NaN is neither.
        if (since - passed).abs() <= ROUNDING && (0.0..periods as f64).contains(&passed) {
            self.passed += passed;
            return passed as usize;
        }
        (self.first, self.passed) = (start, 0.0);
        periods
    }
}
