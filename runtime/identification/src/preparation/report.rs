//! Report of the preparation: statistics and findings.

use super::super::error::{IdentificationError, Result};
use super::super::methods::filter::Band;
use super::super::numeric::statistics::extremes;
use super::super::robot::Robot;
use super::super::run::Effort;
use super::bandwidth::noise_share;
use super::channel::Channel;
use super::choice::Recorded;
use super::grid::Piece;
use super::result::{Delay, JointPreparation, PreparationReport};
use super::settings::PreparationSettings;
use super::signals::{Signals, Smoothed, Smoothing, is_too_short};
use gelenk_findings::{Finding, Rule, Subject};

/// Sees: a run with pauses that are too long for interpolation, or a run without any time at which all columns have values.
/// Matters: the run is split there, and its pieces lose their ends.
/// Example: a bag that lost messages for 50 ms.
/// Fixture: `dropouts` in `codegen/tests/findings/arm.rs`.
const GAPS: Rule = Rule::note("gaps");

/// Sees: pieces of a run that are shorter than the filter needs.
/// Matters: these pieces are not used.
/// Example: 0.2 s between two gaps, and a filter of 5 Hz.
/// Fixture: `dropouts` in `codegen/tests/findings/arm.rs`.
const SHORT_PIECES: Rule = Rule::note("short-pieces");

/// Sees: samples in which a joint rests.
/// Matters: at rest, dry friction can have any value up to the static friction. The fit does not use these samples.
/// Example: a joint that waits for the others.
/// Fixture: the tests of `preparation/rest.rs`.
const RESTS: Rule = Rule::note("rests");

/// Sees: single positions that no motion explains.
/// Matters: these positions are not used.
/// Example: a bit that flips in an encoder.
/// Fixture: `spikes` in `codegen/tests/findings/arm.rs`.
const SPIKES: Rule = Rule::note("position-spikes");

/// Sees: an acceleration of which a tenth or more is noise.
/// Matters: the estimated inertia is too small.
/// Example: a coarse encoder and a slow motion.
/// Fixture: `short` in `codegen/tests/findings/arm.rs`.
const NOISY: Rule = Rule::note("noisy-acceleration");

/// Sees: a position or an effort that changes in only a part of the rows.
/// Matters: repeated values are not measurements. They are not used.
/// Example: efforts at 10 Hz in a log of 250 Hz.
/// Fixture: `held` in `codegen/tests/findings/arm.rs`.
const HELD: Rule = Rule::note("held-signal");

/// Sees: efforts that come later or earlier than the positions.
/// Matters: this delay is removed.
/// Example: efforts that are 15 ms late, because a drive averages them.
/// Fixture: `late` in `codegen/tests/findings/arm.rs`.
const DELAY: Rule = Rule::note("delay-removed");

/// Sees: efforts that the motion explains better if a low-pass filter is assumed.
/// Matters: the filter has smoothed friction at reversals. Positions and terms of friction pass the same filter.
/// Example: efforts that a script smoothed at 4 Hz.
/// Fixture: `low_passed` in `codegen/tests/findings/arm.rs`.
const LOW_PASSED: Rule = Rule::warning("efforts-low-passed");

fn low_passed(band: Band) -> Finding {
    let Band { frequency, order } = band;
    let message = format!(
        "the efforts seem to have passed a low-pass filter of {frequency:.3} Hz and order {order}, but the positions do not. The \
         same filter is applied to the positions and the friction terms"
    );
    let help =
        "record efforts without a filter. With `--bandwidth`, no low-pass filter of the efforts is assumed";
    LOW_PASSED.found(message).help(help)
}

