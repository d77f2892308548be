//! Stretches in which a joint rests or reverses.
//!
//! Dry friction at rest takes any value up to the static one: it balances what the drive and the rigid body do not. So
//! the effort of a resting joint says nothing about the law over the speed, about the delay, nor about the filter. The filter
//! mixes the efforts of a rest or a reversal with those of its neighbourhood, as far as the main lobe of its kernel reaches.

use super::super::run::PreparedRun;

/// Share of a joint's largest speed below which it sticks or creeps.
const SLOW: f64 = 0.01;

/// Deviations of the speed's noise below which a speed is not told from zero.
const NOISE: f64 = 4.0;

/// Share of the largest speed that noise of the speed may make of this limit: beyond it nothing is told apart.
const MOST: f64 = 0.1;

/// Least duration of a rest [s] that the choice of filter and delay leaves out: reversals show a delay better than all else.
pub(super) const SHORTEST: f64 = 0.25;

/// Part of the bandwidth's period by which a rest or a reversal reaches into its neighbourhood.
const LOBE: f64 = 1.0;

/// First and last time of a rest or a reversal [s].
type Stretch = [f64; 2];

/// The rests and reversals of one run, for each joint in the order of time.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Rests {
    joints: Vec<Vec<Stretch>>,
}

/// What is known of a joint's speeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Speeds {
    /// Largest speed of all runs [rad/s or m/s]; infinite where the joint moves in none.
    pub largest: f64,
    /// Standard deviation of the noise of a smoothed speed.
    pub noise: f64,
}

impl Speeds {
    /// Speed below which the joint rests.
    fn limit(&self) -> f64 {
        (SLOW * self.largest).max((NOISE * self.noise).min(MOST * self.largest))
    }
}

impl Rests {
    /// Adds those of a smoothed piece of the run.
    ///
    /// - `speeds`: of each joint; none where it never rests
    /// - `cut`: what was cut off at the piece's ends [s]; a rest there goes on
    /// - `shortest`: least duration [s]
    pub(crate) fn add(&mut self, piece: &PreparedRun, speeds: &[Option<Speeds>], [cut, shortest]: [f64; 2]) {
        self.joints.resize(speeds.len(), Vec::new());
        let (Some(first), Some(last)) = (piece.times.first(), piece.times.last()) else { return };
        let widened = |[start, end]: Stretch| {
            [if start <= *first { start - cut } else { start }, if end >= *last { end + cut } else { end }]
        };
        let joints = self.joints.iter_mut().zip(&piece.velocities).zip(speeds);
        for ((rests, velocities), speeds) in joints {
            let Some(limit) = speeds.map(|speeds| speeds.limit()) else { continue };
            let slow = slow_stretches(&piece.times, velocities, limit).into_iter().map(widened);
            rests.extend(slow.filter(|[start, end]| end - start >= shortest));
        }
    }

    /// For each joint, which of the times are in a rest or a reversal, or nearer to one than the filter tells apart.
    pub(crate) fn at(&self, times: &[f64], bandwidth: f64) -> Vec<Vec<bool>> {
        let near = LOBE / bandwidth;
        let of_joint = |rests: &Vec<Stretch>| {
            let within = |t: &f64| rests.iter().any(|[start, end]| start - near <= *t && *t <= end + near);
            times.iter().map(within).collect()
        };
        self.joints.iter().map(of_joint).collect()
    }
}

/// First and last times of the stretches without a speed above the limit, and of steps over which the speed changes its sign.
fn slow_stretches(times: &[f64], velocities: &[f64], limit: f64) -> Vec<Stretch> {
    let mut stretches: Vec<Stretch> = Vec::new();
    let mut before: Option<(f64, f64)> = None;
    for (t, v) in times.iter().copied().zip(velocities.iter().copied()) {
        let start = match before {
            Some((last, other)) if v * other < 0.0 => Some(last),
            _ => (v.abs() <= limit).then_some(t),
        };
        if let Some(start) = start {
            let last = before.map(|(last, _)| last);
            match stretches.last_mut() {
                Some(stretch) if last == Some(stretch[1]) => stretch[1] = t,
                _ => stretches.push([start, t]),
            }
        }
        before = Some((t, v));
    }
    stretches
}

#[cfg(test)]
mod tests {
    use super::super::super::run::Effort;
    use super::*;

    /// Moves from 1 s to 4 s, with a reversal at 2.5 s, and rests before and after.
    fn piece() -> PreparedRun {
        let times: Vec<f64> = (0..=500).map(|i| 0.01 * f64::from(i)).collect();
        let speed = |t: &f64| if (1.0..=4.0).contains(t) { (2.5 - t).clamp(-1.0, 1.0) } else { 1e-4 };
        PreparedRun {
            name: "piece".into(),
            rows: (2..503).collect(),
            positions: vec![vec![0.0; 501]],
            poses: Vec::new(),
            velocities: vec![times.iter().map(speed).collect()],
            accelerations: vec![vec![0.0; 501]],
            efforts: vec![vec![0.0; 501]],
            resting: Vec::new(),
            effort: Effort::Joint,
            desired: None,
            times,
        }
    }

    #[test]
    fn rests_at_the_ends_and_a_reversal_are_found() {
        let mut rests = Rests::default();
        let speeds = Some(Speeds { largest: 1.0, noise: 1e-4 });
        rests.add(&piece(), &[speeds], [0.2, 0.0]);
        let times = [-0.1, 0.5, 1.15, 1.25, 2.25, 2.35, 2.65, 2.75, 3.75, 3.85, 4.5, 5.1];
        let resting = [true, true, true, false, false, true, true, false, false, true, true, true];
        assert_eq!(rests.at(&times, 5.0), [resting]);
        let mut long = Rests::default();
        long.add(&piece(), &[speeds], [0.2, 0.25]);
        assert_eq!(long.at(&[1.15, 2.5], 5.0), [[true, false]]);
        // Noise that hides the motion hides no speed above a tenth of the largest.
        let mut noisy = Rests::default();
        noisy.add(&piece(), &[Some(Speeds { largest: 1.0, noise: 1.0 })], [0.2, 0.0]);
        assert_eq!(noisy.at(&[2.34, 2.37], 20.0), [[false, true]]);
        // A reversal between two samples.
        assert_eq!(slow_stretches(&[0.0, 1.0, 2.0, 3.0], &[1.0, 0.5, -0.5, -1.0], 0.01), [[1.0, 2.0]]);
        let mut never = Rests::default();
        never.add(&piece(), &[None], [0.2, 0.0]);
        assert_eq!(never.at(&times, 5.0), [[false; 12]]);
    }
}
