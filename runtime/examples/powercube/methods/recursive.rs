//! Recursive least squares with exponential forgetting and periodic thresholding, for adaptation in the loop.
//!
//! `K = P θ / (λ + θᵀ P θ)`, `ξ ← ξ + K (y − θᵀ ξ)`, `P ← (P − K θᵀ P)/λ` (Ljung, System Identification,
//! 1999, ch. 11). Fixed sizes: an update neither allocates nor fails; samples that are not finite are skipped
//! and counted.

use gelenk_identification::error::{Result, require_setting};
use nalgebra::{SMatrix, SVector};

/// Settings of [`RecursiveLeastSquares`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecursiveSettings {
    /// Forgetting factor λ in (0, 1]: a sample counts λᵏ after k updates; memory is about 1/(1 − λ) samples.
    pub forgetting: f64,
    /// Initial covariance of each coefficient over the noise variance: large means no prior knowledge.
    pub initial_covariance: f64,
    /// Upper limit of the covariance's trace: without excitation forgetting would let it grow without end.
    pub largest_trace: f64,
    /// Coefficients below this magnitude are removed at each check; 0 keeps all.
    pub threshold: f64,
    /// Updates between two checks; a check also lets removed terms compete again.
    pub period: u32,
}

impl Default for RecursiveSettings {
    fn default() -> Self {
        Self { forgetting: 0.999, initial_covariance: 1e6, largest_trace: 1e9, threshold: 0.0, period: 500 }
    }
}

/// Estimator of `N` coefficients.
#[derive(Debug, Clone, PartialEq)]
pub struct RecursiveLeastSquares<const N: usize> {
    settings: RecursiveSettings,
    coefficients: SVector<f64, N>,
    covariance: SMatrix<f64, N, N>,
    active: [bool; N],
    updates: u32,
    skipped: u64,
}

impl<const N: usize> RecursiveLeastSquares<N> {
    /// Starts from coefficients `initial`, e.g. the model in use.
    ///
    /// # Errors
    /// Settings out of range.
    pub fn new(initial: [f64; N], settings: RecursiveSettings) -> Result<Self> {
        let f = settings.forgetting;
        require_setting("forgetting factor", f, f > 0.0 && f <= 1.0, "it must lie in (0, 1]")?;
        let c = settings.initial_covariance;
        require_setting("initial covariance", c, c > 0.0, "it must be positive")?;
        let largest = settings.largest_trace;
        require_setting(
            "largest trace",
            largest,
            largest >= c * N as f64,
            "it must not be less than the initial trace",
        )?;
        require_setting(
            "threshold",
            settings.threshold,
            settings.threshold >= 0.0,
            "it must not be negative",
        )?;
        require_setting("period", f64::from(settings.period), settings.period > 0, "it must be positive")?;
        Ok(Self {
            settings,
            coefficients: SVector::from(initial),
            covariance: SMatrix::from_diagonal_element(c),
            active: [true; N],
            updates: 0,
            skipped: 0,
        })
    }

    /// Takes one sample: regressors `theta` and target `y`. Returns the prediction error before the update;
    /// samples that are not finite change nothing and return 0.
    pub fn update(&mut self, theta: &[f64; N], y: f64) -> f64 {
        let theta = SVector::from(*theta);
        let error = y - theta.dot(&self.masked());
        let direction = self.covariance * theta;
        let denominator = self.settings.forgetting + theta.dot(&direction);
        if !error.is_finite() || denominator <= 0.0 || !denominator.is_finite() {
            self.skipped += 1;
            return 0.0;
        }
        // The full model is updated with its own error; the mask acts on what is handed out.
        let full_error = y - theta.dot(&self.coefficients);
        self.coefficients += direction * (full_error / denominator);
        self.covariance -= direction * direction.transpose() / denominator;
        self.forget();
        self.updates = self.updates.wrapping_add(1);
        if self.settings.threshold > 0.0 && self.updates.is_multiple_of(self.settings.period) {
            self.remove_small();
        }
        error
    }

    /// Divides by λ where the trace allows it, and keeps the matrix symmetric.
    fn forget(&mut self) {
        let trace = self.covariance.trace();
        let factor =
            (1.0 / self.settings.forgetting).min(self.settings.largest_trace / trace.max(f64::MIN_POSITIVE));
        for i in 0..N {
            for j in 0..=i {
                let value = 0.5 * (self.covariance[(i, j)] + self.covariance[(j, i)]) * factor.max(1.0);
                self.covariance[(i, j)] = value;
                self.covariance[(j, i)] = value;
            }
        }
    }

    /// Removes one coefficient after the other, the least first, each time with the others adapted to the
    /// loss (`ξ ← ξ − P eᵢ ξᵢ/Pᵢᵢ`), until all remaining ones reach the threshold.
    fn remove_small(&mut self) {
        self.active = [true; N];
        let (mut w, mut p) = (self.coefficients, self.covariance);
        for _ in 0..N {
            let small = |i: &usize| self.active[*i] && w[*i].abs() < self.settings.threshold;
            let Some(i) = (0..N).filter(small).min_by(|&i, &j| w[i].abs().total_cmp(&w[j].abs())) else {
                break;
            };
            self.active[i] = false;
            eliminate(&mut w, &mut p, i);
        }
    }

