//! Laws that are sums of terms: choice, least squares, passivity, standard errors.

use super::super::cross_validation::pareto_front;
use super::super::ensemble::{Ensemble, bootstrap};
use super::super::error::Result;
use super::super::least_squares::{Reduced, Solution, Solver};
use super::super::moments::{Moments, Samples};
use super::super::result::{FrictionLaw, FrictionTerm};
use super::super::subset::{MOST_TERMS, ModelAverage, requirements};
use super::design::Design;
use super::errors::Errors;
use super::findings::Findings;
use super::held_out::held_out;
use super::judgement::{Judged, velocity_range};
use super::passivity::{doubt, passive, restrict};
use super::report::FrictionReport;
use super::selection::{Selection, choose};
use super::task::{FrictionData, FrictionIdentification};
use nalgebra::DVector;

/// The law of terms.
pub(super) fn identify(settings: &FrictionIdentification, data: &FrictionData) -> Result<FrictionReport> {
    let design = Design::new(settings, data)?;
    let samples = design.samples()?;
    let reduced = Reduced::new(&samples)?;
    let mut findings = Findings::new(data);
    describe_library(&design, &reduced, &mut findings);
    let folds = || design.folds(&samples, settings.folds);
    let chosen = choose(&settings.method, &reduced, folds)?;
    findings.note(chosen.note.clone());
    let front = match &chosen.validation {
        Some(validation) => pareto_front(&reduced, 0, validation)?,
        None => Vec::new(),
    };
    let ensemble = draw(settings, &samples, &chosen.selection, &mut findings)?;
    let rows =
        settings.passive.then(|| passive(&design.library, velocity_range(data.velocities))).transpose()?;
    let free = chosen.solution.clone();
    let (solution, binding) = restrict(&reduced, free, rows.as_ref(), samples.len(), &mut findings)?;
    doubt(&reduced, &solution.active, &mut findings);
    let residuals = design.residuals(&solution.coefficients);
    let errors = Errors::new(&design, &solution.active, &binding, &residuals)?;
    let average = average(&reduced, &errors)?;
    let law = law(&design, &solution, &errors, average.as_ref(), ensemble.as_ref());
    let torques = law.torques(data.velocities)?;
    let offsets = design.offsets(&torques, &residuals);
    let unseen = held_out(&design, &samples, settings, &chosen.selection, rows.as_ref(), &mut findings);
    let judged = Judged { law, offsets, unseen, residuals, freedom: errors.freedom, stribeck: None };
    let mut report = findings.report(settings, judged)?;
    report.terms = design.library.terms().to_vec();
    report.correlation = reduced.moments().correlation();
    report.condition = reduced.condition();
    report.covariance = errors.covariance;
    report.validation = chosen.validation;
    report.front = front;
    report.subsets = chosen.subsets;
    report.ensemble = ensemble;
    report.average = average;
    Ok(report)
}

fn describe_library(design: &Design, reduced: &Reduced, findings: &mut Findings) {
    let offsets = if design.separate { " beside the offset of each run" } else { "" };
    let terms = design.library.terms().join(", ");
    let condition = reduced.condition();
    findings.note(format!("library [{terms}]{offsets}, condition number {condition:.1}"));
    design.notes.iter().for_each(|note| findings.note(note.clone()));
    design.hidden.iter().for_each(|doubt| findings.warn(doubt.clone()));
    if reduced.solver() == Solver::Orthogonal {
        findings.note("solved by orthogonal factorization".into());
    }
}

/// How often bootstrap draws choose each term.
fn draw(
    settings: &FrictionIdentification,
    samples: &Samples,
    selection: &Selection,
    findings: &mut Findings,
) -> Result<Option<Ensemble>> {
    let (draws, count) = (settings.draws, settings.blocks);
    if draws == 0 {
        return Ok(None);
    }
    let blocks = Moments::blocks(samples, count.min(samples.len()))?;
    let fit = |moments: Moments| -> Result<DVector<f64>> {
        Ok(selection.fit(&Reduced::from_moments(moments)?)?.coefficients)
    };
    match bootstrap(&blocks, draws, settings.seed, fit) {
        Ok(ensemble) => {
            let (count, seed) = (blocks.len(), settings.seed);
            findings.note(format!("inclusion: {draws} draws of {count} contiguous blocks, seed {seed}"));
            if let Some(reason) = &ensemble.first_failure {
                let failed = ensemble.failed;
                findings.warn(format!("{failed} of {draws} bootstrap draws gave no model: {reason}"));
            }
            Ok(Some(ensemble))
        }
        Err(reason) => {
            findings.warn(format!("no bootstrap draw gave a model: {reason}"));
            Ok(None)
        }
    }
}

fn average(reduced: &Reduced, errors: &Errors) -> Result<Option<ModelAverage>> {
    if reduced.moments().terms() > MOST_TERMS {
        return Ok(None);
    }
    let requirements = requirements(reduced.moments().names());
    ModelAverage::new(reduced.moments(), 0, errors.effective_samples, &requirements).map(Some)
}

fn law(
    design: &Design,
    solution: &Solution,
    errors: &Errors,
    average: Option<&ModelAverage>,
    ensemble: Option<&Ensemble>,
) -> FrictionLaw {
    let term = |(k, &i): (usize, &usize)| FrictionTerm {
        inclusion: ensemble.map(|e| e.inclusion[i]),
        probability: average.map(|a| a.inclusion[i]),
        ..errors.term(k, &design.library.terms()[i], solution.coefficients[i])
    };
    FrictionLaw::Terms(solution.active.iter().enumerate().map(term).collect())
}
