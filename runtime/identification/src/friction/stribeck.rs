//! Stribeck laws: nonlinear regression beside the offsets, and the same judgement as for terms.

use super::super::error::Result;
use super::super::methods::offset::centre;
use super::super::methods::stribeck::{Observed, StribeckFit, StribeckRegression, stribeck_torque};
use super::super::numeric::digits::plain;
use super::super::result::FrictionLaw;
use super::design::{folds, offset_ranges, offsets};
use super::findings::Findings;
use super::held_out::{Unseen, variation};
use super::judgement::Judged;
use super::passivity::beyond;
use super::report::FrictionReport;
use super::task::{FrictionData, FrictionIdentification, Offsets};
use gelenk_findings::Rule;
use nalgebra::DMatrix;
use std::ops::Range;

/// Sees: parameters of a Stribeck law that the data do not tell.
/// Matters: they are guesses.
/// Example: a Stribeck speed below all speeds in the data.
/// Fixture: `methods/stribeck/tests.rs`.
const PARAMETERS: Rule = Rule::warning("stribeck-parameters");

/// Sees: a fit whose Coulomb friction, static friction or Stribeck speed mean nothing.
/// Matters: the law is refused.
/// Example: static friction below Coulomb friction.
/// Fixture: `a_stribeck_law_is_taken_and_another_law_is_refused` in `friction/stribeck.rs`.
const NO_STRIBECK: Rule = Rule::error("no-stribeck-law");

/// Sees: a Stribeck law that drives the joint at some speed.
/// Matters: a controller that compensates it would be unstable.
/// Example: viscous friction below 0.
/// Fixture: `friction/tests.rs`.
const DRIVES: Rule = Rule::error("law-drives");

/// The Stribeck law of one joint.
pub(super) fn identify(
    settings: &FrictionIdentification,
    data: &FrictionData,
    regression: &StribeckRegression,
) -> Result<FrictionReport> {
    let separate = settings.offsets == Offsets::Separate;
    let regression = StribeckRegression { offset: separate, ..regression.clone() };
    let runs = offset_ranges(data);
    let samples = Observed {
        v: data.velocities,
        torque: data.torques,
        weights: data.weights,
        runs: &runs,
        filtered: data.filtered,
    };
    let fit = regression.fit_runs(&samples)?.with_correlated_errors(&samples);
    let mut findings = Findings::new(data);
    findings.note(format!(
        "Stribeck law{} by least squares, samples weigh the same, {} starts, {} passes",
        if separate { " beside the offset of each run" } else { "" },
        regression.starts,
        fit.iterations
    ));
    fit.warnings.iter().for_each(|warning| findings.add(PARAMETERS.found(warning.clone())));
    refuse_other_laws(&fit, data.velocities, &mut findings);
    if settings.passive {
        refuse_driving(&fit, data.velocities, &mut findings);
    }
    let unseen = held_out(data, settings, &regression, &fit, &samples)?;
    let judged = judged(data, &fit, &runs, Some(unseen))?;
    let mut report = findings.report(settings, judged)?;
    report.condition = fit.condition;
    report.covariance = DMatrix::from_fn(5, 5, |i, j| fit.covariance[(i, j)]);
    Ok(report)
}

fn judged(
    data: &FrictionData,
    fit: &StribeckFit,
    runs: &[Range<usize>],
    unseen: Option<Unseen>,
) -> Result<Judged> {
    let law = FrictionLaw::stribeck(fit.parameters, fit.standard_errors, fit.resolutions);
    let torques = data.torques_of(&law)?;
    let mut residuals: Vec<f64> = data.torques.iter().zip(&torques).map(|(t, l)| t - l).collect();
    for (run, offset) in runs.iter().zip(&fit.offsets) {
        residuals[run.clone()].iter_mut().for_each(|r| *r -= offset);
    }
    let separate = !fit.offsets.is_empty();
    Ok(Judged {
        law,
        offsets: if separate { offsets(data, runs, &torques, &residuals) } else { Vec::new() },
        unseen,
        residuals,
        freedom: fit.freedom as f64,
        stribeck: Some(fit.words()),
    })
}

