//! Results of an estimate from samples or from sums: parameters, friction terms and gains with their intervals, and findings
//! about the choices.

use super::super::error::{IdentificationError, Result};
use super::super::inertial::PER_BODY;
use super::super::methods::confidence::quantile;
use super::super::methods::library::smooth_sign;
use super::super::robot::Robot;
use super::intervals::{Covariance, RigidFit};
use super::layout::{ARMATURE, ASYMMETRY, COULOMB, LOAD, Layout, VISCOUS};
use super::normal::residual_vector;
use super::result::{CommonTerms, Estimate, EstimatedTerm, Gravity, JointEstimate, Offsets, Uncertain};
use super::sensitivity::{JointSensitivity, Sensitivity};
use super::settings::EstimationSettings;
use super::trial::is_refusal;
use gelenk_findings::digits::{plain, with_error};
use gelenk_findings::{Finding, Rule};
use nalgebra::{DMatrix, DVector};

/// Sees: the number of offsets of the measured forces.
/// Matters: an offset for each run absorbs differences between runs.
/// Example: one offset for each joint.
/// Fixture: `good` in `codegen/tests/findings/arm.rs`.
const OFFSETS: Rule = Rule::note("offsets");

/// Sees: the remaining delays of the efforts.
/// Matters: intervals include the uncertainty of the delays.
/// Example: 0.2 ± 0.3 ms.
/// Fixture: `good` in `codegen/tests/findings/arm.rs`.
const DELAYS: Rule = Rule::note("delays-estimated");

/// Sees: the weight of the description, and the number of combinations of inertial parameters that the data determine.
/// Matters: the description determines the other combinations.
/// Example: 12.3 of 30 combinations.
/// Fixture: `good` in `codegen/tests/findings/arm.rs`.
const WEIGHT: Rule = Rule::note("description-weight");

/// Sees: a body whose described parameters have a smaller weight, and an interval that does not contain a described value.
/// Matters: the description of this body is probably wrong.
/// Example: a link that is 12 % heavier than described.
/// Fixture: `merge` in `codegen/tests/findings/arm.rs`.
const CONTRADICTED: Rule = Rule::note("body-contradicted");

/// Sees: a motor constant whose interval is wider than a factor of 2.
/// Matters: torques, friction and inertia of the joint may be wrong by this factor.
/// Example: a joint with a vertical axis.
/// Fixture: `estimation/tests/currents.rs`.
const MOTOR_CONSTANT: Rule = Rule::warning("motor-constant-unknown");

/// The last fit and its inputs.
pub(super) struct Estimated<'a> {
    pub(super) robot: &'a dyn Robot,
    pub(super) settings: &'a EstimationSettings,
    pub(super) gravity: Gravity,
    pub(super) fit: &'a RigidFit<'a>,
    pub(super) covariance: Covariance,
    /// Change of each unknown if the samples near rests and reversals are left out.
    pub(super) margin: DVector<f64>,
    /// Delays \[s\] that were removed from the efforts after the first fit, one for each index of a delay.
    pub(super) delays: &'a [f64],
}

