//! Identifiers for the names of a description.

use super::super::JointKind;
use super::super::description::{DriveChoice, JointDescription, Name, RobotDescription};
use super::super::name::{identifier, is_argument};
use crate::diagnostic::Report;
use std::collections::{BTreeMap, BTreeSet};

/// Identifiers and what had to be changed to get them.
#[derive(Debug, Default)]
pub(super) struct Names {
    changed: Vec<(Name, String)>,
}

impl Names {
    pub(super) fn identifier(&mut self, name: &Name, report: &mut Report) -> Option<String> {
        let Some(result) = identifier(&name.value) else {
            report.error(
                name.span,
                "unusable-name",
                format!("{:?} has no letter or digit", name.value),
            );
            report.help("names become Rust identifiers: use ASCII letters, digits and underscores");
            return None;
        };
        if result != name.value {
            self.changed.push((name.clone(), result.clone()));
        }
        Some(result)
    }

    /// Distinct identifiers of entries of one kind, in their order.
    fn distinct(
        &mut self,
        names: &[&Name],
        what: &str,
        prefix: Option<&str>,
        report: &mut Report,
    ) -> Vec<String> {
        let mut seen: BTreeMap<String, &Name> = BTreeMap::new();
        let mut result = Vec::new();
        for name in names {
            let Some(mut own) = self.identifier(name, report) else {
                // Reported; the entry keeps its place in the list.
                result.push(String::new());
                continue;
            };
            if let Some(prefix) = prefix.filter(|_| is_argument(&own)) {
                own = format!("{prefix}_{own}");
                self.changed.push(((*name).clone(), own.clone()));
            }
            if let Some(first) = seen.get(&own) {
                report_collision(first, name, &own, what, report);
            } else {
                seen.insert(own.clone(), name);
            }
            result.push(own);
        }
        result
    }

    pub(super) fn note(self, report: &mut Report) {
        let Some((first, _)) = self.changed.first() else {
            return;
        };
        let list = self
            .changed
            .iter()
            .take(6)
            .map(|(from, to)| format!("{:?} → `{to}`", from.value));
        let list = list.collect::<Vec<_>>().join(", ");
        let more = match self.changed.len() {
            0..=6 => String::new(),
            count => format!(" and {} more", count - 6),
        };
        report.note(
            Some(first.span),
            "name-mapped",
            format!("names in generated code: {list}{more}"),
        );
    }
}

fn report_collision(
    first: &Name,
    second: &Name,
    identifier: &str,
    what: &str,
    report: &mut Report,
) {
    let place = report.place(first.span);
    if first.value == second.value {
        let message = format!(
            "two {what} are named `{}`; the other one stands at {place}",
            second.value
        );
        report.error(second.span, "duplicate-name", message);
        report.help("give each its own name");
        return;
    }
    let message = format!(
        "{:?} and {:?} would both be `{identifier}` in generated code",
        first.value, second.value
    );
    report.error(second.span, "name-collision", message);
    report.help(format!(
        "rename one of them; the other one stands at {place}"
    ));
}

pub(super) fn report_duplicates<'d>(
    names: impl Iterator<Item = &'d Name>,
    what: &str,
    report: &mut Report,
) {
    let mut seen: BTreeMap<&str, &Name> = BTreeMap::new();
    for name in names {
        match seen.get(name.value.as_str()) {
            Some(first) => report_collision(first, name, &name.value, what, report),
            None => {
                seen.insert(&name.value, name);
            }
        }
    }
}

/// Identifiers of joints, frames and drives, in the order of their description.
#[derive(Debug)]
pub(super) struct JointNames {
    pub(super) joints: Vec<String>,
    pub(super) frames: Vec<String>,
    pub(super) drives: Vec<Option<String>>,
}

impl JointNames {
    pub(super) fn new(robot: &RobotDescription, names: &mut Names, report: &mut Report) -> Self {
        let joints: Vec<&Name> = robot.joints.iter().map(|joint| &joint.name).collect();
        let joints = names.distinct(&joints, "joints", Some("joint"), report);
        // Fixed joints do not appear in generated code.
        let fixed = robot
            .joints
            .iter()
            .filter(|joint| joint.kind == Some(JointKind::Fixed));
        let fixed: BTreeSet<&str> = fixed.map(|joint| joint.name.value.as_str()).collect();
        names
            .changed
            .retain(|(name, _)| !fixed.contains(name.value.as_str()));
        let frames: Vec<&Name> = robot.frames.iter().map(|frame| &frame.name).collect();
        let frames = names.distinct(&frames, "frames", None, report);
        let drive_name =
            |joint: &JointDescription| match joint.drive.as_ref().map(|drive| &drive.value) {
                Some(DriveChoice::Motor(motor)) => motor.name.clone(),
                _ => None,
            };
        let own: Vec<Option<Name>> = robot.joints.iter().map(drive_name).collect();
        let listed: Vec<&Name> = own.iter().flatten().collect();
        let mut mapped = names
            .distinct(&listed, "drives", Some("drive"), report)
            .into_iter();
        let drives = own
            .iter()
            .map(|name| name.as_ref().and_then(|_| mapped.next()))
            .collect();
        Self {
            joints,
            frames,
            drives,
        }
    }
}
