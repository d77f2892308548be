//! Test of remedies. Each remedy is a hypothesis about a change of the log or of the description. Another fit tests the
//! remedy, and a finding proposes it only if the error on held-out data falls clearly. The finding says by how much the error
//! falls.

use super::super::error::Result;
use super::super::robot::Robot;
use super::super::run::{Effort, PreparedRun};
use super::checks::Checked;
use super::choice::Chosen;
use super::factors::factor;
use super::fit::{HeldOut, held_out};
use super::layout::{ARMATURE, LOAD, Layout};
use super::levels;
use super::normal::{Centred, Model};
use super::offer::{Errors, FALL, as_described, fitted, offered, times};
use super::prior::Prior;
use super::result::Gravity;
use super::springs::spring;
use super::sums::{moving, sum};
use super::task::Task;
use gelenk_findings::{Finding, Rule, Severity, Subject};

/// Sees: efforts of a joint that fit the rigid body better with the other sign.
/// Matters: friction would drive the joint, and its masses would be wrong.
/// Example: a torque whose positive direction is opposite to that of the position.
/// Fixture: `sign` in `codegen/tests/findings/arm.rs`.
const OTHER_SIGN: Rule = Rule::error("other-sign");

/// Sees: friction that drives a joint, and a rigid body that does not fit better with the other sign.
/// Matters: such a law is not passive.
/// Example: a controller that compensates more friction than there is.
/// Fixture: `estimation/tests/pendulum.rs`.
const DRIVING: Rule = Rule::error("driving-friction");

/// Sees: a log with too few samples to distinguish friction from noise.
/// Matters: a wrong sign cannot be detected.
/// Example: 2 s of slow motion.
/// Fixture: `a_wrong_sign_and_forces_that_are_noise_are_refused` in `estimation/tests/simulated.rs`.
const TOO_SHORT: Rule = Rule::error("log-too-short");

/// Sees: efforts that fit better without gravity, or with gravity although the settings say that it is compensated.
/// Matters: the masses are wrong.
/// Example: a driver that reports torques without the weight, as UR's ROS 2 driver does.
/// Fixture: `without_gravity` in `codegen/tests/findings/arm.rs`.
const GRAVITY: Rule = Rule::error("other-gravity");

/// Sees: an effort that comes later or earlier than `--delay` says.
/// Matters: the delay causes errors of inertia and friction.
/// Example: `--delay 0` with efforts that are 50 ms early.
/// Fixture: `efforts_that_come_early_are_moved` in `codegen/tests/external_arm/main.rs`.
const DELAY: Rule = Rule::warning("other-delay");

/// Sees: columns that fit better in another order of the joints.
/// Matters: every joint would get the friction law and the body of another joint.
/// Example: columns in alphabetical order, as ROS writes them.
/// Fixture: `alphabetic` and `pan_lift` in `codegen/tests/findings/arm.rs`.
const ORDER: Rule = Rule::error("other-order");

fn other_sign() -> Finding {
    OTHER_SIGN.found("the data are explained better with the other sign of its effort").help(
        "check the signs of effort and position. To change the sign of all efforts, use --columns 'torque=tau{}[-1 Nm]'; to change \
         one sign, use --columns 'torque=tau1|tau2[-1 Nm]|tau3'",
    )
}

/// Whether a finding says that friction drives a joint and that no remedy is known.
pub(super) fn is_driving(finding: &Finding) -> bool {
    finding.code == DRIVING.code
}

fn driving() -> Finding {
    let message = "its estimated friction drives it. With the other sign of its effort, friction would brake, but the fit would \
                   not be better";
    let remedy = "check the sign, the unit and the assignment of its columns, and whether the robot's controller compensates friction";
    DRIVING.found(message).help(remedy)
}

/// Doubts about the robot as a whole, and for each joint the doubt because of which the result is refused, if there is one.
pub(super) struct Doubts {
    pub(super) of_all: Vec<Finding>,
    pub(super) of_joints: Vec<Option<Finding>>,
}

impl Doubts {
    /// All doubts. A refusal that was accepted is a warning.
    pub(super) fn findings(self) -> Vec<Finding> {
        self.of_all.into_iter().chain(self.of_joints.into_iter().flatten()).map(Finding::accepted).collect()
    }

    fn is_empty(&self) -> bool {
        self.of_all.is_empty() && self.of_joints.iter().all(Option::is_none)
    }

    /// Largest decrease of the held-out error by one of the hypotheses [%].
    fn most(&self) -> f64 {
        let all = self.of_all.iter().chain(self.of_joints.iter().flatten());
        all.filter_map(|finding| finding.value(FALL)).fold(0.0, f64::max)
    }

