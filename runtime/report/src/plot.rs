//! Plots as SVG in the colours of the page.

use std::fmt::Display;
use std::ops::Range;

use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::error::ReportError;
use super::inline::{Inline, inlines};
use super::style::light;

/// One or more plots with a common caption.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Anchor on the page and name of the CSV file: letters, digits, hyphens and underscores.
    pub id: String,
    /// Caption below the plots.
    pub caption: Vec<Inline>,
    /// Plots of the figure, side by side if the page is wide enough.
    pub plots: Vec<Plot>,
}

/// Curves in one pair of axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    /// Short title above the plot; may be empty.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Curves. At least one curve must have a finite point.
    pub series: Vec<Series>,
}

/// An axis of a plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Quantity of the axis.
    pub label: String,
    /// Unit of the quantity; may be empty.
    pub unit: String,
    /// Shown range; `None` for the range of the data. Points outside the range are omitted.
    pub range: Option<[f64; 2]>,
    /// Whether the scale is logarithmic. A logarithmic scale omits values that are not positive.
    pub is_logarithmic: bool,
}

/// A curve of a plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// Style of the curve.
    pub marks: Marks,
    /// Points (x, y). A point that is not finite interrupts the curve.
    pub points: Vec<[f64; 2]>,
}

/// Style of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marks {
    /// A line through the points.
    Line,
    /// A dashed line through the points.
    Dashed,
    /// Points without a line.
    Points,
    /// A stepped line: each value is held until the next point, like the output of a controller.
    Steps,
}

impl Figure {
    /// A figure without plots; `$…$` in the caption is an equation in LaTeX.
    #[must_use]
    pub fn new(id: impl Into<String>, caption: &str) -> Self {
        Self { id: id.into(), caption: inlines(caption), plots: Vec::new() }
    }

    /// Adds a plot.
    #[must_use]
    pub fn plot(mut self, plot: Plot) -> Self {
        self.plots.push(plot);
        self
    }
}

impl Plot {
    /// A plot without curves.
    #[must_use]
    pub fn new(title: impl Into<String>, x: Axis, y: Axis) -> Self {
        Self { title: title.into(), x, y, series: Vec::new() }
    }

    /// Adds a curve.
    #[must_use]
    pub fn series(mut self, name: impl Into<String>, marks: Marks, points: Vec<[f64; 2]>) -> Self {
        self.series.push(Series { name: name.into(), marks, points });
        self
    }
}

impl Axis {
    /// A linear axis over the range of the data.
    #[must_use]
    pub fn new(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { label: label.into(), unit: unit.into(), range: None, is_logarithmic: false }
    }

    /// Makes the scale logarithmic.
    #[must_use]
    pub fn logarithmic(mut self) -> Self {
        self.is_logarithmic = true;
        self
    }

    /// Sets the range that the axis shows.
    #[must_use]
    pub fn over(mut self, low: f64, high: f64) -> Self {
        self.range = Some([low, high]);
        self
    }

    /// Title of the axis, for example `friction torque [N m]`.
    pub(super) fn title(&self) -> String {
        match self.unit.as_str() {
            "" => self.label.clone(),
            unit => format!("{} [{unit}]", self.label),
        }
    }

    /// Positions of the ticks in scaled values. A logarithmic axis has ticks at powers of ten. If the range is short, it also
    /// has ticks at 2 and 5 times the powers of ten.
    fn ticks(&self, span: &Range<f64>, most: usize) -> Vec<f64> {
        if self.is_logarithmic {
            let digits: &[f64] = match span.end - span.start {
                width if width < 2.0 => &[1.0, 2.0, 5.0],
                _ => &[1.0],
            };
            let decades = span.start.floor() as i64..=span.end.ceil() as i64;
            let stride = (span.end - span.start) as usize / most + 1;
            let ticks: Vec<f64> = decades
                .step_by(stride)
                .flat_map(|decade| digits.iter().map(move |d| decade as f64 + d.log10()))
                .filter(|tick| span.contains(tick))
                .collect();
            // In a shorter range, linear and logarithmic scale look alike.
            if ticks.len() >= 2 {
                return ticks;
            }
        }
        RangedCoordf64::from(span.clone()).key_points(most)
    }

