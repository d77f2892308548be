//! Quality of the written description, joint by joint. It can differ from the quality of the estimate of all joints: the
//! written friction law may have other terms, and offsets of the sensors are not written.

use super::super::error::Result;
use super::super::estimation::{Estimate, JointEstimate};
use super::super::friction::FrictionReport;
use super::super::friction::joint_samples::kept;
use super::super::methods::confidence::{LongRun, quantile};
use super::super::methods::offset::{centre, mean};
use super::super::preparation::Filter;
use super::super::result::{CONFIDENCE, FrictionResult, FrictionTerm};
use super::super::robot::Robot;
use super::super::run::PreparedRun;
use super::levels;
use gelenk_findings::digits::plain;
use gelenk_findings::{Finding, Rule};
use std::ops::Range;

/// Sees: a friction law that explains the efforts less well than viscous and Coulomb friction would.
/// Matters: the law needs more terms than the requested ones.
/// Example: `--friction viscous` of a joint with Coulomb friction.
/// Fixture: `codegen/tests/external_arm/doubts.rs`.
const TOO_FEW_TERMS: Rule = Rule::warning("too-few-terms");

/// Sees: an offset of the efforts that lowers R² by more than 0.01 and is not written.
/// Matters: the written description predicts efforts without this offset.
/// Example: a torque sensor with a zero error.
/// Fixture: `codegen/tests/external_arm/offsets.rs`.
const OFFSET: Rule = Rule::warning("offset-not-written");

/// Sets the statistics of a joint's fit to those of its friction law. Adds a warning to the law if the law explains the efforts
/// much less well than the friction terms of the estimate.
///
/// The held-out error becomes the larger one of the estimate's and the law's held-out errors. Both are computed without the
/// held-out data. However, the law is fitted to efforts minus the forces of bodies that were fitted to all data. Offsets of
/// the runs are not part of these errors.
pub(crate) fn judge(joint: &mut JointEstimate, law: &mut FrictionResult) {
    let total = joint.sigma.powi(2) / (1.0 - joint.r_squared);
    let of_friction = law.residual.powi(2) / (1.0 - law.r_squared);
    if !(total.is_finite() && of_friction.is_finite() && total > 0.0) {
        return;
    }
    let unseen = law.held_out.map_or(law.residual.powi(2), |r_squared| (1.0 - r_squared) * of_friction);
    let before = joint.held_out_r_squared;
    joint.held_out_r_squared = before.min(1.0 - unseen / total);
    let loss = before - joint.held_out_r_squared;
    joint.held_out_with_rest -= loss;
    joint.r_squared = 1.0 - law.residual.powi(2) / total;
    joint.sigma = law.residual;
    if loss > levels::NOTICEABLE.get() {
        let message = format!(
            "viscous and Coulomb friction would explain the efforts better than the friction law. R² on held-out data is {} instead of {}",
            plain(joint.held_out_r_squared, 3),
            plain(before, 3)
        );
        law.findings.push(
            TOO_FEW_TERMS.found(message).help("allow more terms in the friction law with `--friction`"),
        );
    }
}

/// Data for the prediction of a joint's force by the written description.
pub(crate) struct Written<'a> {
    pub(crate) robot: &'a dyn Robot,
    pub(crate) filter: &'a Filter,
    pub(crate) joint: usize,
}

