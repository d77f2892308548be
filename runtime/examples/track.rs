//! The PowerCube along its published trajectory at 50 Hz: feed-forward alone, linear time-varying MPC,
//! nonlinear MPC.
//!
//! ```sh
//! cargo run --release -p gelenk-runtime --example track [FOLDER]
//! ```
//!
//! Prints a table and writes plots into FOLDER (`target/track`). `GELENK_EXAMPLE_SHORT=1` runs the first
//! three seconds.

use gelenk_runtime::control_loop::{Command, Controller, ControllerFault, Cycle};
use gelenk_runtime::feed_forward::FeedForward;
use gelenk_runtime::mpc::{LinearizationPoint, LtvMpc, MpcOptions, Nmpc};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{Columns, Recording, Sampled, Smoothing, Trajectory};
use outcome::Outcome;
use plotters::prelude::*;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[path = "support/outcome.rs"]
mod outcome;

gelenk_runtime::dynamics!(
    /// The controllers' model, and the plant's.
    struct PowerCube = gelenk_generated::powercube: Discretizable []
);

const PERIOD: f64 = 0.02;
const HORIZON: usize = 20;
/// Peak torque of the motors [N m].
const PEAK: f64 = 0.5;
const JOINTS: [&str; 2] = ["beta", "gamma"];

/// No feedback at all.
struct FeedForwardAlone<'t> {
    feed_forward: FeedForward<PowerCube, 2, 2>,
    reference: &'t Sampled<2>,
}

impl Controller<2, 2> for FeedForwardAlone<'_> {
    fn reset(&mut self, _: &[f64; 2], _: &[f64; 2]) {}

    fn step(&mut self, cycle: &Cycle<2, 2>) -> Result<Command<2>, ControllerFault> {
        let inputs = self.feed_forward.at(&self.reference.sample(cycle.time));
        Ok(Command { inputs: inputs.inputs.map(|u| u.clamp(-PEAK, PEAK)), iterations: 0 })
    }
}

/// What happened along a trajectory.
struct Run {
    name: &'static str,
    reference: &'static str,
    positions: Vec<[f64; 2]>,
    errors: Vec<[f64; 2]>,
    inputs: Vec<[f64; 2]>,
}

fn run(
    name: &'static str,
    reference: (&'static str, &Sampled<2>),
    steps: usize,
    controller: &mut impl Controller<2, 2>,
) -> Outcome<Run> {
    let (reference_name, reference) = reference;
    let options = PlantOptions { input_limits: [[-PEAK, PEAK]; 2], ..PlantOptions::default() };
    let mut plant = Plant::new(PowerCube, options)?;
    let start = reference.sample(0.0);
    plant.reset(start.positions, start.velocities)?;
    let mut last = FeedForward::new(PowerCube)?.at(&start).inputs;
    controller.reset(&start.positions, &last);
    let mut run = Run { name, reference: reference_name, positions: vec![], errors: vec![], inputs: vec![] };
    for k in 0..steps {
        let time = k as f64 * PERIOD;
        let command = controller.step(&Cycle {
            time,
            periods: u32::from(k > 0),
            positions: Some(plant.measure().positions),
            last_inputs: last,
            ..Cycle::default()
        })?;
        last = command.inputs;
        plant.apply(&last, PERIOD)?;
        let (y, _) = plant.state();
        let desired = reference.sample(time + PERIOD).positions;
        run.positions.push(y);
        run.errors.push(core::array::from_fn(|i| y[i] - desired[i]));
        run.inputs.push(last);
    }
    Ok(run)
}

fn print_table(runs: &[Run]) {
    println!(
        "                                 rms error [mrad]      largest error [mrad]  largest torque [N m]"
    );
    println!("controller         reference      beta       gamma      beta       gamma      beta   gamma");
    for run in runs {
        let count = run.errors.len() as f64;
        let rms = [0, 1].map(|i| {
            let sum: f64 = run.errors.iter().map(|e| e[i] * e[i]).sum();
            1e3 * (sum / count).sqrt()
        });
        let largest =
            |values: &[[f64; 2]]| [0, 1].map(|i| values.iter().fold(0.0_f64, |max, v| max.max(v[i].abs())));
        let (error, torque) = (largest(&run.errors).map(|e| 1e3 * e), largest(&run.inputs));
        println!(
            "{:<18} {:<10} {:>10.4} {:>10.4}  {:>10.4} {:>10.4}      {:.3}   {:.3}",
            run.name, run.reference, rms[0], rms[1], error[0], error[1], torque[0], torque[1]
        );
    }
}

/// One curve of a plot: name for the legend, colour, width, a value per period.
type Curve<'c> = (&'c str, RGBColor, u32, Vec<f64>);

