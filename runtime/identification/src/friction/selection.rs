//! The choice of terms from moments (sums of products). It can be repeated on the moments of folds.

use super::super::error::Result;
use super::super::methods::cross_validation::{CrossValidation, refit};
use super::super::methods::lasso::{Lasso, active_terms, paper_lambda};
use super::super::methods::least_squares::{Reduced, Solution};
use super::super::methods::moments::Moments;
use super::super::methods::stribeck::StribeckRegression;
use super::super::methods::subset::{Conditions, SubsetValidation, best_of_size, requirements};
use super::super::methods::thresholding::Thresholding;
use gelenk_findings::digits::plain;

/// Method by which a friction law is identified.
#[derive(Debug, Clone, PartialEq)]
pub enum FrictionMethod {
    /// Least squares on all candidate terms.
    LeastSquares,
    /// Sequentially thresholded least squares (STLS, as in SINDy).
    Thresholding(Thresholding),
    /// LASSO with 100 weights λ of the penalty. Cross-validation on contiguous blocks chooses one weight, and
    /// least squares is applied to the chosen terms.
    Lasso(Lasso),
    /// The subset with the fewest terms whose error on held-out blocks exceeds the least error by at most one standard error.
    /// The library must have at most twelve terms.
    BestSubset,
    /// Nonlinear regression of the Stribeck law. The library is not used.
    Stribeck(StribeckRegression),
    /// The law by [`FrictionMethod::BestSubset`], or the Stribeck law if the error of the Stribeck law on held-out data is
    /// smaller by more than one standard error.
    Ladder(StribeckRegression),
}

/// A rule that chooses terms from moments.
pub(super) enum Selection {
    All,
    Thresholding(Thresholding),
    Lasso(Lasso, f64),
    BestOfSize(usize, Conditions),
}

/// A choice of terms with its fit on all samples and a note on the choice.
pub(super) struct Chosen {
    pub(super) selection: Selection,
    pub(super) solution: Solution,
    pub(super) validation: Option<CrossValidation>,
    pub(super) subsets: Option<SubsetValidation>,
    /// Note on the method.
    pub(super) note: String,
}

impl Chosen {
    /// The choice by a rule that needs no folds.
    fn directly(selection: Selection, reduced: &Reduced, note: String) -> Result<Self> {
        let solution = selection.fit(reduced)?;
        Ok(Self { selection, solution, validation: None, subsets: None, note })
    }
}

impl Selection {
    pub(super) fn fit(&self, reduced: &Reduced) -> Result<Solution> {
        match self {
            Self::All => {
                let all: Vec<usize> = (0..reduced.moments().terms()).collect();
                reduced.fit(0, &all)
            }
            Self::Thresholding(settings) => completed(settings.fit(reduced, 0)?, reduced),
            Self::Lasso(lasso, lambda) => {
                let (_, active) = lasso.fit(reduced.moments(), 0, *lambda)?;
                completed(reduced.fit(0, &active)?, reduced)
            }
            Self::BestOfSize(size, conditions) => {
                let best = best_of_size(reduced.moments(), 0, *size, conditions)?;
                reduced.fit(0, &active_terms(&best))
            }
        }
    }
}

/// The solution, refitted with further terms that its terms require: an asymmetry `|f(v)|` requires `f(v)`.
fn completed(solution: Solution, reduced: &Reduced) -> Result<Solution> {
    let active = with_needed(solution.active.clone(), reduced);
    if active == solution.active { Ok(solution) } else { reduced.fit(0, &active) }
}

/// A set of terms, extended by the terms that they require: an asymmetry `|f(v)|` requires `f(v)`
/// ([`requirements`]).
fn with_needed(mut active: Vec<usize>, reduced: &Reduced) -> Vec<usize> {
    for requirement in requirements(reduced.moments().names()) {
        if active.contains(&requirement.term) && !active.contains(&requirement.needs) {
            active.push(requirement.needs);
        }
    }
    active.sort_unstable();
    active
}

