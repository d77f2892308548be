//! Regression of the Stribeck law on synthetic data.

use super::super::confidence::quantile;
use super::super::filtered::{Filtered, FilteredRun};
use super::words::Estimate;
use super::*;
use crate::friction::{FrictionData, FrictionIdentification, FrictionMethod};
use crate::methods::filter::Filter;
use crate::numeric::random::SplitMix64;
use crate::result::{FrictionLaw, FrictionTerm};
use std::ops::Range;

const TRUE: [f64; 5] = [2.1, 1.4, 20.0, 0.9, 8.0];

fn data(m: usize, sigma: f64, seed: u64) -> (Vec<f64>, Vec<f64>) {
    let mut random = SplitMix64::new(seed);
    let v: Vec<f64> =
        (0..m).map(|i| 1.2 * (0.002 * i as f64).sin() + 0.7 * (0.0052 * i as f64 + 0.4).sin()).collect();
    let torque = v.iter().map(|v| stribeck_torque(*v, &TRUE) + sigma * random.normal()).collect();
    (v, torque)
}

/// The parameters of the identified law, with errors for correlated residuals.
fn stribeck(data: &FrictionData) -> [FrictionTerm; 5] {
    let method = FrictionMethod::Stribeck(StribeckRegression::default());
    let settings = FrictionIdentification { method, ..FrictionIdentification::new().unwrap() };
    match settings.identify(data).unwrap().result.law {
        FrictionLaw::Stribeck(terms) => *terms,
        law @ FrictionLaw::Terms(_) => panic!("{law:?}"),
    }
}

fn observed<'a>(v: &'a [f64], torque: &'a [f64], runs: &'a [Range<usize>]) -> Observed<'a> {
    Observed { v, torque, weights: None, runs, filtered: None }
}

#[test]
fn finds_the_parameters_without_noise() {
    for a in [TRUE, [76.0, 4.0, 5.0, 2.0, 30.0], [0.1, 10.0, 80.0, -3.0, 2.0]] {
        let (v, _) = data(5000, 0.0, 1);
        let torque: Vec<f64> = v.iter().map(|v| stribeck_torque(*v, &a)).collect();
        let fit = StribeckRegression::default().fit(&v, &torque).unwrap();
        for i in 0..5 {
            assert!((fit.parameters[i] / a[i] - 1.0).abs() < 1e-5, "{:?} instead of {a:?}", fit.parameters);
        }
    }
}

#[test]
fn intervals_cover_the_truth_as_often_as_they_say() {
    let mut covered = [0; 5];
    for seed in 0..200 {
        let (v, torque) = data(2000, 0.05, seed);
        let fit = StribeckRegression::default().fit(&v, &torque).unwrap();
        let t = quantile(0.9, fit.freedom as f64).unwrap();
        for i in 0..5 {
            let error = (fit.parameters[i] - TRUE[i]).abs();
            covered[i] += usize::from(error <= t * fit.standard_errors[i].unwrap());
        }
    }
    // 90 % of 200 fits, ± 3 binomial standard deviations of 4.2, and a margin because the law is nonlinear.
    assert!(covered.iter().all(|c| (165..=195).contains(c)), "{covered:?} of 200");
}

#[test]
fn parameters_without_influence_are_named() {
    let (v, _) = data(3000, 0.0, 1);
    let mut random = SplitMix64::new(5);
    let viscous: Vec<f64> = v.iter().map(|v| 3.6 * v + 0.05 * random.normal()).collect();
    let fit = StribeckRegression::default().fit(&v, &viscous).unwrap();
    assert!(fit.warnings.iter().all(|w| w.code == "stribeck-parameters") && !fit.warnings.is_empty());
    assert!((fit.torque(1.0) - 3.6).abs() < 0.1);
    let fast: Vec<f64> = v.iter().map(|v| 2.0 + v.abs()).collect();
    let torque: Vec<f64> = fast.iter().map(|v| stribeck_torque(*v, &TRUE) + 0.05 * random.normal()).collect();
    let fit = StribeckRegression::default().fit(&fast, &torque).unwrap();
    assert!(
        fit.warnings
            .iter()
            .any(|w| w.message.contains("slower than 1/a3") || w.message.contains("not identifiable")),
        "{:?}",
        fit.warnings
    );
    for s in fit.standard_errors.iter().flatten() {
        assert!(s.is_finite());
    }
}

