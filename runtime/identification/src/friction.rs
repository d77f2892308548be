//! The friction law of one joint from its velocity and friction torque, with everything that says how far to
//! trust it.
//!
//! Terms are chosen by one of the [`FrictionMethod`]s and refitted by least squares; a bootstrap over
//! contiguous blocks says how stable the choice is. Standard errors assume independent errors, which samples
//! of a smoothed log do not have: the bootstrap's intervals are the honest ones.

use super::constrained::{constrained_fit, nonnegative_rows, passivity_rows};
use super::cross_validation::{CrossValidation, ParetoPoint, pareto_front, refit};
use super::ensemble::{Ensemble, bootstrap};
use super::error::{IdentificationError, Result, require_finite, require_length, require_samples};
use super::lasso::{Lasso, active_terms, paper_lambda};
use super::least_squares::{Reduced, Solution, Solver};
use super::library::Library;
use super::moments::{Moments, Samples};
use super::result::{FrictionLaw, FrictionResult, FrictionTerm};
use super::stribeck::StribeckRegression;
use super::subset::{SubsetValidation, best_of_size};
use super::thresholding::Thresholding;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Condition number of the library above which coefficients are doubted (the curve need not be).
const DOUBTFUL_CONDITION: f64 = 100.0;

/// Friction samples of one joint.
#[derive(Debug, Clone)]
pub struct FrictionData<'a> {
    /// Name of the joint in the description.
    pub joint: &'a str,
    /// Unit of the torque, `N·m` or `N`.
    pub unit: &'a str,
    /// Unit of the velocity, `rad/s` or `m/s`.
    pub velocity_unit: &'a str,
    /// ẏ.
    pub velocities: &'a [f64],
    /// τ, from [`super::torque::friction_torques`].
    pub torques: &'a [f64],
    /// Weights of the samples, 1 where absent.
    pub weights: Option<&'a [f64]>,
    /// Folds of the cross-validation, e.g. runs, or groups of runs that repeat one motion; contiguous blocks
    /// of equal size where absent.
    pub folds: Option<&'a [Range<usize>]>,
    /// Source and hash of the log.
    pub data: &'a str,
    /// How these samples were made: differentiation, selection.
    pub settings: &'a [String],
}

/// Which λ of a cross-validated path is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LambdaChoice {
    /// The one with the least error on left-out blocks.
    Minimum,
    /// The largest one whose error is within one standard error of the least.
    OneStandardError,
}

/// How the law is found.
#[derive(Debug, Clone, PartialEq)]
pub enum FrictionMethod {
    /// Least squares on all terms of the library.
    LeastSquares,
    /// Sequentially thresholded least squares.
    Thresholding(Thresholding),
    /// LASSO on 100 values of λ, cross-validated on contiguous blocks, then least squares on the chosen
    /// terms.
    Lasso(Lasso, LambdaChoice),
    /// The subset with the fewest terms whose error on left-out blocks is within one standard error of the
    /// least, for libraries of at most twelve terms.
    BestSubset,
    /// Nonlinear regression of the Stribeck law; the library is not used.
    Stribeck(StribeckRegression),
}

/// Settings.
#[derive(Debug, Clone)]
pub struct FrictionIdentification {
    /// Terms in the velocity `v`.
    pub library: Library,
    /// How the law is found.
    pub method: FrictionMethod,
    /// Contiguous blocks of the cross-validation, where the data name no folds.
    pub folds: usize,
    /// Bootstrap draws; 0 for none.
    pub draws: usize,
    /// Contiguous blocks among which the bootstrap draws: longer than the errors are correlated.
    pub blocks: usize,
    /// Seed of the bootstrap.
    pub seed: u64,
    /// Forces `τ v ≥ 0` over the speeds in the data and viscous friction ≥ 0, where least squares would break
    /// them.
    pub passive: bool,
}

impl FrictionIdentification {
    /// The reference robot's library, thresholding at 0.1, ten folds, 200 draws from 60 blocks, passive.
    ///
    /// # Errors
    /// None in practice; the signature is that of [`Library::new`].
    pub fn new() -> Result<Self> {
        Ok(Self {
            library: Library::friction()?,
            method: FrictionMethod::Thresholding(Thresholding::default()),
            folds: 10,
            draws: 200,
            blocks: 60,
            seed: 1,
            passive: true,
        })
    }
}

