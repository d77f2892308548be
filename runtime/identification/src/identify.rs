//! Identification of a robot from its logs in one call.

use super::doubts::limits::beyond;
use super::doubts::written::{self, Written};
use super::error::{IdentificationError, Result};
use super::estimation::{Estimate, EstimationSettings, JointEstimate, estimate, repeated_motions};
use super::friction::joint_samples::JointSamples;
use super::friction::{FrictionIdentification, FrictionMethod, FrictionReport};
use super::log::{ColumnOptions, Recording, runs_noting};
use super::methods::stribeck::StribeckRegression;
use super::preparation::{Delay, PreparationReport, PreparationSettings, prepare_all};
use super::result::FrictionTerm;
use super::robot::JointTerm;
use super::robot::{Robot, require_no_quaternions};
use super::run::PreparedRun;
use super::shafts::{RobotRows, ShaftRows};
use gelenk_findings::{Finding, Rule, Severity, distinct};
use std::path::PathBuf;

/// Sees: a friction law that is refused or cannot be fitted.
/// Matters: the described friction stays.
/// Example: a joint that moved too slowly.
/// Fixture: `codegen/tests/identified_friction.rs`.
const NO_LAW: Rule = Rule::warning("no-friction-law");

/// Sees: a law in which no term differs from 0 by more than its standard error.
/// Matters: the data do not show friction, and no law is written.
/// Example: a direct drive without friction.
/// Fixture: `friction/tests.rs`.
const NOTHING_LEFT: Rule = Rule::error("no-friction");

/// Sees: data to which no law can be fitted.
/// Matters: the described friction stays.
/// Example: a constant velocity.
/// Fixture: `constant_logs` in `runtime/tests/identification_bad_input.rs`.
const NO_FIT: Rule = Rule::error("no-friction-fit");

/// Settings of an identification. The defaults suit a log about which nothing is known.
#[derive(Debug, Clone)]
pub struct IdentificationSettings {
    /// Assignment and units of the columns of a log.
    pub columns: ColumnOptions,
    /// Settings of resampling, filter and delay.
    pub preparation: PreparationSettings,
    /// Settings of the estimate of inertia, friction, offsets and gains in one fit.
    pub estimation: EstimationSettings,
    /// Settings of the friction laws.
    pub friction: FrictionIdentification,
    /// Whether friction laws that would be refused are accepted. The reasons for the refusal then become warnings.
    pub accept_poor: bool,
}

impl IdentificationSettings {
    /// Returns the default settings.
    ///
    /// # Errors
    /// The call fails if the default library of friction terms is invalid, which does not happen.
    pub fn new() -> Result<Self> {
        Ok(Self {
            columns: ColumnOptions::default(),
            preparation: PreparationSettings::default(),
            estimation: EstimationSettings::default(),
            friction: FrictionIdentification {
                method: FrictionMethod::Ladder(StribeckRegression {
                    // Eight starts take 1.33 s of CPU for a log that takes 1.1 s with four. If a worse minimum is found, the
                    // law of chosen terms is kept.
                    starts: 4,
                    ..StribeckRegression::default()
                }),
                ..FrictionIdentification::new()?
            },
            accept_poor: false,
        })
    }
}

/// Result of an identification, with its data.
#[derive(Debug, Clone)]
pub struct Identification {
    /// The logs as they were read, before the preparation.
    pub recording: Recording,
    /// Report on the preparation of the signals.
    pub preparation: PreparationReport,
    /// The signals from which the estimate was made; empty if it was made from moments (the sums of [`crate::fleet`]).
    pub runs: Vec<PreparedRun>,
    /// Estimate of inertia, friction, offsets and gains.
    pub estimate: Estimate,
    /// Friction laws of the joints that moved.
    pub friction: Vec<JointFriction>,
    /// The rows of the equations in which shafts of drives replace joints; `None` if no shaft replaces a joint. In the row of a
    /// shaft, positions and velocities are those of the shaft, and efforts are those of the shaft's motor.
    pub(crate) shafts: Option<ShaftRows>,
}

