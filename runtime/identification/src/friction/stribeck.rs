//! Stribeck laws by nonlinear regression, with the same acceptance tests as for laws of terms.

use super::super::error::Result;
use super::super::methods::moments::Samples;
use super::super::methods::stribeck::{NAMES, Observed, StribeckFit, StribeckRegression, slower};
use super::super::numeric::statistics::simplest;
use super::super::result::FrictionLaw;
use super::design::{folds, runs};
use super::errors::Errors;
use super::findings::Findings;
use super::held_out::{HeldOutErrors, variation};
use super::judgement::LawFit;
use super::levels;
use super::passivity::beyond;
use super::report::FrictionReport;
use super::task::{FrictionData, FrictionIdentification};
use gelenk_findings::digits::plain;
use gelenk_findings::{Finding, Rule};
use nalgebra::{DMatrix, SMatrix};
use std::ops::Range;

/// Sees: a fit whose Coulomb friction, static friction or Stribeck speed has no physical meaning.
/// Matters: the law is refused.
/// Example: static friction below Coulomb friction.
/// Fixture: `a_stribeck_law_is_taken_and_another_law_is_refused` in `friction/stribeck.rs`.
const NO_STRIBECK: Rule = Rule::error("no-stribeck-law");

/// Sees: a Stribeck law that drives the joint at some speed.
/// Matters: a controller that compensates this friction would be unstable.
/// Example: viscous friction below 0.
/// Fixture: `friction/tests.rs`.
const DRIVES: Rule = Rule::error("law-drives");

/// Identifies the Stribeck law of one joint.
pub(super) fn identify(
    settings: &FrictionIdentification,
    data: &FrictionData,
    regression: &StribeckRegression,
) -> Result<FrictionReport> {
    let runs = runs(data);
    let mut attempt = Attempt::new(settings, data, regression, &runs)?;
    let doubts = attempt.fit.warnings.iter().chain(&attempt.other_law).cloned();
    attempt.findings.all.splice(0..0, doubts);
    attempt.judged(settings)
}

/// The Stribeck law of one joint, or the law of terms. The Stribeck law is chosen if its error on held-out data is smaller by
/// more than one standard error (Breiman 1984).
///
/// The Stribeck law is a curve here, and its parameters may have no physical meaning. A law with a peak at speeds too low to
/// be resolved by the data is refused, because sticking before a reversal causes such a peak. If the regression fails, the law
/// of terms is returned.
pub(super) fn or_simpler(
    settings: &FrictionIdentification,
    data: &FrictionData,
    regression: &StribeckRegression,
    terms: FrictionReport,
) -> Result<FrictionReport> {
    let runs = runs(data);
    let Ok(attempt) = Attempt::new(settings, data, regression, &runs) else { return Ok(terms) };
    if !attempt.findings.all.is_empty() || !falls(&attempt.fit, data) {
        return Ok(terms);
    }
    let stribeck = attempt.judged(settings)?;
    let (Some(simpler), Some(other)) = (terms.unseen_error, stribeck.unseen_error) else { return Ok(terms) };
    let is_better = simplest(&[simpler, other]).is_some_and(|[_, choice]| choice == 1);
    Ok(if is_better && stribeck.result.refusals().next().is_none() { stribeck } else { terms })
}

/// A Stribeck law before its test on held-out data.
struct Attempt<'a> {
    regression: &'a StribeckRegression,
    samples: Observed<'a>,
    fit: StribeckFit,
    errors: Errors,
    /// The finding that parameters of the fit have no physical meaning; `None` if all of them have a meaning.
    other_law: Option<Finding>,
    /// Findings because of which the curve is refused.
    findings: Findings<'a>,
}

