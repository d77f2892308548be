//! The estimate as it is returned.

use super::super::inertial::PER_BODY;
use super::super::robot::Robot;
use super::choice::Chosen;
use super::estimate::Task;
use super::fit::Solved;
use super::intervals::Covariance;
use super::layout::{ARMATURE, ASYMMETRY, COULOMB, VISCOUS};
use super::normal::Offsets;
use super::prior::Prior;
use super::residuals::{Forces, RunOffsets};
use super::result::{Estimate, EstimatedTerm, JointEstimate, Uncertain};
use statrs::distribution::{ContinuousCDF, Normal};

/// Everything that the printed estimate is made of.
pub(super) struct Report<'a> {
    pub(super) task: &'a Task<'a>,
    pub(super) chosen: &'a Chosen<'a>,
    pub(super) solved: &'a Solved,
    pub(super) forces: &'a Forces,
    pub(super) offsets: &'a RunOffsets,
    pub(super) covariance: &'a Covariance,
    pub(super) held_out: &'a [f64],
    pub(super) warnings: Vec<String>,
}

impl Report<'_> {
    pub(super) fn estimate(&self) -> Estimate {
        let Task { robot, settings, layout, .. } = self.task;
        let described = robot.parameters();
        let parameters = (0..layout.parameters).map(|i| self.uncertain(i, described[i]));
        let add = |a: &[f64], b: &[f64], sign: f64| {
            a.iter().zip(b).map(|(a, b)| a + sign * b).collect::<Vec<f64>>()
        };
        let each = |of: &dyn Fn(usize, usize) -> Vec<f64>| -> Vec<Vec<Vec<f64>>> {
            let runs = 0..self.forces.measured.len();
            runs.map(|r| (0..layout.joints).map(|j| of(r, j)).collect()).collect()
        };
        let Forces { measured, residual, rigid, .. } = self.forces;
        Estimate {
            parameters: parameters.collect(),
            consistent: self.is_consistent(),
            joints: self.joints(),
            effort: layout.effort,
            offsets: self.chosen.model.offsets,
            description_weight: self.chosen.weighting.description,
            weights_tried: self.chosen.tried.clone(),
            effective_parameters: self.covariance.decided,
            predicted: each(&|r, j| add(&measured[r][j], &residual[r][j], -1.0)),
            friction: each(&|r, j| add(&measured[r][j], &rigid[r][j], -1.0)),
            measured: measured.clone(),
            confidence: settings.confidence,
            choices: self.choices(),
            warnings: self.warnings.clone(),
        }
    }

    fn is_consistent(&self) -> bool {
        self.task.prior.can_exist(&self.solved.values.unknowns)
    }

    /// What was chosen, in sentences.
    fn choices(&self) -> Vec<String> {
        let offsets = match self.chosen.model.offsets {
            Offsets::None => "Forces have no offset.",
            Offsets::Common => "Each joint's force has one offset.",
            Offsets::ByRun => "Each joint's force has an offset in each run.",
        };
        let words =
            chosen_in_words(self.task.robot, self.chosen, self.task.prior, self.solved, self.covariance);
        [offsets.to_string()].into_iter().chain(words).collect()
    }

    fn uncertain(&self, global: usize, base: f64) -> Uncertain {
        let level = self.task.settings.confidence;
        let quantile = Normal::standard().inverse_cdf(0.5 + 0.5 * level);
        Uncertain::new(
            base + self.solved.values.unknowns[global],
            self.covariance.deviation(self.solved, global),
            quantile,
        )
    }

    fn joints(&self) -> Vec<JointEstimate> {
        let names = self.task.robot.joint_names();
        let rss: Vec<f64> = (0..names.len()).map(|j| self.squares(j)).collect();
        let in_fit = self.chosen.centred_r_squared(&rss);
        names.into_iter().enumerate().map(|(j, name)| self.joint(j, name, in_fit[j])).collect()
    }

    fn squares(&self, joint: usize) -> f64 {
        self.forces.residual.iter().flat_map(|run| &run[joint]).map(|r| r * r).sum()
    }

    fn joint(&self, joint: usize, name: String, r_squared: f64) -> JointEstimate {
        let Task { robot, layout, .. } = self.task;
        let model = &self.chosen.model;
        let count: usize = self.forces.residual.iter().map(|run| run[joint].len()).sum();
        let armature = model.armature[joint] && layout.moves[joint];
        JointEstimate {
            name,
            unit: if robot.position_units()[joint] == "m" { "N" } else { "N·m" },
            terms: self.terms(joint),
            armature: armature.then(|| self.uncertain(layout.term(joint, ARMATURE), 0.0)),
            gain: model.gains.then(|| self.gain(joint)),
            offsets: self.offsets[joint].clone(),
            sigma: (self.squares(joint) / count.max(1) as f64).sqrt(),
            r_squared,
            held_out_r_squared: self.held_out[joint],
            moves: layout.moves[joint],
        }
    }

    fn terms(&self, joint: usize) -> Vec<EstimatedTerm> {
        let layout = self.task.layout;
        if !layout.moves[joint] {
            return Vec::new();
        }
        let width = self.chosen.model.coulomb[joint];
        let tanh = format!("tanh({}*v)", layout.steepness[joint][width]);
        let mut terms = vec![("v".to_string(), VISCOUS), (tanh, COULOMB.start + width)];
        if self.chosen.model.asymmetry[joint] {
            terms.push(("abs(v)".to_string(), ASYMMETRY));
        }
        let term = |(basis, term)| EstimatedTerm {
            basis,
            coefficient: self.uncertain(layout.term(joint, term), 0.0),
        };
        terms.into_iter().map(term).collect()
    }

    /// K_M: its relative error is that of the rigid force.
    fn gain(&self, joint: usize) -> Uncertain {
        let value = self.solved.values.gains[joint];
        let quantile = Normal::standard().inverse_cdf(0.5 + 0.5 * self.task.settings.confidence);
        Uncertain::new(
            value,
            value * self.covariance.deviation(self.solved, self.task.layout.gain(joint)),
            quantile,
        )
    }
}

/// How much the description weighs, and which of its bodies the data contradict.
pub(super) fn chosen_in_words(
    robot: &dyn Robot,
    chosen: &Chosen,
    prior: &Prior,
    solved: &Solved,
    covariance: &Covariance,
) -> Vec<String> {
    let names = robot.parameter_names();
    let all = solved.active.iter().filter(|&&global| global < names.len()).count();
    let weight = format!(
        "The description weighs {:.3e}: the data decide {:.1} of {all} combinations of inertial parameters, \
         the description decides the rest.",
        chosen.weighting.description, covariance.decided
    );
    let doubted = prior.bodies.iter().filter(|b| chosen.weighting.trust[*b * PER_BODY] < 1.0);
    let doubted = doubted.map(|b| {
        format!("The data contradict the described body of {}.", names[b * PER_BODY].trim_start_matches("m_"))
    });
    [weight].into_iter().chain(doubted).collect()
}
