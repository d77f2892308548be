//! Simulates a quadruped (Unitree Go2) whose trunk follows a motion while its feet stand. The controller uses inverse dynamics with
//! given wrenches at the feet.
//!
//! ```sh
//! cargo run --release -p gelenk-runtime --example trunk [FOLDER]
//! ```
//!
//! The simulation has no ground. In each period the controller chooses the forces at the feet, and these forces act on the simulated
//! robot. This represents a real ground if the forces press and are within the friction cones. The program checks this condition
//! and the limits of the joints. In each period:
//!
//! 1. The acceleration of the trunk is the desired acceleration plus feedback of `y_d ⊖ y` and of the velocities. The accelerations
//!    of the legs keep the feet in place, `J v̇ + J̇ v = −k_p (p − p_0) − k_d ṗ`, with the position p of a foot and its place p_0.
//! 2. The feet must produce the six rows of the base in the inverse dynamics. Of the twelve forces, those with the smallest norm are
//!    chosen.
//! 3. The other rows of the inverse dynamics with these wrenches are the joint torques.
//!
//! The program prints a table and writes a page of plots to FOLDER. The default is a folder for temporary files.

use gelenk_generated::go2::{self as robot, M, N, NY, WRENCHES};
use nalgebra::{Matrix3, Vector3};
use outcome::Outcome;
use plots::{Folder, figure, over_time};
use quadruped::{
    FEET, FRICTION, Jacobian, Wrenches, at_feet, standing, used_friction, used_torque, within_limits,
};
use std::process::ExitCode;

#[path = "support/outcome.rs"]
mod outcome;
#[path = "support/plots.rs"]
mod plots;
#[path = "support/quadruped.rs"]
mod quadruped;

const PERIOD: f64 = 0.001;
/// Number of simulation steps in a period.
const STEPS: u32 = 2;
/// Duration of the motion [s].
const DURATION: f64 = 6.0;
/// Feedback gains of the trunk for position and velocity [1/s², 1/s].
const GAINS: [f64; 2] = [100.0, 20.0];
/// Feedback gains of the feet for position and velocity [1/s², 1/s]. They are larger because legs are light.
const STIFF: [f64; 2] = [1e4, 200.0];
/// Lateral force that pushes the trunk [N]. The controller does not know the force.
const PUSH: f64 = 15.0;
/// Interval of the push [s].
const PUSHED: std::ops::Range<f64> = 4.0..4.2;

#[derive(Debug, Clone, Copy)]
struct State {
    y: [f64; NY],
    v: [f64; N],
}

/// Desired pose of the trunk, which moves in all six directions.
fn desired(time: f64) -> [f64; NY] {
    let s = time.clamp(0.0, 1.0);
    let grown = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
    let wave = |period: f64| grown * (std::f64::consts::TAU * time / period).sin();
    let mut d = [0.0; N];
    d[..6].copy_from_slice(&[
        0.02 * wave(1.5),
        0.04 * wave(2.0),
        0.02 * wave(1.0),
        0.2 * wave(2.0),
        0.1 * wave(1.5),
        0.15 * wave(3.0),
    ]);
    robot::integrate(&standing(), &d)
}

/// Desired velocity and acceleration, computed by differences (⊖) over a millisecond.
fn desired_rates(time: f64) -> [[f64; 6]; 2] {
    let h = 1e-3;
    let at = desired(time);
    let [ahead, back] = [h, -h].map(|h| robot::difference(&at, &desired(time + h)));
    [
        std::array::from_fn(|i| (ahead[i] - back[i]) / (2.0 * h)),
        std::array::from_fn(|i| (ahead[i] + back[i]) / (h * h)),
    ]
}

