//! Notes about probable mistakes in a description: degrees, millimetres, legs with a fixed base, shapes
//! without mass, missing drives.
//!
//! Each kind of mistake has one note. Notes have no effect on the model.

use super::tree::Tree;
use crate::description::angles::{is_beyond_turns, looks_like_degrees};
use crate::description::{DriveChoice, JointDescription, RobotDescription};
use crate::diagnostic::{Report, Span};
use crate::model::JointKind;
use crate::model::name::identifier;
use crate::wording::{as_written, list, listed, three_digits};
use gelenk_formula::Formula;

/// Largest plausible length in m. Lengths of a robot in millimetres exceed it.
const FAR: f64 = 50.0;

/// Words in the names of links and joints of legs.
const LEG_WORDS: [&str; 9] = ["leg", "foot", "feet", "knee", "ankle", "calf", "thigh", "shin", "shank"];

/// Adds notes about probable mistakes to the report. The links must form a tree.
pub(super) fn note(robot: &RobotDescription, tree: &Tree, defaults: &[f64], report: &mut Report) {
    let moving = tree.moving(robot);
    note_degrees(robot, report);
    note_lengths(robot, tree, &moving, defaults, report);
    note_inertias(robot, tree, &moving, defaults, report);
    note_legs(robot, tree, report);
    note_shapes(robot, tree, report);
    warn_of_missing_drives(robot, report);
}

fn note_degrees(robot: &RobotDescription, report: &mut Report) {
    let turns =
        |joint: &&JointDescription| matches!(joint.kind, Some(JointKind::Revolute | JointKind::Continuous));
    let mut found: Vec<(Span, String)> = Vec::new();
    for joint in robot.joints.iter().filter(turns) {
        let name = joint.name.quoted();
        let limits = joint.limits.position.as_ref();
        if let Some(limits) = limits.filter(|limits| are_degrees(limits.value)) {
            let [low, high] = limits.value;
            found.push((limits.span, format!("{name} from {} to {}", as_written(low), as_written(high))));
        }
        if let Some(held) = joint.held.filter(|&held| looks_like_degrees(held)) {
            found.push((joint.name.span, format!("{name} held at {}", as_written(held))));
        }
    }
    let message = |entries| format!("these positions look like degrees, but are read as radians: {entries}");
    let help = "90° is 1.5707963267948966 in a URDF, `\"pi/2\"` in TOML";
    note_found(found, "looks-like-degrees", message, help, report);
}

/// Adds one note about all found entries, at the place of the first entry.
fn note_found(
    found: Vec<(Span, String)>,
    code: &'static str,
    message: impl Fn(String) -> String,
    help: &str,
    report: &mut Report,
) {
    if let Some(&(first, _)) = found.first() {
        let entries = listed(found.into_iter().map(|(_, entry)| entry));
        report.note(Some(first), code, message(entries)).help(help);
    }
}

fn are_degrees(limits: [f64; 2]) -> bool {
    let is_round = limits.iter().all(|limit| limit % 5.0 == 0.0);
    is_round && limits.into_iter().any(looks_like_degrees) || limits.into_iter().all(is_beyond_turns)
}

fn note_lengths(
    robot: &RobotDescription,
    tree: &Tree,
    moving: &[bool],
    defaults: &[f64],
    report: &mut Report,
) {
    let length = |entries: &[Formula; 3]| {
        let entries = entries.iter().map(|entry| entry.evaluate(defaults, 0.0, 0.0));
        entries.map(|entry| entry * entry).sum::<f64>().sqrt()
    };
    let mut found: Vec<(Span, String)> = Vec::new();
    for body in &robot.bodies {
        let moves = tree.index.get(&body.link.value).is_some_and(|&link| moving[link]);
        let distance = length(&body.center_in_link());
        if moves && distance.is_finite() && distance > FAR {
            let entry = format!("centre of mass of {} ({} m)", body.name.quoted(), three_digits(distance));
            found.push((body.name.span, entry));
        }
    }
    for (link, joint) in tree.joints.iter().enumerate() {
        let joint = joint.and_then(|joint| robot.joints.get(joint));
        let Some(joint) = joint.filter(|_| moving[tree.parents[link]]) else {
            continue;
        };
        let distance = joint.origin.as_ref().map_or(0.0, |origin| length(&origin.translation));
        if distance > FAR {
            let entry = format!("joint {} ({} m)", joint.name.quoted(), three_digits(distance));
            found.push((joint.name.span, entry));
        }
    }
    let message = |entries| {
        format!(
            "these positions are far from the frame of their link: {entries}. Check whether lengths are in millimetres"
        )
    };
    note_found(found, "far-away", message, "lengths are in m, inertias in kg m²", report);
}

