//! Which unknown stands in which column, and which columns an equation of a joint has.

use super::super::error::{IdentificationError, Result, require_length, require_samples};
use super::super::numeric::random::SplitMix64;
use super::super::pose::rows_of;
use super::super::robot::Robot;
use super::super::run::{Effort, PreparedRun};
use super::levels;
use super::result::Offsets;
use gelenk_findings::digits::two_digits;
use std::ops::Range;

/// Widths of the Coulomb term that are tried, as shares of the joint's fast speed.
const WIDTHS: [f64; 4] = [0.01, 0.025, 0.06, 0.15];
/// Candidate terms of a joint: v, the Coulomb terms, |v|, and ÿ.
pub(super) const TERMS: usize = WIDTHS.len() + 3;
pub(super) const VISCOUS: usize = 0;
pub(super) const COULOMB: Range<usize> = 1..1 + WIDTHS.len();
pub(super) const ASYMMETRY: usize = TERMS - 2;
pub(super) const ARMATURE: usize = TERMS - 1;
/// The term under load, |τ_l| tanh(k v), behind the others if the layout has it.
pub(super) const LOAD: usize = TERMS;

/// States at which the structure of W is looked up. One generic state shows it; more guard against chance.
const PROBES: usize = 4;

/// Columns of the equations, and prior knowledge about the data.
///
/// Unknowns count globally: the P inertial parameters (as differences from the description), then the candidate
/// terms of each joint, then what is left of the efforts' delays.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layout {
    pub(super) joints: usize,
    pub(super) parameters: usize,
    /// Candidate terms of each joint: [`TERMS`], or one more with [`LOAD`].
    pub(super) terms: usize,
    /// Global columns with entries in the joint's equation, ascending; behind them stand the described rigid force and
    /// the measured force.
    pub(super) local: Vec<Vec<usize>>,
    /// Number of the delay of each effort, if delays are not known; empty otherwise.
    pub(super) delays: Vec<usize>,
    /// Delays with entries in the joint's equation.
    pub(super) delays_of: Vec<Vec<usize>>,
    /// Factors k of the terms tanh(k v), for each joint.
    pub(super) steepness: Vec<[f64; WIDTHS.len()]>,
    /// Whether the joint moves and its force was measured.
    pub(super) moves: Vec<bool>,
    /// Whether the force is known without a sensor, as in the rows of a joint with a quaternion: no offset is in it, and no
    /// friction is estimated.
    pub(super) exact: Vec<bool>,
    /// Whether inertia of the joint's drive may be estimated in addition to the parameters.
    pub(super) takes_inertia: Vec<bool>,
    /// Whether the joint's force was measured: its equations have entries.
    pub(super) measured: Vec<bool>,
    pub(super) effort: Effort,
    /// Whether the joint's effort is a force up to B: no current, or one with a described motor constant.
    pub(super) known_gains: Vec<bool>,
    /// B, rows first.
    pub(super) input_matrix: Vec<f64>,
}

impl Layout {
    /// Joints that move, and whose efforts are measured; none if the described bodies calibrate the current.
    pub(super) fn known_efforts(&self) -> Vec<bool> {
        let is_known = |joint: usize| self.known_gains[joint] && self.moves[joint] && self.measured[joint];
        (0..self.joints).map(is_known).collect()
    }

    /// - `given`: factors of the Coulomb terms of each joint
    /// - `loads`: whether there is a term under load
    pub(super) fn new(
        robot: &dyn Robot,
        runs: &[PreparedRun],
        given: Option<&[f64]>,
        loads: bool,
    ) -> Result<Self> {
        let joints = robot.joint_names().len();
        let first = runs.first().ok_or(IdentificationError::Empty { what: "the list of runs".into() })?;
        for run in runs {
            check_run(robot, run, first.effort)?;
        }
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

    /// The layout before there are data: with given factors of the Coulomb terms of each joint.
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

    /// The layout where the delays of the efforts are not known.
    ///
    /// - `delays`: number of the delay of each effort
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

    /// Joints whose gains are to be found.
    pub(super) fn unknown_gains(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.joints).filter(|&joint| self.measured[joint] && !self.known_gains[joint])
    }