/// Accelerations of trunk and legs, and Jacobians of the positions of the feet.
fn accelerations(
    time: f64,
    State { y, v }: &State,
    places: &[[f64; 3]; 4],
) -> Outcome<([f64; N], [Jacobian; 4])> {
    let error = robot::difference(y, &desired(time));
    let [velocity, acceleration] = desired_rates(time);
    let mut a = [0.0; N];
    for i in 0..6 {
        a[i] = acceleration[i] + GAINS[0] * error[i] + GAINS[1] * (velocity[i] - v[i]);
    }
    let jacobians = FEET.map(|foot| (foot.jacobian)(y));
    for (k, (foot, j)) in FEET.iter().zip(&jacobians).enumerate() {
        let (place, rate) = ((foot.pose)(y).0, (foot.rate)(y, v));
        let wanted = Vector3::from_fn(|i, _| {
            let moved = j[i].iter().zip(v).map(|(j, v)| j * v).sum::<f64>();
            let trunk = (0..6).map(|c| j[i][c] * a[c]).sum::<f64>();
            -STIFF[0] * (place[i] - places[k][i]) - STIFF[1] * moved - rate[i] - trunk
        });
        let leg = Matrix3::from_fn(|i, c| j[i][6 + 3 * k + c]);
        let joints = leg.lu().solve(&wanted).ok_or("a leg is stretched")?;
        a[6 + 3 * k..9 + 3 * k].copy_from_slice(joints.as_slice());
    }
    Ok((a, jacobians))
}

/// Joint torques and wrenches of a period.
fn control(time: f64, state: &State, places: &[[f64; 3]; 4]) -> Outcome<([f64; M], Wrenches)> {
    let (a, jacobians) = accelerations(time, state, places)?;
    let inverse = |w| robot::inverse_dynamics_with_wrenches(&state.y, &state.v, &a, w);
    let wrenches = at_feet(&inverse(&[[0.0; 6]; WRENCHES]), &jacobians, [1.0; 4])?;
    let rows = inverse(&wrenches);
    // Only the wrenches at the feet move the base, so the remaining rows must be zero.
    if rows[..6].iter().any(|row| row.abs() > 1e-9) {
        return Err("the wrenches at the feet do not move the trunk as wanted".into());
    }
    Ok((std::array::from_fn(|i| rows[6 + i]), wrenches))
}

/// Simulates the robot over a period with given torques and wrenches, by the midpoint rule with ⊕.
fn advance(State { mut y, mut v }: State, u: &[f64; M], w: &Wrenches) -> State {
    let h = PERIOD / f64::from(STEPS);
    let add = |v: &[f64; N], a: &[f64; N], h: f64| std::array::from_fn(|i| v[i] + h * a[i]);
    for _ in 0..STEPS {
        let a = robot::forward_dynamics_with_wrenches(&y, &v, u, w);
        let middle = robot::integrate(&y, &v.map(|v| 0.5 * h * v));
        let velocity: [f64; N] = add(&v, &a, 0.5 * h);
        let a = robot::forward_dynamics_with_wrenches(&middle, &velocity, u, w);
        y = robot::integrate(&y, &velocity.map(|v| h * v));
        v = add(&v, &a, h);
    }
    State { y, v }
}

#[derive(Debug, Clone, Copy)]
struct Record {
    time: f64,
    /// Position error [m] and attitude error [rad] of the trunk.
    errors: [f64; 2],
    /// Largest distance of a foot from its place [m].
    slip: f64,
    /// Vertical forces at the feet [N].
    pressing: [f64; 4],
    /// Largest ratio of tangential force to available friction at a foot.
    friction: f64,
    torques: [f64; M],
}

