//! How well a joint's force is explained by the description that is written: by its friction law, which need not have the
//! terms of the common estimate, and without the offsets of the sensors, which are not written.

use super::super::error::Result;
use super::super::estimation::{Estimate, JointEstimate};
use super::super::friction::FrictionReport;
use super::super::friction::joint_samples::kept;
use super::super::methods::confidence::{LongRun, quantile};
use super::super::numeric::digits::plain;
use super::super::preparation::Filter;
use super::super::result::{CONFIDENCE, FrictionResult, FrictionTerm};
use super::super::robot::Robot;
use super::super::run::PreparedRun;
use gelenk_findings::{Finding, Rule};
use std::ops::Range;

/// Sees: a law that explains less than viscous and Coulomb friction would.
/// Matters: the terms that were asked for are too few.
/// Example: `--friction viscous` of a joint with Coulomb friction.
/// Fixture: `codegen/tests/external_arm/doubts.rs`.
const TOO_FEW_TERMS: Rule = Rule::warning("too-few-terms");

/// Sees: an offset of the efforts that costs more than a hundredth of R², and that is not written.
/// Matters: the written description predicts efforts without it.
/// Example: a torque sensor with a zero error.
/// Fixture: `codegen/tests/external_arm/offsets.rs`.
const OFFSET: Rule = Rule::warning("offset-not-written");

/// Loss of held-out R² from which it is said.
const NOTICEABLE: f64 = 0.01;

/// Gives a joint the numbers of its law, and the law a warning where it explains much less than the estimate's own terms.
///
/// The held-out error is the larger one of the estimate's and the law's: neither knows the left-out data, and the law's is
/// next to bodies that do. Offsets of the runs are left out of all of them.
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
    if loss > NOTICEABLE {
        let message = format!(
            "the terms of the law explain less than friction with viscous and Coulomb terms of its own would: R² on held-out data is \
             {} instead of {}",
            plain(joint.held_out_r_squared, 3),
            plain(before, 3)
        );
        law.findings.push(TOO_FEW_TERMS.found(message).help("let more terms be chosen (--friction)"));
    }
}

/// A joint whose force is predicted by the written description.
pub(crate) struct Written<'a> {
    pub(crate) robot: &'a dyn Robot,
    pub(crate) filter: &'a Filter,
    pub(crate) joint: usize,
}

impl Written<'_> {
    /// Friction as it is written, through the filter of the efforts: the law with its constant, or the described friction.
    /// Friction under load is not in it.
    ///
    /// # Errors
    /// As [`super::super::result::FrictionLaw::torques`].
    pub(crate) fn friction(&self, law: Option<&FrictionResult>, velocities: &[f64]) -> Result<Vec<f64>> {
        let sharp = match law {
            Some(result) => result.law.torques(velocities)?,
            None => velocities.iter().map(|v| self.robot.friction(self.joint, *v)).collect(),
        };
        let level = law.map_or(0.0, FrictionResult::level);
        Ok(self.filter.apply(&sharp).into_iter().map(|torque| torque + level).collect())
    }

    /// Finds the constant of a law, predicts the joint's force in the fitted runs, and gives the joint the numbers of this prediction.
    ///
    /// # Errors
    /// As [`Self::friction`].
    pub(crate) fn predict(
        &self,
        estimate: &mut Estimate,
        law: Option<&mut FrictionReport>,
        runs: &[PreparedRun],
    ) -> Result<()> {
        let residuals = self.residuals(estimate, law.as_deref(), runs)?;
        let joint = &estimate.joints[self.joint];
        let offsets = by_recording(runs, &residuals, &joint.offsets);
        let mut level = 0.0;
        if let Some(report) = law {
            report.result.constant = repeated(&offsets, &residuals, joint, estimate.freedom);
            level = report.result.level();
            report.result.offsets.iter_mut().for_each(|offset| offset.value -= level);
        }
        estimate.joints[self.joint].offsets.iter_mut().for_each(|offset| *offset -= level);
        let doubt = self.judge(estimate, &residuals, (runs, offsets.len()));
        estimate.findings.extend(doubt);
        Ok(())
    }

    /// Measured minus predicted forces of each run beyond its offset, where the joint moves.
    fn residuals(
        &self,
        estimate: &Estimate,
        law: Option<&FrictionReport>,
        runs: &[PreparedRun],
    ) -> Result<Vec<Vec<f64>>> {
        let mut of_law = law.map(|report| report.residuals.iter().copied());
        let of_run = |(index, run): (usize, &PreparedRun)| {
            let torques = &estimate.friction[index][self.joint];
            let kept = kept(run, self.joint, torques);
            if let Some(residuals) = &mut of_law {
                return Ok(kept.zip(residuals).map(|(_, residual)| residual).collect());
            }
            let described = self.friction(None, &run.velocities[self.joint])?;
            let offset = estimate.joints[self.joint].offsets[index];
            Ok(kept.map(|i| torques[i] - described[i] - offset).collect())
        };
        runs.iter().enumerate().map(of_run).collect()
    }

    /// Predicted forces and numbers without the offsets that are left; a warning if these cost much.
    fn judge(
        &self,
        estimate: &mut Estimate,
        residuals: &[Vec<f64>],
        (runs, recordings): (&[PreparedRun], usize),
    ) -> Option<Finding> {
        let (mut fitted, mut written, mut measured) = (0.0, 0.0, Vec::new());
        for (index, run) in runs.iter().enumerate() {
            let offset = estimate.joints[self.joint].offsets[index];
            let forces = &estimate.measured[index][self.joint];
            let predicted = &mut estimate.predicted[index][self.joint];
            for (i, residual) in
                kept(run, self.joint, &estimate.friction[index][self.joint]).zip(&residuals[index])
            {
                predicted[i] = forces[i] - residual - offset;
                fitted += residual * residual;
                written += (residual + offset).powi(2);
                measured.push(forces[i]);
            }
        }
        let samples = measured.len() as f64;
        let mean = measured.iter().sum::<f64>() / samples;
        let total: f64 = measured.iter().map(|force| (force - mean).powi(2)).sum::<f64>() / samples;
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
        let doubt = (cost > NOTICEABLE * total).then(|| not_written(joint, recordings, 1.0 - unseen / total));
        doubt.map(|doubt| doubt.of(self.robot.subject(self.joint)))
    }
}

