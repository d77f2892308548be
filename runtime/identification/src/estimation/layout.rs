//! Order of the unknowns, and columns of the equation of each joint.

use super::super::error::{IdentificationError, Place, Result, require_length, require_samples};
use super::super::numeric::random::SplitMix64;
use super::super::pose::rows_of;
use super::super::robot::Robot;
use super::super::run::{Effort, PreparedRun};
use super::levels;
use super::result::Offsets;
use super::settings::EstimationSettings;
use gelenk_findings::digits::two_digits;
use std::ops::Range;

/// Candidate widths 1/k of the Coulomb term tanh(k v) with the velocity v, as shares of the joint's fast
/// speed ([`fast_speed`]).
const WIDTHS: [f64; 4] = [0.01, 0.025, 0.06, 0.15];
/// Number of candidate terms of a joint: velocity v, the Coulomb terms, |v|, and acceleration ÿ.
pub(super) const TERMS: usize = WIDTHS.len() + 3;
pub(super) const VISCOUS: usize = 0;
pub(super) const COULOMB: Range<usize> = 1..1 + WIDTHS.len();
pub(super) const ASYMMETRY: usize = TERMS - 2;
pub(super) const ARMATURE: usize = TERMS - 1;
/// Index of the load-dependent friction term |τ_l| tanh(k v) with the load τ_l, if the layout has this term.
pub(super) const LOAD: usize = TERMS;

/// Number of random states at which the nonzero columns of the regressor W are found. One state is enough
/// with probability one. More states are a safeguard.
const PROBES: usize = 4;

/// Columns of the equations of all joints, and properties of the data.
///
/// The unknowns have a common order: the P inertial parameters (as differences from the description), then the candidate
/// terms of each joint, then the remaining delays of the efforts.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layout {
    pub(super) joints: usize,
    pub(super) parameters: usize,
    /// Number of candidate terms of each joint: [`TERMS`], or one more with [`LOAD`].
    pub(super) terms: usize,
    /// Indices of the unknowns in each joint's equation, ascending. The equation also has columns of the
    /// described rigid-body force and of the measured force.
    pub(super) local: Vec<Vec<usize>>,
    /// For each effort, the index of its delay. Efforts with the same index share a delay. Empty if the delays are known.
    pub(super) delays: Vec<usize>,
    /// Indices of the delays in each joint's equation.
    pub(super) delays_of: Vec<Vec<usize>>,
    /// Factors k of the terms tanh(k v), for each joint.
    pub(super) steepness: Vec<[f64; WIDTHS.len()]>,
    /// Whether each joint moves and its force was measured.
    pub(super) moves: Vec<bool>,
    /// Whether each force is known without a sensor, as it is for a joint with a quaternion. These forces have no offset and
    /// no estimated friction.
    pub(super) exact: Vec<bool>,
    /// Whether inertia of each joint's drive may be estimated in addition to the parameters.
    pub(super) takes_inertia: Vec<bool>,
    /// Whether each joint's force was measured. A joint without a measured force has no equations.
    pub(super) measured: Vec<bool>,
    pub(super) effort: Effort,
    /// Whether each joint's effort is known as a force: it is not a current, or the motor constants of its inputs are
    /// described.
    pub(super) known_gains: Vec<bool>,
    /// Input matrix B, row by row.
    pub(super) input_matrix: Vec<f64>,
}

impl Layout {
    /// For each joint, whether it moves, has a measured effort, and has a known gain.
    pub(super) fn known_efforts(&self) -> Vec<bool> {
        let is_known = |joint: usize| self.known_gains[joint] && self.moves[joint] && self.measured[joint];
        (0..self.joints).map(is_known).collect()
    }

