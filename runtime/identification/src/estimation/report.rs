//! The estimate as it is returned.

use super::super::confidence::quantile;
use super::super::inertial::PER_BODY;
use super::super::robot::Robot;
use super::choice::Chosen;
use super::endogeneity::{Endogeneity, Test};
use super::fit::Solved;
use super::intervals::Covariance;
use super::layout::{ARMATURE, ASYMMETRY, COULOMB, LOAD, VISCOUS};
use super::prior::Prior;
use super::residuals::{Forces, RunOffsets};
use super::result::{Estimate, EstimatedTerm, InstrumentalEstimate, JointEstimate, Offsets, Uncertain};
use super::task::Task;

/// Level of the test of least squares against instrumental variables.
const LEVEL: f64 = 0.05;

/// Everything that the printed estimate is made of.
pub(super) struct Report<'a> {
    pub(super) task: &'a Task<'a>,
    pub(super) chosen: &'a Chosen<'a>,
    pub(super) solved: &'a Solved,
    pub(super) forces: &'a Forces,
    pub(super) offsets: &'a RunOffsets,
    pub(super) covariance: &'a Covariance,
    pub(super) held_out: &'a [f64],
    pub(super) endogeneity: Option<&'a Endogeneity>,
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
            let known = |r, j| if layout.measured[j] { of(r, j) } else { vec![f64::NAN; of(r, j).len()] };
            let runs = 0..self.forces.measured.len();
            runs.map(|r| (0..layout.joints).map(|j| known(r, j)).collect()).collect()
        };
        let Forces { measured, residual, rigid, load, .. } = self.forces;
        let has_loads = self.task.loads.is_some();
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
            measured: each(&|r, j| measured[r][j].clone()),
            load_friction: if has_loads { each(&|r, j| load[r][j].clone()) } else { Vec::new() },
            confidence: settings.confidence,
            instrumental: self.endogeneity.map(|found| self.instrumental(found)),
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
        let exact = self.task.layout.exact.contains(&true).then(|| {
            "Forces in the rows of spherical and floating joints are those of the inputs alone: no offset and no friction \
             is estimated there."
                .to_string()
        });
        let offsets = if self.task.layout.exact.contains(&false) { Some(offsets.to_string()) } else { None };
        let words =
            chosen_in_words(self.task.robot, self.chosen, self.task.prior, self.solved, self.covariance);
        offsets
            .into_iter()
            .chain(exact)
            .chain(words)
            .chain(self.pull_said())
            .chain([self.endogeneity_said()])
            .collect()
    }

    /// What was done where the program over bodies that can exist did not converge by itself.
    fn pull_said(&self) -> Option<String> {
        let pull = self.solved.pull;
        (pull > 0.0).then(|| {
            format!(
                "The fit over bodies that can exist converged with a pull towards the description of {pull:.0e} of the \
                 largest curvature, which is below what the sums resolve."
            )
        })
    }

    /// Whether noise of the motion biases least squares.
    fn endogeneity_said(&self) -> String {
        let Some(Endogeneity { source, test: Test { statistic, freedoms: [q, rest], p_value }, .. }) =
            self.endogeneity
        else {
            return "The logs hold no instruments (commanded positions, or repeats of a motion), or are too short for \
                    them: whether noise of the positions biases the estimate in closed loop is not known."
                .into();
        };
        let numbers = format!("F({q}, {rest}) = {statistic:.2}, p = {p_value:.2e}, instruments are {source}");
        if *p_value < LEVEL {
            format!(
                "Least squares differs from instrumental variables by more than chance ({numbers}): noise of the \
                 positions biases it in closed loop, or what the model lacks follows the control error."
            )
        } else {
            format!("Least squares is not biased in closed loop as far as the data tell ({numbers}).")
        }
    }

    fn instrumental(&self, found: &Endogeneity) -> InstrumentalEstimate {
        let layout = self.task.layout;
        let described = self.task.robot.parameters();
        let quantile = self.quantile(found.freedom);
        let uncertain = |global: usize, base: f64| {
            let place = self.solved.active.iter().position(|&active| active == global);
            let error = place.map_or(0.0, |i| found.covariance[(i, i)].max(0.0).sqrt());
            Uncertain::new(base + found.values.unknowns[global], error, quantile)
        };
        let terms = |joint: usize| {
            let terms = self.basis(joint).into_iter().map(|(basis, term)| EstimatedTerm {
                basis,
                coefficient: uncertain(layout.term(joint, term), 0.0),
            });
            terms.collect()
        };
        InstrumentalEstimate {
            source: found.source,
            parameters: (0..layout.parameters).map(|i| uncertain(i, described[i])).collect(),
            terms: (0..layout.joints).map(terms).collect(),
            statistic: found.test.statistic,
            degrees_of_freedom: found.test.freedoms,
            p_value: found.test.p_value,
        }
    }

    /// Student's quantile at the level of the intervals. The settings are checked, and there is one degree of freedom.
    fn quantile(&self, freedom: usize) -> f64 {
        quantile(self.task.settings.confidence, freedom.max(1) as f64).unwrap_or(f64::INFINITY)
    }

    fn uncertain(&self, global: usize, base: f64) -> Uncertain {
        Uncertain::new(
            base + self.solved.values.unknowns[global],
            self.covariance.deviation(self.solved, global),
            self.quantile(self.covariance.freedom),
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
        let measured = layout.measured[joint];
        JointEstimate {
            name,
            unit: if robot.position_units()[joint] == "m" { "N" } else { "N·m" },
            terms: self.terms(joint),
            load: (model.load[joint] && layout.moves[joint]).then(|| EstimatedTerm {
                basis: format!("tanh({}*v)", layout.steepness[joint][model.coulomb[joint]]),
                coefficient: self.uncertain(layout.term(joint, LOAD), 0.0),
            }),
            armature: armature.then(|| self.uncertain(layout.term(joint, ARMATURE), 0.0)),
            gain: (model.gains && measured).then(|| self.gain(joint)),
            offsets: self.offsets[joint].clone(),
            sigma: if measured { (self.squares(joint) / count.max(1) as f64).sqrt() } else { f64::NAN },
            r_squared,
            held_out_r_squared: self.held_out[joint],
            moves: layout.moves[joint],
            measured,
            exact: layout.exact[joint],
        }
    }

    fn terms(&self, joint: usize) -> Vec<EstimatedTerm> {
        let term = |(basis, term)| EstimatedTerm {
            basis,
            coefficient: self.uncertain(self.task.layout.term(joint, term), 0.0),
        };
        self.basis(joint).into_iter().map(term).collect()
    }

    /// Friction terms that were chosen, as expressions and by their numbers.
    fn basis(&self, joint: usize) -> Vec<(String, usize)> {
        let layout = self.task.layout;
        if !layout.rubbing().any(|rubbing| rubbing == joint) {
            return Vec::new();
        }
        let width = self.chosen.model.coulomb[joint];
        let tanh = format!("tanh({}*v)", layout.steepness[joint][width]);
        let mut terms = vec![("v".to_string(), VISCOUS), (tanh, COULOMB.start + width)];
        if self.chosen.model.asymmetry[joint] {
            terms.push(("abs(v)".to_string(), ASYMMETRY));
        }
        terms
    }

    /// K_M: its relative error is that of the rigid force.
    fn gain(&self, joint: usize) -> Uncertain {
        let value = self.solved.values.gains[joint];
        let error = value * self.covariance.deviation(self.solved, self.task.layout.gain(joint));
        Uncertain::new(value, error, self.quantile(self.covariance.freedom))
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