#[test]
fn bad_input_has_messages() {
    let regression = StribeckRegression::default();
    let message = |v: &[f64], t: &[f64]| regression.fit(v, t).unwrap_err().to_string();
    assert!(message(&[], &[]).contains("empty"));
    assert!(message(&[1.0; 5], &[1.0; 5]).contains("at least 6 samples, but there are 5"));
    assert!(message(&[0.3; 9], &[1.0; 9]).contains("the velocity is constant (0.3) in all 9 samples"));
    assert!(message(&[f64::NAN; 9], &[1.0; 9]).contains("9 of 9 values are not finite"));
    let zero = regression.fit(&data(100, 0.0, 1).0, &[0.0; 100]).unwrap();
    assert!(zero.parameters.iter().all(|a| a.is_finite()) && zero.torque(0.7).abs() < 1e-9);
}

#[test]
fn physical_words_are_what_the_law_does() {
    let (v, torque) = data(6000, 0.05, 2);
    let fit = StribeckRegression::default().fit(&v, &torque).unwrap();
    let words = fit.words();
    // Viscous and Coulomb friction from the curve itself, at speeds at which the excess of static friction is negligible.
    let slope = (fit.torque(30.0) - fit.torque(20.0)) / 10.0;
    assert!((words.viscous.value - slope).abs() < 1e-9);
    assert!((words.coulomb.value - (fit.torque(20.0) - 20.0 * slope)).abs() < 1e-9);
    let near =
        |found: Estimate, truth: f64| (found.value - truth).abs() < 3.0 * found.standard_error.unwrap();
    assert!(near(words.coulomb, 1.4) && near(words.static_friction, 2.3), "{words:?}");
    assert!(near(words.stribeck_speed, 0.125) && near(words.viscous, 2.1), "{words:?}");
    let line = words.line("N·m", "rad/s");
    assert!(line.contains("static F_s = 2.266 ± 0.035 N·m"), "{line}");
}

/// The starts do not depend on the scale: the laws are those of a slow slide and of a joint whose dip is at high speeds.
#[test]
fn the_best_of_several_starts_is_found_at_any_scale() {
    for (scale, a) in [(0.004, [300.0, 9.0, 6000.0, 5.0, 900.0]), (40.0, [0.02, 1.0, 4.0, 0.8, 0.1])] {
        let (v, _) = data(4000, 0.0, 1);
        let v: Vec<f64> = v.iter().map(|v| scale * v).collect();
        let mut random = SplitMix64::new(4);
        let torque: Vec<f64> = v.iter().map(|v| stribeck_torque(*v, &a) + 0.02 * random.normal()).collect();
        let fit = StribeckRegression::default().fit(&v, &torque).unwrap();
        assert!(fit.converged && (fit.variance.sqrt() - 0.02).abs() < 0.001, "{fit:?}");
    }
}

/// Without slow samples, the step at zero is not determined. A law that drives the joint must not be chosen.
#[test]
fn of_laws_that_fit_alike_one_that_dissipates_is_taken() {
    for seed in 0..10 {
        let mut random = SplitMix64::new(seed);
        let v: Vec<f64> = (0..260)
            .map(|i| (0.1 + 0.37 * (0.05 * f64::from(i)).sin().abs()) * if i % 100 < 50 { 1.0 } else { -1.0 })
            .collect();
        let truth =
            |v: f64| 76.6 * v + 3.9 * (5.0 * v).tanh() + 10.8 * (10.0 * v).tanh() + 2.2 * (20.0 * v).tanh();
        let torque: Vec<f64> = v.iter().map(|v| truth(*v) + 0.2 * random.normal()).collect();
        let fit = StribeckRegression::default().fit(&v, &torque).unwrap();
        for i in 1..100 {
            assert!(fit.torque(0.005 * f64::from(i)) >= 0.0, "seed {seed}: {:?}", fit.parameters);
        }
    }
}

