//! Joint tables of a TOML description. A table describes a new joint, or refers to an existing joint with a
//! quaternion: the floating joint of the base, or a joint of the extended description. The table refers either
//! to the whole joint, with values for its parts, or to one velocity of the joint.

use super::joints::{by_part, check_all_parts, forces, of_part, read_joint, single_joint};
use super::table::Table;
use super::values::Reader;
use crate::description::{JointDescription, Name};
use crate::diagnostic::{At, Report};
use crate::read::composite::Composite;

/// Keys of a joint table for the pose of the joint.
const PLACE: [&str; 5] = ["origin", "dh", "modified_dh", "axis", "pitch"];

/// Keys of a joint table that only one velocity of a joint with a quaternion can have.
const SINGLE: [&str; 2] = ["follows", "offset"];

/// The joints of a file, and values for velocities of its floating base.
#[derive(Debug, Default)]
pub(crate) struct Joints {
    pub joints: Vec<JointDescription>,
    /// Values for velocities of the floating joint, if this file makes the base floating.
    pub velocities: Vec<JointDescription>,
}

/// Properties of the description that a file extends.
#[derive(Debug, Default)]
pub(crate) struct Extended {
    /// Joints with quaternions of the extended description, by name.
    pub quaternions: Vec<(String, Composite)>,
    /// Name of the floating joint that the base gets if it is made floating.
    pub base_joint: String,
    /// Whether an option makes the base of the extended description floating.
    pub is_to_float: bool,
}

/// Reads the joints of a file.
///
/// - `base`: name of the base, and whether this file makes it floating
pub(crate) fn read_joints(
    reader: &mut Reader,
    top: &Table<'_>,
    base: Option<&Name>,
    frees: bool,
    extended: Option<Extended>,
) -> Joints {
    let Some(item) = top.get("joints") else {
        return Joints::default();
    };
    let tables = item.tables(&mut reader.report);
    let extends = extended.is_some();
    let standing = standing(&tables, frees, extended);
    let mut joints: Vec<JointDescription> = Vec::new();
    let mut velocities: Vec<JointDescription> = Vec::new();
    for table in &tables {
        if let Some(told) = velocities_of(reader, table, &standing) {
            for velocity in told {
                add(velocity, &mut velocities, &mut reader.report);
            }
            continue;
        }
        for mut joint in read_joint(reader, table) {
            if !extends {
                chain(&mut joint, joints.last(), base);
            }
            joints.push(joint);
        }
    }
    if extends {
        joints.append(&mut velocities);
    }
    Joints { joints, velocities }
}

/// Joints with quaternions that need no table: the joints of the extended description, and the joint of a
/// floating base.
fn standing(tables: &[Table<'_>], frees: bool, extended: Option<Extended>) -> Vec<(String, Composite)> {
    let extended = extended.unwrap_or_else(|| {
        let is_own = |table: &Table<'_>| is_called(table, "base") && has_place(table);
        let base_joint = if tables.iter().any(is_own) { "floating_base" } else { "base" };
        Extended { base_joint: base_joint.to_owned(), ..Extended::default() }
    });
    let mut standing = extended.quaternions;
    let floats = standing.iter().any(|(_, joint)| *joint == Composite::FLOATING);
    if (frees || extended.is_to_float) && !floats {
        standing.push((extended.base_joint, Composite::FLOATING));
    }
    standing
}

/// Whether a table has keys for a pose, and so describes a new joint.
fn has_place(table: &Table<'_>) -> bool {
    ["parent", "child", "type"].iter().any(|key| table.get(key).is_some())
}

/// Sets the default links of a joint in a chain: the joint moves a link with the joint's name, and the link
/// of the previous joint carries it.
fn chain(joint: &mut JointDescription, before: Option<&JointDescription>, base: Option<&Name>) {
    let at = joint.name.span;
    let previous = before.and_then(|joint| joint.child.clone()).map(|link| At::new(link.value, at));
    let first = || base.cloned().unwrap_or_else(|| At::new("base".to_owned(), at));
    joint.parent.get_or_insert_with(|| previous.unwrap_or_else(first));
    joint.complete();
}

/// The velocities of an existing joint with a quaternion that a table describes; `None` if the table
/// describes a new joint.
///
/// - `standing`: the existing joints with quaternions
fn velocities_of(
    reader: &mut Reader,
    table: &Table<'_>,
    standing: &[(String, Composite)],
) -> Option<Vec<JointDescription>> {
    if has_place(table) {
        return None;
    }
    if let Some((_, joint)) = standing.iter().find(|(name, _)| is_called(table, name)) {
        let name = reader.name_of(table, "name")?;
        return Some(whole(reader, table, &name, *joint));
    }
    let is_part = |(name, joint): &(String, Composite)| {
        joint.parts().iter().any(|part| is_called(table, &format!("{name}_{}", part.name)))
    };
    let (joint, composite) = standing.iter().find(|joint| is_part(joint))?;
    let name = reader.name_of(table, "name")?;
    refuse(reader, table, &PLACE, joint, *composite);
    Some(vec![single_joint(reader, table, name, None)])
}

/// Whether the table has the key `name` with this value.
fn is_called(table: &Table<'_>, name: &str) -> bool {
    table.get("name").is_some_and(|item| item.value.as_str() == Some(name))
}

/// Returns the velocities of a joint with a quaternion for which its table has values.
fn whole(reader: &mut Reader, table: &Table<'_>, name: &Name, composite: Composite) -> Vec<JointDescription> {
    refuse(reader, table, &PLACE, &name.value, composite);
    refuse(reader, table, &SINGLE, &name.value, composite);
    check_all_parts(reader, table, name, composite);
    let mut told = Vec::new();
    for part in composite.parts() {
        if by_part(table).any(|item| of_part(table, composite, part, item.key).is_some()) {
            let own = At::new(format!("{}_{}", name.value, part.name), name.span);
            told.push(forces(reader, &|key| of_part(table, composite, part, key), own));
        }
    }
    told
}

fn refuse(reader: &mut Reader, table: &Table<'_>, keys: &[&str], joint: &str, composite: Composite) {
    for item in keys.iter().filter_map(|key| table.get(key)) {
        let message =
            format!("`{}` is given for {} joint `{joint}`, which already exists", item.key, composite.name());
        reader.report.error(item.key_span, "conflicting-keys", message);
        reader.report.help(format!(
            "remove `{}`. A new joint needs `parent`, or another name than `{joint}`",
            item.key
        ));
    }
}

/// Adds the values for a velocity to a list. A second table for the velocity is an error.
fn add(velocity: JointDescription, velocities: &mut Vec<JointDescription>, report: &mut Report) {
    if velocities.iter().any(|known| known.name.value == velocity.name.value) {
        let message = format!("velocity `{}` is described twice", velocity.name.value);
        report.error(velocity.name.span, "duplicate-name", message);
        report.help("describe the velocity in one table: either as a part of the joint, or by itself");
        return;
    }
    velocities.push(velocity);
}
