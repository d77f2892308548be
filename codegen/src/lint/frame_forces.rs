//! Checks of forces between frames: distances that vanish, and probable mistakes in force laws.

use super::distances::Distances;
use super::{dead_centres, idle_inputs};
use crate::description::{PointForceDescription, RobotDescription};
use crate::diagnostic::{At, Report};
use crate::model::{Attachment, Drive, ForceEffect, Model};
use crate::wording::{list, three_digits};
use gelenk_findings::Rule;
use gelenk_formula::{Formula, Function};

/// Sees: a force between frames whose law has an exact `sign` of the rate.
/// Matters: the simulation models sticking of joints only, not sticking of distances between frames.
/// Example: `law = "50*sign(dl)"`.
/// Fixture: `a_force_that_jumps_with_the_sign_of_its_rate_is_noted` in `codegen/tests/doubts.rs`.
const DRY_FORCE: Rule = Rule::note("dry-force");

/// Sees: a force law whose rate-dependent part adds energy in every motion.
/// Matters: a damper with the sign of other conventions accelerates the robot.
/// Example: `law = "-40*dl"`.
/// Fixture: `a_law_that_feeds_every_motion_is_told` in `codegen/tests/motion_limits.rs`.
const DRIVING_FORCE: Rule = Rule::warning("driving-force");

/// Sees: a cylinder and a drive on the only joint between the ends of the cylinder.
/// Matters: two inputs act on one joint. Usually the drive of the joint should have been removed.
/// Example: a boom with a cylinder that extends a URDF, whose joints have ideal drives.
/// Fixture: `codegen/tests/snapshots/bad/strokes.toml.snap`.
const DRIVE_BESIDE: Rule = Rule::note("drive-beside-input");

/// Shorter distances between frames count as zero \[m\].
const SHORTEST: f64 = 1e-9;
/// Largest relative difference of the longest and the shortest distance between two frames that counts as
/// constant.
const CONSTANT: f64 = 1e-9;
/// Rates of a distance at which force laws are evaluated (m/s), with both signs. The rate 0 is added.
const RATES: [f64; 5] = [1e-3, 1e-2, 0.1, 1.0, 10.0];
/// A force law has a pole between two of the evaluated distances if it is this many times larger there than
/// at all evaluated distances.
const POLE: f64 = 1e6;
/// Number of steps of the search for a pole of a force law.
const THIRDS: u32 = 80;
const FINITE: &str = "a force law must be finite at every distance l that the joints' limits allow, and at every rate dl, \
                      including 0";
/// Number of distances at which force laws are evaluated, including both ends.
const LENGTHS: i32 = 21;

/// Checks forces between frames with the geometry of the whole model.
pub(super) fn check(robot: &RobotDescription, model: &Model, report: &mut Report) {
    for force in &robot.point_forces {
        let Some(between) = between(force, model) else { continue };
        let distances = Distances::new(model, between);
        let mut found = distances.at_states();
        let has_direction =
            has_direction(force, &found, report) && keeps_direction(force, &distances, &mut found, report);
        if let Some(law) = force.law.as_ref().filter(|_| has_direction) {
            check_law(force, law, &found, model, report);
        }
        if force.input.is_some() {
            note_drive_beside(force, between, model, report);
            let changing = distances.changing();
            if !changing.is_empty() && !changing.iter().any(|link| model.coordinates.contains(link)) {
                idle_inputs::refuse_on_driven(&force.name, model, report);
            }
            if has_direction {
                dead_centres::warn(force, &distances, robot, model, report);
            }
        }
    }
    idle_inputs::check_wrenches(robot, model, report);
    refuse_load(robot, model, report);
}

/// The frames between which a force acts; `None` if the model has no frames for it.
pub(super) fn between<'m>(force: &PointForceDescription, model: &'m Model) -> Option<&'m [Attachment; 2]> {
    let frames = force.between.each_ref().map(|name| &name.value);
    pairs(model).find(|between| between.each_ref().map(|at| &at.name) == frames)
}

/// Returns the two frames of each force between frames.
fn pairs(model: &Model) -> impl Iterator<Item = &[Attachment; 2]> {
    let pulls = model.force_inputs.iter().filter_map(|input| match &input.effect {
        ForceEffect::Pull(between) => Some(between),
        ForceEffect::Wrench { .. } => None,
    });
    model.point_forces.iter().map(|force| &force.between).chain(pulls)
}