/// Two panels, one for each joint.
fn plot(path: &Path, title: &str, unit: &str, panels: [Vec<Curve<'_>>; 2]) -> Outcome<()> {
    let area = SVGBackend::new(path, (900, 640)).into_drawing_area();
    area.fill(&WHITE)?;
    let area = area.titled(title, ("sans-serif", 20))?;
    for (panel, (joint, curves)) in area.split_evenly((2, 1)).iter().zip(JOINTS.iter().zip(panels)) {
        let all = || curves.iter().flat_map(|c| c.3.iter().copied());
        let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
        let span = (high - low).max(1e-9);
        // Room for the legend above the curves.
        let range = low - 0.05 * span..high + 0.4 * span;
        let end = curves.iter().map(|c| c.3.len()).max().unwrap_or(1) as f64 * PERIOD;
        let mut chart = ChartBuilder::on(panel)
            .margin(8)
            .x_label_area_size(32)
            .y_label_area_size(70)
            .build_cartesian_2d(0.0..end, range)?;
        chart
            .configure_mesh()
            .x_desc("time [s]")
            .y_desc(format!("{joint} [{unit}]"))
            .light_line_style(WHITE)
            // Adding zero makes a rounded −0 a 0.
            .y_label_formatter(&|v| format!("{}", (v * 1e3).round() / 1e3 + 0.0))
            .draw()?;
        for (name, colour, width, values) in curves {
            let points = values.into_iter().enumerate().map(|(k, v)| ((k + 1) as f64 * PERIOD, v));
            let line = chart.draw_series(LineSeries::new(points, colour.stroke_width(width)))?;
            if !name.is_empty() {
                line.label(name).legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour));
            }
        }
        chart
            .configure_series_labels()
            .background_style(WHITE.mix(0.8))
            .border_style(BLACK)
            .position(SeriesLabelPosition::UpperRight)
            .draw()?;
    }
    area.present()?;
    Ok(())
}

fn joint(values: &[[f64; 2]], i: usize, scale: f64) -> Vec<f64> {
    values.iter().map(|v| scale * v[i]).collect()
}

fn draw(folder: &Path, reference: &Sampled<2>, runs: &[Run]) -> Outcome<()> {
    const COLOURS: [RGBColor; 4] =
        [RGBColor(200, 60, 40), RGBColor(30, 90, 200), RGBColor(40, 140, 60), RGBColor(170, 170, 170)];
    let steps = runs[0].positions.len();
    let desired: Vec<[f64; 2]> = reference.samples()[1..=steps].iter().map(|s| s.positions).collect();
    plot(
        &folder.join("positions.svg"),
        "Positions: desired, with feed-forward alone along the file, with LTV-MPC",
        "rad",
        [0, 1].map(|i| {
            vec![
                ("feed-forward, file", COLOURS[0], 1, joint(&runs[3].positions, i, 1.0)),
                ("desired", COLOURS[3], 4, joint(&desired, i, 1.0)),
                ("LTV-MPC", COLOURS[1], 1, joint(&runs[1].positions, i, 1.0)),
            ]
        }),
    )?;
    plot(
        &folder.join("errors.svg"),
        "Errors along the smoothed trajectory",
        "mrad",
        [0, 1].map(|i| {
            let curve = |r: usize| (runs[r].name, COLOURS[r], 1, joint(&runs[r].errors, i, 1e3));
            vec![curve(0), curve(1), curve(2)]
        }),
    )?;
    plot(
        &folder.join("errors_mpc.svg"),
        "Errors of the predictive controllers along the smoothed trajectory",
        "microrad",
        [0, 1].map(|i| {
            let curve = |r: usize| (runs[r].name, COLOURS[r], 1, joint(&runs[r].errors, i, 1e6));
            vec![curve(1), curve(2)]
        }),
    )?;
    plot(
        &folder.join("torques.svg"),
        "Motor torques of LTV-MPC, and their limits",
        "N m",
        [0, 1].map(|i| {
            vec![
                ("LTV-MPC", COLOURS[1], 1, joint(&runs[1].inputs, i, 1.0)),
                ("peak torque", COLOURS[0], 1, vec![PEAK; steps]),
                ("", COLOURS[0], 1, vec![-PEAK; steps]),
            ]
        }),
    )
}

fn main() -> ExitCode {
    outcome::end(compare())
}

fn compare() -> Outcome<()> {
    let folder = std::env::args().nth(1).map_or_else(|| PathBuf::from("target/track"), PathBuf::from);
    std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let columns = Columns { time: "t", positions: ["y1", "y2"], velocities: Some(["v1", "v2"]) };
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/data/powercube_trajectory.csv");
    let recording = Recording::<2>::open(data, &columns)?;
    let (smoothed, file) = (recording.smoothed(&Smoothing::of(PERIOD))?.trajectory, recording.raw()?);
    let short = std::env::var_os("GELENK_EXAMPLE_SHORT").is_some();
    let steps = if short { 150 } else { smoothed.samples().len() - 1 };

    let mut options = MpcOptions::new(&PowerCube, PERIOD, HORIZON);
    options.velocity_weight = [5.0, 3.5];
    options.linearization = LinearizationPoint::Reference;
    let mut runs = vec![];
    for reference in [("smoothed", &smoothed), ("file", &file)] {
        let mut alone =
            FeedForwardAlone { feed_forward: FeedForward::new(PowerCube)?, reference: reference.1 };
        runs.push(run("feed-forward", reference, steps, &mut alone)?);
        let mut ltv = LtvMpc::new(PowerCube, reference.1, options.clone())?;
        runs.push(run("LTV-MPC", reference, steps, &mut ltv)?);
        let mut nmpc = Nmpc::new(PowerCube, reference.1, options.clone())?;
        runs.push(run("NMPC", reference, steps, &mut nmpc)?);
    }
    print_table(&runs);
    draw(&folder, &smoothed, &runs)?;
    println!("plots in {}", folder.display());
    Ok(())
}
