//! Test whether a spring at one joint explains the efforts better: a cable that the joint winds up, or a spring that
//! balances an arm.

use super::super::error::Result;
use super::checks::Checked;
use super::task::Task;
use super::trial::{Bodies, Case, Change, Hypothesis, is_refusal};
use gelenk_findings::digits::plain;
use gelenk_findings::{Finding, Rule, Subject};

/// Sees: efforts of a joint that another spring stiffness explains better, even if the bodies are fitted, too.
/// Matters: a spring that the description lacks causes errors of bodies and friction.
/// Example: a cable that the joint winds up.
/// Fixture: `spring` in `codegen/tests/findings/arm.rs`.
const SPRING: Rule = Rule::warning("spring");

pub(super) const OTHER_STIFFNESS: Hypothesis = Hypothesis {
    when: |case, doubts| !doubts.iter().any(is_refusal) && case.too_short().is_none(),
    bodies: Bodies::Unbounded,
    is_alone: true,
    ..Hypothesis::of(SPRING, springs, finding)
};

/// For each joint, the change by a spring of unknown stiffness. Rows of joints with quaternions and of shafts have no spring.
fn springs(case: &Case) -> Result<Vec<Change>> {
    let layout = case.layout();
    let is_possible = !layout.exact.contains(&true) && !layout.known_gains.contains(&false);
    let is_joint = |joint: &usize| matches!(case.robot.subject(*joint), Subject::Joint(_)) && is_possible;
    Ok(layout.rubbing().filter(is_joint).map(Change::Spring).collect())
}

/// Described stiffness of a joint at the first sample of the first run [N·m/rad or N/m]. It is the derivative
/// of the described forces, without those of bodies, with respect to the joint's position.
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

fn finding(case: &Case, change: &Change, rule: &Rule) -> Result<Option<Finding>> {
    let (Change::Spring(joint), Some(Checked { task, .. }), Some(data)) =
        (change, case.checked, case.data(change)?)
    else {
        return Ok(None);
    };
    let mut fitted = case.changed(change, Some(&data));
    fitted.model.consistent = false;
    let solved = fitted.solved(&data.prior)?;
    let stiffness = solved.values.unknowns[task.layout.parameters + joint];
    // A spring pulls back. A force that pushes away counts only if the description has a spring that is reduced by at most
    // twice its stiffness.
    if stiffness + 2.0 * described_stiffness(task, *joint) <= 0.0 {
        return Ok(None);
    }
    let (shown, unit) = (plain(stiffness.abs(), 3), task.robot.position_units()[*joint]);
    let force = if unit == "m" { "N" } else { "N·m" };
    let (side, change) = if stiffness > 0.0 { ("more", "increase") } else { ("less", "reduce") };
    let message =
        format!("the data are explained better with {shown} {force}/{unit} {side} stiffness than described");
    let remedy = format!(
        "if the joint has a spring or a cable that pulls, {change} its `spring = {{ stiffness = … }}` by {shown}. Otherwise check \
         the load"
    );
    Ok(Some(rule.found(message).with("stiffness", stiffness, "").help(remedy)))
}