fn has_direction(force: &PointForceDescription, found: &[f64], report: &mut Report) -> bool {
    let [a, b] = force.between.each_ref().map(|name| &name.value);
    let (shortest, longest) = ends(found);
    if shortest < SHORTEST {
        let message = format!("`{a}` and `{b}` coincide, so a force between them has no direction");
        report.error(force.between[1].span, "zero-length", message);
        report.help("the distance must stay above 0 at every position within the joints' limits");
    } else if longest - shortest <= CONSTANT * longest {
        let message = format!(
            "the distance of `{a}` and `{b}` is always {} m, so a force between them moves nothing",
            three_digits(longest)
        );
        report.error(force.between[1].span, "constant-length", message);
        report.help(
            "name frames whose distance changes with the joints between them, for example off the axis of a revolute joint",
        );
    }
    shortest >= SHORTEST
}

/// Adds the least distance between two frames over all positions to the found distances. If it is zero, it is
/// reported instead. Returns `false` if this is an error, because all joints have limits.
fn keeps_direction(
    force: &PointForceDescription,
    distances: &Distances<'_>,
    found: &mut Vec<f64>,
    report: &mut Report,
) -> bool {
    let closest = distances.closest();
    if closest.distance >= SHORTEST {
        found.push(closest.distance);
        return true;
    }
    let [a, b] = force.between.each_ref().map(|name| &name.value);
    let at =
        closest.positions.iter().map(|(joint, position)| format!("{joint} = {}", three_digits(*position)));
    let message = format!(
        "`{a}` and `{b}` coincide at {}, where a force between them has no direction",
        list(at.collect::<Vec<_>>().iter().map(String::as_str))
    );
    if closest.is_limited {
        report.error(force.between[1].span, "zero-length", message);
        report.help("the distance must stay above 0 at every position within the joints' limits");
    } else {
        // The surroundings of the robot may limit a joint without described limits, for example a floating base.
        report.note(Some(force.between[1].span), "zero-length", message);
        report.help(
            "the generated functions are not finite at this position: give joint limits that exclude it",
        );
    }
    !closest.is_limited
}

fn ends(found: &[f64]) -> (f64, f64) {
    let shortest = found.iter().fold(f64::INFINITY, |least, length| least.min(*length));
    (shortest, found.iter().fold(0.0, |most: f64, length| most.max(*length)))
}

fn check_law(
    force: &PointForceDescription,
    law: &At<Formula>,
    found: &[f64],
    model: &Model,
    report: &mut Report,
) {
    let defaults = model.described_parameters();
    let (shortest, longest) = ends(found);
    let part = |k: i32| f64::from(k) / f64::from(LENGTHS - 1);
    let lengths: Vec<f64> = (0..LENGTHS).map(|k| shortest + (longest - shortest) * part(k)).collect();
    let rates = RATES.iter().flat_map(|rate| [*rate, -rate]);
    let mut states = [0.0].into_iter().chain(rates).flat_map(|rate| lengths.iter().map(move |l| [*l, rate]));
    if let Some([l, rate]) = states.find(|[l, rate]| !law.value.evaluate(&defaults, *l, *rate).is_finite()) {
        let message = format!(
            "the force `{}` is not finite at l = {} m, dl = {} m/s",
            force.name.value,
            three_digits(l),
            three_digits(rate)
        );
        report.error(law.span, "force-not-finite", message).help(FINITE);
    } else if let Some(l) = pole(&lengths, |l| law.value.evaluate(&defaults, l, 0.0).abs()) {
        let message = format!("the force `{}` is unbounded at l = {} m", force.name.value, three_digits(l));
        report.error(law.span, "force-not-finite", message).help(FINITE);
    }
    warn_of_drive(force, law, &lengths, &defaults, report);
    if law.value.calls(Function::Sign) {
        let message = format!("the force `{}` is discontinuous at dl = 0", force.name.value);
        report.push(Some(law.span), DRY_FORCE.found(message));
        report.help(
            "the simulation supports sticking of joints, not of distances: use `tanh(100*dl)` or `--smooth-sign`",
        );
    }
}

