//! Dead centres of cylinders: positions of the one joint that an input between two frames moves, at which it has no lever.

use super::super::description::{PointForceDescription, RobotDescription};
use super::super::distances::Distances;
use super::super::{ForceEffect, ForceInput, Model};
use crate::diagnostic::Report;
use crate::wording::three_digits;

/// Number of intervals of a joint's range.
const INTERVALS: u32 = 720;
/// Halvings after which an interval is one of neighbouring numbers.
const HALVINGS: u32 = 64;
/// Part of the longest lever below which a lever at the end of the range is none.
const NONE: f64 = 1e-6;

/// Warns if an input alone moves a joint through positions at which it cannot. A cylinder over several joints is left out: where
/// its lever about one of them vanishes, the others decide what it does.
pub(super) fn warn(
    force: &PointForceDescription,
    distances: &Distances<'_>,
    (robot, model): (&RobotDescription, &Model),
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
        format!("`{name}` has a dead centre {range}, at {places}: it exerts nothing on the joint there");
    report.warning(limits.map_or(force.name.span, |limits| limits.span), "dead-centre", message);
    report.help("no controller holds the joint there, and the force changes its sign: narrow the joint's `position` to one side, or move a frame");
}

/// Whether a drive or another cylinder moves the joint of a link too. A propeller beyond it seldom holds it.
fn others_act_on(link: usize, force: &PointForceDescription, model: &Model) -> bool {
    let mut driven = model.input_drives().flat_map(|drive| &drive.acts_on);
    let pulls = |input: &ForceInput| match &input.effect {
        ForceEffect::Wrench { .. } => false,
        ForceEffect::Pull(between) => Distances::new(model, between).changing().contains(&link),
    };
    let mut others = model.force_inputs.iter().filter(|input| input.name != force.name.value);
    driven.any(|moved| model.link_of(moved.coordinate) == Some(link)) || others.any(pulls)
}

/// Positions at which the derivative of a distance changes its sign, or vanishes at an end of the range.
fn dead_centres(distances: &Distances<'_>, link: usize, [low, high]: [f64; 2]) -> Vec<f64> {
    let lever = |position: f64| distances.slope(link, position);
    let place = |k: u32| low + (high - low) * f64::from(k) / f64::from(INTERVALS);
    let levers: Vec<[f64; 2]> = (0..=INTERVALS).map(place).map(|at| [at, lever(at)]).collect();
    let longest = levers.iter().fold(0.0_f64, |most, [_, lever]| most.max(lever.abs()));
    let is_none = |[_, lever]: &&[f64; 2]| lever.abs() <= NONE * longest;
    let (first, last) = (levers.first().filter(is_none), levers.last().filter(is_none));
    let inside = levers.windows(2).filter_map(|pair| {
        let ([before, a], [behind, b]) = (pair[0], pair[1]);
        let is_end = [first, last].iter().flatten().any(|end| end[0] == before || end[0] == behind);
        (a * b <= 0.0 && a != 0.0 && !is_end).then(|| crossing([before, behind], |at| lever(at) * a <= 0.0))
    });
    first.map(|end| end[0]).into_iter().chain(inside).chain(last.map(|end| end[0])).collect()
}

/// The position from which on something is so.
fn crossing([mut before, mut behind]: [f64; 2], is_so: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (before + behind);
        *(if is_so(middle) { &mut behind } else { &mut before }) = middle;
    }
    behind
}
