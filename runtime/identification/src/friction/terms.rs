//! Laws that are sums of terms: choice of terms, least squares, passivity, standard errors.

use super::super::error::Result;
use super::super::methods::least_squares::{Reduced, Solution};
use super::super::methods::library::Library;
use super::super::methods::moments::Moments;
use super::super::methods::subset::{self, Conditions, MOST_TERMS, requirements};
use super::super::numeric::statistics::extremes;
use super::super::result::{FrictionLaw, FrictionTerm};
use super::design::{Design, folds};
use super::errors::Errors;
use super::findings::Findings;
use super::held_out::{held_out, variation};
use super::judgement::LawFit;
use super::passivity::{doubt, passive, restrict};
use super::report::FrictionReport;
use super::selection::{Chosen, Selection, choose};
use super::task::{FrictionData, FrictionIdentification};
use nalgebra::DMatrix;

/// Identifies a law that is a sum of terms.
pub(super) fn identify(settings: &FrictionIdentification, data: &FrictionData) -> Result<FrictionReport> {
    let design = Design::new(settings, data)?;
    let samples = design.samples()?;
    let reduced = Reduced::new(&samples)?;
    let mut findings = Findings::new(data);
    describe_library(&design, &reduced, &mut findings);
    let candidates = Candidates {
        library: &design.library,
        reduced: &reduced,
        folds: &|| design.folds(&samples, settings.folds),
        velocity_range: extremes(data.velocities.iter().copied()),
    };
    let fitted = candidates.fitted(settings, &mut findings)?;
    let residuals = design.residuals(&fitted.solution.coefficients);
    let active = &fitted.solution.active;
    let binding = fitted.binding.select_columns(active);
    let errors = Errors::of_samples(data, &design.samples_of(active)?, &binding, &residuals)?;
    let probable = probabilities(&reduced, &errors)?;
    let law = fitted.law(&design.library, &errors, probable.as_ref());
    let total = variation(data, &folds(data, settings.folds).concat());
    let unseen = held_out((candidates.folds)(), total, fitted.way(), &mut findings);
    let report = findings.report(settings, LawFit::of_samples(data, law, unseen, residuals, errors))?;
    Ok(fitted.complete(report, &candidates, probable))
}

fn describe_library(design: &Design, reduced: &Reduced, findings: &mut Findings) {
    findings.note_library(&design.library, "", reduced.condition());
    findings.notes.extend_from_slice(&design.notes);
    if reduced.is_orthogonal() {
        findings.note("solved by orthogonal factorization");
    }
}

/// Terms from which a law is chosen, with their data.
pub(super) struct Candidates<'a> {
    pub(super) library: &'a Library,
    pub(super) reduced: &'a Reduced,
    pub(super) folds: &'a dyn Fn() -> Result<Vec<Moments>>,
    pub(super) velocity_range: [f64; 2],
}

/// Terms that were chosen, fitted under the constraints.
pub(super) struct Fitted {
    chosen: Chosen,
    /// Matrix A of the constraints `A ξ ≥ 0` on the coefficients ξ; `None` if the law need not be passive.
    rows: Option<DMatrix<f64>>,
    pub(super) solution: Solution,
    /// Rows of the constraint matrix at which the solution lies on the boundary.
    pub(super) binding: DMatrix<f64>,
}

impl Candidates<'_> {
    pub(super) fn fitted(
        &self,
        settings: &FrictionIdentification,
        findings: &mut Findings,
    ) -> Result<Fitted> {
        let rows = settings.passive.then(|| passive(self.library, self.velocity_range)).transpose()?;
        let conditions = Conditions {
            requirements: requirements(self.library.terms()),
            rows: rows.clone(),
            values: Some(self.values()?),
        };
        let chosen = choose(&settings.method, self.reduced, self.folds, conditions)?;
        findings.note(&chosen.note);
        let samples = self.reduced.moments().samples();
        let free = chosen.solution.clone();
        let (solution, binding) = restrict(self.reduced, free, rows.as_ref(), samples, findings)?;
        doubt(self.reduced, &solution.active, findings);
        Ok(Fitted { chosen, rows, solution, binding })
    }

    /// Values of the terms at velocities of both directions, from a hundredth of the largest speed in the data up to this
    /// speed; zeros for a constant term.
    fn values(&self) -> Result<DMatrix<f64>> {
        let share = |i: i32| 0.01_f64.powf(f64::from(i) / 20.0);
        let speeds = self.velocity_range.into_iter().flat_map(|end| (0..=20).map(move |i| end * share(i)));
        let mut values = self.library.matrix(&[&speeds.collect::<Vec<_>>()])?;
        for mut term in values.column_iter_mut() {
            if term.iter().all(|value| *value == term[0]) {
                term.fill(0.0);
            }
        }
        Ok(values)
    }
}

/// Probabilities of the terms; `None` if there are too many terms.
pub(super) fn probabilities(reduced: &Reduced, errors: &Errors) -> Result<Option<Vec<f64>>> {
    if reduced.moments().terms() > MOST_TERMS {
        return Ok(None);
    }
    let requirements = requirements(reduced.moments().names());
    subset::probabilities(reduced.moments(), 0, errors.effective_samples, &requirements).map(Some)
}

impl Fitted {
    /// Rule that chose the terms, and constraints of the fit, from which a law can be identified on other
    /// moments.
    pub(super) fn way(&self) -> (&Selection, Option<&DMatrix<f64>>) {
        (&self.chosen.selection, self.rows.as_ref())
    }

    pub(super) fn law(&self, library: &Library, errors: &Errors, probable: Option<&Vec<f64>>) -> FrictionLaw {
        let term = |(k, &i): (usize, &usize)| FrictionTerm {
            probability: probable.map(|shares| shares[i]),
            ..errors.term(k, &library.terms()[i], self.solution.coefficients[i])
        };
        FrictionLaw::Terms(self.solution.active.iter().enumerate().map(term).collect())
    }

    /// Adds the candidate terms to the report on a law.
    pub(super) fn complete(
        self,
        report: FrictionReport,
        of: &Candidates,
        probabilities: Option<Vec<f64>>,
    ) -> FrictionReport {
        FrictionReport {
            terms: of.library.terms().to_vec(),
            validation: self.chosen.validation,
            subsets: self.chosen.subsets,
            probabilities,
            ..report
        }
    }
}
