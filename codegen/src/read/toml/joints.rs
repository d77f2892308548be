//! Joints of a TOML description.

use super::couplings::followed_joints;
use super::forces::{drive, friction, springs};
use super::keys::Value;
use super::table::{Item, Table};
use super::values::{Reader, unsaid};
use crate::description::{JointDescription, LimitsDescription, Name};
use crate::diagnostic::At;
use crate::model::pose::{about_z, modified_dh, standard_dh};
use crate::model::quaternion_joint::{NO_LAW_OF_POSITION, NO_ROTOR};
use crate::model::{JointKind, Pose, QuaternionKind};
use crate::read::composite::{self, Composite, Part, Place};
use gelenk_formula::Formula;

/// Type of a joint in a TOML description.
enum JointType {
    Single(JointKind),
    Composite(Composite),
}

/// Reads the joint of a table. A joint with several degrees of freedom becomes a chain of joints.
pub(crate) fn read_joint(reader: &mut Reader, table: &Table<'_>) -> Vec<JointDescription> {
    let Some(name) = reader.name_of(table, "name") else {
        return Vec::new();
    };
    let kind = match table.get("type").map(|item| read_type(reader, table, item, &name)) {
        Some(JointType::Composite(composite)) => return read_composite(reader, table, name, composite),
        Some(JointType::Single(kind)) => Some(kind),
        None => None,
    };
    refuse_pitch(reader, table, kind);
    vec![single_joint(reader, table, name, kind)]
}

pub(crate) fn single_joint(
    reader: &mut Reader,
    table: &Table<'_>,
    name: Name,
    kind: Option<JointKind>,
) -> JointDescription {
    if let (Some(held), Some(_)) = (table.get("held"), table.get("follows")) {
        let message = format!("joint `{}` is held and also follows others", name.value);
        reader.report.error(held.key_span, "conflicting-keys", message);
        reader.report.help("remove `held` or `follows`");
    }
    let owner = name.value.clone();
    let (origin, link_frame) = placement(reader, table, &owner);
    JointDescription {
        kind,
        parent: table.get("parent").and_then(|item| reader.name(item)),
        child: table.get("child").and_then(|item| reader.name(item)),
        origin,
        unsaid: unsaid(table.get("origin")),
        link_frame,
        axis: table.get("axis").and_then(|item| reader.axis(item)),
        follows: table.get("follows").map(|item| {
            // Unreadable entries were reported. The joint still counts as a follower.
            At::new(followed_joints(reader, item, &owner).unwrap_or_default(), item.key_span)
        }),
        offset: table.get("offset").and_then(|item| reader.number(item)),
        ..forces(reader, &|key| table.get(key), name)
    }
}

/// Reads limits, drive, friction, springs and held position of a joint. The pose is not read.
///
/// - `value`: returns the value of a key
pub(crate) fn forces<'t>(
    reader: &mut Reader,
    value: &impl Fn(&str) -> Option<Item<'t>>,
    name: Name,
) -> JointDescription {
    let owner = name.value.clone();
    JointDescription {
        held: value("held").and_then(|item| reader.number(item)).map(|number| number.value),
        driven: value("motion").and_then(|item| read_motion(reader, item)),
        limits: value("limits").and_then(|item| read_limits(reader, item)).unwrap_or_default(),
        springs: value("spring").map(|item| At::new(springs(reader, item, &owner), item.span)),
        friction: value("friction")
            .and_then(|item| Some(At::new(friction(reader, item, &owner)?, item.span))),
        drive: value("drive").and_then(|item| drive(reader, item, &owner)),
        ..JointDescription::named(name)
    }
}

/// Reads whether a joint's motion is prescribed, so that the joint is driven.
fn read_motion(reader: &mut Reader, item: Item<'_>) -> Option<At<bool>> {
    let driven = item.word(&mut reader.report)? == "driven";
    Some(At::new(driven, item.span))
}

fn read_type(reader: &mut Reader, table: &Table<'_>, item: Item<'_>, name: &Name) -> JointType {
    let kind = match item.word(&mut reader.report) {
        Some("fixed") => JointKind::Fixed,
        Some("continuous") => JointKind::Continuous,
        Some("prismatic") => JointKind::Prismatic,
        Some("helical") => JointKind::Helical { pitch: pitch(reader, table, name) },
        word => match word.and_then(Composite::named) {
            Some(composite) => return JointType::Composite(composite),
            // An unknown type counts as revolute, so that it causes no further error.
            None => JointKind::Revolute,
        },
    };
    JointType::Single(kind)
}

