//! Test whether friction depends on the load of the gears.

use super::super::error::Result;
use super::checks::Checked;
use super::layout::LOAD;
use super::task::Task;
use super::trial::{Case, Change, Hypothesis};
use gelenk_findings::{Finding, Rule};

/// Sees: load-dependent friction of a gear.
/// Matters: a law of the velocity alone is wrong under other loads.
/// Example: a worm gear.
/// Fixture: `friction_under_load_is_identified_where_it_is_asked_for` in `codegen/tests/command_line/identify.rs`.
const UNDER_LOAD: Rule = Rule::warning("friction-under-load");

pub(super) const FRICTION_UNDER_LOAD: Hypothesis = Hypothesis::of(UNDER_LOAD, loads, under_load);

impl Checked<'_> {
    /// Whether the residual of a joint shows load-dependent friction. Such friction leaves the residual
    /// `(|τ_l| − mean) sign(v)` with the load τ_l of the gear and the velocity v, because the Coulomb term explains the mean of
    /// |τ_l|.
    fn rubs_under_load(&self, joint: usize) -> bool {
        let Task { robot, layout, settings, .. } = self.task;
        // Without gravity, rigid forces are not the loads of the gears. A joint with a quaternion has no gear.
        let is_known = settings.load_friction || settings.gravity_compensated;
        if is_known || layout.exact[joint] || !robot.own_inputs()[joint] {
            return false;
        }
        let rigid = |run: usize, i: usize| self.forces.rigid[run][joint][i].abs();
        let all = self.forces.moving(self.task.layout, self.task.runs, joint).map(|(run, i)| rigid(run, i));
        let (sum, count) = all.fold((0.0, 0), |(sum, count), force| (sum + force, count + 1));
        let mean = sum / f64::from(count.max(1));
        let steepness = self.task.layout.steepness[joint][0];
        let direction = |run: usize, i: usize| (steepness * self.task.runs[run].velocities[joint][i]).tanh();
        self.explained(joint, &|run, i| (rigid(run, i) - mean) * direction(run, i))
            .is_some_and(|(factor, share)| factor > 0.0 && self.is_suspicious(share))
    }
}

/// Load-dependent friction of the joints whose residuals show such friction.
fn loads(case: &Case) -> Result<Vec<Change>> {
    let Some(checked) = case.checked else { return Ok(Vec::new()) };
    let joints = case.layout().rubbing().filter(|joint| checked.rubs_under_load(*joint));
    let joints: Vec<usize> = joints.collect();
    Ok((!joints.is_empty()).then_some(Change::Load(joints)).into_iter().collect())
}

fn under_load(case: &Case, change: &Change, rule: &Rule) -> Result<Option<Finding>> {
    let (Change::Load(joints), Some(data)) = (change, case.data(change)?) else { return Ok(None) };
    let solved = case.changed(change, Some(&data)).solved(&data.prior)?;
    let share = |joint: &usize| solved.values.unknowns[data.layout.term(*joint, LOAD)];
    let names = case.robot.joint_names();
    let said: Vec<String> = joints.iter().map(|j| format!("{:.2} at {}", share(j), names[*j])).collect();
    let message = format!(
        "friction grows with the load of the gear; the ratio of friction to load is about {}",
        said.join(", ")
    );
    // Other shares cannot exist.
    let can_exist = joints.iter().map(share).all(|share| share > 0.0 && share < 1.0);
    let finding = rule.found(message).with("share of the load", share(&joints[0]), "");
    Ok(can_exist.then(|| finding.help("use --load-friction")))
}