impl Recorded<'_> {
    pub(super) fn too_short(&self, how: &Smoothing) -> IdentificationError {
        let longest = self.signals.iter().flat_map(|s| self.pieces(s, how.bandwidth));
        let longest = longest.map(|p| p.duration()).fold(0.0, f64::max);
        IdentificationError::TooFewSamples {
            what: format!(
                "a filter of {:.3} Hz that cuts off {:.3} s at both ends (a larger `--bandwidth` cuts off less; in the library, \
                 set `PreparationSettings::cut` and `largest_gap`)",
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
        let filter = how.filter()?;
        let joints: Vec<JointPreparation> = (0..self.joints()).map(|j| self.joint(j, how, &delays)).collect();
        let of_run = |s: &Signals| [self.of_pieces(s, how), self.of_positions(s)].concat();
        let mut findings: Vec<Finding> = self.signals.iter().flat_map(of_run).collect();
        findings.extend(joints.iter().filter_map(noisy));
        findings.extend(self.held());
        // Findings about efforts of joints are in the report of the joint.
        findings.extend((self.joints()..self.efforts()).filter_map(|effort| self.fault(effort)));
        findings.extend(how.band.map(low_passed));
        findings.extend(delay_findings(&joints, |_| true));
        findings.extend(self.of_rests(smoothed));
        Ok(PreparationReport { joints, delays, filter, sample_rate: 1.0 / how.step, findings })
    }

    fn name(&self, joint: usize) -> String {
        let names = self.robot.map(Robot::joint_names).unwrap_or_default();
        names.get(joint).cloned().unwrap_or_else(|| format!("joint {}", joint + 1))
    }

    fn joint(&self, j: usize, how: &Smoothing, delays: &[Delay]) -> JointPreparation {
        let quality = &self.quality[j];
        let resolutions = self.signals.iter().map(|s| s.positions[j].resolution);
        JointPreparation {
            name: self.name(j),
            noise: quality.noise,
            resolution: resolutions.fold(0.0, f64::max),
            moves: quality.moves,
            bandwidth: how.bandwidth,
            acceleration_noise: noise_share(quality, how.bandwidth),
            delay: delays.get(j).map_or(0.0, |d| d.removed),
            fault: self.fault(j),
        }
    }

    /// Returns the reason why the effort with index `j` cannot be used; `None` if it can be used.
    fn fault(&self, j: usize) -> Option<Finding> {
        let fault = self.faults.get(j).cloned().flatten()?;
        let is_of_input = self.signals[0].effort != Effort::Joint;
        (is_of_input || !self.is_unmeasured(j)).then(|| fault.of(self.subject(j)))
    }

    /// Returns the joint or the input to which an effort belongs.
    fn subject(&self, effort: usize) -> Subject {
        let robot = self.robot.filter(|_| self.signals[0].effort != Effort::Joint);
        let input = robot.and_then(|robot| robot.input_names().into_iter().nth(effort));
        input.map_or_else(|| Subject::Joint(self.name(effort)), Subject::Input)
    }

    /// Returns whether the joint is moved from outside. A missing effort of this joint is not a fault.
    fn is_unmeasured(&self, joint: usize) -> bool {
        self.robot.is_some_and(|robot| robot.unmeasured()[joint])
    }

    fn of_pieces(&self, signals: &Signals, how: &Smoothing) -> Vec<Finding> {
        let pieces = self.pieces(signals, how.bandwidth);
        let about = |rule: Rule, message: String| rule.found(message).log(&signals.name, None);
        if pieces.is_empty() {
            return vec![about(
                GAPS,
                "it is left out, because there is no time at which all its columns have values".into(),
            )];
        }
        let short: Vec<&Piece> = pieces.iter().filter(|p| is_too_short(signals, p, how)).collect();
        let longest = short.iter().map(|p| p.duration()).fold(0.0, f64::max);
        let short = short.first().map(|first| {
            let (count, row) = (short.len(), signals.row(first.start));
            let reason = format!("because the filter cuts off {:.3} s at each end", how.cut);
            let message = match count {
                1 => format!("1 piece of {longest:.3} s is left out, {reason}. It begins in row {row}"),
                _ => format!(
                    "{count} pieces of up to {longest:.3} s are left out, {reason}. The first begins in row {row}"
                ),
            };
            about(SHORT_PIECES, message).help("use a larger --bandwidth, which cuts off less")
        });
        let pauses: Vec<f64> = pieces.windows(2).map(|pair| pair[1].start - pair[0].end).collect();
        let gaps = pieces.first().filter(|_| !pauses.is_empty()).map(|first| {
            let row = signals.row(first.end);
            let [least, most] = extremes(pauses.iter().copied()).map(|pause| format!("{pause:.3}"));
            let size = if least == most { least } else { format!("{least} to {most}") };
            about(
                GAPS,
                match pauses.len() {
                    1 => format!("it is split at 1 gap of {size} s after row {row}"),
                    count => format!("it is split at {count} gaps of {size} s. The first is after row {row}"),
                },
            )
        });
        gaps.into_iter().chain(short).collect()
    }

    /// Returns findings about signals that have a new value only in a part of the rows.
    fn held(&self) -> Vec<Finding> {
        let joint = |j: usize| Subject::Joint(self.name(j));
        let positions = (0..self.joints()).map(|j| (joint(j), "position", self.hold(|s| &s.positions[j])));
        let efforts = 0..self.signals[0].efforts.len();
        let efforts = efforts.map(|m| (self.subject(m), "effort", self.hold(|s| &s.efforts[m])));
        let held = positions.chain(efforts).filter(|(.., hold)| *hold > 1.2);
        let finding = |(subject, what, hold): (Subject, &str, f64)| {
            let message = format!(
                "its {what} has a new value only in one of {hold:.1} rows. The repeated values are left out"
            );
            HELD.found(message).of(subject).with("rows for each value", hold, "")
        };
        held.map(finding).collect()
    }

    /// Returns the mean number of log rows for each new value of a channel, in the run with the largest number.
    fn hold(&self, channel: impl Fn(&Signals) -> &Channel) -> f64 {
        self.signals.iter().map(|signals| channel(signals).hold).fold(1.0, f64::max)
    }

    /// Returns the finding about the moving joints that rest for a part of the time, with the share of each joint.
    fn of_rests(&self, smoothed: &[Smoothed]) -> Option<Finding> {
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
            RESTS.found(format!(
                "the fit leaves out the samples in which a joint rests: {}. At rest, dry friction can have any value up to the \
                 static friction",
                named.join(", ")
            ))
        })
    }

    fn of_positions(&self, signals: &Signals) -> Vec<Finding> {
        let of = |(j, channel): (usize, &Channel)| {
            let first = channel.spikes.first()?;
            let (count, row) = (channel.spikes.len(), signals.rows[*first]);
            let message = match count {
                1 => format!("1 spike of its position is left out. It is in row {row}"),
                _ => format!("{count} spikes of its position are left out. The first is in row {row}"),
            };
            Some(SPIKES.found(message).log(&signals.name, None).joint(self.name(j)))
        };
        signals.positions.iter().enumerate().filter_map(of).collect()
    }
}