    fn ticked(&self, span: &Range<f64>, most: usize) -> Ticked {
        Ticked { range: span.clone().into(), ticks: self.ticks(span, most) }
    }

    fn scaled(&self, value: f64) -> f64 {
        if self.is_logarithmic { value.log10() } else { value }
    }

    /// Shown range in scaled values; `None` if it is empty or not finite.
    fn span(&self, values: impl Iterator<Item = f64>) -> Option<Range<f64>> {
        if let Some([low, high]) = self.range {
            let (low, high) = (self.scaled(low), self.scaled(high));
            return (low < high && (high - low).is_finite()).then_some(low..high);
        }
        let finite = values.filter(|value| value.is_finite());
        let (low, high) =
            finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        if low > high || !(high - low).is_finite() {
            return None;
        }
        // Steps below the resolution of the numbers would leave no room between two ticks.
        let least = 1e-9 * low.abs().max(high.abs());
        let margin = match high - low {
            width if width > least => 0.04 * width,
            _ => (0.1 * high.abs()).max(1e-3),
        };
        Some(low - margin..high + margin)
    }

    /// Label of a tick. `span` is the shown range in scaled values. Values below the resolution of the range
    /// are shown as zero.
    fn tick(&self, scaled: f64, span: &Range<f64>) -> String {
        if !self.is_logarithmic {
            let is_zero = scaled.abs() < 1e-9 * (span.end - span.start);
            return tick(if is_zero { 0.0 } else { scaled });
        }
        let value = 10_f64.powf(scaled);
        tick(format!("{value:.1e}").parse().unwrap_or(value))
    }
}

/// Label of a number, with the digits that distinguish it from its neighbours.
fn tick(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-3..1e5).contains(&size) {
        return super::number::exact(format!("{value:.5e}").parse().unwrap_or(value));
    }
    let fixed = format!("{value:.6}");
    let short = fixed.trim_end_matches('0').trim_end_matches('.');
    match short {
        "" | "-0" => "0".to_owned(),
        short => short.replace('-', "−"),
    }
}

/// Width and height of a plot on the page in CSS pixels.
const SIZE: (u32, u32) = (600, 350);
/// Ratio of the size of the canvas to the size on the page. The library rounds to whole pixels, so a larger canvas makes the
/// rounding invisible.
const SCALE: u32 = 8;
/// Largest number of points of a curve. A curve with more points is thinned, to limit the size of the page.
const MOST_POINTS: usize = 3_000;
/// Largest number of points that are drawn as large circles.
const FEW_POINTS: usize = 20;
/// Number of colours of curves.
pub(super) const COLOURS: usize = 6;

// Placeholder colours, which are later replaced by the colours of the page.
const INK: RGBColor = RGBColor(1, 1, 1);
const GRID: RGBColor = RGBColor(2, 2, 2);
const FIRST: u8 = 0x10;

fn colour(series: usize, marks: Marks) -> RGBColor {
    let index = u8::try_from(series % COLOURS).unwrap_or(0);
    match marks {
        Marks::Dashed => RGBColor(3, 4, FIRST + index),
        _ => RGBColor(3, 3, FIRST + index),
    }
}

/// The plot as an `svg` element with the colours of the page.
///
/// - `id`: identifier of the figure, for messages
pub(super) fn svg(plot: &Plot, id: &str) -> Result<String, ReportError> {
    let fault = |message: &dyn Display| ReportError::Plot { id: id.to_owned(), message: message.to_string() };
    let curves: Vec<Vec<[f64; 2]>> = plot.series.iter().map(|one| scaled(plot, one)).collect();
    let values = |axis: usize| {
        let shown = curves.iter().flatten();
        shown.filter(|point| point.iter().all(|x| x.is_finite())).map(move |point| point[axis])
    };
    let (Some(x), Some(y)) = (plot.x.span(values(0)), plot.y.span(values(1))) else {
        return Err(fault(&"the plot has no finite points, or an empty range: give at least one point"));
    };
    let mut text = String::new();
    draw(plot, &curves, x, y, &mut text).map_err(|error| fault(&error))?;
    Ok(themed(&text, &description(plot)))
}