/// Warns if the rate-dependent part of a force law adds energy in every motion, as a damper with the opposite
/// sign does.
fn warn_of_drive(
    force: &PointForceDescription,
    law: &At<Formula>,
    lengths: &[f64],
    defaults: &[f64],
    report: &mut Report,
) {
    let at = |l: f64, rate: f64| law.value.evaluate(defaults, l, rate);
    let rates = RATES.iter().flat_map(|rate| [*rate, -rate]);
    let mut taken = rates.flat_map(|rate| lengths.iter().map(move |l| (at(*l, rate) - at(*l, 0.0)) * rate));
    if taken.all(|power| power < 0.0) {
        let message = format!(
            "the force `{}` accelerates its ends at every rate, so it is not a damper",
            force.name.value
        );
        report.push(Some(law.span), DRIVING_FORCE.found(message));
        report.help("a positive force pulls the ends together: a damper is `40*dl`, not `-40*dl`");
    }
}

/// A place between `places` at which the magnitude of a function has a pole: a maximum that grows without
/// bound as it is approached. `None` without a pole.
fn pole(places: &[f64], magnitude: impl Fn(f64) -> f64) -> Option<f64> {
    let largest = places.iter().fold(0.0_f64, |most, place| most.max(magnitude(*place)));
    let around =
        |place: usize| [place.saturating_sub(1), (place + 1).min(places.len() - 1)].map(|at| places[at]);
    let is_highest =
        |place: &usize| around(*place).iter().all(|other| magnitude(*other) <= magnitude(places[*place]));
    let mut highest = (0..places.len()).filter(is_highest).map(|place| maximum(around(place), &magnitude));
    highest.find(|place| largest > 0.0 && magnitude(*place) > POLE * largest)
}

/// Place of the largest value of a function between two places, by repeated division into thirds.
fn maximum([mut low, mut high]: [f64; 2], value: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..THIRDS {
        let third = (high - low) / 3.0;
        let [a, b] = [low + third, high - third];
        if value(a) < value(b) { low = a } else { high = b }
    }
    0.5 * (low + high)
}

/// Adds a note about a cylinder with a drive on the only joint between its ends. Usually the drive of the
/// joint should have been removed.
fn note_drive_beside(
    force: &PointForceDescription,
    between: &[Attachment; 2],
    model: &Model,
    report: &mut Report,
) {
    let path = |at: &Attachment| {
        let parent = |link: &usize| model.links[*link].joint.as_ref().map(|joint| joint.parent);
        std::iter::successors(Some(at.link), parent).collect::<Vec<usize>>()
    };
    let [a, b] = between.each_ref().map(path);
    let between = a.iter().filter(|link| !b.contains(link)).chain(b.iter().filter(|link| !a.contains(link)));
    let driven: Vec<usize> = model.input_drives().filter_map(Drive::coordinate).collect();
    let driven =
        |link: &&usize| driven.iter().any(|&coordinate| model.coordinates.get(coordinate) == Some(*link));
    for link in between.filter(driven) {
        let joint = model.links[*link].joint.as_ref().map_or("", |joint| &joint.name);
        let message = format!("joint `{joint}` has both a drive and the input `{}`", force.name.value);
        report.push(Some(force.name.span), DRIVE_BESIDE.found(message));
        report.help("write `drive = \"none\"` at the joint if only the input acts");
    }
}

/// Reports an error if a joint has load-dependent friction and the robot has inputs at frames or wrenches.
/// The load of a joint is the force of its drive; other inputs and wrenches do not pass through its gear.
fn refuse_load(robot: &RobotDescription, model: &Model, report: &mut Report) {
    if model.force_inputs.is_empty() && model.wrenches.is_empty() {
        return;
    }
    let frictions = robot.joints.iter().filter_map(|joint| Some((joint, joint.friction.as_ref()?)));
    for (joint, friction) in frictions {
        let Some(load) = &friction.value.load else { continue };
        let message = format!(
            "joint `{}` has load-dependent friction, but the robot has wrenches or inputs at frames",
            joint.name.value
        );
        report.error(load.span, "load-with-forces", message);
        report.help("load-dependent friction requires that only drives at the joints act: remove `load`");
    }
}
