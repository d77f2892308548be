//! Estimates of a simulated robot whose parameters are known.

use super::super::super::numeric::random::SplitMix64;
use super::super::super::robot::Robot;
use super::super::super::run::{Effort, PreparedRun};
use super::super::{Estimate, EstimationSettings, Gravity, Offsets, Uncertain, estimate};
use super::pendulum::{Experiment, FRICTION, Pendulum, STEEPNESS, simulate};
use gelenk_findings::{Finding, Severity, Subject, texts};

fn quietly(robot: &Pendulum, runs: &[PreparedRun], settings: &EstimationSettings) -> Estimate {
    estimate(robot, runs, settings, &mut |_| ()).unwrap()
}

/// Estimated and true values: friction of both joints, and parameters with a column in the regressor W.
fn pairs(found: &Estimate, truth: &Pendulum) -> Vec<(Uncertain, f64)> {
    let friction = found.joints.iter().zip(FRICTION);
    let friction = friction.flat_map(|(j, truth)| j.terms.iter().map(|t| t.coefficient).zip(truth));
    let inertial = [1, 2, 9, 10, 11, 12, 19].map(|i| (found.parameters[i], truth.parameters[i]));
    friction.chain(inertial).collect()
}

#[test]
fn friction_offset_and_base_parameters_come_back() {
    let mut random = SplitMix64::new(7);
    let truth = Pendulum::described().other(0.1, &mut random);
    let (mut run, _) = simulate(&truth, &Experiment::default(), &mut random);
    // Outliers of a hundred times the noise in one sample of a hundred.
    run.efforts[0].iter_mut().step_by(100).for_each(|u| *u += 15.0);
    let settings =
        EstimationSettings { steepness: Some(vec![STEEPNESS; 2]), folds: 5, ..EstimationSettings::default() };
    let found = quietly(&Pendulum::described(), &[run], &settings);
    assert!(
        found.consistent && texts(&found.findings, Severity::Warning).is_empty(),
        "{:?}",
        texts(&found.findings, Severity::Warning)
    );
    for (joint, (friction, offset)) in found.joints.iter().zip(FRICTION.iter().zip([0.4, -0.2])) {
        for (term, truth) in joint.terms.iter().zip(friction) {
            assert!((term.coefficient.value / truth - 1.0).abs() < 0.03, "{term:?} {truth}");
        }
        assert!((joint.offsets[0] - offset).abs() < 0.05, "{:?}", joint.offsets);
    }
    // Gravity of the second link, which no other parameter can take over.
    assert!((found.parameters[11].value / truth.parameters[11] - 1.0).abs() < 0.02);
}

/// The estimate of runs whose efforts lack the weight of `compensated`, and whose sensor at the shoulder has these zeros.
fn without_the_weight_of(
    compensated: &Pendulum,
    truth: &Pendulum,
    zeros: &[f64],
    random: &mut SplitMix64,
) -> Estimate {
    let mut run = |zero: &f64| {
        let (mut run, _) = simulate(truth, &Experiment::default(), random);
        for sample in 0..run.times.len() {
            let y = [run.positions[0][sample], run.positions[1][sample]];
            let mut weight = [0.0; 2];
            compensated.rigid_forces(&y, &[0.0; 2], &[0.0; 2], &mut weight);
            run.efforts.iter_mut().zip(weight).for_each(|(column, weight)| column[sample] -= weight);
            run.efforts[0][sample] += zero;
        }
        run
    };
    let runs: Vec<PreparedRun> = zeros.iter().map(&mut run).collect();
    let settings = EstimationSettings {
        steepness: Some(vec![STEEPNESS; 2]),
        folds: 5,
        gravity_compensated: true,
        ..EstimationSettings::default()
    };
    quietly(&Pendulum::described(), &runs, &settings)
}

