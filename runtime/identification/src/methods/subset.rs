//! Best subset of a small library. Every subset is fitted to all folds except one and tested on this fold.
//!
//! With p terms and k folds, these are k·2ᵖ solutions of at most p × p normal equations. The method needs no λ and does not
//! have the bias of the LASSO (Hocking and Leslie 1967; one-standard-error rule: Breiman 1984).

use super::super::error::{IdentificationError, Result, require_setting};
use super::super::numeric::statistics::{mean_with_error, simplest};
use super::constrained::{breaks, constrained};
use super::least_squares::solve_scaled;
use super::moments::{Moments, splits};
use nalgebra::{DMatrix, DVector};

/// Largest number of terms of a library. Twelve terms have 4095 subsets with at least one term.
pub(crate) const MOST_TERMS: usize = 12;

/// Subset of the candidate terms, with the error of its law on held-out folds.
#[derive(Debug, Clone, PartialEq)]
pub struct ValidatedSubset {
    /// Indices of the terms in ascending order.
    pub active: Vec<usize>,
    /// Mean squared error on the held-out fold, averaged over the folds.
    pub mean_error: f64,
    /// Standard error of [`Self::mean_error`] over the folds.
    pub standard_error: f64,
}

/// Pareto table for a choice of terms: sets of terms with their errors on held-out folds. The chosen set is one of them.
///
/// For the method of the best subset, the table contains the best set of each size. For STLS and LASSO, it contains the sets
/// that are chosen with decreasing thresholds or penalties.
#[derive(Debug, Clone, PartialEq)]
pub struct SubsetValidation {
    /// Sets in the order of their number of terms, from few to many. Sets whose equations cannot be solved are left out.
    pub best: Vec<ValidatedSubset>,
    /// Index of the set with the smallest error.
    pub minimum: usize,
    /// Index of the chosen set. For the best subset, it is the set with the fewest terms whose error exceeds the smallest
    /// error by at most one standard error.
    pub chosen: usize,
}

/// Dependence of a term on another term: an asymmetry `|f(v)|` needs `f(v)`. Without `f(v)`, the asymmetry would replace
/// `f(v)` if the motion has only one direction, and would drive the joint in the other direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Requirement {
    /// Index of the term that needs another term.
    pub term: usize,
    /// Index of the term that must be in the law, too.
    pub needs: usize,
}

/// Returns a requirement for each term `abs(f)` of a library that also has the term `f`.
pub(crate) fn requirements(terms: &[String]) -> Vec<Requirement> {
    let partner = |(term, text): (usize, &String)| {
        let inner = text.strip_prefix("abs(")?.strip_suffix(')')?;
        let needs = terms.iter().position(|t| t == inner)?;
        Some(Requirement { term, needs })
    };
    terms.iter().enumerate().filter_map(partner).collect()
}

/// Conditions on the friction law of a subset.
#[derive(Debug, Clone, Default)]
pub(crate) struct Conditions {
    /// Terms that need other terms.
    pub requirements: Vec<Requirement>,
    /// Matrix A of the constraints `A ξ ≥ 0` on the coefficients ξ of all terms; `None` for fits without constraints.
    pub rows: Option<DMatrix<f64>>,
    /// Values of all terms, one row for each speed. The terms of a law must not cancel each other at any of these speeds.
    /// `None` if this is not checked.
    pub values: Option<DMatrix<f64>>,
}

/// Largest ratio of Σ |terms| to |law| at a speed. The ratio is within this limit if the friction in one direction is up to
/// three times the friction in the other direction.
const MOST_CANCELLED: f64 = 3.0;

/// Returns whether the terms of a law cancel each other at some speed.
fn cancels(values: &DMatrix<f64>, coefficients: &DVector<f64>) -> bool {
    let cancels_at = |speed: usize| {
        let terms = (0..coefficients.len()).map(|term| values[(speed, term)] * coefficients[term]);
        let [law, all] = terms.fold([0.0, 0.0], |[law, all], term| [law + term, all + term.abs()]);
        all > MOST_CANCELLED * law.abs() * (1.0 + 1e-9)
    };
    (0..values.nrows()).any(cancels_at)
}