    /// Layout of the unknowns for prepared runs.
    ///
    /// - `given`: factors k of the Coulomb terms of each joint; `None` if the factors are chosen by the held-out error
    /// - `loads`: whether there is a term of load-dependent friction
    pub(super) fn new(
        robot: &dyn Robot,
        runs: &[PreparedRun],
        given: Option<&[f64]>,
        loads: bool,
    ) -> Result<Self> {
        let joints = robot.joint_names().len();
        let first = runs.first().ok_or(IdentificationError::Empty { what: "the list of runs".into() })?;
        for run in runs {
            require_samples(&format!("the fit to {}", run.name), 3, run.times.len())?;
            run.check(robot, first.effort, true)?;
        }
        require_known_inputs(robot, first.effort)?;
        if let Some(given) = given {
            require_length("factors of the Coulomb terms", joints, given.len())?;
        }
        let measured = measured(robot, runs);
        if !measured.contains(&true) {
            return Err(IdentificationError::Empty {
                what: "the list of joints with measured efforts".into(),
            });
        }
        let scales = robot.speed_scales();
        let moves = (0..joints)
            .map(|j| span(runs, j) > levels::STANDSTILL.get() * scales[j] && measured[j])
            .collect();
        let steepness =
            (0..joints).map(|j| given.map_or_else(|| steepness(runs, j), |k| [k[j]; WIDTHS.len()])).collect();
        let layout = Self::without_data(robot, first.effort, steepness, moves, loads)?;
        Ok(Self { measured, ..layout }.without_resting_currents())
    }

    /// The layout of an estimate with given settings.
    ///
    /// - `steepness`: factors k of the Coulomb terms tanh(k v) of each joint
    /// - `loads`: whether there is a term of load-dependent friction
    pub(super) fn of(
        robot: &dyn Robot,
        runs: &[PreparedRun],
        settings: &EstimationSettings,
        steepness: Option<&[f64]>,
        loads: bool,
    ) -> Result<Self> {
        let layout = Self::new(robot, runs, steepness, loads)?.without(&settings.without);
        match &settings.delays {
            Some(delays) => layout.with_delays(delays),
            None => Ok(layout),
        }
    }

    /// The layout before data are read, with given factors k of the Coulomb terms of each joint.
    pub(super) fn without_data(
        robot: &dyn Robot,
        effort: Effort,
        steepness: Vec<[f64; WIDTHS.len()]>,
        moves: Vec<bool>,
        loads: bool,
    ) -> Result<Self> {
        require_known_inputs(robot, effort)?;
        let (joints, parameters) = (robot.joint_names().len(), robot.parameters().len());
        let terms = TERMS + usize::from(loads);
        Ok(Self {
            joints,
            parameters,
            terms,
            local: local(robot, joints, parameters, terms),
            delays: Vec::new(),
            delays_of: vec![Vec::new(); joints],
            steepness,
            moves,
            exact: rows_of(&robot.quaternion_joints(), joints),
            takes_inertia: robot.takes_inertia(),
            measured: vec![true; joints],
            effort,
            known_gains: known_gains(robot, effort),
            input_matrix: robot.input_matrix(),
        })
    }

    /// The layout with unknown delays of the efforts.
    ///
    /// - `delays`: for each effort, the index of its delay
    pub(super) fn with_delays(mut self, delays: &[usize]) -> Result<Self> {
        let efforts = if self.effort == Effort::Joint { self.joints } else { self.inputs() };
        require_length("delays of the efforts", efforts, delays.len())?;
        self.delays = delays.to_vec();
        for joint in 0..self.joints {
            let mut own: Vec<usize> = self.acting(joint).map(|(effort, _)| delays[effort]).collect();
            own.sort_unstable();
            own.dedup();
            let globals: Vec<usize> = own.iter().map(|delay| self.delay(*delay)).collect();
            self.local[joint].extend(globals);
            self.delays_of[joint] = own;
        }
        Ok(self)
    }

    /// The layout without the equations of some joints.
    pub(super) fn without(mut self, joints: &[usize]) -> Self {
        for &joint in joints {
            (self.measured[joint], self.moves[joint]) = (false, false);
        }
        self
    }

