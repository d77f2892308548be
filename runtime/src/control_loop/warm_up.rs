//! Warm-up of the caches by controller steps whose results are discarded.

use super::controller::{Controller, Cycle};
use super::law::JointLaw;
use super::run::{ControlLoop, Phase};
use crate::clock::Clock;
use crate::trajectory::Trajectory;
use crate::transport::Transport;
use std::hint::black_box;
use std::time::Duration;

impl<L, R, C, T, K, const N: usize, const M: usize, const NY: usize> ControlLoop<L, R, C, T, K, N, M, NY>
where
    L: JointLaw<N, M, NY>,
    R: Trajectory<N, NY>,
    C: Controller<N, M, NY>,
    T: Transport<N, M, NY>,
    K: Clock,
{
    /// Makes the first warm-up while the brakes are engaged, so its duration does not delay a period. If the warm-up
    /// exceeds its time, later warm-ups are disabled.
    pub(super) fn first_warm_up(&mut self, positions: &[f64; NY]) {
        if self.state.warms_up {
            let begin = self.clock.now();
            self.warm_up(-self.release_time(), positions, None);
            self.take_warm_up(begin);
        }
    }

    /// Warms up for the period that begins at `wake`, if there is still enough time.
    pub(super) fn warm_up_before(&mut self, wake: Duration) {
        if !(self.state.warms_up && self.is_driving()) {
            return;
        }
        let begin = wake.saturating_sub(Duration::from_secs_f64(self.settings.warm_up));
        if self.clock.now() > begin {
            return;
        }
        self.clock.sleep_until(begin);
        let woken = self.clock.now();
        // After a wake-up this late, the remaining time is too short.
        if woken.saturating_sub(begin) > wake.saturating_sub(begin) / 2 {
            return;
        }
        let positions = self.state.believed.positions;
        let velocities = self.state.measures[0].then(|| *self.state.filter.velocities());
        self.warm_up(self.time(), &positions, velocities);
        self.take_warm_up(begin);
    }

    fn warm_up(&mut self, time: f64, positions: &[f64; NY], velocities: Option<[f64; N]>) {
        let desired = self.state.reference.sample(&self.trajectory);
        let velocities_now = self.state.filter.velocities();
        let _ = black_box(self.fallback.inputs_at_time(time, &desired, positions, velocities_now));
        if !matches!(self.state.phase, Phase::Stopping(_)) {
            self.controller.warm_up(&Cycle {
                time,
                positions: Some(*positions),
                velocities,
                last_inputs: self.state.inputs,
                ..Cycle::default()
            });
        }
    }

    fn take_warm_up(&mut self, begin: Duration) {
        let took = self.clock.now().saturating_sub(begin);
        self.state.counts.warm_ups += 1;
        if took > Duration::from_secs_f64(self.settings.warm_up) {
            self.state.counts.late_warm_ups += 1;
            self.state.warms_up = false;
        }
    }
}
