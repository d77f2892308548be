//! Dead centres of cylinders: positions of a joint at which the only cylinder that moves it has the lever arm
//! zero.

use super::distances::{Distances, crossing, places};
use crate::description::{PointForceDescription, RobotDescription};
use crate::diagnostic::Report;
use crate::model::{ForceEffect, ForceInput, Model};
use crate::wording::three_digits;
use gelenk_findings::Rule;

/// Sees: a cylinder that alone moves a joint and has a zero lever arm at a position within the joint's limits.
/// Matters: no controller can hold the joint at this position, and the lever arm changes its sign there.
/// Example: a boom that may pass the line through the two ends of its cylinder.
/// Fixture: `a_cylinder_that_alone_moves_a_joint_through_its_dead_centre_is_told` in `codegen/tests/motion_limits.rs`.
const DEAD_CENTRE: Rule = Rule::warning("dead-centre");

/// A lever arm at an end of the joint's range counts as zero below this fraction of the longest lever arm.
const NONE: f64 = 1e-6;

/// Warns if a cylinder alone moves a joint and has a zero lever arm (dead centre) within the joint's range.
/// Cylinders over several joints are skipped: if their lever about one joint vanishes, the other joints
/// determine their effect.
pub(super) fn warn(
    force: &PointForceDescription,
    distances: &Distances<'_>,
    robot: &RobotDescription,
    model: &Model,
    report: &mut Report,
) {
    let [link] = distances.changing()[..] else { return };
    // Nothing needs to hold a driven joint, and a second input may hold what the first one cannot.
    if !model.coordinates.contains(&link) || others_act_on(link, force, model) {
        return;
    }
    let Some(joint) = model.links[link].joint.as_ref() else { return };
    let found = dead_centres(distances, link, joint.seeded_range());
    if found.is_empty() {
        return;
    }
    let unit = joint.kind.unit();
    let places: Vec<String> = found.iter().map(|at| format!("{} {unit}", three_digits(*at))).collect();
    let places = places.join(" and ");
    let (name, joint) = (&force.name.value, &joint.name);
    let described = robot.joints.iter().find(|described| described.name.value == *joint);
    let limits = described.and_then(|described| described.limits.position.as_ref());
    let range = match limits {
        Some(_) => format!("within the limits of joint `{joint}`"),
        None => format!("of joint `{joint}`, whose position has no limits"),
    };
    let message =
        format!("`{name}` has a dead centre {range}, at {places}, where its force on the joint is 0");
    report.push(Some(limits.map_or(force.name.span, |limits| limits.span)), DEAD_CENTRE.found(message));
    report.help(
        "at a dead centre the force changes its sign, and no controller can hold the joint. Narrow the joint's `position` to one \
         side, or move a frame",
    );
}

/// Whether a drive or another cylinder also moves the joint of a link. A propeller on the link does not
/// count, because it seldom holds the joint.
fn others_act_on(link: usize, force: &PointForceDescription, model: &Model) -> bool {
    let mut driven = model.input_drives().flat_map(|drive| &drive.acts_on);
    let pulls = |input: &ForceInput| match &input.effect {
        ForceEffect::Wrench { .. } => false,
        ForceEffect::Pull(between) => Distances::new(model, between).changing().contains(&link),
    };
    let mut others = model.force_inputs.iter().filter(|input| input.name != force.name.value);
    driven.any(|moved| model.link_of(moved.coordinate) == Some(link)) || others.any(pulls)
}

/// Positions of a joint at which the derivative of a distance changes its sign, or vanishes at an end of the
/// range.
fn dead_centres(distances: &Distances<'_>, link: usize, range: [f64; 2]) -> Vec<f64> {
    let lever = |position: f64| distances.slope(link, position);
    let levers: Vec<[f64; 2]> = places(range).into_iter().map(|at| [at, lever(at)]).collect();
    let longest = levers.iter().fold(0.0_f64, |most, [_, lever]| most.max(lever.abs()));
    let is_none = |[_, lever]: &&[f64; 2]| lever.abs() <= NONE * longest;
    let (first, last) = (levers.first().filter(is_none), levers.last().filter(is_none));
    let inside = levers.windows(2).filter_map(|pair| {
        let ([before, a], [behind, b]) = (pair[0], pair[1]);
        let is_end = [first, last].iter().flatten().any(|end| end[0] == before || end[0] == behind);
        (a * b <= 0.0 && a != 0.0 && !is_end)
            .then(|| crossing([before, behind], |at| lever(at) * a <= 0.0)[1])
    });
    first.map(|end| end[0]).into_iter().chain(inside).chain(last.map(|end| end[0])).collect()
}
