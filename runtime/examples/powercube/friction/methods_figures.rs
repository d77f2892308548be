//! Figures and tables of the comparison of methods (claim 8).

use super::angle::GRAVITY_ERROR;
use super::cases::{Beside, Case, FASTEST, OFFSET, Recorded, SLOW, USEFUL, slower, worst};
use super::law::{Method, curve, deviation};
use crate::study::{Outcome, Study};
use gelenk_report::{Axis, Block, Cell, Figure, Marks, Plot, Section, Table, text};
use std::time::Instant;

/// Section of the report.
///
/// - `shown`: data with an error of gravity of 8 %
/// - `right`: data of A, B and C for all angles, with the right gravity
pub fn section(study: &Study, shown: &[Case], right: &[Case]) -> Outcome<Section> {
    Ok(Section::new("methods-section", "SINDy and nonlinear regression side by side")
        .block(text(
            "SINDy chooses from the library, by sequentially thresholded least squares (STLS, threshold 0.1) or by LASSO with ten folds; \
             nonlinear regression fits $\\tau = a_1 v + a_2 \\tanh a_3 v + a_4 e^{-a_5 |v|} \\tanh 3 a_3 v$. Both see the same samples: the record \
             of each joint, gravity of the identifying model 8 % wrong. Errors are those of the curve against the plant's own up to 0.5 rad/s, so \
             that no method is judged by data that are wrong themselves.",
        ))
        .block(Block::Figure(curves(shown)?))
        .block(Block::Figure(deviations(shown)?))
        .block(Block::Table(errors(shown)?))
        .block(Block::Table(times(shown)?))
        .block(Block::Figure(breaks(study)?))
        .block(Block::Figure(data_needed(study, right)))
        .block(Block::Figure(outside(right)?)))
}

fn velocity() -> Axis {
    Axis::new("velocity", "rad/s").over(-0.52, 0.52)
}

fn curves(shown: &[Case]) -> Outcome<Figure> {
    let mut figure = Figure::new(
        "methods",
        "Laws by SINDy (LASSO) and nonlinear regression with the samples that they were made from.",
    );
    for case in shown {
        let law = |method| curve(&case.law(method)?, FASTEST);
        figure = figure.plot(
            Plot::new(case.name, velocity(), Axis::new("friction torque", "N m").over(-62.0, 62.0))
                .series("samples", Marks::Points, case.samples.points(400))
                .series(Method::Lasso.name(), Marks::Line, law(Method::Lasso)?)
                .series(Method::Stribeck.name(), Marks::Dashed, law(Method::Stribeck)?),
        );
    }
    Ok(figure)
}

fn deviations(shown: &[Case]) -> Outcome<Figure> {
    let mut figure = Figure::new(
        "methods-deviations",
        "Law minus the plant's own friction. What leaves the plot for B with |β| < 0.1 is STLS, see claim 8f.",
    );
    for case in shown {
        let mut plot = Plot::new(case.name, velocity(), Axis::new("law minus plant", "N m").over(-1.2, 1.2));
        for method in Method::ALL {
            let points = deviation(&case.law(method)?, |v| case.truth(v), FASTEST)?;
            plot = plot.series(method.name(), Marks::Line, points);
        }
        figure = figure.plot(plot);
    }
    Ok(figure)
}

fn errors(shown: &[Case]) -> Outcome<Table> {
    let mut table = Table::new(
        "methods-errors",
        "Errors of the laws, rms over all speeds, and what each leaves of its samples, rms [N m].",
    )
    .column("data", "data", "")
    .column("samples", "samples", "")
    .column("STLS", "stls", "N m")
    .column("LASSO", "lasso", "N m")
    .column("regression", "regression", "N m")
    .column("left by LASSO", "lasso_residual", "N m")
    .column("left by regression", "regression_residual", "N m");
    for case in shown {
        let left = |method: Method| -> Outcome<Cell> {
            let report = method.identify(&case.samples)?;
            Ok(Cell::number(report.result.residual))
        };
        let errors = Method::ALL.map(|method| Cell::number(case.error_or_nan(method)));
        let mut row = vec![Cell::text(case.name), Cell::Count(case.samples.len())];
        row.extend(errors);
        row.extend([left(Method::Lasso)?, left(Method::Stribeck)?]);
        table = table.row(row);
    }
    Ok(table)
}

/// Table of computing times. It is the only table of these experiments that differs from run to run.
fn times(shown: &[Case]) -> Outcome<Table> {
    let mut table = Table::new(
        "methods-times",
        "Time to find one law, the choice of terms included, in this run; these numbers differ from run to run.",
    )
    .column("data", "data", "")
    .column("STLS", "stls_time", "ms")
    .column("LASSO, ten folds", "lasso_time", "ms")
    .column("regression", "regression_time", "ms");
    for case in shown {
        let mut row = vec![Cell::text(case.name)];
        for method in Method::ALL {
            let start = Instant::now();
            method.identify(&case.samples)?;
            row.push(Cell::Rounded(1e3 * start.elapsed().as_secs_f64(), 2));
        }
        table = table.row(row);
    }
    Ok(table)
}

