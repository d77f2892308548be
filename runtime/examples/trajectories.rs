//! Computes desired motions for the PowerCube and the Puma 560, checks each motion against the limits of the model, and plots them.
//!
//!     cargo run --release -p gelenk-runtime --example trajectories [FOLDER]
//!
//! The program writes a page of plots to FOLDER. The default is a folder for temporary files.

use gelenk_generated::puma560;
use gelenk_report::Figure;
use gelenk_runtime::kinematics::SphericalWrist;
use gelenk_runtime::limits::{Rating, violations};
use gelenk_runtime::trajectory::{
    Along, IdentificationSine, MotionLimits, PointSequence, RestToRest, Trajectory, ViaPoints, straight_ways,
};
use outcome::Outcome;
use plots::Folder;
use std::process::ExitCode;

#[path = "support/outcome.rs"]
mod outcome;
#[path = "support/plots.rs"]
mod plots;

gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);

const JOINTS: [&str; 2] = gelenk_generated::powercube::JOINT_NAMES;

fn main() -> ExitCode {
    outcome::end(run())
}

fn run() -> Outcome<()> {
    let folder = Folder::from_arguments("trajectories")?;
    let [stops, way] = points()?;
    folder.write("Motions", vec![rest_to_rest()?, identification()?, stops, way, cartesian()?])
}

/// Fastest motion within 60 % of 25 rpm, from one leaning position over the upright position to another.
fn rest_to_rest() -> Outcome<Figure> {
    let speeds = [0.6 * 2.618; 2];
    let motion = RestToRest::within([-0.6, -0.4], [0.7, 0.5], &speeds, &[4.0; 2], 0.1)?;
    report("rest to rest", &motion)?;
    Ok(plots::motion("rest_to_rest", "PowerCube, rest to rest", &motion, JOINTS))
}

/// Identification sine at both joints with β = −γ (compensated motion).
fn identification() -> Outcome<Figure> {
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
    Ok(plots::motion("identification_sine", "Identification sine, beta = −gamma", &motion, JOINTS))
}

fn points() -> Outcome<[Figure; 2]> {
    let points = [[0.0, 0.0], [0.4, 0.6], [-0.3, 0.9], [0.0, 0.0]];
    let motion = PointSequence::within(&points, &[0.5; 2], &[2.0; 2], 0.3)?;
    report("four points", &motion)?;
    let stops = plots::motion("points", "PowerCube, four points", &motion, JOINTS);
    let limits = MotionLimits { speeds: [0.5; 2], accelerations: [2.0; 2], ..MotionLimits::default() };
    let motion = ViaPoints::within(&points, &limits)?;
    report("four points without a stop", &motion)?;
    Ok([stops, plots::motion("via_points", "PowerCube, four points without a stop", &motion, JOINTS)])
}

/// Motion of the Puma's tool along two straight lines, computed by inverse kinematics.
fn cartesian() -> Outcome<Figure> {
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
    Ok(plots::motion("straight_ways", "Puma 560, straight there and back", &motion, puma560::JOINT_NAMES))
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