/// The pitch of a helical joint (m/rad). After an error it is 1.
fn pitch(reader: &mut Reader, table: &Table<'_>, name: &Name) -> f64 {
    const HELP: &str = "`pitch` is the translation in m per rad. `pitch = \"0.02/(2*pi)\"` is 20 mm per turn. Negative values are \
                        left-handed screws";
    let Some(item) = table.get("pitch") else {
        let message = format!("helical joint `{}` has no `pitch`", name.value);
        reader.report.error(name.span, "missing-key", message).help(HELP);
        return 1.0;
    };
    match reader.number(item) {
        Some(pitch) if pitch.value == 0.0 => {
            reader.report.error(item.span, "pitch", format!("the pitch of joint `{}` is 0", name.value));
            reader.report.help(format!("{HELP}. Use type \"revolute\" for a joint that does not slide"));
            1.0
        }
        Some(pitch) => pitch.value,
        None => 1.0,
    }
}

fn refuse_pitch(reader: &mut Reader, table: &Table<'_>, kind: Option<JointKind>) {
    let Some(item) = table.get("pitch").filter(|_| !matches!(kind, Some(JointKind::Helical { .. }))) else {
        return;
    };
    reader.report.error(
        item.key_span,
        "conflicting-keys",
        "`pitch` is given, but the type is not \"helical\"",
    );
    reader.report.help("only helical joints have a pitch: give the joint this type, or remove `pitch`");
}

/// Values of a joint's table that may be given for each part of a joint with several degrees of freedom.
pub(crate) fn by_part<'t>(table: &Table<'t>) -> impl Iterator<Item = Item<'t>> {
    table.items().iter().copied().filter(|item| matches!(item.row.value, Value::ByPart(_)))
}

/// Whether a value is one word that applies to all parts of a joint with several degrees of freedom.
fn is_for_all_parts(item: &Item<'_>) -> bool {
    item.value.is_str() && !item.row.value.words().is_empty()
}

/// Reads a joint with several degrees of freedom as a chain of joints.
fn read_composite(
    reader: &mut Reader,
    table: &Table<'_>,
    name: Name,
    composite: Composite,
) -> Vec<JointDescription> {
    refuse_pitch(reader, table, None);
    refuse_in_composites(reader, table, composite);
    check_all_parts(reader, table, &name, composite);
    let place = Place {
        parent: table.get("parent").and_then(|item| reader.name(item)),
        child: table.get("child").and_then(|item| reader.name(item)),
        origin: table.get("origin").and_then(|item| reader.pose(item, &name.value)),
        axis: table.get("axis").and_then(|item| reader.axis(item)).unwrap_or([0.0, 0.0, 1.0]),
    };
    composite::expand(composite, &name, place, |part, name| {
        forces(reader, &|key| of_part(table, composite, part, key), name)
    })
}

/// Value of a key for one part of a joint with several degrees of freedom; `None` without a value for this
/// part.
pub(crate) fn of_part<'t>(
    table: &Table<'t>,
    composite: Composite,
    part: &Part,
    key: &str,
) -> Option<Item<'t>> {
    match table.get(key)? {
        _ if key == "held" && composite.quaternion().is_some() => None, // reported
        // One word for all parts.
        item if is_for_all_parts(&item) => Some(item),
        item => item.named()?.into_iter().find(|entry| entry.key == part.name),
    }
}

/// Reports values that do not name the parts of the joint, or that name unknown parts.
pub(crate) fn check_all_parts(reader: &mut Reader, table: &Table<'_>, name: &Name, composite: Composite) {
    for item in by_part(table) {
        if let (Some(kind), "held") = (composite.quaternion(), item.key) {
            let message = format!("{} joint `{}` cannot have `held`", kind.name(), name.value);
            reader.report.error(item.key_span, "quaternion-joint", message).help(kind.how_to_hold());
            continue;
        }
        check_parts(reader, item, name, composite);
    }
}

/// Reports a value that is not given for each part of a joint with several degrees of freedom.
fn check_parts(reader: &mut Reader, item: Item<'_>, name: &Name, composite: Composite) {
    let kind = composite.name();
    let help = || {
        format!(
            "give a value for each part ({}): `{} = {{ {} = … }}`",
            composite.listed(),
            item.key,
            composite.parts()[0].name
        )
    };
    let Some(entries) = item.named() else {
        if !is_for_all_parts(&item) {
            let message = format!("`{}` of {kind} joint `{}` does not name its parts", item.key, name.value);
            reader.report.error(item.span, "wrong-type", message).help(help());
        }
        return;
    };
    for entry in entries {
        if composite.parts().iter().any(|part| part.name == entry.key) {
            continue;
        }
        if let Some(reason) = composite.quaternion().and_then(|kind| refused(kind, item.key, entry.key)) {
            let message =
                format!("`{}` has no meaning in `{}` of {kind} joint `{}`", entry.key, item.key, name.value);
            reader.report.error(entry.key_span, "quaternion-joint", message).help(reason);
            continue;
        }
        let message = format!("{kind} joint `{}` has no part `{}`", name.value, entry.key);
        reader.report.error(entry.key_span, "unknown-key", message);
        let part = composite.parts()[0].name;
        reader.report.help(match item.row.value.keys().is_some_and(|keys| keys.row(entry.key).is_some()) {
            true => format!(
                "the parts are {}. Give each part a value: `{} = {{ {part} = {{ {} = … }} }}`",
                composite.listed(),
                item.key,
                entry.key
            ),
            false => help(),
        });
    }
}

