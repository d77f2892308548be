//! Sequentially thresholded least squares (STLS; Brunton, Proctor, Kutz 2016).

use super::error::{IdentificationError, Result, require_setting};
use super::least_squares::{Reduced, Solution};

/// Settings of [`Thresholding::fit`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thresholding {
    /// Coefficients below this magnitude are removed, in the coefficient's own unit.
    pub threshold: f64,
    /// Ridge α ≥ 0 of the solves between the removals: `‖y − Θ ξ‖² + α ‖ξ‖²`. The final refit has none.
    pub ridge: f64,
    /// Limit of the removals; each removes a term or ends the iteration, so p is always enough.
    pub max_iterations: usize,
}

impl Default for Thresholding {
    fn default() -> Self {
        Self { threshold: 0.1, ridge: 0.0, max_iterations: 20 }
    }
}

impl Thresholding {
    /// Solves, removes every coefficient below the threshold, and repeats until none is removed; then refits.
    ///
    /// - `reduced`: the data; `target`: which target column
    /// - returns the least-squares solution on the terms that stayed
    ///
    /// # Errors
    /// A negative or NaN threshold or ridge, a threshold that removes every term, or a factorization that
    /// fails.
    pub fn fit(&self, reduced: &Reduced, target: usize) -> Result<Solution> {
        require_setting(
            "threshold",
            self.threshold,
            self.threshold >= 0.0,
            "it must be finite and not negative",
        )?;
        require_setting("ridge", self.ridge, self.ridge >= 0.0, "it must be finite and not negative")?;
        let mut active: Vec<usize> = (0..reduced.moments().terms()).collect();
        for _ in 0..self.max_iterations {
            let coefficients = reduced.solve(target, &active, self.ridge)?;
            let before = active.len();
            active.retain(|&i| coefficients[i].abs() >= self.threshold);
            if active.is_empty() {
                return Err(IdentificationError::EverythingRemoved {
                    what: "threshold".into(),
                    value: self.threshold,
                    largest: coefficients.amax(),
                });
            }
            if active.len() == before {
                break;
            }
        }
        reduced.fit(target, &active)
    }
}

#[cfg(test)]
mod tests {
    use super::super::library::Library;
    use super::super::moments::Samples;
    use super::super::random::SplitMix64;
    use super::*;

    fn data() -> (Library, Vec<f64>, Vec<f64>) {
        let library = Library::new(&["1", "v", "v*abs(v)", "tanh(20*v)"], &["v"]).unwrap();
        let mut random = SplitMix64::new(7);
        let v: Vec<f64> = (0..4000).map(|_| 2.0 * random.uniform() - 1.0).collect();
        let y = v.iter().map(|v| 2.1 * v + 1.4 * (20.0 * v).tanh() + 0.05 * random.normal()).collect();
        (library, v, y)
    }

    #[test]
    fn chooses_the_terms_that_made_the_data() {
        let (library, v, y) = data();
        let samples = Samples::from_library(&library, vec![&v], vec![&y]).unwrap();
        let reduced = Reduced::new(&samples).unwrap();
        let settings = Thresholding { threshold: 0.2, ridge: 0.05, ..Default::default() };
        let fit = settings.fit(&reduced, 0).unwrap();
        assert_eq!(fit.active, [1, 3]);
        assert!((fit.coefficients[1] - 2.1).abs() < 4.0 * fit.standard_errors[0]);
        assert!((fit.coefficients[3] - 1.4).abs() < 4.0 * fit.standard_errors[1]);
        assert!((fit.variance.sqrt() - 0.05).abs() < 0.003);
    }

    #[test]
    fn a_threshold_that_removes_everything_says_which_would_not() {
        let (library, v, y) = data();
        let samples = Samples::from_library(&library, vec![&v], vec![&y]).unwrap();
        let reduced = Reduced::new(&samples).unwrap();
        let settings = Thresholding { threshold: 50.0, ..Default::default() };
        let IdentificationError::EverythingRemoved { largest, .. } = settings.fit(&reduced, 0).unwrap_err()
        else {
            panic!("another error");
        };
        assert!(Thresholding { threshold: 0.999 * largest, ..settings }.fit(&reduced, 0).is_ok());
        let message =
            Thresholding { threshold: f64::NAN, ..settings }.fit(&reduced, 0).unwrap_err().to_string();
        assert_eq!(message, "threshold = NaN is not possible: it must be finite and not negative");
    }
}
