//! Simulates a satellite with three reaction wheels and predictive control. In the first run it slews while a boom swings on a ball
//! joint. In the second run it comes to rest after tumbling. No input can change the total momentum. Hull and wheels only exchange
//! momentum.
//!
//! ```sh
//! cargo run --release -p gelenk-runtime --example satellite [FOLDER]
//! ```
//!
//! The program prints a table and writes a page of plots to FOLDER. The default is a folder for temporary files.
//! `GELENK_EXAMPLE_SHORT=1` only simulates the first seconds.

use gelenk_report::Figure;
use gelenk_runtime::dynamics::Dynamics;
use gelenk_runtime::mpc::{LtvMpc, MpcOptions, ObserverOptions, TerminalWeight};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{GeodesicMotion, Trajectory};
use nalgebra::{Matrix6, Quaternion, UnitQuaternion, Vector3, Vector6};
use outcome::Outcome;
use plots::{Folder, figure, over_time};
use std::process::ExitCode;

#[path = "support/outcome.rs"]
mod outcome;
#[path = "support/plots.rs"]
mod plots;
#[path = "support/simulated.rs"]
mod simulated;

gelenk_runtime::dynamics!(struct Satellite = gelenk_generated::satellite);

type Motion = GeodesicMotion<Satellite, 12, 3, 14>;

const PERIOD: f64 = 0.1;
const HORIZON: usize = 30;
/// First indices of groups of velocities. The order is linear velocity of the hull, angular velocity of the hull, wheels, boom.
const TURN: usize = 3;
const WHEELS: usize = 6;
const BOOM: usize = 9;

/// Velocities d of all joints while the hull rotates about `axis` without total momentum, with the boom at rest relative to the
/// hull. The six rows of the base in `M d` are zero. The unknowns are the linear velocity of the hull and the wheel speeds.
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

/// Slew of 150° about an oblique axis. The floating joint makes a screw motion, and M does not change while the boom is at rest
/// relative to the hull. Therefore the momentum is zero at all times.
fn slew() -> Outcome<Motion> {
    let angle = 150.0_f64.to_radians();
    let way = turning([0.48, -0.64, 0.6])?.map(|d| d * angle);
    let start = Satellite.neutral();
    Ok(Motion::between(Satellite, start, Satellite.integrate(&start, &way), 40.0)?)
}

/// Angular momentum [N m s] about the origin in the axes of the world. It follows from the rows of the base in `M v`.
fn angular_momentum(y: &[f64; 14], v: &[f64; 12]) -> [f64; 3] {
    let m = Satellite.mass_matrix(y);
    let row = |i: usize| m[i].iter().zip(v).map(|(m, v)| m * v).sum::<f64>();
    let attitude = UnitQuaternion::from_quaternion(Quaternion::new(y[6], y[3], y[4], y[5]));
    let [linear, angular] = [0, TURN].map(|first| attitude * Vector3::from_fn(|i, _| row(first + i)));
    (angular + Vector3::new(y[0], y[1], y[2]).cross(&linear)).into()
}

/// State at the end of a period.
struct Row {
    time: f64,
    /// Angle between the hull and its desired attitude [rad].
    error: f64,
    velocities: [f64; 12],
    /// Angle of the boom from its middle [rad].
    boom: f64,
    torques: [f64; 3],
    momentum: [f64; 3],
}

fn length(of: &[f64]) -> f64 {
    of.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn options() -> MpcOptions<12, 3> {
    let mut options = MpcOptions {
        // Only the attitude and angular velocity of the hull and the motion of the boom have weights. All other motions follow
        // from the momentum, which no input can change.
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

fn run(motion: &Motion, velocities: [f64; 12], duration: f64) -> Outcome<Vec<Row>> {
    let mut controller = LtvMpc::new(Satellite, motion.clone(), options())?;
    let limits = Satellite.input_limits().peak;
    let mut plant = Plant::new(Satellite, PlantOptions { input_limits: limits, ..PlantOptions::default() })?;
    plant.reset(motion.sample(0.0).positions, velocities)?;
    let steps = (duration / PERIOD).ceil() as u32;
    let periods = simulated::run(&mut plant, &mut controller, [0.0; 3], PERIOD, steps)?;
    let row = |period: simulated::Period<12, 3, 14>| {
        let (y, v) = (period.positions, period.velocities);
        let d = Satellite.difference(&motion.sample(period.time).positions, &y);
        Row {
            time: period.time,
            error: length(&d[TURN..WHEELS]),
            velocities: v,
            boom: length(&Satellite.difference(&Satellite.neutral(), &y)[BOOM..]),
            torques: period.inputs,
            momentum: angular_momentum(&y, &v),
        }
    };
    Ok(periods.into_iter().map(row).collect())
}

/// Prints the row of a run.
///
/// # Errors
/// An error if the run does not end at rest, or if the momentum changed.
fn report(what: &str, rows: &[Row], end: f64) -> Outcome<()> {
    let most =
        |value: &dyn Fn(&Row) -> f64| rows.iter().fold(0.0, |most: f64, row| most.max(value(row).abs()));
    let largest = |values: &[f64]| values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let (first, left) = (rows[0].momentum, rows[rows.len() - 1].error);
    let change = most(&|row| length(&[0, 1, 2].map(|i| row.momentum[i] - first[i])));
    println!(
        "{what:<8} {:>9.1e} {left:>9.1e} {:>9.3} {:>10.1} {:>10.3} {:>10.3} {change:>10.0e}",
        most(&|row| row.error),
        most(&|row| row.boom),
        most(&|row| largest(&row.velocities[WHEELS..BOOM])),
        most(&|row| largest(&row.torques)),
        length(&first),
    );
    if left <= end && change <= 1e-9 { Ok(()) } else { Err("the hull did not come to rest".into()) }
}

fn plot(id: &str, caption: &str, rows: &[Row]) -> Figure {
    let points = |value: &dyn Fn(&Row) -> f64| -> Vec<[f64; 2]> {
        rows.iter().map(|row| [row.time, value(row)]).collect()
    };
    let angle = |value: fn(&Row) -> f64| [("angle", points(&value))];
    let three =
        |value: fn(&Row, usize) -> f64| [0, 1, 2].map(|i| (["x", "y", "z"][i], points(&|row| value(row, i))));
    let plots = [
        over_time("error of the hull", "rad", angle(|row| row.error)),
        over_time("boom", "rad", angle(|row| row.boom)),
        over_time("hull", "rad/s", three(|row, i| row.velocities[TURN + i])),
        over_time("wheels", "rad/s", three(|row, i| row.velocities[WHEELS + i])),
        over_time("torque", "N m", three(|row, i| row.torques[i])),
    ];
    figure(id, caption, plots)
}

fn main() -> ExitCode {
    outcome::end(program())
}

fn program() -> Outcome<()> {
    let folder = Folder::from_arguments("satellite")?;
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
    let figures = vec![
        plot("tumbling", "The wheels take up the momentum of the hull.", &rest),
        plot("slew", "A slew by 150°, while the boom swings.", &slewed),
    ];
    folder.write("A satellite with reaction wheels", figures)
}