    /// Findings about the whole robot that refuse a result.
    pub(super) fn refusals(&self) -> Vec<Finding> {
        self.of_all.iter().filter(|finding| finding.severity == Severity::Error).cloned().collect()
    }
}

/// Tries the other setting of gravity. Also tries the other sign of the effort for joints that are hardly explained or whose
/// friction drives them.
///
/// - `ratio`: ratio of estimated and described forces of the robot as a whole
pub(super) fn other_explanations(
    task: &Task,
    (chosen, own): (&Chosen, &HeldOut),
    ratio: Option<f64>,
) -> Result<Doubts> {
    let of_all = gravity(task, chosen, own, ratio)?.into_iter().collect();
    let mut of_joints = signs(task.robot, chosen, own, task.prior)?;
    if let Some(short) = too_short(task) {
        of_joints
            .iter_mut()
            .flatten()
            .for_each(|doubt| *doubt = short.clone().of(doubt.about.subject.clone()));
    }
    Ok(Doubts { of_all, of_joints })
}

/// Tries the columns in other orders if there is a doubt. If an order is better than all other hypotheses, the finding about
/// the order replaces the findings about those hypotheses.
///
/// - `is_doubted`: whether there are other doubts
pub(super) fn other_order(
    task: &Task,
    chosen: &Chosen,
    own: &HeldOut,
    doubts: &mut Doubts,
    is_doubted: bool,
) -> Result<()> {
    let orders = if doubts.is_empty() && !is_doubted { Vec::new() } else { orders(task) };
    if orders.is_empty() || too_short(task).is_some() {
        return Ok(());
    }
    let described = as_described(chosen.over(chosen.centred.sums), task.prior)?;
    let mut best: Option<(Vec<usize>, f64)> = None;
    for order in orders {
        let Some(share) = described.gain(&in_order(task, chosen, &order, as_described)?) else { continue };
        if best.as_ref().is_none_or(|(_, most)| share > *most) {
            best = Some((order, share));
        }
    }
    if let Some((order, share)) = best.filter(|(_, share)| 100.0 * share > doubts.most())
        && !own.is_exceeded_by(&in_order(task, chosen, &order, fitted)?)
    {
        let names = task.robot.joint_names();
        let moved = (0..order.len()).filter(|j| order[*j] != *j);
        let said: Vec<String> =
            moved.map(|j| format!("{} has the columns of {}", names[order[j]], names[j])).collect();
        let finding = ORDER.found(format!("columns belong to other joints: {}", said.join(", ")));
        let finding = finding
            .help("name the columns in the order of the joints, for example --columns 'position=q3|q2|q1'");
        doubts.of_joints.fill(None);
        doubts.of_all = vec![offered(finding, share)];
    }
    Ok(())
}

/// Orders that are tried: names in alphabetical order, the reversed chain, and all exchanges of two joints. In an order,
/// joint j has the columns of joint `order[j]`.
fn orders(task: &Task) -> Vec<Vec<usize>> {
    let (names, units, layout) = (task.robot.joint_names(), task.robot.position_units(), task.layout);
    let count = names.len();
    let is_joint = |row: usize| matches!(task.robot.subject(row), Subject::Joint(_));
    let is_usual = layout.effort == Effort::Joint && !layout.exact.contains(&true);
    let has_own_columns = is_usual && (0..count).all(is_joint);
    if !has_own_columns || task.loads.is_some() || layout.measured.contains(&false) {
        return Vec::new();
    }
    let mut sorted: Vec<usize> = (0..count).collect();
    sorted.sort_by(|a, b| names[*a].cmp(&names[*b]));
    // The k-th column belongs to the k-th name.
    let mut by_name = vec![0; count];
    sorted.iter().enumerate().for_each(|(k, joint)| by_name[*joint] = k);
    let exchanged = |a: usize, b: usize| {
        let mut order: Vec<usize> = (0..count).collect();
        order.swap(a, b);
        order
    };
    let mut orders = vec![by_name, (0..count).rev().collect()];
    orders.extend((0..count).flat_map(|b| (0..b).map(move |a| exchanged(a, b))));
    let is_other = |order: &Vec<usize>| (0..count).any(|j| order[j] != j);
    let has_units = |order: &Vec<usize>| (0..count).all(|j| units[order[j]] == units[j]);
    let mut distinct: Vec<Vec<usize>> = Vec::new();
    for order in orders.into_iter().filter(|order| is_other(order) && has_units(order)) {
        if !distinct.contains(&order) {
            distinct.push(order);
        }
    }
    distinct
}