/// Returns the finding about a joint with a noisy acceleration.
fn noisy(joint: &JointPreparation) -> Option<Finding> {
    (joint.moves && joint.acceleration_noise > 0.1).then(|| {
        let message = format!(
            "{:.0} % of the power of its acceleration is noise, so the estimated inertia is too small",
            100.0 * joint.acceleration_noise
        );
        let remedy =
            format!("move the joint faster, or use a smaller `--bandwidth` than {:.3} Hz", joint.bandwidth);
        NOISY.found(message).help(remedy).joint(&joint.name)
    })
}

/// Returns findings about removed delays. All joints with the same delay share one finding.
///
/// - `is_significant`: function that returns whether the delay of the joint with this index differs significantly from zero
fn delay_findings(joints: &[JointPreparation], is_significant: impl Fn(usize) -> bool) -> Vec<Finding> {
    let mut groups: Vec<(String, f64, Vec<&str>)> = Vec::new();
    // Findings state delays in tenths of a millisecond.
    let is_found = |(j, joint): &(usize, &JointPreparation)| joint.delay.abs() >= 5e-5 && is_significant(*j);
    for (_, joint) in joints.iter().enumerate().filter(is_found) {
        let seconds = format!("{:.4}", joint.delay);
        match groups.iter_mut().find(|group| group.0 == seconds) {
            Some((.., names)) => names.push(&joint.name),
            None => groups.push((seconds, joint.delay, vec![&joint.name])),
        }
    }
    let finding = |(seconds, delay, names): (String, f64, Vec<&str>)| {
        let order = if delay > 0.0 { "after" } else { "before" };
        let by = format!("{:.1} ms {order}", 1e3 * delay.abs());
        let of = if names.len() == joints.len() { "all joints".to_owned() } else { names.join(", ") };
        let found = match names.as_slice() {
            [name] => {
                DELAY.found(format!("its effort comes {by} its position. This delay is removed")).joint(*name)
            }
            _ => DELAY.found(format!("the efforts of {of} come {by} the positions. This delay is removed")),
        };
        let remedy = format!("`--delay {seconds}` sets this delay. `--delay 0` keeps the efforts unshifted");
        found.with("delay", delay, "s").help(remedy)
    };
    groups.into_iter().map(finding).collect()
}

impl PreparationReport {
    /// Returns settings that prepare other runs in the same way.
    pub(crate) fn settings_alike(&self, settings: &PreparationSettings) -> PreparationSettings {
        let joint = self.joints.first();
        PreparationSettings {
            bandwidth: joint.map(|joint| joint.bandwidth),
            rate: joint.map(|_| self.sample_rate),
            delay: joint.map(|joint| joint.delay),
            ..settings.clone()
        }
    }

    /// Adds the remaining delays that the common estimate found. A delay that is not significant gives no finding.
    ///
    /// - `left`: remaining delay of each effort and its standard error, in s; empty if the delays are known
    pub(crate) fn refine(&mut self, left: &[[f64; 2]]) {
        if left.is_empty() {
            return;
        }
        for (delay, [left, error]) in self.delays.iter_mut().zip(left) {
            delay.removed += left;
            delay.error = *error;
        }
        for (joint, delay) in self.joints.iter_mut().zip(&self.delays) {
            joint.delay = delay.removed;
        }
        let is_significant = |j: usize| self.delays.get(j).is_none_or(|d| d.removed.abs() > 2.0 * d.error);
        let found = delay_findings(&self.joints, is_significant);
        self.findings.retain(|finding| finding.code != DELAY.code);
        self.findings.extend(found);
    }
}