/// The law, and what it was chosen from.
#[derive(Debug, Clone)]
pub struct FrictionReport {
    /// The law with its numbers.
    pub result: FrictionResult,
    /// Cosines between the library's columns `[p × p]`.
    pub correlation: DMatrix<f64>,
    /// Condition number of the library, columns scaled.
    pub condition: f64,
    /// Cross-validated path, for the LASSO.
    pub validation: Option<CrossValidation>,
    /// Error against number of terms over λ, for the LASSO.
    pub front: Vec<ParetoPoint>,
    /// Bootstrap; none without draws.
    pub ensemble: Option<Ensemble>,
    /// Torque minus law at the samples.
    pub residuals: Vec<f64>,
}

impl FrictionIdentification {
    /// Finds the law of one joint.
    ///
    /// # Errors
    /// Lengths that disagree, values that are not finite, a velocity that never changes, and what the method
    /// reports: collinear terms, too few samples, a threshold or λ that removes every term.
    pub fn identify(&self, data: &FrictionData) -> Result<FrictionReport> {
        check(data)?;
        let mut samples = Samples::from_library(&self.library, vec![data.velocities], vec![data.torques])?;
        if let Some(weights) = data.weights {
            samples = samples.with_weights(weights)?;
        }
        let mut work =
            Work { settings: self, data, samples, notes: data.settings.to_vec(), warnings: Vec::new() };
        match &self.method {
            FrictionMethod::Stribeck(regression) => work.stribeck(regression),
            _ => work.sparse(),
        }
    }
}

fn check(data: &FrictionData) -> Result<()> {
    let m = data.velocities.len();
    require_samples(&format!("the friction of {}", data.joint), 2, m)?;
    require_length("friction torques", m, data.torques.len())?;
    require_finite(&format!("the velocity of {}", data.joint), data.velocities)?;
    require_finite(&format!("the friction torque of {}", data.joint), data.torques)?;
    if data.velocities.iter().all(|v| *v == data.velocities[0]) {
        return Err(IdentificationError::Constant {
            what: format!("the velocity of {}", data.joint),
            value: data.velocities[0],
            samples: m,
        });
    }
    Ok(())
}

struct Work<'a> {
    settings: &'a FrictionIdentification,
    data: &'a FrictionData<'a>,
    samples: Samples<'a>,
    notes: Vec<String>,
    warnings: Vec<String>,
}

/// A choice of terms, repeatable on other moments.
enum Selection {
    All,
    Thresholding(Thresholding),
    Lasso(Lasso, f64),
    BestOfSize(usize),
}

impl Selection {
    fn fit(&self, reduced: &Reduced) -> Result<Solution> {
        match self {
            Self::All => {
                let all: Vec<usize> = (0..reduced.moments().terms()).collect();
                reduced.fit(0, &all)
            }
            Self::Thresholding(settings) => settings.fit(reduced, 0),
            Self::Lasso(lasso, lambda) => {
                let (_, active) = lasso.fit(reduced.moments(), 0, *lambda)?;
                reduced.fit(0, &active)
            }
            Self::BestOfSize(size) => {
                let best = best_of_size(reduced.moments(), 0, *size)?;
                reduced.fit(0, &active_terms(&best))
            }
        }
    }
}

