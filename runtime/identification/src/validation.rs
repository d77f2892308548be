//! Prediction of logs that were not used for the identification.

use super::doubts::limits::beyond;
use super::doubts::written::Written;
use super::error::Result;
use super::estimation::Gravity;
use super::identify::{Identification, IdentificationSettings};
use super::log::runs_noting;
use super::preparation::{Filter, prepare_as};
use super::robot::Robot;
use super::run::{Effort, PreparedRun};
use super::shafts::RobotRows;
use gelenk_findings::digits::plain;
use gelenk_findings::{Finding, Rule};
use std::path::PathBuf;

/// Sees: a validation log that was also fitted.
/// Matters: its R² does not measure the error on other data.
/// Example: the same file twice on the command line.
/// Fixture: `codegen/tests/external_arm/doubts.rs`.
const FITTED: Rule = Rule::warning("fitted-log");

/// Sees: efforts of a validation log that are farther from the prediction than from their mean.
/// Matters: a constant predicts this log better than the description does. The log may be of another robot, load or unit.
/// Example: efforts with the other sign.
/// Fixture: `codegen/tests/external_arm/doubts.rs`.
const NOT_PREDICTED: Rule = Rule::warning("validation-failed");

/// Quality of the prediction of a joint's efforts τ in logs that were not fitted. τ̂ is the predicted effort. τ̄ is the mean
/// of τ.
#[derive(Debug, Clone, PartialEq)]
pub struct JointValidation {
    /// Name of the joint.
    pub name: String,
    /// `R² = 1 − Σ (τ − τ̂)² / Σ (τ − τ̄)²` of the effort τ with its prediction τ̂ and its mean τ̄, over the
    /// samples in which the joint moves. NaN if the effort is constant, or if it was not measured in the logs
    /// of the identification.
    pub r_squared: f64,
    /// R² of the prediction including the samples in which the joint rests. Dry friction at rest takes any
    /// value up to the static one.
    pub r_squared_with_rest: f64,
    /// Root mean square of measured minus predicted effort over the samples in which the joint moves [N·m or
    /// N].
    pub residual: f64,
    /// Mean of measured minus predicted effort over the samples in which the joint moves [N·m or N]. It is a
    /// constant force in the logs that the description does not contain.
    pub offset: f64,
    /// R² over the samples in which the joint moves, if [`Self::offset`] is added to the predicted effort.
    pub r_squared_with_offset: f64,
}

/// Predicts the efforts of other logs with the identified description: inertial parameters, added inertias, the chosen friction
/// laws with their constants, and gains of the drives. No value is fitted again. Offsets of the fitted logs are not added.
///
/// Signals pass the filter of the identification, and friction passes the filter of the efforts. The delay of the
/// identification is removed from the efforts.
///
/// - `found`: result of the identification
/// - `progress`: receives the findings about the other logs
///
/// # Errors
/// The call fails if logs cannot be read, do not match the robot, or are too short.
pub fn validate(
    robot: &dyn Robot,
    found: &Identification,
    logs: &[PathBuf],
    settings: &IdentificationSettings,
    progress: &mut dyn FnMut(&str),
) -> Result<Vec<JointValidation>> {
    let mut noted = Vec::new();
    let recording = runs_noting(logs, robot, &settings.columns, &mut noted);
    let recording = recording.map_err(|error| error.after(noted))?;
    let mut say = |finding: &Finding| progress(&format!("in the logs to validate, {finding}"));
    recording.findings.iter().for_each(&mut say);
    let fitted = |hash: &str| found.recording.hashes.iter().any(|(_, other)| other == hash);
    for (path, _) in recording.hashes.iter().filter(|(_, hash)| fitted(hash)) {
        say(&FITTED
            .found("it is one of the fitted logs, so its R² does not measure the error on other data")
            .log(path, None));
    }
    let preparation = found.preparation.settings_alike(&settings.preparation);
    let (prepared, report) = prepare_as(&recording.runs, robot, &preparation, &found.preparation.filter)?;
    beyond(robot, &recording, &prepared).into_iter().for_each(|found| say(&found.accepted()));
    let rows = RobotRows::new(robot, found.shafts.clone());
    let prepared = rows.along(prepared);
    let model = Prediction::new(&rows, found, settings.estimation.gravity_compensated);
    let mut sums = vec![[Sums::default(); 2]; found.estimate.joints.len()];
    prepared.iter().try_for_each(|run| model.add(run, &report.filter, &mut sums))?;
    let joints = found.estimate.joints.iter().zip(sums);
    let judged: Vec<JointValidation> = joints.map(|(joint, sums)| judged(joint.name.clone(), sums)).collect();
    for (joint, JointValidation { r_squared, .. }) in
        judged.iter().enumerate().filter(|(_, of)| of.r_squared < 0.0)
    {
        let r_squared = plain(*r_squared, 3);
        let message = format!(
            "the efforts are farther from the prediction than from their mean (R² is {r_squared}). Check that robot, load and \
             units are those of the fitted logs"
        );
        say(&NOT_PREDICTED.found(message).of(rows.subject(joint)));
    }
    Ok(judged)
}

/// Sums over one joint's measured forces and errors.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    count: f64,
    mean: f64,
    spread: f64,
    errors: f64,
    error: f64,
}