/// If a controller carries the described bodies, the efforts contain the remaining weight of the real bodies.
#[test]
fn weight_is_compensated_as_described_or_as_it_is() {
    let mut random = SplitMix64::new(3);
    let described = Pendulum::described();
    let truth = described.other(0.1, &mut random);
    let by_model = without_the_weight_of(&described, &truth, &[0.0], &mut random);
    assert_eq!(by_model.gravity, Gravity::CompensatedAsDescribed);
    assert!(
        texts(&by_model.findings, Severity::Note)
            .iter()
            .any(|said| said.contains("[compensated-as-described]")),
        "{:?}",
        texts(&by_model.findings, Severity::Note)
    );
    // The moment of the second link, which its weight determines best.
    assert!((by_model.parameters[11].value / truth.parameters[11] - 1.0).abs() < 0.02);
    let in_full = without_the_weight_of(&truth, &truth, &[0.0], &mut random);
    assert_eq!(in_full.gravity, Gravity::Compensated);
    for found in [by_model, in_full] {
        assert!(
            found.consistent && texts(&found.findings, Severity::Warning).is_empty(),
            "{:?}",
            texts(&found.findings, Severity::Warning)
        );
        assert!(found.joints.iter().all(|joint| joint.held_out_r_squared > 0.98));
    }
}

/// A sensor offset that differs between runs is not mistaken for a weight, and a weight is not mistaken for an offset.
#[test]
fn zeros_that_move_are_told_from_weight_that_is_left() {
    let mut random = SplitMix64::new(5);
    let described = Pendulum::described();
    let truth = described.other(0.1, &mut random);
    let zeros = [0.0, 2.0, -1.0, 0.5];
    let in_full = without_the_weight_of(&truth, &truth, &zeros, &mut random);
    assert_eq!((in_full.gravity, in_full.offsets), (Gravity::Compensated, Offsets::ByRun));
    let by_model = without_the_weight_of(&described, &truth, &[0.0; 4], &mut random);
    assert_eq!((by_model.gravity, by_model.offsets), (Gravity::CompensatedAsDescribed, Offsets::Common));
}

#[test]
fn currents_give_the_motor_constants_in_proportion_to_the_description() {
    let mut random = SplitMix64::new(11);
    let truth = Pendulum { gears: [80.0, 50.0], ..Pendulum::described() };
    let (mut run, _) = simulate(&truth, &Experiment::default(), &mut random);
    let constants = [0.11, 0.07];
    for (column, constant) in run.efforts.iter_mut().zip(constants) {
        column.iter_mut().for_each(|u| *u /= constant);
    }
    run.effort = Effort::Current;
    let settings = EstimationSettings { folds: 5, optional_terms: false, ..EstimationSettings::default() };
    let found = quietly(&truth, &[run], &settings);
    for (joint, constant) in found.joints.iter().zip(constants) {
        let gain = joint.gain.unwrap().value;
        assert!((gain / constant - 1.0).abs() < 0.02, "{gain} instead of {constant}");
    }
}

