//! Checks whether the residuals of the efforts show effects that the model lacks.

use super::super::methods::offset::mean;
use super::super::robot::Robot;
use super::levels;
use super::residuals::Forces;
use super::task::Task;
use super::unit::{CommonRatio, Sizes, common_ratio, unit_doubt};
use gelenk_findings::digits::plain;
use gelenk_findings::{Finding, Rule};

/// Sees: a joint without a measured effort next to others that have one.
/// Matters: its friction, drive and offset stay as described.
/// Example: a column of zeros.
/// Fixture: `dead` in `codegen/tests/findings/arm.rs`.
const NO_EFFORT: Rule = Rule::warning("no-effort");

/// Sees: a joint that does not move.
/// Matters: its friction is not estimated.
/// Example: a joint that was held.
/// Fixture: `still` in `codegen/tests/findings/arm.rs`.
const DOES_NOT_MOVE: Rule = Rule::warning("does-not-move");

/// Sees: a residual that is correlated with the acceleration.
/// Matters: the inertia of the rigid body is wrong.
/// Example: a rotor that the description does not have.
/// Fixture: `estimation/tests/simulated.rs`.
const ACCELERATION: Rule = Rule::warning("residual-follows-acceleration");

/// Fit whose residuals are checked.
pub(super) struct Checked<'a> {
    pub(super) task: &'a Task<'a>,
    pub(super) forces: &'a Forces,
    pub(super) correlation_time: f64,
}

impl Checked<'_> {
    /// Doubts about each moving joint, and findings about joints without a measured effort or without motion.
    pub(super) fn findings(&self) -> Vec<Finding> {
        let of = |joint: usize| {
            if self.task.robot.unmeasured()[joint] || self.task.settings.without.contains(&joint) {
                Vec::new()
            } else if !self.task.layout.measured[joint] {
                vec![no_effort(self.task.robot, joint)]
            } else if !self.task.layout.moves[joint] && !self.task.layout.exact[joint] {
                let still =
                    DOES_NOT_MOVE.found("it does not move in these data, so its friction is not estimated");
                vec![still.of(self.task.robot.subject(joint)).help("record a log in which it moves")]
            } else {
                self.joint(joint)
            }
        };
        (0..self.task.layout.joints).flat_map(of).collect()
    }

    /// Findings that raise doubts about the fit of one joint.
    pub(super) fn joint(&self, joint: usize) -> Vec<Finding> {
        let doubts = [unit_doubt(self.sizes(joint)), self.acceleration(joint)].into_iter().flatten();
        doubts.map(|doubt| doubt.of(self.task.robot.subject(joint))).collect()
    }

    /// Root sums of squares of the estimated rigid force, the described rigid force and the measured force of a joint. The
    /// mean of each run is removed first, because an offset may explain it.
    fn sizes(&self, joint: usize) -> Sizes {
        let squares = |forces: &Vec<f64>| {
            let mean = mean(forces);
            forces.iter().map(|x| (x - mean).powi(2)).sum::<f64>()
        };
        let size = |of: &[Vec<Vec<f64>>]| of.iter().map(|run| squares(&run[joint])).sum::<f64>().sqrt();
        [&self.forces.rigid, &self.forces.described, &self.forces.measured].map(|of| size(of))
    }

    /// Whether the estimated rigid-body force of a joint differs so much from the described force that the unit of its effort
    /// may be wrong.
    pub(super) fn has_other_unit(&self) -> bool {
        let known = self.task.layout.known_efforts();
        (0..self.task.layout.joints).any(|joint| known[joint] && unit_doubt(self.sizes(joint)).is_some())
    }

    /// Ratio of estimated to described forces of the robot as a whole; `None` if no joint determines the ratio.
    pub(super) fn common_ratio(&self) -> Option<CommonRatio> {
        let sizes: Vec<Sizes> = (0..self.task.layout.joints).map(|joint| self.sizes(joint)).collect();
        common_ratio(self.task.robot, self.task.layout.effort, &self.task.layout.known_efforts(), &sizes)
    }

    fn acceleration(&self, joint: usize) -> Option<Finding> {
        // A joint with a quaternion has no rotor.
        if self.task.layout.exact[joint] {
            return None;
        }
        let (factor, share) = self.explained(joint, &|run, i| self.task.runs[run].accelerations[joint][i])?;
        self.is_suspicious(share).then(|| {
            let message = format!(
                "the inertia in the model is wrong, because the residual follows the acceleration. {} times the acceleration \
                 explains {:.0} % of the residual's variance",
                plain(factor, 3),
                100.0 * share
            );
            let remedy = "describe the rotor's inertia, or look for a delay (--delay) or an elastic gear";
            ACCELERATION.found(message).help(remedy)
        })
    }

    /// Whether a quantity that explains this share of the residual's variance needs a finding.
    pub(super) fn is_suspicious(&self, share: f64) -> bool {
        let total: usize = self.task.runs.iter().map(|r| r.times.len()).sum();
        share > levels::SUSPICIOUS.get()
            && share > levels::BY_CHANCE.get() * self.correlation_time / total as f64
    }

    /// Linear regression of a joint's residual on a quantity: its factor, and the share of the residual's variance that it
    /// explains. `None` if the quantity is constant or the residual is zero.
    pub(super) fn explained(
        &self,
        joint: usize,
        quantity: &dyn Fn(usize, usize) -> f64,
    ) -> Option<(f64, f64)> {
        let mut sums = [0.0; 6];
        for (run, i) in self.forces.moving(self.task.layout, self.task.runs, joint) {
            let (x, r) = (quantity(run, i), self.forces.residual[run][joint][i]);
            for (sum, term) in sums.iter_mut().zip([1.0, x, r, x * x, x * r, r * r]) {
                *sum += term;
            }
        }
        let [n, x, r, xx, xr, rr] = sums;
        let (variance, covariance, energy) = (xx - x * x / n, xr - x * r / n, rr - r * r / n);
        let usable = variance > 1e-12 * xx && energy > 0.0;
        usable.then(|| (covariance / variance, covariance * covariance / (variance * energy)))
    }
}

/// The finding about a joint without a usable effort in the logs.
pub(super) fn no_effort(robot: &dyn Robot, joint: usize) -> Finding {
    let message = "it has no measured effort, or only currents while it rests. Its friction, drive and offset stay as described. \
                   Its body is estimated from the efforts of other joints";
    NO_EFFORT.found(message).of(robot.subject(joint))
}