impl Identification {
    /// Returns the robot with the same rows of equations and the same order of parameters as the estimate. In some rows, the
    /// shaft of a drive replaces a joint ([`Robot::shafts`]).
    ///
    /// - `robot`: the identified robot
    #[must_use]
    pub fn rows<'a>(&'a self, robot: &'a dyn Robot) -> impl Robot + 'a {
        RobotRows::new(robot, self.shafts.clone())
    }

    /// Returns the name of the drive whose shaft has this row of the equations; `None` if the row is that of a joint.
    #[must_use]
    pub fn shaft(&self, row: usize) -> Option<&str> {
        self.shafts.as_ref()?.shaft(row).map(|shaft| shaft.name.as_str())
    }

    /// Returns the report on the friction law of the joint or shaft that has this row of the equations; `None` if there is no
    /// law.
    #[must_use]
    pub fn law(&self, row: usize) -> Option<&FrictionReport> {
        let of_row = self.friction.iter().find(|friction| friction.joint == row);
        of_row.and_then(|friction| friction.report.as_ref().ok())
    }

    /// Returns the described friction terms of the joints that shafts of drives replace in the equations, with their estimated
    /// factors; `None` if no shaft replaces a joint.
    #[must_use]
    pub fn joint_terms(&self) -> Option<Vec<(&JointTerm, f64)>> {
        let rows = self.shafts.as_ref()?;
        let factors = self.estimate.parameters.iter().skip(rows.first_term()).map(|factor| factor.value);
        Some(rows.joint_terms().iter().zip(factors).collect())
    }
}

/// Friction of a joint, or of a shaft that replaces the joint in the equations.
#[derive(Debug, Clone)]
pub struct JointFriction {
    /// Index of the joint, or of the joint that the shaft replaces.
    pub joint: usize,
    /// Name of the joint, or of the drive whose shaft replaces the joint.
    pub name: String,
    /// Velocities ẏ [rad/s or m/s] at the samples in which the joint does not rest, of all runs.
    pub velocities: Vec<f64>,
    /// Measured forces minus the estimated rigid-body forces and load-dependent friction, at the samples in
    /// which the joint does not rest [N·m or N]. The differences contain the other friction, the offset and
    /// the error.
    pub torques: Vec<f64>,
    /// Friction law with its report, or the findings because of which there is no law.
    pub report: std::result::Result<FrictionReport, Vec<Finding>>,
}

/// Reads logs of a robot, prepares their signals (resampling, filter, delay), estimates inertia and friction in one fit, and
/// chooses the terms of each joint's friction law.
///
/// - `progress`: receives a sentence at each step
///
/// # Errors
/// The call fails if
/// - logs cannot be read or do not match the robot's joints,
/// - signals are too short or far beyond described limits, or
/// - the estimate is refused ([`estimate()`] lists the reasons).
///
/// An error after the first finding is [`IdentificationError::After`], which holds the earlier findings. A joint without a
/// friction law is not an error ([`JointFriction::report`]).
pub fn identify(
    robot: &dyn Robot,
    logs: &[PathBuf],
    settings: &IdentificationSettings,
    progress: &mut dyn FnMut(&str),
) -> Result<Identification> {
    let mut noted = Vec::new();
    identified(robot, logs, settings, &mut noted, progress).map_err(|error| error.after(noted))
}