#[test]
fn a_joint_without_efforts_stays_as_described_and_the_other_goes_on() {
    let mut random = SplitMix64::new(7);
    let truth = Pendulum::described().other(0.1, &mut random);
    let (mut run, _) = simulate(&truth, &Experiment::default(), &mut random);
    run.efforts[1].fill(f64::NAN);
    let settings =
        EstimationSettings { steepness: Some(vec![STEEPNESS; 2]), folds: 5, ..EstimationSettings::default() };
    for effort in [Effort::Input, Effort::Current] {
        run.effort = effort;
        let found = quietly(&Pendulum::described(), std::slice::from_ref(&run), &settings);
        let [shoulder, elbow] = &found.joints[..] else { panic!() };
        assert!(shoulder.measured && shoulder.held_out_r_squared > 0.99, "{shoulder:?}");
        assert!(!elbow.measured && elbow.terms.is_empty() && elbow.gain.is_none() && elbow.sigma.is_nan());
        assert!(found.predicted[0][1].iter().all(|x| x.is_nan()) && found.consistent);
        let said = texts(&found.findings, Severity::Warning).join(" ");
        assert!(
            said.contains("joint elbow: it has no measured effort") && !said.contains("shoulder"),
            "{said}"
        );
        assert!(found.parameters.iter().all(|p| p.value.is_finite() && p.standard_error.is_finite()));
        if effort == Effort::Input {
            for (term, truth) in shoulder.terms.iter().zip(FRICTION[0]) {
                assert!((term.coefficient.value / truth - 1.0).abs() < 0.05, "{term:?} {truth}");
            }
            assert!((found.parameters[11].value / truth.parameters[11] - 1.0).abs() < 0.03);
        }
    }
    run.efforts[0].fill(f64::NAN);
    let fault = estimate(&Pendulum::described(), &[run], &settings, &mut |_| ()).unwrap_err().to_string();
    assert!(fault.contains("joints with measured efforts"), "{fault}");
}

#[test]
fn offsets_that_change_between_runs_are_found() {
    let mut random = SplitMix64::new(5);
    let truth = Pendulum::described();
    let of = |offset: f64| Experiment { offsets: [offset, 0.0], seconds: 6.0, ..Experiment::default() };
    let runs: Vec<PreparedRun> =
        [0.5, -1.0, 2.0].iter().map(|offset| simulate(&truth, &of(*offset), &mut random).0).collect();
    let settings = EstimationSettings { optional_terms: false, folds: 6, ..EstimationSettings::default() };
    let found = quietly(&truth, &runs, &settings);
    assert_eq!(found.offsets, Offsets::ByRun);
    for (got, want) in found.joints[0].offsets.iter().zip([0.5, -1.0, 2.0]) {
        assert!((got - want).abs() < 0.1, "{got} {want}");
    }
}

#[test]
fn a_wrong_sign_and_forces_that_are_noise_are_refused() {
    let mut random = SplitMix64::new(3);
    let truth = Pendulum::described();
    let (run, _) = simulate(&truth, &Experiment::default(), &mut random);
    let settings = EstimationSettings { folds: 5, optional_terms: false, ..EstimationSettings::default() };
    let refused =
        |run: PreparedRun| estimate(&truth, &[run], &settings, &mut |_| ()).unwrap_err().to_string();
    let mut turned = run.clone();
    turned.efforts[1].iter_mut().for_each(|u| *u = -*u);
    let message = refused(turned);
    assert!(message.contains("joint elbow") && message.contains("other sign"), "{message}");
    // If the log is short, the message names its length as the reason.
    let mut short = super::data::part(&run, 0..40);
    short.efforts[1].iter_mut().for_each(|u| *u = -*u);
    let message = refused(short);
    assert!(
        message.contains("[log-too-short]") && message.contains("40 samples") && !message.contains("sign of"),
        "{message}"
    );
    let mut noise = run;
    noise.efforts[0].iter_mut().for_each(|u| *u = random.normal());
    let found = quietly(&truth, std::slice::from_ref(&noise), &settings);
    let warning = found.findings.iter().find(|finding| finding.code == "joint-left-out").unwrap();
    assert_eq!(warning.about.subject, Subject::Joint("shoulder".into()));
    let [shoulder, elbow] = &found.joints[..] else { panic!() };
    assert!(!shoulder.measured && shoulder.terms.is_empty() && elbow.held_out_r_squared > 0.9);
    // If no joint is left, there is no estimate.
    noise.efforts[1].iter_mut().for_each(|u| *u = random.normal());
    let message = refused(noise);
    assert!(
        message
            .starts_with("error[fit-doubted]: joint shoulder: the fit does not explain its effort. R² is "),
        "{message}"
    );
    assert!(message.contains("error[unexplained-effort]"), "{message}");
}

