//! Report page of an identification.

use gelenk_findings::digits;
use gelenk_findings::{Severity, texts};
use gelenk_identification::estimation::{JointEstimate, Uncertain};
use gelenk_identification::identify::{Identification, JointFriction};
use gelenk_identification::methods::subset::{SubsetValidation, ValidatedSubset};
use gelenk_identification::robot::Robot;
use gelenk_identification::run::PreparedRun;
use gelenk_report::{Axis, Block, Cell, Figure, Marks, Plot, Report, Section, Table, plain, text};

use super::terms;

/// Largest number of drawn points of a curve. If a curve has more points, only every k-th point is drawn.
const MOST_POINTS: usize = 1500;
/// Explanation in the report page of the rows of equations, if shafts of drives replace joints in the fit.
const SHAFTS: &str = "Efforts at the joints are $\\tau = W(y,\\dot y,\\ddot y)\\,\\pi + \\tau_F(\\dot y) + c$: inertial \
                      parameters $\\pi$, friction $\\tau_F$ and offsets $c$ in one weighted fit. Each drive that acts on several \
                      joints has a separate row with the name of the drive. Torque, position and speed in this row are those of \
                      the motor's shaft.";
/// Number of points of a friction curve in the report page.
const CURVE: usize = 200;

/// Creates the report page with friction curves, measured and predicted efforts, residuals, held-out
/// errors, parameters, and the preparation of the logs.
///
/// - `command`: command line that made the page
#[must_use]
pub fn page(name: &str, robot: &dyn Robot, found: &Identification, command: &str) -> Report {
    let findings = found.findings(robot);
    let rows = found.rows(robot);
    let robot: &dyn Robot = &rows;
    let estimate = &found.estimate;
    let samples: usize = found.runs.iter().map(|run| run.times.len()).sum();
    let mut report = Report::new(format!("Identification of {name}"))
        .lead(
            "Efforts at the joints are $\\tau = W(y,\\dot y,\\ddot y)\\,\\pi + \\tau_F(\\dot y) + c$: inertial parameters $\\pi$, \
             friction $\\tau_F$ and offsets $c$ in one weighted fit.",
        )
        .fact("joints", estimate.joints.len().to_string());
    if found.joint_terms().is_some() {
        report = report.lead(SHAFTS);
    }
    report = match found.runs.len() {
        0 => report.fact("logs", found.recording.hashes.len().to_string()),
        runs => report.fact("runs", runs.to_string()).fact("samples", samples.to_string()),
    };
    report.made_by = command.to_owned();
    let units = robot.position_units();
    report = report.section(summary(found));
    let warnings = texts(&findings, Severity::Warning);
    if !warnings.is_empty() {
        let blocks = warnings.into_iter().map(plain);
        report = report.section(Section::new("warnings", "Doubts").blocks(blocks));
    }
    if !found.friction.is_empty() {
        report = report.section(friction(found, &units));
    }
    if !found.runs.is_empty() {
        report = report.section(efforts(found)).section(residuals(found, &units));
    }
    report.section(parameters(robot, found)).section(data(found))
}

/// Returns the heading for the rows of tables: `joint`, or `joint or shaft` if shafts of drives replace joints
/// in the equations.
#[must_use]
pub fn rows_are(found: &Identification) -> &'static str {
    if found.joint_terms().is_some() { "joint or shaft" } else { "joint" }
}

/// Returns whether some joint rests in a part of the samples. The fit does not use these samples.
#[must_use]
pub fn has_rest(found: &Identification) -> bool {
    found.estimate.joints.iter().any(|joint| joint.rest > 0.0)
}

/// Returns the formula of the friction law of a joint, or a dash if the joint has no law.
#[must_use]
pub fn law(found: &Identification, joint: usize) -> String {
    found.law(joint).map_or_else(|| "–".to_owned(), |report| report.result.formula())
}

fn summary(found: &Identification) -> Section {
    let mut table = Table::new(
        "joints",
        "Held-out: each contiguous part of the data is predicted by the fit to the other parts. $R^2$ is centred. Samples at \
         which a joint rests are left out, because dry friction can have any value up to the static friction. The column 'with \
         rest' includes these samples. Predictions use the written description, without offsets of single runs.",
    )
    .column(rows_are(found), "joint", "")
    .column("$R^2$ held-out", "r_squared_held_out", "")
    .column("with rest", "r_squared_with_rest", "")
    .column("$R^2$ in the fit", "r_squared", "")
    .column("residual $\\sigma$", "sigma", "")
    .columns(&["offset", "unit", "friction"]);
    for (index, joint) in found.estimate.joints.iter().enumerate() {
        table = table.row([
            Cell::text(joint.name.clone()),
            share(joint, joint.held_out_r_squared),
            if joint.rest > 0.0 { share(joint, joint.held_out_with_rest) } else { Cell::Empty },
            share(joint, joint.r_squared),
            if joint.measured { Cell::Rounded(joint.sigma, 3) } else { Cell::Empty },
            Cell::text(offsets(joint)),
            Cell::text(joint.unit),
            Cell::Code(law(found, index)),
        ]);
    }
    let choices = texts(&found.estimate.findings, Severity::Note).into_iter().map(plain);
    Section::new("summary", "How well it fits").block(Block::Table(table)).blocks(choices)
}

