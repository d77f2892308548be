//! What was found and chosen, in numbers and sentences.

use super::super::error::{IdentificationError, Result};
use super::super::robot::Robot;
use super::super::run::Effort;
use super::bandwidth::{from_positions, noise_share};
use super::channel::Channel;
use super::choice::{Recorded, USUAL};
use super::filter::Filter;
use super::grid::Piece;
use super::result::{Delay, JointPreparation, PreparationReport, VelocityCheck};
use super::signals::{Signals, Smoothed, Smoothing, is_too_short};

impl Recorded<'_> {
    pub(super) fn too_short(&self, how: &Smoothing) -> IdentificationError {
        let longest = self.signals.iter().flat_map(|s| self.pieces(s, how.bandwidth));
        let longest = longest.map(|p| p.duration()).fold(0.0, f64::max);
        IdentificationError::TooFewSamples {
            what: format!(
                "a filter of {:.3} Hz with {:.3} s cut off at both ends (a larger --bandwidth cuts off less; `PreparationSettings::cut` and `largest_gap` of the library)",
                how.bandwidth, how.cut
            ),
            needed: (2.0 * how.cut / self.step).ceil() as usize + 1,
            got: (longest / self.step) as usize,
        }
    }

    pub(super) fn report(
        &self,
        how: &Smoothing,
        delays: Vec<Delay>,
        smoothed: &[Smoothed],
    ) -> Result<PreparationReport> {
        let filter = Filter::new(how.bandwidth, how.step)?;
        let joints: Vec<JointPreparation> =
            (0..self.joints()).map(|j| self.joint(j, how, &delays, smoothed)).collect();
        let mut notes = self.notes(how);
        notes.extend(joints.iter().flat_map(remarks));
        notes.extend(self.held());
        notes.extend(late(&joints, |_| true));
        notes.extend(self.of_rests(smoothed));
        if how.step > 1.5 * self.step {
            let (fewer, all) = (1.0 / how.step, 1.0 / self.step);
            notes.push(format!("the filter leaves nothing above {:.3} Hz, so {fewer:.1} of {all:.1} samples a second are kept (a larger --bandwidth keeps more)", 2.0 * how.bandwidth));
        }
        Ok(PreparationReport { joints, delays, filter, sample_rate: 1.0 / how.step, notes })
    }

    fn name(&self, joint: usize) -> String {
        let names = self.robot.map(Robot::joint_names).unwrap_or_default();
        names.get(joint).cloned().unwrap_or_else(|| format!("joint {}", joint + 1))
    }

    fn joint(&self, j: usize, how: &Smoothing, delays: &[Delay], smoothed: &[Smoothed]) -> JointPreparation {
        let quality = &self.quality[j];
        let resolutions = self.signals.iter().map(|s| s.positions[j].resolution);
        let own = from_positions(&[quality], self.lowest(USUAL).min(self.highest()), self.highest());
        JointPreparation {
            name: self.name(j),
            noise: quality.noise,
            resolution: resolutions.fold(0.0, f64::max),
            hold: self.hold(|s| &s.positions[j]),
            moves: quality.moves,
            bandwidth: how.bandwidth,
            own_bandwidth: own,
            acceleration_noise: noise_share(quality, how.bandwidth),
            delay: delays.get(j).map_or(0.0, |d| d.removed),
            sample_rate: 1.0 / how.step,
            velocity: velocity_check(smoothed, j),
            fault: self.faults.get(j).cloned().flatten().filter(|_| !self.is_unmeasured(j)),
        }
    }

    /// Whether something else moves a joint: that its force is not known is no fault.
    fn is_unmeasured(&self, joint: usize) -> bool {
        self.robot.is_some_and(|robot| robot.unmeasured()[joint])
    }

    /// What was left out of each run.
    fn notes(&self, how: &Smoothing) -> Vec<String> {
        self.signals.iter().flat_map(|s| [self.of_pieces(s, how), self.of_positions(s)].concat()).collect()
    }

    fn of_pieces(&self, signals: &Signals, how: &Smoothing) -> Vec<String> {
        let name = &signals.name;
        let pieces = self.pieces(signals, how.bandwidth);
        if pieces.is_empty() {
            return vec![format!("{name} is left out: at no time do all its columns have values")];
        }
        let gap = |pair: &[Piece]| {
            let (pause, row) = (pair[1].start - pair[0].end, signals.row(pair[0].end));
            format!("{name} is split by the gap of {pause:.3} s after row {row}")
        };
        let short = pieces.iter().filter(|p| is_too_short(signals, p, how)).map(|p| {
            let (first, last) = (signals.row(p.start), signals.row(p.end));
            format!("{name}: rows {first} to {last} are left out; they last {:.3} s, less than the two ends of {:.3} s that are cut (a larger --bandwidth cuts off less)", p.duration(), how.cut)
        });
        pieces.windows(2).map(gap).chain(short).collect()
    }

    /// Signals that are new in a part of the rows only.
    fn held(&self) -> Vec<String> {
        let positions =
            (0..self.joints()).map(|j| (self.name(j), "position", self.hold(|s| &s.positions[j])));
        let robot = self.robot.filter(|_| self.signals[0].effort != Effort::Joint);
        let inputs = robot.map(Robot::input_names).unwrap_or_default();
        let name = |m: usize| inputs.get(m).cloned().unwrap_or_else(|| self.name(m));
        let efforts =
            (0..self.signals[0].efforts.len()).map(|m| (name(m), "effort", self.hold(|s| &s.efforts[m])));
        let held = positions.chain(efforts).filter(|(.., hold)| *hold > 1.2);
        let said = |(name, what, hold): (String, &str, f64)| {
            format!(
                "{name}: its {what} is new in one of {} rows only; the repeats are left out",
                (10.0 * hold).round() / 10.0
            )
        };
        held.map(said).collect()
    }

    /// Rows of the log for each new value of a channel, the most of all runs.
    fn hold(&self, channel: impl Fn(&Signals) -> &Channel) -> f64 {
        self.signals.iter().map(|signals| channel(signals).hold).fold(1.0, f64::max)
    }

    /// Which joints that move rest for a part of the time.
    fn of_rests(&self, smoothed: &[Smoothed]) -> Option<String> {
        let samples: usize = smoothed.iter().map(|s| s.run.times.len()).sum();
        let share = |joint: usize| {
            let rests = |s: &Smoothed| (0..s.run.times.len()).filter(|i| s.run.rests(joint, *i)).count();
            100.0 * smoothed.iter().map(rests).sum::<usize>() as f64 / samples.max(1) as f64
        };
        let moving =
            (0..self.joints()).filter(|joint| self.quality[*joint].moves && !self.is_unmeasured(*joint));
        let shares = moving.map(|joint| (joint, share(joint))).filter(|(_, share)| *share > 0.0);
        let named: Vec<String> =
            shares.map(|(joint, share)| format!("{} in {share:.0} %", self.name(joint))).collect();
        (!named.is_empty()).then(|| {
            format!(
                "at rest dry friction takes any value up to the static one, and efforts say nothing about it: the fit \
                 leaves out the samples in which a joint rests ({})",
                named.join(", ")
            )
        })
    }

    fn of_positions(&self, signals: &Signals) -> Vec<String> {
        let mut notes = Vec::new();
        for (j, channel) in signals.positions.iter().enumerate() {
            let (run, joint) = (&signals.name, self.name(j));
            if let Some(first) = channel.spikes.first() {
                let (count, row) = (channel.spikes.len(), signals.rows[*first]);
                notes.push(format!(
                    "{run}: {count} spikes of the position of {joint} are left out, the first in row {row}"
                ));
            }
            if channel.turns > 0 {
                let turns = channel.turns;
                notes.push(format!(
                    "{run}: {turns} jumps by a whole turn are taken out of the position of {joint}"
                ));
            }
        }
        notes
    }
}

