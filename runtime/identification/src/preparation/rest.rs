//! Detection of the time intervals in which a joint rests.
//!
//! At rest, dry friction can have any value up to the static friction: it balances the difference between the
//! drive force and the rigid-body force. Therefore the effort of a resting joint contains no information on
//! the delay, on the filter, or on friction as a function of the speed.

use super::super::run::PreparedRun;
use super::levels;

/// First and last time of a rest in s.
type Stretch = [f64; 2];

/// Rests of one run: one list for each joint, in the order of time.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Rests {
    joints: Vec<Vec<Stretch>>,
}

/// Largest speed and noise of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Speeds {
    /// Largest speed in all runs in rad/s or m/s; infinite if the joint never moves.
    pub largest: f64,
    /// Standard deviation of the noise of a smoothed speed in rad/s or m/s.
    pub noise: f64,
}

impl Speeds {
    /// Returns the speed in rad/s or m/s below which the joint counts as resting.
    fn limit(&self) -> f64 {
        (levels::SLOW.get() * self.largest)
            .max((levels::SPEED_NOISE.get() * self.noise).min(levels::MOST_NOISE.get() * self.largest))
    }
}

impl Rests {
    /// Adds the rests in a smoothed piece of the run.
    ///
    /// - `speeds`: statistics of each joint; `None` if the joint never rests
    /// - `bandwidth`: half-amplitude frequency in Hz of the filter of the piece
    /// - `cut`: time in s that was cut off at each end of the piece. A rest at an end is continued in this time.
    pub(crate) fn add(&mut self, piece: &PreparedRun, speeds: &[Option<Speeds>], bandwidth: f64, cut: f64) {
        self.joints.resize(speeds.len(), Vec::new());
        let shortest = 1.0 / bandwidth;
        let (Some(first), Some(last)) = (piece.times.first(), piece.times.last()) else { return };
        let joints = self.joints.iter_mut().zip(&piece.velocities).zip(speeds);
        for ((rests, velocities), speeds) in joints {
            let Some(limit) = speeds.map(|speeds| speeds.limit()) else { continue };
            let slow = slow_stretches(&piece.times, velocities, limit);
            for [from, to] in slow_stretches(&piece.times, velocities, 2.0 * limit) {
                let within = || slow.iter().filter(|[start, end]| from <= *start && *end <= to);
                let (Some([start, _]), Some([_, end])) = (within().next(), within().next_back()) else {
                    continue;
                };
                let dwell: f64 = within().map(|[start, end]| end - start).sum();
                let [begins, ends] = [start <= first, end >= last];
                if begins || ends || dwell >= shortest && dwell >= levels::FLAT.get() * (to - from - dwell) {
                    rests.push([
                        if begins { start - cut } else { *start },
                        if ends { end + cut } else { *end },
                    ]);
                }
            }
        }
    }

    /// Returns the durations in s of the parts of an interval in which a joint does not rest, for all joints. If no rests
    /// are known, the result is the duration of the interval.
    pub(crate) fn between(&self, [start, end]: Stretch) -> Vec<f64> {
        if self.joints.is_empty() {
            return vec![end - start];
        }
        let of_joint = |rests: &Vec<Stretch>| {
            let ends = rests.iter().map(|rest| rest[1]);
            let from = std::iter::once(start).chain(ends);
            let to = rests.iter().map(|rest| rest[0]).chain([end]);
            let parts = from.zip(to).map(|(from, to)| to.min(end) - from.max(start));
            parts.filter(|duration| *duration > 0.0).collect::<Vec<_>>()
        };
        self.joints.iter().flat_map(of_joint).collect()
    }

    /// Returns for each joint and each time whether the joint rests, or whether the filter does not separate
    /// this time from a rest.
    pub(crate) fn at(&self, times: &[f64], bandwidth: f64) -> Vec<Vec<bool>> {
        let near = levels::REACH.get() / bandwidth;
        let of_joint = |rests: &Vec<Stretch>| {
            let within = |t: &f64| rests.iter().any(|[start, end]| start - near <= *t && *t <= end + near);
            times.iter().map(within).collect()
        };
        self.joints.iter().map(of_joint).collect()
    }
}

