//! From a log to a friction description and a page of plots.
//!
//!     cargo run --release -p gelenk-runtime --example identify [-- LOG.csv [FOLDER]]
//!
//! The log has the columns `t [s]`, `q1 [rad]`, `q2 [rad]`, `u1 [N*m]`, `u2 [N*m]` of a PowerCube reduced to
//! two joints (torques at the motors). Without one, the published arm is simulated along an excitation
//! motion: 60 s at 50 Hz, encoders of 1e-4 rad, motor torques of 1e-4 N·m noise. Written to FOLDER
//! (`target/identify`): the log, a description that `gelenk generate` takes unchanged, and the page.
//! `GELENK_EXAMPLE_SHORT=1` searches and draws less.

use gelenk_files::write_whole;
use gelenk_identification::cross_validation::{ParetoPoint, pareto_table};
use gelenk_identification::description::write_description;
use gelenk_identification::differentiation::{KalmanSmoother, quantization_noise};
use gelenk_identification::excitation::{Excitation, ExcitationLimits, FourierMotion};
use gelenk_identification::friction::{
    FrictionData, FrictionIdentification, FrictionMethod, FrictionReport, LambdaChoice,
};
use gelenk_identification::lasso::Lasso;
use gelenk_identification::log::{Differentiation, Log, LogSchema};
use gelenk_identification::random::SplitMix64;
use gelenk_identification::torque::friction_torques;
use gelenk_report::{Axis, Block, Figure, Marks, Plot, Report, Section};
use gelenk_runtime::dynamics::Dynamics;
use outcome::Outcome;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[path = "support/outcome.rs"]
mod outcome;

gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);

const JOINTS: [&str; 2] = gelenk_generated::powercube::JOINT_NAMES;
const RESOLUTION: f64 = 1e-4;
const STEP: f64 = 0.02;
const SAMPLES: usize = 3000;
/// Samples left out at both ends, one second: there the smoother sees one side only.
const MARGIN: usize = 50;
const SELECTION: &str = "abs(q1_velocity) < 2 && abs(q2_velocity) < 2";

fn main() -> ExitCode {
    outcome::end(run())
}

fn run() -> Outcome<()> {
    let short = std::env::var_os("GELENK_EXAMPLE_SHORT").is_some();
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let given = arguments.next();
    let folder = arguments.next().unwrap_or_else(|| "target/identify".into());
    std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let path = match given {
        Some(path) => path,
        None => simulated_log(&folder, short)?,
    };
    let (mut log, findings) = Log::open(&path, &LogSchema::default())?;
    println!("{}: {} rows, sha256 {}", log.source(), log.rows(), log.hash());
    findings.iter().for_each(|finding| println!("  {finding}"));

    let reports = identify(&mut log, if short { 50 } else { 500 })?;
    for report in &reports {
        println!("\n{}", report.result.table());
        if let Some(validation) = &report.validation {
            let choices = [validation.minimum, validation.one_standard_error];
            println!("{}", pareto_table(&report.front, &report.terms, report.result.samples, choices));
        }
    }
    let sections = reports.iter().map(|report| section(report, &log)).collect::<Outcome<Vec<_>>>()?;
    sections.into_iter().fold(Report::new("Friction from a log"), Report::section).write(&folder)?;
    let results: Vec<_> = reports.into_iter().map(|r| r.result).collect();
    let base = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/powercube.toml");
    let base = base.canonicalize()?.display().to_string();
    let description = folder.join("powercube_identified.toml");
    write_description(&description, "powercube_identified", &base, &results)?;
    println!("\nwritten to {}; next:", folder.display());
    println!("  cargo run --release -- generate {}", description.display());
    Ok(())
}

/// Friction of both joints: smooth, select, take the rigid arm's torque off, choose terms.
fn identify(log: &mut Log, draws: usize) -> Outcome<Vec<FrictionReport>> {
    let smoother = KalmanSmoother::from_noise(quantization_noise(RESOLUTION));
    for position in ["q1", "q2"] {
        log.differentiate(position, &Differentiation::KalmanSmoother(smoother))?;
    }
    let rows = log.inner_rows(&log.select(SELECTION)?, MARGIN)?;
    let columns = log.motion(&["q1", "q2"], &["u1", "u2"], &rows)?;
    let torques = friction_torques(&PowerCube, &columns.motion())?;
    let lasso = Lasso { standardize: true, ..Default::default() };
    let settings = FrictionIdentification {
        method: FrictionMethod::Lasso(lasso, LambdaChoice::OneStandardError),
        draws,
        ..FrictionIdentification::new()?
    };
    let data = format!("{}, sha256 {}", log.source(), log.hash());
    let preparation = [
        format!("Kalman smoother for encoders of {RESOLUTION} rad, {MARGIN} samples left out at both ends"),
        format!("selection {SELECTION}"),
    ];
    let one = |joint: usize| {
        settings.identify(&FrictionData {
            joint: JOINTS[joint],
            unit: "N·m",
            velocity_unit: "rad/s",
            velocities: &columns.velocities[joint],
            torques: &torques[joint],
            positions: Some(&columns.positions[joint]),
            accelerations: Some(&columns.accelerations[joint]),
            data: &data,
            settings: &preparation,
            ..FrictionData::default()
        })
    };
    Ok(vec![one(0)?, one(1)?])
}