impl Sums {
    /// Adds a sample. Mean and spread are updated by Welford's recursion (1962).
    fn add(&mut self, measured: f64, predicted: f64) {
        self.count += 1.0;
        let before = measured - self.mean;
        self.mean += before / self.count;
        self.spread += before * (measured - self.mean);
        self.errors += (measured - predicted).powi(2);
        self.error += measured - predicted;
    }

    /// Mean difference between measured and predicted force.
    fn offset(&self) -> f64 {
        self.error / self.count
    }

    fn r_squared(&self, squares: f64) -> f64 {
        if self.spread > 0.0 { 1.0 - squares / self.spread } else { f64::NAN }
    }
}

/// The quality of the prediction from the sums of a joint.
///
/// - `moving`: sums over the samples in which the joint moves
/// - `all`: sums over all samples
fn judged(name: String, [moving, all]: [Sums; 2]) -> JointValidation {
    JointValidation {
        name,
        r_squared: moving.r_squared(moving.errors),
        r_squared_with_rest: all.r_squared(all.errors),
        residual: (moving.errors / moving.count).sqrt(),
        offset: moving.offset(),
        r_squared_with_offset: moving.r_squared(moving.errors - moving.count * moving.offset().powi(2)),
    }
}

/// The identified model, which predicts efforts.
struct Prediction<'a> {
    robot: &'a dyn Robot,
    found: &'a Identification,
    input_matrix: Vec<f64>,
    /// Identified minus described inertial parameters.
    changes: Vec<f64>,
    /// Inertial parameters of the weight that the robot compensates; `None` if the robot does not compensate gravity.
    compensated: Option<Vec<f64>>,
}

impl<'a> Prediction<'a> {
    fn new(robot: &'a dyn Robot, found: &'a Identification, is_gravity_compensated: bool) -> Self {
        let values: Vec<f64> = found.estimate.parameters.iter().map(|parameter| parameter.value).collect();
        let changes = values.iter().zip(robot.parameters()).map(|(new, old)| new - old).collect();
        let compensated = is_gravity_compensated.then(|| match found.estimate.gravity {
            Gravity::CompensatedAsDescribed => robot.parameters(),
            Gravity::Compensated | Gravity::Recorded => values,
        });
        Self { robot, found, input_matrix: robot.input_matrix(), changes, compensated }
    }

    /// Adds the measured and predicted efforts of a run to the sums of each joint.
    fn add(&self, run: &PreparedRun, filter: &Filter, sums: &mut [[Sums; 2]]) -> Result<()> {
        let law = |joint: usize| self.found.law(joint).map(|report| &report.result);
        // Friction along the run, filtered as the efforts are; `None` if the friction depends on the load.
        let friction = |joint: usize| {
            let needs_load = law(joint).is_some_and(|law| !law.load.is_empty());
            let written = Written { robot: self.robot, filter, joint };
            (!needs_load).then(|| written.friction(law(joint), &run.velocities[joint])).transpose()
        };
        let friction = (0..sums.len()).map(friction).collect::<Result<Vec<Option<Vec<f64>>>>>()?;
        for sample in 0..run.times.len() {
            let [y, v, a] = run.state(sample);
            // Loads of the gears: rigid-body forces `M ÿ + k − q` with gravity, with the mass matrix M, the bias force k and
            // the applied forces q.
            let mut loads = vec![0.0; sums.len()];
            self.robot.rigid_forces(&y, &v, &a, &mut loads);
            self.add_regressor([&y, &v, &a], 1.0, &self.changes, &mut loads);
            let (mut forces, zero) = (loads.clone(), vec![0.0; v.len()]);
            if let Some(compensated) = &self.compensated {
                self.add_regressor([&y, &zero, &zero], -1.0, compensated, &mut forces);
            }
            let joints = self.found.estimate.joints.iter().enumerate();
            for (joint, of_joint) in joints.filter(|(_, of_joint)| of_joint.measured) {
                let inertia = of_joint.armature.map_or(0.0, |armature| armature.value) * a[joint];
                let friction = match (&friction[joint], law(joint)) {
                    (Some(friction), _) => friction[sample],
                    // A law that cannot be evaluated makes the prediction NaN, and the sample is not counted.
                    (None, Some(law)) => law.torque(v[joint], loads[joint] + inertia).unwrap_or(f64::NAN),
                    (None, None) => 0.0,
                };
                let predicted = forces[joint] + (friction + inertia);
                let gain =
                    of_joint.gain.filter(|_| run.effort != Effort::Joint).map_or(1.0, |gain| gain.value);
                let measured = run.force(&self.input_matrix, joint, sample) * gain;
                if measured.is_finite() && predicted.is_finite() {
                    let counted = usize::from(run.rests(joint, sample));
                    sums[joint][counted..].iter_mut().for_each(|sums| sums.add(measured, predicted));
                }
            }
        }
        Ok(())
    }

    fn add_regressor(&self, [y, v, a]: [&[f64]; 3], sign: f64, parameters: &[f64], forces: &mut [f64]) {
        let mut regressor = vec![0.0; forces.len() * parameters.len()];
        self.robot.inertial_regressor(y, v, a, &mut regressor);
        for (force, row) in forces.iter_mut().zip(regressor.chunks_exact(parameters.len().max(1))) {
            *force += sign * row.iter().zip(parameters).map(|(w, p)| w * p).sum::<f64>();
        }
    }
}