    /// Joints whose gains are unknown.
    pub(super) fn unknown_gains(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.joints).filter(|&joint| self.measured[joint] && !self.known_gains[joint])
    }

    /// The layout without the equations of joints that rest and whose gains are unknown. Stiction holds a joint at rest, so
    /// its current does not determine its force.
    pub(super) fn without_resting_currents(self) -> Self {
        let rests = |joint: &usize| !self.known_gains[*joint] && !self.moves[*joint];
        let joints: Vec<usize> = (0..self.joints).filter(rests).collect();
        self.without(&joints)
    }

    /// The layout with `more` additional parameters, after the inertial ones, in the equation of every joint.
    pub(super) fn with_more_parameters(&self, more: usize) -> Self {
        let count = self.parameters;
        let of_joint = |local: &Vec<usize>| {
            let (own, others): (Vec<usize>, Vec<usize>) = local.iter().partition(|global| **global < count);
            let others = others.into_iter().map(|global| global + more);
            own.into_iter().chain(count..count + more).chain(others).collect()
        };
        Self { parameters: count + more, local: self.local.iter().map(of_joint).collect(), ..self.clone() }
    }

    fn inputs(&self) -> usize {
        self.input_matrix.len() / self.joints.max(1)
    }

    /// The efforts that act on a joint, with their factors in the input matrix B.
    pub(super) fn acting(&self, joint: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let own = (self.effort == Effort::Joint).then_some((joint, 1.0));
        let inputs = if own.is_some() { 0 } else { self.inputs() };
        let row = (0..inputs).map(move |input| (input, self.input_matrix[joint * inputs + input]));
        own.into_iter().chain(row.filter(|(_, factor)| *factor != 0.0))
    }

    /// Index of the unknown of a remaining delay.
    ///
    /// - `number`: index of the delay
    pub(super) fn delay(&self, number: usize) -> usize {
        self.parameters + self.joints * self.terms + number
    }

    /// Whether an unknown is a delay.
    pub(super) fn is_delay(&self, global: usize) -> bool {
        global >= self.delay(0)
    }

    /// Number of unknown delays of the efforts.
    pub(super) fn delay_count(&self) -> usize {
        self.delays.iter().map(|delay| delay + 1).max().unwrap_or(0)
    }

    /// Factor of an unknown's column in the force of a joint. The column of a delay is a rate of the measured effort, so its
    /// factor is `gain`. The other factors are one.
    pub(super) fn scale(&self, global: usize, gain: f64) -> f64 {
        if self.is_delay(global) { gain } else { 1.0 }
    }

    /// Index of the unknown of a candidate term.
    pub(super) fn term(&self, joint: usize, term: usize) -> usize {
        self.parameters + joint * self.terms + term
    }

    /// The joint and the term of an unknown; `None` if the unknown is not a candidate term.
    pub(super) fn joint_and_term(&self, global: usize) -> Option<(usize, usize)> {
        let place = global.checked_sub(self.parameters)?;
        (!self.is_delay(global)).then(|| (place / self.terms, place % self.terms))
    }

    /// The joints whose friction is estimated.
    pub(super) fn rubbing(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.joints).filter(|&joint| self.moves[joint] && !self.exact[joint])
    }

    /// Kind of the offsets of a joint's force. Forces that are known without a sensor have no offset.
    ///
    /// - `measured`: kind of the offsets of measured forces
    pub(super) fn offsets(&self, joint: usize, measured: Offsets) -> Offsets {
        if self.exact[joint] { Offsets::None } else { measured }
    }

    /// Number of all unknowns: inertial parameters, candidate terms and delays.
    pub(super) fn len(&self) -> usize {
        self.parameters + self.joints * self.terms + self.delay_count()
    }

    /// Index of a joint's first candidate term among its columns.
    pub(super) fn first_term(&self, joint: usize) -> usize {
        self.local[joint].len() - self.delays_of[joint].len() - self.terms
    }

    /// Number of columns of a joint's sums of products: its unknowns, the rigid force, the measured force.
    pub(super) fn width(&self, joint: usize) -> usize {
        self.local[joint].len() + 2
    }
}

/// For each joint, whether all its efforts were measured in all runs.
fn measured(robot: &dyn Robot, runs: &[PreparedRun]) -> Vec<bool> {
    let (joints, inputs) = (robot.joint_names().len(), robot.input_names().len());
    let b = robot.input_matrix();
    let known = |column: &Vec<f64>| column.iter().all(|u| u.is_finite());
    let of_run = |joint: usize, run: &PreparedRun| match run.effort {
        Effort::Joint => known(&run.efforts[joint]),
        _ => (0..inputs).all(|input| b[joint * inputs + input] == 0.0 || known(&run.efforts[input])),
    };
    let unmeasured = robot.unmeasured();
    (0..joints).map(|joint| !unmeasured[joint] && runs.iter().all(|run| of_run(joint, run))).collect()
}

/// Fails if inputs act at frames and efforts are inputs or currents, because the input matrix B is then not
/// constant. Also fails if gains of currents are unknown and joints and inputs do not correspond one to one.
fn require_known_inputs(robot: &dyn Robot, effort: Effort) -> Result<()> {
    if effort != Effort::Joint && robot.has_inputs_at_frames() {
        return Err(Place::default().fault(
            "efforts of inputs at frames are not supported here, because their forces at the joints depend on the positions. \
             Convert the efforts to forces at the joints, and use --effort joint",
        ));
    }
    if known_gains(robot, effort).contains(&false) { require_own_inputs(robot) } else { Ok(()) }
}