/// What stands out in a joint's numbers.
fn remarks(joint: &JointPreparation) -> Vec<String> {
    let name = &joint.name;
    let mut remarks = Vec::new();
    if joint.moves && joint.acceleration_noise > 0.1 {
        remarks.push(format!(
            "{name}: {:.0} % of the power of its acceleration is noise; inertia comes out too small unless it moves faster (the filter is --bandwidth {:.3})",
            100.0 * joint.acceleration_noise, joint.bandwidth
        ));
    }
    if let Some(check) =
        joint.velocity.filter(|v| joint.moves && ((v.gain - 1.0).abs() > 0.1 || v.r_squared < 0.9))
    {
        remarks.push(format!(
            "{name}: its measured velocity is {:.3} times the derivative of its position, with R² {:.3}; check its unit and joint (it is not used)",
            check.gain, check.r_squared
        ));
    }
    remarks
}

/// What is said of delays that are removed: a sentence for the joints that share one.
///
/// - `is_told`: whether the delay of a joint with its number is told from none
fn late(joints: &[JointPreparation], is_told: impl Fn(usize) -> bool) -> Vec<String> {
    let mut groups: Vec<(String, f64, Vec<&str>)> = Vec::new();
    for (_, joint) in joints.iter().enumerate().filter(|(j, joint)| joint.delay != 0.0 && is_told(*j)) {
        let seconds = format!("{:.4}", joint.delay);
        match groups.iter_mut().find(|group| group.0 == seconds) {
            Some((.., names)) => names.push(&joint.name),
            None => groups.push((seconds, joint.delay, vec![&joint.name])),
        }
    }
    let said = |(seconds, delay, names): (String, f64, Vec<&str>)| {
        let order = if delay > 0.0 { "after" } else { "before" };
        let by = format!("{:.1} ms {order}", 1e3 * delay.abs());
        let what = match names.as_slice() {
            [name] => format!("{name}: its effort comes {by} its position"),
            all if all.len() == joints.len() => format!("the efforts of all joints come {by} the positions"),
            some => format!("{}: their efforts come {by} their positions", some.join(", ")),
        };
        format!("{what}; this delay is removed (--delay {seconds} says so, --delay 0 says otherwise)")
    };
    groups.into_iter().map(said).collect()
}

