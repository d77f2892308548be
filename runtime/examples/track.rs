//! Compares feed-forward alone, linear time-varying MPC and nonlinear MPC for the PowerCube along its published trajectory at 50 Hz.
//!
//! ```sh
//! cargo run --release -p gelenk-runtime --example track [FOLDER]
//! ```
//!
//! The program prints a table and writes a page of plots to FOLDER. `GELENK_EXAMPLE_SHORT=1` only simulates the first three seconds.

use gelenk_report::Plot;
use gelenk_runtime::control_loop::{Command, Controller, ControllerFault, Cycle};
use gelenk_runtime::feed_forward::FeedForward;
use gelenk_runtime::mpc::{LinearizationPoint, LtvMpc, MpcOptions, Nmpc};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{Columns, Recording, Sampled, Smoothing, Trajectory};
use outcome::Outcome;
use plots::{Folder, figure, over_time};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[path = "support/outcome.rs"]
mod outcome;
#[path = "support/plots.rs"]
mod plots;
#[path = "support/simulated.rs"]
mod simulated;

gelenk_runtime::dynamics!(
    /// Model of the controllers and of the plant.
    struct PowerCube = gelenk_generated::powercube: Discretizable []
);

const PERIOD: f64 = 0.02;
const HORIZON: usize = 20;
/// Peak torque of the motors [N m].
const PEAK: f64 = 0.5;
const JOINTS: [&str; 2] = ["beta", "gamma"];

/// Controller without feedback.
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

/// Recorded motion along a trajectory.
struct Run {
    name: &'static str,
    reference: &'static str,
    periods: Vec<Period>,
    errors: Vec<[f64; 2]>,
}

type Period = simulated::Period<2, 2>;

fn run(
    name: &'static str,
    reference: (&'static str, &Sampled<2>),
    steps: u32,
    controller: &mut impl Controller<2, 2>,
) -> Outcome<Run> {
    let (reference_name, reference) = reference;
    let options = PlantOptions { input_limits: [[-PEAK, PEAK]; 2], ..PlantOptions::default() };
    let mut plant = Plant::new(PowerCube, options)?;
    let start = reference.sample(0.0);
    plant.reset(start.positions, start.velocities)?;
    let last = FeedForward::new(PowerCube)?.at(&start).inputs;
    let periods = simulated::run(&mut plant, controller, last, PERIOD, steps)?;
    let error = |period: &Period| {
        let desired = reference.sample(period.time).positions;
        [0, 1].map(|i| period.positions[i] - desired[i])
    };
    let errors = periods.iter().map(error).collect();
    Ok(Run { name, reference: reference_name, periods, errors })
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
        let largest = |value: &dyn Fn(usize) -> f64| (0..run.errors.len()).map(value).fold(0.0, f64::max);
        let error = [0, 1].map(|i| 1e3 * largest(&|k| run.errors[k][i].abs()));
        let torque = [0, 1].map(|i| largest(&|k| run.periods[k].inputs[i].abs()));
        println!(
            "{:<18} {:<10} {:>10.4} {:>10.4}  {:>10.4} {:>10.4}      {:.3}   {:.3}",
            run.name, run.reference, rms[0], rms[1], error[0], error[1], torque[0], torque[1]
        );
    }
}

fn draw(folder: &Folder, reference: &Sampled<2>, runs: &[Run]) -> Outcome<()> {
    let points = |run: &Run, value: &dyn Fn(usize) -> f64| -> Vec<[f64; 2]> {
        run.periods.iter().enumerate().map(|(k, period)| [period.time, value(k)]).collect()
    };
    let [ltv, file] = [&runs[1], &runs[3]];
    let position = |run: &Run, i: usize| points(run, &|k| run.periods[k].positions[i]);
    let joints = |plot: &dyn Fn(usize) -> Plot| [0, 1].map(plot);
    let positions = joints(&|i| {
        let desired = points(ltv, &|k| reference.sample(ltv.periods[k].time).positions[i]);
        let lines =
            [("feed-forward, file", position(file, i)), ("desired", desired), ("LTV-MPC", position(ltv, i))];
        over_time(JOINTS[i], "rad", lines)
    });
    let errors = |first: usize, unit: &str, scale: f64| {
        let line = |run: &Run, i: usize| (run.name, points(run, &|k| scale * run.errors[k][i]));
        joints(&|i| over_time(JOINTS[i], unit, runs[first..3].iter().map(|run| line(run, i))))
    };
    let torques = joints(&|i| {
        let torque = points(ltv, &|k| ltv.periods[k].inputs[i]);
        let limit = |sign: f64| points(ltv, &|_| sign * PEAK);
        let lines = [("LTV-MPC", torque), ("peak torque", limit(1.0)), ("its negative", limit(-1.0))];
        over_time(JOINTS[i], "N m", lines)
    });
    let figures = vec![
        figure(
            "positions",
            "Positions: desired, with feed-forward alone along the file, with LTV-MPC.",
            positions,
        ),
        figure("errors", "Errors along the smoothed trajectory.", errors(0, "mrad", 1e3)),
        figure(
            "errors-mpc",
            "Errors of the predictive controllers along the smoothed trajectory.",
            errors(1, "µrad", 1e6),
        ),
        figure("torques", "Motor torques of LTV-MPC, and their limits.", torques),
    ];
    folder.write("The PowerCube along its published trajectory", figures)
}

fn main() -> ExitCode {
    outcome::end(compare())
}

fn compare() -> Outcome<()> {
    let folder = std::env::args().nth(1).map_or_else(|| PathBuf::from("target/track"), PathBuf::from);
    let folder = Folder::made(folder)?;
    let columns = Columns { time: "t", positions: ["y1", "y2"], velocities: Some(["v1", "v2"]) };
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/data/powercube_trajectory.csv");
    let recording = Recording::<2>::open(data, &columns)?;
    let (smoothed, file) = (recording.smoothed(&Smoothing::of(PERIOD))?.trajectory, recording.raw()?);
    let short = std::env::var_os("GELENK_EXAMPLE_SHORT").is_some();
    let steps = if short { 150 } else { smoothed.samples().len() as u32 - 1 };

    let mut options = MpcOptions::new(&PowerCube, PERIOD, HORIZON);
    options.velocity_weight = [5.0, 3.5];
    options.linearization = LinearizationPoint::Reference;
    // As in the paper, disturbances are not estimated.
    options.observer.disturbance_noise = [0.0; 2];
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
    draw(&folder, &smoothed, &runs)
}
