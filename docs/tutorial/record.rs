//! Moves the arm along plan.csv and writes log.csv.

use std::error::Error;
use std::process::ExitCode;

use gelenk_runtime::control_loop::{
    ControlLoop, FeedForwardPd, JointGains, JointPd, LoopSettings, VirtualClock, log_to_file,
};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{Columns, Recording, Trajectory};
use gelenk_runtime::transport::InProcess;

gelenk_runtime::include_model!(mod arm);
gelenk_runtime::include_model!(mod robot);
gelenk_runtime::dynamics!(struct Arm = arm);
gelenk_runtime::dynamics!(struct Robot = robot);

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
    let columns =
        Columns { time: "t", positions: ["q_beta", "q_gamma"], velocities: Some(["dq_beta", "dq_gamma"]) };
    let motion = Recording::<2>::open("plan.csv", &columns)?.raw()?;
    let start = motion.sample(0.0).positions;

    let settings = LoopSettings::for_robot(200.0, &Robot);
    let clock = VirtualClock::new();
    let options = PlantOptions { encoder_resolution: [1e-5; 2], ..PlantOptions::default() };
    let mut plant = Plant::new(Arm, options)?;
    plant.reset(start, [0.0; 2])?;
    let robot = InProcess::new(plant, clock.clone(), settings.period());

    let gains = JointGains::from_bandwidth(&Robot, &start, 20.0, 0.7);
    let law = JointPd::new(Robot, gains)?;
    let controller = FeedForwardPd::new(law.clone(), motion.clone(), 0.005, 0.01)?;
    let (sink, log) = log_to_file("log.csv".as_ref(), &Robot, 100_000)?;
    let control = ControlLoop::new(settings, law, motion, controller, robot, clock)?;
    let mut control = control.with_log(sink);
    println!("{}", control.run());
    drop(control);
    println!("{} records in log.csv", log.finish()?.written);
    Ok(())
}
