//! Recorded motions as they were measured ([`Run`]), and prepared for the regression ([`PreparedRun`]).

use super::error::{Result, at, require_finite, require_length};
use super::numeric::shifted::{shifted, slope};
use super::robot::Robot;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// A part of a log without interruption. All columns have samples at the same times.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// File name of the log, followed by the number of the run if the log has several runs.
    pub name: String,
    /// Times \[s\]. They increase strictly. Their steps may differ.
    pub times: Vec<f64>,
    /// Row of each sample in the log. The header is row 1, as in an editor.
    pub rows: Vec<usize>,
    /// Measured positions [rad or m], one column for each joint of the robot. A joint with a quaternion has one column for
    /// each of its velocities. Such a column starts at 0 and adds up the displacements `y ⊖ y_before` between consecutive
    /// samples: rotation vectors, and for a floating joint also translations. The rate of the column is the velocity in the
    /// body's frame.
    pub positions: Vec<Vec<f64>>,
    /// Measured positions y of a robot with quaternions, one column for each entry; empty for other robots.
    pub poses: Vec<Vec<f64>>,
    /// Measured velocities [rad/s or m/s] of each joint; `None` if the log does not have them.
    pub velocities: Vec<Option<Vec<f64>>>,
    /// Measured efforts. [`Self::effort`] determines the unit, and whether there is a column for each joint or for each input.
    pub efforts: Vec<Vec<f64>>,
    /// Kind of the efforts: forces at the joints, inputs, or currents.
    pub effort: Effort,
}

/// Fewest samples of a run that can be prepared.
pub(crate) const FEWEST_SAMPLES: usize = 16;

/// Kind of the efforts of a log.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Effort {
    /// Forces at the joints, `B u` with the input matrix B and the inputs u [N·m or N], one for each joint.
    Joint,
    /// Inputs u of the description [N·m or N], on the motor side of the gears, one for each input.
    Input,
    /// Motor currents i \[A\], one for each input: `u = K_M i` with the input u and an unknown motor constant K_M.
    Current,
}

impl Effort {
    pub(crate) fn plural(self) -> &'static str {
        match self {
            Self::Joint => "forces at the joints",
            Self::Input => "inputs",
            Self::Current => "currents",
        }
    }
}

/// A run on an equidistant time grid, with smoothed positions and their derivatives, as [`crate::preparation`] makes it. The
/// efforts passed the same filter, and their delay is removed.
#[derive(Debug, Clone, PartialEq)]
pub struct PreparedRun {
    /// Name of the run from which this run was made.
    pub name: String,
    /// Times \[s\], equidistant.
    pub times: Vec<f64>,
    /// Row of the nearest sample in the log. The header is row 1, as in an editor.
    pub rows: Vec<usize>,
    /// Smoothed positions [rad or m], one column for each joint; for joints with a quaternion as in [`Run::positions`].
    pub positions: Vec<Vec<f64>>,
    /// Smoothed positions y of a robot with quaternions, one column for each entry; empty for other robots.
    pub poses: Vec<Vec<f64>>,
    /// Velocities ẏ [rad/s or m/s], one column for each joint.
    pub velocities: Vec<Vec<f64>>,
    /// Accelerations ÿ [rad/s² or m/s²], one column for each joint.
    pub accelerations: Vec<Vec<f64>>,
    /// Smoothed efforts. [`Self::effort`] determines the unit, and whether there is a column for each joint or for each input.
    pub efforts: Vec<Vec<f64>>,
    /// For each joint and sample, whether the joint rests. Dry friction at rest takes any value up to the static one, so the
    /// effort at this sample contains no information on friction. Empty if no joint rests.
    pub resting: Vec<Vec<bool>>,
    /// Kind of the efforts: forces at the joints, inputs, or currents.
    pub effort: Effort,
}

impl PreparedRun {
    /// Fails unless the run has all columns of a robot, and the columns have the same length and finite values.
    ///
    /// - `effort`: kind of efforts of the other runs
    /// - `may_lack`: whether an effort may be missing. The column of a missing effort is NaN.
    pub(crate) fn check(&self, robot: &dyn Robot, effort: Effort, may_lack: bool) -> Result<()> {
        let name = &self.name;
        if self.effort != effort {
            let message = format!(
                "its efforts are {}, but those of the first run are {}",
                self.effort.plural(),
                effort.plural()
            );
            return Err(at(name).fault(message));
        }
        let (joints, quaternions) = (robot.joint_names().len(), robot.quaternion_joints().len());
        let kinds = [
            ("positions", &self.positions, joints),
            ("velocities", &self.velocities, joints),
            ("accelerations", &self.accelerations, joints),
            ("poses", &self.poses, if quaternions > 0 { joints + quaternions } else { 0 }),
            (
                "efforts",
                &self.efforts,
                if effort == Effort::Joint { joints } else { robot.input_names().len() },
            ),
        ];
        for (what, columns, expected) in kinds {
            let what = format!("{what} of {name}");
            require_length(&what, expected, columns.len())?;
            for column in columns {
                require_length(&format!("samples of {what}"), self.times.len(), column.len())?;
                let is_missing =
                    may_lack && std::ptr::eq(columns, &self.efforts) && column.iter().all(|u| u.is_nan());
                if !is_missing {
                    require_finite(&what, column)?;
                }
            }
        }
        Ok(())
    }

