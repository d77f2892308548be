//! Stribeck laws: nonlinear regression beside the offsets, and the same judgement as for terms.

use super::super::error::Result;
use super::super::offset::centre;
use super::super::result::FrictionLaw;
use super::super::stribeck::{StribeckFit, StribeckRegression, stribeck_torque};
use super::design::{fold_ranges, offset_ranges, offsets};
use super::findings::Findings;
use super::held_out::{Unseen, variation};
use super::judgement::Judged;
use super::report::FrictionReport;
use super::task::{FrictionData, FrictionIdentification, Offsets};
use nalgebra::DMatrix;
use std::ops::Range;

/// The Stribeck law of one joint.
pub(super) fn identify(
    settings: &FrictionIdentification,
    data: &FrictionData,
    regression: &StribeckRegression,
) -> Result<FrictionReport> {
    let separate = settings.offsets == Offsets::Separate;
    let regression = StribeckRegression { offset: separate, ..regression.clone() };
    let runs = offset_ranges(data);
    let (v, torques) = (data.velocities, data.torques);
    let fit = regression.fit_runs(v, torques, data.weights, &runs)?;
    let fit = fit.with_correlated_errors(v, torques, data.weights, &runs);
    let mut findings = Findings::new(data);
    findings.note(format!(
        "Stribeck law{} by least squares, {:?} weights, {} starts, {} passes",
        if separate { " beside the offset of each run" } else { "" },
        regression.robustness,
        regression.starts,
        fit.iterations
    ));
    fit.warnings.iter().for_each(|warning| findings.warn(warning.clone()));
    if settings.passive {
        refuse_driving(&fit, v, &mut findings);
    }
    let unseen = held_out(data, settings, &regression, &fit, &runs);
    let judged = judged(data, &fit, &runs, Some(unseen));
    let mut report = findings.report(settings, judged)?;
    report.condition = fit.condition;
    report.covariance = DMatrix::from_fn(5, 5, |i, j| fit.covariance[(i, j)]);
    Ok(report)
}

fn judged(data: &FrictionData, fit: &StribeckFit, runs: &[Range<usize>], unseen: Option<Unseen>) -> Judged {
    let law: Vec<f64> = data.velocities.iter().map(|v| fit.torque(*v)).collect();
    let mut residuals: Vec<f64> = data.torques.iter().zip(&law).map(|(t, l)| t - l).collect();
    for (run, offset) in runs.iter().zip(&fit.offsets) {
        residuals[run.clone()].iter_mut().for_each(|r| *r -= offset);
    }
    let separate = !fit.offsets.is_empty();
    Judged {
        law: FrictionLaw::stribeck(fit.parameters, fit.standard_errors, fit.resolutions),
        offsets: if separate { offsets(data, runs, &law, &residuals) } else { Vec::new() },
        unseen,
        residuals,
        freedom: fit.freedom as f64,
        stribeck: Some(fit.words()),
    }
}

fn refuse_driving(fit: &StribeckFit, velocities: &[f64], findings: &mut Findings) {
    let fastest = velocities.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
    // The law is odd: one direction is enough.
    let speeds = (1..=200).map(|i| fastest * f64::from(i) / 200.0);
    let driving = speeds.filter(|v| fit.torque(*v) < -1e-9 * fit.torque(fastest).abs()).fold(0.0, f64::max);
    if driving > 0.0 {
        findings.refuse(format!(
            "the Stribeck law drives the joint at up to {driving:.4}: choose a method over terms, which can be kept \
             from it"
        ));
    }
}

/// The fit repeated without each fold in turn, from the law of all samples. A fold is left out by weights of zero.
fn held_out(
    data: &FrictionData,
    settings: &FrictionIdentification,
    regression: &StribeckRegression,
    fit: &StribeckFit,
    runs: &[Range<usize>],
) -> Unseen {
    let ranges = fold_ranges(data, settings.folds);
    let mut unseen = Unseen { residual: 0.0, total: variation(data, regression.offset, &ranges) };
    let weight = |i: usize| data.weights.map_or(1.0, |w| w[i]);
    for fold in &ranges {
        let others = |i: usize| if fold.contains(&i) { 0.0 } else { weight(i) };
        let weights: Vec<f64> = (0..data.velocities.len()).map(others).collect();
        let law = regression.refit(fit, data.velocities, data.torques, &weights, runs);
        let left = |(v, t): (&f64, &f64)| t - stribeck_torque(*v, &law);
        let mut residuals: Vec<f64> = data.velocities.iter().zip(data.torques).map(left).collect();
        if regression.offset {
            // As for terms, a run keeps its offset where a part of it is left out.
            centre(&mut residuals, runs, data.weights);
        }
        unseen.residual += fold.clone().map(|i| weight(i) * residuals[i] * residuals[i]).sum::<f64>();
    }
    unseen
}
