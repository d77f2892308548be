//! Table of hypotheses about faults of the log or of the description. Each row is a kind of change that may explain the efforts
//! better, for example another sign of an effort. Another fit tests each change. A change is offered as a remedy only if it
//! lowers the error on held-out data clearly ([`Case::offered`]).

use super::super::error::Result;
use super::checks::Checked;
use super::factors;
use super::layout::{ARMATURE, LOAD};
use super::levels;
use super::orders;
use super::result::Gravity;
use super::springs;
use super::tilt;
use super::trial::{Bodies, Case, Change, FALL, Hypothesis};
use super::unit;
use gelenk_findings::{Finding, Rule, Severity};

/// Sees: efforts of a joint that fit the rigid body better with the other sign.
/// Matters: friction would drive the joint, and its masses would be wrong.
/// Example: a torque whose positive direction is opposite to that of the position.
/// Fixture: `sign` in `codegen/tests/findings/arm.rs`.
const OTHER_SIGN: Rule = Rule::error("other-sign");

/// Sees: friction that drives a joint, and a rigid body that does not fit better with the other sign.
/// Matters: such a law is not passive.
/// Example: a controller that compensates more friction than there is.
/// Fixture: `estimation/tests/pendulum.rs`.
const DRIVING: Rule = Rule::error("driving-friction");

/// Sees: a log with too few samples to distinguish friction from noise.
/// Matters: a wrong sign cannot be detected.
/// Example: 2 s of slow motion.
/// Fixture: `a_wrong_sign_and_forces_that_are_noise_are_refused` in `estimation/tests/simulated.rs`.
const TOO_SHORT: Rule = Rule::error("log-too-short");

/// Sees: efforts that fit better without gravity, or with gravity although the settings say that it is compensated.
/// Matters: the masses are wrong.
/// Example: a driver that reports torques without the weight, as UR's ROS 2 driver does.
/// Fixture: `without_gravity` in `codegen/tests/findings/arm.rs`.
const GRAVITY: Rule = Rule::error("other-gravity");

/// Sees: an effort that comes later or earlier than `--delay` says.
/// Matters: the delay causes errors of inertia and friction.
/// Example: `--delay 0` with efforts that are 50 ms early.
/// Fixture: `efforts_that_come_early_are_moved` in `codegen/tests/external_arm/main.rs`.
const DELAY: Rule = Rule::warning("other-delay");

/// Sees: load-dependent friction of a gear.
/// Matters: a law of the velocity alone is wrong under other loads.
/// Example: a worm gear.
/// Fixture: `friction_under_load_is_identified_where_it_is_asked_for` in `codegen/tests/command_line/identify.rs`.
const UNDER_LOAD: Rule = Rule::warning("friction-under-load");

/// Hypothesis with the entries that most rows of the table share.
const USUAL: Hypothesis = Hypothesis {
    rule: OTHER_SIGN,
    when: |_, _| true,
    changes: |_| Ok(Vec::new()),
    bodies: Bodies::Fitted,
    rival: |_| None,
    accepts: |_, _| true,
    each: false,
    is_alone: false,
    finding: |_, _, _| Ok(None),
};

const SIGNS: Hypothesis =
    Hypothesis { rule: OTHER_SIGN, changes: signs, each: true, finding: other_sign, ..USUAL };

const TABLE: [Hypothesis; 7] = [
    Hypothesis {
        rule: GRAVITY,
        changes: |case| Ok(vec![Change::Gravity(Gravity::of(!is_compensated(case)))]),
        bodies: Bodies::Described,
        // If described bodies are too heavy or efforts are in a larger unit, the data are also better explained without gravity.
        rival: |case| case.ratio.map(|ratio| Change::Factor(None, 1.0 / ratio.factor())),
        finding: other_gravity,
        ..USUAL
    },
    Hypothesis { rule: tilt::TILT, changes: |case| Ok(tilt::tilts(case)), finding: tilt::finding, ..USUAL },
    Hypothesis {
        rule: factors::OTHER_FACTOR,
        when: |case, doubts| doubts.is_empty() && case.too_short().is_none(),
        changes: factors::factors,
        bodies: Bodies::Unbounded,
        accepts: factors::explains,
        finding: factors::finding,
        ..USUAL
    },
    Hypothesis {
        rule: orders::ORDER,
        when: |case, doubts| (!doubts.is_empty() || case.has_other_unit()) && case.too_short().is_none(),
        changes: orders::orders,
        bodies: Bodies::Described,
        is_alone: true,
        finding: orders::finding,
        ..USUAL
    },
    Hypothesis {
        rule: springs::SPRING,
        when: |case, doubts| !doubts.iter().any(is_refusal) && case.too_short().is_none(),
        changes: springs::springs,
        bodies: Bodies::Unbounded,
        is_alone: true,
        finding: springs::finding,
        ..USUAL
    },
    Hypothesis { rule: DELAY, changes: delays, each: true, finding: other_delay, ..USUAL },
    Hypothesis { rule: UNDER_LOAD, changes: loads, finding: under_load, ..USUAL },
];

