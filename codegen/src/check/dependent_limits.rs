//! Checks the limits of joints that follow others against the limits of the followed joints.

use super::tree::Tree;
use crate::description::{JointDescription, LimitsDescription, RobotDescription};
use crate::diagnostic::Report;
use crate::model::Follower;
use crate::wording::{as_written, list, three_digits};

/// Relative tolerance for the rounding error of a quotient of two numbers in the description.
const ROUNDING: f64 = 1e-12;

/// A robot whose joints that follow other joints are checked.
pub(super) struct Limited<'d> {
    pub(super) robot: &'d RobotDescription,
    pub(super) tree: &'d Tree,
    /// Indices of the links of the coordinates, then of the links of driven joints (with prescribed motion).
    pub(super) coordinates: &'d [usize],
    /// Number of driven joints, whose motion is prescribed.
    pub(super) driven: usize,
    /// Values of the free parameters in the description.
    pub(super) defaults: &'d [f64],
}

impl<'d> Limited<'d> {
    /// Reports an error if no position satisfies the limits of a joint that follows others. Adds notes and
    /// warnings about limits that such a joint can exceed, and names the parts of the runtime that enforce
    /// these limits.
    pub(super) fn check(&self, followers: &[Follower], report: &mut Report) {
        for follower in followers {
            let joint = self.joint(follower.link);
            self.check_positions(joint, follower, report);
            self.note_speed(joint, follower, report);
        }
        self.warn_of_free_ratios(followers, report);
        for coordinate in 0..self.coordinates.len() {
            self.check_together(coordinate, followers, report);
        }
        let joints: Vec<&JointDescription> =
            followers.iter().map(|follower| self.joint(follower.link)).collect();
        note_efforts(&joints, report);
    }