/// Identifies as [`identify`] does, but without adding the earlier findings to errors.
///
/// - `noted`: receives the findings that precede an error
fn identified(
    robot: &dyn Robot,
    logs: &[PathBuf],
    settings: &IdentificationSettings,
    noted: &mut Vec<Finding>,
    progress: &mut dyn FnMut(&str),
) -> Result<Identification> {
    let (recording, prepared, mut preparation) = read_and_prepare(robot, logs, settings, noted, progress)?;
    let beyond = beyond_limits(robot, &recording, &prepared, settings.accept_poor)?;
    let rows = RobotRows::of(robot);
    let (joints, robot) = (robot, &rows as &dyn Robot);
    let prepared = rows.along(prepared);
    let estimation = of_signals(settings, &preparation, rows.of_shafts().is_some());
    let mut estimate = estimate(robot, &prepared, &estimation, progress)?;
    let of_logs = beyond.into_iter().chain(faults(&preparation).cloned());
    estimate.findings.splice(0..0, of_logs);
    preparation.refine(&left_of_delays(&estimate));
    progress("choosing the friction terms");
    let data = source(&recording);
    let rubs = |joint: &usize| estimate.joints[*joint].moves && !estimate.joints[*joint].exact;
    let motions = repeated_motions(&prepared);
    let friction = (0..estimate.joints.len()).filter(rubs).map(|joint| {
        let mut samples = JointSamples::new(joint, &prepared, motions.as_deref(), &estimate);
        let law = samples.law(robot, &settings.friction, &data, &preparation);
        let mut report = unless_refused(law, settings.accept_poor);
        if let Ok(report) = &mut report {
            report.result.load = under_load(&estimate.joints[joint]).into_iter().collect();
        }
        let (velocities, torques) = (samples.velocities, samples.torques);
        JointFriction { joint, name: samples.name.to_owned(), velocities, torques, report }
    });
    let mut friction: Vec<JointFriction> = friction.collect();
    for JointFriction { joint, report, .. } in &mut friction {
        let mut law = report.as_mut().ok();
        if let Some(report) = &mut law {
            written::judge(&mut estimate.joints[*joint], &mut report.result);
        }
        let of_joint = Written { robot, filter: &preparation.filter, joint: *joint };
        of_joint.predict(&mut estimate, law, &prepared)?;
    }
    if let Some(shafts) = rows.of_shafts() {
        estimate.findings.splice(0..0, shafts.found(joints, &estimate));
    }
    Ok(Identification {
        recording,
        preparation,
        runs: prepared,
        estimate,
        friction,
        shafts: rows.of_shafts().cloned(),
    })
}

impl Identification {
    /// Returns all findings in the order of the stages: logs, preparation, estimate, friction laws. If the estimate and a
    /// friction law have the same finding about a joint, the result has only the finding of the law.
    ///
    /// - `robot`: the identified robot
    pub fn findings(&self, robot: &dyn Robot) -> Vec<Finding> {
        let rows = self.rows(robot);
        let of_law = |friction: &JointFriction| -> Vec<Finding> {
            let subject = rows.subject(friction.joint);
            let found = match &friction.report {
                Ok(report) => report.result.findings.clone(),
                Err(reasons) => vec![no_law(reasons)],
            };
            found.into_iter().map(|finding| finding.of(subject.clone())).collect()
        };
        let of_laws = self.friction.iter().flat_map(of_law);
        let before = [&self.recording.findings, &self.preparation.findings, &self.estimate.findings];
        let before = self.recording.columns_found().into_iter().chain(before.into_iter().flatten().cloned());
        distinct(before.chain(of_laws))
    }
}

/// The finding that no law is written, with all reasons.
///
/// - `reasons`: findings because of which the law is refused
fn no_law(reasons: &[Finding]) -> Finding {
    let messages: Vec<&str> = reasons.iter().map(|reason| reason.message.as_str()).collect();
    let remedies: Vec<&str> = reasons.iter().filter_map(|reason| reason.remedy.as_deref()).collect();
    let message =
        format!("no friction law is written: {}. The described friction stays", messages.join("; "));
    let found = NO_LAW.found(message);
    if remedies.is_empty() { found } else { found.help(remedies.join("; ")) }
}

/// Settings of the estimate with the filter of the signals and with the index of the delay of each effort. Efforts with the
/// same delay have the same index.
///
/// - `mixed`: whether efforts of the joints were added along shafts
pub(crate) fn of_signals(
    settings: &IdentificationSettings,
    preparation: &PreparationReport,
    mixed: bool,
) -> EstimationSettings {
    let mut own = 0;
    let mut number = |delay: &Delay| {
        own += usize::from(delay.own && !mixed);
        if delay.own && !mixed { own } else { 0 }
    };
    let delays = preparation.delays.iter().map(&mut number).collect();
    EstimationSettings {
        filter: Some(preparation.filter.clone()),
        delays: settings.preparation.delay.is_none().then_some(delays),
        ..settings.estimation.clone()
    }
}

/// Remaining delay of each effort, and its standard error [s].
pub(crate) fn left_of_delays(estimate: &Estimate) -> Vec<[f64; 2]> {
    estimate.delays.iter().map(|delay| [delay.value, delay.standard_error]).collect()
}

