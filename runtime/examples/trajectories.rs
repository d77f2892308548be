//! Desired motions for the PowerCube and the Puma 560, each checked against the model's limits, and their
//! plots.
//!
//!     cargo run --release -p gelenk-runtime --example trajectories [FOLDER]
//!
//! Plots go to FOLDER, by default a folder beside the build's output.

use gelenk_generated::puma560;
use gelenk_runtime::kinematics::SphericalWrist;
use gelenk_runtime::trajectory::{
    Along, IdentificationSine, MotionLimits, PointSequence, Rating, RestToRest, Trajectory, ViaPoints,
    straight_ways, violations,
};
use outcome::Outcome;
use std::process::ExitCode;
use support::Folder;

#[path = "support/outcome.rs"]
mod outcome;
#[path = "support/motion_plot.rs"]
mod support;

gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);

fn main() -> ExitCode {
    outcome::end(run())
}

fn run() -> Outcome<()> {
    let folder = Folder::from_arguments()?;
    rest_to_rest(&folder)?;
    identification(&folder)?;
    points(&folder)?;
    cartesian(&folder)
}

/// As fast as a motion within 60 % of 25 rpm, from leaning to leaning over the top.
fn rest_to_rest(folder: &Folder) -> Outcome<()> {
    let speeds = [0.6 * 2.618; 2];
    let motion = RestToRest::within([-0.6, -0.4], [0.7, 0.5], &speeds, &[4.0; 2], 0.1)?;
    report("rest to rest", &motion)?;
    folder.plot("rest_to_rest.svg", "PowerCube, rest to rest", &motion, ["beta", "gamma"])
}

/// The identification sine on both joints, compensated: β = −γ.
fn identification(folder: &Folder) -> Outcome<()> {
    let sine = IdentificationSine {
        center: [0.0],
        amplitude: [0.5],
        first_frequency: [0.4],
        last_frequency: [0.9],
        sine_duration: if short() { 6.0 } else { 20.0 },
        run_in: 1.5,
    };
    let motion = Along::compensated([0.0, 0.0], sine.motion()?)?;
    report("identification sine, beta = -gamma", &motion)?;
    folder.plot("identification_sine.svg", "Identification sine, beta = -gamma", &motion, ["beta", "gamma"])
}

fn points(folder: &Folder) -> Outcome<()> {
    let points = [[0.0, 0.0], [0.4, 0.6], [-0.3, 0.9], [0.0, 0.0]];
    let motion = PointSequence::within(&points, &[0.5; 2], &[2.0; 2], 0.3)?;
    report("four points", &motion)?;
    folder.plot("points.svg", "PowerCube, four points", &motion, ["beta", "gamma"])?;
    let limits = MotionLimits { speeds: [0.5; 2], accelerations: [2.0; 2], ..MotionLimits::default() };
    let motion = ViaPoints::within(&points, &limits)?;
    report("four points without a stop", &motion)?;
    folder.plot("via_points.svg", "PowerCube, four points without a stop", &motion, ["beta", "gamma"])
}

/// The Puma's tool along two straight lines, by inverse kinematics.
fn cartesian(folder: &Folder) -> Outcome<()> {
    let arm = SphericalWrist::from_poses(puma560::frame_tool_pose)?;
    let start = [0.2, 0.5, -0.6, 0.1, 0.7, -0.2];
    let first = puma560::frame_tool_pose(&start);
    let solutions = arm.solve(&first, &start)?;
    println!("the Puma reaches its first pose in {} ways:", solutions.all().count());
    for solution in solutions.all() {
        println!("  {:8.4?}", solution.positions);
    }
    let aside = ([first.0[0] - 0.1, first.0[1] + 0.2, first.0[2] + 0.1], first.1);
    let motion = straight_ways(&arm, &start, &[aside, first], &[2.0, 2.0], 0.01)?;
    println!("straight ways: {:.2} s", motion.duration());
    folder.plot("straight_ways.svg", "Puma 560, straight there and back", &motion, puma560::JOINT_NAMES)
}

fn report(name: &str, motion: &impl Trajectory<2>) -> Outcome<()> {
    println!("{name}: {:.2} s", motion.duration());
    for violation in violations(motion, PowerCube, Rating::Peak, 0.01)? {
        println!("  {violation}");
    }
    Ok(())
}

fn short() -> bool {
    std::env::var_os("GELENK_EXAMPLE_SHORT").is_some()
}