    /// Coefficients in use, zero where removed; the others adapted to the removal.
    pub fn coefficients(&self) -> [f64; N] {
        self.masked().into()
    }

    fn masked(&self) -> SVector<f64, N> {
        let (mut w, mut p) = (self.coefficients, self.covariance);
        for i in (0..N).filter(|&i| !self.active[i]) {
            eliminate(&mut w, &mut p, i);
        }
        for i in (0..N).filter(|&i| !self.active[i]) {
            w[i] = 0.0;
        }
        w
    }

    /// Which terms are in use.
    pub fn active(&self) -> &[bool; N] {
        &self.active
    }

    /// Covariance over the noise variance.
    pub fn covariance(&self) -> &SMatrix<f64, N, N> {
        &self.covariance
    }

    /// Samples skipped because something was not finite.
    pub fn skipped(&self) -> u64 {
        self.skipped
    }
}

/// Sets coefficient i to zero and adapts the others: `w ← w − P eᵢ wᵢ/Pᵢᵢ`, P likewise.
fn eliminate<const N: usize>(w: &mut SVector<f64, N>, p: &mut SMatrix<f64, N, N>, i: usize) {
    let (column, pivot) = (p.column(i).into_owned(), p[(i, i)]);
    if pivot > 0.0 {
        *w -= column * (w[i] / pivot);
        *p -= column * column.transpose() / pivot;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gelenk_identification::numeric::random::SplitMix64;
    use nalgebra::{DMatrix, DVector};

    #[test]
    fn equals_weighted_least_squares_of_the_whole_past() {
        let mut random = SplitMix64::new(1);
        let forgetting: f64 = 0.98;
        let settings = RecursiveSettings {
            forgetting,
            initial_covariance: 1e4,
            largest_trace: 1e12,
            ..Default::default()
        };
        let mut rls = RecursiveLeastSquares::new([0.5, 0.0, -0.2], settings).unwrap();
        let m = 200;
        let theta = DMatrix::from_fn(m, 3, |_, _| random.normal());
        let y = DVector::from_fn(m, |_, _| random.normal());
        for i in 0..m {
            rls.update(&[theta[(i, 0)], theta[(i, 1)], theta[(i, 2)]], y[i]);
        }
        let w = DMatrix::from_diagonal(&DVector::from_fn(m, |i, _| forgetting.powi((m - 1 - i) as i32)));
        let prior = forgetting.powi(m as i32) / 1e4;
        let h = theta.transpose() * &w * &theta + DMatrix::identity(3, 3) * prior;
        let b = theta.transpose() * w * y + DVector::from_column_slice(&[0.5, 0.0, -0.2]) * prior;
        let exact = h.cholesky().unwrap().solve(&b);
        for i in 0..3 {
            assert!((rls.coefficients()[i] - exact[i]).abs() < 1e-8);
        }
    }

    #[test]
    fn follows_a_change_and_removes_what_is_not_there() {
        let mut random = SplitMix64::new(2);
        let settings =
            RecursiveSettings { forgetting: 0.995, threshold: 0.3, period: 200, ..Default::default() };
        let mut rls = RecursiveLeastSquares::new([0.0; 4], settings).unwrap();
        let mut run = |rls: &mut RecursiveLeastSquares<4>, viscous: f64| {
            for _ in 0..4000 {
                let v = 2.0 * random.uniform() - 1.0;
                let y = viscous * v + 0.8 * (20.0 * v).tanh() + 0.05 * random.normal();
                rls.update(&[1.0, v, v * v.abs(), (20.0 * v).tanh()], y);
            }
        };
        for viscous in [3.0, 1.2] {
            run(&mut rls, viscous);
            assert_eq!(rls.active(), &[false, true, false, true]);
            let w = rls.coefficients();
            assert!(
                (w[1] - viscous).abs() < 0.06 && (w[3] - 0.8).abs() < 0.05 && w[0] == 0.0 && w[2] == 0.0,
                "{w:?}"
            );
        }
    }

    #[test]
    fn no_excitation_and_bad_samples_do_no_harm() {
        let settings = RecursiveSettings { forgetting: 0.9, ..Default::default() };
        let mut rls = RecursiveLeastSquares::new([1.0, 2.0], settings).unwrap();
        for i in 0..100_000 {
            let y = if i % 7 == 0 { f64::NAN } else { 3.0 };
            rls.update(&[1.0, 0.0], y);
        }
        assert_eq!(rls.skipped(), 14_286);
        assert!(rls.covariance().iter().all(|p| p.is_finite()) && rls.covariance().trace() <= 1.0001e9);
        assert!((rls.coefficients()[0] - 3.0).abs() < 1e-6 && (rls.coefficients()[1] - 2.0).abs() < 1e-9);
        let message =
            RecursiveLeastSquares::new([0.0], RecursiveSettings { forgetting: 1.5, ..settings }).unwrap_err();
        assert_eq!(message.to_string(), "forgetting factor = 1.5 is not possible: it must lie in (0, 1]");
    }
}
