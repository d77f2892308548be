//! Claim 7: useful fineness of the library of friction terms, and necessary number of terms.

use super::angle::{alpha_samples, arm_samples};
use super::data::{Samples, beta_alone, opposed};
use super::law::{Method, curve_error, standardized};
use crate::arm::Friction;
use crate::study::{Outcome, Part, Study};
use gelenk_identification::friction::FrictionReport;
use gelenk_identification::methods::cross_validation::CrossValidation;
use gelenk_identification::methods::least_squares::Reduced;
use gelenk_identification::methods::library::Library;
use gelenk_identification::methods::moments::{Moments, Samples as Columns};
use gelenk_identification::methods::thresholding::Thresholding;
use gelenk_report::{Axis, Block, Cell, Claim, Criterion, Figure, Marks, Plot, Section, Table, text};

/// Number of folds of the cross-validation.
const FOLDS: usize = 10;
/// Additional terms of the finer library.
const FINER: [&str; 5] = ["tanh(7*v)", "tanh(14*v)", "tanh(30*v)", "tanh(50*v)", "tanh(70*v)"];

/// The library of the paper with five more slopes.
pub fn finer_library() -> Outcome<Library> {
    let paper = Friction::library()?;
    let terms: Vec<&str> = (paper.terms().iter().map(String::as_str)).chain(FINER).collect();
    Ok(Library::new(&terms, &["v"])?)
}

/// Measures of the cost and benefit of a library for given samples.
pub struct Fineness {
    /// Condition number of the scaled columns.
    pub condition: f64,
    /// Largest cosine between two columns.
    pub correlation: f64,
    /// Rms error of a fit with all terms on the omitted fold, for ten contiguous folds [N m].
    pub unseen: f64,
}

/// Measures of least squares on all terms, with cross-validation on contiguous folds.
pub fn fineness(library: &Library, samples: &Samples) -> Outcome<Fineness> {
    let columns = columns(library, samples)?;
    let folds = Moments::blocks(&columns, FOLDS)?;
    let all: Vec<usize> = (0..library.terms().len()).collect();
    let (mut squares, mut count) = (0.0, 0);
    for (k, left_out) in folds.iter().enumerate() {
        let others = folds.iter().enumerate().filter(|(i, _)| *i != k);
        let training = Reduced::from_moments(Moments::sum(others.map(|(_, fold)| fold))?)?;
        let fit = training.fit(0, &all)?;
        squares += left_out.residual(0, &fit.coefficients);
        count += left_out.samples();
    }
    let reduced = Reduced::new(&columns)?;
    let correlation = reduced.moments().correlation();
    let n = correlation.nrows();
    let pairs = (0..n).flat_map(|i| (0..i).map(move |j| (i, j)));
    Ok(Fineness {
        condition: reduced.condition(),
        correlation: pairs.fold(0.0, |most, (i, j)| most.max(correlation[(i, j)].abs())),
        unseen: (squares / count as f64).sqrt(),
    })
}

fn columns<'s>(library: &'s Library, samples: &'s Samples) -> Outcome<Columns<'s>> {
    Ok(Columns::from_library(library, vec![&samples.velocities], vec![&samples.torques])?)
}

/// Number of terms and rms residual [N m] of the models of a method. The list has the best model for each number of terms, in
/// increasing order.
pub type Front = Vec<(usize, f64)>;