/// Offset of each recording, parts of which share it.
fn by_recording(runs: &[PreparedRun], residuals: &[Vec<f64>], offsets: &[f64]) -> Vec<f64> {
    let mut sums: Vec<(&str, f64, f64)> = Vec::new();
    for ((run, residuals), offset) in
        runs.iter().zip(residuals).zip(offsets).filter(|((_, r), _)| !r.is_empty())
    {
        let samples = residuals.len() as f64;
        let sum = samples * offset + residuals.iter().sum::<f64>();
        match sums.iter_mut().find(|(name, ..)| *name == run.name) {
            Some((_, total, count)) => (*total, *count) = (*total + sum, *count + samples),
            None => sums.push((&run.name, sum, samples)),
        }
    }
    sums.into_iter().map(|(_, sum, samples)| sum / samples).collect()
}

/// The mean c of the offsets of n ≥ 2 recordings, if |c| > √((t s/√n)² + (t' e)²) with their standard deviation s, the standard
/// error e of the residuals' mean, which are correlated, and Student's t. The rest of the description is that with which c was
/// found, so that its errors do not count here. They count in the interval.
///
/// - `freedom`: degrees of freedom of the estimate
fn repeated(
    offsets: &[f64],
    residuals: &[Vec<f64>],
    joint: &JointEstimate,
    freedom: usize,
) -> Option<FrictionTerm> {
    let n = offsets.len() as f64;
    let mean = offsets.iter().sum::<f64>() / n;
    let spread = (offsets.iter().map(|offset| (offset - mean).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt();
    let noise = LongRun::of_sum(&residuals.concat(), &ranges(residuals));
    let samples: usize = residuals.iter().map(Vec::len).sum();
    let alone = noise.standard_error() / samples as f64;
    let known = joint.offset_errors.iter().copied().fold(0.0, f64::max);
    let half = |freedom: f64, error: f64| quantile(CONFIDENCE, freedom).map_or(f64::INFINITY, |t| t * error);
    let random = half(n - 1.0, spread).hypot(half(noise.freedom, alone));
    (offsets.len() > 1 && mean.abs() > random).then(|| FrictionTerm {
        basis: "1".into(),
        coefficient: mean,
        standard_error: Some(spread.hypot(known)),
        reach: Some(random.hypot(half(freedom.max(1) as f64, known))),
        resolution: Some(spread.hypot(alone)),
        ..FrictionTerm::default()
    })
}

/// The samples of each run among those of all.
fn ranges(runs: &[Vec<f64>]) -> Vec<Range<usize>> {
    let mut start = 0;
    let range = |run: &Vec<f64>| {
        start += run.len();
        start - run.len()..start
    };
    runs.iter().map(range).collect()
}

/// - `recordings`: how many there are
/// - `with_offsets`: R² on held-out data
fn not_written(joint: &JointEstimate, recordings: usize, with_offsets: f64) -> Finding {
    let ends = [f64::min, f64::max].map(|of| joint.offsets.iter().copied().reduce(of).unwrap_or_default());
    let [low, high] = ends.map(|end| plain(end, 3));
    let unit = joint.unit;
    let said = match recordings {
        1 => format!(
            "its offset of {high} {unit} is not part of the law, because one run does not tell whether it repeats"
        ),
        n => format!(
            "its offsets of {low} to {high} {unit} are not part of the law, because {n} runs do not tell whether they repeat"
        ),
    };
    let message = format!(
        "{said}: R² on held-out data is {} without and {} with an offset",
        plain(joint.held_out_r_squared, 3),
        plain(with_offsets, 3)
    );
    OFFSET.found(message).help("give logs of more runs: an offset that repeats becomes a constant of the law")
}