/// The load-dependent friction term of a joint, as a term of a law; `None` if the term was not chosen.
fn under_load(joint: &JointEstimate) -> Option<FrictionTerm> {
    joint.load.as_ref().map(|term| FrictionTerm {
        basis: term.basis.clone(),
        coefficient: term.coefficient.value,
        standard_error: Some(term.coefficient.standard_error),
        ..FrictionTerm::default()
    })
}

/// Reads the logs and prepares their signals.
///
/// - `noted`: receives the findings, including those that precede an error
pub(crate) fn read_and_prepare(
    robot: &dyn Robot,
    logs: &[PathBuf],
    settings: &IdentificationSettings,
    noted: &mut Vec<Finding>,
    progress: &mut dyn FnMut(&str),
) -> Result<(Recording, Vec<PreparedRun>, PreparationReport)> {
    if settings.estimation.gravity_compensated {
        let help = "no drive holds the weight of such a robot, so leave out --gravity-compensated";
        require_no_quaternions(robot, "gravity is not compensated", help)?;
    }
    progress("reading the logs");
    let mut before = Vec::new();
    let recording = runs_noting(logs, robot, &settings.columns, &mut before);
    noted.append(&mut before);
    let recording = recording?;
    noted.extend(recording.columns_found());
    noted.extend(recording.findings.iter().cloned());
    progress("smoothing");
    let preparation = PreparationSettings {
        gravity_compensated: settings.estimation.gravity_compensated,
        ..settings.preparation.clone()
    };
    let (prepared, preparation) = prepare_all(&recording.runs, Some(robot), &preparation)?;
    noted.extend(preparation.findings.iter().chain(faults(&preparation)).cloned());
    require_efforts(&preparation)?;
    Ok((recording, prepared, preparation))
}

/// Findings about values beyond the described limits.
///
/// # Errors
/// [`IdentificationError::Found`] if values are far beyond their limits and this is not accepted.
pub(crate) fn beyond_limits(
    robot: &dyn Robot,
    recording: &Recording,
    prepared: &[PreparedRun],
    accept_poor: bool,
) -> Result<Vec<Finding>> {
    let findings = beyond(robot, recording, prepared);
    if accept_poor || findings.iter().all(|finding| finding.severity != Severity::Error) {
        return Ok(findings.into_iter().map(Finding::accepted).collect());
    }
    Err(IdentificationError::Found { findings })
}

/// Fails if no effort can be used. A joint without a usable effort keeps its description.
///
/// # Errors
/// [`IdentificationError::Found`] with the faults.
fn require_efforts(preparation: &PreparationReport) -> Result<()> {
    if preparation.joints.iter().any(|joint| joint.fault.is_none()) {
        return Ok(());
    }
    let faults = faults(preparation).cloned();
    let findings = faults.map(|fault| Finding { severity: Severity::Error, ..fault }).collect();
    Err(IdentificationError::Found { findings })
}

/// Findings about efforts that cannot be used.
pub(crate) fn faults(preparation: &PreparationReport) -> impl Iterator<Item = &Finding> {
    preparation.joints.iter().filter_map(|joint| joint.fault.as_ref())
}

/// Names of the logs with the first digits of their hashes, as text.
fn source(recording: &Recording) -> String {
    let logs = recording.hashes.iter().map(|(path, hash)| {
        let name = path.rsplit(['/', '\\']).next().unwrap_or(path);
        format!("{name} (sha256 {})", hash.get(..16).unwrap_or(hash))
    });
    logs.collect::<Vec<_>>().join(", ")
}

/// The law, or the reasons for which it is refused.
///
/// - `accept_poor`: whether a law is accepted in spite of the reasons. The reasons then become warnings.
pub(crate) fn unless_refused(
    report: Result<FrictionReport>,
    accept_poor: bool,
) -> std::result::Result<FrictionReport, Vec<Finding>> {
    let mut report = report.map_err(|error| vec![NO_FIT.found(error.to_string())])?;
    let refusals: Vec<Finding> = report.result.refusals().cloned().collect();
    if report.result.vanishes() {
        let nothing = || vec![NOTHING_LEFT.found("no term differs from 0 by more than its standard error")];
        return Err(if refusals.is_empty() { nothing() } else { refusals });
    }
    if accept_poor {
        report.result.accept();
        return Ok(report);
    }
    if refusals.is_empty() { Ok(report) } else { Err(refusals) }
}