/// Hypothesis that all efforts are in another unit. Its finding is only a part of the finding about the ratio of estimated to
/// described forces.
const UNITS: Hypothesis = Hypothesis {
    rule: unit::COMMON_FACTOR,
    changes: units,
    bodies: Bodies::Described,
    finding: other_unit,
    ..USUAL
};

/// Whether a finding refuses the fit of its joint or of the whole robot.
pub(super) fn is_refusal(doubt: &Finding) -> bool {
    doubt.severity == Severity::Error
}

/// Decrease of the held-out error by the change that a finding offers, in percent.
fn fall(doubt: &Finding) -> f64 {
    doubt.value(FALL).unwrap_or(0.0)
}

impl Case<'_> {
    /// Tries the hypotheses of all rows of the table, and returns the findings about the changes that are offered.
    pub(super) fn doubts(&self) -> Result<Vec<Finding>> {
        let mut doubts = self.signs()?;
        for row in &TABLE {
            if !(row.when)(self, &doubts) {
                continue;
            }
            let most = doubts.iter().map(fall).fold(0.0, f64::max);
            let mut found = self.offered(row)?;
            found.retain(|doubt| !row.is_alone || fall(doubt) > most);
            if row.is_alone && !found.is_empty() {
                doubts.clear();
            }
            doubts.extend(found);
        }
        Ok(doubts)
    }

    /// Doubts about the sign of each joint's effort.
    pub(super) fn signs(&self) -> Result<Vec<Finding>> {
        let mut doubts = self.offered(&SIGNS)?;
        for joint in self.layout().rubbing().filter(|joint| self.drives(*joint)) {
            let driving = driving().of(self.robot.subject(joint));
            if doubts.iter().all(|doubt| doubt.about != driving.about) {
                doubts.push(driving);
            }
        }
        let short = self.too_short();
        let said = |doubt: Finding| match &short {
            Some(short) => short.clone().of(doubt.about.subject),
            None => doubt,
        };
        Ok(doubts.into_iter().map(said).collect())
    }

    /// The finding that all efforts are in another unit; `None` if the described bodies do not explain the efforts better in
    /// any other unit.
    pub(super) fn unit(&self) -> Result<Option<Finding>> {
        Ok(self.offered(&UNITS)?.pop())
    }

    /// Finding that replaces a doubt about a sign if there are too few samples to distinguish friction from noise; `None` if
    /// there are enough samples. The criterion is the number of samples, because a wrong sign makes the correlation time of the
    /// residuals long.
    fn too_short(&self) -> Option<Finding> {
        let task = self.checked?.task;
        let samples: usize = task.runs.iter().map(|run| run.times.len()).sum();
        (samples < levels::FEWEST_SAMPLES.get()).then(|| {
            let message = format!(
                "the log is too short: {samples} samples are left after the filter, and friction cannot be distinguished from noise"
            );
            TOO_SHORT.found(message).help("record a motion of 10 s or more")
        })
    }

    /// Whether the estimated rigid-body forces of a joint or of the robot are several times the described forces, or a fraction
    /// of the described forces.
    fn has_other_unit(&self) -> bool {
        self.ratio.is_some_and(unit::CommonRatio::is_other)
            || self.checked.is_some_and(Checked::has_other_unit)
    }

    /// Whether the estimated friction τ(v) drives the joint noticeably: `Σ v τ(v)` is clearly negative.
    fn drives(&self, joint: usize) -> bool {
        let (layout, chosen) = (self.layout(), self.chosen);
        let products = &chosen.centred.all[joint];
        let first = layout.first_term(joint);
        let term =
            |term: usize| chosen.values.unknowns[layout.term(joint, term)] * products[(first, first + term)];
        let power: f64 = (0..ARMATURE).chain(LOAD..layout.terms).map(term).sum();
        let last = products.nrows() - 1;
        let scale =
            chosen.values.gains[joint].abs() * (products[(first, first)] * products[(last, last)]).sqrt();
        power < -levels::NOTICEABLE_POWER.get() * scale
    }
}

/// Whether a finding says that friction drives a joint and that no remedy is known.
pub(super) fn is_driving(finding: &Finding) -> bool {
    finding.code == DRIVING.code
}

fn driving() -> Finding {
    let message = "its estimated friction drives it instead of braking it. With the other sign of its effort, friction would brake, but the \
                   fit would not be better";
    let remedy = "check the sign, the unit and the assignment of its columns, and whether the robot's controller compensates friction";
    DRIVING.found(message).help(remedy)
}