impl Work<'_> {
    fn sparse(&mut self) -> Result<FrictionReport> {
        let reduced = Reduced::new(&self.samples)?;
        self.notes.push(format!(
            "library [{}], condition number {:.1}",
            self.settings.library.terms().join(", "),
            reduced.condition()
        ));
        if reduced.condition() > DOUBTFUL_CONDITION {
            self.warnings.push(format!(
                "the library is nearly collinear on these velocities (condition number {:.0}): trust the curve, not the \
                 single coefficients",
                reduced.condition()
            ));
        }
        if reduced.solver() == Solver::Orthogonal {
            self.notes.push("solved by orthogonal factorization".into());
        }
        let (selection, solution, validation) = self.select(&reduced)?;
        let front = match &validation {
            Some(validation) => pareto_front(&reduced, 0, validation)?,
            None => Vec::new(),
        };
        let ensemble = self.ensemble(&selection)?;
        let coefficients = self.passive(&reduced, &solution)?;
        let law = self.law(&solution, &coefficients, ensemble.as_ref());
        let mut report = self.report(law)?;
        report.correlation = reduced.moments().correlation();
        report.condition = reduced.condition();
        report.validation = validation;
        report.front = front;
        report.ensemble = ensemble;
        Ok(report)
    }

    fn select(&mut self, reduced: &Reduced) -> Result<(Selection, Solution, Option<CrossValidation>)> {
        match &self.settings.method {
            FrictionMethod::Thresholding(settings) => {
                let t = settings.threshold;
                self.notes.push(format!(
                    "sequentially thresholded least squares, threshold {t}, ridge {}",
                    settings.ridge
                ));
                let selection = Selection::Thresholding(*settings);
                Ok((selection, settings.fit(reduced, 0)?, None))
            }
            FrictionMethod::Lasso(lasso, choice) => self.select_by_lasso(reduced, lasso, *choice),
            FrictionMethod::BestSubset => {
                let folds = self.folds()?;
                let subsets = SubsetValidation::new(&folds, 0)?;
                let chosen = &subsets.best[subsets.one_standard_error];
                self.notes.push(format!(
                    "best subset, {} contiguous folds, choice by one standard error",
                    folds.len()
                ));
                let selection = Selection::BestOfSize(chosen.active.len());
                Ok((selection, reduced.fit(0, &chosen.active)?, None))
            }
            FrictionMethod::LeastSquares | FrictionMethod::Stribeck(_) => {
                self.notes.push("least squares on all terms".into());
                Ok((Selection::All, Selection::All.fit(reduced)?, None))
            }
        }
    }

    fn folds(&self) -> Result<Vec<Moments>> {
        match self.data.folds {
            Some(ranges) => Moments::ranges(&self.samples, ranges),
            None => Moments::blocks(&self.samples, self.settings.folds),
        }
    }

    fn select_by_lasso(
        &mut self,
        reduced: &Reduced,
        lasso: &Lasso,
        choice: LambdaChoice,
    ) -> Result<(Selection, Solution, Option<CrossValidation>)> {
        let folds = self.folds()?;
        let grid = lasso.lambda_grid(reduced.moments(), 0, 100, 1e-4)?;
        let validation = CrossValidation::new(lasso, &folds, 0, &grid)?;
        let (index, name) = match choice {
            LambdaChoice::Minimum => (validation.minimum, "least error"),
            LambdaChoice::OneStandardError => (validation.one_standard_error, "one standard error"),
        };
        let lambda = grid[index];
        self.notes.push(format!(
            "LASSO, {} contiguous folds, choice by {name}: λ = {lambda:.4e} in 1/(2N)‖·‖² + λ‖·‖₁{}, {:.4e} in \
             ‖·‖² + λ‖·‖₁; then least squares on the chosen terms",
            folds.len(),
            if lasso.standardize { " (terms in units of their rms)" } else { "" },
            paper_lambda(lambda, reduced.moments().samples())
        ));
        let solution = refit(reduced, 0, &validation.path, index)?;
        let selection = Selection::Lasso(lasso.clone(), lambda);
        Ok((selection, solution, Some(validation)))
    }

    fn ensemble(&mut self, selection: &Selection) -> Result<Option<Ensemble>> {
        let (draws, count) = (self.settings.draws, self.settings.blocks);
        if draws == 0 {
            return Ok(None);
        }
        let blocks = Moments::blocks(&self.samples, count.min(self.samples.len()))?;
        let fit = |moments: Moments| -> Result<DVector<f64>> {
            Ok(selection.fit(&Reduced::from_moments(moments)?)?.coefficients)
        };
        match bootstrap(&blocks, draws, self.settings.seed, fit) {
            Ok(ensemble) => {
                self.notes.push(format!(
                    "inclusion: {draws} draws of {} contiguous blocks, seed {}",
                    blocks.len(),
                    self.settings.seed
                ));
                if let Some(reason) = &ensemble.first_failure {
                    self.warnings.push(format!(
                        "{} of {draws} bootstrap draws gave no model: {reason}",
                        ensemble.failed
                    ));
                }
                Ok(Some(ensemble))
            }
            Err(reason) => {
                self.warnings.push(format!("no bootstrap draw gave a model: {reason}"));
                Ok(None)
            }
        }
    }

    /// Coefficients of the chosen terms, constrained where least squares would make friction drive the joint.
    fn passive(&mut self, reduced: &Reduced, solution: &Solution) -> Result<DVector<f64>> {
        let free = solution.coefficients.clone();
        if !self.settings.passive {
            return Ok(free);
        }
        let library = &self.settings.library;
        let fastest = self.data.velocities.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
        let grid: Vec<f64> = (-200..=200).map(|i| fastest * f64::from(i) / 200.0).collect();
        let viscous: Vec<usize> = (0..library.len()).filter(|&i| library.terms()[i] == "v").collect();
        let (signs, slope) = (passivity_rows(library, &grid)?, nonnegative_rows(&viscous, library.len()));
        let all: Vec<_> = signs.row_iter().chain(slope.row_iter()).collect();
        let rows = DMatrix::from_rows(&all);
        let worst = (&rows * &free).min();
        let largest = free.amax();
        if worst >= -1e-9 * largest {
            return Ok(free);
        }
        self.warnings.push(format!(
            "least squares would give a law that drives the joint (by up to {:.4}); it was refitted under τ v ≥ 0 and \
             viscous friction ≥ 0, the standard errors are those of the free fit",
            -worst
        ));
        constrained_fit(reduced, 0, &solution.active, &rows)
    }

    fn law(
        &self,
        solution: &Solution,
        coefficients: &DVector<f64>,
        ensemble: Option<&Ensemble>,
    ) -> FrictionLaw {
        let term = |(k, &i): (usize, &usize)| FrictionTerm {
            basis: self.settings.library.terms()[i].clone(),
            coefficient: coefficients[i],
            standard_error: Some(solution.standard_errors[k]).filter(|e| e.is_finite()),
            inclusion: ensemble.map(|e| e.inclusion[i]),
        };
        FrictionLaw::Terms(solution.active.iter().enumerate().map(term).collect())
    }

    fn stribeck(&mut self, regression: &StribeckRegression) -> Result<FrictionReport> {
        let fit = regression.fit(self.data.velocities, self.data.torques, self.data.weights)?;
        self.notes.push(format!(
            "Stribeck law by least squares, {:?} weights, {} starts, {} passes",
            regression.robustness, regression.starts, fit.iterations
        ));
        self.warnings.extend(fit.warnings.iter().cloned());
        let mut report = self.report(FrictionLaw::Stribeck {
            parameters: fit.parameters,
            standard_errors: fit.standard_errors,
        })?;
        report.condition = fit.condition;
        Ok(report)
    }

    /// Residuals and summary of a law.
    fn report(&mut self, law: FrictionLaw) -> Result<FrictionReport> {
        let data = self.data;
        let torques = law.torques(data.velocities)?;
        let residuals: Vec<f64> = data.torques.iter().zip(&torques).map(|(t, l)| t - l).collect();
        let sum = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
        let (rss, energy) = (sum(&residuals), sum(data.torques));
        let range = data
            .velocities
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(*v), b.max(*v)]);
        let result = FrictionResult {
            joint: data.joint.into(),
            unit: data.unit.into(),
            velocity_unit: data.velocity_unit.into(),
            law,
            samples: residuals.len(),
            velocity_range: range,
            residual: (rss / residuals.len() as f64).sqrt(),
            r_squared: if energy > 0.0 { 1.0 - rss / energy } else { 1.0 },
            data: data.data.into(),
            settings: std::mem::take(&mut self.notes),
            warnings: std::mem::take(&mut self.warnings),
        };
        Ok(FrictionReport {
            result,
            correlation: DMatrix::zeros(0, 0),
            condition: f64::NAN,
            validation: None,
            front: Vec::new(),
            ensemble: None,
            residuals,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::random::SplitMix64;
    use super::*;

    fn samples(law: impl Fn(f64) -> f64, noise: f64) -> (Vec<f64>, Vec<f64>) {
        let mut random = SplitMix64::new(9);
        let v: Vec<f64> = (0..6000)
            .map(|i| 0.6 * (0.011 * f64::from(i)).sin() + 0.4 * (0.027 * f64::from(i)).sin())
            .collect();
        let torque = v.iter().map(|v| law(*v) + noise * random.normal()).collect();
        (v, torque)
    }

    fn identify(settings: &FrictionIdentification, v: &[f64], torque: &[f64]) -> Result<FrictionReport> {
        settings.identify(&FrictionData {
            joint: "beta",
            unit: "N·m",
            velocity_unit: "rad/s",
            velocities: v,
            torques: torque,
            weights: None,
            folds: None,
            data: "here (sha256 0)",
            settings: &["made by hand".into()],
        })
    }

    #[test]
    fn every_method_finds_the_curve() {
        let truth = |v: f64| 20.0 * v + 3.0 * (10.0 * v).tanh();
        let (v, torque) = samples(truth, 0.2);
        let lasso = Lasso { standardize: true, ..Default::default() };
        let methods = [
            FrictionMethod::LeastSquares,
            FrictionMethod::Thresholding(Thresholding::default()),
            FrictionMethod::Lasso(lasso.clone(), LambdaChoice::Minimum),
            FrictionMethod::Lasso(lasso, LambdaChoice::OneStandardError),
            FrictionMethod::BestSubset,
            FrictionMethod::Stribeck(StribeckRegression::default()),
        ];
        for method in methods {
            let settings =
                FrictionIdentification { method, draws: 20, ..FrictionIdentification::new().unwrap() };
            let report = identify(&settings, &v, &torque).unwrap();
            let grid: Vec<f64> = (-100..=100).map(|i| 0.009 * f64::from(i)).collect();
            let law = report.result.law.torques(&grid).unwrap();
            for (v, t) in grid.iter().zip(&law) {
                assert!((t - truth(*v)).abs() < 0.25, "{:?} at {v}", settings.method);
            }
            assert!((report.result.residual - 0.2).abs() < 0.01);
            assert_eq!(report.residuals.len(), 6000);
            assert_eq!(report.result.settings[0], "made by hand");
        }
    }

    #[test]
    fn the_lasso_says_its_lambda_in_both_conventions_and_keeps_its_path() {
        let (v, torque) = samples(|v| 20.0 * v + 3.0 * (10.0 * v).tanh(), 0.2);
        let lasso = Lasso { standardize: true, ..Default::default() };
        let settings = FrictionIdentification {
            method: FrictionMethod::Lasso(lasso, LambdaChoice::OneStandardError),
            ..FrictionIdentification::new().unwrap()
        };
        let report = identify(&settings, &v, &torque).unwrap();
        let text = report.result.settings.join("\n");
        assert!(text.contains("in 1/(2N)‖·‖² + λ‖·‖₁") && text.contains("in ‖·‖² + λ‖·‖₁"), "{text}");
        assert_eq!(report.front.len(), 100);
        assert_eq!(report.correlation.shape(), (7, 7));
        let ensemble = report.ensemble.unwrap();
        assert_eq!(ensemble.inclusion[1], 1.0);
    }

    #[test]
    fn a_law_that_would_drive_the_joint_is_mended_with_a_warning() {
        // An offset: at small velocities the free law would push.
        let (v, torque) = samples(|v| 0.5 + 20.0 * v + 3.0 * (10.0 * v).tanh(), 0.05);
        let settings = FrictionIdentification::new().unwrap();
        let report = identify(&settings, &v, &torque).unwrap();
        assert!(report.result.warnings.iter().any(|w| w.contains("drives the joint")));
        let grid: Vec<f64> = (-100..=100).map(|i| 0.01 * f64::from(i)).collect();
        for (v, t) in grid.iter().zip(report.result.law.torques(&grid).unwrap()) {
            assert!(v * t >= -1e-6, "{v} {t}");
        }
        let free = FrictionIdentification { passive: false, ..settings };
        assert!(identify(&free, &v, &torque).unwrap().result.warnings.iter().all(|w| !w.contains("drives")));
    }

    #[test]
    fn bad_data_have_messages() {
        let settings = FrictionIdentification::new().unwrap();
        let message = |v: &[f64], t: &[f64]| identify(&settings, v, t).unwrap_err().to_string();
        assert!(message(&[], &[]).starts_with("the friction of beta is empty"));
        assert!(message(&[1.0], &[1.0]).contains("needs at least 2 samples, there are 1"));
        assert!(
            message(&[1.0; 50], &[1.0; 50]).starts_with("the velocity of beta is constant (1) in all 50")
        );
        assert!(message(&[1.0, f64::NAN], &[1.0; 2]).contains("not finite (NaN) at row 1"));
        assert!(message(&[1.0, 2.0], &[1.0]).contains("friction torques: 2 expected, 1 given"));
        assert!(message(&[0.1, 0.2, 0.3], &[1.0; 3]).contains("needs at least 7 samples, there are 3"));
    }
}
