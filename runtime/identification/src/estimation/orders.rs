//! Hypothesis that the columns of a log are in another order than the joints. Possible reasons are sorted names, a reversed chain,
//! or two exchanged columns.

use super::super::error::Result;
use super::super::run::Effort;
use super::checks::Checked;
use super::trial::{Bodies, Case, Change, Hypothesis};
use super::unit::CommonRatio;
use gelenk_findings::{Finding, Rule, Subject};

/// Sees: columns that fit better in another order of the joints.
/// Matters: every joint would get the friction law and the body of another joint.
/// Example: columns in alphabetical order, as ROS writes them.
/// Fixture: `alphabetic` and `pan_lift` in `codegen/tests/findings/arm.rs`.
const ORDER: Rule = Rule::error("other-order");

pub(super) const OTHER_ORDER: Hypothesis = Hypothesis {
    when: |case, doubts| (!doubts.is_empty() || has_other_unit(case)) && case.too_short().is_none(),
    bodies: Bodies::Described,
    is_alone: true,
    ..Hypothesis::of(ORDER, orders, finding)
};

/// Whether the estimated rigid-body forces of a joint or of the robot are several times the described forces, or a fraction
/// of the described forces.
fn has_other_unit(case: &Case) -> bool {
    case.ratio.is_some_and(CommonRatio::is_other) || case.checked.is_some_and(Checked::has_other_unit)
}

/// Orders that are tried. Joint j has the columns of joint `order[j]`.
fn orders(case: &Case) -> Result<Vec<Change>> {
    let Some(Checked { task, .. }) = case.checked else { return Ok(Vec::new()) };
    let (names, units, layout) = (task.robot.joint_names(), task.robot.position_units(), task.layout);
    let count = names.len();
    let is_joint = |row: usize| matches!(task.robot.subject(row), Subject::Joint(_));
    let is_usual = layout.effort == Effort::Joint && !layout.exact.contains(&true);
    let has_own_columns = is_usual && (0..count).all(is_joint);
    if !has_own_columns || task.loads.is_some() || layout.measured.contains(&false) {
        return Ok(Vec::new());
    }
    // The k-th column belongs to the k-th name.
    let place = |name: &String| names.iter().filter(|other| *other < name).count();
    let by_name = names.iter().map(place).collect();
    let exchanged = |a: usize, b: usize| {
        let mut order: Vec<usize> = (0..count).collect();
        order.swap(a, b);
        order
    };
    let mut orders = vec![by_name, (0..count).rev().collect()];
    orders.extend((0..count).flat_map(|b| (0..b).map(move |a| exchanged(a, b))));
    let is_other = |order: &Vec<usize>| (0..count).any(|j| order[j] != j);
    let has_units = |order: &Vec<usize>| (0..count).all(|j| units[order[j]] == units[j]);
    let orders = orders.into_iter().filter(|order| is_other(order) && has_units(order));
    Ok(orders.map(Change::Order).collect())
}

fn finding(case: &Case, change: &Change, rule: &Rule) -> Result<Option<Finding>> {
    let Change::Order(order) = change else { return Ok(None) };
    let names = case.robot.joint_names();
    let moved = (0..order.len()).filter(|j| order[*j] != *j);
    let said: Vec<String> = moved
        .map(|j| format!("the values of {} are in the columns of {}", names[j], names[order[j]]))
        .collect();
    let finding = rule.found(format!("the columns of some joints seem to be exchanged: {}", said.join(", ")));
    Ok(Some(finding.help("name the columns in the order of the joints, as in --columns 'position=q3|q2|q1'")))
}
