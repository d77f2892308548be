//! Runs LTV-MPC on the arm with the guessed friction and with the identified friction.

use std::error::Error;
use std::process::ExitCode;

use gelenk_runtime::control_loop::{
    ControlLoop, JointGains, JointPd, LoopSettings, VirtualClock, log_to_file,
};
use gelenk_runtime::dynamics::Predictable;
use gelenk_runtime::mpc::{LtvMpc, MpcOptions};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{Columns, Recording, RestToRest, Trajectory};
use gelenk_runtime::transport::InProcess;

gelenk_runtime::include_model!(mod arm);
gelenk_runtime::include_model!(mod robot);
gelenk_runtime::include_model!(mod robot_identified_control);
gelenk_runtime::dynamics!(struct Arm = arm);
gelenk_runtime::dynamics!(struct Robot = robot);
gelenk_runtime::dynamics!(struct Identified = robot_identified_control);

/// Moves the arm by LTV-MPC, writes a log, and returns the largest tracking error in rad.
fn track<D>(model: D, path: &str) -> Result<f64, Box<dyn Error>>
where
    D: Predictable<2, 2, 4> + Copy,
{
    let start = [-0.4, 0.3];
    let motion = RestToRest::new(start, [0.4, -0.2], 4.0)?;
    let settings = LoopSettings::for_robot(50.0, &model);
    let clock = VirtualClock::new();
    let mut plant = Plant::new(Arm, PlantOptions::default())?;
    plant.reset(start, [0.0; 2])?;
    let robot = InProcess::new(plant, clock.clone(), settings.period());

    let options = MpcOptions::new(&model, 0.02, 20);
    let controller = LtvMpc::new(model, motion, options)?;
    let fallback = JointPd::new(model, JointGains::from_bandwidth(&model, &start, 10.0, 0.7))?;
    let (sink, log) = log_to_file(path.as_ref(), &model, 10_000)?;
    let control = ControlLoop::new(settings, fallback, motion, controller, robot, clock)?;
    let mut control = control.with_log(sink);
    println!("{}", control.run());
    drop(control);
    log.finish()?;

    let of =
        |positions| Recording::<2>::open(path, &Columns { time: "time", positions, velocities: None })?.raw();
    let (measured, desired) = (of(["q_beta", "q_gamma"])?, of(["desired_beta", "desired_gamma"])?);
    let error = |k: usize| {
        let [y, goal] = [&measured, &desired].map(|motion| motion.sample(0.02 * k as f64).positions);
        (y[0] - goal[0]).abs().max((y[1] - goal[1]).abs())
    };
    Ok((0..=200).map(error).fold(0.0, f64::max))
}

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
    let guessed = track(Robot, "guessed.csv")?;
    let identified = track(Identified, "identified.csv")?;
    println!("largest error: guessed {:.2} mrad, identified {:.2} mrad", 1e3 * guessed, 1e3 * identified);
    Ok(())
}
