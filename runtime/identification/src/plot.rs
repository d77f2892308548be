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
/// Characters of a caption's line.
const LONGEST_LINE: usize = 130;

/// Measured friction torque over velocity, with the identified law.
///
/// - `velocities`, `torques`: the data; `units`: theirs, e.g. `["rad/s", "N·m"]`
/// - `law`: velocities and torques of the curve, ascending
/// - `caption`: a title line, then joint, data hash, settings in lines of their own
///
/// # Errors
/// No samples, lengths that disagree, or values that are not finite.
pub fn friction_plot(
    velocities: &[f64],
    torques: &[f64],
    law: (&[f64], &[f64]),
    units: [&str; 2],
    caption: &str,
) -> Result<String> {
    check(velocities, torques)?;
    check(law.0, law.1)?;
    let x = span(velocities.iter().chain(law.0).copied());
    let y = span(torques.iter().chain(law.1).copied());
    let curve: Vec<(f64, f64)> = law.0.iter().copied().zip(law.1.iter().copied()).collect();
    let labels = labels(["velocity", "friction torque"], units);
    draw(caption, |area| {
        let mut chart = axes(area, x, y, &labels)?;
        chart
            .draw_series(points(velocities, torques))?
            .label("data")
            .legend(|(x, y)| Circle::new((x + 10, y), 3, BLUE.mix(0.6).filled()));
        chart
            .draw_series(LineSeries::new(curve, RED.stroke_width(2)))?
            .label("identified law")
            .legend(|(x, y)| PathElement::new([(x, y), (x + 20, y)], RED.stroke_width(2)));
        legend(&mut chart, SeriesLabelPosition::UpperLeft)
    })
}

/// Residuals (torque minus law) over velocity.
///
/// # Errors
/// As [`friction_plot`].
pub fn residual_plot(
    velocities: &[f64],
    residuals: &[f64],
    units: [&str; 2],
    caption: &str,
) -> Result<String> {
    check(velocities, residuals)?;
    let x = span(velocities.iter().copied());
    let y = span(residuals.iter().copied());
    let zero = [(x.start, 0.0), (x.end, 0.0)];
    let labels = labels(["velocity", "torque minus law"], units);
    draw(caption, |area| {
        let mut chart = axes(area, x.clone(), y, &labels)?;
        chart.draw_series(points(velocities, residuals))?;
        chart.draw_series(LineSeries::new(zero, BLACK.stroke_width(1)))?;
        Ok(())
    })
}

/// Root mean squared errors over λ, both as logarithms, with vertical lines at the two choices and the number
/// of terms above.
///
/// - `front`: the points, λ descending; `choices`: indices of the least error and of the one-standard-error
///   choice
/// - `unit`: of the target, e.g. `N·m`
///
/// # Errors
/// No points, a choice out of range, or values that are not finite.
pub fn pareto_plot(front: &[ParetoPoint], choices: [usize; 2], unit: &str, caption: &str) -> Result<String> {
    require_samples("the Pareto front", 1, front.len())?;
    let furthest = choices[0].max(choices[1]);
    if furthest >= front.len() {
        require_length("points of the front", furthest + 1, front.len())?;
    }
    let x: Vec<f64> = front.iter().map(|p| p.lambda.log10()).collect();
    // An exact fit has no logarithm; twelve digits below the largest error is as good as exact.
    let largest = front.iter().map(|p| p.lasso_error).fold(f64::MIN_POSITIVE, f64::max);
    let series = |f: &dyn Fn(&ParetoPoint) -> f64| -> Vec<f64> {
        front.iter().map(|p| 0.5 * f(p).max(1e-24 * largest).log10()).collect()
    };
    let curves = [
        ("left-out blocks", series(&|p| p.validation_error.unwrap_or(p.lasso_error)), BLUE),
        ("least squares on the chosen terms", series(&|p| p.refit_error), RED),
    ];
    for (_, values, _) in &curves {
        check(&x, values)?;
    }
    let range = span(x.iter().copied());
    let errors = span(curves.iter().flat_map(|c| c.1.iter().copied()));
    let marks =
        [("least error", choices[0], BLACK.mix(1.0)), ("one standard error", choices[1], GREEN.mix(1.0))];
    let labels = [
        "log10 of lambda, in 1/(2N) |y - T x|² + lambda |x|".to_string(),
        format!("log10 of the rms error [{unit}]; above: number of terms"),
    ];
    draw(caption, |area| {
        let mut chart = axes(area, range, errors.clone(), &labels)?;
        for (name, values, color) in curves {
            let line = x.iter().copied().zip(values);
            chart
                .draw_series(LineSeries::new(line, color.stroke_width(2)))?
                .label(name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], color.stroke_width(2)));
        }
        for (name, index, color) in marks {
            let line = [(x[index], errors.start), (x[index], errors.end)];
            chart
                .draw_series(LineSeries::new(line, color.stroke_width(1)))?
                .label(name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], color.stroke_width(1)));
        }
        chart.draw_series(term_counts(front, &x, errors.end))?;
        legend(&mut chart, SeriesLabelPosition::LowerRight)
    })
}

/// The number of terms, where it changes along the front.
fn term_counts<'t>(
    front: &'t [ParetoPoint],
    x: &'t [f64],
    y: f64,
) -> impl Iterator<Item = Text<'static, (f64, f64), String>> + 't {
    let count = |i: usize| front[i].active.len();
    (0..front.len())
        .filter(move |&i| i == 0 || count(i) != count(i - 1))
        .map(move |i| Text::new(count(i).to_string(), (x[i], y), ("sans-serif", 12)))
}