/// Points of a curve in the scales of the axes.
fn scaled(plot: &Plot, series: &Series) -> Vec<[f64; 2]> {
    let points = series.points.iter();
    points.map(|&[x, y]| [plot.x.scaled(x), plot.y.scaled(y)]).collect()
}

/// A range with given ticks.
struct Ticked {
    range: RangedCoordf64,
    ticks: Vec<f64>,
}

impl Ranged for Ticked {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        self.range.map(value, limit)
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() { Vec::new() } else { self.ticks.clone() }
    }

    fn range(&self) -> Range<f64> {
        self.range.range()
    }
}

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Ticked, Ticked>>;

fn draw(
    plot: &Plot,
    curves: &[Vec<[f64; 2]>],
    x: Range<f64>,
    y: Range<f64>,
    text: &mut String,
) -> Result<(), DrawingAreaErrorKind<std::io::Error>> {
    let area = SVGBackend::with_string(text, (SIZE.0 * SCALE, SIZE.1 * SCALE)).into_drawing_area();
    let pixels = |length: u32| length * SCALE;
    // The library divides sizes of letters by 1.24.
    let letters = |size: f64| ("sans-serif", size * f64::from(SCALE) * 1.24).into_font();
    let mut chart = ChartBuilder::on(&area)
        .margin(pixels(6))
        // The margin has room for half a label at the end of the axis.
        .margin_right(pixels(18))
        .x_label_area_size(pixels(42))
        .y_label_area_size(pixels(70))
        .build_cartesian_2d(plot.x.ticked(&x, 8), plot.y.ticked(&y, 7))?;
    chart
        .configure_mesh()
        .x_desc(plot.x.title())
        .y_desc(plot.y.title())
        .x_label_formatter(&|value| plot.x.tick(*value, &x))
        .y_label_formatter(&|value| plot.y.tick(*value, &y))
        .axis_style(INK.stroke_width(SCALE))
        .bold_line_style(GRID.stroke_width(SCALE))
        .light_line_style(TRANSPARENT)
        .label_style(letters(12.0).color(&INK))
        .axis_desc_style(letters(13.0).color(&INK))
        .set_all_tick_mark_size(pixels(4))
        .draw()?;
    for (index, (series, points)) in plot.series.iter().zip(curves).enumerate() {
        let style = colour(index, series.marks).stroke_width(SCALE * 7 / 4);
        let shown = |point: &[f64; 2]| x.contains(&point[0]) && y.contains(&point[1]);
        curve(&mut chart, series.marks, points, style, &shown)?;
    }
    area.present()
}

fn curve(
    chart: &mut Chart<'_, '_>,
    marks: Marks,
    points: &[[f64; 2]],
    style: ShapeStyle,
    shown: &dyn Fn(&[f64; 2]) -> bool,
) -> Result<(), DrawingAreaErrorKind<std::io::Error>> {
    let stride = points.len().div_ceil(MOST_POINTS).max(1);
    if marks == Marks::Points {
        let dots = points.iter().step_by(stride).filter(|point| shown(point));
        // Few points are drawn large, and many points small.
        let radius = if points.len() <= FEW_POINTS { SCALE * 4 } else { SCALE * 3 / 2 };
        let dot = |&[x, y]: &[f64; 2]| Circle::new((x, y), radius, style.filled());
        chart.draw_series(dots.map(dot))?;
        return Ok(());
    }
    for piece in points.split(|point| !shown(point)) {
        let last = piece.last().into_iter();
        let kept = piece.iter().step_by(stride).chain(last);
        let line: Vec<(f64, f64)> = match marks {
            Marks::Steps => steps(kept),
            _ => kept.map(|&[x, y]| (x, y)).collect(),
        };
        chart.draw_series(LineSeries::new(line, style))?;
    }
    Ok(())
}