/// Plot with one curve for each method over a varied quantity.
fn sweep(title: &str, x: Axis, points: &[f64], error: impl Fn(f64, Method) -> Outcome<f64>) -> Outcome<Plot> {
    let mut plot =
        Plot::new(title, x, Axis::new("error of the law, rms", "N m").logarithmic().over(5e-3, 20.0));
    for method in Method::ALL {
        let mut curve = Vec::new();
        for point in points {
            curve.push([*point, error(*point, method)?]);
        }
        plot = plot.series(method.name(), Marks::Line, curve);
    }
    let ends = [points.first(), points.last()];
    let bound = ends.into_iter().flatten().map(|x| [*x, USEFUL]).collect();
    Ok(plot.series("useful", Marks::Dashed, bound))
}

fn breaks(study: &Study) -> Outcome<Figure> {
    let seconds = 30.0;
    let record = Recorded::b(Beside::NOTHING, seconds, 2)?;
    let gravity: &[f64] = study.pick(&[0.0, 2.0, 4.0, 8.0, 12.0, 16.0, 24.0, 32.0], &[0.0, 8.0, 24.0]);
    let by_gravity =
        sweep("B, all angles", Axis::new("error of gravity", "%"), gravity, |percent, method| {
            Ok(record.case(0.01 * percent)?.error_or_nan(method))
        })?;
    let offsets: &[f64] = study.pick(&[0.0, 0.25, 0.5, 1.0, 2.0, 3.0, 4.0], &[0.0, 1.0, 4.0]);
    let by_offset =
        sweep("C, β = −γ", Axis::new("constant in the friction", "N m"), offsets, |offset, method| {
            let case = Recorded::c(Beside::offset(offset), seconds, 2)?.case(GRAVITY_ERROR)?;
            Ok(case.error_or_nan(method))
        })?;
    let all = record.case(GRAVITY_ERROR)?;
    let widths: &[f64] =
        study.pick(&[0.03, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.6, 0.8], &[0.05, 0.1, 0.3, 0.8]);
    let by_width = sweep(
        "B, gravity 8 % wrong",
        Axis::new("angles kept, |β| below", "rad").logarithmic(),
        widths,
        |width, method| {
            let kept = all.samples.select(|angle, _| angle.abs() < width);
            Ok(all.with(all.name, kept).error_or_nan(method))
        },
    )?;
    Ok(Figure::new(
        "breaks",
        &format!(
            "Where each method breaks: error of gravity in the identifying model, a constant in the plant's friction (claim 8b has {OFFSET} N m), \
             selection by angle. A gap is where a method gives no law, or one that is off by more than 20 N m; {USEFUL} N m counts as useful."
        ),
    )
    .plot(by_gravity)
    .plot(by_offset)
    .plot(by_width))
}

fn data_needed(study: &Study, right: &[Case]) -> Figure {
    let error = |cases: &[Case], method| worst(cases, method);
    let counts: &[f64] = study.pick(&[12.0, 20.0, 30.0, 50.0, 100.0, 300.0, 1000.0], &[20.0, 100.0, 1000.0]);
    let thinned = |count: f64, method| {
        let few: Vec<Case> =
            (right.iter()).map(|case| case.with(case.name, case.samples.thinned(count as usize))).collect();
        Ok(error(&few, method))
    };
    let lengths: &[f64] = study.pick(&[2.0, 3.0, 4.0, 5.0, 7.0, 10.0, 15.0, 30.0], &[3.0, 5.0, 10.0, 25.0]);
    let first = |seconds: f64, method| {
        let short: Vec<Case> = right.iter().map(|case| case.first(seconds)).collect();
        Ok(error(&short, method))
    };
    let plots = [
        sweep(
            "Samples evenly from the whole record",
            Axis::new("samples", "").logarithmic(),
            counts,
            thinned,
        ),
        sweep("Beginning of the record, 50 Hz", Axis::new("length", "s").logarithmic(), lengths, first),
    ];
    let figure = Figure::new(
        "data-needed",
        "How much data a law needs: the worst of joints A, B and C, gravity right, all angles.",
    );
    plots.into_iter().flatten().fold(figure, Figure::plot)
}

fn outside(right: &[Case]) -> Outcome<Figure> {
    let mut figure = Figure::new(
        "outside",
        "Laws from samples below 0.25 rad/s, gravity right: law minus plant up to twice that speed.",
    );
    for case in right {
        let slow = slower(case, SLOW);
        let mut plot = Plot::new(case.name, velocity(), Axis::new("law minus plant", "N m").over(-1.2, 1.2));
        for method in Method::ALL {
            if let Ok(law) = slow.law(method) {
                let points = deviation(&law, |v| case.truth(v), FASTEST)?;
                plot = plot.series(method.name(), Marks::Line, points);
            }
        }
        figure = figure.plot(plot);
    }
    Ok(figure)
}