impl Estimated<'_> {
    pub(super) fn layout(&self) -> &Layout {
        self.fit.layout()
    }

    /// The estimate without the forces along the runs.
    ///
    /// - `fits`: offsets of each joint, and quality of the fit of its force
    pub(super) fn estimate(&self, fits: Vec<JointEstimate>, mut findings: Vec<Finding>) -> Estimate {
        findings.extend(self.untold_gains());
        let (layout, chosen, changes) = (self.layout(), self.fit.chosen, &self.fit.solved.values.unknowns);
        let described = self.robot.parameters().into_iter().enumerate();
        let joints = self.robot.joint_names().into_iter().zip(fits).enumerate();
        Estimate {
            parameters: described.map(|(i, described)| self.uncertain(i, described)).collect(),
            consistent: self.fit.prior.can_exist(changes),
            joints: joints.map(|(joint, (name, fit))| self.joint(joint, name, fit)).collect(),
            effort: layout.effort,
            gravity: self.gravity,
            offsets: chosen.model.offsets,
            description_weight: chosen.weighting.description,
            parameter_covariance: self.parameter_covariance(),
            sensitivity: self.sensitivity(),
            measured: Vec::new(),
            predicted: Vec::new(),
            friction: Vec::new(),
            load_friction: Vec::new(),
            confidence: self.settings.confidence,
            common: (0..layout.joints).map(|joint| self.common(joint)).collect(),
            freedom: self.covariance.freedom,
            delays: layout.delays.iter().map(|number| self.delay(*number)).collect(),
            findings,
        }
    }

    /// Findings about the kind of offsets.
    ///
    /// - `measured`: offsets of measured forces
    pub(super) fn offsets_found(&self, measured: Offsets) -> impl Iterator<Item = Finding> {
        let said = match measured {
            Offsets::None => "forces have no offset",
            Offsets::Common => "each joint's force has one constant offset for all runs",
            Offsets::ByRun => "each joint's force has a separate constant offset for each run",
        };
        let exact = "the forces at spherical and floating joints are computed from the inputs and taken as exact. Neither an \
                     offset nor friction is estimated for these joints";
        let said = [(false, said), (true, exact)];
        said.into_iter()
            .filter(|(kind, _)| self.layout().exact.contains(kind))
            .map(|(_, said)| OFFSETS.found(said))
    }

    /// Products from which the loss of R² by other inertial parameters is computed.
    fn sensitivity(&self) -> Sensitivity {
        let (layout, centred, values) = (self.layout(), &self.fit.chosen.centred, &self.fit.solved.values);
        let joint = |j: usize| {
            let (all, local) = (&centred.all[j], &layout.local[j]);
            let places: Vec<usize> = (0..local.len()).filter(|k| local[*k] < layout.parameters).collect();
            let slopes = all * residual_vector(layout, values, j);
            JointSensitivity {
                parameters: places.iter().map(|k| local[*k]).collect(),
                products: all.select_rows(&places).select_columns(&places),
                slopes: slopes.select_rows(&places),
                variation: values.gains[j].powi(2) * centred.variation(j),
            }
        };
        Sensitivity { joints: (0..layout.joints).filter(|j| layout.moves[*j]).map(joint).collect() }
    }

    /// Covariance of the inertial parameters, scaled to the reported standard errors; zero for parameters that the data may
    /// not change.
    fn parameter_covariance(&self) -> DMatrix<f64> {
        let count = self.layout().parameters;
        let active = self.fit.solved.active.iter().enumerate().take_while(|(_, global)| **global < count);
        let active: Vec<(usize, usize)> = active.map(|(place, global)| (place, *global)).collect();
        let matrix = &self.covariance.matrix;
        let factor = |&(place, global): &(usize, usize)| {
            let own = matrix[(place, place)].max(0.0).sqrt();
            if own > 0.0 { self.uncertain(global, 0.0).standard_error / own } else { 0.0 }
        };
        let factors: Vec<f64> = active.iter().map(factor).collect();
        let mut covariance = DMatrix::zeros(count, count);
        for (&(i, row), a) in active.iter().zip(&factors) {
            for (&(k, column), b) in active.iter().zip(&factors) {
                covariance[(row, column)] = matrix[(i, k)] * a * b;
            }
        }
        covariance
    }

    /// The friction terms of a joint with the errors of their coefficients; `None` if the joint has no terms.
    fn common(&self, joint: usize) -> Option<CommonTerms> {
        let (bases, unknowns): (Vec<String>, Vec<usize>) = self.bases(joint).into_iter().unzip();
        let of = |i: usize, k: usize| self.covariance.of(&self.fit.solved, unknowns[i], unknowns[k]);
        (!bases.is_empty()).then(|| CommonTerms {
            bases,
            margins: DVector::from_fn(unknowns.len(), |i, _| self.margin[unknowns[i]]),
            covariance: DMatrix::from_fn(unknowns.len(), unknowns.len(), of),
            freedom: self.covariance.freedom.max(1) as f64,
        })
    }

    /// The finding about the remaining delays; `None` if the delays are known.
    fn delays_found(&self) -> Option<Finding> {
        let mut numbers = self.layout().delays.clone();
        numbers.sort_unstable();
        numbers.dedup();
        let half = |delay: Uncertain| 0.5 * (delay.interval[1] - delay.interval[0]);
        let said = |delay: Uncertain| format!("{:+.2} ± {:.2} ms", 1e3 * delay.value, 1e3 * half(delay));
        let said: Vec<String> = numbers.iter().map(|number| said(self.delay(*number))).collect();
        (!said.is_empty()).then(|| {
            let message = format!(
                "the delay of the efforts is {} in addition to the delay that was removed before. The additional delay was estimated \
                 together with all other parameters, and the intervals include its uncertainty",
                said.join(", ")
            );
            DELAYS.found(message).help("if the delay is known, set it with --delay")
        })
    }

    /// Remaining delay with an index, including the part that was removed after the first fit.
    fn delay(&self, number: usize) -> Uncertain {
        let before = self.delays.get(number).copied().unwrap_or(0.0);
        self.uncertain(self.layout().delay(number), before)
    }

    /// The finding about the parameter of a body whose described value is farthest outside its interval; `None` if the
    /// intervals contain all described values of the body.
    fn contradicted(&self, names: &[String], body: usize) -> Option<Finding> {
        let of = |i: usize| {
            let described = self.fit.prior.described[i];
            let Uncertain { value, interval: [low, high], .. } = self.uncertain(i, described);
            let half = 0.5 * (high - low);
            ((value - described).abs() / half, i, [value, half, described])
        };
        let all = (body * PER_BODY..(body + 1) * PER_BODY).map(of).filter(|(ratio, ..)| *ratio > 1.0);
        let (_, i, numbers) = all.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let [value, half, described] = numbers;
        let message = format!(
            "the estimate {} of `{}` contradicts the described {}, so the description of this body has a smaller weight than the \
             descriptions of other bodies",
            with_error(value, Some(half)),
            names[i],
            plain(described, 3)
        );
        Some(CONTRADICTED.found(message).with("estimate", value, "").with("described", described, ""))
    }

    /// Findings about the weight of the description, the bodies whose descriptions have a smaller weight, and the delays.
    pub(super) fn choices(&self) -> impl Iterator<Item = Finding> {
        let names = self.robot.parameter_names();
        let weighting = &self.fit.chosen.weighting;
        let all = self.fit.solved.active.iter().filter(|&&global| global < names.len()).count();
        let weight = format!(
            "the description has the weight {}. The data determine {:.1} of {all} combinations of inertial parameters, and the \
             description determines the rest",
            plain(weighting.description, 4),
            self.covariance.decided
        );
        let bodies = self.fit.prior.bodies.iter();
        let doubted = bodies.filter(move |body| weighting.trust[*body * PER_BODY] < 1.0);
        let doubted = doubted.filter_map(move |body| self.contradicted(&names, *body));
        std::iter::once(WEIGHT.found(weight)).chain(doubted).chain(self.delays_found())
    }

    /// Value of an unknown plus `base`, with its interval. Student's interval is extended on both sides by the change of the
    /// value if the samples near rests and reversals are left out.
    fn uncertain(&self, global: usize, base: f64) -> Uncertain {
        let error = self.covariance.of(&self.fit.solved, global, global).max(0.0).sqrt();
        let distance = self.margin[global].abs();
        let value = base + self.fit.solved.values.unknowns[global];
        let [low, high] = self.with_interval(value, error, self.covariance.freedom).interval;
        Uncertain {
            value,
            standard_error: distance.hypot(error),
            interval: [low - distance, high + distance],
        }
    }

    /// Value with its interval by Student's t distribution. At least one degree of freedom is assumed.
    fn with_interval(&self, value: f64, standard_error: f64, freedom: usize) -> Uncertain {
        let quantile = quantile(self.settings.confidence, freedom.max(1) as f64).unwrap_or(f64::INFINITY);
        let half = quantile * standard_error;
        Uncertain { value, standard_error, interval: [value - half, value + half] }
    }

    /// The chosen friction terms of a joint, with the indices of their unknowns.
    fn bases(&self, joint: usize) -> Vec<(String, usize)> {
        let (layout, model) = (self.layout(), &self.fit.chosen.model);
        if !layout.rubbing().any(|rubbing| rubbing == joint) {
            return Vec::new();
        }
        let coulomb = (self.coulomb(joint), COULOMB.start + model.coulomb[joint]);
        let asymmetry = model.asymmetry[joint].then(|| ("abs(v)".to_owned(), ASYMMETRY));
        let bases = [("v".to_owned(), VISCOUS), coulomb].into_iter().chain(asymmetry);
        bases.map(|(basis, term)| (basis, layout.term(joint, term))).collect()
    }

    /// Expression of a joint's Coulomb term.
    fn coulomb(&self, joint: usize) -> String {
        smooth_sign(self.layout().steepness[joint][self.fit.chosen.model.coulomb[joint]])
    }

    /// Motor constant K_M of a joint's drive. The interval is computed for the logarithm of K_M.
    fn gain(&self, joint: usize) -> Uncertain {
        let (chosen, value) = (self.fit.chosen, self.fit.solved.values.gains[joint]);
        let error = chosen.log_gains[(joint, joint)].max(0.0).sqrt();
        let folds = chosen.centred.without.len();
        let [low, high] = self.with_interval(0.0, error, folds.saturating_sub(1)).interval;
        let mut interval = [low, high].map(|end| value * end.exp());
        interval.sort_by(f64::total_cmp);
        Uncertain { value, standard_error: value.abs() * error, interval }
    }

    /// Findings about joints whose gains have intervals that are wider than a factor of 2.
    fn untold_gains(&self) -> Vec<Finding> {
        let untold = |joint: &usize| !self.gain(*joint).has_one_size();
        let finding = |joint: usize| {
            let message = "its motor constant cannot be determined, so its torques, friction and inertia may be wrong by a common \
                           factor. The described bodies load the joint too little, or only by an inertia like the drive's. \
                           Predicted currents are not affected";
            let remedy = "set `motor_constant` from the data sheet or from a test with a known load, or convert the currents to torques";
            MOTOR_CONSTANT.found(message).of(self.robot.subject(joint)).help(remedy)
        };
        self.layout().unknown_gains().filter(untold).map(finding).collect()
    }

    fn joint(&self, joint: usize, name: String, fit: JointEstimate) -> JointEstimate {
        let (layout, model) = (self.layout(), &self.fit.chosen.model);
        let measured = layout.measured[joint];
        let of_term = |term: usize| self.uncertain(layout.term(joint, term), 0.0);
        let term = |(basis, global)| EstimatedTerm { basis, coefficient: self.uncertain(global, 0.0) };
        let has = |term: &[bool]| term[joint] && layout.moves[joint];
        JointEstimate {
            name,
            unit: if self.robot.position_units()[joint] == "m" { "N" } else { "N·m" },
            terms: self.bases(joint).into_iter().map(term).collect(),
            load: has(&model.load)
                .then(|| EstimatedTerm { basis: self.coulomb(joint), coefficient: of_term(LOAD) }),
            armature: has(&model.armature).then(|| of_term(ARMATURE)),
            gain: (!layout.known_gains[joint] && measured).then(|| self.gain(joint)),
            sigma: if measured { fit.sigma } else { f64::NAN },
            moves: layout.moves[joint],
            measured,
            exact: layout.exact[joint],
            ..fit
        }
    }
}