fn steps<'p>(points: impl Iterator<Item = &'p [f64; 2]>) -> Vec<(f64, f64)> {
    let mut line: Vec<(f64, f64)> = Vec::new();
    for &[x, y] in points {
        if let Some(&(_, held)) = line.last() {
            line.push((x, held));
        }
        line.push((x, y));
    }
    line
}

/// Description of the plot for screen readers.
fn description(plot: &Plot) -> String {
    let names: Vec<&str> = plot.series.iter().map(|one| one.name.as_str()).collect();
    let title = match plot.title.as_str() {
        "" => String::new(),
        title => format!("{title}: "),
    };
    format!("{title}{} over {}; {}", plot.y.title(), plot.x.title(), names.join(", "))
}

/// Replaces the placeholder colours by the colours of the page, and leaves the size to the page.
fn themed(svg: &str, description: &str) -> String {
    let body = svg.find(">\n").map_or(svg, |end| &svg[end + 1..]);
    let label = maud::html! { (description) }.into_string();
    let hex = |RGBColor(r, g, b): RGBColor| format!("#{r:02X}{g:02X}{b:02X}");
    let mut body = body
        .replace(&hex(INK), "currentColor")
        .replace(&hex(GRID), "var(--grid)")
        .replace(" font-family=\"sans-serif\"", "")
        .replace(" opacity=\"1\"", "");
    for index in 0..COLOURS {
        let own = format!("var(--series-{})", index + 1);
        let dashed = hex(colour(index, Marks::Dashed));
        let dashes = format!("{own}\" stroke-dasharray=\"{} {}", 7 * SCALE, 4 * SCALE);
        body = body.replace(&dashed, &dashes).replace(&hex(colour(index, Marks::Line)), &own);
    }
    format!(
        "<svg class=\"plot\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{label}\">{body}",
        SIZE.0 * SCALE,
        SIZE.1 * SCALE,
    )
}

