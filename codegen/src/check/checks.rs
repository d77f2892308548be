//! Checks of a single joint or body.

use crate::description::{BodyDescription, JointDescription, LimitsDescription, Name};
use crate::diagnostic::Report;
use crate::model::JointKind;
use crate::wording::as_written;
use gelenk_formula::Formula;

pub(super) fn joint(joint: &JointDescription, report: &mut Report) {
    let name = &joint.name;
    if let Some(position) = &joint.limits.position {
        let [low, high] = position.value;
        if joint.kind == Some(JointKind::Continuous) && joint.part_of.is_none() {
            let message = format!("joint `{}` is continuous but has position limits", name.value);
            report.error(position.span, "conflicting-keys", message);
            report.help("use type \"revolute\" for a joint with position limits, or remove the limits");
        }
        if low == high && joint.part_of.is_none() {
            let only = as_written(low);
            let message =
                format!("the position limits of joint `{}` allow only the position {only}", name.value);
            report.warning(position.span, "limits-equal", message);
            report.help(format!("use `held = {only}` to hold the joint there, or correct a limit"));
        }
        if low > high {
            let message = format!(
                "the position limits of joint `{}` are reversed: {} > {}",
                name.value,
                as_written(low),
                as_written(high)
            );
            report.error(position.span, "limits-reversed", message);
            report.help(format!(
                "use {} as the lower and {} as the upper limit",
                as_written(high),
                as_written(low)
            ));
        }
        if let Some(held) = joint.held.filter(|held| low <= high && !(low..=high).contains(held)) {
            let message = format!(
                "joint `{}` is held at {}, outside its limits {} … {}",
                name.value,
                as_written(held),
                as_written(low),
                as_written(high)
            );
            report.note(Some(name.span), "held-outside-limits", message);
        }
    }
    amounts(&joint.limits, name, report);
    if joint.kind == Some(JointKind::Fixed) {
        fixed(joint, report);
        note_limits_of_fixed(joint, report);
    } else if joint.follows.is_none()
        && let Some(offset) = &joint.offset
    {
        let message = format!("joint `{}` has an `offset` but follows no joint", name.value);
        report.error(offset.span, "conflicting-keys", message);
        report
            .help("`offset` is the position of a follower if the followed joints are at 0. Add `follows`, or remove `offset`");
    }
}

fn amounts(limits: &LimitsDescription, name: &Name, report: &mut Report) {
    for (what, limit) in limits.amounts() {
        if let Some(limit) = limit.as_ref().filter(|limit| limit.value <= 0.0) {
            let message = format!(
                "the {what} limit of joint `{}` is {}, but must be positive",
                name.value,
                as_written(limit.value)
            );
            report.error(limit.span, "not-positive", message);
        }
    }
    if let (Some(nominal), Some(peak)) = (&limits.effort, &limits.peak_effort)
        && nominal.value > peak.value
    {
        let message = format!(
            "the nominal effort {} of joint `{}` exceeds its peak effort {}",
            as_written(nominal.value),
            name.value,
            as_written(peak.value)
        );
        report.error(peak.span, "limits-reversed", message);
        report.help("`effort` is the continuous limit and `peak_effort` the short-time limit: exchange them, or correct one");
    }
}

fn fixed(joint: &JointDescription, report: &mut Report) {
    let what = if joint.held.is_some() {
        "`held`"
    } else if joint.follows.is_some() {
        "`follows`"
    } else if joint.drive.is_some() {
        "a drive"
    } else if joint.springs.is_some() {
        "a spring"
    } else if joint.friction.as_ref().is_some_and(|friction| !friction.value.is_empty()) {
        "friction"
    } else if joint.offset.is_some() {
        "`offset`"
    } else {
        return;
    };
    let message = format!("joint `{}` is fixed, so {what} has no effect", joint.name.value);
    report.error(joint.name.span, "fixed-joint", message);
    report.help("remove this entry, or give the joint a type that moves");
}

/// Adds a note about limits of a fixed joint. They are not an error, because a second file may fix a joint of
/// a description that limits it.
fn note_limits_of_fixed(joint: &JointDescription, report: &mut Report) {
    let limits = &joint.limits;
    let amounts = limits.amounts().into_iter().filter_map(|(_, limit)| limit.as_ref());
    let mut spans = limits.position.iter().map(|limit| limit.span).chain(amounts.map(|limit| limit.span));
    if let Some(span) = spans.next() {
        let message = format!("joint `{}` is fixed, so its limits have no effect", joint.name.value);
        report.note(Some(span), "fixed-joint", message);
        report.help("remove `limits`, or give the joint a type that moves");
    }
}

pub(super) fn body(body: &BodyDescription, defaults: &[f64], report: &mut Report) {
    let value = |formula: &Formula| formula.evaluate(defaults, 0.0, 0.0);
    let Some(mass) = &body.mass else {
        report.error(body.name.span, "missing-key", format!("body `{}` has no `mass`", body.name.value));
        report.help("write `mass = 0` for a body that has only inertia");
        return;
    };
    let kilograms = value(&mass.value);
    if !kilograms.is_finite() || kilograms < 0.0 {
        let message = format!("body `{}` has mass {}", body.name.value, as_written(kilograms));
        report.error(mass.span, "mass-not-positive", message).help("a mass must be finite and at least 0");
    }
    if body.center_in_link().iter().any(|entry| !value(entry).is_finite()) {
        let message = format!("the centre of mass of body `{}` is not finite", body.name.value);
        report.error(body.name.span, "number-not-finite", message);
    }
    let Some(inertia) = &body.inertia else { return };
    if inertia.value.iter().any(|entry| !value(entry).is_finite()) {
        let message = format!("the inertia of body `{}` is not finite", body.name.value);
        report.error(inertia.span, "number-not-finite", message);
    }
}