impl Conditions {
    /// Solves least squares on a subset with the constraints; `None` if there is no solution or if the terms of the
    /// solution cancel each other.
    fn fit(&self, moments: &Moments, target: usize, active: &[usize]) -> Option<DVector<f64>> {
        self.met(moments, fit(moments, target, active)?, active)
    }

    /// Returns the solution with the constraints, computed from the solution without them; `None` as in [`Self::fit`].
    fn met(&self, moments: &Moments, free: DVector<f64>, active: &[usize]) -> Option<DVector<f64>> {
        let met = match &self.rows {
            Some(rows) if breaks(rows, &free) => constrained(moments, free, active, rows).ok()?,
            _ => free,
        };
        let cancels = self.values.as_ref().is_some_and(|values| cancels(values, &met));
        (!cancels).then_some(met)
    }
}

/// Cosine between f and |f| above which an asymmetry cannot be distinguished from f. At this value nine tenths of the
/// energy of f are in one direction.
pub(crate) const MOST_ALIKE: f64 = 0.8;

/// Returns the indices of the terms that the motion can distinguish. An asymmetry `|f(v)|` is left out if nearly all of the
/// motion is in one direction, in which `|f(v)|` is `f(v)` or its negative. The second value is a sentence about the terms
/// that are left out; `None` if all terms are kept.
///
/// - `energies`: function that returns Σ f² of a term f, forwards and backwards
pub(crate) fn seen_both_ways(
    terms: &[String],
    energies: impl Fn(usize) -> [f64; 2],
) -> (Vec<usize>, Vec<String>) {
    let unseen = |requirement: &Requirement| {
        let [forwards, backwards] = energies(requirement.needs);
        (forwards - backwards).abs() > MOST_ALIKE * (forwards + backwards)
    };
    let out: Vec<usize> = requirements(terms).iter().filter(|r| unseen(r)).map(|r| r.term).collect();
    let texts = out.iter().map(|&i| terms[i].clone()).collect();
    ((0..terms.len()).filter(|i| !out.contains(i)).collect(), texts)
}

/// Returns all subsets of p terms that meet the requirements. The empty subset is the first one.
fn subsets(p: usize, requirements: &[Requirement]) -> impl Iterator<Item = Vec<usize>> {
    let has = |bits: u32, i: usize| bits >> i & 1 == 1;
    let meets = move |bits: &u32| requirements.iter().all(|r| !has(*bits, r.term) || has(*bits, r.needs));
    (0..1_u32 << p.min(MOST_TERMS))
        .filter(meets)
        .map(move |bits| (0..p).filter(|i| *i < MOST_TERMS && has(bits, *i)).collect())
}

impl SubsetValidation {
    /// Tests all subsets that meet the conditions.
    ///
    /// - `folds`: moments of contiguous blocks, see [`Moments::blocks`]
    ///
    /// # Errors
    /// - `Setting`: there are fewer than two folds or more than [`MOST_TERMS`] terms
    /// - `Collinear`: no subset can be solved
    pub(crate) fn new(folds: &[Moments], target: usize, conditions: &Conditions) -> Result<Self> {
        let p = folds.first().map_or(0, Moments::terms);
        let count = folds.len() as f64;
        require_setting("number of folds", count, folds.len() >= 2, "at least two are needed")?;
        require_setting(
            "number of terms",
            p as f64,
            (1..=MOST_TERMS).contains(&p),
            "the method tries all subsets of one to twelve terms. Use the LASSO for more terms",
        )?;
        folds[0].require_target(target)?;
        let splits = splits(folds).collect::<Result<Vec<_>>>()?;
        let mut best: Vec<Option<ValidatedSubset>> = vec![None; p];
        for active in subsets(p, &conditions.requirements).skip(1) {
            let Some(subset) = validate(active, &splits, target, conditions) else {
                continue;
            };
            let slot = &mut best[subset.active.len() - 1];
            if slot.as_ref().is_none_or(|b| subset.mean_error < b.mean_error) {
                *slot = Some(subset);
            }
        }
        Self::choose(best.into_iter().flatten().collect(), folds[0].names())
    }