#[test]
fn one_effort_with_another_factor_is_refused_and_named() {
    let truth = Pendulum::described();
    let (run, _) = simulate(&truth, &Experiment::default(), &mut SplitMix64::new(3));
    let settings = EstimationSettings { folds: 5, optional_terms: false, ..EstimationSettings::default() };
    let of = |joint: usize, factor: f64| {
        let mut run = run.clone();
        run.efforts[joint].iter_mut().for_each(|u| *u *= factor);
        estimate(&truth, &[run], &settings, &mut |_| ())
    };
    for (joint, name, factor) in [(0, "shoulder", 2.0), (1, "elbow", 3.0), (1, "elbow", 0.4)] {
        let error = of(joint, factor).unwrap_err();
        let (refusal, reasons) = error.refusals().split_first().unwrap();
        let subject = &refusal.about.subject;
        assert_eq!(*subject, Subject::Joint(name.into()), "{error}");
        let named = |reason: &&Finding| reason.code == "other-factor" && reason.about.subject == *subject;
        let named = reasons.iter().find(named).unwrap().value("factor").unwrap();
        assert!((named * factor - 1.0).abs() < 0.15, "{factor}: {error}");
    }
    assert!(of(1, 1.0).is_ok());
}

#[test]
fn data_of_the_wrong_shape_are_named() {
    let mut random = SplitMix64::new(3);
    let truth = Pendulum::described();
    let (mut run, _) = simulate(&truth, &Experiment { seconds: 2.0, ..Experiment::default() }, &mut random);
    let message = |run: &PreparedRun| {
        let settings = EstimationSettings::default();
        estimate(&truth, std::slice::from_ref(run), &settings, &mut |_| ()).unwrap_err().to_string()
    };
    run.velocities[1][5] = f64::NAN;
    assert!(message(&run).contains("velocities of simulated is not finite"), "{}", message(&run));
    run.velocities.pop();
    assert!(
        message(&run).contains("velocities of simulated: 2 are expected, but 1 are given"),
        "{}",
        message(&run)
    );
    assert!(estimate(&truth, &[], &EstimationSettings::default(), &mut |_| ()).is_err());
}

/// Noise of forces large enough that noise of the motion, which biases least squares, hardly matters.
fn where_least_squares_holds() -> Experiment {
    Experiment { position_noise: 1e-6, force_noise: 1.0, ..Experiment::default() }
}

#[test]
#[ignore = "100 logs, a minute: cargo test --release -p gelenk-identification --lib intervals_cover -- --ignored --nocapture"]
fn intervals_cover_the_truth_in_a_hundred_logs() {
    const LOGS: u64 = 100;
    let settings =
        EstimationSettings { steepness: Some(vec![STEEPNESS; 2]), ..EstimationSettings::default() };
    let mut hits = std::collections::BTreeMap::<usize, (usize, f64)>::new();
    for seed in 0..LOGS {
        let mut random = SplitMix64::new(seed);
        let truth = Pendulum::described().other(0.1, &mut random);
        let (run, _) = simulate(&truth, &where_least_squares_holds(), &mut random);
        let found = quietly(&Pendulum::described(), &[run], &settings);
        for (place, (value, truth)) in pairs(&found, &truth).into_iter().enumerate() {
            let entry = hits.entry(place).or_default();
            entry.0 += usize::from(value.interval[0] <= truth && truth <= value.interval[1]);
            entry.1 += ((value.value - truth) / value.standard_error).powi(2);
        }
    }
    for (place, (hit, squares)) in &hits {
        println!("value {place}: {hit} of {LOGS}, rms {:.2} standard errors", (squares / LOGS as f64).sqrt());
    }
    let total: usize = hits.values().map(|h| h.0).sum();
    let share = total as f64 / (hits.len() as f64 * LOGS as f64);
    println!("pooled {share:.3}");
    assert!((0.85..=0.95).contains(&share), "{share}");
}
