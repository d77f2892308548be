//! Settings with which a friction law was found.

use super::super::methods::thresholding::Thresholding;
use gelenk_findings::digits::plain;
use gelenk_findings::{Finding, Rule, counted};
use std::fmt;

/// Sees: the filter of the samples, the method, and the terms from which the law was chosen.
/// Matters: with other settings the law may differ. These notes are written as comments of the law.
/// Example: best subset, 10 folds.
/// Fixture: `friction/tests.rs`.
const SETTINGS: Rule = Rule::note("law-settings");

/// A setting with which a friction law was found.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Setting {
    /// Bandwidth of the filter of positions and efforts, and rate of the filtered samples [Hz].
    Filter { bandwidth: f64, sample_rate: f64 },
    /// Sums of products of logs, with the total duration [s] and the smallest and largest bandwidth of the logs [Hz].
    Moments { logs: usize, samples: u64, seconds: f64, shares: usize, bandwidths: [f64; 2] },
    /// Terms that motion in one direction does not determine.
    OneDirection(Vec<String>),
    /// Terms from which the law is chosen, and the condition number of the scaled terms.
    Library { terms: Vec<String>, with_offsets: bool, condition: f64 },
    /// Least squares on all terms.
    LeastSquares,
    /// Sequentially thresholded least squares.
    Threshold(Thresholding),
    /// LASSO with the weight λ in the conventions of `1/(2N)‖·‖²` and of `‖·‖²`.
    Lasso { folds: usize, lambdas: [f64; 2], standardize: bool },
    /// Best subset of the terms.
    BestSubset { folds: usize },
    /// Nonlinear regression of a Stribeck law.
    Stribeck { starts: usize, passes: usize },
    /// A Stribeck law was not tried, because sums of products contain no samples.
    NoSamples,
    /// Solution by orthogonal factorization, because the terms are nearly collinear.
    Orthogonal,
}

impl Setting {
    /// The note about the setting.
    pub(crate) fn finding(&self) -> Finding {
        let found = SETTINGS.found(self.to_string());
        match self {
            Self::Library { condition, .. } => found.with("condition number", *condition, ""),
            _ => found,
        }
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let offsets = |has: &bool| if *has { " in addition to the offset of each run" } else { "" };
        match self {
            Self::Filter { bandwidth, sample_rate } => write!(
                out,
                "positions and efforts passed the same zero-phase filter of {} Hz. Their sample rate is {} Hz",
                plain(*bandwidth, 4),
                plain(*sample_rate, 6)
            ),
            Self::Moments { logs, samples, seconds, shares, bandwidths: [narrow, wide] } => {
                let logs = counted(*logs, "log", "logs");
                let range = if narrow < wide { format!("{narrow:.3} to ") } else { String::new() };
                write!(
                    out,
                    "moments of {logs}, {samples} samples, {seconds:.1} s, in {shares} groups for cross-validation, low-pass \
                     filter {range}{wide:.3} Hz. R² is computed with one offset for each run. The values of these offsets cannot \
                     be computed from moments, so they are not reported"
                )
            }
            Self::OneDirection(terms) => {
                let terms = terms.join(", ");
                write!(out, "these terms are left out, because nine tenths of the motion are in one direction: {terms}")
            }
            Self::Library { terms, with_offsets, condition } => {
                let (terms, offsets) = (terms.join(", "), offsets(with_offsets));
                write!(out, "the law is chosen from the terms [{terms}]{offsets}. Their condition number is {condition:.1}")
            }
            Self::LeastSquares => out.write_str("least squares fitted all terms"),
            Self::Threshold(Thresholding { threshold, ridge, .. }) => {
                write!(out, "sequentially thresholded least squares (threshold {threshold}, ridge {ridge}) chose the terms")
            }
            Self::Lasso { folds, lambdas, standardize } => {
                let [own, paper] = lambdas.map(|lambda| plain(lambda, 5));
                let rms = if *standardize { " (terms in units of their rms)" } else { "" };
                write!(
                    out,
                    "LASSO chose the terms by cross-validation with {folds} contiguous parts, λ by one standard error: λ = {own} in 1/(2N)‖·‖² + λ‖·‖₁{rms}, {paper} in \
                     ‖·‖² + λ‖·‖₁. Values and errors are those of least squares on the chosen terms"
                )
            }
            Self::BestSubset { folds } => {
                write!(out, "the best subset of terms was chosen by {folds}-fold cross-validation and the one-standard-error rule")
            }
            Self::Stribeck { starts, passes } => write!(
                out,
                "the Stribeck law was fitted by nonlinear least squares with equal weights of all samples ({starts} starts, {passes} passes)"
            ),
            Self::NoSamples => out.write_str(
                "the Stribeck law was not tried, because a file of moments does not contain the single samples",
            ),
            Self::Orthogonal => out.write_str("solved by orthogonal factorization"),
        }
    }
}
