//! A satellite with three reaction wheels slews by predictive control while a boom swings on a ball joint, and comes to
//! rest after it tumbled. No input reaches its momentum: hull and wheels exchange it.
//!
//! ```sh
//! cargo run --release -p gelenk-runtime --example satellite [FOLDER]
//! ```
//!
//! Prints a table and writes plots into FOLDER (the folder for temporary files). `GELENK_EXAMPLE_SHORT=1` computes the first
//! seconds alone.

use gelenk_runtime::control_loop::{Controller, Cycle};
use gelenk_runtime::dynamics::Dynamics;
use gelenk_runtime::mpc::{LtvMpc, MpcOptions, ObserverOptions, TerminalWeight};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{GeodesicMotion, Trajectory};
use nalgebra::{Matrix6, Quaternion, UnitQuaternion, Vector3, Vector6};
use outcome::Outcome;
use std::process::ExitCode;
use support::{Folder, Line};

#[path = "support/outcome.rs"]
mod outcome;
#[path = "support/motion_plot.rs"]
mod support;

gelenk_runtime::dynamics!(struct Satellite = gelenk_generated::satellite);

type Motion = GeodesicMotion<Satellite, 12, 3, 14>;

const PERIOD: f64 = 0.1;
const HORIZON: usize = 30;
/// Of the velocities: those of the hull (linear, angular), then wheels and boom.
const TURN: usize = 3;
const WHEELS: usize = 6;
const BOOM: usize = 9;

/// The motion of all joints while the hull turns about `axis`, with the boom at rest on it and without momentum: the
/// base's six rows of `M d` are zero. The unknowns are the hull's linear velocity and the wheels' speeds.
fn turning(axis: [f64; 3]) -> Outcome<[f64; 12]> {
    let m = Satellite.mass_matrix(&Satellite.neutral());
    let unknown = |k: usize| if k < TURN { k } else { WHEELS + k - TURN };
    let columns = Matrix6::from_fn(|i, k| m[i][unknown(k)]);
    let turn = Vector6::from_fn(|i, _| -(0..3).map(|k| m[i][TURN + k] * axis[k]).sum::<f64>());
    let solution = columns.lu().solve(&turn).ok_or("the wheels cannot take up this momentum")?;
    let mut d = [0.0; 12];
    d[TURN..WHEELS].copy_from_slice(&axis);
    for k in 0..6 {
        d[unknown(k)] = solution[k];
    }
    Ok(d)
}

/// By 150° about an oblique axis. A floating joint moves on a screw, M does not change while the boom rests on the hull,
/// so that there is no momentum at any time.
fn slew() -> Outcome<Motion> {
    let angle = 150.0_f64.to_radians();
    let way = turning([0.48, -0.64, 0.6])?.map(|d| d * angle);
    let start = Satellite.neutral();
    Ok(Motion::between(Satellite, start, Satellite.integrate(&start, &way), 40.0)?)
}

/// Angular momentum [N m s] about the origin, in the axes of the world: that of the base's rows of `M v`, shifted.
fn angular_momentum(y: &[f64; 14], v: &[f64; 12]) -> [f64; 3] {
    let m = Satellite.mass_matrix(y);
    let row = |i: usize| m[i].iter().zip(v).map(|(m, v)| m * v).sum::<f64>();
    let attitude = UnitQuaternion::from_quaternion(Quaternion::new(y[6], y[3], y[4], y[5]));
    let [linear, angular] = [0, TURN].map(|first| attitude * Vector3::from_fn(|i, _| row(first + i)));
    (angular + Vector3::new(y[0], y[1], y[2]).cross(&linear)).into()
}

#[derive(Default)]
struct Run {
    time: Vec<f64>,
    /// Angle between the hull and its desired attitude [rad].
    errors: Vec<f64>,
    velocities: Vec<[f64; 12]>,
    /// Angle of the boom from its middle [rad].
    boom: Vec<f64>,
    torques: Vec<[f64; 3]>,
    momenta: Vec<[f64; 3]>,
}

