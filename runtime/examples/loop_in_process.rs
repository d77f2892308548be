//! Runs the control loop in real time with a simulated robot in the same process, for 3 s at 200 Hz with a log.
//!
//! ```text
//! cargo run --release -p gelenk-runtime --example loop_in_process
//! ```
//!
//! Ctrl-C stops the arm on its path and engages the brakes. `GELENK_EXAMPLE_SHORT=1` shortens the motion to 0.4 s.

use gelenk_runtime::control_loop::{
    ControlLoop, FeedForwardPd, JointGains, JointPd, LoopSettings, MonotonicClock, RealtimeRequest,
    StopRequest, log_to_file,
};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::RestToRest;
use gelenk_runtime::transport::InProcess;
use outcome::Outcome;
use std::process::ExitCode;

#[path = "support/outcome.rs"]
mod outcome;

gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);

const RATE: f64 = 200.0;

fn main() -> ExitCode {
    outcome::end(run())
}

fn run() -> Outcome<()> {
    let short = std::env::var_os("GELENK_EXAMPLE_SHORT").is_some();
    let (start, end) = ([-0.2, 0.3], [0.2, 0.0]);
    let motion = RestToRest::new(start, end, 3.0)?;
    // The short motion covers a seventh of the distance at the same speed.
    let motion = if short { RestToRest::new(start, [-0.14, 0.26], 0.4)? } else { motion };

    let settings = LoopSettings {
        position_limits: [[-1.0, 1.0]; 2],
        // A machine without real-time scheduling misses more deadlines.
        hold_periods: 20,
        ..LoopSettings::for_robot(RATE, &PowerCube)
    };
    let gains = JointGains::from_bandwidth(&PowerCube, &start, 10.0, 0.7);
    let law = JointPd::new(PowerCube, gains)?;
    let period = settings.period();
    let controller = FeedForwardPd::new(law.clone(), motion, period.as_secs_f64(), 0.01)?;

    let options = PlantOptions {
        encoder_resolution: [1e-4; 2],
        input_limits: [[-0.5, 0.5]; 2],
        ..PlantOptions::default()
    };
    let mut plant = Plant::new(PowerCube, options)?;
    plant.reset(start, [0.0; 2])?;
    let robot = InProcess::new(plant, MonotonicClock, period);

    let path = std::env::temp_dir().join("gelenk_loop_in_process.csv");
    let (sink, log) = log_to_file(&path, &PowerCube, 10_000)?;
    let mut control = ControlLoop::new(settings, law, motion, controller, robot, MonotonicClock)?
        .with_log(sink)
        .with_stop_request(StopRequest::on_signals()?);
    println!("{}", RealtimeRequest::default().apply());

    let report = control.run();
    println!("{report}");
    let (positions, _) = control.transport().plant().state();
    println!("the arm is at {positions:.4?} rad");
    drop(control);
    let summary = log.finish()?;
    println!("{} records in {}", summary.written, path.display());
    Ok(())
}
