//! Prediction of logs that were not used for the identification.

use super::doubts::limits::beyond;
use super::doubts::written::Written;
use super::error::Result;
use super::estimation::Gravity;
use super::identify::{Identification, IdentificationSettings};
use super::log::runs_noting;
use super::preparation::{Filter, prepare_as};
use super::result::FrictionResult;
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
    let mut model = Prediction::new(&rows, found, settings.estimation.gravity_compensated)?;
    let mut sums = vec![[Sums::default(); 2]; model.joints];
    for run in &prepared {
        model.set_friction(run, &report.filter)?;
        for sample in 0..run.times.len() {
            model.add(run, sample, &mut sums);
        }
    }
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
    /// Inertial parameters of the weight that the robot compensates; `None` if the robot does not compensate gravity.
    compensated: Option<Vec<f64>>,
    joints: usize,
    /// Identified minus described inertial parameters.
    changes: Vec<f64>,
    /// Loads of the gears: rigid-body forces `M ÿ + k − q` with gravity, with the mass matrix M, the bias
    /// force k and the applied forces q.
    loads: Vec<f64>,
    input_matrix: Vec<f64>,
    regressor: Vec<f64>,
    forces: Vec<f64>,
    /// Friction of each joint along the run, filtered as the efforts are; `None` if the friction depends on the load.
    friction: Vec<Option<Vec<f64>>>,
}

impl<'a> Prediction<'a> {
    fn new(robot: &'a dyn Robot, found: &'a Identification, is_gravity_compensated: bool) -> Result<Self> {
        let joints = robot.joint_names().len();
        let values: Vec<f64> = found.estimate.parameters.iter().map(|parameter| parameter.value).collect();
        let changes: Vec<f64> = values.iter().zip(robot.parameters()).map(|(new, old)| new - old).collect();
        let compensated = is_gravity_compensated.then(|| match found.estimate.gravity {
            Gravity::CompensatedAsDescribed => robot.parameters(),
            Gravity::Compensated | Gravity::Recorded => values,
        });
        Ok(Self {
            robot,
            found,
            compensated,
            joints,
            loads: vec![0.0; joints],
            input_matrix: robot.input_matrix(),
            regressor: vec![0.0; joints * changes.len()],
            forces: vec![0.0; joints],
            friction: vec![None; joints],
            changes,
        })
    }

    /// The friction law of a joint; `None` if it has no law.
    fn law(&self, joint: usize) -> Option<&'a FrictionResult> {
        self.found.law(joint).map(|report| &report.result)
    }

    fn set_friction(&mut self, run: &PreparedRun, filter: &Filter) -> Result<()> {
        for joint in 0..self.joints {
            let law = self.law(joint);
            let needs_load = law.is_some_and(|law| !law.load.is_empty());
            let written = Written { robot: self.robot, filter, joint };
            let friction = (!needs_load).then(|| written.friction(law, &run.velocities[joint]));
            self.friction[joint] = friction.transpose()?;
        }
        Ok(())
    }

    fn add(&mut self, run: &PreparedRun, sample: usize, sums: &mut [[Sums; 2]]) {
        let [y, v, a] = run.state(sample);
        self.rigid(&y, &v, &a);
        // A joint without measured efforts in the logs of the identification has no identified law.
        let known = |joint: &usize| self.found.estimate.joints[*joint].measured;
        for joint in (0..sums.len()).filter(known) {
            let measured = self.measured(run, joint, sample);
            let predicted = self.forces[joint] + self.at_joint(joint, sample, [v[joint], a[joint]]);
            if measured.is_finite() && predicted.is_finite() {
                let counted = usize::from(run.rests(joint, sample));
                sums[joint][counted..].iter_mut().for_each(|sums| sums.add(measured, predicted));
            }
        }
    }

    /// Computes the rigid-body forces `M ÿ + k − q` with the identified parameters, without gravity if the
    /// robot compensates it. M is the mass matrix, k the bias force and q the applied forces.
    fn rigid(&mut self, y: &[f64], v: &[f64], a: &[f64]) {
        self.robot.rigid_forces(y, v, a, &mut self.forces);
        self.add_regressor([y, v, a], 1.0, &self.changes.clone());
        self.loads.copy_from_slice(&self.forces);
        if let Some(compensated) = self.compensated.clone() {
            let zero = vec![0.0; v.len()];
            self.add_regressor([y, &zero, &zero], -1.0, &compensated);
        }
    }

    fn add_regressor(&mut self, [y, v, a]: [&[f64]; 3], sign: f64, parameters: &[f64]) {
        self.regressor.fill(0.0);
        self.robot.inertial_regressor(y, v, a, &mut self.regressor);
        let rows = self.regressor.chunks_exact(parameters.len().max(1));
        for (force, row) in self.forces.iter_mut().zip(rows) {
            *force += sign * row.iter().zip(parameters).map(|(w, p)| w * p).sum::<f64>();
        }
    }

    /// Friction and force of the added inertia of a joint.
    fn at_joint(&self, joint: usize, sample: usize, [v, a]: [f64; 2]) -> f64 {
        let inertia = self.found.estimate.joints[joint].armature.map_or(0.0, |armature| armature.value);
        let load = self.loads[joint] + inertia * a;
        let friction = match (&self.friction[joint], self.law(joint)) {
            (Some(friction), _) => friction[sample],
            // A law that cannot be evaluated makes the prediction NaN, and the sample is not counted.
            (None, Some(law)) => law.torque(v, load).unwrap_or(f64::NAN),
            (None, None) => 0.0,
        };
        friction + inertia * a
    }

    fn measured(&self, run: &PreparedRun, joint: usize, sample: usize) -> f64 {
        let gain = self.found.estimate.joints[joint].gain.filter(|_| run.effort != Effort::Joint);
        run.force(&self.input_matrix, joint, sample) * gain.map_or(1.0, |gain| gain.value)
    }
}