/// Returns the lowest and the highest offset of a joint's efforts in single runs as text. These offsets are
/// not part of the written description.
#[must_use]
pub fn offsets(joint: &JointEstimate) -> String {
    let error = joint.offset_errors.first().copied();
    let end = |of: fn(f64, f64) -> f64| {
        let end = joint.offsets.iter().copied().reduce(of);
        end.map(|end| digits::rounded(end, error))
    };
    match (end(f64::min), end(f64::max)) {
        (Some(low), Some(high)) if low == high => low,
        (Some(low), Some(high)) => format!("{low} … {high}"),
        _ => "–".to_owned(),
    }
}

/// Returns the cell with R² of a joint that moves; empty if nothing acts on the joint.
fn share(joint: &JointEstimate, r_squared: f64) -> Cell {
    if is_judged(joint) { Cell::Rounded(r_squared, 4) } else { Cell::Empty }
}

/// Returns whether the coefficient of determination R² of a joint is meaningful. It is meaningful if the
/// joint moves and a force acts on it.
#[must_use]
pub fn is_judged(joint: &JointEstimate) -> bool {
    joint.moves && !joint.held_out_r_squared.is_nan()
}

fn friction(found: &Identification, units: &[&str]) -> Section {
    let words = match found.runs.is_empty() {
        true => {
            "The lines are the written friction laws. Files of moments do not contain samples, so measured points, efforts and \
             residuals are missing."
        }
        false => {
            "Points: measured effort minus the effort of the rigid bodies, the offset, and load-dependent friction if it \
             is identified. Line: the written law without load-dependent friction."
        }
    };
    let mut section = Section::new("friction", "Friction").block(text(words));
    for joint in &found.friction {
        section = section.block(Block::Figure(friction_figure(joint, units[joint.joint])));
    }
    section.block(Block::Table(terms::table(found)))
}

fn friction_figure(joint: &JointFriction, unit: &str) -> Figure {
    let force = if unit == "m" { "N" } else { "N·m" };
    let velocity = Axis::new("velocity", format!("{unit}/s"));
    let law = joint.report.as_ref().ok();
    let offsets = law.map_or(&[][..], |report| &report.result.offsets);
    let offset = offsets.iter().map(|offset| offset.value).sum::<f64>() / offsets.len().max(1) as f64;
    let points = joint.velocities.iter().zip(&joint.torques).map(|(v, torque)| [*v, torque - offset]);
    let mut plot = Plot::new(joint.name.clone(), velocity, Axis::new("friction", force));
    if !joint.velocities.is_empty() {
        plot = plot.series("measured", Marks::Points, thinned(points.collect()));
    }
    let mut figure = Figure::new(format!("friction_{}", joint.joint + 1), "");
    if let Some(report) = law {
        let [low, high] = report.result.velocity_range;
        let grid: Vec<f64> = (0..=CURVE).map(|i| low + (high - low) * i as f64 / CURVE as f64).collect();
        let point = |v: &f64| report.result.torque(*v, 0.0).ok().map(|torque| [*v, torque]);
        plot = plot.series("law", Marks::Line, grid.iter().filter_map(point).collect());
        figure = figure.plot(plot);
        if let Some(subsets) = &report.subsets {
            figure = figure.plot(front(subsets, force));
        }
        return figure;
    }
    figure.plot(plot)
}

/// Creates the plot of the error on held-out data over the number of friction terms.
fn front(subsets: &SubsetValidation, force: &str) -> Plot {
    let point = |subset: &ValidatedSubset| [subset.active.len() as f64, subset.mean_error.sqrt()];
    Plot::new(
        "Error by number of terms",
        Axis::new("terms", ""),
        Axis::new("rms error on held-out data", force),
    )
    .series("tried", Marks::Points, subsets.best.iter().map(point).collect())
    .series("chosen", Marks::Points, vec![point(&subsets.best[subsets.chosen])])
}

/// Returns the joints whose efforts were measured.
fn measured(found: &Identification) -> impl Iterator<Item = (usize, &JointEstimate)> {
    found.estimate.joints.iter().enumerate().filter(|(_, joint)| joint.measured)
}

fn efforts(found: &Identification) -> Section {
    let times = times(&found.runs);
    let mut figure = Figure::new(
        "effort",
        "Efforts at the joints, after the gears: measured, and predicted by the estimate. Runs are in sequence.",
    );
    for (index, joint) in measured(found) {
        let curve = |runs: &[Vec<Vec<f64>>]| {
            let values = runs.iter().flat_map(|run| run[index].iter().copied().chain([f64::NAN]));
            thinned(times.iter().copied().zip(values).map(|(t, value)| [t, value]).collect())
        };
        let plot = Plot::new(joint.name.clone(), Axis::new("time", "s"), Axis::new("effort", joint.unit))
            .series("measured", Marks::Line, curve(&found.estimate.measured))
            .series("predicted", Marks::Dashed, curve(&found.estimate.predicted));
        figure = figure.plot(plot);
    }
    Section::new("efforts", "Efforts over time").block(Block::Figure(figure))
}

