//! Bad logs and impossible settings: each ends in a message with its numbers, none in a panic or a silent
//! NaN.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "test code: what cannot be set up ends the test")]

use crate::support::named_robot::NamedRobot;
use gelenk_identification::friction::{FrictionData, FrictionIdentification, FrictionMethod, FrictionReport};
use gelenk_identification::log::{ColumnOptions, Recording, runs_of};
use gelenk_identification::methods::cross_validation::{CrossValidation, refit};
use gelenk_identification::methods::differentiation::TotalVariation;
use gelenk_identification::methods::lasso::Lasso;
use gelenk_identification::methods::library::Library;
use gelenk_identification::methods::moments::{Moments, Samples};
use gelenk_identification::methods::stribeck::StribeckRegression;
use gelenk_identification::methods::thresholding::Thresholding;
use gelenk_identification::result::description::comment_lines;
use gelenk_identification::{IdentificationError, Result};

fn read(text: &str) -> Result<Recording> {
    let robot = NamedRobot { names: vec!["joint_1".into()], ..NamedRobot::default() };
    runs_of(text.as_bytes(), "bad.csv", &robot, &ColumnOptions::default())
}

fn smoothed(times: &[f64], positions: &[f64]) -> Result<Vec<f64>> {
    TotalVariation::from_noise(1e-4).differentiate(times, positions).map(|found| found.first)
}

fn rows(values: impl Iterator<Item = (f64, f64, f64)>) -> String {
    let lines: String = values.map(|(t, q, u)| format!("{t},{q},{u}\n")).collect();
    format!("t,q1,u1\n{lines}")
}

/// Methods on terms, and the nonlinear one.
fn methods() -> Vec<FrictionMethod> {
    vec![
        FrictionMethod::LeastSquares,
        FrictionMethod::Thresholding(Thresholding::default()),
        FrictionMethod::Lasso(Lasso::default()),
        FrictionMethod::BestSubset,
        FrictionMethod::Stribeck(StribeckRegression::default()),
    ]
}

fn identify(
    library: &Library,
    method: FrictionMethod,
    velocities: &[f64],
    torques: &[f64],
) -> Result<FrictionReport> {
    let settings =
        FrictionIdentification { library: library.clone(), method, ..FrictionIdentification::new()? };
    settings.identify(&FrictionData::of("beta", velocities, torques))
}

fn message<T: std::fmt::Debug>(result: Result<T>) -> String {
    result.expect_err("an error").to_string()
}

fn wave(samples: u32) -> Vec<f64> {
    (0..samples).map(|i| (0.05 * f64::from(i)).sin()).collect()
}

#[test]
fn empty_logs() {
    assert!(message(read("t,q1,u1\n")).contains("bad.csv: the file has no rows of numbers"));
    assert!(message(read("")).contains("bad.csv: the file is empty"));
    let friction = Library::friction().expect("a library");
    for method in methods() {
        let text = message(identify(&friction, method, &[], &[]));
        assert!(text.starts_with("the friction of beta is empty"), "{text}");
    }
}

#[test]
fn one_sample() {
    let text = message(smoothed(&[0.0], &[1.0]));
    assert_eq!(text, "differentiation needs at least 5 samples, but there are 1");
    let friction = Library::friction().expect("a library");
    for method in methods() {
        let text = message(identify(&friction, method, &[0.1], &[1.0]));
        assert_eq!(text, "the friction of beta needs at least 2 samples, but there are 1");
    }
}

#[test]
fn constant_logs() {
    let friction = Library::friction().expect("a library");
    for method in methods() {
        let text = message(identify(&friction, method, &[0.5; 40], &[2.0; 40]));
        assert!(text.starts_with("the velocity of beta is constant (0.5) in all 40 samples"), "{text}");
    }
}