    /// The layout without the equations of joints that rest and whose gains are unknown: stiction holds such a joint, and its current
    /// does not tell its force.
    pub(super) fn without_resting_currents(self) -> Self {
        let rests = |joint: &usize| !self.known_gains[*joint] && !self.moves[*joint];
        let joints: Vec<usize> = (0..self.joints).filter(rests).collect();
        self.without(&joints)
    }

    /// The layout with more parameters of every joint, behind the others.
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

    /// The efforts that act on a joint, with their factors.
    pub(super) fn acting(&self, joint: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let own = (self.effort == Effort::Joint).then_some((joint, 1.0));
        let inputs = if own.is_some() { 0 } else { self.inputs() };
        let row = (0..inputs).map(move |input| (input, self.input_matrix[joint * inputs + input]));
        own.into_iter().chain(row.filter(|(_, factor)| *factor != 0.0))
    }

    /// Global number of a remaining delay.
    pub(super) fn delay(&self, number: usize) -> usize {
        self.parameters + self.joints * self.terms + number
    }

    /// Whether a global number is that of a delay.
    pub(super) fn is_delay(&self, global: usize) -> bool {
        global >= self.delay(0)
    }

    /// How many delays there are.
    pub(super) fn delay_count(&self) -> usize {
        self.delays.iter().map(|delay| delay + 1).max().unwrap_or(0)
    }

    /// Factor of a joint's column in its force: a delay moves the measured effort, which has a gain.
    pub(super) fn scale(&self, global: usize, gain: f64) -> f64 {
        if self.is_delay(global) { gain } else { 1.0 }
    }

    /// Global number of a candidate term.
    pub(super) fn term(&self, joint: usize, term: usize) -> usize {
        self.parameters + joint * self.terms + term
    }

    /// The joint and the number of a candidate term.
    pub(super) fn joint_and_term(&self, global: usize) -> Option<(usize, usize)> {
        let place = global.checked_sub(self.parameters)?;
        (!self.is_delay(global)).then(|| (place / self.terms, place % self.terms))
    }

    /// The joints whose friction is estimated.
    pub(super) fn rubbing(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.joints).filter(|&joint| self.moves[joint] && !self.exact[joint])
    }

    /// The samples of a run that tell about a joint: without its rests, in contiguous stretches. A joint that rests in all
    /// data has no law, and its constant stiction is an offset.
    pub(super) fn stretches(&self, run: &PreparedRun, joint: usize) -> Vec<Range<usize>> {
        if self.moves[joint] { run.moving(joint) } else { std::iter::once(0..run.times.len()).collect() }
    }

    /// The offsets of a joint's force where those of measured forces are `measured`.
    pub(super) fn offsets(&self, joint: usize, measured: Offsets) -> Offsets {
        if self.exact[joint] { Offsets::None } else { measured }
    }

    /// Number of global unknowns.
    pub(super) fn len(&self) -> usize {
        self.parameters + self.joints * self.terms + self.delay_count()
    }

    /// Place of a joint's first candidate term among its columns.
    pub(super) fn first_term(&self, joint: usize) -> usize {
        self.local[joint].len() - self.delays_of[joint].len() - self.terms
    }

    /// Columns of a joint's sums of products: its unknowns, the rigid force, the measured force.
    pub(super) fn width(&self, joint: usize) -> usize {
        self.local[joint].len() + 2
    }
}

fn check_run(robot: &dyn Robot, run: &PreparedRun, effort: Effort) -> Result<()> {
    let (joints, inputs) = (robot.joint_names().len(), robot.input_names().len());
    let of_run = |what: &str| format!("{what} of {}", run.name);
    require_samples(&of_run("samples"), 3, run.times.len())?;
    if run.effort != effort {
        return Err(IdentificationError::File {
            place: run.name.clone(),
            message: format!("its efforts are {:?}, those of the first run are {effort:?}", run.effort),
        });
    }
    let columns = if effort == Effort::Joint { joints } else { inputs };
    let mut kinds = vec![
        ("positions", &run.positions, joints),
        ("velocities", &run.velocities, joints),
        ("accelerations", &run.accelerations, joints),
    ];
    let entries = joints + robot.quaternion_joints().len();
    if entries > joints {
        kinds.push(("poses", &run.poses, entries));
    }
    for (kind, found, expected) in kinds {
        require_length(&of_run(kind), expected, found.len())?;
        for column in found {
            require_length(&of_run(kind), run.times.len(), column.len())?;
            super::super::error::require_finite(&of_run(kind), column)?;
        }
    }
    require_length(&of_run("efforts"), columns, run.efforts.len())?;
    for column in &run.efforts {
        require_length(&of_run("efforts"), run.times.len(), column.len())?;
        // A column of NaN says that nothing was measured.
        if !column.iter().all(|u| u.is_nan()) {
            super::super::error::require_finite(&of_run("efforts"), column)?;
        }
    }
    require_known_inputs(robot, effort)
}