impl<'a> Attempt<'a> {
    fn new(
        settings: &FrictionIdentification,
        data: &'a FrictionData,
        regression: &'a StribeckRegression,
        runs: &'a [Range<usize>],
    ) -> Result<Self> {
        let samples = Observed {
            v: data.velocities,
            torque: data.torques,
            weights: None,
            runs,
            filtered: data.filtered,
        };
        let mut fit = regression.fit_runs(&samples)?;
        let errors = errors(data, &samples, &fit)?;
        fit.covariance = SMatrix::from_fn(|i, k| errors.covariance[(i, k)]);
        fit.standard_errors = std::array::from_fn(|i| fit.standard_errors[i].map(|_| errors.standard[i]));
        let mut findings = Findings::new(data);
        findings.note(format!(
            "the Stribeck law was fitted by nonlinear least squares with equal weights of all samples ({} starts, {} passes)",
            regression.starts, fit.iterations
        ));
        if settings.passive {
            refuse_driving(&fit, &mut findings);
        }
        let other_law = other_law(&fit, data);
        Ok(Self { regression, samples, fit, errors, other_law, findings })
    }

    fn judged(self, settings: &FrictionIdentification) -> Result<FrictionReport> {
        let unseen = self.held_out(settings)?;
        let Self { fit, errors, other_law, findings, .. } = self;
        let data = findings.data;
        let term = |i: usize| errors.term(i, NAMES[i], fit.parameters[i]);
        let law = FrictionLaw::Stribeck(Box::new(std::array::from_fn(term)));
        let torques = data.torques_of(&law)?;
        let residuals = data.torques.iter().zip(&torques).map(|(t, l)| t - l).collect();
        let judged = LawFit {
            stribeck: other_law.is_none().then(|| fit.words()),
            ..LawFit::of_samples(data, law, Some(unseen), residuals, errors)
        };
        findings.report(settings, judged)
    }

    /// Errors on held-out data: the fit is repeated without each fold in turn, and it starts at the law of all samples. A fold
    /// is left out by weights of zero.
    fn held_out(&self, settings: &FrictionIdentification) -> Result<HeldOutErrors> {
        let Self { regression, samples, fit, findings, .. } = self;
        let data = findings.data;
        let folds = folds(data, settings.folds);
        let total = variation(data, &folds.concat());
        let error = |fold: &Vec<Range<usize>>| {
            let is_left_out = |i: usize| fold.iter().any(|range| range.contains(&i));
            let others = |i: usize| if is_left_out(i) { 0.0 } else { 1.0 };
            let weights: Vec<f64> = (0..samples.v.len()).map(others).collect();
            let law = regression.refit(fit, &Observed { weights: Some(&weights), ..*samples });
            let mut residuals = data.torques.to_vec();
            let torques = data.torques_of(&FrictionLaw::stribeck(law, [None; 5], [None; 5]))?;
            residuals.iter_mut().zip(torques).for_each(|(left, law)| *left -= law);
            let squares = fold.iter().cloned().flatten().map(|i| residuals[i] * residuals[i]);
            Ok([squares.clone().sum(), squares.count() as f64])
        };
        Ok(HeldOutErrors { folds: folds.iter().map(error).collect::<Result<_>>()?, total })
    }
}

/// Errors of the parameters to first order: those of a law whose terms are the derivatives of the torque with respect to the
/// parameters. Parameters that the data do not determine are held, and their errors are infinite.
fn errors(data: &FrictionData, samples: &Observed, fit: &StribeckFit) -> Result<Errors> {
    let columns = samples.columns(&fit.parameters);
    let [derivatives @ .., residuals] = &columns;
    let columns = derivatives.iter().map(Vec::as_slice).collect();
    let terms = Samples::from_columns(&NAMES.map(str::to_owned), columns, vec![data.torques])?;
    let lost: Vec<usize> = (0..NAMES.len()).filter(|i| fit.standard_errors[*i].is_none()).collect();
    let held = DMatrix::identity(NAMES.len(), NAMES.len()).select_rows(&lost);
    let mut errors = Errors::of_samples(data, &terms, &held, residuals)?;
    for i in lost {
        (errors.standard[i], errors.resolution[i], errors.reach[i]) = (f64::INFINITY, f64::INFINITY, None);
    }
    Ok(errors)
}

