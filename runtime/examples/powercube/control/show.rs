//! Axes and curves that several experiments draw in the same way.

use super::run::Run;
use crate::arm::{GEAR, JOINTS};
use gelenk_report::{Axis, Marks, Plot};

pub fn time() -> Axis {
    Axis::new("time", "s")
}

/// Plot of the torques of a controller and of the feed-forward of its model at a joint, over time.
pub fn torques(title: &str, run: &Run, i: usize) -> Plot {
    Plot::new(format!("joint {}, {title}", JOINTS[i]), time(), Axis::new("torque at the joint", "N m"))
        .series("LTV-MPC", Marks::Steps, run.points(|row| GEAR * row.inputs[i]))
        .series("feed-forward", Marks::Dashed, run.points(|row| GEAR * row.forward[i]))
}

/// Plot of the errors of both joints over time.
pub fn errors(title: &str, run: &Run) -> Plot {
    let plot = Plot::new(title, time(), Axis::new("error", "mrad"));
    (0..2).fold(plot, |plot, i| plot.series(JOINTS[i], Marks::Line, run.points(|row| 1e3 * row.error(i))))
}

/// A limit in both directions, as one curve with a gap.
pub fn limits(run: &Run, limit: f64) -> Vec<[f64; 2]> {
    let gap = [f64::NAN; 2];
    let mut points = run.points(|_| limit);
    points.push(gap);
    points.extend(run.points(|_| -limit));
    points
}