impl PreparationReport {
    /// Adds what the common estimate finds left of the delays. One that is not told from none stays unsaid.
    ///
    /// - `left`: of each effort with its standard error \[s\]; empty where delays are known
    pub(crate) fn refine(&mut self, left: &[[f64; 2]]) {
        if left.is_empty() {
            return;
        }
        let before = late(&self.joints, |_| true);
        for (delay, [left, error]) in self.delays.iter_mut().zip(left) {
            delay.removed += left;
            delay.error = *error;
        }
        for (joint, delay) in self.joints.iter_mut().zip(&self.delays) {
            joint.delay = delay.removed;
        }
        let is_told = |j: usize| self.delays.get(j).is_none_or(|d| d.removed.abs() > 2.0 * d.error);
        self.notes.retain(|note| !before.contains(note));
        self.notes.extend(late(&self.joints, is_told));
    }
}

fn velocity_check(smoothed: &[Smoothed], joint: usize) -> Option<VelocityCheck> {
    let (mut vv, mut mv, mut mm) = (0.0, 0.0, 0.0);
    for piece in smoothed {
        let measured = piece.velocities[joint].as_ref()?;
        let pairs = measured.iter().zip(&piece.run.velocities[joint]);
        for (m, v) in pairs.filter(|(m, _)| m.is_finite()) {
            vv += v * v;
            mv += m * v;
            mm += m * m;
        }
    }
    let gain = mv / vv;
    gain.is_finite()
        .then(|| VelocityCheck { gain, r_squared: if mm > 0.0 { mv * mv / (vv * mm) } else { 0.0 } })
}
