//! Simulates the robot of `robot.toml` under control. If its inputs can carry its weight, for example those of a quadrotor, a
//! predictive controller moves it to another pose. Otherwise it falls, and a PD law holds the posture of its joints.

use std::error::Error;
use std::process::ExitCode;

use gelenk_runtime::control_loop::{Controller, Cycle, JointGains};
use gelenk_runtime::dynamics::{Dynamics, plain_entries};
use gelenk_runtime::feed_forward::FeedForward;
use gelenk_runtime::mpc::{LtvMpc, MpcOptions};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{GeodesicMotion, Sample, Trajectory};

gelenk_runtime::include_model!(
    /// The equations of motion, written by the build script.
    mod robot
);
gelenk_runtime::dynamics!(
    /// The robot.
    pub struct Robot = robot
);

/// Positions of the base (x y z and the quaternion x y z w), then those of the joints.
type Positions = [f64; robot::NY];
/// Velocities of the base (linear and angular, in the axes of the base), then those of the joints.
type Velocities = [f64; robot::N];
type Inputs = [f64; robot::M];

/// Period of the predictive controller in s.
const PERIOD: f64 = 0.02;
/// Number of periods that the predictive controller looks ahead.
const HORIZON: usize = 20;
/// Number of periods between two printed lines.
const PRINTED: u32 = 10;
/// Period of the PD law in s. Joints with little inertia need a short period.
const FAST: f64 = 1e-3;
/// Number of periods of the PD law between two printed lines.
const FAST_PRINTED: u32 = 200;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    let home = home();
    match missing(&home) {
        None => {
            println!("The inputs can carry the robot: it moves by predictive control.");
            carry(&home)
        }
        Some(why) => {
            println!("The inputs cannot carry the robot: it falls, and its joints are held.");
            println!("{why}");
            fall(&home)
        }
    }
}

/// Returns the reason why the inputs cannot hold the robot at rest; `None` if they can hold it.
fn missing(home: &Positions) -> Option<String> {
    let hold = match FeedForward::new(Robot) {
        Ok(forward) => forward.at(&Sample::at_rest(*home)),
        Err(why) => return Some(why.to_string()),
    };
    let missed = hold.residual;
    if length(&missed) > 1e-6 {
        return Some(format!(
            "To hold the robot at rest, the inputs lack a force of {:.4?} N and a moment of {:.4?} N m in the axes of the base.",
            &missed[..3],
            &missed[3..6]
        ));
    }
    let limits = Robot.input_limits().peak;
    let all = robot::INPUT_NAMES.iter().zip(&hold.inputs).zip(&limits);
    let mut beyond = all.filter(|((_, input), [low, high])| *input < low || *input > high);
    beyond.next().map(|((name, input), [low, high])| {
        format!("To hold the robot at rest, the input {name} must be {input:.4}, but its limits are {low} and {high}.")
    })
}

/// Positions with the base at the origin and each joint at 0, or at the position within its limits nearest to 0.
fn home() -> Positions {
    let (mut home, limits) = (Robot.neutral(), Robot.limits().position);
    for (joint, position) in plain_entries(Robot.quaternion_joints(), robot::N) {
        let [low, high] = limits[joint];
        home[position] = 0.0_f64.max(low).min(high);
    }
    home
}