/// Plots of a joint: its friction over the velocity, the residuals, and the errors along the path of the LASSO.
fn section(report: &FrictionReport, log: &Log) -> Outcome<Section> {
    let result = &report.result;
    let rows = log.inner_rows(&log.select(SELECTION)?, MARGIN)?;
    let channel = format!("q{}_velocity", if result.joint == JOINTS[0] { 1 } else { 2 });
    let velocities = log.values(&channel, &rows)?;
    let law = result.law.torques(&velocities)?;
    let torques: Vec<f64> = law.iter().zip(&report.residuals).map(|(l, r)| l + r).collect();
    let [slowest, fastest] = result.velocity_range;
    let grid: Vec<f64> = (0..=600).map(|i| slowest + (fastest - slowest) * f64::from(i) / 600.0).collect();
    let points = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| [*x, *y]).collect::<Vec<_>>();
    let over_velocity = |title: &str, quantity: &str| {
        let velocity = Axis::new("velocity", result.velocity_unit.as_str());
        Plot::new(title, velocity, Axis::new(quantity, result.unit.as_str()))
    };
    let friction = over_velocity("friction", "friction torque")
        .series("data", Marks::Points, points(&velocities, &torques))
        .series("identified law", Marks::Line, points(&grid, &result.law.torques(&grid)?));
    let residuals = over_velocity("residuals", "torque minus law").series(
        "data",
        Marks::Points,
        points(&velocities, &report.residuals),
    );
    let caption = [std::slice::from_ref(&result.data), &result.settings[..]].concat().join("; ");
    let mut figure = Figure::new(result.joint.as_str(), &caption).plot(friction).plot(residuals);
    if let Some(validation) = &report.validation {
        let choices = [validation.minimum, validation.one_standard_error];
        figure = figure.plot(front(&report.front, choices, &result.unit)).plot(sizes(&report.front));
    }
    let title = format!("Joint {}", result.joint);
    Ok(Section::new(format!("joint-{}", result.joint), title).block(Block::Figure(figure)))
}

fn lambda() -> Axis {
    Axis::new("λ, in 1/(2N) |y − Θ x|² + λ |x|", "").logarithmic()
}

/// Root mean squared errors over λ, with the two choices.
fn front(front: &[ParetoPoint], choices: [usize; 2], unit: &str) -> Plot {
    let points = |error: fn(&ParetoPoint) -> f64| -> Vec<[f64; 2]> {
        front.iter().map(|point| [point.lambda, error(point).sqrt()]).collect()
    };
    let left_out = points(|point| point.validation_error.unwrap_or(point.lasso_error));
    let marks: Vec<[f64; 2]> = choices.iter().map(|&i| left_out[i]).collect();
    Plot::new("errors", lambda(), Axis::new("rms error", unit).logarithmic())
        .series("left-out blocks", Marks::Line, left_out)
        .series("least squares on the chosen terms", Marks::Line, points(|point| point.refit_error))
        .series("least error, one standard error", Marks::Points, marks)
}

fn sizes(front: &[ParetoPoint]) -> Plot {
    let points = front.iter().map(|point| [point.lambda, point.active.len() as f64]).collect();
    Plot::new("size", lambda(), Axis::new("number of terms", "")).series("terms", Marks::Steps, points)
}

/// A motion that tells viscous friction from steps at standstill, within what the motors can do.
fn excitation(short: bool) -> Outcome<FourierMotion> {
    let settings = Excitation { iterations: if short { 50 } else { 1000 }, ..Default::default() };
    let limits = [ExcitationLimits { position: [-0.6, 0.6], velocity: 0.65, acceleration: 2.0 }; 2];
    // Steps at standstill and slopes, each direction by itself, so that the motion shows both.
    let found = settings.search(&limits, [2, 8], |_, v, _, out| {
        out.fill(0.0);
        for (joint, v) in v.iter().enumerate() {
            let step = (20.0 * v).tanh();
            let terms = [v.max(0.0), v.min(0.0), step.max(0.0), step.min(0.0)];
            out[12 * joint..12 * joint + 4].copy_from_slice(&terms);
        }
    })?;
    println!("excitation: condition number {:.1}, {:.1} before the search", found.condition, found.start);
    Ok(found.motion)
}

/// What encoders and torque sensors would record of the published arm along the excitation.
fn simulated_log(folder: &Path, short: bool) -> Outcome<PathBuf> {
    let motion = excitation(short)?;
    let gear = PowerCube.input_matrix(&[0.0; 2])[0][0];
    let mut random = SplitMix64::new(1);
    let mut text = String::from("t [s],q1 [rad],q2 [rad],u1 [N*m],u2 [N*m]\n");
    for i in 0..SAMPLES {
        let t = STEP * i as f64;
        let [y, v, a] = motion.at(t);
        let torques = PowerCube.inverse_dynamics(&y, &v, &a);
        let [q1, q2] = y.map(|y| (y / RESOLUTION).round() * RESOLUTION);
        let [u1, u2] = torques.map(|torque| torque / gear + 1e-4 * random.normal());
        writeln!(text, "{t:.2},{q1:.4},{q2:.4},{u1:.6},{u2:.6}")?;
    }
    let path = folder.join("log.csv");
    write(&path, &text)?;
    Ok(path)
}

/// All of it or nothing: the generator reads what is written here.
fn write(path: &Path, text: &str) -> Outcome<()> {
    write_whole(path, text).map_err(|e| format!("{}: {e}", path.display()).into())
}