/// Chooses terms by a method.
///
/// - `folds`: computes the moments of the folds, if the method needs them
/// - `conditions`: conditions that subsets have to meet
pub(super) fn choose(
    method: &FrictionMethod,
    reduced: &Reduced,
    folds: impl Fn() -> Result<Vec<Moments>>,
    conditions: Conditions,
) -> Result<Chosen> {
    match method {
        FrictionMethod::Thresholding(settings) => {
            let Thresholding { threshold, ridge, .. } = settings;
            let note = format!(
                "sequentially thresholded least squares (threshold {threshold}, ridge {ridge}) chose the terms"
            );
            let chosen = Chosen::directly(Selection::Thresholding(*settings), reduced, note)?;
            let sets = by_threshold(settings, reduced);
            let subsets = folds().ok().and_then(|folds| along(sets, &folds, &conditions, &chosen.solution));
            Ok(Chosen { subsets, ..chosen })
        }
        FrictionMethod::Lasso(lasso) => by_lasso(reduced, lasso, &folds()?, &conditions),
        FrictionMethod::BestSubset | FrictionMethod::Ladder(_) => by_subsets(reduced, &folds()?, conditions),
        FrictionMethod::LeastSquares | FrictionMethod::Stribeck(_) => {
            Chosen::directly(Selection::All, reduced, "least squares fitted all terms".to_owned())
        }
    }
}

fn by_subsets(reduced: &Reduced, folds: &[Moments], conditions: Conditions) -> Result<Chosen> {
    let subsets = SubsetValidation::new(folds, 0, &conditions)?;
    let best = &subsets.best[subsets.chosen];
    Ok(Chosen {
        selection: Selection::BestOfSize(best.active.len(), conditions),
        solution: reduced.fit(0, &best.active)?,
        validation: None,
        note: format!(
            "the best subset of terms was chosen by {}-fold cross-validation and the one-standard-error rule",
            folds.len()
        ),
        subsets: Some(subsets),
    })
}

/// The sets of terms for increasing thresholds. Each threshold is just above the smallest coefficient of the previous set.
/// The number of sets is at most the number of terms.
fn by_threshold(settings: &Thresholding, reduced: &Reduced) -> Vec<Vec<usize>> {
    let mut threshold = 0.0_f64;
    let mut next = |_| {
        let solution = Thresholding { threshold, ..*settings }.fit(reduced, 0).ok()?;
        let sizes = solution.active.iter().map(|&i| solution.coefficients[i].abs());
        threshold = sizes.fold(f64::INFINITY, f64::min).next_up();
        Some(with_needed(solution.active, reduced))
    };
    (0..reduced.moments().terms()).map_while(&mut next).collect()
}

/// The Pareto table of sets of terms; `None` if it cannot be computed.
fn along(
    mut sets: Vec<Vec<usize>>,
    folds: &[Moments],
    conditions: &Conditions,
    chosen: &Solution,
) -> Option<SubsetValidation> {
    sets.push(chosen.active.clone());
    sets.sort_by_key(|set| (set.len(), set.clone()));
    sets.dedup();
    SubsetValidation::along(sets, folds, 0, conditions, &chosen.active)
}

fn by_lasso(reduced: &Reduced, lasso: &Lasso, folds: &[Moments], conditions: &Conditions) -> Result<Chosen> {
    let grid = lasso.lambda_grid(reduced.moments(), 0, 100, 1e-4)?;
    let validation = CrossValidation::new(lasso, folds, 0, &grid)?;
    let index = validation.one_standard_error;
    let lambda = grid[index];
    let [own, paper] = [lambda, paper_lambda(lambda, reduced.moments().samples())].map(|x| plain(x, 5));
    let note = format!(
        "LASSO chose the terms by cross-validation with {} contiguous parts, λ by one standard error: λ = {own} in 1/(2N)‖·‖² + \
         λ‖·‖₁{}, {paper} in ‖·‖² + λ‖·‖₁. Values and errors are those of least squares on the chosen terms",
        folds.len(),
        if lasso.standardize { " (terms in units of their rms)" } else { "" }
    );
    let solution = completed(refit(reduced, 0, &validation.path, index)?, reduced)?;
    let selection = Selection::Lasso(lasso.clone(), lambda);
    let sets = validation.path.coefficients.column_iter().map(|column| active_terms(&column.into_owned()));
    let sets = sets.map(|active| with_needed(active, reduced)).filter(|set| !set.is_empty()).collect();
    let subsets = along(sets, folds, conditions, &solution);
    Ok(Chosen { selection, solution, validation: Some(validation), subsets, note })
}