fn length(of: &[f64]) -> f64 {
    of.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn record(time: f64, y: &[f64; NY], u: &[f64; M], w: &Wrenches, places: &[[f64; 3]; 4]) -> Record {
    let error = robot::difference(&desired(time), y);
    let slip = FEET.iter().zip(places).map(|(foot, place)| {
        let at = (foot.pose)(y).0;
        length(&[at[0] - place[0], at[1] - place[1], at[2] - place[2]])
    });
    Record {
        time,
        errors: [length(&error[..3]), length(&error[3..6])],
        slip: slip.fold(0.0, f64::max),
        pressing: std::array::from_fn(|k| w[k][2]),
        friction: w[..4].iter().map(used_friction).fold(0.0, f64::max),
        torques: *u,
    }
}

fn run() -> Outcome<Vec<Record>> {
    let mut state = State { y: standing(), v: [0.0; N] };
    let places = FEET.map(|foot| (foot.pose)(&state.y).0);
    let mut records = Vec::new();
    for k in 0..(DURATION / PERIOD).round() as u32 {
        let time = PERIOD * f64::from(k);
        let (u, mut w) = control(time, &state, &places)?;
        within_limits(&state.y, &state.v, &u).map_err(|error| format!("at {time:.3} s {error}"))?;
        if PUSHED.contains(&time) {
            w[4][1] = PUSH;
        }
        state = advance(state, &u, &w);
        records.push(record(time + PERIOD, &state.y, &u, &w, &places));
    }
    Ok(records)
}

/// Prints a row of the table.
///
/// # Errors
/// An error if an error of the trunk exceeds `bound` [m and rad], or if a foot would lift or slide.
fn report(what: &str, records: &[Record], bound: f64) -> Outcome<()> {
    let most = |value: &dyn Fn(&Record) -> f64| records.iter().map(value).fold(0.0, f64::max);
    let [distance, angle] = [0, 1].map(|k| most(&|record| record.errors[k]));
    let least = records.iter().flat_map(|record| record.pressing).fold(f64::INFINITY, f64::min);
    let friction = most(&|record| record.friction);
    let slip = most(&|record| record.slip);
    println!(
        "{what:<12} {distance:>9.1e} {angle:>9.1e} {slip:>11.1e} {least:>12.1} {friction:>12.2} {:>9.1} {:>10.2}",
        most(&|record| record.torques.iter().fold(0.0, |most, u| most.max(u.abs()))),
        most(&|record| used_torque(&record.torques))
    );
    if distance.max(angle).max(slip) > bound {
        return Err(format!("{what}: the trunk is further off than {bound:e}").into());
    }
    if least <= 0.0 || friction > 1.0 {
        return Err(format!("{what}: a foot would not stand").into());
    }
    Ok(())
}

fn plot(folder: &Folder, records: &[Record]) -> Outcome<()> {
    let points = |value: &dyn Fn(&Record) -> f64| -> Vec<[f64; 2]> {
        records.iter().map(|record| [record.time, value(record)]).collect()
    };
    let error = |k: usize| [("error", points(&|record| 1e3 * record.errors[k]))];
    let feet = robot::WRENCH_NAMES[..4].iter().copied().enumerate();
    let pressing = feet.clone().map(|(k, name)| (name, points(&|record| record.pressing[k])));
    let calves = feet.map(|(k, name)| (name, points(&|record| record.torques[3 * k + 2])));
    let plots = [
        over_time("distance", "mm", error(0)),
        over_time("angle", "mrad", error(1)),
        over_time("pressing", "N", pressing),
        over_time("torque of the calf", "N m", calves),
    ];
    folder.write("The trunk of a Go2", vec![figure("trunk", "It is pushed at 4 s.", plots)])
}

fn main() -> ExitCode {
    outcome::end(program())
}

fn program() -> Outcome<()> {
    let folder = Folder::from_arguments("trunk")?;
    let records = run()?;
    println!(
        "                largest error of the        feet: [m]     pressing   used friction   torque  of limits"
    );
    println!(
        "             trunk [m]     [rad]        from place    least [N]    of {FRICTION} [1]    [N m]       [1]"
    );
    let (undisturbed, pushed) =
        records.split_at(records.partition_point(|record| record.time < PUSHED.start));
    report("motion", undisturbed, 1e-3)?;
    report("with a push", pushed, 5e-2)?;
    report("at the end", &records[records.len() - 10..], 1e-3)?;
    plot(&folder, &records)
}
