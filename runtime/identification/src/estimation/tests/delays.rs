//! Efforts with an unknown delay.

use super::super::super::numeric::random::SplitMix64;
use super::super::super::preparation::{PreparationSettings, prepare_all};
use super::super::super::run::Effort;
use super::super::{Estimate, EstimationSettings, estimate};
use super::pendulum::{Experiment, Pendulum, STEEPNESS, log};
use gelenk_findings::{Severity, texts};

/// The estimate of a log with late efforts, from which the preparation removed no delay.
///
/// - `delays`: delay of each effort [s]
/// - `numbers`: index of each effort's delay; efforts with the same index share a delay
fn estimated(truth: &Pendulum, delays: [f64; 2], numbers: &[usize], effort: Effort) -> Estimate {
    let experiment =
        Experiment { rate: 250.0, position_noise: 1e-6, slope_time: 0.01, ..Experiment::default() };
    let mut run = log(truth, &experiment, &mut SplitMix64::new(7));
    if effort == Effort::Current {
        run.efforts.iter_mut().flatten().for_each(|u| *u /= 0.1);
    }
    run.effort = effort;
    let known = PreparationSettings { delay: Some(0.0), ..PreparationSettings::default() };
    let (runs, report) = prepare_all(&[run], Some(truth), &known).unwrap();
    let settings = EstimationSettings {
        steepness: Some(vec![STEEPNESS; 2]),
        optional_terms: false,
        folds: 5,
        filter: Some(report.filter),
        delays: Some(numbers.to_vec()),
        ..EstimationSettings::default()
    };
    let runs: Vec<_> = runs.into_iter().map(|run| run.without_delays(&delays.map(|delay| -delay))).collect();
    estimate(truth, &runs, &settings, &mut |_| ()).unwrap()
}

fn require_found(found: &Estimate, delays: [f64; 2]) {
    assert_eq!(found.delays.len(), 2);
    for (left, delay) in found.delays.iter().zip(delays) {
        assert!((left.value - delay).abs() < 1e-3, "{left:?} {delay}");
        assert!(left.interval[0] < delay && delay < left.interval[1], "{left:?} {delay}");
    }
}

#[test]
fn a_delay_comes_back_from_forces_and_from_currents() {
    let truth = Pendulum::described();
    let geared = Pendulum { gears: [80.0, 50.0], ..truth.clone() };
    let mut friction = Vec::new();
    for (truth, effort) in [(&truth, Effort::Input), (&geared, Effort::Input), (&geared, Effort::Current)] {
        let found = estimated(truth, [4e-3; 2], &[0; 2], effort);
        require_found(&found, [4e-3; 2]);
        assert_eq!(found.delays[0], found.delays[1]);
        let said = texts(&found.findings, Severity::Note)
            .iter()
            .any(|said| said.contains("the delay of the efforts is "));
        assert!(said, "{:?}", texts(&found.findings, Severity::Note));
        friction.push(found.joints[0].terms[0].coefficient.value);
    }
    assert!(friction.iter().all(|viscous| (viscous / 1.2 - 1.0).abs() < 0.05), "{friction:?}");
}

#[test]
fn efforts_may_have_delays_of_their_own() {
    let delays = [1e-3, 6e-3];
    let found = estimated(&Pendulum::described(), delays, &[0, 1], Effort::Joint);
    require_found(&found, delays);
}

#[test]
#[should_panic(expected = "delays of the efforts")]
fn every_effort_has_the_number_of_a_delay() {
    estimated(&Pendulum::described(), [0.0; 2], &[0], Effort::Input);
}