/// Pareto fronts of STLS (over the threshold) and of LASSO (over λ), both after least squares on the chosen terms.
fn fronts(samples: &Samples) -> Outcome<[Front; 2]> {
    let library = Friction::library()?;
    let columns = columns(&library, samples)?;
    let reduced = Reduced::new(&columns)?;
    let mut by_threshold = Vec::new();
    for i in 0..100 {
        let settings =
            Thresholding { threshold: 1e-3 * 1e5_f64.powf(f64::from(i) / 99.0), ..Thresholding::default() };
        // If the threshold exceeds the largest coefficient, no term remains.
        let Ok(fit) = settings.fit(&reduced, 0) else {
            break;
        };
        by_threshold.push((fit.active.len(), fit.residual));
    }
    let folds = Moments::blocks(&columns, FOLDS)?;
    let lasso = standardized();
    let grid = lasso.lambda_grid(reduced.moments(), 0, 100, 1e-4)?;
    let validation = CrossValidation::new(&lasso, &folds, 0, &grid)?;
    let mut by_lambda = Vec::new();
    for coefficients in validation.path.coefficients.column_iter() {
        let active: Vec<usize> = (0..coefficients.len()).filter(|term| coefficients[*term] != 0.0).collect();
        if !active.is_empty() {
            by_lambda.push((active.len(), reduced.fit(0, &active)?.residual));
        }
    }
    let front = |models: Vec<(usize, f64)>| -> Front {
        (1..=library.terms().len())
            .filter_map(|size| {
                let squares = models.iter().filter(|(n, _)| *n == size).map(|(_, r)| *r);
                let least = squares.fold(f64::INFINITY, f64::min);
                let rms = (least / samples.len() as f64).sqrt();
                rms.is_finite().then_some((size, rms))
            })
            .collect()
    };
    Ok([front(by_threshold), front(by_lambda)])
}

/// Fronts of joints A, B and C.
pub fn joint_fronts([a, b, c]: &[Samples; 3]) -> Outcome<[[Front; 2]; 3]> {
    Ok([fronts(a)?, fronts(b)?, fronts(c)?])
}

/// Smallest number of terms with an error within 1 % of the smallest error of the front.
fn knee(front: &Front) -> f64 {
    let least = front.iter().fold(f64::INFINITY, |least, (_, e)| least.min(*e));
    let enough = front.iter().find(|(_, error)| *error <= 1.01 * least);
    enough.map_or(f64::NAN, |(size, _)| *size as f64)
}

/// Claim 7a for the samples of one joint.
pub fn fineness_claim(paper: &Fineness, finer: &Fineness) -> Claim {
    Claim::new(
        "claim-7a",
        "The library [1, v, sgn v, tanh 5v, 10v, 20v, 100v] needs no finer slopes: they are nearly collinear and tell nothing new.",
    )
    .criterion(Criterion::at_least(
        "condition number of the finer library over that of the paper's",
        finer.condition / paper.condition,
        10.0,
        "",
    ))
    .criterion(Criterion::at_most(
        "what the finer one gains on held-out data",
        1.0 - finer.unseen / paper.unseen,
        0.01,
        "",
    ))
    .flipped_by("a plant with Stribeck friction whose step is tanh 40v, measured without noise")
    .remark(format!(
        "Condition numbers {:.0} and {:.0}; the largest correlation of two terms is {:.4} and {:.6}.",
        paper.condition, finer.condition, paper.correlation, finer.correlation
    ))
    .shown_in("correlation")
}

/// Claim 7b for the fronts of the joints A, B and C.
pub fn front_claim(fronts: &[[Front; 2]; 3]) -> Claim {
    let most = |method: usize| fronts.iter().map(|joint| knee(&joint[method])).fold(0.0, f64::max);
    Claim::new(
        "claim-7b",
        "The Pareto fronts of STLS and LASSO bend early: few terms reach the error of all seven within 1 %.",
    )
    .criterion(Criterion::at_most("terms needed by STLS, worst joint", most(0), 4.0, ""))
    .criterion(Criterion::at_most("terms needed by LASSO, worst joint", most(1), 4.0, ""))
    .flipped_by("data without noise: the error then falls with every true term")
    .shown_in("pareto")
}

