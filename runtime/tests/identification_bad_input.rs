//! Bad logs and impossible settings: each ends in a message with its numbers, none in a panic or a silent
//! NaN.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "test code: what cannot be set up ends the test")]

use gelenk_identification::cross_validation::{CrossValidation, refit};
use gelenk_identification::differentiation::KalmanSmoother;
use gelenk_identification::friction::{
    FrictionData, FrictionIdentification, FrictionMethod, FrictionReport, LambdaChoice, Offsets,
};
use gelenk_identification::lasso::Lasso;
use gelenk_identification::library::Library;
use gelenk_identification::log::{Differentiation, FindingKind, Log, LogSchema};
use gelenk_identification::moments::{Moments, Samples};
use gelenk_identification::stribeck::StribeckRegression;
use gelenk_identification::thresholding::Thresholding;
use gelenk_identification::{IdentificationError, Result};

fn read(text: &str) -> Result<(Log, Vec<FindingKind>)> {
    let (log, findings) = Log::read(text.as_bytes(), "bad.csv", &LogSchema::default())?;
    Ok((log, findings.iter().map(|f| f.kind).collect()))
}

fn smoothed(text: &str) -> Result<Vec<f64>> {
    let method = Differentiation::KalmanSmoother(KalmanSmoother::from_noise(1e-4));
    read(text)?.0.differentiate("q1", &method)
}

fn rows(values: impl Iterator<Item = (f64, f64)>) -> String {
    let lines: String = values.map(|(t, q)| format!("{t},{q}\n")).collect();
    format!("t,q1\n{lines}")
}

/// Methods on terms, and the nonlinear one.
fn methods() -> Vec<FrictionMethod> {
    vec![
        FrictionMethod::LeastSquares,
        FrictionMethod::Thresholding(Thresholding::default()),
        FrictionMethod::Lasso(Lasso::default(), LambdaChoice::Minimum),
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
    let settings = FrictionIdentification {
        library: library.clone(),
        method,
        draws: 10,
        ..FrictionIdentification::new()?
    };
    settings.identify(&FrictionData {
        joint: "beta",
        unit: "N·m",
        velocity_unit: "rad/s",
        velocities,
        torques,
        data: "by hand",
        ..FrictionData::default()
    })
}

fn message<T: std::fmt::Debug>(result: Result<T>) -> String {
    result.expect_err("an error").to_string()
}

fn wave(samples: u32) -> Vec<f64> {
    (0..samples).map(|i| (0.05 * f64::from(i)).sin()).collect()
}

#[test]
fn empty_logs() {
    assert_eq!(message(read("t,q1\n")), "the log bad.csv is empty: there is nothing to identify from");
    assert!(message(read("")).starts_with("the log bad.csv is empty"));
    let friction = Library::friction().expect("a library");
    for method in methods() {
        let text = message(identify(&friction, method, &[], &[]));
        assert!(text.starts_with("the friction of beta is empty"), "{text}");
    }
}

#[test]
fn one_sample() {
    let text = message(smoothed("t,q1\n0,1\n"));
    assert_eq!(text, "differentiation needs at least 8 samples, there are 1");
    let friction = Library::friction().expect("a library");
    for method in methods() {
        let text = message(identify(&friction, method, &[0.1], &[1.0]));
        assert_eq!(text, "the friction of beta needs at least 2 samples, there are 1");
    }
}

#[test]
fn constant_logs() {
    let log = rows((0..100).map(|i| (0.01 * f64::from(i), 0.25)));
    let (_, findings) = read(&log).expect("a log");
    assert!(findings.contains(&FindingKind::Constant));
    let friction = Library::friction().expect("a library");
    for method in methods() {
        let text = message(identify(&friction, method, &[0.5; 40], &[2.0; 40]));
        assert!(text.starts_with("the velocity of beta is constant (0.5) in all 40 samples"), "{text}");
    }
}

#[test]
fn channels_of_nan() {
    let log = rows((0..100).map(|i| (0.01 * f64::from(i), f64::NAN)));
    let (_, findings) = read(&log).expect("a log");
    assert!(findings.contains(&FindingKind::NoValues));
    let text = message(smoothed(&log));
    assert!(text.contains("is not finite (NaN) at row 0 (counted from 0), 100 such values of 100"), "{text}");
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
            text.starts_with("the terms v, sign(v), 2*v - sign(v) are collinear on these data"),
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
        let needs = text.contains("needs at least 7 samples, there are 4")
            || text.contains("needs at least 6 samples, there are 4");
        assert!(needs, "{text}");
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
    let largest = lasso.largest_lambda(&moments, 0).expect("a bound");
    let text = message(lasso.fit(&moments, 0, 2.0 * largest));
    assert!(text.contains("removes every term: the largest value that keeps one"), "{text}");
    let folds = Moments::blocks(&samples, 4).expect("folds");
    let path = CrossValidation::new(&lasso, &folds, 0, &[2.0 * largest]).expect("a path").path;
    let reduced = gelenk_identification::least_squares::Reduced::new(&samples);
    let text = message(refit(&reduced.expect("sums"), 0, &path, 0));
    assert!(text.starts_with("lambda = "), "{text}");
}

#[test]
fn parameters_that_the_data_do_not_show() {
    // Fast motion only: nothing tells how friction rises near standstill.
    let v: Vec<f64> = (0..800).map(|i| 1.0 + 0.5 * (0.05 * f64::from(i)).sin()).collect();
    let torque: Vec<f64> = v.iter().map(|v| 2.0 * v + 1.0).collect();
    let friction = Library::friction().expect("a library");
    let method = FrictionMethod::Stribeck(StribeckRegression::default());
    let report = identify(&friction, method, &v, &torque).expect("a law");
    let warnings = report.result.warnings.join("\n");
    assert!(warnings.contains("identifiable"), "{warnings}");
    assert!(report.residuals.iter().all(|r| r.is_finite()));
    // Steps of the same library are part of the offset, and a warning says so.
    let report = identify(&friction, FrictionMethod::LeastSquares, &v, &torque).expect("a law");
    let warnings = report.result.warnings.join("\n");
    assert!(
        warnings.contains("sign(v), tanh(5*v), tanh(10*v), tanh(20*v), tanh(100*v) left out"),
        "{warnings}"
    );
    assert!(warnings.contains("move in both directions"), "{warnings}");
    // Where offsets are friction, they have no unique answer.
    let settings = FrictionIdentification {
        library: friction,
        method: FrictionMethod::LeastSquares,
        offsets: Offsets::PartOfLaw,
        ..FrictionIdentification::new().expect("settings")
    };
    let data = FrictionData { joint: "beta", velocities: &v, torques: &torque, ..FrictionData::default() };
    let text = message(settings.identify(&data));
    assert!(text.contains("are collinear on these data"), "{text}");
}
