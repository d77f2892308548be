//! Runs prepared by a plain filter: the same Savitzky–Golay window over positions and torques.

use super::super::super::differentiation::SavitzkyGolay;
use super::super::super::run::{DesiredMotion, Effort, PreparedRun};
use std::path::PathBuf;

/// A file of the data folder beside the checkout, or `None` with a printed note.
pub(super) fn shared(path: &str) -> Option<PathBuf> {
    let folder =
        std::env::var_os("GELENK_SHARED").map_or_else(|| PathBuf::from("../../../shared"), PathBuf::from);
    let file = folder.join(path);
    if file.exists() {
        return Some(file);
    }
    println!("skipped: there is no {}", file.display());
    None
}

/// A run whose motion needs no filter.
///
/// - `columns`: positions, velocities, accelerations and efforts
pub(super) fn as_simulated(times: Vec<f64>, columns: [Vec<Vec<f64>>; 4], effort: Effort) -> PreparedRun {
    let [positions, velocities, accelerations, efforts] = columns;
    PreparedRun {
        poses: Vec::new(),
        resting: Vec::new(),
        name: "simulated".into(),
        rows: (2..times.len() + 2).collect(),
        times,
        positions,
        velocities,
        accelerations,
        efforts,
        effort,
        desired: None,
    }
}

/// Smooths and differentiates positions and smooths efforts over `window` samples; ten samples at each end go.
pub(super) fn prepare(
    name: &str,
    times: &[f64],
    positions: &[Vec<f64>],
    efforts: &[Vec<f64>],
    window: usize,
) -> PreparedRun {
    let filter = SavitzkyGolay::with_window(window, 3);
    let inner = window / 2..times.len() - window / 2;
    let smooth = |column: &Vec<f64>| filter.differentiate(times, column).unwrap();
    let moved: Vec<_> = positions.iter().map(smooth).collect();
    let cut = |column: &[f64]| column[inner.clone()].to_vec();
    PreparedRun {
        poses: Vec::new(),
        resting: Vec::new(),
        name: name.into(),
        times: cut(times),
        rows: inner.clone().map(|i| i + 2).collect(),
        positions: moved.iter().map(|d| cut(&d.value)).collect(),
        velocities: moved.iter().map(|d| cut(&d.first)).collect(),
        accelerations: moved.iter().map(|d| cut(&d.second)).collect(),
        efforts: efforts.iter().map(|e| cut(&smooth(e).value)).collect(),
        effort: Effort::Joint,
        desired: None,
    }
}

/// Part of a run.
pub(super) fn part(run: &PreparedRun, rows: std::ops::Range<usize>) -> PreparedRun {
    let cut = |columns: &[Vec<f64>]| columns.iter().map(|c| c[rows.clone()].to_vec()).collect::<Vec<_>>();
    PreparedRun {
        poses: Vec::new(),
        resting: run.resting.iter().map(|rests| rests[rows.clone()].to_vec()).collect(),
        name: run.name.clone(),
        times: run.times[rows.clone()].to_vec(),
        rows: run.rows[rows.clone()].to_vec(),
        positions: cut(&run.positions),
        velocities: cut(&run.velocities),
        accelerations: cut(&run.accelerations),
        efforts: cut(&run.efforts),
        effort: run.effort,
        desired: run.desired.as_ref().map(|desired| DesiredMotion {
            positions: cut(&desired.positions),
            velocities: cut(&desired.velocities),
            accelerations: cut(&desired.accelerations),
        }),
    }
}
