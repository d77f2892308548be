//! From logs to an identified robot, in one call.

use super::error::{IdentificationError, Result};
use super::estimation::{Estimate, EstimationSettings, JointEstimate, estimate, repeated_motions};
use super::friction::{CommonTerms, FrictionIdentification, FrictionMethod, FrictionReport};
use super::joint_samples::JointSamples;
use super::log::{ColumnOptions, FindingKind, Recording, runs_noting};
use super::preparation::{Delay, PreparationReport, PreparationSettings, prepare_all};
use super::range::{far_beyond, require_in_range};
use super::result::FrictionTerm;
use super::robot::{Robot, require_no_quaternions};
use super::run::PreparedRun;
use super::shafts::{RobotRows, ShaftRows, in_words};
use super::written;
use nalgebra::DVector;
use std::path::PathBuf;

/// What may be decided about an identification; the defaults suit a log about which nothing is known.
#[derive(Debug, Clone)]
pub struct IdentificationSettings {
    /// Which columns are what.
    pub columns: ColumnOptions,
    /// Grid, filter and delay.
    pub preparation: PreparationSettings,
    /// The common estimate of inertia, friction, offsets and gains.
    pub estimation: EstimationSettings,
    /// How the terms of the friction laws are chosen.
    pub friction: FrictionIdentification,
    /// Takes friction laws that would be refused; the reason becomes a warning.
    pub accept_poor: bool,
}

impl IdentificationSettings {
    /// The defaults.
    ///
    /// # Errors
    /// None in fact: those of the default library of friction terms.
    pub fn new() -> Result<Self> {
        Ok(Self {
            columns: ColumnOptions::default(),
            preparation: PreparationSettings::default(),
            estimation: EstimationSettings::default(),
            friction: FrictionIdentification {
                method: FrictionMethod::BestSubset,
                ..FrictionIdentification::new()?
            },
            accept_poor: false,
        })
    }
}

/// What was found, and all that it was found from.
#[derive(Debug, Clone)]
pub struct Identification {
    /// The logs.
    pub recording: Recording,
    /// What was done to their signals.
    pub preparation: PreparationReport,
    /// The signals that the estimate was made of; none where it was made of moments.
    pub runs: Vec<PreparedRun>,
    /// Inertia, friction, offsets and gains.
    pub estimate: Estimate,
    /// Friction laws of the joints that moved.
    pub friction: Vec<JointFriction>,
    /// The rows that these numbers belong to where shafts take those of joints. What is said of a joint then is said of
    /// the shaft: positions and velocities are its own, efforts are those of its motor.
    pub shafts: Option<ShaftRows>,
}

impl Identification {
    /// The robot with the rows and the parameters of the estimate.
    ///
    /// - `robot`: the one that was identified
    #[must_use]
    pub fn rows<'a>(&'a self, robot: &'a dyn Robot) -> RobotRows<'a> {
        RobotRows::new(robot, self.shafts.as_ref())
    }

    /// The drive whose shaft's row this is; `None` where it is that of the joint.
    #[must_use]
    pub fn shaft(&self, row: usize) -> Option<&str> {
        self.shafts.as_ref()?.shaft(row).map(|shaft| shaft.name.as_str())
    }
}

/// The friction of a joint, or of a shaft that takes its row.
#[derive(Debug, Clone)]
pub struct JointFriction {
    /// Number of the joint.
    pub joint: usize,
    /// Name of the joint, or of the shaft's drive.
    pub name: String,
    /// ẏ at all samples of all runs in which the joint does not rest.
    pub velocities: Vec<f64>,
    /// Measured forces without those of the rigid body and without friction under load: friction, offset and error.
    pub torques: Vec<f64>,
    /// The law, or why there is none.
    pub report: std::result::Result<FrictionReport, String>,
}