    fn choose(best: Vec<ValidatedSubset>, names: &[String]) -> Result<Self> {
        let errors: Vec<[f64; 2]> = best.iter().map(|b| [b.mean_error, b.standard_error]).collect();
        let Some([minimum, chosen]) = simplest(&errors) else {
            return Err(IdentificationError::Collinear {
                terms: names.to_vec(),
                condition: f64::INFINITY,
                limit: 1e7,
            });
        };
        Ok(Self { best, minimum, chosen })
    }

    /// Creates the table of given sets; `None` if the chosen set has no solution on the folds.
    ///
    /// - `sets`: sets of terms, from few terms to many
    pub(crate) fn along(
        sets: Vec<Vec<usize>>,
        folds: &[Moments],
        target: usize,
        conditions: &Conditions,
        chosen: &[usize],
    ) -> Option<Self> {
        let splits = splits(folds).collect::<Result<Vec<_>>>().ok()?;
        let best: Vec<ValidatedSubset> =
            sets.into_iter().filter_map(|set| validate(set, &splits, target, conditions)).collect();
        let chosen = best.iter().position(|subset| subset.active == chosen)?;
        let least = |a: &usize, b: &usize| best[*a].mean_error.total_cmp(&best[*b].mean_error);
        let minimum = (0..best.len()).min_by(least)?;
        Some(Self { best, minimum, chosen })
    }
}

/// Returns the probability of each term. It is the total weight of the subsets that contain the term, divided by the total
/// weight of all subsets including the empty one.
///
/// The weight of a subset with k terms is `exp(−BIC/2)` with `BIC = n ln(RSS/n) + k ln n` (Schwarz 1978; Raftery 1995).
///
/// - `n`: effective number of samples: the number of samples with independent errors that would give the same information
///
/// # Errors
/// - `Setting`: there are more than [`MOST_TERMS`] terms, or `n` is smaller than two
/// - `Shape`: there is no such target
pub(crate) fn probabilities(
    moments: &Moments,
    target: usize,
    n: f64,
    requirements: &[Requirement],
) -> Result<Vec<f64>> {
    let p = moments.terms();
    let requirement = "probabilities are computed from all subsets, for one to twelve terms";
    require_setting("number of terms", p as f64, (1..=MOST_TERMS).contains(&p), requirement)?;
    require_setting("effective samples", n, n >= 2.0, "at least two are needed")?;
    moments.require_target(target)?;
    // An exact fit has a residual of zero. Its residual is replaced by the rounding error of the energy.
    let floor = 1e-14 * moments.energy(target).max(f64::MIN_POSITIVE);
    let models = subsets(p, requirements).filter_map(|active| {
        let residual = moments.residual(target, &fit(moments, target, &active)?).max(floor);
        Some((n * (residual / n).ln() + active.len() as f64 * n.ln(), active))
    });
    let models: Vec<(f64, Vec<usize>)> = models.collect();
    let least = models.iter().fold(f64::INFINITY, |a, (bic, _)| a.min(*bic));
    let (mut total, mut inclusion) = (0.0, vec![0.0; p]);
    for (bic, active) in &models {
        let weight = (-0.5 * (bic - least)).exp();
        total += weight;
        active.iter().for_each(|&i| inclusion[i] += weight);
    }
    // Rounding may give a sum slightly above one.
    Ok(inclusion.into_iter().map(|weight| (weight / total).min(1.0)).collect())
}

/// Computes the errors of a subset on held-out folds; `None` if the normal equations of a fold are singular.
fn validate(
    active: Vec<usize>,
    splits: &[(Moments, &Moments)],
    target: usize,
    conditions: &Conditions,
) -> Option<ValidatedSubset> {
    let error = |(training, fold): &(Moments, &Moments)| {
        let coefficients = conditions.fit(training, target, &active)?;
        Some(fold.residual(target, &coefficients) / fold.samples() as f64)
    };
    let errors: Vec<f64> = splits.iter().map(error).collect::<Option<_>>()?;
    let [mean_error, standard_error] = mean_with_error(&errors);
    Some(ValidatedSubset { active, mean_error, standard_error })
}