/// Held-out errors with columns in another order, one for each column. The chosen friction terms are reordered with the
/// columns.
fn in_order(task: &Task, chosen: &Chosen, order: &[usize], errors: Errors) -> Result<HeldOut> {
    fn moved_by<T: Clone>(order: &[usize], values: &[T]) -> Vec<T> {
        order.iter().map(|k| values[*k].clone()).collect()
    }
    let of = |columns: &Vec<Vec<f64>>| moved_by(order, columns);
    let with_order = |run: &PreparedRun| PreparedRun {
        positions: of(&run.positions),
        velocities: of(&run.velocities),
        accelerations: of(&run.accelerations),
        efforts: of(&run.efforts),
        resting: if run.resting.is_empty() { Vec::new() } else { moved_by(order, &run.resting) },
        ..run.clone()
    };
    let runs: Vec<PreparedRun> = task.runs.iter().map(with_order).collect();
    let layout = Layout::new(task.robot, &runs, task.settings.steepness.as_deref(), false)?;
    let other = Task { runs: &runs, layout: &layout, first_fit: None, ..task.clone() };
    let sums = other.sums_of(&moving);
    let model = Model {
        coulomb: moved_by(order, &chosen.model.coulomb),
        asymmetry: moved_by(order, &chosen.model.asymmetry),
        armature: moved_by(order, &chosen.model.armature),
        load: moved_by(order, &chosen.model.load),
        ..chosen.model.clone()
    };
    let zeros = moved_by(order, &chosen.centred.zeros);
    let mut moved = chosen.with_more(&layout, &sums, 1.0);
    moved.weighting.sigma = moved_by(order, &chosen.weighting.sigma);
    moved.centred = Centred::new(&layout, &sums, model.offsets, zeros);
    moved.model = model;
    let errors = errors(moved, task.prior)?;
    let mut rss = errors.rss.clone();
    order.iter().zip(&errors.rss).for_each(|(column, of_joint)| rss[*column] = *of_joint);
    Ok(HeldOut { rss, ..errors })
}

/// Findings about delays that the settings state, if the residual shows a further delay and the effort is better explained
/// with this delay. Other delays are unknowns of the fit and have no such finding.
pub(super) fn other_delays(
    task: &Task,
    (chosen, own): (&Chosen, &HeldOut),
    checked: &Checked,
) -> Result<Vec<Finding>> {
    let mut found = Vec::new();
    let stated = task.layout.delays.is_empty();
    for joint in task.layout.rubbing().filter(|_| stated) {
        let Some(seconds) = checked.delay(joint) else { continue };
        let other = earlier(task, chosen, (joint, seconds))?;
        let (excess, deviation) = other.excess(own);
        let share = 1.0 - other.rss[joint] / own.rss[joint];
        if share > levels::CLEARLY.get() && -excess > 2.0 * deviation {
            let way = if seconds > 0.0 { "later" } else { "earlier" };
            let message = format!(
                "compared with its position, its effort comes {:.1} ms {way} than the stated delay says",
                1e3 * seconds.abs()
            );
            let finding = DELAY.found(message).with("delay", seconds, "s").of(task.robot.subject(joint));
            let remedy = "leave --delay out, or give the whole delay with --delay SECONDS (positive if efforts are late)";
            found.push(offered(finding.help(remedy), share));
        }
    }
    Ok(found)
}

/// Held-out errors of the same choice if the efforts of a joint are shifted to earlier times by a number of seconds.
fn earlier(task: &Task, chosen: &Chosen, (joint, seconds): (usize, f64)) -> Result<HeldOut> {
    let mut delays = vec![0.0; task.runs.first().map_or(0, |run| run.efforts.len())];
    task.layout.acting(joint).for_each(|(effort, _)| delays[effort] = seconds);
    let runs: Vec<PreparedRun> = task.runs.iter().map(|run| run.clone().without_delays(&delays)).collect();
    let sums = Task { runs: &runs, ..task.clone() }.sums_of(&moving);
    chosen.over(&sums).held_out(task.prior)
}

/// Tries a spring at each joint, if there is no doubt except one about the direction of gravity. If a spring explains the
/// data better, its finding replaces the doubt about gravity.
pub(super) fn other_spring(task: &Task, chosen: &Chosen, doubts: &mut Doubts) -> Result<()> {
    let is_doubted = !doubts.refusals().is_empty() || doubts.of_joints.iter().any(Option::is_some);
    if is_doubted || too_short(task).is_some() {
        return Ok(());
    }
    if let Some(found) = spring(task, chosen)?
        && found.value(FALL).is_some_and(|fall| fall > doubts.most())
    {
        doubts.of_all = vec![found];
    }
    Ok(())
}