impl Written<'_> {
    /// Returns the written friction of the joint after the filter of the efforts: the law with its constant, or the
    /// described friction if there is no law. Load-dependent friction is not included.
    ///
    /// # Errors
    /// The errors are those of [`super::super::result::FrictionLaw::torques`].
    pub(crate) fn friction(&self, law: Option<&FrictionResult>, velocities: &[f64]) -> Result<Vec<f64>> {
        let sharp = match law {
            Some(result) => result.law.torques(velocities)?,
            None => velocities.iter().map(|v| self.robot.friction(self.joint, *v)).collect(),
        };
        let level = law.map_or(0.0, FrictionResult::level);
        Ok(self.filter.apply(&sharp).into_iter().map(|torque| torque + level).collect())
    }

    /// Determines the constant of a law, and predicts the joint's force in the fitted runs. The statistics of
    /// the joint's fit become those of this prediction.
    ///
    /// # Errors
    /// The errors are those of [`Self::friction`].
    pub(crate) fn predict(
        &self,
        estimate: &mut Estimate,
        law: Option<&mut FrictionReport>,
        runs: &[PreparedRun],
    ) -> Result<()> {
        let left = self.left(estimate, law.as_deref().map(|report| &report.result), runs)?;
        let moving = |(errors, run): (&Vec<f64>, &PreparedRun)| -> Vec<f64> {
            kept(run, self.joint, errors).map(|i| errors[i]).collect()
        };
        let errors: Vec<Vec<f64>> = left.iter().zip(runs).map(moving).collect();
        let joint = &estimate.joints[self.joint];
        let offsets = by_recording(runs, &errors);
        let mut level = 0.0;
        if let Some(report) = law {
            report.result.constant = repeated(&offsets, &errors, joint, estimate.freedom);
            level = report.result.level();
            report.result.offsets.iter_mut().for_each(|offset| offset.value -= level);
        }
        for (index, left) in left.iter().enumerate() {
            let forces = estimate.measured[index][self.joint].iter().zip(left);
            estimate.predicted[index][self.joint] =
                forces.map(|(force, error)| force - error + level).collect();
        }
        estimate.joints[self.joint].offsets.iter_mut().for_each(|offset| *offset -= level);
        let doubt = self.leave_out_offsets(estimate, runs, offsets.len());
        estimate.findings.extend(doubt);
        Ok(())
    }

    /// Returns measured minus predicted forces of each run.
    fn left(
        &self,
        estimate: &Estimate,
        law: Option<&FrictionResult>,
        runs: &[PreparedRun],
    ) -> Result<Vec<Vec<f64>>> {
        let of_run = |(index, run): (usize, &PreparedRun)| {
            let mut left = estimate.friction[index][self.joint].clone();
            let friction = self.friction(law, &run.velocities[self.joint])?;
            left.iter_mut().zip(friction).for_each(|(left, friction)| *left -= friction);
            if let Some(load) = estimate.load_friction.get(index).filter(|_| law.is_some()) {
                left.iter_mut().zip(&load[self.joint]).for_each(|(left, load)| *left -= load);
            }
            Ok(left)
        };
        runs.iter().enumerate().map(of_run).collect()
    }

    /// Sets the statistics of the joint's fit to those of a model without the offsets that are not written. Returns a warning
    /// if R² is noticeably lower without these offsets.
    fn leave_out_offsets(
        &self,
        estimate: &mut Estimate,
        runs: &[PreparedRun],
        recordings: usize,
    ) -> Option<Finding> {
        let (mut fitted, mut written, mut measured) = (0.0, 0.0, Vec::new());
        for (index, run) in runs.iter().enumerate() {
            let offset = estimate.joints[self.joint].offsets[index];
            let forces = &estimate.measured[index][self.joint];
            let predicted = &estimate.predicted[index][self.joint];
            for i in kept(run, self.joint, predicted) {
                let error = forces[i] - predicted[i];
                fitted += (error - offset).powi(2);
                written += error.powi(2);
                measured.push(forces[i]);
            }
        }
        let samples = measured.len() as f64;
        let middle = mean(&measured);
        let total: f64 = measured.iter().map(|force| (force - middle).powi(2)).sum::<f64>() / samples;
        let joint = &mut estimate.joints[self.joint];
        let within = joint.sigma.powi(2) / (1.0 - joint.r_squared);
        if !(within.is_finite() && total > 0.0) {
            return None;
        }
        let (fitted, cost) = (fitted / samples, (written - fitted) / samples);
        let unseen = ((1.0 - joint.held_out_r_squared) * within).max(fitted);
        let before = joint.held_out_r_squared;
        joint.sigma = (fitted + cost).sqrt();
        joint.r_squared = 1.0 - (fitted + cost) / total;
        joint.held_out_r_squared = 1.0 - (unseen + cost) / total;
        joint.held_out_with_rest -= before - joint.held_out_r_squared;
        let doubt = (cost > levels::NOTICEABLE.get() * total)
            .then(|| not_written(joint, recordings, 1.0 - unseen / total));
        doubt.map(|doubt| doubt.of(self.robot.subject(self.joint)))
    }
}