    /// Positions y, one column for each entry. The columns are the joints' positions if the robot has no
    /// quaternion.
    pub(crate) fn coordinates(&self) -> &[Vec<f64>] {
        if self.poses.is_empty() { &self.positions } else { &self.poses }
    }

    /// The entries of y, and the velocities and accelerations of the joints, at a sample.
    pub(crate) fn state(&self, sample: usize) -> [Vec<f64>; 3] {
        let columns = [self.coordinates(), &self.velocities, &self.accelerations];
        columns.map(|columns| columns.iter().map(|column| column[sample]).collect())
    }

    /// Force at a joint [N·m or N], computed from the measured efforts with a gain of one.
    ///
    /// - `input_matrix`: input matrix B, row by row
    pub(crate) fn force(&self, input_matrix: &[f64], joint: usize, sample: usize) -> f64 {
        if self.effort == Effort::Joint {
            return self.efforts[joint][sample];
        }
        let row = input_matrix.chunks_exact(self.efforts.len().max(1)).nth(joint).unwrap_or_default();
        let driven = row.iter().zip(&self.efforts).filter(|(b, _)| **b != 0.0);
        driven.map(|(b, u)| b * u[sample]).sum()
    }

    /// Whether a joint rests at a sample.
    pub(crate) fn rests(&self, joint: usize, sample: usize) -> bool {
        self.resting.get(joint).and_then(|rests| rests.get(sample)).copied().unwrap_or(false)
    }

    /// Contiguous intervals of the samples that are used for a joint: the samples at which the joint does not rest. If the
    /// joint does not move in any run, all samples are used, because it has no friction law and its constant stiction is an
    /// offset.
    pub(crate) fn stretches(&self, joint: usize, moves: bool) -> Vec<Range<usize>> {
        let mut stretches: Vec<Range<usize>> = Vec::new();
        for i in (0..self.times.len()).filter(|i| !moves || !self.rests(joint, *i)) {
            match stretches.last_mut() {
                Some(stretch) if stretch.end == i => stretch.end = i + 1,
                _ => stretches.push(i..i + 1),
            }
        }
        stretches
    }

    /// Time between samples [s].
    pub(crate) fn step(&self) -> f64 {
        let last = self.times.len().saturating_sub(1);
        (self.times[last] - self.times[0]) / last.max(1) as f64
    }

    /// Rate of change of an effort at a sample, per second.
    pub(crate) fn effort_rate(&self, effort: usize, sample: usize) -> f64 {
        slope(&self.efforts[effort], sample) / self.step()
    }

    /// The run with efforts that are shifted to earlier times.
    ///
    /// - `delays`: delay of each effort \[s\]; efforts without an entry are not shifted
    pub(crate) fn without_delays(self, delays: &[f64]) -> Self {
        let step = self.step();
        let earlier = |(effort, values): (usize, &Vec<f64>)| -> Vec<f64> {
            let samples = delays.get(effort).copied().unwrap_or(0.0) / step;
            let at =
                |i: usize| if samples == 0.0 { values[i] } else { shifted(values, i as f64 + samples).0 };
            (0..values.len()).map(at).collect()
        };
        let efforts = self.efforts.iter().enumerate().map(earlier).collect();
        Self { efforts, ..self }
    }

    /// The run in which joint j has the columns of joint `order[j]`.
    pub(crate) fn in_order(&self, order: &[usize]) -> Self {
        Self {
            positions: moved(order, &self.positions),
            velocities: moved(order, &self.velocities),
            accelerations: moved(order, &self.accelerations),
            efforts: moved(order, &self.efforts),
            resting: moved(order, &self.resting),
            ..self.clone()
        }
    }

    /// Number of the samples at which at least one joint moves.
    pub(crate) fn count_moving(&self, samples: Range<usize>) -> usize {
        samples.filter(|sample| self.is_moving(*sample)).count()
    }

    /// Whether at least one joint moves at a sample.
    pub(crate) fn is_moving(&self, sample: usize) -> bool {
        (0..self.positions.len()).any(|joint| !self.rests(joint, sample))
    }
}

/// Values in another order of the joints: the value of joint j is that of joint `order[j]`. Empty if there
/// are no values.
pub(crate) fn moved<T: Clone>(order: &[usize], values: &[T]) -> Vec<T> {
    order.iter().filter_map(|column| values.get(*column).cloned()).collect()
}