/// Whether static friction is not less than Coulomb friction, and the law has no peak at speeds too low to be resolved by the
/// data.
fn falls(fit: &StribeckFit, data: &FrictionData) -> bool {
    let resolved = data.resolved_from();
    let bound = levels::MOST_UNRESOLVED.get() * fit.torque(resolved).abs();
    fit.parameters[3] >= 0.0 && slower(resolved).all(|v| fit.torque(v).abs() <= bound)
}

/// The finding that a fit is not a Stribeck law, because its Coulomb friction, static friction or Stribeck speed has no
/// physical meaning; `None` if all three have a meaning.
fn other_law(fit: &StribeckFit, data: &FrictionData) -> Option<Finding> {
    let words = fit.words();
    let [coulomb, highest, speed] =
        [words.coulomb, words.static_friction, words.stribeck_speed].map(|word| word.value);
    let fastest = data.fastest();
    let (torque, velocity) = (data.unit, data.velocity_unit);
    let [said_coulomb, said_highest, said_speed, said_fastest] =
        [coulomb, highest, speed, fastest].map(|x| plain(x, 4));
    let error = fit.standard_errors[3].unwrap_or(f64::INFINITY);
    let differ = highest - coulomb > levels::DISTINCT.get() * error;
    let faults = [
        (!fit.converged).then(|| format!("the regression did not converge in {} passes", fit.iterations)),
        (coulomb < 0.0).then(|| format!("Coulomb friction F_c = {said_coulomb} {torque} is negative")),
        (highest < coulomb).then(|| {
            format!("static friction F_s = {said_highest} {torque} is less than Coulomb friction F_c = {said_coulomb} {torque}")
        }),
        (highest >= coulomb && !differ).then(|| {
            format!("static friction F_s = {said_highest} {torque} cannot be distinguished from Coulomb friction F_c = \
                     {said_coulomb} {torque}")
        }),
        (speed > fastest).then(|| {
            format!("the Stribeck speed v_s = {said_speed} {velocity} is above the fastest motion of {said_fastest} {velocity}")
        }),
    ];
    let faults: Vec<String> = faults.into_iter().flatten().collect();
    let remedy = "record slow reversals too, or leave --friction out";
    let message = format!("the data show no Stribeck law: {}", faults.join("; "));
    (!faults.is_empty()).then(|| NO_STRIBECK.found(message).help(remedy))
}