/// Joints all of whose efforts were measured in all runs.
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

/// Efforts at inputs are those at the joints only through a known B.
fn require_known_inputs(robot: &dyn Robot, effort: Effort) -> Result<()> {
    if effort != Effort::Joint && robot.has_inputs_at_frames() {
        return Err(IdentificationError::File {
            place: "efforts".into(),
            message: "inputs act at frames, so that their forces at the joints depend on the positions; convert currents to \
                      forces of the inputs first, and say so (`--effort input`)"
                .into(),
        });
    }
    if known_gains(robot, effort).contains(&false) { require_own_inputs(robot) } else { Ok(()) }
}

/// For each joint, whether its efforts are forces up to B: no currents, or all with described motor constants.
fn known_gains(robot: &dyn Robot, effort: Effort) -> Vec<bool> {
    let joints = robot.joint_names().len();
    if effort != Effort::Current {
        return vec![true; joints];
    }
    let (b, described) = (robot.input_matrix(), robot.described_currents());
    let row = |joint: usize| b[joint * described.len()..].iter().zip(&described);
    (0..joints).map(|joint| row(joint).all(|(b, described)| *described || *b == 0.0)).collect()
}

/// A current's gain can be told from the joint's force only where each joint has one input of its own.
fn require_own_inputs(robot: &dyn Robot) -> Result<()> {
    let (joints, inputs) = (robot.joint_names(), robot.input_names());
    let b = robot.input_matrix();
    let entries = |of: &dyn Fn(usize) -> f64, n: usize| (0..n).filter(|&k| of(k) != 0.0).count();
    let rows = (0..joints.len()).all(|j| entries(&|i| b[j * inputs.len() + i], inputs.len()) == 1);
    let columns = (0..inputs.len()).all(|i| entries(&|j| b[j * inputs.len() + i], joints.len()) == 1);
    if rows && columns {
        return Ok(());
    }
    Err(IdentificationError::File {
        place: "drive gains".into(),
        message: "currents give gains only if each joint has one input of its own; convert the currents to \
                  forces of the inputs first"
            .into(),
    })
}

/// Global columns of each joint's equation.
fn local(robot: &dyn Robot, joints: usize, parameters: usize, terms: usize) -> Vec<Vec<usize>> {
    let structure = structure(robot, joints, parameters);
    let local = structure.iter().enumerate().map(|(joint, columns)| {
        let start = parameters + joint * terms;
        columns.iter().copied().chain(start..start + terms).collect()
    });
    local.collect()
}

/// Columns of W with entries in each joint's row, at generic states.
fn structure(robot: &dyn Robot, joints: usize, parameters: usize) -> Vec<Vec<usize>> {
    let mut random = SplitMix64::new(0x5EED);
    let quaternions = robot.quaternion_joints();
    let mut regressor = vec![0.0; joints * parameters];
    let mut found = vec![vec![false; parameters]; joints];
    for _ in 0..PROBES {
        // An attitude that is longer or shorter than one has the same structure.
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

/// Factors of the Coulomb candidates, with two digits, so that the printed expression is the one fitted.
fn steepness(runs: &[PreparedRun], joint: usize) -> [f64; WIDTHS.len()] {
    let fast = fast_speed(runs, joint);
    WIDTHS.map(|width| two_digits(1.0 / (width * fast)))
}

/// The speed that 95 % of the samples do not exceed; 1 for a joint that stands still.
pub(super) fn fast_speed(runs: &[PreparedRun], joint: usize) -> f64 {
    let mut speeds: Vec<f64> =
        runs.iter().flat_map(|run| run.velocities[joint].iter().step_by(7)).map(|v| v.abs()).collect();
    let at = (speeds.len() * 95 / 100).min(speeds.len() - 1);
    let (_, fast, _) = speeds.select_nth_unstable_by(at, f64::total_cmp);
    if *fast > 0.0 { *fast } else { 1.0 }
}
