//! Moves the robot of `robot.toml` by feed-forward and PD, and learns its friction online. The simulated robot has 30 % less
//! friction than the description, for example because its gears are warm.

use std::error::Error;
use std::process::ExitCode;

use gelenk_runtime::adaptation::{AdaptationSettings, Adaptive};
use gelenk_runtime::control_loop::{Controller, Cycle, FeedForwardPd, JointGains, JointPd};
use gelenk_runtime::dynamics::Dynamics;
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{IdentificationSine, Sampled, Trajectory};

gelenk_runtime::include_model!(
    /// The equations of motion, written by the build script.
    mod robot
);
gelenk_runtime::dynamics!(
    /// The robot.
    pub struct Robot = robot
);

/// Period of the control in s.
const PERIOD: f64 = 0.01;
/// Duration of the motion in s.
const DURATION: f64 = 60.0;
/// Number of periods between two printed lines.
const PRINTED: u32 = 500;
/// Share of the described friction that the simulated robot lacks.
const LESS: f64 = 0.3;

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
    let motion = Sampled::of(&sine().motion()?, PERIOD)?;
    let start = motion.sample(0.0).positions;
    let gains = JointGains::from_bandwidth(&Robot, &start, 20.0, 0.8);
    let settings = AdaptationSettings::new(PERIOD);
    let mut controller = Adaptive::new(Robot, settings, |robot| -> Result<_, Box<dyn Error>> {
        let law = JointPd::new(robot, gains)?;
        Ok(FeedForwardPd::new(law, &motion, PERIOD, 0.01)?)
    })??;
    let mut plant = plant(start)?;
    let mut last_inputs = [0.0; robot::M];
    controller.reset(&start, &last_inputs);
    let joints = robot::JOINT_NAMES.map(|name| format!("{name:>26}"));
    println!("{:>8}  {}", "t [s]", joints.join("  "));
    for k in 0..(motion.duration() / PERIOD) as u32 {
        let cycle = Cycle {
            time: f64::from(k) * PERIOD,
            periods: u32::from(k > 0),
            positions: Some(plant.measure().positions),
            last_inputs,
            ..Cycle::default()
        };
        last_inputs = controller.step(&cycle)?.inputs;
        if k % PRINTED == 0 {
            let laws: [String; robot::N] = core::array::from_fn(|joint| law(&controller, joint));
            println!("{:8.3}  {}", cycle.time, laws.join("  "));
        }
        let (y, v) = plant.state();
        let missing = Robot.friction_torques(&y, &v).map(|torque| LESS * torque);
        plant.push(PERIOD, move |_| missing);
        plant.apply(&last_inputs, PERIOD)?;
    }
    println!("learned friction at {SPEED} rad/s or m/s, its 90 % interval, and the described friction");
    Ok(())
}

/// Speed at which friction is printed in rad/s or m/s.
const SPEED: f64 = 0.5;

/// Friction of a joint as text: the learned value ± half of its interval, then the described value.
fn law<C>(controller: &Adaptive<C, Robot, { robot::N }, { robot::M }>, joint: usize) -> String {
    let described = Robot.friction_torques(&Robot.neutral(), &[SPEED; robot::N])[joint];
    match controller.adaptation().friction(joint, described, SPEED) {
        Some([learned, half]) => format!("{learned:8.4} ± {half:<6.4} {described:8.4}"),
        None => format!("{described:>26.4}"),
    }
}

/// A motion about 0, or the nearest position within the limits, with another frequency at each joint.
fn sine() -> IdentificationSine<{ robot::N }> {
    let limits = Robot.limits().position;
    let amplitude = limits.map(|[low, high]| (0.25 * (high - low)).min(0.5));
    let nearest = |i: usize| {
        let [low, high] = limits[i];
        0.0_f64.max(low + amplitude[i]).min(high - amplitude[i])
    };
    let frequency = |i: usize| 0.2 + 0.05 * i as f64;
    IdentificationSine {
        center: core::array::from_fn(nearest),
        amplitude,
        first_frequency: core::array::from_fn(frequency),
        last_frequency: core::array::from_fn(|i| 1.5 * frequency(i)),
        sine_duration: DURATION,
        run_in: 2.0,
    }
}

type Simulated = Plant<Robot, { robot::N }, { robot::M }>;

fn plant(start: [f64; robot::N]) -> Result<Simulated, Box<dyn Error>> {
    let options = PlantOptions {
        encoder_resolution: [1e-4; robot::N],
        ..PlantOptions::default()
    };
    let mut plant = Plant::new(Robot, options)?;
    plant.reset(start, [0.0; robot::N])?;
    Ok(plant)
}