/// Returns the sample times of all runs in sequence, with a gap after each run.
fn times(runs: &[PreparedRun]) -> Vec<f64> {
    let mut times = Vec::new();
    let mut start = 0.0;
    for run in runs {
        let first = run.times.first().copied().unwrap_or_default();
        times.extend(run.times.iter().map(|t| start + t - first));
        let end = times.last().copied().unwrap_or_default();
        times.push(end);
        start = end;
    }
    times
}

fn residuals(found: &Identification, units: &[&str]) -> Section {
    let mut section = Section::new("residuals", "Residuals").block(text(
        "Measured minus predicted effort. If the model is complete, this residual does not depend on any of \
                     these quantities.",
    ));
    for (index, joint) in measured(found) {
        let unit = units[index];
        let over = |label: &str, axis: &str, signal: &dyn Fn(&PreparedRun) -> &[f64]| {
            let points = found.runs.iter().enumerate().flat_map(|(run, prepared)| {
                let measured = &found.estimate.measured[run][index];
                let predicted = &found.estimate.predicted[run][index];
                let error = measured.iter().zip(predicted).map(|(m, p)| m - p);
                signal(prepared).iter().copied().zip(error).map(|(x, e)| [x, e]).collect::<Vec<_>>()
            });
            let y = Axis::new("residual", joint.unit);
            Plot::new(joint.name.clone(), Axis::new(label, axis), y).series(
                "",
                Marks::Points,
                thinned(points.collect()),
            )
        };
        let mut figure = Figure::new(format!("residual_{}", index + 1), "")
            .plot(over("time", "s", &|run| &run.times))
            .plot(over("velocity", &format!("{unit}/s"), &|run| &run.velocities[index]));
        // The path of a joint with a quaternion does not show its pose.
        if !joint.exact {
            figure = figure.plot(over("position", unit, &|run| &run.positions[index]));
        }
        section = section.block(Block::Figure(figure));
    }
    section
}

fn parameters(robot: &dyn Robot, found: &Identification) -> Section {
    let mut table = Table::new(
        "inertial_parameters",
        &format!(
            "Described and estimated inertial parameters with {:.0} % intervals. Parameters that the data do not determine \
             stay near the described values.",
            100.0 * found.estimate.confidence
        ),
    )
    .columns(&["parameter", "described", "estimated", "lowest", "highest"]);
    let described = robot.parameter_names().into_iter().zip(robot.parameters());
    for ((name, described), Uncertain { value, standard_error, interval: [low, high] }) in
        described.zip(&found.estimate.parameters)
    {
        let cells = [*value, *low, *high].map(|x| terms::measured(x, Some(*standard_error)));
        table = table.row([Cell::Code(name), Cell::Rounded(described, 4)].into_iter().chain(cells));
    }
    Section::new("parameters", "Inertial parameters").block(Block::Table(table))
}

fn data(found: &Identification) -> Section {
    let recording = &found.recording;
    let hashes = recording.hashes.iter().map(|(path, hash)| plain(format!("{path}: sha256 {hash}")));
    let columns = recording.columns.iter().cloned().map(plain);
    let unused = (!recording.unused.is_empty())
        .then(|| plain(format!("Columns that are not used: {}.", recording.unused.join(", "))));
    let findings = texts(&recording.findings, Severity::Note).into_iter().map(plain);
    let notes = texts(&found.preparation.findings, Severity::Note).into_iter().map(plain);
    Section::new("data", "Data")
        .blocks(hashes)
        .blocks(columns)
        .blocks(unused)
        .blocks(findings)
        .blocks(notes)
        .blocks((!found.preparation.joints.is_empty()).then(|| Block::Table(preparation(found))))
}

fn preparation(found: &Identification) -> Table {
    let mut table = Table::new("preparation", "Properties of the signals, and the filter of all signals.")
        .column("joint", "joint", "")
        .column("noise of positions", "noise", "")
        .column("resolution", "resolution", "")
        .column("filter", "bandwidth", "Hz")
        .column("delay of the effort", "delay", "ms")
        .column("remark", "remark", "");
    for joint in &found.preparation.joints {
        table = table.row([
            Cell::text(joint.name.clone()),
            Cell::Rounded(joint.noise, 3),
            Cell::Rounded(joint.resolution, 3),
            Cell::Rounded(joint.bandwidth, 3),
            Cell::Rounded(1e3 * joint.delay, 3),
            Cell::text(joint.fault.as_ref().map_or_else(String::new, |fault| fault.message.clone())),
        ]);
    }
    table
}

/// Returns every k-th point, so that at most [`MOST_POINTS`] points remain.
pub(super) fn thinned(points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let step = points.len().div_ceil(MOST_POINTS).max(1);
    points.into_iter().step_by(step).collect()
}