/// Reads logs of a robot, prepares their signals, estimates, and chooses the terms of each joint's friction.
///
/// - `progress`: takes a sentence at each step
///
/// # Errors
/// Logs that cannot be read or matched with the robot's joints, signals that are too short, and estimates that
/// explain nothing. A joint whose friction has no law is no error, see [`JointFriction::report`].
pub fn identify(
    robot: &dyn Robot,
    logs: &[PathBuf],
    settings: &IdentificationSettings,
    progress: &mut dyn FnMut(&str),
) -> Result<Identification> {
    let (recording, prepared, mut preparation) = read_and_prepare(robot, logs, settings, progress)?;
    let beyond = beyond_range(robot, (&recording, &prepared, &preparation), settings.accept_poor, progress)?;
    let shafts = ShaftRows::of(robot);
    let rows = RobotRows::new(robot, shafts.as_ref());
    let (joints, robot) = (robot, &rows as &dyn Robot);
    let prepared = rows.along(prepared);
    let estimation = of_signals(settings, &preparation, shafts.is_some());
    let found = estimate(robot, &prepared, &estimation, progress);
    let found = found.map_err(|error| in_words(error, shafts.as_ref()));
    let mut estimate = or_noted(found, || notes(&recording, Some(&preparation)), progress)?;
    let of_logs = recording.doubts().chain(beyond).chain(faults(&preparation));
    estimate.warnings.splice(0..0, of_logs);
    preparation.refine(&left_of_delays(&estimate));
    progress("choosing the terms of friction");
    let data = source(&recording);
    let rubs = |joint: &usize| estimate.joints[*joint].moves && !estimate.joints[*joint].exact;
    let motions = repeated_motions(&prepared);
    let friction = (0..estimate.joints.len()).filter(rubs).map(|joint| {
        let runs = (&prepared[..], motions.as_deref());
        let mut samples = JointSamples::new(joint, runs, &estimate, common(&estimate, joint));
        let law = samples.law(robot, &settings.friction, &data, &preparation);
        let law = law.map_err(|error| error.to_string());
        let mut report = law.and_then(|report| unless_refused(report, settings.accept_poor));
        if let Ok(report) = &mut report {
            report.result.load = under_load(&estimate.joints[joint]).into_iter().collect();
        }
        let (velocities, torques) = (samples.velocities, samples.torques);
        JointFriction { joint, name: samples.name.to_owned(), velocities, torques, report }
    });
    let mut friction: Vec<JointFriction> = friction.collect();
    for JointFriction { joint, report, .. } in &mut friction {
        let Ok(report) = report else { continue };
        written::judge(&mut estimate.joints[*joint], &mut report.result);
        written::predict(&mut estimate, *joint, &prepared, &report.residuals);
    }
    estimate.warnings.retain(|warning| !is_said(warning, &friction));
    if let Some(shafts) = &shafts {
        shafts.word(joints, &mut estimate, faults_of(&mut friction));
    }
    Ok(Identification { recording, preparation, runs: prepared, estimate, friction, shafts })
}

/// The settings of the estimate with what is known of the signals: their filter, and which efforts share a delay.
///
/// - `mixed`: efforts of the joints were added up along shafts
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

/// What is left of the delay of each effort, and its standard error.
pub(crate) fn left_of_delays(estimate: &Estimate) -> Vec<[f64; 2]> {
    estimate.delays.iter().map(|delay| [delay.value, delay.standard_error]).collect()
}

/// The term of a joint's friction that grows with the load, as a law has it.
fn under_load(joint: &JointEstimate) -> Option<FrictionTerm> {
    joint.load.as_ref().map(|term| FrictionTerm {
        basis: term.basis.clone(),
        coefficient: term.coefficient.value,
        standard_error: Some(term.coefficient.standard_error),
        ..FrictionTerm::default()
    })
}

/// The logs, and their signals on one grid through one filter.
pub(crate) fn read_and_prepare(
    robot: &dyn Robot,
    logs: &[PathBuf],
    settings: &IdentificationSettings,
    progress: &mut dyn FnMut(&str),
) -> Result<(Recording, Vec<PreparedRun>, PreparationReport)> {
    if settings.estimation.gravity_compensated {
        let help = "nothing holds the weight of such a robot; leave --gravity-compensated out";
        require_no_quaternions(robot, "gravity is not compensated", help)?;
    }
    progress("reading the logs");
    let mut findings = Vec::new();
    let recording = runs_noting(logs, robot, &settings.columns, &mut findings);
    let recording = or_noted(recording, || findings.iter().map(ToString::to_string).collect(), progress)?;
    or_noted(require_sides(&recording, &settings.columns), || notes(&recording, None), progress)?;
    progress("smoothing");
    let preparation = PreparationSettings {
        gravity_compensated: settings.estimation.gravity_compensated,
        ..settings.preparation.clone()
    };
    let prepared = prepare_all(&recording.runs, Some(robot), &preparation);
    let (prepared, preparation) = or_noted(prepared, || notes(&recording, None), progress)?;
    or_noted(require_efforts(&preparation), || notes(&recording, Some(&preparation)), progress)?;
    Ok((recording, prepared, preparation))
}

/// What is far beyond the described limits, where it is accepted.
///
/// # Errors
/// Values far beyond the limits that are not accepted.
pub(crate) fn beyond_range(
    robot: &dyn Robot,
    (recording, prepared, preparation): (&Recording, &[PreparedRun], &PreparationReport),
    accept_poor: bool,
    progress: &mut dyn FnMut(&str),
) -> Result<Vec<String>> {
    let beyond = far_beyond(robot, recording, prepared);
    if !accept_poor {
        or_noted(require_in_range(&beyond), || notes(recording, Some(preparation)), progress)?;
    }
    Ok(beyond.into_iter().map(|sentence| format!("in the logs, {sentence}")).collect())
}

/// What was noticed on the way to an error is said before it: it may be the reason.
pub(crate) fn or_noted<T>(
    result: Result<T>,
    notes: impl FnOnce() -> Vec<String>,
    progress: &mut dyn FnMut(&str),
) -> Result<T> {
    if result.is_err() {
        notes().iter().for_each(|note| progress(&format!("note: {note}")));
    }
    result
}