type Chart<'a, 'b> = ChartContext<
    'a,
    SVGBackend<'b>,
    Cartesian2d<plotters::coord::types::RangedCoordf64, plotters::coord::types::RangedCoordf64>,
>;
type Drawn<T> = std::result::Result<T, DrawingAreaErrorKind<std::io::Error>>;

fn labels(quantities: [&str; 2], units: [&str; 2]) -> [String; 2] {
    std::array::from_fn(|i| format!("{} [{}]", quantities[i], units[i]))
}

/// The caption's lines at the top, the first as a title, and the content below.
fn draw(caption: &str, content: impl FnOnce(&DrawingArea<SVGBackend, Shift>) -> Drawn<()>) -> Result<String> {
    let mut text = String::new();
    let fault = |e: &dyn Display| IdentificationError::File {
        place: format!("plot {caption}"),
        message: e.to_string(),
    };
    {
        let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        area.fill(&WHITE).map_err(|e| fault(&e))?;
        let mut y = 10;
        for (i, line) in caption.lines().enumerate() {
            let size = if i == 0 { 16 } else { 12 };
            for part in wrapped(line) {
                let text = Text::new(part, (16, y), ("sans-serif", size));
                area.draw(&text).map_err(|e| fault(&e))?;
                y += size + 4;
            }
        }
        content(&area.split_vertically(y).1).map_err(|e| fault(&e))?;
        area.present().map_err(|e| fault(&e))?;
    }
    Ok(text)
}

/// A line of the caption in parts that fit the width, broken at spaces.
fn wrapped(line: &str) -> Vec<String> {
    let mut parts = vec![String::new()];
    for word in line.split(' ') {
        let length = |text: &str| text.chars().count();
        match parts.last_mut() {
            Some(last) if last.is_empty() => last.push_str(word),
            Some(last) if length(last) + 1 + length(word) <= LONGEST_LINE => {
                last.push(' ');
                last.push_str(word);
            }
            _ => parts.push(word.to_string()),
        }
    }
    parts
}

fn axes<'a, 'b>(
    area: &'a DrawingArea<SVGBackend<'b>, Shift>,
    x: Range<f64>,
    y: Range<f64>,
    labels: &[String; 2],
) -> Drawn<Chart<'a, 'b>> {
    let mut chart = ChartBuilder::on(area)
        .margin(12)
        .x_label_area_size(44)
        .y_label_area_size(70)
        .build_cartesian_2d(x, y)?;
    chart
        .configure_mesh()
        .x_desc(&labels[0])
        .y_desc(&labels[1])
        .x_label_formatter(&number)
        .y_label_formatter(&number)
        .max_light_lines(2)
        .draw()?;
    Ok(chart)
}

/// A number at an axis, without the sign of a zero or digits of rounding.
fn number(x: &f64) -> String {
    format!("{}", (x * 1e9).round() / 1e9 + 0.0)
}

fn legend<'a, 'b: 'a>(chart: &mut Chart<'a, 'b>, position: SeriesLabelPosition) -> Drawn<()> {
    chart
        .configure_series_labels()
        .position(position)
        .background_style(WHITE.mix(0.8))
        .border_style(BLACK.mix(0.4))
        .draw()
}

fn points<'p>(x: &'p [f64], y: &'p [f64]) -> impl Iterator<Item = Circle<(f64, f64), i32>> + 'p {
    let stride = x.len().div_ceil(MOST_POINTS).max(1);
    x.iter().zip(y).step_by(stride).map(|(x, y)| Circle::new((*x, *y), 2, BLUE.mix(0.4).filled()))
}

/// Range of the values with a margin; never empty.
fn span(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    let margin = if high > low { 0.03 * (high - low) } else { 0.5 * high.abs().max(1e-3) };
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
        let law = ([-1.0, 1.0].as_slice(), [-3.0, 3.0].as_slice());
        let svg = friction_plot(&v, &torque, law, ["rad/s", "N·m"], "beta <2>\nsha256 ab12").unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        assert!(svg.contains("beta &lt;2&gt;") && svg.contains("sha256 ab12"));
        assert!(svg.contains("velocity [rad/s]") && svg.contains("friction torque [N·m]"));
        let circles = svg.matches("<circle").count();
        assert!((3_000..=MOST_POINTS).contains(&circles), "{circles}");
        assert!(svg.contains("<polyline"));
        assert_eq!(svg, friction_plot(&v, &torque, law, ["rad/s", "N·m"], "beta <2>\nsha256 ab12").unwrap());
        assert!(residual_plot(&v[..1], &[0.0], ["rad/s", "N·m"], "one").unwrap().contains("<circle"));
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
        let svg = pareto_plot(&front, [2, 1], "N·m", "front").unwrap();
        assert!(svg.matches("<polyline").count() >= 4);
        assert!(
            pareto_plot(&front, [3, 0], "N·m", "front")
                .unwrap_err()
                .to_string()
                .contains("4 expected, 3 given")
        );
        assert!(friction_plot(&[0.0], &[f64::NAN], (&[0.0], &[0.0]), ["", ""], "x").is_err());
        assert!(
            friction_plot(&[], &[], (&[], &[]), ["", ""], "x").unwrap_err().to_string().contains("empty")
        );
    }
}