fn length(of: &[f64]) -> f64 {
    of.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn options() -> MpcOptions<12, 3> {
    let mut options = MpcOptions {
        // Only the hull's attitude and its rate are asked for, and that the boom swings little. All else follows
        // from the momentum, which no input reaches.
        position_weight: [0.0; 12],
        velocity_weight: [0.0; 12],
        input_weight: [1.0; 3],
        terminal_weight: TerminalWeight::Discounted { time_constant: 60.0 },
        observer: ObserverOptions { velocity_sensor_noise: Some([1e-5; 12]), ..ObserverOptions::default() },
        ..MpcOptions::new(&Satellite, PERIOD, HORIZON)
    };
    options.position_weight[TURN..WHEELS].fill(1.0);
    options.velocity_weight[TURN..WHEELS].fill(10.0);
    options.velocity_weight[BOOM..].fill(0.1);
    options
}

fn run(motion: &Motion, velocities: [f64; 12], duration: f64) -> Outcome<Run> {
    let mut controller = LtvMpc::new(Satellite, motion.clone(), options())?;
    let limits = Satellite.input_limits().peak;
    let mut plant = Plant::new(Satellite, PlantOptions { input_limits: limits, ..PlantOptions::default() })?;
    let start = motion.sample(0.0).positions;
    plant.reset(start, velocities)?;
    let mut last_inputs = [0.0; 3];
    controller.reset(&start, &last_inputs);
    let mut run = Run::default();
    for k in 0..(duration / PERIOD).ceil() as u32 {
        let time = PERIOD * f64::from(k);
        let command = controller.step(&Cycle {
            time,
            periods: u32::from(k > 0),
            positions: Some(plant.measure().positions),
            velocities: Some(plant.state().1),
            last_inputs,
            ..Cycle::default()
        })?;
        last_inputs = command.inputs;
        plant.apply(&last_inputs, PERIOD)?;
        let (y, v) = plant.state();
        let d = Satellite.difference(&motion.sample(time + PERIOD).positions, &y);
        run.time.push(time + PERIOD);
        run.errors.push(length(&d[TURN..WHEELS]));
        run.velocities.push(v);
        run.boom.push(length(&Satellite.difference(&Satellite.neutral(), &y)[BOOM..]));
        run.torques.push(last_inputs);
        run.momenta.push(angular_momentum(&y, &v));
    }
    Ok(run)
}

fn most(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |most, value| most.max(value.abs()))
}

/// Prints the row of a run.
///
/// # Errors
/// Where it does not end at rest, or where the momentum changed.
fn report(what: &str, run: &Run, end: f64) -> Outcome<()> {
    let first = run.momenta.first().copied().unwrap_or_default();
    let drift = run.momenta.iter().map(|h| length(&[h[0] - first[0], h[1] - first[1], h[2] - first[2]]));
    let (left, change) = (run.errors.last().copied().unwrap_or_default(), most(drift));
    println!(
        "{what:<8} {:>9.1e} {:>9.1e} {:>9.3} {:>10.1} {:>10.3} {:>10.3} {:>10.0e}",
        most(run.errors.iter().copied()),
        left,
        most(run.boom.iter().copied()),
        most(run.velocities.iter().flat_map(|v| v[WHEELS..BOOM].to_vec())),
        most(run.torques.as_flattened().iter().copied()),
        length(&first),
        change,
    );
    if left <= end && change <= 1e-9 { Ok(()) } else { Err("the hull did not come to rest".into()) }
}

fn plot(folder: &Folder, file: &str, title: &str, run: &Run) -> Outcome<()> {
    let line = |name: &str, value: &dyn Fn(usize) -> f64| Line {
        name: name.to_owned(),
        points: run.time.iter().enumerate().map(|(k, &time)| (time, value(k))).collect(),
    };
    let three = |value: fn(&Run, usize, usize) -> f64| -> Vec<Line> {
        ["x", "y", "z"].iter().enumerate().map(|(i, name)| line(name, &|k| value(run, k, i))).collect()
    };
    folder.lines(
        file,
        title,
        &[
            ("error of the hull [rad]", vec![line("angle", &|k| run.errors[k])]),
            ("boom [rad]", vec![line("angle", &|k| run.boom[k])]),
            ("hull [rad/s]", three(|run, k, i| run.velocities[k][TURN + i])),
            ("wheels [rad/s]", three(|run, k, i| run.velocities[k][WHEELS + i])),
            ("torque [N m]", three(|run, k, i| run.torques[k][i])),
        ],
    )
}

fn main() -> ExitCode {
    outcome::end(program())
}

fn program() -> Outcome<()> {
    let folder = Folder::from_arguments()?;
    let short = std::env::var_os("GELENK_EXAMPLE_SHORT").is_some();
    println!("         error of the hull [rad]    boom     wheels     torque     momentum [N m s]");
    println!("            most   at the end      [rad]    [rad/s]      [N m]      start     change");
    let start = Satellite.neutral();
    let mut tumbling = [0.0; 12];
    tumbling[TURN..WHEELS].copy_from_slice(&[0.12, -0.08, 0.1]);
    let still = Motion::between(Satellite, start, start, 1.0)?;
    let rest = run(&still, tumbling, if short { 1.0 } else { 60.0 })?;
    report("tumbling", &rest, if short { 0.5 } else { 1e-6 })?;
    if short {
        return Ok(());
    }
    let slewed = run(&slew()?, [0.0; 12], 60.0)?;
    report("slew", &slewed, 1e-5)?;
    plot(&folder, "satellite_tumbling.svg", "The wheels take up the momentum of the hull", &rest)?;
    plot(&folder, "satellite_slew.svg", "A slew by 150°, the boom swings", &slewed)
}
