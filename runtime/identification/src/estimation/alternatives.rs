//! Whether the data are explained better by what the user did not say: gravity left out, or a sign.

use super::super::error::Result;
use super::super::robot::Robot;
use super::choice::Chosen;
use super::factors::factor;
use super::fit::{HeldOut, held_out};
use super::layout::{ARMATURE, LOAD};
use super::prior::Prior;
use super::result::Gravity;
use super::sums::{moving, sum};
use super::task::Task;
use gelenk_findings::{Finding, Rule};

/// An explanation counts as better where it lowers the held-out error by this share, and by two standard errors.
pub(super) const CLEARLY: f64 = 0.1;

/// R² below which a sign is doubted.
const POOR: f64 = 0.5;
/// Power of driving friction, as a share of the power of a force as large as the measured one.
const NOTICEABLE: f64 = 0.05;

/// Samples below which friction that drives a joint is no sign of a wrong sign: ten periods of the usual filter.
const FEWEST_SAMPLES: usize = 100;

/// Sees: efforts of a joint that fit the rigid body better with the other sign.
/// Matters: friction would drive the joint, and its masses would be wrong.
/// Example: a torque that counts against the position.
/// Fixture: `sign` in `codegen/tests/findings/arm.rs`.
const OTHER_SIGN: Rule = Rule::error("other-sign");

/// Sees: friction that drives a joint, and a rigid body that does not fit better with the other sign.
/// Matters: such a law is not passive.
/// Example: a controller that compensates more friction than there is.
/// Fixture: `estimation/tests/pendulum.rs`.
const DRIVING: Rule = Rule::error("driving-friction");

/// Sees: a log of too few samples to tell friction from chance.
/// Matters: no sign can be doubted.
/// Example: 2 s of slow motion.
/// Fixture: `estimation/tests/pendulum.rs`.
const TOO_SHORT: Rule = Rule::error("log-too-short");

/// Sees: efforts that fit better without gravity, or with it if it is said to be compensated.
/// Matters: masses come out wrong.
/// Example: a driver that reports torques without the weight.
/// Fixture: `without_gravity` in `codegen/tests/findings/arm.rs`.
const GRAVITY: Rule = Rule::warning("other-gravity");

fn other_sign() -> Finding {
    OTHER_SIGN.found("the data are explained better with the other sign of its effort").help(
        "check the signs of effort and position; --columns turns all columns, 'torque=tau{}[-1 Nm]', or one of them, \
         'torque=tau1|tau2[-1 Nm]|tau3'",
    )
}

fn driving() -> Finding {
    let message = "its friction comes out as driving it. With the other sign of its effort friction would brake, but the motion \
                   would not be explained better";
    let remedy = "check sign, unit and assignment of its columns, and whether the robot's controller compensates friction itself";
    DRIVING.found(message).help(remedy)
}

/// Weight of the description with which nothing changes its bodies.
const AS_DESCRIBED: f64 = 1e12;

/// Doubts about all joints, and those that refuse single ones.
pub(super) struct Doubts {
    pub(super) of_all: Vec<Finding>,
    pub(super) of_joints: Vec<Option<Finding>>,
}

impl Doubts {
    /// All of them; what would refuse a joint and was accepted is a warning.
    pub(super) fn findings(self) -> Vec<Finding> {
        self.of_all.into_iter().chain(self.of_joints.into_iter().flatten().map(Finding::accepted)).collect()
    }
}

/// Tries the other setting of gravity, and the other sign of the efforts of joints that are hardly explained or
/// whose friction drives them.
pub(super) fn other_explanations(task: &Task, chosen: &Chosen, own: &HeldOut) -> Result<Doubts> {
    let of_all = gravity(task, chosen)?.into_iter().collect();
    let mut of_joints = signs(task.robot, chosen, own, task.prior)?;
    if let Some(short) = too_short(task) {
        of_joints
            .iter_mut()
            .flatten()
            .for_each(|doubt| *doubt = short.clone().of(doubt.about.subject.clone()));
    }
    Ok(Doubts { of_all, of_joints })
}

/// Tries other factors of the efforts, where nothing else is doubted and no joint is hardly explained: what is wrong there
/// would pass for a factor.
pub(super) fn other_factors(
    task: &Task,
    chosen: &Chosen,
    held_out: &[f64],
    doubts: &mut Doubts,
) -> Result<()> {
    let poor = chosen.centred.layout.rubbing().any(|joint| held_out[joint] < POOR);
    let has_doubts = !doubts.of_all.is_empty() || doubts.of_joints.iter().any(Option::is_some);
    if poor || has_doubts || too_short(task).is_some() {
        return Ok(());
    }
    if let Some((joint, doubt)) = factor(chosen, task.prior)? {
        doubts.of_joints[joint] = Some(doubt.of(task.robot.subject(joint)));
    }
    Ok(())
}