/// Simulates predictive control. From a tilted pose away from its path, the robot rises by 1 m and turns by 1 rad within 3 s.
fn carry(home: &Positions) -> Result<(), Box<dyn Error>> {
    let goal = Robot.integrate(home, &base([0.0, 0.0, 1.0, 0.0, 0.0, 1.0]));
    let start = Robot.integrate(home, &base([0.3, -0.2, 0.0, 0.3, 0.2, 0.0]));
    let motion = GeodesicMotion::between(Robot, *home, goal, 3.0)?;
    let options = MpcOptions::new(&Robot, PERIOD, HORIZON);
    let mut controller = LtvMpc::new(Robot, motion.clone(), options)?;
    for note in controller.notes() {
        println!("note: {note}");
    }
    let mut plant = plant(start)?;
    let mut last_inputs = [0.0; robot::M];
    controller.reset(&start, &last_inputs);
    println!("{:>8}  {:>16}  inputs", "t [s]", "from its way [1]");
    for k in 0..=200 {
        let time = f64::from(k) * PERIOD;
        let cycle = Cycle {
            time,
            periods: u32::from(k > 0),
            positions: Some(plant.measure().positions),
            last_inputs,
            ..Cycle::default()
        };
        last_inputs = controller.step(&cycle)?.inputs;
        if k % PRINTED == 0 {
            // The norm combines metres and radians.
            let desired = motion.sample(time).positions;
            let error = length(&Robot.difference(&desired, &plant.state().0));
            println!("{time:8.3}  {error:16.6}  {}", row(&last_inputs));
        }
        plant.apply(&last_inputs, PERIOD)?;
    }
    Ok(())
}

/// Simulates a PD law. The joints return to their posture while the base falls.
fn fall(home: &Positions) -> Result<(), Box<dyn Error>> {
    let mut away = [0.0; robot::N];
    for (joint, _) in plain_entries(Robot.quaternion_joints(), robot::N) {
        away[joint] = -0.2;
    }
    let gains = JointGains::from_bandwidth(&Robot, home, 20.0, 1.0);
    let mut plant = plant(Robot.integrate(home, &away))?;
    println!(
        "{:>8}  {:>16}  positions of the base",
        "t [s]", "from posture [1]"
    );
    for k in 0..=1000 {
        let (y, v) = plant.state();
        if k % FAST_PRINTED == 0 {
            let joints = plain_entries(Robot.quaternion_joints(), robot::N);
            let error: Vec<f64> = joints
                .map(|(_, position)| y[position] - home[position])
                .collect();
            println!(
                "{:8.3}  {:16.6}  {}",
                f64::from(k) * FAST,
                length(&error),
                row(&y[..3])
            );
        }
        plant.apply(&joint_pd(home, &gains, &y, &v), FAST)?;
    }
    Ok(())
}

/// Inputs of a PD law that returns the joints to their posture, within the limits. Replace this function by your controller.
fn joint_pd(
    home: &Positions,
    gains: &JointGains<{ robot::N }>,
    y: &Positions,
    v: &Velocities,
) -> Inputs {
    let (error, mut forces) = (Robot.difference(y, home), [0.0; robot::N]);
    for (joint, _) in plain_entries(Robot.quaternion_joints(), robot::N) {
        forces[joint] = gains.position[joint] * error[joint] - gains.velocity[joint] * v[joint];
    }
    let wanted = FeedForward::new(Robot).map(|forward| forward.inputs_for(y, &forces));
    let limits = Robot.input_limits().peak;
    let wanted = wanted.unwrap_or([0.0; robot::M]);
    core::array::from_fn(|i| wanted[i].clamp(limits[i][0], limits[i][1]))
}

fn plant(
    start: Positions,
) -> Result<Plant<Robot, { robot::N }, { robot::M }, { robot::NY }>, Box<dyn Error>> {
    let options = PlantOptions {
        input_limits: Robot.input_limits().peak,
        ..PlantOptions::default()
    };
    let mut plant = Plant::new(Robot, options)?;
    plant.reset(start, [0.0; robot::N])?;
    Ok(plant)
}

/// Velocities with a linear and angular motion of the base, and the joints at rest.
fn base(of_base: [f64; 6]) -> Velocities {
    let mut motion = [0.0; robot::N];
    motion[..6].copy_from_slice(&of_base);
    motion
}

fn length(entries: &[f64]) -> f64 {
    entries.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn row(entries: &[f64]) -> String {
    let entries: Vec<String> = entries.iter().map(|x| format!("{x:10.4}")).collect();
    entries.join(" ")
}
