//! Plots as SVG text: friction characteristic with data, residuals, Pareto front.
//!
//! Each carries its source (file and hash) in the caption; the same data give the same bytes.

use super::cross_validation::ParetoPoint;
use super::error::{IdentificationError, Result, require_finite, require_length, require_samples};
use plotters::coord::Shift;
use plotters::prelude::*;
use std::fmt::Display;
use std::ops::Range;

const SIZE: (u32, u32) = (900, 600);
/// More points than this are thinned evenly: an SVG of a million circles helps nobody.
const MOST_POINTS: usize = 4_000;

/// Measured friction torque over velocity, with the identified law.
///
/// - `velocities`, `torques`: the data [rad/s, N·m]
/// - `law`: τ(v)
/// - `caption`: joint, data hash, settings
///
/// # Errors
/// No samples, lengths that disagree, or values that are not finite.
pub fn friction_plot(
    velocities: &[f64],
    torques: &[f64],
    law: impl Fn(f64) -> f64,
    caption: &str,
) -> Result<String> {
    check(velocities, torques)?;
    let v = span(velocities.iter().copied());
    let curve: Vec<(f64, f64)> = (0..=600)
        .map(|i| v.start + (v.end - v.start) * f64::from(i) / 600.0)
        .map(|v| (v, law(v)))
        .collect();
    let values: Vec<f64> = curve.iter().map(|p| p.1).collect();
    require_finite("the friction law", &values)?;
    let range = span(torques.iter().copied().chain(values));
    draw(caption, |area| {
        let mut chart = axes(
            area,
            caption,
            v,
            range,
            "velocity [rad/s]",
            "friction torque [N m]",
        )?;
        chart.draw_series(points(velocities, torques))?;
        chart.draw_series(LineSeries::new(curve, RED.stroke_width(2)))?;
        Ok(())
    })
}

/// Residuals over velocity.
///
/// # Errors
/// As [`friction_plot`].
pub fn residual_plot(velocities: &[f64], residuals: &[f64], caption: &str) -> Result<String> {
    check(velocities, residuals)?;
    let (v, r) = (
        span(velocities.iter().copied()),
        span(residuals.iter().copied()),
    );
    draw(caption, |area| {
        let mut chart = axes(
            area,
            caption,
            v.clone(),
            r,
            "velocity [rad/s]",
            "residual [N m]",
        )?;
        chart.draw_series(points(velocities, residuals))?;
        chart.draw_series(LineSeries::new(
            [(v.start, 0.0), (v.end, 0.0)],
            BLACK.stroke_width(1),
        ))?;
        Ok(())
    })
}

/// Root mean squared errors over log₁₀ λ, with vertical lines at the two choices.
///
/// - `front`: the points; `minimum`, `one_standard_error`: indices of the choices
///
/// # Errors
/// No points, a choice out of range, or values that are not finite.
pub fn pareto_plot(
    front: &[ParetoPoint],
    minimum: usize,
    one_standard_error: usize,
    caption: &str,
) -> Result<String> {
    require_samples("the Pareto front", 1, front.len())?;
    let furthest = minimum.max(one_standard_error);
    if furthest >= front.len() {
        require_length("points of the front", furthest + 1, front.len())?;
    }
    let x: Vec<f64> = front.iter().map(|p| p.lambda.log10()).collect();
    let series = |f: &dyn Fn(&ParetoPoint) -> f64| -> Vec<f64> {
        front.iter().map(|p| f(p).sqrt()).collect()
    };
    let validation = series(&|p| p.validation_error.unwrap_or(p.lasso_error));
    let refit = series(&|p| p.refit_error);
    check(&x, &validation)?;
    require_finite("the refit error", &refit)?;
    let (range, errors) = (
        span(x.iter().copied()),
        span(validation.iter().chain(&refit).copied()),
    );
    draw(caption, |area| {
        let mut chart = axes(
            area,
            caption,
            range,
            errors.clone(),
            "log10 of lambda (1/(2N) convention)",
            "rms error [N m]: validated (blue), refit (red)",
        )?;
        chart.draw_series(LineSeries::new(
            x.iter().copied().zip(validation),
            BLUE.stroke_width(2),
        ))?;
        chart.draw_series(LineSeries::new(
            x.iter().copied().zip(refit),
            RED.stroke_width(2),
        ))?;
        for index in [minimum, one_standard_error] {
            chart.draw_series(LineSeries::new(
                [(x[index], errors.start), (x[index], errors.end)],
                BLACK.stroke_width(1),
            ))?;
        }
        Ok(())
    })
}