/// Adds a note about inertias whose radius of gyration exceeds [`FAR`].
fn note_inertias(
    robot: &RobotDescription,
    tree: &Tree,
    moving: &[bool],
    defaults: &[f64],
    report: &mut Report,
) {
    let mut found: Vec<(Span, String)> = Vec::new();
    for body in &robot.bodies {
        let moves = tree.index.get(&body.link.value).is_some_and(|&link| moving[link]);
        let (Some(mass), Some(inertia)) = (&body.mass, &body.inertia) else { continue };
        let value = |formula: &Formula| formula.evaluate(defaults, 0.0, 0.0);
        let [xx, _, _, yy, _, zz] = inertia.value.each_ref().map(value);
        let (mass, largest) = (value(&mass.value), xx.max(yy).max(zz));
        let radius = (largest / mass).sqrt();
        if moves && radius.is_finite() && radius > FAR {
            let [mass, largest, radius] = [mass, largest, radius].map(three_digits);
            let entry = format!(
                "{} of {mass} kg has {largest} kg m², a radius of gyration of {radius} m",
                body.name.quoted()
            );
            found.push((inertia.span, entry));
        }
    }
    let message = |entries| {
        format!(
            "these inertias are too large for their masses: {entries}. Check whether the inertias are in kg mm²"
        )
    };
    note_found(found, "large-inertia", message, "inertias are in kg m²: 1 kg m² is 1e6 kg mm²", report);
}

/// Adds a note about a robot with legs and a fixed base. A single leg causes no note, because it may be
/// tested on a stand.
fn note_legs(robot: &RobotDescription, tree: &Tree, report: &mut Report) {
    if robot.joints.iter().any(|joint| joint.part_of.is_some()) {
        // The base is not fixed, or the author described what floats.
        return;
    }
    let mut legs: Vec<usize> = Vec::new();
    for link in tree.moved_links(robot) {
        let joint = tree.joints[link].and_then(|joint| robot.joints.get(joint));
        let names = [Some(&tree.links[link]), joint.map(|joint| &joint.name)];
        let is_leg = names.into_iter().flatten().any(|name| names_a_leg(&name.value));
        if is_leg && !tree.ancestors(link).any(|before| legs.contains(&before)) {
            legs.push(link);
        }
    }
    let (Some(base), Some(&first)) = (tree.links.first(), legs.get(1).and(legs.first())) else {
        return;
    };
    let joints = legs.iter().filter_map(|&link| robot.joints.get(tree.joints[link]?));
    let joints: Vec<&str> = joints.map(|joint| joint.name.value.as_str()).collect();
    let message = format!(
        "the robot seems to have {} legs ({}), but its base {} is fixed to the world",
        legs.len(),
        list(joints.into_iter()),
        base.quoted(),
    );
    report.note(Some(tree.links[first].span), "legs-on-fixed-base", message);
    report.help(
        "make the base floating with `--base floating` on the command line, or `base = { type = \
                 \"floating\" }` in a description",
    );
}

fn names_a_leg(name: &str) -> bool {
    // `identifier` turns `LKneePitch` into `lknee_pitch`. A word such as `upperleg` ends with the name of a part;
    // `footprint`, a link of mobile robots, does not.
    let name = identifier(name);
    let mut words = name.split('_');
    words.any(|word| {
        let word = word.trim_end_matches(|c: char| c.is_ascii_digit());
        LEG_WORDS.iter().any(|leg| word.ends_with(leg))
    })
}

/// Adds a note about links with a shape if neither the link nor a link that is fixed to it has a mass.
fn note_shapes(robot: &RobotDescription, tree: &Tree, report: &mut Report) {
    let carriers = tree.carriers(robot);
    let mut weighs = vec![false; tree.links.len()];
    for body in &robot.bodies {
        if let Some(&link) = tree.index.get(&body.link.value) {
            weighs[carriers[link]] = true;
        }
    }
    let shapes = robot.weightless_shapes.iter();
    let found: Vec<_> = shapes
        .filter(|name| {
            let carrier = tree.index.get(&name.value).map(|&link| carriers[link]);
            carrier.is_some_and(|carrier| carrier > 0 && !weighs[carrier])
        })
        .collect();
    let Some(first) = found.first() else { return };
    let message = format!(
        "these links have a shape but no <inertial>, so their mass is 0: {}",
        list(found.iter().map(|name| name.value.as_str()))
    );
    report.note(Some(first.span), "shape-without-mass", message);
}

/// Warns of effort limits of joints without a drive. `drive = "none"` suppresses the warning.
fn warn_of_missing_drives(robot: &RobotDescription, report: &mut Report) {
    let is_still = |joint: &&JointDescription| {
        let is_idle = joint.drive.is_none() && matches!(robot.drive_of(joint), DriveChoice::Passive);
        joint.is_coordinate() && is_idle && !robot.is_acted_on(joint)
    };
    let mut found = Vec::new();
    for joint in robot.joints.iter().filter(is_still) {
        if let Some(effort) = joint.limits.effort.as_ref().or(joint.limits.peak_effort.as_ref()) {
            found.push((effort.span, format!("{} {}", joint.name.quoted(), as_written(effort.value))));
        }
    }
    let Some(&(first, _)) = found.first() else { return };
    let entries = listed(found.into_iter().map(|(_, entry)| entry));
    let message = format!("the effort limits of these joints without a drive have no effect: {entries}");
    report.warning(first, "effort-without-drive", message);
    report.help("`drive = \"ideal\"` makes the joint's force or torque an input. `drive = \"none\"` gives it no input");
}