/// Fewest samples that tell of the fall from static to Coulomb friction.
const FEWEST_SLOW: usize = 10;

/// Share of the excess F_s − F_c that the law has to reach somewhere for its words to mean something.
const REACHED: f64 = 0.1;

/// Whether the law without viscous friction rises above F_c anywhere. It does not where the fall is over before the step at
/// zero is.
fn stands_out(fit: &StribeckFit) -> bool {
    let [_, coulomb, step, excess, fall] = fit.parameters;
    let without = [0.0, coulomb, step, excess, fall];
    let mut speeds = (1..=500).map(|i| 0.01 * f64::from(i) / fall);
    speeds.any(|v| stribeck_torque(v, &without) > coulomb + REACHED * excess)
}

/// Refuses a fit that is no Stribeck law: its words (Coulomb, static, Stribeck speed) would mean nothing.
fn refuse_other_laws(fit: &StribeckFit, velocities: &[f64], findings: &mut Findings) {
    let words = fit.words();
    let [coulomb, highest, speed] =
        [words.coulomb, words.static_friction, words.stribeck_speed].map(|word| word.value);
    let fastest = velocities.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
    let slow = velocities.iter().filter(|v| v.abs() < speed).count();
    let (torque, velocity) = (findings.unit, findings.data.velocity_unit);
    let [said_coulomb, said_highest, said_speed, said_fastest] =
        [coulomb, highest, speed, fastest].map(|x| plain(x, 4));
    let faults = [
        (!fit.converged).then(|| format!("the regression did not converge in {} passes", fit.iterations)),
        (coulomb < 0.0).then(|| format!("Coulomb friction F_c = {said_coulomb} {torque} is negative")),
        (highest < coulomb).then(|| {
            format!("static friction F_s = {said_highest} {torque} is less than Coulomb friction F_c = {said_coulomb} {torque}")
        }),
        (speed > fastest).then(|| {
            format!("the Stribeck speed v_s = {said_speed} {velocity} is beyond the fastest motion of {said_fastest} {velocity}")
        }),
        (slow < FEWEST_SLOW).then(|| {
            format!("only {slow} samples are slower than the Stribeck speed v_s = {said_speed} {velocity}")
        }),
        (highest > coulomb && !stands_out(fit)).then(|| {
            format!("its friction nowhere rises above Coulomb friction: the fall by v_s = {said_speed} {velocity} is over within the \
                     step at zero")
        }),
    ];
    let faults: Vec<String> = faults.into_iter().flatten().collect();
    if !faults.is_empty() {
        let remedy = "record slow reversals too, or let terms be chosen (--friction viscous,coulomb)";
        let message = format!("the data show no Stribeck law: {}", faults.join("; "));
        findings.add(NO_STRIBECK.found(message).help(remedy));
    }
}

fn refuse_driving(fit: &StribeckFit, velocities: &[f64], findings: &mut Findings) {
    let fastest = velocities.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
    // The law is odd: one direction is enough.
    let speeds =
        (1..=200).map(|i| fastest * f64::from(i) / 200.0).chain(beyond().map(|factor| factor * fastest));
    let driving = speeds.filter(|v| fit.torque(*v) < -1e-9 * fit.torque(fastest).abs()).fold(0.0, f64::max);
    if driving > 0.0 {
        let remedy = "let terms be chosen, which can be kept from it (--friction viscous,coulomb)";
        let message = format!("the Stribeck law drives the joint at up to {}", plain(driving, 4));
        findings.add(DRIVES.found(message).help(remedy));
    }
}