/// For each effort that is hardly explained or whose estimated friction drives the joint, the change to the other sign.
fn signs(case: &Case) -> Result<Vec<Change>> {
    let r_squared = case.chosen.centred_r_squared(&case.own(Bodies::Fitted).rss);
    let is_doubted = |joint: &usize| case.drives(*joint) || r_squared[*joint] < levels::POOR.get();
    Ok(case.layout().rubbing().filter(is_doubted).map(|joint| Change::Factor(Some(joint), -1.0)).collect())
}

fn other_sign(_: &Case, _: &Change, rule: &Rule) -> Result<Option<Finding>> {
    Ok(Some(rule.found("the data are explained better with the other sign of its effort").help(
        "check the signs of effort and position. To change the sign of all efforts, use --columns 'torque=tau{}[-1 Nm]'; to change \
         one sign, use --columns 'torque=tau1|tau2[-1 Nm]|tau3'",
    )))
}

/// Whether the robot compensates gravity outside the efforts, as the settings say.
fn is_compensated(case: &Case) -> bool {
    case.checked.is_some_and(|checked| checked.task.settings.gravity_compensated)
}

fn other_gravity(case: &Case, _: &Change, rule: &Rule) -> Result<Option<Finding>> {
    let (what, remedy) = if case.layout().exact.contains(&true) {
        (
            "without",
            "check that the vertical axis of the log is that of the description, and check the order of the quaternion's entries",
        )
    } else if is_compensated(case) {
        ("with", "leave out --gravity-compensated: the efforts seem to contain the weight")
    } else {
        (
            "without",
            "use --gravity-compensated if the robot compensates gravity outside the recorded efforts. If it is not mounted as \
             described, for example on a wall or a ceiling, set `gravity = [x, y, z]`",
        )
    };
    Ok(Some(rule.found(format!("the data are explained better {what} gravity")).help(remedy)))
}

/// Further delays that the residuals show, if the settings state the delays. Delays that are not stated are unknowns of the
/// fit.
fn delays(case: &Case) -> Result<Vec<Change>> {
    let Some(checked) = case.checked.filter(|checked| checked.task.layout.delays.is_empty()) else {
        return Ok(Vec::new());
    };
    let delay = |joint: usize| checked.delay(joint).map(|seconds| Change::Delay(joint, seconds));
    Ok(case.layout().rubbing().filter_map(delay).collect())
}

fn other_delay(_: &Case, change: &Change, rule: &Rule) -> Result<Option<Finding>> {
    let Change::Delay(_, seconds) = change else { return Ok(None) };
    let way = if *seconds > 0.0 { "later" } else { "earlier" };
    let message = format!(
        "its effort is {:.1} ms {way} relative to its position than the stated delay says",
        1e3 * seconds.abs()
    );
    let remedy =
        "leave --delay out, or give the whole delay with --delay SECONDS (positive if efforts are late)";
    Ok(Some(rule.found(message).with("delay", *seconds, "s").help(remedy)))
}

/// Load-dependent friction of the joints whose residuals show such friction.
fn loads(case: &Case) -> Result<Vec<Change>> {
    let Some(checked) = case.checked else { return Ok(Vec::new()) };
    let joints = case.layout().rubbing().filter(|joint| checked.rubs_under_load(*joint));
    let joints: Vec<usize> = joints.collect();
    Ok((!joints.is_empty()).then_some(Change::Load(joints)).into_iter().collect())
}

fn under_load(case: &Case, change: &Change, rule: &Rule) -> Result<Option<Finding>> {
    let (Change::Load(joints), Some(data)) = (change, case.data(change)?) else { return Ok(None) };
    let solved = case.changed(change, Some(&data)).solved(&data.prior)?;
    let share = |joint: &usize| solved.values.unknowns[data.layout.term(*joint, LOAD)];
    let names = case.robot.joint_names();
    let said: Vec<String> = joints.iter().map(|j| format!("{:.2} at {}", share(j), names[*j])).collect();
    let message = format!(
        "friction grows with the load of the gear; the ratio of friction to load is about {}",
        said.join(", ")
    );
    // Other shares cannot exist.
    let can_exist = joints.iter().map(share).all(|share| share > 0.0 && share < 1.0);
    let finding = rule.found(message).with("share of the load", share(&joints[0]), "");
    Ok(can_exist.then(|| finding.help("use --load-friction")))
}

fn units(case: &Case) -> Result<Vec<Change>> {
    Ok(case.ratio.iter().flat_map(|ratio| ratio.units()).map(Change::Unit).collect())
}

fn other_unit(case: &Case, change: &Change, rule: &Rule) -> Result<Option<Finding>> {
    let Change::Unit(name) = change else { return Ok(None) };
    Ok(case.ratio.map(|ratio| ratio.finding(Some(name), rule)))
}