#[test]
fn channels_of_nan() {
    let log = rows((0..100).map(|i| (0.01 * f64::from(i), f64::NAN, 1.0)));
    assert!(message(read(&log)).contains("column `q1` has no finite number"));
    let times: Vec<f64> = (0..100).map(|i| 0.01 * f64::from(i)).collect();
    let text = message(smoothed(&times, &[f64::NAN; 100]));
    assert!(
        text.contains("is not finite (NaN) at row 0 (counted from 0), and 100 of 100 values are not finite"),
        "{text}"
    );
    let friction = Library::friction().expect("a library");
    for method in methods() {
        let text = message(identify(&friction, method, &wave(40), &[f64::NAN; 40]));
        assert!(text.contains("friction torque of beta is not finite (NaN)"), "{text}");
    }
}

#[test]
fn collinear_libraries() {
    let library = Library::new(&["v", "sign(v)", "2*v - sign(v)"], &["v"]).expect("a library");
    let v = wave(400);
    for method in methods() {
        if matches!(method, FrictionMethod::Stribeck(_)) {
            continue;
        }
        let text = message(identify(&library, method, &v, &v));
        assert!(
            text.starts_with("the data cannot distinguish the friction terms v, sign(v), 2*v - sign(v)"),
            "{text}"
        );
    }
}

#[test]
fn more_terms_than_samples() {
    let friction = Library::friction().expect("a library");
    let v = [-0.5, -0.1, 0.2, 0.6];
    for method in methods() {
        let text = message(identify(&friction, method, &v, &v));
        // Terms that these four velocities do not distinguish are left out before.
        let needs = |count: usize| text.contains(&format!("needs at least {count} samples, but there are 4"));
        assert!([5, 6, 7].into_iter().any(needs), "{text}");
    }
}

#[test]
fn lambda_and_threshold_that_remove_everything() {
    let friction = Library::friction().expect("a library");
    let (v, torque) = (wave(400), wave(400));
    let strict = Thresholding { threshold: 1e3, ..Default::default() };
    let method = FrictionMethod::Thresholding(strict);
    let error = identify(&friction, method, &v, &torque).expect_err("an error");
    assert!(
        matches!(error, IdentificationError::EverythingRemoved { largest, .. } if largest < 1e3),
        "{error}"
    );
    let samples = Samples::from_library(&friction, vec![&v], vec![&torque]).expect("samples");
    let moments = Moments::new(&samples).expect("sums");
    let lasso = Lasso::default();
    let largest = lasso.lambda_grid(&moments, 0, 2, 0.5).expect("a bound")[0];
    let folds = Moments::blocks(&samples, 4).expect("folds");
    let path = CrossValidation::new(&lasso, &folds, 0, &[2.0 * largest]).expect("a path").path;
    let reduced = gelenk_identification::methods::least_squares::Reduced::new(&samples);
    let text = message(refit(&reduced.expect("sums"), 0, &path, 0));
    assert!(text.starts_with("lambda = ") && text.contains("removes every term"), "{text}");
}

#[test]
fn parameters_that_the_data_do_not_show() {
    // Fast motion only: nothing tells how friction rises near standstill.
    let v: Vec<f64> = (0..800).map(|i| 1.0 + 0.5 * (0.05 * f64::from(i)).sin()).collect();
    let torque: Vec<f64> = v.iter().map(|v| 2.0 * v + 1.0).collect();
    let friction = Library::friction().expect("a library");
    let method = FrictionMethod::Stribeck(StribeckRegression::default());
    let report = identify(&friction, method, &v, &torque).expect("a law");
    let warnings = comment_lines(&report.result);
    assert!(warnings.contains("identifiable"), "{warnings}");
    assert!(report.residuals.iter().all(|r| r.is_finite()));
    // Steps of the same library are all constant. One of them is kept, because the torques have no offset.
    let report = identify(&friction, FrictionMethod::LeastSquares, &v, &torque).expect("a law");
    assert_eq!(report.terms, ["v", "tanh(100*v)"]);
    let law = &report.result.law;
    let torques = law.torques(&[1.2, -1.2]).expect("torques");
    assert!((torques[0] - 3.4).abs() < 1e-9 && (torques[1] + 3.4).abs() < 1e-9);
}