/// The fit repeated without each fold in turn, from the law of all samples. A fold is left out by weights of zero.
fn held_out(
    data: &FrictionData,
    settings: &FrictionIdentification,
    regression: &StribeckRegression,
    fit: &StribeckFit,
    samples: &Observed,
) -> Result<Unseen> {
    let folds = folds(data, settings.folds);
    let mut unseen = Unseen { residual: 0.0, total: variation(data, regression.offset, &folds.concat()) };
    let weight = |i: usize| data.weights.map_or(1.0, |w| w[i]);
    for fold in &folds {
        let is_left_out = |i: usize| fold.iter().any(|range| range.contains(&i));
        let others = |i: usize| if is_left_out(i) { 0.0 } else { weight(i) };
        let weights: Vec<f64> = (0..samples.v.len()).map(others).collect();
        let law = regression.refit(fit, &Observed { weights: Some(&weights), ..*samples });
        let mut residuals = data.torques.to_vec();
        let torques = data.torques_of(&FrictionLaw::stribeck(law, [None; 5], [None; 5]))?;
        residuals.iter_mut().zip(torques).for_each(|(left, law)| *left -= law);
        if regression.offset {
            // As for terms, a run keeps its offset where a part of it is left out.
            centre(&mut residuals, samples.runs, data.weights);
        }
        unseen.residual +=
            fold.iter().cloned().flatten().map(|i| weight(i) * residuals[i] * residuals[i]).sum::<f64>();
    }
    Ok(unseen)
}

#[cfg(test)]
mod tests {
    use super::super::super::friction::FrictionMethod;
    use super::super::super::numeric::random::SplitMix64;
    use super::*;

    /// A Stribeck law, or viscous and Coulomb friction alone, along sines with noise; the refusals of the fit.
    fn refusal(excess: f64, speed: f64) -> (FrictionReport, Vec<String>) {
        let mut random = SplitMix64::new(5);
        let velocities: Vec<f64> = (0..4000).map(|i| 1.5 * (0.004 * f64::from(i)).sin()).collect();
        let torque = |v: &f64| {
            stribeck_torque(*v, &[2.0, 3.0, 100.0, excess, 1.0 / speed])
                + 0.05 * (2.0 * random.uniform() - 1.0)
        };
        let torques: Vec<f64> = velocities.iter().map(torque).collect();
        let data = FrictionData {
            joint: "elbow",
            unit: "N·m",
            velocity_unit: "rad/s",
            velocities: &velocities,
            torques: &torques,
            ..FrictionData::default()
        };
        let method = FrictionMethod::Stribeck(StribeckRegression::default());
        let report = FrictionIdentification { method, ..FrictionIdentification::new().unwrap() }
            .identify(&data)
            .unwrap();
        let refusal = report.result.refusals().map(ToString::to_string).collect();
        (report, refusal)
    }

    /// The truth is given, so are the words that a right fit must find.
    #[test]
    fn a_stribeck_law_is_taken_and_another_law_is_refused() {
        let (report, none) = refusal(2.0, 0.1);
        assert!(none.is_empty(), "{none:?}");
        let words = report.result.stribeck.unwrap();
        assert!((words.static_friction.value - 5.0).abs() < 0.1, "{words:?}");
        assert!((words.stribeck_speed.value - 0.1).abs() < 0.01, "{words:?}");
        let note = report.result.settings.iter().find(|note| note.starts_with("Stribeck law"));
        assert!(note.is_some_and(|note| note.contains("samples weigh the same")), "{note:?}");
        // Friction that grows where Stribeck's falls, one that falls faster than it can be seen, and none that falls.
        for (excess, speed, reason) in
            [(-2.0, 0.3, "is less than Coulomb"), (2.0, 20.0, "v_s ="), (0.0, 0.1, "no Stribeck law")]
        {
            let (report, refusal) = refusal(excess, speed);
            assert!(
                refusal.iter().any(|said| said.contains(reason)),
                "{refusal:?} {:?}",
                report.result.stribeck
            );
        }
    }
}
