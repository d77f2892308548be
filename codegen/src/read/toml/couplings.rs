//! Joints that follow other joints, and drives on several joints (`[[drives]]`).

use super::forces::motor;
use super::table::{Item, Table};
use super::values::Reader;
use crate::description::{DriveDescription, FollowsDescription, SharedDriveDescription};
use crate::diagnostic::At;

/// Reads a table of joint names with ratios: `{ shoulder = 1, elbow = -1 }`.
pub(crate) fn followed_joints(
    reader: &mut Reader,
    item: Item<'_>,
    owner: &str,
) -> Option<Vec<FollowsDescription>> {
    let Some(terms) = item.named() else {
        item.expected("a table of joints with their ratios", &mut reader.report);
        return None;
    };
    if terms.is_empty() {
        reader.report.error(item.span, "follows-nothing", format!("`{}` names no joint", item.key));
        reader.report.help(format!("`{} = {{ shoulder = 1 }}` gives a joint and its ratio", item.key));
        return None;
    }
    let term = |term: Item<'_>| {
        let ratio = reader.formula(term, &format!("{owner}_{}", term.key))?;
        let joint = At::new(term.key.to_owned(), term.key_span);
        Some(FollowsDescription { joint, ratio: At::new(ratio, term.span) })
    };
    // All terms are read, so that all errors are reported.
    let terms: Vec<Option<FollowsDescription>> = terms.into_iter().map(term).collect();
    terms.into_iter().collect()
}

/// Reads the drives on several joints from the key `[[drives]]`.
pub(crate) fn read_drives(reader: &mut Reader, top: &Table<'_>) -> Vec<SharedDriveDescription> {
    reader.all(top, "drives", read_drive)
}

fn read_drive(reader: &mut Reader, table: &Table<'_>) -> Option<SharedDriveDescription> {
    let name = reader.name_of(table, "name")?;
    let on = followed_joints(reader, table.get("on")?, &name.value)?;
    let motor: DriveDescription = motor(reader, table, &name.value);
    Some(SharedDriveDescription { name, on, motor })
}
