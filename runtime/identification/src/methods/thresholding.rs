//! Sequentially thresholded least squares (STLS; Brunton, Proctor, Kutz 2016).
//!
//! SINDy in its general form, `ẋ ≈ Θ(x, u) Ξ` or `x⁺ ≈ Θ(x, u) Ξ`, consists of one such fit for each column of Ξ. The
//! channels of the library are the states x and the inputs u. The targets are the derivatives of the states
//! ([`super::differentiation`]) or their next samples x⁺.
//!
//! ```
//! use gelenk_identification::methods::least_squares::Reduced;
//! use gelenk_identification::methods::library::Library;
//! use gelenk_identification::methods::moments::Samples;
//! use gelenk_identification::methods::thresholding::Thresholding;
//!
//! // x decays and is driven by y, which oscillates: ẋ = −2 x + 3 y.
//! let wave = |of: fn(f64, f64) -> f64| -> Vec<f64> {
//!     let time = (0..2000).map(|i| 0.01 * f64::from(i));
//!     time.map(|t| [1.3, 2.9].iter().map(|rate| of(*rate, t)).sum()).collect()
//! };
//! let y = wave(|rate, t| (rate * t).sin());
//! let x = wave(|rate, t| 3.0 * (2.0 * (rate * t).sin() - rate * (rate * t).cos()) / (4.0 + rate * rate));
//! let rate: Vec<f64> = x.iter().zip(&y).map(|(x, y)| 3.0 * y - 2.0 * x).collect();
//!
//! let library = Library::new(&["1", "x", "y", "x*x", "x*y", "y*y"], &["x", "y"])?;
//! let samples = Samples::from_library(&library, vec![&x, &y], vec![&rate])?;
//! let fit = Thresholding { threshold: 0.5, ..Default::default() }.fit(&Reduced::new(&samples)?, 0)?;
//! assert_eq!(fit.active, [1, 2]);
//! assert!((fit.coefficients[1] + 2.0).abs() < 1e-9 && (fit.coefficients[2] - 3.0).abs() < 1e-9);
//! # Ok::<(), gelenk_identification::IdentificationError>(())
//! ```

use super::super::error::{Result, everything_removed, require_setting};
use super::least_squares::{Reduced, Solution};

/// Settings of [`Thresholding::fit`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thresholding {
    /// Magnitude below which a coefficient is removed, in the unit of the coefficient.
    pub threshold: f64,
    /// Ridge parameter α ≥ 0 of the intermediate solutions. Their coefficients ξ minimize `‖y − Θ ξ‖² + α ‖ξ‖²` with the target
    /// y and the matrix Θ of the terms. The final solution is computed without a ridge.
    pub ridge: f64,
    /// Largest number of iterations. Each iteration except the last one removes a term. Therefore p iterations are enough
    /// for p terms.
    pub max_iterations: usize,
}

impl Default for Thresholding {
    fn default() -> Self {
        Self { threshold: 0.1, ridge: 0.0, max_iterations: 20 }
    }
}

impl Thresholding {
    /// Solves least squares and removes every term whose coefficient is below the threshold. This is repeated until no
    /// coefficient is removed. Returns the least-squares solution on the remaining terms.
    ///
    /// - `reduced`: data of the regression
    /// - `target`: index of the target column
    ///
    /// # Errors
    /// [`Setting`](crate::IdentificationError::Setting) if the threshold or ridge is negative or not finite,
    /// [`EverythingRemoved`](crate::IdentificationError::EverythingRemoved) if the threshold removes every term, and the
    /// errors of [`Reduced::fit`].
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
                return Err(everything_removed("threshold", self.threshold, coefficients.amax()));
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
    use super::super::differentiation::TotalVariation;
    use super::super::library::Library;
    use super::super::moments::Samples;
    use super::*;
    use crate::numeric::random::SplitMix64;

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

    /// The states of the Lorenz system with noise give exactly its seven terms (Brunton, Proctor, Kutz 2016).
    #[test]
    fn lorenz_from_noisy_states() {
        let rate =
            |x: [f64; 3]| [10.0 * (x[1] - x[0]), x[0] * (28.0 - x[2]) - x[1], x[0] * x[1] - 8.0 / 3.0 * x[2]];
        let (step, mut x) = (1e-3, [-8.0, 7.0, 27.0]);
        let plus = |a: [f64; 3], b: [f64; 3], s: f64| std::array::from_fn(|i| a[i] + s * b[i]);
        let mut random = SplitMix64::new(3);
        let mut noisy = [const { Vec::new() }; 3];
        for _ in 0..20_000 {
            for (column, x) in noisy.iter_mut().zip(x) {
                column.push(x + 0.01 * random.normal());
            }
            // The midpoint rule has an error of 1e-5 after one second.
            x = plus(x, rate(plus(x, rate(x), step / 2.0)), step);
        }
        let times: Vec<f64> = (0..20_000).map(|i| f64::from(i) * step).collect();
        let smooth = noisy.map(|x| TotalVariation::from_noise(0.01).differentiate(&times, &x).unwrap());
        let inner = 100..19_900;
        let states = smooth.iter().map(|s| &s.value[inner.clone()]).collect();
        let rates = smooth.iter().map(|s| &s.first[inner.clone()]).collect();
        let terms =
            "1 x y z x*x x*y x*z y*y y*z z*z x*x*x x*x*y x*x*z x*y*y x*y*z x*z*z y*y*y y*y*z y*z*z z*z*z";
        let terms: Vec<&str> = terms.split(' ').collect();
        let library = Library::new(&terms, &["x", "y", "z"]).unwrap();
        let reduced = Reduced::new(&Samples::from_library(&library, states, rates).unwrap()).unwrap();
        let settings = Thresholding { threshold: 0.2, ..Default::default() };
        let expected = [
            vec![("x", -10.0), ("y", 10.0)],
            vec![("x", 28.0), ("y", -1.0), ("x*z", -1.0)],
            vec![("z", -8.0 / 3.0), ("x*y", 1.0)],
        ];
        for (state, expected) in expected.iter().enumerate() {
            let fit = settings.fit(&reduced, state).unwrap();
            let terms: Vec<&str> = fit.active.iter().map(|&i| library.terms()[i].as_str()).collect();
            assert_eq!(terms, expected.iter().map(|(term, _)| *term).collect::<Vec<_>>());
            for (&i, (term, value)) in fit.active.iter().zip(expected) {
                let found = fit.coefficients[i];
                assert!((found - value).abs() < 0.01 * value.abs(), "{term}: {found}");
            }
        }
    }

    #[test]
    fn a_threshold_that_removes_everything_says_which_would_not() {
        let (library, v, y) = data();
        let samples = Samples::from_library(&library, vec![&v], vec![&y]).unwrap();
        let reduced = Reduced::new(&samples).unwrap();
        let settings = Thresholding { threshold: 50.0, ..Default::default() };
        let crate::IdentificationError::EverythingRemoved { largest, .. } =
            settings.fit(&reduced, 0).unwrap_err()
        else {
            panic!("another error");
        };
        assert!(Thresholding { threshold: 0.999 * largest, ..settings }.fit(&reduced, 0).is_ok());
        let message =
            Thresholding { threshold: f64::NAN, ..settings }.fit(&reduced, 0).unwrap_err().to_string();
        assert_eq!(message, "threshold = NaN is not possible: it must be finite and not negative");
    }
}