/// Claim 7c for the laws that LASSO chose for the joints A, B and C.
pub fn choice_claim(chosen: &[(FrictionReport, f64); 3]) -> Claim {
    let most = chosen.iter().map(|(report, _)| terms_of(report).len());
    let worst = chosen.iter().fold(0.0, |worst: f64, (_, error)| worst.max(*error));
    Claim::new(
        "claim-7c",
        "LASSO with k folds chooses its terms alone, without a threshold set by hand.",
    )
    .criterion(Criterion::at_most(
        "terms chosen, worst joint",
        most.max().unwrap_or(0) as f64,
        5.0,
        "",
    ))
    .criterion(Criterion::at_most("error of the law, worst joint, rms", worst, 0.5, "N m"))
    .flipped_by("gravity 16 % wrong and no selection by angle: the mean error of gravity passes for friction")
    .remark("λ is the largest whose error on ten left-out contiguous folds is within one standard error of the least; least squares on the chosen terms follows.")
    .shown_in("validation")
}

/// Terms of a law with their coefficients.
fn terms_of(report: &FrictionReport) -> Vec<(String, f64)> {
    report.result.law.coefficients().iter().map(|term| (term.basis.clone(), term.coefficient)).collect()
}

/// Laws that LASSO chooses for the samples of the joints A, B and C, with the error of each curve.
pub fn choices(samples: &[Samples; 3]) -> Outcome<[(FrictionReport, f64); 3]> {
    let truths = [Friction::A, Friction::B, Friction::C];
    let mut chosen = Vec::new();
    for (samples, truth) in samples.iter().zip(truths) {
        let report = Method::Lasso.identify(samples)?;
        let error = curve_error(&report.result.law, |v| truth.at(v), samples.fastest())?;
        chosen.push((report, error));
    }
    chosen.try_into().map_err(|_| "three joints".into())
}

/// Samples of A, B and C, computed with a relative error of gravity. β and γ move in opposite directions.
pub fn joints(gravity_error: f64, seconds: f64) -> Outcome<[Samples; 3]> {
    let [beta, _] = arm_samples(&beta_alone(), gravity_error, seconds)?;
    let [_, gamma] = arm_samples(&opposed(), gravity_error, seconds)?;
    Ok([alpha_samples(seconds)?, beta, gamma])
}

pub fn experiment(study: &Study) -> Outcome<Part> {
    let samples = joints(0.0, study.pick(60.0, 30.0))?;
    let [_, beta, _] = &samples;
    let paper = fineness(&Friction::library()?, beta)?;
    let finer = fineness(&finer_library()?, beta)?;
    let fronts = joint_fronts(&samples)?;
    let chosen = choices(&samples)?;
    let claims = vec![fineness_claim(&paper, &finer), front_claim(&fronts), choice_claim(&chosen)];
    let section = Section::new("library", "The library and the choice of terms")
        .block(text(
            "The record of the experiment before, the identifying model's gravity right. The finer library adds tanh 7v, 14v, 30v, 50v and 70v.",
        ))
        .block(Block::Table(correlation_table(beta)?))
        .block(Block::Table(fineness_table(&[("the paper's", &paper), ("finer", &finer)])))
        .block(Block::Figure(pareto_figure(&fronts)))
        .block(Block::Figure(validation_figure(&chosen)))
        .block(Block::Table(choice_table(&chosen)?));
    Ok(Part { section, claims })
}

fn correlation_table(samples: &Samples) -> Outcome<Table> {
    let library = Friction::library()?;
    let correlation = Reduced::new(&columns(&library, samples)?)?.moments().correlation();
    let mut table = Table::new(
        "correlation",
        "Correlation of the library's terms on the record of joint B: cosines of the angles between the columns.",
    )
    .column("", "term", "");
    for term in library.terms() {
        table = table.column(term, term.clone(), "");
    }
    for (i, term) in library.terms().iter().enumerate() {
        let cosines = (0..library.terms().len()).map(|j| Cell::Rounded(correlation[(i, j)], 4));
        table = table.row(std::iter::once(Cell::Code(term.clone())).chain(cosines));
    }
    Ok(table)
}

