//! Runs prepared by a plain filter: cubic polynomials in the same window over positions and torques (Savitzky and Golay 1964).

use super::super::super::run::{Effort, PreparedRun};
use nalgebra::DMatrix;
use std::path::PathBuf;

/// A file of the data folder next to the checkout, or `None` with a printed note.
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
    }
}

/// Smooths and differentiates positions and smooths efforts over `window` samples. Ten samples at each end are removed.
pub(super) fn prepare(
    name: &str,
    times: &[f64],
    positions: &[Vec<f64>],
    efforts: &[Vec<f64>],
    window: usize,
) -> PreparedRun {
    let half = window / 2;
    let inner = half..times.len() - half;
    let step = (times[times.len() - 1] - times[0]) / (times.len() - 1) as f64;
    let powers = DMatrix::from_fn(window, 4, |i, k| ((i as f64 - half as f64) * step).powi(k as i32));
    let weights = powers.pseudo_inverse(1e-12).unwrap();
    let smooth = |column: &Vec<f64>, order: usize| -> Vec<f64> {
        let at = |window: &[f64]| weights.row(order).iter().zip(window).map(|(w, x)| w * x).sum::<f64>();
        column.windows(window).map(|window| [1.0, 1.0, 2.0][order] * at(window)).collect()
    };
    let moved = |order: usize| positions.iter().map(|column| smooth(column, order)).collect::<Vec<_>>();
    let cut = |column: &[f64]| column[inner.clone()].to_vec();
    PreparedRun {
        poses: Vec::new(),
        resting: Vec::new(),
        name: name.into(),
        times: cut(times),
        rows: inner.clone().map(|i| i + 2).collect(),
        positions: moved(0),
        velocities: moved(1),
        accelerations: moved(2),
        efforts: efforts.iter().map(|column| smooth(column, 0)).collect(),
        effort: Effort::Joint,
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
    }
}