type Chart<'a, 'b> = ChartContext<
    'a,
    SVGBackend<'b>,
    Cartesian2d<plotters::coord::types::RangedCoordf64, plotters::coord::types::RangedCoordf64>,
>;
type Drawn<T> = std::result::Result<T, DrawingAreaErrorKind<std::io::Error>>;

fn draw(
    caption: &str,
    content: impl FnOnce(&DrawingArea<SVGBackend, Shift>) -> Drawn<()>,
) -> Result<String> {
    let mut text = String::new();
    let fault = |e: &dyn Display| IdentificationError::File {
        place: format!("plot {caption}"),
        message: e.to_string(),
    };
    {
        let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        area.fill(&WHITE).map_err(|e| fault(&e))?;
        content(&area).map_err(|e| fault(&e))?;
        area.present().map_err(|e| fault(&e))?;
    }
    Ok(text)
}

fn axes<'a, 'b>(
    area: &'a DrawingArea<SVGBackend<'b>, Shift>,
    caption: &str,
    x: Range<f64>,
    y: Range<f64>,
    x_label: &str,
    y_label: &str,
) -> Drawn<Chart<'a, 'b>> {
    let mut chart = ChartBuilder::on(area)
        .caption(caption, ("sans-serif", 16))
        .margin(12)
        .x_label_area_size(44)
        .y_label_area_size(70)
        .build_cartesian_2d(x, y)?;
    chart
        .configure_mesh()
        .x_desc(x_label)
        .y_desc(y_label)
        .draw()?;
    Ok(chart)
}

fn points<'p>(x: &'p [f64], y: &'p [f64]) -> impl Iterator<Item = Circle<(f64, f64), i32>> + 'p {
    let stride = x.len().div_ceil(MOST_POINTS).max(1);
    x.iter()
        .zip(y)
        .step_by(stride)
        .map(|(x, y)| Circle::new((*x, *y), 1, BLUE.mix(0.4).filled()))
}

/// Range of the values with a margin; never empty.
fn span(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
        (a.min(x), b.max(x))
    });
    let margin = if high > low {
        0.03 * (high - low)
    } else {
        0.5 * high.abs().max(1e-3)
    };
    low - margin..high + margin
}

fn check(x: &[f64], y: &[f64]) -> Result<()> {
    require_samples("a plot", 1, x.len())?;
    require_length("values of a plot", x.len(), y.len())?;
    require_finite("the abscissa of a plot", x)?;
    require_finite("the ordinate of a plot", y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plots_hold_data_law_and_escaped_caption() {
        let v: Vec<f64> = (0..10_000).map(|i| (0.01 * f64::from(i)).sin()).collect();
        let torque: Vec<f64> = v.iter().map(|v| 3.0 * v).collect();
        let svg = friction_plot(&v, &torque, |v| 3.0 * v, "beta <2>, sha256 ab12").unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        assert!(svg.contains("beta &lt;2&gt;, sha256 ab12"));
        let circles = svg.matches("<circle").count();
        assert!((3_000..=MOST_POINTS).contains(&circles), "{circles}");
        assert!(svg.contains("<polyline"));
        assert_eq!(
            svg,
            friction_plot(&v, &torque, |v| 3.0 * v, "beta <2>, sha256 ab12").unwrap()
        );
        assert!(
            residual_plot(&v[..1], &[0.0], "one")
                .unwrap()
                .contains("<circle")
        );
    }

    #[test]
    fn the_front_marks_both_choices() {
        let point = |lambda: f64| ParetoPoint {
            lambda,
            active: vec![0],
            lasso_error: lambda,
            refit_error: lambda / 2.0,
            l1_norm: 1.0,
            validation_error: Some(lambda * 1.5),
        };
        let front: Vec<ParetoPoint> = [1.0, 0.1, 0.01].map(point).to_vec();
        let svg = pareto_plot(&front, 2, 1, "front").unwrap();
        assert!(svg.matches("<polyline").count() >= 4);
        assert!(
            pareto_plot(&front, 3, 0, "front")
                .unwrap_err()
                .to_string()
                .contains("4 expected, 3 given")
        );
        assert!(friction_plot(&[0.0], &[f64::NAN], |v| v, "x").is_err());
        assert!(
            friction_plot(&[], &[], |v| v, "x")
                .unwrap_err()
                .to_string()
                .contains("empty")
        );
    }
}