/// For each joint, whether its effort is known as a force: it is not a current, or all currents that act on the joint have
/// described motor constants.
fn known_gains(robot: &dyn Robot, effort: Effort) -> Vec<bool> {
    let joints = robot.joint_names().len();
    if effort != Effort::Current {
        return vec![true; joints];
    }
    let (b, described) = (robot.input_matrix(), robot.described_currents());
    let row = |joint: usize| b[joint * described.len()..].iter().zip(&described);
    (0..joints).map(|joint| row(joint).all(|(b, described)| *described || *b == 0.0)).collect()
}

/// Fails unless each joint has exactly one input and each input drives exactly one joint. Otherwise the gain of a current
/// does not follow from the joint's force.
fn require_own_inputs(robot: &dyn Robot) -> Result<()> {
    let (joints, inputs) = (robot.joint_names(), robot.input_names());
    let b = robot.input_matrix();
    let entries = |of: &dyn Fn(usize) -> f64, n: usize| (0..n).filter(|&k| of(k) != 0.0).count();
    let rows = (0..joints.len()).all(|j| entries(&|i| b[j * inputs.len() + i], inputs.len()) == 1);
    let columns = (0..inputs.len()).all(|i| entries(&|j| b[j * inputs.len() + i], joints.len()) == 1);
    if rows && columns {
        return Ok(());
    }
    Err(Place::default().fault(
        "motor constants can be estimated only if each joint has one input that drives no other joint. Convert the currents to \
         forces of the inputs first",
    ))
}

/// Indices of the unknowns in each joint's equation.
fn local(robot: &dyn Robot, joints: usize, parameters: usize, terms: usize) -> Vec<Vec<usize>> {
    let structure = structure(robot, joints, parameters);
    let local = structure.iter().enumerate().map(|(joint, columns)| {
        let start = parameters + joint * terms;
        columns.iter().copied().chain(start..start + terms).collect()
    });
    local.collect()
}

/// Indices of the regressor's columns that are not zero in each joint's row, determined at random states.
fn structure(robot: &dyn Robot, joints: usize, parameters: usize) -> Vec<Vec<usize>> {
    let mut random = SplitMix64::new(0x5EED);
    let quaternions = robot.quaternion_joints();
    let mut regressor = vec![0.0; joints * parameters];
    let mut found = vec![vec![false; parameters]; joints];
    for _ in 0..PROBES {
        // An attitude whose quaternion does not have unit length has the same structure.
        let [y, v, a]: [Vec<f64>; 3] = [joints + quaternions.len(), joints, joints]
            .map(|entries| (0..entries).map(|_| random.normal()).collect());
        regressor.fill(0.0);
        robot.inertial_regressor(&y, &v, &a, &mut regressor);
        for (row, found) in regressor.chunks_exact(parameters.max(1)).zip(&mut found) {
            found.iter_mut().zip(row).for_each(|(found, x)| *found |= *x != 0.0);
        }
    }
    found.iter().map(|row| (0..parameters).filter(|&i| row[i]).collect()).collect()
}

fn span(runs: &[PreparedRun], joint: usize) -> f64 {
    let all = || runs.iter().flat_map(|run| &run.positions[joint]);
    all().fold(f64::MIN, |a, x| a.max(*x)) - all().fold(f64::MAX, |a, x| a.min(*x))
}

/// Factors k of the candidate Coulomb terms, with two digits, so that the printed expression is the fitted one.
fn steepness(runs: &[PreparedRun], joint: usize) -> [f64; WIDTHS.len()] {
    let fast = fast_speed(runs, joint);
    WIDTHS.map(|width| two_digits(1.0 / (width * fast)))
}

/// The speed that 95 % of the samples do not exceed [rad/s or m/s]; 1 for a joint that does not move.
pub(super) fn fast_speed(runs: &[PreparedRun], joint: usize) -> f64 {
    let mut speeds: Vec<f64> =
        runs.iter().flat_map(|run| run.velocities[joint].iter().step_by(7)).map(|v| v.abs()).collect();
    let at = (speeds.len() * 95 / 100).min(speeds.len() - 1);
    let (_, fast, _) = speeds.select_nth_unstable_by(at, f64::total_cmp);
    if *fast > 0.0 { *fast } else { 1.0 }
}