#[test]
fn correlated_errors_widen_the_intervals() {
    let (v, mut torque) = data(4000, 0.0, 1);
    let mut random = SplitMix64::new(12);
    let mut slow = 0.0;
    for t in &mut torque {
        slow = 0.9 * slow + 0.05 * random.normal();
        *t += slow;
    }
    let fit = StribeckRegression::default().fit(&v, &torque).unwrap();
    let honest = stribeck(&FrictionData { velocities: &v, torques: &torque, ..FrictionData::default() });
    for (i, term) in honest.iter().enumerate() {
        let (narrow, wide) = (fit.standard_errors[i].unwrap(), term.standard_error.unwrap());
        assert!(wide > 1.5 * narrow && wide < 10.0 * narrow, "{i}: {narrow} {wide}");
        assert!((fit.parameters[i] - TRUE[i]).abs() < 4.0 * wide);
        assert!(term.resolution.unwrap() <= wide * 1.5);
        assert_eq!(term.coefficient, fit.parameters[i]);
    }
}

/// A second search starts from the law that made the data. The laws are steep or flat, with or without an excess of static
/// friction.
#[test]
fn no_worse_minimum_is_taken_than_the_one_near_the_truth() {
    let mut random = SplitMix64::new(31);
    for case in 0..16 {
        let between =
            |random: &mut SplitMix64, low: f64, high: f64| low * (high / low).powf(random.uniform());
        let mut a = [
            between(&mut random, 0.1, 10.0),
            between(&mut random, 0.5, 10.0),
            between(&mut random, 5.0, 200.0),
            between(&mut random, 0.1, 5.0),
            between(&mut random, 2.0, 50.0),
        ];
        // Special cases: no viscous friction, an excess as large as Coulomb friction, equal steepness of rise and fall.
        match case % 4 {
            0 => a[0] = 0.0,
            1 => a[3] = a[1],
            2 => a[4] = a[2],
            _ => {}
        }
        let (v, _) = data([1000, 6000][case % 2], 0.0, 1);
        let torque: Vec<f64> = v.iter().map(|v| stribeck_torque(*v, &a) + 0.1 * random.normal()).collect();
        let fit = StribeckRegression::default().fit(&v, &torque).unwrap();
        let whole = 0..v.len();
        let runs = [whole];
        let near = observed(&v, &torque, &runs).refine(a, &StribeckRegression::default(), NEAR);
        let cost = fit.variance * fit.freedom as f64;
        assert!(cost < 1.001 * near.cost, "{case}: {cost}, not {}, {a:?} {:?}", near.cost, fit.parameters);
    }
}

/// The law passes the filter of the torques. Positions are logged at 100 Hz, and the filter smooths the step at zero.
#[test]
fn a_filter_of_the_torques_changes_no_parameter() {
    let filter = Filter::new(6.0, 0.01).unwrap();
    let mut inside = 0;
    for seed in 0..6 {
        let mut random = SplitMix64::new(seed);
        let a = [4.0, 3.0, 20.0 * 4f64.powf(random.uniform()), 1.5, 6.0 + 10.0 * random.uniform()];
        let v: Vec<f64> = (0..3000)
            .map(|i| 0.7 * (0.02 * f64::from(i)).sin() + 0.3 * (0.051 * f64::from(i)).sin())
            .collect();
        let torque: Vec<f64> = v.iter().map(|v| stribeck_torque(*v, &a) + 0.1 * random.normal()).collect();
        let torque = filter.apply(&torque);
        // The ends are left out, because the filter uses a continuation of the signal there.
        let kept: Vec<usize> = (50..2950).filter(|i| i % 400 > 40).collect();
        let of = |all: &[f64]| -> Vec<f64> { kept.iter().map(|i| all[*i]).collect() };
        let (samples, torques) = (of(&v), of(&torque));
        let whole = 0..kept.len();
        let runs = [whole];
        let run = FilteredRun { velocities: &v, kept: kept.clone() };
        let filtered = Filtered { filter: &filter, runs: vec![run] };
        let observed = Observed { filtered: Some(&filtered), ..observed(&samples, &torques, &runs) };
        let fit = StribeckRegression::default().fit_runs(&observed).unwrap();
        let data = FrictionData {
            velocities: &samples,
            torques: &torques,
            filtered: Some(&filtered),
            ..FrictionData::default()
        };
        let terms = stribeck(&data);
        inside +=
            (0..5).filter(|i| (terms[*i].coefficient - a[*i]).abs() <= terms[*i].reach.unwrap()).count();
        assert!((fit.parameters[2] / a[2] - 1.0).abs() < 0.15, "{:?} instead of {a:?}", fit.parameters);
    }
    assert!((25..=30).contains(&inside), "{inside} of 30 intervals hold");
}