fn fineness_table(libraries: &[(&str, &Fineness)]) -> Table {
    let mut table =
        Table::new("fineness", "What finer slopes cost and bring, joint B, least squares on all terms.")
            .column("library", "library", "")
            .column("condition number", "condition", "")
            .column("largest correlation", "correlation", "")
            .column("error on left-out folds, rms", "unseen", "N m");
    for (name, one) in libraries {
        table = table.row([
            Cell::text(*name),
            Cell::number(one.condition),
            Cell::Rounded(one.correlation, 7),
            Cell::Rounded(one.unseen, 5),
        ]);
    }
    table
}

fn pareto_figure(fronts: &[[Front; 2]; 3]) -> Figure {
    let mut figure = Figure::new(
        "pareto",
        "Residual over number of terms after least squares on the terms that STLS chooses over its threshold, and LASSO over λ.",
    );
    for (name, [by_threshold, by_lambda]) in ["A (α)", "B (β)", "C (γ)"].iter().zip(fronts) {
        let points = |front: &Front| (front.iter()).map(|(size, error)| [*size as f64, *error]).collect();
        figure = figure.plot(
            Plot::new(
                *name,
                Axis::new("terms", "").over(0.5, 7.5),
                Axis::new("residual, rms", "N m").logarithmic(),
            )
            .series("STLS", Marks::Line, points(by_threshold))
            .series("LASSO", Marks::Dashed, points(by_lambda)),
        );
    }
    figure
}

fn validation_figure(chosen: &[(FrictionReport, f64); 3]) -> Figure {
    let mut figure = Figure::new(
        "validation",
        "Error on ten left-out contiguous folds over λ of $\\tfrac{1}{2N} \\lVert y - \\Theta\\xi \\rVert^2 + \\lambda \\lVert \\xi \\rVert_1$, \
         and the two choices.",
    );
    for (name, (report, _)) in ["A (α)", "B (β)", "C (γ)"].iter().zip(chosen) {
        let Some(validation) = &report.validation else {
            continue;
        };
        let point = |k: usize| [validation.path.lambdas[k], validation.mean_error[k].sqrt()];
        let all = (0..validation.mean_error.len()).map(point).collect();
        figure = figure.plot(
            Plot::new(
                *name,
                Axis::new("λ", "N m").logarithmic(),
                Axis::new("error on held-out data, rms", "N m").logarithmic(),
            )
            .series("left-out folds", Marks::Line, all)
            .series("least error", Marks::Points, vec![point(validation.minimum)])
            .series(
                "one standard error",
                Marks::Points,
                vec![point(validation.one_standard_error)],
            ),
        );
    }
    figure
}

fn choice_table(chosen: &[(FrictionReport, f64); 3]) -> Outcome<Table> {
    let library = Friction::library()?;
    let mut table = Table::new(
        "choices",
        "Coefficients [N m, viscous N m s] of the terms that LASSO with ten folds chose, and the plant's own.",
    )
    .column("joint", "joint", "");
    for term in library.terms() {
        table = table.column(term, term.clone(), "");
    }
    table = table.column("error of the law, rms", "error", "N m");
    let truths = [Friction::A, Friction::B, Friction::C];
    for ((name, (report, error)), truth) in ["A (α)", "B (β)", "C (γ)"].iter().zip(chosen).zip(truths) {
        let found = terms_of(report);
        let coefficients = library.terms().iter().map(|term| {
            let one = found.iter().find(|(basis, _)| basis == term);
            one.map_or(Cell::Empty, |(_, value)| Cell::number(*value))
        });
        table = table.row(
            std::iter::once(Cell::text(format!("{name}, LASSO")))
                .chain(coefficients)
                .chain([Cell::number(*error)]),
        );
        let own = truth.0.iter().map(|value| match value {
            0.0 => Cell::Empty,
            value => Cell::number(*value),
        });
        table =
            table.row(std::iter::once(Cell::text(format!("{name}, plant"))).chain(own).chain([Cell::Empty]));
    }
    Ok(table)
}
