//! Standard errors of the parameters of a Stribeck law, and warnings about the parameters.

use super::law::{NAMES, StribeckFit};
use super::refine::{Normal, Observed};
use crate::numeric::spectrum::symmetric_eigen;
use gelenk_findings::digits::plain;
use gelenk_findings::{Finding, Rule, counted};
use nalgebra::SMatrix;

/// Sees: parameters of a Stribeck law that the data do not determine.
/// Matters: the values of these parameters are guesses.
/// Example: a Stribeck speed below all speeds in the data.
/// Fixture: `methods/stribeck/tests.rs`.
const PARAMETERS: Rule = Rule::warning("stribeck-parameters");

pub(super) fn summarize(samples: &Observed, state: &Normal) -> StribeckFit {
    let freedom = samples.v.len().saturating_sub(5).max(1);
    let variance = state.cost / freedom as f64;
    let (inverse, lost) = inverse(&shown(samples, state));
    let known = |i: usize, variance: f64| (!lost[i]).then(|| variance.max(0.0).sqrt());
    let covariance = inverse * variance;
    let mut fit = StribeckFit {
        parameters: state.a,
        covariance,
        standard_errors: std::array::from_fn(|i| known(i, covariance[(i, i)])),
        variance,
        freedom,
        iterations: state.iterations,
        converged: state.converged,
        warnings: Vec::new(),
    };
    fit.warnings = warnings(&fit, samples);
    fit
}

/// Squared share of the torques below which the influence of a parameter is only rounding.
const ROUNDING: f64 = 1e-24;

/// Returns JᵀWJ with the derivatives J of the law with respect to its parameters a1 … a5, and the weights W.
/// The rows and columns of a3 and a5 are zero if the law does not depend on these parameters, for example if
/// a2 and a4 are zero.
fn shown(samples: &Observed, state: &Normal) -> SMatrix<f64, 5, 5> {
    let energy = samples.energy();
    let mut information = state.h;
    for i in [2, 4] {
        if state.a[i].powi(2) * information[(i, i)] <= ROUNDING * energy {
            information.row_mut(i).fill(0.0);
            information.column_mut(i).fill(0.0);
        }
    }
    information
}

/// Returns the inverse of the matrix H of the normal equations, a flag for each parameter that is not
/// identifiable, and the condition number of the scaled sensitivities. The rows and columns of parameters
/// that are not identifiable are zero.
fn inverse(h: &SMatrix<f64, 5, 5>) -> (SMatrix<f64, 5, 5>, [bool; 5]) {
    let d = h.diagonal().map(|h| if h > 0.0 { h.sqrt() } else { 1.0 });
    let scaled = SMatrix::<f64, 5, 5>::from_fn(|i, j| h[(i, j)] / (d[i] * d[j]));
    let eigen = symmetric_eigen(scaled);
    let largest = eigen.eigenvalues.max();
    let mut inverse = SMatrix::<f64, 5, 5>::zeros();
    let mut lost = [false; 5];
    for k in 0..5 {
        let direction = eigen.eigenvectors.column(k);
        if eigen.eigenvalues[k] > 1e-10 * largest {
            inverse += direction * direction.transpose() / eigen.eigenvalues[k];
        } else {
            (0..5)
                .filter(|&i| direction[i].is_nan() || direction[i].abs() > 0.1)
                .for_each(|i| lost[i] = true);
        }
    }
    let entry = |i: usize, j: usize| if lost[i] || lost[j] { 0.0 } else { inverse[(i, j)] / (d[i] * d[j]) };
    (SMatrix::from_fn(entry), lost)
}

fn warnings(fit: &StribeckFit, samples: &Observed) -> Vec<Finding> {
    let mut warnings = Vec::new();
    let mut warn = |message: String, name: &'static str, value: f64| {
        warnings.push(PARAMETERS.found(message).with(name, value, ""));
    };
    let a = &fit.parameters;
    if !fit.converged {
        let message = format!(
            "the regression did not converge in {} passes, because some parameters grow without a limit",
            fit.iterations
        );
        warn(message, "passes", fit.iterations as f64);
    }
    for i in 0..5 {
        let (name, value) = (NAMES[i], plain(a[i], 4));
        match fit.standard_errors[i] {
            None => warn(format!("{name} is not identifiable: the data do not depend on it"), name, a[i]),
            Some(s) if s > 0.5 * a[i].abs() => {
                let error = plain(s, 2);
                let message = format!(
                    "{name} = {value} is uncertain. Its standard error of {error} is more than half of the value"
                );
                warn(message, name, a[i]);
            }
            Some(_) => {}
        }
        for j in 0..i {
            let c = fit.covariance[(i, j)] / (fit.covariance[(i, i)] * fit.covariance[(j, j)]).sqrt();
            if c.abs() > 0.995 {
                let other = NAMES[j];
                let message = format!(
                    "the data determine only a combination of {other} and {name}. Their errors have the correlation {c:.4}"
                );
                warn(message, "correlation", c);
            }
        }
    }
    let (slow, speed) = (samples.v.iter().filter(|v| v.abs() < 1.0 / a[2]).count(), plain(1.0 / a[2], 4));
    if slow < 10 {
        let message = format!(
            "the data do not determine a3. Only {} slower than 1/a3 = {speed}, the width of the step at zero velocity",
            counted(slow, "sample is", "samples are")
        );
        warn(message, "slow samples", slow as f64);
    }
    warnings
}