/// Returns the mean prediction error of each recording. All parts of a recording have the same offset.
fn by_recording(runs: &[PreparedRun], errors: &[Vec<f64>]) -> Vec<f64> {
    let mut all: Vec<(&str, Vec<f64>)> = Vec::new();
    for (run, errors) in runs.iter().zip(errors).filter(|(_, errors)| !errors.is_empty()) {
        match all.iter_mut().find(|(name, _)| *name == run.name) {
            Some((_, known)) => known.extend(errors),
            None => all.push((&run.name, errors.clone())),
        }
    }
    all.iter().map(|(_, errors)| mean(errors)).collect()
}

/// Returns the constant c of a law, which is the mean of the offsets of n ≥ 2 recordings. The result is `None` if |c| ≤
/// √((t s/√n)² + (t' e)²), with
///
/// - s: standard deviation of the offsets
/// - e: standard error of the mean of the residuals, which are correlated
/// - t, t': quantiles of Student's t distribution
///
/// The test uses the estimates of the other parameters as if they were exact. Their errors count only in the confidence
/// interval of c.
///
/// - `freedom`: degrees of freedom of the estimate
fn repeated(
    offsets: &[f64],
    errors: &[Vec<f64>],
    joint: &JointEstimate,
    freedom: usize,
) -> Option<FrictionTerm> {
    let n = offsets.len() as f64;
    let constant = mean(offsets);
    let spread =
        (offsets.iter().map(|offset| (offset - constant).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt();
    let ranges = ranges(errors);
    let mut left = errors.concat();
    centre(&mut left, &ranges);
    let noise = LongRun::of_sum(&left, &ranges);
    let alone = noise.standard_error() / left.len() as f64;
    let known = joint.offset_errors.iter().copied().fold(0.0, f64::max);
    let half = |freedom: f64, error: f64| quantile(CONFIDENCE, freedom).map_or(f64::INFINITY, |t| t * error);
    let random = half(n - 1.0, spread).hypot(half(noise.freedom, alone));
    (offsets.len() > 1 && constant.abs() > random).then(|| FrictionTerm {
        basis: "1".into(),
        coefficient: constant,
        standard_error: Some(spread.hypot(known)),
        reach: Some(random.hypot(half(freedom.max(1) as f64, known))),
        resolution: Some(spread.hypot(alone)),
        ..FrictionTerm::default()
    })
}

/// Returns the samples of each run as a range of indices into the samples of all runs.
fn ranges(runs: &[Vec<f64>]) -> Vec<Range<usize>> {
    let mut start = 0;
    let range = |run: &Vec<f64>| {
        start += run.len();
        start - run.len()..start
    };
    runs.iter().map(range).collect()
}

/// Returns the warning about offsets that are not written.
///
/// - `recordings`: number of recordings
/// - `with_offsets`: R² on held-out data with offsets
fn not_written(joint: &JointEstimate, recordings: usize, with_offsets: f64) -> Finding {
    let ends = [f64::min, f64::max].map(|of| joint.offsets.iter().copied().reduce(of).unwrap_or_default());
    let [low, high] = ends.map(|end| plain(end, 3));
    let unit = joint.unit;
    let said = match recordings {
        1 => format!(
            "its offset of {high} {unit} is not part of the law. One run does not show whether the offset is the same in every run"
        ),
        n => format!(
            "its offsets of {low} to {high} {unit} are not part of the law, because the {n} runs do not show a common offset"
        ),
    };
    let message = format!(
        "{said}: R² on held-out data is {} without the offset and {} with it",
        plain(joint.held_out_r_squared, 3),
        plain(with_offsets, 3)
    );
    OFFSET
        .found(message)
        .help("give logs of more runs. An offset that is the same in all runs becomes a constant of the law")
}
