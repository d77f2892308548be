//! Prediction of logs that were not used for the identification.

use super::doubts::limits::beyond;
use super::doubts::written::Written;
use super::error::Result;
use super::estimation::Gravity;
use super::identify::{Identification, IdentificationSettings};
use super::log::runs_noting;
use super::methods::offset::mean;
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
    let mut forces = vec![Forces::default(); found.estimate.joints.len()];
    prepared.iter().try_for_each(|run| model.add(run, &report.filter, &mut forces))?;
    let joints = found.estimate.joints.iter().zip(&forces);
    let judged: Vec<JointValidation> =
        joints.map(|(joint, forces)| judged(joint.name.clone(), forces)).collect();
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

/// Measured and predicted forces of a joint: at the samples in which the joint moves, and at all samples.
type Forces = [Vec<[f64; 2]>; 2];

/// The quality of the prediction of a joint's forces.
fn judged(name: String, [moving, all]: &Forces) -> JointValidation {
    let errors = |of: &[[f64; 2]]| of.iter().map(|[measured, predicted]| measured - predicted).collect();
    let squares = |of: &[f64], from: f64| of.iter().map(|x| (x - from).powi(2)).sum::<f64>();
    let r_squared = |of: &[[f64; 2]], offset: f64| {
        let measured: Vec<f64> = of.iter().map(|[measured, _]| *measured).collect();
        let (errors, spread): (Vec<f64>, f64) = (errors(of), squares(&measured, mean(&measured)));
        if spread > 0.0 { 1.0 - squares(&errors, offset) / spread } else { f64::NAN }
    };
    let left: Vec<f64> = errors(moving);
    let offset = mean(&left);
    JointValidation {
        name,
        r_squared: r_squared(moving, 0.0),
        r_squared_with_rest: r_squared(all, 0.0),
        residual: (squares(&left, 0.0) / left.len() as f64).sqrt(),
        offset,
        r_squared_with_offset: r_squared(moving, offset),
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

    /// Adds the measured and predicted forces of each joint along a run.
    fn add(&self, run: &PreparedRun, filter: &Filter, found: &mut [Forces]) -> Result<()> {
        let law = |joint: usize| self.found.law(joint).map(|report| &report.result);
        // Friction along the run, filtered as the efforts are; `None` if the friction depends on the load.
        let friction = |joint: usize| {
            let needs_load = law(joint).is_some_and(|law| !law.load.is_empty());
            let written = Written { robot: self.robot, filter, joint };
            (!needs_load).then(|| written.friction(law(joint), &run.velocities[joint])).transpose()
        };
        let friction = (0..found.len()).map(friction).collect::<Result<Vec<Option<Vec<f64>>>>>()?;
        for sample in 0..run.times.len() {
            let [y, v, a] = run.state(sample);
            // Loads of the gears: rigid-body forces `M ÿ + k − q` with gravity, with the mass matrix M, the bias force k and
            // the applied forces q.
            let mut loads = vec![0.0; found.len()];
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
                    found[joint][counted..].iter_mut().for_each(|of| of.push([measured, predicted]));
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