    /// The joint of the description that carries a moving link.
    fn joint(&self, link: usize) -> &'d JointDescription {
        let joint = self.tree.joints[link];
        &self.robot.joints[joint.unwrap_or_else(|| unreachable!("a moving link has a joint"))]
    }

    /// Returns each ratio of a joint to a followed joint, with the limits of the followed joint.
    fn terms(&self, follower: &Follower) -> impl Iterator<Item = (f64, &'d LimitsDescription)> {
        follower.follows.iter().map(|term| {
            let followed = self.joint(self.coordinates[term.coordinate]);
            (term.ratio.evaluate(self.defaults, 0.0, 0.0), &followed.limits)
        })
    }

    /// Reports an error if a joint that follows others exceeds its position limits for all allowed positions
    /// of the followed joints.
    fn check_positions(&self, joint: &JointDescription, follower: &Follower, report: &mut Report) {
        let Some(limits) = &joint.limits.position else { return };
        let mut reach = [follower.offset; 2];
        for (ratio, followed) in self.terms(follower) {
            let own = followed.position.as_ref();
            let [low, high] = own.map_or([f64::NEG_INFINITY, f64::INFINITY], |limits| limits.value);
            let ends = [ratio * low, ratio * high];
            reach = [reach[0] + ends[0].min(ends[1]), reach[1] + ends[0].max(ends[1])];
        }
        let [low, high] = limits.value;
        if low <= high && (reach[1] < low || reach[0] > high) {
            let message = format!(
                "joint `{}` moves from {} to {} with the joints that it follows, outside its limits {} … {}",
                joint.name.value,
                three_digits(reach[0]),
                three_digits(reach[1]),
                as_written(low),
                as_written(high)
            );
            report.error(limits.span, "limits-exclude", message);
            report.help("no position satisfies all limits: correct the limits, the ratios or the `offset`");
        } else if (reach[0] < low || reach[1] > high) && !is_free(follower) {
            let message = format!(
                "joint `{}` can exceed its limits while the joints that it follows stay within their limits",
                joint.name.value
            );
            report.note(Some(limits.span), "dependent-limits", message);
            self.say_who_keeps(follower, report);
        }
    }

    /// Adds a help text that names the parts of the runtime that enforce the limits of a joint that follows
    /// others.
    fn say_who_keeps(&self, follower: &Follower, report: &mut Report) {
        let driven = self.coordinates.len() - self.driven;
        report.help(match &follower.follows[..] {
            terms if terms.iter().any(|term| term.coordinate >= driven) => {
                "the control loop brakes at these limits, and trajectory checks report violations. Predictive controllers report \
                 that they do not enforce limits that depend on driven joints"
            }
            [_] => {
                "the runtime narrows the limits of the followed joint. Control loop, predictive controllers and planned motions keep \
                 the limits of both joints"
            }
            _ => {
                "the control loop brakes at these limits, and trajectory checks report violations. Predictive controllers keep \
                 them with rows from `MpcRow::of_limits`"
            }
        });
    }

    /// Warns of limits that no controller enforces. If a ratio is a free parameter, the module does not
    /// contain the limits of the joint with this ratio.
    fn warn_of_free_ratios(&self, followers: &[Follower], report: &mut Report) {
        let has_limits =
            |joint: &&JointDescription| joint.limits.position.is_some() || joint.limits.velocity.is_some();
        let limited = followers
            .iter()
            .filter(|follower| is_free(follower))
            .map(|one| self.joint(one.link))
            .filter(has_limits);
        let limited: Vec<_> = limited.collect();
        let Some(first) = limited.first() else { return };
        let spans =
            [first.limits.position.as_ref().map(|l| l.span), first.limits.velocity.as_ref().map(|l| l.span)];
        let Some(span) = spans.into_iter().flatten().next() else { return };
        let names = list(limited.iter().map(|joint| joint.name.value.as_str()));
        let message = format!(
            "no controller keeps the limits of these followers, because their ratios depend on free parameters: {names}"
        );
        report.warning(span, "limits-not-kept", message);
        report.help("give the ratios as numbers, or enforce these limits with `MpcRow::dependent_joint` and `violations`");
    }

    /// Reports an error if the limits of joints that follow only this coordinate exclude all its positions.
    fn check_together(&self, coordinate: usize, followers: &[Follower], report: &mut Report) {
        let own = self.joint(self.coordinates[coordinate]).limits.position.as_ref();
        let mut lowest = own.map(|limits| (limits.value[0], None));
        let mut highest = own.map(|limits| (limits.value[1], None));
        for follower in followers {
            let Some([low, high]) = self.allowed(coordinate, follower) else { continue };
            let joint = self.joint(follower.link);
            if lowest.is_none_or(|(other, _)| low > other) {
                lowest = Some((low, Some(joint)));
            }
            if highest.is_none_or(|(other, _)| high < other) {
                highest = Some((high, Some(joint)));
            }
        }
        // `check_positions` reports a follower whose limits contradict the limits of the coordinate.
        let (Some((low, Some(a))), Some((high, Some(b)))) = (lowest, highest) else { return };
        let Some(limits) = &b.limits.position else { return };
        if low <= high + ROUNDING * (low.abs() + high.abs()) || std::ptr::eq(a, b) {
            return;
        }
        let followed = &self.joint(self.coordinates[coordinate]).name.value;
        let message = format!(
            "joints `{0}` and `{1}` follow `{followed}` with contradictory limits. `{0}` requires `{followed}` ≥ {2}, and `{1}` \
             requires `{followed}` ≤ {3}",
            a.name.value,
            b.name.value,
            as_written(low),
            as_written(high)
        );
        report.error(limits.span, "limits-exclude", message);
        report.help("no position satisfies all limits: correct the limits, the ratios or the `offset`");
    }

    /// Positions of a coordinate for which a joint that follows it is within its limits; `None` if the joint
    /// also follows other coordinates.
    fn allowed(&self, coordinate: usize, follower: &Follower) -> Option<[f64; 2]> {
        let [low, high] = self.joint(follower.link).limits.position.as_ref()?.value;
        let [only] = &follower.follows[..] else { return None };
        let ratio = only.ratio.evaluate(self.defaults, 0.0, 0.0);
        if only.coordinate != coordinate || low > high || ratio == 0.0 {
            return None;
        }
        let ends = [low, high].map(|end| (end - follower.offset) / ratio);
        Some([ends[0].min(ends[1]), ends[0].max(ends[1])])
    }

    /// Adds a note about a joint that can exceed its speed limit while the joints that it follows are within
    /// their limits.
    fn note_speed(&self, joint: &JointDescription, follower: &Follower, report: &mut Report) {
        let Some(limit) = &joint.limits.velocity else { return };
        let fastest = self.terms(follower).map(|(ratio, followed)| {
            ratio.abs() * followed.velocity.as_ref().map_or(f64::INFINITY, |limit| limit.value)
        });
        // A product of two written numbers is rounded.
        if fastest.sum::<f64>() > limit.value * (1.0 + 1e-12) && !is_free(follower) {
            let message = format!(
                "joint `{}` can exceed its speed limit while the joints that it follows stay within their limits",
                joint.name.value
            );
            report.note(Some(limit.span), "dependent-limits", message);
            self.say_who_keeps(follower, report);
        }
    }
}

/// Whether a ratio of a joint to the coordinates that it follows depends on free parameters.
fn is_free(follower: &Follower) -> bool {
    follower.follows.iter().any(|term| term.ratio.value(&[]).is_none())
}

/// Adds a note that effort limits of joints that follow others have no effect.
fn note_efforts(followers: &[&JointDescription], report: &mut Report) {
    let limited: Vec<_> = followers.iter().filter(|joint| joint.limits.effort.is_some()).collect();
    let Some(first) = limited.first().and_then(|joint| joint.limits.effort.as_ref()) else { return };
    let names = list(limited.iter().map(|joint| joint.name.value.as_str()));
    let message = format!("the effort limits of these followers have no effect: {names}");
    report.note(Some(first.span), "dependent-limits", message);
    report.help("the force of a follower is not an input: limit the drives or the followed joints");
}