fn refuse_driving(fit: &StribeckFit, findings: &mut Findings) {
    let fastest = findings.data.fastest();
    // The law is odd, so that one direction is enough.
    let speeds = (1..=200).map(|i| fastest * f64::from(i) / 200.0);
    let speeds = speeds.chain(slower(fastest)).chain(beyond().map(|factor| factor * fastest));
    let driving = speeds.filter(|v| fit.torque(*v) < -1e-9 * fit.torque(fastest).abs()).fold(0.0, f64::max);
    if driving > 0.0 {
        let remedy = "name the terms of the law, as in --friction viscous,coulomb. Such a law is fitted so that it always brakes";
        let (speed, unit) = (plain(driving, 4), findings.data.velocity_unit);
        let message = format!("the Stribeck law drives the joint at speeds up to {speed} {unit}");
        findings.add(DRIVES.found(message).help(remedy));
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::friction::FrictionMethod;
    use super::super::super::methods::stribeck::stribeck_torque;
    use super::super::super::numeric::random::SplitMix64;
    use super::*;

    /// Whether the Stribeck law is taken before terms for the torques of a law along sines.
    fn is_taken(law: impl Fn(f64) -> f64) -> bool {
        let mut random = SplitMix64::new(5);
        let velocities: Vec<f64> = (0..4000).map(|i| 1.5 * (0.0041 * f64::from(i)).sin()).collect();
        let torques: Vec<f64> = velocities.iter().map(|v| law(*v) + 0.05 * random.normal()).collect();
        let data = FrictionData { velocities: &velocities, torques: &torques, ..FrictionData::default() };
        let method = FrictionMethod::Ladder(StribeckRegression::default());
        let settings = FrictionIdentification { method, ..FrictionIdentification::new().unwrap() };
        matches!(settings.identify(&data).unwrap().result.law, FrictionLaw::Stribeck(_))
    }

    #[test]
    fn a_stribeck_law_is_taken_before_terms_if_it_predicts_better() {
        // A fall that no term has, and one that ends in the least speeds.
        assert!(is_taken(|v| stribeck_torque(v, &[2.0, 3.0, 30.0, 4.0, 2.0])));
        assert!(is_taken(|v| stribeck_torque(v, &[0.6, 12.4, 1.2, 80.0, 20.0])));
        for [viscous, coulomb, slope] in
            [[4.0, 3.0, 100.0], [4.0, 0.0, 1.0], [0.0, 3.0, 20.0], [1.0, 2.0, 5.0]]
        {
            assert!(!is_taken(|v| viscous * v + coulomb * (slope * v).tanh()), "{viscous} {coulomb} {slope}");
        }
        // A peak within the slowest ten samples, and a law that drives the joint there.
        assert!(!is_taken(|v| stribeck_torque(v, &[2.0, 3.0, 1000.0, 200.0, 1000.0])));
        assert!(!is_taken(|v| stribeck_torque(v, &[2.0, 3.0, 1000.0, -30.0, 100.0])));
    }

    /// Five samples are enough for a law of terms, and too few for the Stribeck law.
    #[test]
    fn too_few_samples_for_the_stribeck_law_leave_the_law_of_terms() {
        let (velocities, torques) = ([-1.0, -0.5, 0.25, 0.5, 1.0], [-2.0, -1.01, 0.5, 1.01, 2.0]);
        let data = FrictionData { velocities: &velocities, torques: &torques, ..FrictionData::default() };
        let settings = FrictionIdentification {
            method: FrictionMethod::Ladder(StribeckRegression::default()),
            folds: 2,
            ..FrictionIdentification::new().unwrap().of_terms("viscous").unwrap()
        };
        let law = settings.identify(&data).unwrap().result.law;
        assert!(matches!(law, FrictionLaw::Terms(_)), "{law:?}");
    }

    /// Laws of the Schunk arm and of simulated joints with and without Stribeck friction, as they were found.
    #[test]
    fn peaks_that_are_not_resolved_are_far_from_the_bound() {
        let velocities: Vec<f64> = (0..400).map(|i| 0.05 + 0.004 * f64::from(i)).collect();
        let data = FrictionData { velocities: &velocities, ..FrictionData::default() };
        let ratio = |a: [f64; 5]| {
            let resolved = data.resolved_from();
            let most = slower(resolved).map(|v| stribeck_torque(v, &a)).fold(0.0, f64::max);
            most / stribeck_torque(resolved, &a)
        };
        assert!((data.resolved_from() - 0.086).abs() < 1e-12);
        for a in
            [[0.59, 12.4, 1.23, 80.5, 88.6], [5.03, 2.85, 140.0, 1.61, 16.4], [1.3, 3.03, 1.04, 1.19, 8.73]]
        {
            assert!(ratio(a) < 0.85 * levels::MOST_UNRESOLVED.get(), "{}", ratio(a));
        }
        for a in [
            [6.3, 3.67, 36.7, 144.0, 685.0],
            [9.9, 5.32, 77.4, 232.0, 1434.0],
            [10.7, 6.2, 15.0, 275.0, 236.0],
        ] {
            assert!(ratio(a) > 1.15 * levels::MOST_UNRESOLVED.get(), "{}", ratio(a));
        }
    }

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
        let note = report.result.settings.iter().find(|note| note.message.contains("the Stribeck law"));
        assert!(note.is_some_and(|note| note.message.contains("equal weights of all samples")), "{note:?}");
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