/// What was noticed in the logs, and while their signals were prepared.
fn notes(recording: &Recording, preparation: Option<&PreparationReport>) -> Vec<String> {
    let columns = recording.columns_said().into_iter().chain(recording.doubts());
    let findings = columns.chain(recording.findings.iter().map(ToString::to_string));
    let of_signals =
        preparation.map(|preparation| preparation.notes.iter().cloned().chain(faults(preparation)));
    findings.chain(of_signals.into_iter().flatten()).collect()
}

/// What the estimate and a friction law say of the same residuals, each by its words.
const SAID_TWICE: [[&str; 2]; 4] = [
    ["follows the joint's position", "depends on the position"],
    ["follows the acceleration", "depends on the acceleration"],
    ["its offset drifts", "the constant torque drifts"],
    ["its friction changes by", "friction changes by"],
];

/// Whether the friction law of a joint says what a warning of the estimate says.
fn is_said(warning: &str, friction: &[JointFriction]) -> bool {
    let of_joint = friction.iter().find(|joint| warning.starts_with(&format!("Joint {}:", joint.name)));
    let Some(report) = of_joint.and_then(|joint| joint.report.as_ref().ok()) else { return false };
    let said = |words: &str| report.result.warnings.iter().any(|other| other.contains(words));
    SAID_TWICE.iter().any(|[own, other]| warning.contains(own) && said(other))
}

/// Efforts on the other side of the gears than their names say would make every result wrong by the gear's ratio:
/// somebody has to say what they are.
fn require_sides(recording: &Recording, columns: &ColumnOptions) -> Result<()> {
    let is_said = columns.effort.is_some() || columns.columns.is_some();
    let doubt = recording.findings.iter().find(|finding| finding.kind == FindingKind::GearDoubtful);
    match doubt {
        Some(doubt) if !is_said => Err(IdentificationError::File {
            place: doubt.joint.as_ref().map_or_else(|| "the logs".into(), |joint| format!("joint {joint}")),
            message: format!(
                "{}. Say what they are: --effort joint, --effort input or --effort current",
                doubt.message
            ),
        }),
        _ => Ok(()),
    }
}

/// A joint whose efforts cannot be used keeps what is described; where no joint has others, nothing is left to do.
fn require_efforts(preparation: &PreparationReport) -> Result<()> {
    if preparation.joints.iter().any(|joint| joint.fault.is_none()) {
        return Ok(());
    }
    let faults: Vec<String> = faults(preparation).collect();
    Err(IdentificationError::File { place: "the logs".into(), message: faults.join("; ") })
}

/// What is wrong with efforts that cannot be used, with the knob that names others.
pub(crate) fn faults(preparation: &PreparationReport) -> impl Iterator<Item = String> + '_ {
    preparation.joints.iter().filter_map(|joint| {
        let fault = joint.fault.as_ref()?;
        Some(format!("joint {}: {fault}; name other columns with --columns 'torque=…'", joint.name))
    })
}

/// The reasons for which joints have no law.
pub(crate) fn faults_of(friction: &mut [JointFriction]) -> impl Iterator<Item = &mut String> {
    friction.iter_mut().filter_map(|friction| friction.report.as_mut().err())
}

/// Logs with the first digits of their hashes.
fn source(recording: &Recording) -> String {
    let logs = recording.hashes.iter().map(|(path, hash)| {
        let name = path.rsplit(['/', '\\']).next().unwrap_or(path);
        format!("{name} (sha256 {})", hash.get(..16).unwrap_or(hash))
    });
    logs.collect::<Vec<_>>().join(", ")
}

/// What the estimate says of a joint's friction, and instrumental variables where least squares is biased; `None` where the
/// joint has no terms.
pub(crate) fn common(estimate: &Estimate, joint: usize) -> Option<CommonTerms> {
    let own = Some(&estimate.joints[joint].terms).filter(|terms| !terms.is_empty())?;
    let bases = own.iter().map(|term| term.basis.clone()).collect();
    let Some(other) = estimate.instrumental.as_ref().filter(|other| other.is_counted) else {
        return Some(CommonTerms {
            bases,
            distances: DVector::zeros(own.len()),
            covariance: estimate.terms_covariance[joint].clone(),
            freedom: estimate.freedom.max(1) as f64,
        });
    };
    let terms = other.terms[joint].iter().zip(own);
    let distances = terms.map(|(other, own)| other.coefficient.value - own.coefficient.value);
    Some(CommonTerms {
        bases,
        distances: DVector::from_iterator(own.len(), distances),
        covariance: other.terms_covariance[joint].clone(),
        freedom: other.freedom.max(1) as f64,
    })
}

/// What is said about a law of which no term is left.
const NOTHING_LEFT: &str =
    "no term differs from 0 by more than its error: the described friction stays as it is";

/// The law, or the reason for which it is refused.
///
/// - `accept_poor`: the reason becomes a warning of the law, where there is a law to be accepted
pub(crate) fn unless_refused(
    mut report: FrictionReport,
    accept_poor: bool,
) -> std::result::Result<FrictionReport, String> {
    if report.result.vanishes() {
        let reason = report.result.refusal.take();
        return Err(reason.unwrap_or_else(|| NOTHING_LEFT.to_owned()));
    }
    if accept_poor {
        report.result.accept();
    }
    report.result.refusal.clone().map_or(Ok(report), Err)
}
