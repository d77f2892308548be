//! Batch laws for comparison: friction laws with the terms of the online estimator, fitted to whole
//! intervals of the log.
//!
//! A fit δ is the mean of the coefficients given the samples: `A δ = Σ φ r/σ²` with `A = Σ φ φᵀ/σ² + V⁻¹`.
//! Here φ is the vector of the terms' values, and r is the error of the described friction. The prior
//! covariance V (without drift) and the standard deviation σ of the noise are those of the estimator. A fit
//! uses the samples that the estimator used. Errors are computed for all samples.

use super::replay::{JointReplay, OnlineSample, rms};
use gelenk_adaptation::TERMS;
use nalgebra::{DMatrix, DVector};

/// Durations in s of the interval before a sample to which a causal law is fitted.
const WINDOWS: [f64; 9] = [2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, f64::INFINITY];

/// Friction law that is fitted to an interval of the log, for comparison with the online estimator. Its number
/// of terms and its interval are chosen afterwards, from the errors in the complete log.
#[derive(Debug, Clone, PartialEq)]
pub struct BatchLaw {
    /// Number of friction terms of the law. They are the first entries of
    /// [`TERM_NAMES`](gelenk_adaptation::TERM_NAMES).
    pub terms: usize,
    /// Duration in s of the interval to which the law was fitted; infinite if there is no limit. For a law
    /// that predicts later samples, the interval ends before the predicted sample.
    pub window: f64,
    /// Error of the law's prediction of each sample, in N·m or N.
    pub errors: Vec<f64>,
    /// Root mean square of the prediction errors, in N·m or N.
    pub error: f64,
}

/// Returns the best law that predicts each sample from earlier samples; `None` if no error is finite. The
/// number of terms and the interval are chosen afterwards, from the errors in the complete log.
///
/// - `end`: function that returns the end of the interval of the fit for a sample. The fit uses only
///   samples before this time.
#[must_use]
pub fn best_causal(joint: &JointReplay, end: fn(&OnlineSample) -> f64) -> Option<BatchLaw> {
    let (samples, sums) = (&joint.samples, Sums::of(&joint.samples));
    let before = |time| samples.partition_point(|sample| sample.time < time);
    best(WINDOWS.iter().flat_map(|window| (1..=TERMS).map(move |terms| (terms, *window))), |terms, window| {
        let range = |i: usize| [end(&samples[i]) - window, end(&samples[i])].map(before);
        let of_sample = |i: usize| error(&sums.law(joint, range(i), terms), &samples[i]);
        (0..samples.len()).map(of_sample).collect()
    })
}

/// Returns the best single law for the log, fitted to all samples that the estimator used; `None` if no
/// error is finite.
#[must_use]
pub fn best_in_hindsight(joint: &JointReplay) -> Option<BatchLaw> {
    let sums = Sums::of(&joint.samples);
    best((1..=TERMS).map(|terms| (terms, f64::INFINITY)), |terms, _| {
        let law = sums.law(joint, [0, joint.samples.len()], terms);
        joint.samples.iter().map(|sample| error(&law, sample)).collect()
    })
}

fn best(
    tried: impl Iterator<Item = (usize, f64)>,
    errors: impl Fn(usize, f64) -> Vec<f64>,
) -> Option<BatchLaw> {
    let laws = tried.map(|(terms, window)| {
        let errors = errors(terms, window);
        let error = rms(errors.iter().copied());
        BatchLaw { terms, window, errors, error }
    });
    laws.filter(|law| law.error.is_finite()).min_by(|a, b| a.error.total_cmp(&b.error))
}

fn error(law: &[f64; TERMS], sample: &OnlineSample) -> f64 {
    sample.prediction.torque - law.iter().zip(&sample.prediction.terms).map(|(d, p)| d * p).sum::<f64>()
}

/// Sums of φ φᵀ and φ r over the first samples, one entry for each number of samples. φ is the vector of the
/// terms' values, r the error of the described friction.
struct Sums(Vec<[[f64; TERMS + 1]; TERMS]>);

impl Sums {
    fn of(samples: &[OnlineSample]) -> Self {
        let mut all = vec![[[0.0; TERMS + 1]; TERMS]];
        for sample in samples {
            let mut sums = all[all.len() - 1];
            let prediction = &sample.prediction;
            if prediction.is_explained {
                for i in 0..TERMS {
                    for j in 0..TERMS {
                        sums[i][j] += prediction.terms[i] * prediction.terms[j];
                    }
                    sums[i][TERMS] += prediction.terms[i] * prediction.torque;
                }
            }
            all.push(sums);
        }
        Self(all)
    }

    /// Returns the mean change δ of the described coefficients for a law with the first `terms` terms, fitted
    /// to a range of samples; zero if there are no terms.
    fn law(&self, joint: &JointReplay, [from, to]: [usize; 2], terms: usize) -> [f64; TERMS] {
        let noise = joint.state.noise * joint.state.noise;
        let sum = |i: usize, j: usize| self.0[to][i][j] - self.0[from][i][j];
        // The unknowns are scaled by the prior: δ = V^½ x.
        let scale = &joint.prior;
        let matrix = DMatrix::from_fn(terms, terms, |i, j| {
            scale[i] * scale[j] * sum(i, j) / noise + f64::from(u8::from(i == j))
        });
        let right = DVector::from_fn(terms, |i, _| scale[i] * sum(i, TERMS) / noise);
        let solution = matrix.cholesky().map(|factor| factor.solve(&right));
        let value = |i: usize| solution.as_ref().and_then(|x| x.get(i)).map_or(0.0, |x| scale[i] * x);
        std::array::from_fn(value)
    }
}
