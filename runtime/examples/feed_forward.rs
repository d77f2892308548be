//! Feed-forward alone: the PowerCube along its published trajectory, with the exact model, and where it goes
//! without feedback.
//!
//!     cargo run --release -p gelenk-runtime --example feed_forward [FOLDER]
//!
//! Reads the trajectory from the folder `GELENK_SHARED`, or `../shared` beside the repository; without it a
//! motion over the top is driven.

use gelenk_runtime::dynamics::Dynamics;
use gelenk_runtime::feed_forward::FeedForward;
use gelenk_runtime::plant::{Plant, PlantOptions};
use gelenk_runtime::trajectory::{Columns, Rating, Recording, RestToRest, Smoothing, Trajectory, violations};
use outcome::Outcome;
use std::path::PathBuf;
use std::process::ExitCode;
use support::{Folder, Line};

#[path = "support/outcome.rs"]
mod outcome;
#[path = "support/motion_plot.rs"]
mod support;

gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);

const PERIOD: f64 = 0.02;

fn main() -> ExitCode {
    outcome::end(run())
}

fn run() -> Outcome<()> {
    let folder = Folder::from_arguments()?;
    let path = std::env::var_os("GELENK_SHARED")
        .map_or_else(|| PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared")), PathBuf::from)
        .join("reference/powercube/trajectory.csv");
    if !path.exists() {
        println!("{} is not there: a motion over the top instead", path.display());
        let motion = RestToRest::new([-0.9, -0.5], [0.9, 0.5], 6.0)?;
        return drive(&folder, &motion);
    }
    let columns = Columns { time: "t", positions: ["y1", "y2"], velocities: Some(["v1", "v2"]) };
    let recording = Recording::open(&path, &columns)?;
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
    let mut panels = Vec::new();
    let runs = [
        ("from its start", "error from its start [mrad]", 0.0),
        ("from 1 mrad beside its start", "error from 1 mrad beside [mrad]", 1e-3),
    ];
    for (label, axis, offset) in runs {
        let mut plant = Plant::new(PowerCube, PlantOptions::default())?;
        plant.reset(motion.sample(0.0).positions.map(|y| y + offset), [0.0; 2])?;
        let mut errors = [Vec::new(), Vec::new()];
        for (k, u) in inputs.iter().enumerate() {
            plant.apply(u, PERIOD)?;
            let time = (k + 1) as f64 * PERIOD;
            let desired = motion.sample(time).positions;
            for i in 0..2 {
                errors[i].push((time, 1e3 * (plant.state().0[i] - desired[i])));
            }
        }
        let largest = errors.each_ref().map(|e| e.iter().fold(0.0_f64, |m, p| m.max(p.1.abs())));
        println!("feed-forward alone, {label}: leaves by {largest:.1?} mrad");
        let lines = errors
            .into_iter()
            .zip(["beta", "gamma"])
            .map(|(points, name)| Line { name: name.to_owned(), points })
            .collect();
        panels.push((axis, lines));
    }
    folder.lines("feed_forward.svg", "PowerCube, feed-forward alone, 50 Hz, exact model", &panels)
}
