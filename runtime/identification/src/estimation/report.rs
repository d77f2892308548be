//! The returned estimate: parameters, joints and findings of a fit to samples.

use super::super::run::PreparedRun;
use super::estimated::Estimated;
use super::layout::LOAD;
use super::residuals::{Forces, RunOffsets};
use super::result::{Estimate, Gravity, JointEstimate};
use gelenk_findings::{Finding, Rule};

/// Sees: a robot that compensates the weight of the described bodies only.
/// Matters: the efforts contain only the additional weight.
/// Example: a load in the hand of a robot with gravity compensation.
/// Fixture: `estimation/tests/simulated.rs`.
const AS_DESCRIBED: Rule = Rule::note("compensated-as-described");

/// Data from which the returned estimate is made.
pub(super) struct Report<'a> {
    pub(super) fitted: Estimated<'a>,
    pub(super) runs: &'a [PreparedRun],
    pub(super) forces: &'a Forces,
    pub(super) offset_errors: RunOffsets,
    pub(super) held_out: &'a [f64],
    pub(super) with_rest: &'a [f64],
}

impl Report<'_> {
    pub(super) fn estimate(&self, doubts: Vec<Finding>) -> Estimate {
        let layout = self.fitted.layout();
        let less = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<f64>>();
        let each = |of: &dyn Fn(usize, usize) -> Vec<f64>| -> Vec<Vec<Vec<f64>>> {
            let known = |r, j| if layout.measured[j] { of(r, j) } else { vec![f64::NAN; of(r, j).len()] };
            let runs = 0..self.forces.measured.len();
            runs.map(|r| (0..layout.joints).map(|j| known(r, j)).collect()).collect()
        };
        let Forces { measured, residual, rigid, load, .. } = self.forces;
        Estimate {
            predicted: each(&|r, j| less(&measured[r][j], &residual[r][j])),
            friction: each(&|r, j| less(&measured[r][j], &rigid[r][j])),
            measured: each(&|r, j| measured[r][j].clone()),
            load_friction: if layout.terms > LOAD { each(&|r, j| load[r][j].clone()) } else { Vec::new() },
            ..self.fitted.estimate(self.fits(), self.choices().chain(doubts).collect())
        }
    }

    fn fits(&self) -> Vec<JointEstimate> {
        let layout = self.fitted.layout();
        let moving = |joint: usize| self.forces.moving(layout, self.runs, joint);
        let squares =
            |joint: usize| moving(joint).map(|(run, i)| self.forces.residual[run][joint][i].powi(2)).sum();
        let rss: Vec<f64> = (0..layout.joints).map(squares).collect();
        let all = |joint: usize| self.forces.residual.iter().map(|run| run[joint].len()).sum::<usize>();
        let r_squared = self.fitted.fit.chosen.centred_r_squared(&rss);
        let fit = |joint: usize| JointEstimate {
            offsets: self.fitted.fit.offsets[joint].clone(),
            offset_errors: self.offset_errors[joint].clone(),
            sigma: (rss[joint] / moving(joint).count().max(1) as f64).sqrt(),
            r_squared: r_squared[joint],
            held_out_r_squared: self.held_out[joint],
            held_out_with_rest: self.with_rest[joint],
            rest: 1.0 - moving(joint).count() as f64 / all(joint).max(1) as f64,
            ..JointEstimate::default()
        };
        (0..layout.joints).map(fit).collect()
    }

    /// Choices of the estimate, as findings.
    fn choices(&self) -> impl Iterator<Item = Finding> {
        let offsets = self.fitted.offsets_found(self.fitted.fit.chosen.model.offsets);
        offsets.chain(self.gravity()).chain(self.fitted.choices())
    }

    /// The finding about the compensated weight, if the robot compensates only the described bodies.
    fn gravity(&self) -> Option<Finding> {
        (self.fitted.gravity == Gravity::CompensatedAsDescribed).then(|| {
            AS_DESCRIBED.found(
                "the robot compensates only the weight of the described bodies. The estimated bodies contain the additional \
                 weight that the efforts show. Their weight is wrong if the model in the robot differs from the description",
            )
        })
    }
}
