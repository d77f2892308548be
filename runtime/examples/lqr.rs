//! Compares LQR and joint PD for the axis α of the PowerCube in the control loop at 50 Hz. Prints gains, stability margins and
//! errors.
//!
//! ```text
//! cargo run --release -p gelenk-runtime --example lqr
//! ```

use gelenk_runtime::control_loop::{
    ControlLoop, End, JointGains, JointLaw, JointLqr, JointPd, LawController, LoopSettings, LqrWeights,
    VirtualClock,
};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::RestToRest;
use gelenk_runtime::transport::InProcess;
use outcome::Outcome;
use std::process::ExitCode;

#[path = "support/outcome.rs"]
mod outcome;

gelenk_runtime::dynamics!(struct Alpha = gelenk_generated::powercube_alpha);

fn main() -> ExitCode {
    outcome::end(run())
}

fn run() -> Outcome<()> {
    let period = LoopSettings::for_robot(50.0, &Alpha).period().as_secs_f64();
    // Deviations of 20 mrad, 0.2 rad/s and 0.2 N m have the same cost.
    let weights = LqrWeights::from_deviations([0.02], [0.2], [0.2]);
    let lqr = JointLqr::new(Alpha, &[0.0], period, weights)?;
    let [[position, velocity]] = lqr.regulator().gain;
    println!("LQR: u = u_ff {position:+.2} N m/rad (y - y_d) {velocity:+.2} N m s/rad (v - v_d)");
    println!("     {}", lqr.regulator().margins());
    let pd = JointPd::new(Alpha, JointGains::from_bandwidth(&Alpha, &[0.0], 10.0, 0.7))?;
    for (name, error) in [("LQR", follow(lqr, pd.clone())?), ("joint PD", follow(pd.clone(), pd)?)] {
        println!("{name:8} rests {:.3} mrad from the end of the motion", 1e3 * error);
    }
    Ok(())
}

/// Returns the distance (rad) from the goal after a motion. The arm starts 50 mrad away from the start of the motion, and the
/// encoder has a resolution of 0.1 mrad.
fn follow(law: impl JointLaw<1, 1>, fallback: JointPd<Alpha, 1, 1>) -> Outcome<f64> {
    let motion = RestToRest::new([0.0], [0.8], 2.0)?;
    let settings = LoopSettings { settling_time: 1.0, ..LoopSettings::for_robot(50.0, &Alpha) };
    let controller = LawController::new(law, motion, settings.period().as_secs_f64(), 0.01)?;
    let options = PlantOptions { encoder_resolution: [1e-4], ..PlantOptions::default() };
    let mut plant = Plant::new(Alpha, options)?;
    plant.reset([0.01], [0.0])?;
    let clock = VirtualClock::new();
    let robot = InProcess::new(plant, clock.clone(), settings.period());
    let mut control = ControlLoop::new(settings, fallback, motion, controller, robot, clock)?;
    let report = control.run();
    if report.end != End::Finished {
        return Err(format!("{report}").into());
    }
    Ok((control.transport().plant().state().0[0] - 0.8).abs())
}