fn fit(moments: &Moments, target: usize, active: &[usize]) -> Option<DVector<f64>> {
    let small = solve_scaled(&moments.gram(), &moments.projection(target), active, 0.0)?;
    let mut coefficients = DVector::zeros(moments.terms());
    for (&i, x) in active.iter().zip(small.iter()) {
        coefficients[i] = *x;
    }
    coefficients.iter().all(|x| x.is_finite()).then_some(coefficients)
}

/// Returns the subset of `size` terms with the smallest residual.
///
/// # Errors
/// [`IdentificationError::Collinear`] if no subset of this size can be solved.
pub(crate) fn best_of_size(
    moments: &Moments,
    target: usize,
    size: usize,
    conditions: &Conditions,
) -> Result<DVector<f64>> {
    let mut best: Option<(f64, DVector<f64>)> = None;
    for active in subsets(moments.terms(), &conditions.requirements).filter(|a| a.len() == size && size > 0) {
        // Conditions can only increase the residual.
        let free = fit(moments, target, &active);
        let bound = best.as_ref().map_or(f64::INFINITY, |(residual, _)| *residual);
        let Some(free) = free.filter(|free| moments.residual(target, free) < bound) else { continue };
        let Some(coefficients) = conditions.met(moments, free, &active) else { continue };
        let residual = moments.residual(target, &coefficients);
        if best.as_ref().is_none_or(|b| residual < b.0) {
            best = Some((residual, coefficients));
        }
    }
    best.map(|b| b.1).ok_or_else(|| moments.collinear(&(0..moments.terms()).collect::<Vec<_>>()))
}

#[cfg(test)]
mod tests {
    use super::super::library::Library;
    use super::super::moments::Samples;
    use super::*;
    use crate::numeric::random::SplitMix64;

    fn folds(library: &Library, noise: f64) -> Vec<Moments> {
        let mut random = SplitMix64::new(4);
        let v: Vec<f64> = (0..5000)
            .map(|i| 0.8 * (0.01 * f64::from(i)).sin() + 0.3 * (0.037 * f64::from(i)).sin())
            .collect();
        let y: Vec<f64> =
            v.iter().map(|v| 4.0 * v + 0.7 * (10.0 * v).tanh() + noise * random.normal()).collect();
        let samples = Samples::from_library(library, vec![&v], vec![&y]).unwrap();
        Moments::blocks(&samples, 10).unwrap()
    }

    #[test]
    fn the_one_standard_error_rule_finds_the_terms_that_made_the_data() {
        let folds = folds(&Library::friction().unwrap(), 0.3);
        let found = SubsetValidation::new(&folds, 0, &Conditions::default()).unwrap();
        assert_eq!(found.best.len(), 7);
        assert_eq!(found.best[found.chosen].active, [1, 4]);
        assert!(found.chosen <= found.minimum);
        let all = Moments::sum(&folds).unwrap();
        let two = best_of_size(&all, 0, 2, &Conditions::default()).unwrap();
        assert!((two[1] - 4.0).abs() < 0.05 && (two[4] - 0.7).abs() < 0.05, "{two}");
    }