/// Sees: a joint whose force the fit hardly explains, if no tested cause explains it better.
/// Matters: no law is written.
/// Example: columns of another joint.
/// Fixture: `a_wrong_sign_and_forces_that_are_noise_are_refused` in `estimation/tests/simulated.rs`.
const UNEXPLAINED: Rule = Rule::error("unexplained-effort");

/// The finding about a force that no hypothesis explains, with the usual reasons.
pub(super) fn unexplained(robot: &dyn Robot, joint: usize) -> Finding {
    let remedy = "check sign, unit and assignment of the columns, whether the robot moved freely, and `gravity` of the description";
    UNEXPLAINED.found("the model hardly explains the measured effort of this joint, and none of the checked faults of the log \
                       explains it better").of(robot.subject(joint)).help(remedy)
}

/// Whether a finding is the one of [`unexplained`].
pub(super) fn is_unexplained(finding: &Finding) -> bool {
    finding.code == UNEXPLAINED.code
}

/// Sees: a joint with a low R² on held-out data, or whose effort a hypothesis explains better.
/// Matters: its law and its bodies may be wrong. The reasons follow as separate findings.
/// Example: R² of 0.12.
/// Fixture: `sign` in `codegen/tests/findings/arm.rs`.
const DOUBTED: Rule = Rule::error("fit-doubted");