/// Returns the first and the last time of each interval in which no speed is above the limit.
fn slow_stretches(times: &[f64], velocities: &[f64], limit: f64) -> Vec<Stretch> {
    let mut stretches: Vec<Stretch> = Vec::new();
    let mut before = false;
    for (t, v) in times.iter().zip(velocities) {
        let slow = v.abs() <= limit;
        match stretches.last_mut() {
            Some(stretch) if slow && before => stretch[1] = *t,
            _ if slow => stretches.push([*t, *t]),
            _ => {}
        }
        before = slow;
    }
    stretches
}

#[cfg(test)]
mod tests {
    use super::super::super::run::Effort;
    use super::*;

    /// The joint moves from 1 s to 4 s with a reversal at 2.5 s, and rests before and after.
    fn piece() -> PreparedRun {
        moving(|t| if (1.0..=4.0).contains(&t) { (2.5 - t).clamp(-1.0, 1.0) } else { 1e-4 })
    }

    fn moving(speed: impl Fn(f64) -> f64) -> PreparedRun {
        let times: Vec<f64> = (0..=500).map(|i| 0.01 * f64::from(i)).collect();
        PreparedRun {
            name: "piece".into(),
            rows: (2..503).collect(),
            positions: vec![vec![0.0; 501]],
            poses: Vec::new(),
            velocities: vec![times.iter().map(|t| speed(*t)).collect()],
            accelerations: vec![vec![0.0; 501]],
            efforts: vec![vec![0.0; 501]],
            resting: Vec::new(),
            effort: Effort::Joint,
            times,
        }
    }

    #[test]
    fn rests_at_the_ends_are_found_and_a_reversal_is_none() {
        let mut rests = Rests::default();
        let speeds = Some(Speeds { largest: 1.0, noise: 1e-4 });
        rests.add(&piece(), &[speeds], 5.0, 0.2);
        let times = [-0.1, 0.5, 1.15, 1.25, 2.5, 3.75, 3.85, 4.5, 5.1];
        let resting = [true, true, true, false, false, false, true, true, true];
        assert_eq!(rests.at(&times, 5.0), [resting]);
        // Noise that hides the motion also hides a reversal, but no speed above a tenth of the largest speed.
        let mut noisy = Rests::default();
        noisy.add(&piece(), &[Some(Speeds { largest: 1.0, noise: 1.0 })], 20.0, 0.2);
        assert_eq!(noisy.at(&[2.35, 2.45], 20.0), [[false, false]]);
        let durations = rests.between([1.5, 5.0]);
        assert!(durations.len() == 1 && (durations[0] - 2.5).abs() < 0.05, "{durations:?}");
        assert_eq!(Rests::default().between([1.5, 5.0]), [3.5]);
        let mut never = Rests::default();
        never.add(&piece(), &[None], 5.0, 0.2);
        assert_eq!(never.at(&times, 5.0), [[false; 9]]);
    }

    #[test]
    fn a_stop_before_the_way_back_is_a_rest_also_if_noise_interrupts_it() {
        let rests = |speed: &dyn Fn(f64) -> f64| {
            let mut rests = Rests::default();
            let speeds = Some(Speeds { largest: 1.0, noise: 1e-4 });
            rests.add(&moving(speed), &[speeds], 20.0, 0.2);
            rests.at(&[2.4, 2.5, 2.6], 20.0).concat()
        };
        let stop = |t: f64| 0.1 * (2.5 - t) * (2.5 - t).abs();
        assert_eq!(rests(&stop), [true; 3]);
        assert_eq!(rests(&|t| if (t - 2.5).abs() < 1e-6 { 0.015 } else { stop(t) }), [true; 3]);
        assert_eq!(rests(&|t| 2.5 - t), [false; 3]);
    }
}