/// Reason why a joint with a quaternion cannot have a key of joints with one position; `None` for other keys.
fn refused(kind: QuaternionKind, key: &str, entry: &str) -> Option<&'static str> {
    match (key, entry) {
        ("limits", "position") => Some(kind.why_unlimited(0)),
        ("spring", "stiffness" | "rest") => Some(NO_LAW_OF_POSITION),
        ("drive", "rotor_inertia") => Some(NO_ROTOR),
        _ => None,
    }
}

/// Reports keys that only joints with one degree of freedom can have.
fn refuse_in_composites(reader: &mut Reader, table: &Table<'_>, composite: Composite) {
    let kind = composite.name();
    for item in ["dh", "modified_dh", "follows", "offset"].iter().filter_map(|key| table.get(key)) {
        reader.report.error(
            item.key_span,
            "conflicting-keys",
            format!("a {kind} joint has no `{}`", item.key),
        );
        reader.report.help(match item.key {
            "dh" | "modified_dh" => "give the pose of the joint with `origin`",
            _ => "describe a part that follows others as a separate joint",
        });
    }
    let help = match composite {
        Composite::Universal => {
            "the joint rotates about the x axis of its frame, then about the y axis. Rotate the frame with `origin`"
        }
        Composite::Quaternion(_) => "the joint rotates about every axis: rotate its frame with `origin`",
        Composite::Cylindrical | Composite::Planar => return,
    };
    if let Some(item) = table.get("axis") {
        reader.report.error(item.key_span, "conflicting-keys", format!("a {kind} joint has no `axis`"));
        reader.report.help(help);
    }
}

/// Pose of the joint's frame. For a standard Denavit–Hartenberg row, also the frame of the link after the
/// joint.
fn placement(reader: &mut Reader, table: &Table<'_>, owner: &str) -> (Option<Pose>, Option<Pose>) {
    let given: Vec<Item<'_>> =
        ["origin", "dh", "modified_dh"].iter().filter_map(|key| table.get(key)).collect();
    if let [first, second, ..] = given.as_slice() {
        let message = format!("`{}` and `{}` both give the pose of the joint", first.key, second.key);
        reader.report.error(second.key_span, "conflicting-keys", message).help("remove one of them");
    }
    if let (Some(row), Some(axis)) = (given.iter().find(|item| item.key != "origin"), table.get("axis")) {
        let message =
            format!("`axis` and `{}` are both given, but the axis of a Denavit–Hartenberg row is z", row.key);
        reader.report.error(axis.key_span, "conflicting-keys", message);
        reader.report.help("remove `axis`, or give the pose with `origin`");
    }
    match given.first() {
        Some(item) if item.key == "origin" => (reader.pose(*item, owner), None),
        Some(item) => dh_row(reader, *item, owner).unwrap_or((None, None)),
        None => (None, None),
    }
}

fn dh_row(reader: &mut Reader, item: Item<'_>, owner: &str) -> Option<(Option<Pose>, Option<Pose>)> {
    let table = item.table(&mut reader.report)?;
    let mut length =
        |key| table.get(key).and_then(|item| reader.formula(item, owner)).unwrap_or(Formula::ZERO);
    let (a, d) = (length("a"), length("d"));
    let mut angle = |key| match table.get(key).and_then(|item| reader.number(item)) {
        Some(angle) => reader.angles.angle(&angle, owner),
        None => 0.0,
    };
    let (alpha, theta) = (angle("alpha"), angle("theta"));
    if item.key == "modified_dh" {
        return Some((Some(modified_dh(d, a, alpha, theta)), None));
    }
    let turned = Pose { rotation: about_z(theta), ..Pose::identity() };
    Some((Some(turned), Some(standard_dh(d, a, alpha))))
}

fn read_limits(reader: &mut Reader, item: Item<'_>) -> Option<LimitsDescription> {
    let table = item.table(&mut reader.report)?;
    let position = table.get("position").and_then(|item| reader.numbers::<2>(item));
    let mut positive = |key| table.get(key).and_then(|item| reader.number(item));
    let [velocity, effort, peak_effort, acceleration, jerk] =
        ["velocity", "effort", "peak_effort", "acceleration", "jerk"].map(&mut positive);
    Some(LimitsDescription { position, velocity, effort, peak_effort, acceleration, jerk })
}