/// The plot as an SVG file with its legend, in the light colours of the page.
///
/// - `id`: identifier of the figure, for messages
pub(super) fn file(plot: &Plot, id: &str) -> Result<String, ReportError> {
    let drawing = svg(plot, id)?;
    let body = drawing.split_once('>').map_or("", |(_, body)| body).trim_end().trim_end_matches("</svg>");
    let line = 18 * SCALE;
    let [width, top] = [SIZE.0, SIZE.1].map(|length| length * SCALE);
    let rows = plot.series.iter().enumerate().map(|(index, series)| {
        let (y, colour) = (top + line * (index as u32 + 1), format!("var(--series-{})", index % COLOURS + 1));
        let dashes = if series.marks == Marks::Dashed { format!("{} {}", 7 * SCALE, 4 * SCALE) } else { String::new() };
        maud::html! {
            line x1=(70 * SCALE) x2=(94 * SCALE) y1=(y - 4 * SCALE) y2=(y - 4 * SCALE) stroke=(colour) stroke-width=(2 * SCALE)
                stroke-dasharray=[(!dashes.is_empty()).then_some(dashes)] {}
            text x=(100 * SCALE) y=(y) font-size=(13 * SCALE) fill="currentColor" { (series.name) }
        }
        .into_string()
    });
    let rows: String = rows.collect();
    let title = maud::html! { title { (description(plot)) } }.into_string();
    let height = top + line * (plot.series.len() as u32 + 1);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" viewBox=\"0 0 {width} {height}\" \
         font-family=\"sans-serif\">{title}<rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>{body}{rows}</svg>\n",
        width / SCALE,
        height / SCALE,
    );
    text = text.replace("currentColor", light("--ink")).replace("var(--grid)", light("--grid"));
    for index in 1..=COLOURS {
        let name = format!("--series-{index}");
        text = text.replace(&format!("var({name})"), light(&name));
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// SVG files do not need the page. They contain no CSS variables and no classes, and they contain the names of the curves.
    #[test]
    fn a_file_has_its_colours_and_its_legend() {
        let svg = file(&plot(vec![[0.0, 0.0], [1.0, 1.0]]), "f").unwrap();
        for part in ["xmlns=", "#1f5a94", "measured &amp; filtered", "</svg>"] {
            assert!(svg.contains(part), "no {part}: {svg}");
        }
        assert!(!svg.contains("var(") && !svg.contains("currentColor"), "{svg}");
        assert_eq!(svg.matches("<svg").count(), 1);
    }

    fn plot(points: Vec<[f64; 2]>) -> Plot {
        Plot::new("", Axis::new("time", "s"), Axis::new("torque <τ>", "N m"))
            .series("measured & filtered", Marks::Line, points.clone())
            .series("model", Marks::Dashed, points.clone())
            .series("samples", Marks::Points, points.clone())
            .series("input", Marks::Steps, points)
    }

    fn drawn(plot: &Plot) -> Result<String, String> {
        svg(plot, "f").map_err(|error| error.to_string())
    }

    #[test]
    fn curves_take_the_colours_of_the_page() {
        let points = (0..50).map(|i| [f64::from(i), 0.2 * f64::from(i * i) - 300.0]);
        let svg = drawn(&plot(points.collect())).unwrap();
        for part in ["var(--series-1)", "stroke-dasharray", "var(--grid)", "−200", "&lt;τ&gt;"] {
            assert!(svg.contains(part), "no {part}");
        }
        assert!(!svg.contains("#0") && !svg.contains("<τ>"), "{svg}");
        assert_eq!(svg.matches("<circle").count(), 50);
    }

    #[test]
    fn gaps_break_lines_and_nothing_is_an_error() {
        let gap = vec![[0.0, 1.0], [1.0, 2.0], [2.0, f64::NAN], [3.0, 1.0], [4.0, 5.0]];
        let lines = drawn(&plot(gap)).unwrap();
        assert_eq!(lines.matches("stroke=\"var(--series-1)\"").count(), 2);
        assert!(drawn(&plot(vec![[f64::NAN, 0.0]])).is_err());
        assert!(drawn(&plot(vec![])).is_err());
    }

    #[test]
    fn any_finite_values_can_be_drawn() {
        for value in [0.0, -1e300, 1e300, 5e-324, 1e-12, 9.8] {
            for second in [value, -value, value * (1.0 + 1e-15), 1.0] {
                // A plot whose width exceeds the largest number is rejected. Everything else is drawn.
                let _ = drawn(&plot(vec![[value, second], [second, value]]));
            }
        }
        let mut logarithmic = plot(vec![[1e-3, 1.0], [1e3, 10.0], [0.0, 1.0], [-1.0, 2.0]]);
        logarithmic.x = logarithmic.x.logarithmic();
        assert!(drawn(&logarithmic).unwrap().contains("1000"));
    }

    #[test]
    fn ticks_stand_at_round_numbers() {
        let shown = |plot: &Plot, labels: &[&str]| {
            let svg = drawn(plot).unwrap();
            for label in labels {
                assert!(svg.contains(&format!(">\n{label}\n<")), "no {label} in {svg}");
            }
            assert!(!svg.contains("10⁻") && !svg.contains("3.2"), "{svg}");
        };
        let mut plot = plot(vec![[-0.6, 1e-2], [0.6, 1e2]]);
        plot.x = plot.x.over(-0.6, 0.6);
        plot.y = plot.y.logarithmic();
        shown(&plot, &["−0.4", "0", "0.1", "100"]);
        plot.y = plot.y.over(0.3, 6.0);
        shown(&plot, &["0.5", "1", "2", "5"]);
    }

    #[test]
    fn ticks_are_short() {
        for (value, shown) in
            [(0.1 + 0.2, "0.3"), (-0.0, "0"), (-12.5, "−12.5"), (200.0, "200"), (1e-5, "1·10⁻⁵")]
        {
            assert_eq!(tick(value), shown);
        }
    }
}
