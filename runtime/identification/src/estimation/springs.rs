//! Test whether a spring at one joint explains the efforts better: a cable that the joint winds up, or a spring that
//! balances an arm.

use super::super::error::Result;
use super::choice::Chosen;
use super::fit::fit;
use super::offer::{HELD, offered};
use super::task::Task;
use gelenk_findings::digits::plain;
use gelenk_findings::{Finding, Rule, Subject};

/// Weight of the prior that is small enough for the data alone to determine the stiffness.
const FREE: f64 = 1e-12;

/// Sees: efforts of a joint that another spring stiffness explains better, even if the bodies are fitted, too.
/// Matters: a spring that the description lacks causes errors of bodies and friction.
/// Example: a cable that the joint winds up.
/// Fixture: `spring` in `codegen/tests/findings/arm.rs`.
const SPRING: Rule = Rule::warning("spring");

/// The finding about the spring that improves the fit most; `None` if no spring improves it clearly. Rows of joints with
/// quaternions and of shafts have no spring.
pub(super) fn spring(task: &Task, chosen: &Chosen) -> Result<Option<Finding>> {
    let (layout, count) = (task.layout, task.layout.parameters);
    if layout.exact.contains(&true) || layout.known_gains.contains(&false) {
        return Ok(None);
    }
    let columns = |y: &[f64], regressor: &mut [f64]| {
        let rows = regressor.chunks_exact_mut(count + layout.joints).zip(y).enumerate();
        rows.for_each(|(joint, (row, y))| row[count + joint] = *y);
    };
    task.with_more((layout.joints, &columns), |task, sums| {
        let mut fitted = chosen.with_more(task.layout, sums, HELD);
        fitted.model.consistent = false;
        let own = fitted.held_out(task.prior)?;
        let mut clearest: Option<(usize, f64)> = None;
        for joint in layout.rubbing().filter(|joint| matches!(task.robot.subject(*joint), Subject::Joint(_)))
        {
            fitted.weighting.trust[count + joint] = FREE;
            let share = own.gain(&fitted.held_out(task.prior)?);
            fitted.weighting.trust[count + joint] = HELD;
            let most = clearest.map_or(0.0, |(_, most)| most);
            clearest = share.filter(|share| *share > most).map(|share| (joint, share)).or(clearest);
        }
        let Some((joint, share)) = clearest else { return Ok(None) };
        fitted.weighting.trust[count + joint] = FREE;
        let all = &fitted.centred.all;
        let solved = fit(&fitted.centred, all, &fitted.model, task.prior, &fitted.weighting, &fitted.values)?;
        let stiffness = solved.values.unknowns[count + joint];
        // A spring pulls back. A force that pushes away counts only if the description has a spring that is reduced by at
        // most twice its stiffness.
        let pulls_back = stiffness + 2.0 * described_stiffness(task, joint) > 0.0;
        Ok(pulls_back.then(|| offered(finding(task, joint, stiffness), share)))
    })
}

/// Derivative of the described forces of a joint, without the forces of bodies, with respect to its position, at the first
/// sample of the first run [N·m/rad or N/m].
fn described_stiffness(task: &Task, joint: usize) -> f64 {
    const STEP: f64 = 1e-3;
    let robot = task.robot;
    let (parameters, n) = (robot.parameters(), task.layout.joints);
    let (zero, mut forces, mut regressor) = (vec![0.0; n], vec![0.0; n], vec![0.0; n * parameters.len()]);
    let mut force = |shift: f64| {
        let mut y: Vec<f64> = task.runs.iter().take(1).flat_map(|run| &run.positions).map(|q| q[0]).collect();
        y[joint] += shift;
        robot.rigid_forces(&y, &zero, &zero, &mut forces);
        robot.inertial_regressor(&y, &zero, &zero, &mut regressor);
        let row = &regressor[joint * parameters.len()..][..parameters.len()];
        forces[joint] - row.iter().zip(&parameters).map(|(w, value)| w * value).sum::<f64>()
    };
    (force(STEP) - force(-STEP)) / (2.0 * STEP)
}

fn finding(task: &Task, joint: usize, stiffness: f64) -> Finding {
    let (shown, unit) = (plain(stiffness.abs(), 3), task.robot.position_units()[joint]);
    let force = if unit == "m" { "N" } else { "N·m" };
    let (side, change) = if stiffness > 0.0 { ("more", "increase") } else { ("less", "reduce") };
    let message =
        format!("the data are explained better with {shown} {force}/{unit} {side} stiffness than described");
    let remedy = format!(
        "if the joint has a spring or a cable that pulls, {change} its `spring = {{ stiffness = … }}` by {shown}; otherwise check \
         the load"
    );
    SPRING.found(message).with("stiffness", stiffness, "").of(task.robot.subject(joint)).help(remedy)
}