/// Whether the fit of a joint is refused because of this finding. The findings after it are the reasons.
pub(super) fn is_doubted(finding: &Finding) -> bool {
    finding.code == DOUBTED.code
}

/// Refuses a fit that explains too little of a moving joint's effort, or a fit with a doubt about a moving joint.
///
/// - `held_out`: R² of each joint on held-out data
/// - `doubts`: findings, of which errors about a joint refuse its fit
/// - `reasons`: gives the likely reasons for a joint
///
/// # Errors
/// [`IdentificationError::Found`] with a finding about the first joint of this kind, and the reasons.
pub(super) fn require_explained(
    robot: &dyn Robot,
    layout: &Layout,
    settings: &EstimationSettings,
    held_out: &[f64],
    doubts: &[Finding],
    reasons: impl Fn(usize) -> Vec<Finding>,
) -> Result<()> {
    let least = settings.least_r_squared;
    let doubt = |joint: usize| {
        doubts.iter().find(|doubt| is_refusal(doubt) && doubt.about.subject == robot.subject(joint))
    };
    let poor = |joint: &usize| {
        let r_squared = held_out[*joint];
        // A joint with a quaternion on which no input acts has nothing to explain.
        let explains_nothing = r_squared.is_nan() && !layout.exact[*joint];
        layout.moves[*joint] && (r_squared < least || explains_nothing || doubt(*joint).is_some())
    };
    // A fault of one joint also makes the fit of other joints poor. So a joint with a doubt about its effort goes first.
    let doubted = (0..layout.joints).filter(&poor).find(|joint| doubt(*joint).is_some());
    let Some(joint) = doubted.or_else(|| (0..layout.joints).find(&poor)).filter(|_| !settings.accept_poor)
    else {
        return Ok(());
    };
    let r_squared = held_out[joint];
    let message = match r_squared >= least {
        true => format!(
            "its fit is refused, although R² is {r_squared:.3} on held-out data. The next finding is the reason"
        ),
        false => format!(
            "the fit does not explain its effort. R² is {r_squared:.3} on held-out data, but at least {least} is required"
        ),
    };
    let refusal = DOUBTED.found(message).with("R²", r_squared, "").of(robot.subject(joint));
    let reasons = doubt(joint).map_or_else(|| reasons(joint), |doubt| vec![doubt.clone()]);
    Err(IdentificationError::Found { findings: [vec![refusal], reasons].concat() })
}
