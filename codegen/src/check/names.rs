//! Names in the description, and their identifiers in generated code.

use crate::description::{DriveChoice, JointDescription, Name, PointForceDescription, RobotDescription};
use crate::diagnostic::Report;
use crate::distinct::Distinct;
use crate::model::JointKind;
use crate::model::name::identifier;
use crate::wording::listed;
use std::collections::BTreeMap;

/// Identifiers of the module, joints, frames and drives in generated code. Lists have the order of the
/// description.
#[derive(Debug)]
pub(super) struct Identifiers {
    pub(super) module: String,
    /// Identifiers of the joints. Names of intermediate values in functions contain them.
    pub(super) joints: Vec<String>,
    /// Identifiers of the frames. Names of functions contain them.
    pub(super) frames: Vec<String>,
    /// For each joint the identifier of its drive; `None` if the joint has no drive.
    pub(super) drives: Vec<Option<String>>,
    /// Identifiers of the drives under `[[drives]]`.
    pub(super) shared_drives: Vec<String>,
}

impl Identifiers {
    /// Makes the identifiers and reports duplicate names. If two different names have the same identifier,
    /// the second one gets a number.
    pub(super) fn new(robot: &RobotDescription, report: &mut Report) -> Self {
        let joints: Vec<&Name> = robot.joints.iter().map(|joint| &joint.name).collect();
        let frames: Vec<&Name> = robot.frames.iter().map(|frame| &frame.name).collect();
        let drives: Vec<Option<&Name>> = robot.joints.iter().map(|joint| drive_name(robot, joint)).collect();
        let shared = robot.drives.iter().map(|drive| &drive.name);
        let driven: Vec<&Name> = drives.iter().copied().flatten().chain(shared).collect();
        let pulls = robot.point_forces.iter().filter_map(|force| force.input.as_ref());
        let at_frames =
            pulls.map(|input| &input.name).chain(robot.wrench_inputs.iter().map(|input| &input.name));
        let before = report.error_count();
        // The name of a spherical or floating joint must differ from the names of its velocities.
        let parts = robot.joints.iter().filter_map(|joint| joint.part_of.as_ref());
        let whole = parts.filter(|part| part.index == 0).map(|part| &part.joint);
        report_duplicates(whole.chain(joints.iter().copied()), "joints", report);
        if report.error_count() == before {
            // A drive without a name is called like its joint.
            report_duplicates(driven.iter().copied(), "drives", report);
        }
        if report.error_count() == before {
            report_duplicates(driven.iter().copied().chain(at_frames), "inputs", report);
        }
        // Several springs without a name may act between the same frames.
        let is_named = |force: &&PointForceDescription| {
            let [a, b] = force.between.each_ref().map(|name| &name.value);
            let own = &force.name.value;
            *own != format!("{a} – {b}") && force.input.as_ref().is_none_or(|input| input.name.value != *own)
        };
        report_duplicates(
            robot.point_forces.iter().filter(is_named).map(|force| &force.name),
            "forces",
            report,
        );
        report_duplicates(robot.wrenches.iter().map(|wrench| &wrench.name), "wrenches", report);
        report_duplicates(frames.iter().copied(), "frames", report);
        let mut of_drives = distinct(&driven).into_iter();
        Self {
            module: identifier(&robot.name.value),
            joints: distinct(&joints),
            frames: distinct(&frames),
            drives: drives.iter().map(|name| name.and_then(|_| of_drives.next())).collect(),
            shared_drives: of_drives.collect(),
        }
    }

    /// Adds a note about identifiers of the module and of frames that differ from the names in the
    /// description.
    pub(super) fn note(&self, robot: &RobotDescription, report: &mut Report) {
        let module = (&robot.name, self.module.clone());
        let module = Some(module).filter(|(name, identifier)| name.value != *identifier);
        let module = module.map(|(name, identifier)| (name, format!("`{identifier}`")));
        let frames = robot.frames.iter().map(|frame| &frame.name);
        let frames = frames.zip(&self.frames);
        let frames = frames.filter(|(name, identifier)| name.value != **identifier);
        let frames = frames.map(|(name, identifier)| (name, format!("`frame_{identifier}_…`")));
        let changed: Vec<(&Name, String)> = module.into_iter().chain(frames).collect();
        let Some((first, _)) = changed.first() else {
            return;
        };
        let entries = changed.iter();
        let entries = entries.map(|(name, identifier)| format!("{:?} → {identifier}", name.value));
        report.note(
            Some(first.span),
            "name-mapped",
            format!("the generated code uses these identifiers: {}", listed(entries)),
        );
    }
}

fn drive_name<'d>(robot: &'d RobotDescription, joint: &'d JointDescription) -> Option<&'d Name> {
    if joint.kind == Some(JointKind::Fixed) {
        return None;
    }
    match robot.drive_of(joint) {
        DriveChoice::Motor(motor) => motor.name.as_ref().or(Some(&joint.name)),
        DriveChoice::Ideal => Some(&joint.name),
        DriveChoice::Passive => None,
    }
}

/// Identifiers of names of one kind. If two different names have the same identifier, the second one gets a
/// number.
fn distinct(names: &[&Name]) -> Vec<String> {
    let mut taken = Distinct::default();
    let mut known: BTreeMap<&str, String> = BTreeMap::new();
    for name in names {
        known.entry(&name.value).or_insert_with(|| taken.take(&identifier(&name.value)));
    }
    names.iter().map(|name| known.get(name.value.as_str()).cloned().unwrap_or_default()).collect()
}

pub(super) fn report_duplicates<'d>(names: impl Iterator<Item = &'d Name>, what: &str, report: &mut Report) {
    let mut seen: BTreeMap<&str, &Name> = BTreeMap::new();
    for name in names {
        let Some(first) = seen.get(name.value.as_str()) else {
            seen.insert(&name.value, name);
            continue;
        };
        let place = report.place(first.span);
        let message = format!("two {what} are named `{}`: this one and the one at {place}", name.value);
        report.error(name.span, "duplicate-name", message).help("use different names");
    }
}
