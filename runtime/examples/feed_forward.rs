//! Simulates the PowerCube along its published trajectory with feed-forward alone. The model is exact. The program shows how the
//! arm drifts without feedback.
//!
//!     cargo run --release -p gelenk-runtime --example feed_forward [FOLDER]
//!
//! The program writes a page of plots to FOLDER. The default is a folder for temporary files.

use gelenk_runtime::dynamics::Dynamics;
use gelenk_runtime::feed_forward::FeedForward;
use gelenk_runtime::limits::{Rating, violations};
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{Columns, Recording, Smoothing, Trajectory};
use outcome::Outcome;
use plots::{Folder, figure, over_time};
use std::process::ExitCode;

#[path = "support/outcome.rs"]
mod outcome;
#[path = "support/plots.rs"]
mod plots;

gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);

const PERIOD: f64 = 0.02;

fn main() -> ExitCode {
    outcome::end(run())
}

fn run() -> Outcome<()> {
    let folder = Folder::from_arguments("feed_forward")?;
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/powercube_trajectory.csv");
    let columns = Columns { time: "t", positions: ["y1", "y2"], velocities: Some(["v1", "v2"]) };
    let recording = Recording::open(path, &columns)?;
    println!("steps that contradict their velocities by more than 0.1 mrad:");
    for found in recording.inconsistencies(1e-4) {
        println!(
            "  {:6.2} s, joint {}: {:+.2} mrad",
            found.time,
            PowerCube.joint_names()[found.coordinate],
            1e3 * found.defect
        );
    }
    let smoothed = recording.smoothed(&Smoothing::of(PERIOD))?;
    println!("smoothed, it goes {:.1?} mrad from the file", smoothed.position_deviation.map(|d| 1e3 * d));
    drive(&folder, &smoothed.trajectory)
}

fn drive(folder: &Folder, motion: &impl Trajectory<2>) -> Outcome<()> {
    for violation in violations(motion, PowerCube, Rating::Peak, PERIOD)? {
        println!("  {violation}");
    }
    let inputs = FeedForward::new(PowerCube)?.along(motion, PERIOD, 1e-6)?;
    let mut plots = Vec::new();
    let runs = [("from its start", 0.0), ("from 1 mrad beside its start", 1e-3)];
    for (label, offset) in runs {
        let mut plant = Plant::new(PowerCube, PlantOptions::default())?;
        plant.reset(motion.sample(0.0).positions.map(|y| y + offset), [0.0; 2])?;
        let mut errors = [Vec::new(), Vec::new()];
        for (k, u) in inputs.iter().enumerate() {
            plant.apply(u, PERIOD)?;
            let time = (k + 1) as f64 * PERIOD;
            let desired = motion.sample(time).positions;
            for i in 0..2 {
                errors[i].push([time, 1e3 * (plant.state().0[i] - desired[i])]);
            }
        }
        let largest = errors.each_ref().map(|e| e.iter().fold(0.0_f64, |m, p| m.max(p[1].abs())));
        println!("feed-forward alone, {label}: leaves by {largest:.1?} mrad");
        plots.push(over_time(
            &format!("error {label}"),
            "mrad",
            PowerCube.joint_names().into_iter().zip(errors),
        ));
    }
    let caption = "PowerCube, feed-forward alone at 50 Hz, with the exact model.";
    folder.write("Feed-forward alone", vec![figure("errors", caption, plots)])
}