/// Doubts about the sign of each joint's effort.
pub(super) fn signs(
    robot: &dyn Robot,
    chosen: &Chosen,
    own: &HeldOut,
    prior: &Prior,
) -> Result<Vec<Option<Finding>>> {
    let layout = chosen.centred.layout;
    let r_squared = chosen.centred_r_squared(&own.rss);
    let mut doubts = vec![None; layout.joints];
    for joint in layout.rubbing() {
        let drives = drives(chosen, joint);
        if !drives && r_squared[joint] >= POOR {
            continue;
        }
        let doubt = match (has_other_sign(prior, chosen, own, joint)?, drives) {
            (true, _) => Some(other_sign()),
            (false, true) => Some(driving()),
            (false, false) => None,
        };
        doubts[joint] = doubt.map(|doubt| doubt.of(robot.subject(joint)));
    }
    Ok(doubts)
}

/// What is said instead of a sign where friction cannot be told from chance. The residuals' correlation is no measure:
/// a wrong sign makes it long.
fn too_short(task: &Task) -> Option<Finding> {
    let samples: usize = task.runs.iter().map(|run| run.times.len()).sum();
    (samples < FEWEST_SAMPLES).then(|| {
        let message = format!(
            "the log is too short: {samples} samples are left after the filter, and friction cannot be told from chance"
        );
        TOO_SHORT.found(message).help("record a motion of 10 s or more")
    })
}

fn gravity(task: &Task, chosen: &Chosen) -> Result<Option<Finding>> {
    let compensated = task.settings.gravity_compensated;
    let mut rows = task.rows_where(Gravity::of(!compensated));
    let sums = sum(&mut rows, task.layout, task.runs, &task.pieces, &moving);
    let own = as_described(chosen.over(chosen.centred.sums), task.prior)?;
    let other = as_described(chosen.over(&sums), task.prior)?;
    let (excess, deviation) = other.excess(&own);
    if excess > -CLEARLY * own.total() || excess > -2.0 * deviation {
        return Ok(None);
    }
    let (what, remedy) = if task.layout.exact.contains(&true) {
        (
            "without",
            "check that the vertical of the log's axes is that of the description, and the order of the quaternion's entries",
        )
    } else if compensated {
        ("with", "leave out --gravity-compensated: the efforts seem to hold the weight")
    } else {
        (
            "without",
            "the robot compensates gravity outside the recorded efforts (--gravity-compensated), or is mounted otherwise than \
             described, as on a wall or a ceiling (`gravity = [x, y, z]`)",
        )
    };
    Ok(Some(GRAVITY.found(format!("the data are explained better {what} gravity")).help(remedy)))
}

/// Held-out error of the described bodies as they are, with friction and offsets fitted: free bodies would take up
/// much of a gravity that is not there.
fn as_described(mut chosen: Chosen, prior: &Prior) -> Result<HeldOut> {
    chosen.model.consistent = false;
    chosen.weighting.trust.fill(1.0);
    chosen.weighting.description = AS_DESCRIBED;
    chosen.held_out(prior)
}

/// Whether the rigid body fits better with the other sign of a joint's effort.
fn has_other_sign(prior: &Prior, chosen: &Chosen, own: &HeldOut, joint: usize) -> Result<bool> {
    let mut start = chosen.values.clone();
    start.gains[joint] = -start.gains[joint];
    let other = held_out(&chosen.centred, &chosen.model, prior, &chosen.weighting, &start)?;
    let (excess, deviation) = other.excess(own);
    Ok(excess < -CLEARLY * own.total() && excess < -2.0 * deviation)
}

/// Whether the estimated friction does noticeable work on the joint, `Σ v τ(v) < 0`.
fn drives(chosen: &Chosen, joint: usize) -> bool {
    let layout = chosen.centred.layout;
    let products = &chosen.centred.all[joint];
    let first = layout.first_term(joint);
    let term =
        |term: usize| chosen.values.unknowns[layout.term(joint, term)] * products[(first, first + term)];
    let power: f64 = (0..ARMATURE).chain(LOAD..layout.terms).map(term).sum();
    let last = products.nrows() - 1;
    let scale = chosen.values.gains[joint].abs() * (products[(first, first)] * products[(last, last)]).sqrt();
    power < -NOTICEABLE * scale
}