    #[test]
    fn errors_agree_with_the_residual_of_a_single_fit() {
        let library = Library::new(&["v", "sign(v)"], &["v"]).unwrap();
        let folds = folds(&library, 0.0);
        let found = SubsetValidation::new(&folds, 0, &Conditions::default()).unwrap();
        let mut sum = 0.0;
        for k in 0..10 {
            let rest = Moments::sum(folds.iter().enumerate().filter(|f| f.0 != k).map(|f| f.1));
            let rest = rest.unwrap();
            let slope = rest.projection(0)[0] / rest.gram()[(0, 0)];
            let w = DVector::from_column_slice(&[slope, 0.0]);
            sum += folds[k].residual(0, &w) / folds[k].samples() as f64;
        }
        assert!((found.best[0].mean_error / (sum / 10.0) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn the_terms_that_made_the_data_are_probable_and_others_are_not() {
        let library = Library::friction().unwrap();
        let all = Moments::sum(&folds(&library, 0.3)).unwrap();
        let probable = probabilities(&all, 0, 5000.0, &[]).unwrap();
        for (i, probability) in probable.iter().enumerate() {
            assert_eq!(*probability > 0.5, [1, 4].contains(&i), "{probable:?}");
        }
        // With few samples the terms that resemble each other share the probability.
        let vague = probabilities(&all, 0, 20.0, &[]).unwrap();
        assert!(vague[4] < 0.7 && vague[1] > 0.9, "{vague:?}");
    }

    /// Two orthogonal columns of 8 samples: the four BICs follow by hand.
    #[test]
    fn weights_are_those_of_the_bic() {
        let (one, alternating) = (vec![1.0; 8], [1.0, -1.0].repeat(4));
        let y: Vec<f64> = (0..8).map(|i| [1.2, 0.4, 1.1, -0.1][i % 4]).collect();
        let names = ["a", "b"].map(String::from);
        let samples = Samples::from_columns(&names, vec![&one, &alternating], vec![&y]).unwrap();
        let probable = probabilities(&Moments::new(&samples).unwrap(), 0, 8.0, &[]).unwrap();
        let energy: f64 = y.iter().map(|y| y * y).sum();
        let gains =
            [&one, &alternating].map(|x| x.iter().zip(&y).map(|(x, y)| x * y).sum::<f64>().powi(2) / 8.0);
        let weight = |active: [bool; 2]| {
            let gain = |k: usize| if active[k] { gains[k] } else { 0.0 };
            let k = active.iter().filter(|a| **a).count() as i32;
            (energy - gain(0) - gain(1)).powi(-4) * 8_f64.powf(-0.5 * f64::from(k))
        };
        let [none, a, b, both] = [[false, false], [true, false], [false, true], [true, true]].map(weight);
        let expected = [(a + both) / (none + a + b + both), (b + both) / (none + a + b + both)];
        for (found, expected) in probable.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }

    #[test]
    fn an_asymmetry_stands_beside_what_it_changes() {
        let library = Library::joint_friction().unwrap();
        let found = requirements(library.terms());
        assert_eq!(found, [Requirement { term: 7, needs: 1 }, Requirement { term: 8, needs: 5 }]);
        assert_eq!(subsets(9, &found).count(), 128 * 9 / 4);
        // For a motion in one direction, |v| fits as well as v, but |v| without v is not allowed.
        let v: Vec<f64> = (0..2000).map(|i| -0.6 + 0.5 * (0.01 * f64::from(i)).sin()).collect();
        let y: Vec<f64> = v.iter().map(|v| 4.0 * v).collect();
        let library = Library::new(&["abs(v)", "v"], &["v"]).unwrap();
        let samples = Samples::from_library(&library, vec![&v], vec![&y]).unwrap();
        let folds = Moments::blocks(&samples, 5).unwrap();
        let needs = Conditions { requirements: requirements(library.terms()), ..Conditions::default() };
        let found = SubsetValidation::new(&folds, 0, &needs).unwrap();
        assert_eq!(found.best[0].active, [1]);
    }

    #[test]
    fn what_cannot_be_tried_has_a_message() {
        let terms: Vec<String> = (1..=13).map(|i| format!("sin({i}*v)")).collect();
        let library = Library::new(&terms, &["v"]).unwrap();
        let message =
            SubsetValidation::new(&folds(&library, 0.1), 0, &Conditions::default()).unwrap_err().to_string();
        assert!(message.starts_with("number of terms = 13 is not possible"), "{message}");
        let one = &folds(&Library::friction().unwrap(), 0.1)[..1];
        let message = SubsetValidation::new(one, 0, &Conditions::default()).unwrap_err().to_string();
        assert!(message.starts_with("number of folds = 1 is not possible"), "{message}");
        let zero = Library::new(&["0*v"], &["v"]).unwrap();
        let message =
            SubsetValidation::new(&folds(&zero, 0.1), 0, &Conditions::default()).unwrap_err().to_string();
        assert!(message.contains("cannot distinguish the friction terms 0*v."), "{message}");
    }
}