/// Tries other factors of the efforts, if there is no other doubt.
pub(super) fn other_factors(task: &Task, chosen: &Chosen, doubts: &mut Doubts) -> Result<()> {
    if !doubts.is_empty() || too_short(task).is_some() {
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
        if !drives && r_squared[joint] >= levels::POOR.get() {
            continue;
        }
        let doubt = match (other_sign_gain(prior, chosen, own, joint)?, drives) {
            (Some(share), _) => Some(offered(other_sign(), share)),
            (None, true) => Some(driving()),
            (None, false) => None,
        };
        doubts[joint] = doubt.map(|doubt| doubt.of(robot.subject(joint)));
    }
    Ok(doubts)
}

/// Finding that replaces a doubt about a sign if there are too few samples to distinguish friction from noise; `None` if
/// there are enough samples. The criterion is the number of samples, because a wrong sign makes the correlation time of the
/// residuals long.
fn too_short(task: &Task) -> Option<Finding> {
    let samples: usize = task.runs.iter().map(|run| run.times.len()).sum();
    (samples < levels::FEWEST_SAMPLES.get()).then(|| {
        let message = format!(
            "the log is too short: {samples} samples are left after the filter, and friction cannot be distinguished from noise"
        );
        TOO_SHORT.found(message).help("record a motion of 10 s or more")
    })
}

fn gravity(task: &Task, chosen: &Chosen, own: &HeldOut, ratio: Option<f64>) -> Result<Option<Finding>> {
    let compensated = task.settings.gravity_compensated;
    let mut rows = task.rows_where(Gravity::of(!compensated));
    let sums = sum(&mut rows, task.layout, task.runs, &task.pieces, &moving);
    let described = as_described(chosen.over(chosen.centred.sums), task.prior)?;
    let other = as_described(chosen.over(&sums), task.prior)?;
    let Some(share) = described.gain(&other) else { return Ok(None) };
    // If described bodies are too heavy or efforts are in a larger unit, the data are also better explained without gravity.
    let joints: Vec<usize> = (0..task.layout.joints).collect();
    let scaled = ratio.map(|ratio| times(chosen, &joints, 1.0 / ratio, as_described, task.prior));
    let is_scaled = scaled.transpose()?.is_some_and(|scaled| scaled.total() < other.total());
    // Forces that the description lacks may have the same effect. Fitted bodies show whether gravity is the cause.
    if is_scaled || own.is_exceeded_by(&fitted(chosen.over(&sums), task.prior)?) {
        return Ok(None);
    }
    let (what, remedy) = if task.layout.exact.contains(&true) {
        (
            "without",
            "check that the vertical axis of the log is that of the description, and check the order of the quaternion's entries",
        )
    } else if compensated {
        ("with", "leave out --gravity-compensated: the efforts seem to contain the weight")
    } else {
        (
            "without",
            "use --gravity-compensated if the robot compensates gravity outside the recorded efforts. If it is not mounted as \
             described, for example on a wall or a ceiling, set `gravity = [x, y, z]`",
        )
    };
    let finding = GRAVITY.found(format!("the data are explained better {what} gravity")).help(remedy);
    Ok(Some(offered(finding, share)))
}

/// Share by which the rigid body fits better with the other sign of a joint's effort; `None` if it does not fit clearly
/// better.
fn other_sign_gain(prior: &Prior, chosen: &Chosen, own: &HeldOut, joint: usize) -> Result<Option<f64>> {
    let mut start = chosen.values.clone();
    start.gains[joint] = -start.gains[joint];
    let other = held_out(&chosen.centred, &chosen.model, prior, &chosen.weighting, &start)?;
    Ok(own.gain(&other))
}

/// Whether the estimated friction τ(v) drives the joint noticeably: `Σ v τ(v)` is clearly negative.
fn drives(chosen: &Chosen, joint: usize) -> bool {
    let layout = chosen.centred.layout;
    let products = &chosen.centred.all[joint];
    let first = layout.first_term(joint);
    let term =
        |term: usize| chosen.values.unknowns[layout.term(joint, term)] * products[(first, first + term)];
    let power: f64 = (0..ARMATURE).chain(LOAD..layout.terms).map(term).sum();
    let last = products.nrows() - 1;
    let scale = chosen.values.gains[joint].abs() * (products[(first, first)] * products[(last, last)]).sqrt();
    power < -levels::NOTICEABLE_POWER.get() * scale
}
